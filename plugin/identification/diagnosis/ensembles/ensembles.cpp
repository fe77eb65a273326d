#include "plugin/identification/diagnosis/ensembles.h"

#include "plugin/identification/diagnosis/model/random.h"
#include "plugin/identification/diagnosis/result/verdict.h"
#include "plugin/identification/diagnosis/selection/model_weights.h"
#include "plugin/recording/table/rounded.h"
#include "supercircle/support/elementary.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace supercircle::diagnosis {

namespace {

using record::rounded;

using Index = Eigen::Index;

/// Welch's t of each column.
Eigen::VectorXd welch(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    const auto part = [](const Eigen::MatrixXd& m) {
        const Eigen::RowVectorXd mean = m.colwise().mean();
        const double n = static_cast<double>(m.rows());
        return Eigen::VectorXd((m.rowwise() - mean).colwise().squaredNorm().transpose() / (n * (n - 1.0)));
    };
    const Eigen::VectorXd scale = (part(a) + part(b)).cwiseSqrt().cwiseMax(1e-300);
    return (a.colwise().mean() - b.colwise().mean()).transpose().cwiseQuotient(scale);
}

/// Pooled covariance, with a hundredth of its diagonal against quantities that go together.
Eigen::MatrixXd pooled(const std::vector<const Ensemble*>& all) {
    const Index q = all.front()->values.cols();
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(q, q);
    double freedom = 0.0;
    for (const Ensemble* e : all) {
        const Eigen::MatrixXd d = e->values.rowwise() - e->values.colwise().mean();
        sum += d.transpose() * d;
        freedom += static_cast<double>(d.rows() - 1);
    }
    sum /= freedom;
    sum.diagonal() *= 1.01;
    sum.diagonal().array() += 1e-12 * std::max(1e-300, sum.diagonal().maxCoeff());
    return sum;
}

PredictiveScore scored(const Ensemble& recorded, const Ensemble& model, const Eigen::MatrixXd& covariance) {
    const double widened = 1.0 + 1.0 / static_cast<double>(model.values.rows());
    const Eigen::LLT<Eigen::MatrixXd> llt(covariance * widened);
    const Eigen::MatrixXd d = recorded.values.rowwise() - model.values.colwise().mean();
    PredictiveScore out;
    out.energy = llt.matrixL().solve(d.transpose()).colwise().squaredNorm().transpose();
    const double volume =
        2.0 * llt.matrixLLT().diagonal().array().unaryExpr([](double each) { return math::log(each); }).sum();
    out.volume = Eigen::VectorXd::Constant(d.rows(), volume);
    out.rows = Eigen::VectorXd::Constant(d.rows(), static_cast<double>(d.cols()));
    return out;
}

void shiftsOf(const std::vector<std::string>& quantities, const Ensemble& recorded, const Ensemble& nominal,
              std::uint64_t seed, EnsembleDiagnosis& out) {
    constexpr int kDraws = 1999;
    const Eigen::VectorXd t = welch(recorded.values, nominal.values);
    const Index n = recorded.values.rows(), m = nominal.values.rows();
    Eigen::MatrixXd all(n + m, recorded.values.cols());
    all << recorded.values, nominal.values;
    std::vector<Index> order(static_cast<std::size_t>(n + m));
    std::iota(order.begin(), order.end(), Index{0});
    Random random(seed);
    std::vector<double> largest;
    Eigen::MatrixXd a(n, all.cols()), b(m, all.cols());
    for (int d = 0; d < kDraws; ++d) {
        for (std::size_t i = order.size() - 1; i > 0; --i)
            std::swap(order[i], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i + 1))]);
        for (Index i = 0; i < n + m; ++i)
            (i < n ? a.row(i) : b.row(i - n)) = all.row(order[static_cast<std::size_t>(i)]);
        largest.push_back(welch(a, b).cwiseAbs().maxCoeff());
    }
    std::sort(largest.begin(), largest.end());
    for (Index k = 0; k < t.size(); ++k) {
        const auto above = largest.end() - std::lower_bound(largest.begin(), largest.end(), std::abs(t[k]));
        const double p = (1.0 + static_cast<double>(above)) / (1.0 + kDraws);
        out.shifts.push_back({quantities[static_cast<std::size_t>(k)], recorded.values.col(k).mean(),
                              nominal.values.col(k).mean(), t[k], p});
        out.p = std::min(out.p, p);
    }
}

std::string statement(const EnsembleDiagnosis& d) {
    const auto most = std::max_element(d.shifts.begin(), d.shifts.end(),
                                       [](const auto& a, const auto& b) { return std::abs(a.z) < std::abs(b.z); });
    const std::string shift = most->quantity + " is " + rounded(most->recorded, 3) + " in the recordings and " +
                              rounded(most->simulated, 3) +
                              " in the simulation without extra physics (family-wise p = " + rounded(most->p, 3) + ")";
    if (d.verdict == "adequate")
        return "The recorded ensemble agrees with the simulated one. Largest shift: " + shift + ".";
    if (d.verdict == "inconclusive") {
        const std::string believed = "the probability that no effect is missing is " + rounded(d.adequate, 3) + ".";
        return d.p <= kFamilyWise
                   ? "The ensembles differ: " + shift + ", but too little to conclude that an effect acts: " + believed
                   : "These stacks do not decide whether the ensembles differ. Largest shift: " + shift + "; " +
                         believed;
    }
    if (d.verdict == "identified")
        return "The ensembles differ: " + shift + "; " + plainWords(d.effects.front().label) + " explains it.";
    if (d.verdict == "outside_catalogue")
        return "The ensembles differ: " + shift + ", and none of the simulated effects explains it.";
    return "The ensembles differ: " + shift + "; these stacks do not decide which effect explains it.";
}

} // namespace

EnsembleDiagnosis diagnoseEnsembles(const std::vector<std::string>& quantities, const Ensemble& recorded,
                                    const Ensemble& nominal, const std::vector<Ensemble>& effects, std::uint64_t seed) {
    EnsembleDiagnosis out;
    std::vector<const Ensemble*> all = {&recorded, &nominal};
    for (const Ensemble& e : effects)
        all.push_back(&e);
    for (const Ensemble* e : all)
        if (e->values.rows() < 4 || e->values.cols() != static_cast<Index>(quantities.size())) {
            out.failure = "ensemble " + e->label + ": at least 4 stacks with every quantity are needed, it has " +
                          std::to_string(e->values.rows());
            return out;
        }
    shiftsOf(quantities, recorded, nominal, seed, out);
    const Eigen::MatrixXd covariance = pooled(all);
    const PredictiveScore baseline = scored(recorded, nominal, covariance);
    std::vector<PredictiveScore> held;
    for (const Ensemble& e : effects)
        held.push_back(scored(recorded, e, covariance));
    WeightingInput given;
    given.catalogue = std::max<std::size_t>(1, effects.size());
    given.p = out.p;
    given.seed = seed + 1;
    const ModelWeights w = modelWeights(baseline, held, given);
    out.adequate = w.adequate;
    out.outsideCatalogue = w.outsideCatalogue;
    std::vector<std::size_t> order(effects.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return w.effects[a] > w.effects[b]; });
    Evidence e;
    e.p = out.p;
    e.adequate = w.adequate;
    e.outsideCatalogue = w.outsideCatalogue;
    e.any = !effects.empty();
    for (const std::size_t i : order) {
        FittedEffect f;
        f.label = effects[i].label;
        f.probability = w.effects[i];
        f.gain = w.gain[i];
        f.gainError = w.gainError[i];
        f.confoundedWith = {f.label};
        for (const std::size_t k : order) // means that these recordings cannot distinguish
            if (k != i && alike(held[i], held[k], 1e9, w.dispersion))
                f.confoundedWith.push_back(effects[k].label);
        if (out.effects.empty()) {
            e.gain = f.gain;
            e.gainLow = w.gainLow[i];
            e.groupProbability = f.probability;
            for (const std::size_t k : order)
                if (k != i && std::find(f.confoundedWith.begin(), f.confoundedWith.end(), effects[k].label) !=
                                  f.confoundedWith.end())
                    e.groupProbability += w.effects[k];
        }
        out.effects.push_back(std::move(f));
    }
    out.verdict = verdictOf(e);
    out.statement = statement(out);
    return out;
}

} // namespace supercircle::diagnosis
