#include "plugin/identification/diagnosis/selection/cross_validation.h"

#include "plugin/identification/diagnosis/box_qp.h"
#include "plugin/identification/diagnosis/model/decompositions.h"
#include "plugin/identification/diagnosis/selection/forward_validation.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// Indicator of the rows of one fold.
Eigen::VectorXd maskOf(const Grouping& g, int fold) {
    Eigen::VectorXd m(static_cast<Index>(g.fold.size()));
    for (Index k = 0; k < m.size(); ++k)
        m[k] = g.fold[static_cast<std::size_t>(k)] == fold ? 1.0 : 0.0;
    return m;
}

Eigen::MatrixXd priorOf(const Variables& v) {
    Eigen::VectorXd p(v.size());
    for (Index i = 0; i < v.size(); ++i) {
        p[i] = v.intervalPrecision(i, i < v.nominal ? 1e9 : 20.0);
    }
    return p.asDiagonal();
}

} // namespace

Eigen::MatrixXd priorPrecision(const Variables& v) {
    return priorOf(v) + v.penalty;
}

/// By the small eigenproblem of A'A.
double standardise(const Eigen::MatrixXd& A, Eigen::VectorXd& e) {
    const dense::SymmetricEigen eigen = dense::symmetricEigen(A.transpose() * A);
    double logDet = 0.0;
    Eigen::VectorXd out = e;
    for (Index i = 0; i < A.cols(); ++i) {
        const double s2 = std::max(0.0, eigen.values[i]);
        logDet += math::log1p(s2);
        if (s2 < 1e-12)
            continue;
        const Eigen::VectorXd u = A * eigen.vectors.col(i) / std::sqrt(s2);
        out += u * (u.dot(e) * (1.0 / std::sqrt(1.0 + s2) - 1.0));
    }
    e = out;
    return logDet;
}

namespace {

/// Time of each row, s; infinite for jumps, which belong to the force.
std::vector<double> timesOf(const Likelihood& likelihood) {
    std::vector<double> time(static_cast<std::size_t>(likelihood.rows()), std::numeric_limits<double>::infinity());
    for (std::size_t r = 0; r < likelihood.runs(); ++r) {
        const RecordedRun& run = likelihood.data().runs[r];
        for (Index k = 0; k < run.rows(); ++k)
            time[static_cast<std::size_t>(likelihood.start(r) + k)] = likelihood.timeOfReading(r, k);
    }
    return time;
}

/// Folds of a single loading run: intervals of time with equal numbers of rows. Readings of one time stay together.
void splitByTime(Grouping& g, const Likelihood& likelihood, int parts) {
    const std::vector<double> time = timesOf(likelihood);
    std::vector<double> present;
    for (std::size_t k = 0; k < g.fold.size(); ++k)
        if (g.fold[k] >= 0)
            present.push_back(time[k]);
    std::sort(present.begin(), present.end());
    const auto rows = static_cast<long>(present.size());
    for (std::size_t k = 0; k < g.fold.size(); ++k)
        if (g.fold[k] >= 0) {
            const long before = std::lower_bound(present.begin(), present.end(), time[k]) - present.begin();
            g.fold[k] = g.block[k] = static_cast<int>(std::min<long>(parts - 1, parts * before / rows));
        }
    g.folds = g.blocks = parts;
}

/// Folds of runs: all runs of a specimen, or repeats, are left out together, as long as two folds remain.
std::vector<int> foldsOf(const RecordedData& data) {
    std::vector<int> fold;
    int folds = 0;
    for (const RecordedRun& run : data.runs) {
        const auto same = std::find_if(data.runs.begin(), data.runs.end(),
                                       [&](const RecordedRun& other) { return other.specimen == run.specimen; });
        const auto first = static_cast<std::size_t>(same - data.runs.begin());
        fold.push_back(first < fold.size() ? fold[first] : folds++);
    }
    if (folds >= 2)
        return fold;
    fold.clear();
    folds = 0;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const std::size_t first = data.firstOf(r);
        fold.push_back(first < r ? fold[first] : folds++);
    }
    if (folds < 2)
        std::iota(fold.begin(), fold.end(), 0);
    return fold;
}

/// "run_1.csv", "run_4.csv and 2 repeats", "specimen s1".
std::string nameOf(const RecordedData& data, const std::vector<int>& folds, int fold) {
    const auto first = static_cast<std::size_t>(std::find(folds.begin(), folds.end(), fold) - folds.begin());
    if (!data.runs[first].specimen.empty() && data.runs.front().specimen != data.runs.back().specimen)
        return "specimen " + data.runs[first].specimen;
    std::string name;
    std::size_t repeats = 0;
    for (std::size_t r = 0; r < folds.size(); ++r)
        if (folds[r] == fold) {
            repeats += name.empty() ? 0 : 1;
            name = name.empty() ? data.runs[r].name : name;
        }
    return repeats == 0 ? name : name + " and " + std::to_string(repeats) + (repeats == 1 ? " repeat" : " repeats");
}

/// Assigns a jump to the fold of the force reading next to it.
void joinNearestForce(Grouping& g, const Likelihood& likelihood, std::size_t r, Index row) {
    const RecordedRun& run = likelihood.data().runs[r];
    const double at = likelihood.jumps(r)[static_cast<std::size_t>(row - run.rows())].time;
    Index nearest = -1;
    for (Index k = 0; k < run.force.size(); ++k)
        if (likelihood.counts(r, k) && (nearest < 0 || std::abs(run.time[k] - at) < std::abs(run.time[nearest] - at)))
            nearest = k;
    if (nearest < 0)
        return;
    const auto from = static_cast<std::size_t>(likelihood.start(r) + nearest),
               to = static_cast<std::size_t>(likelihood.start(r) + row);
    g.fold[to] = g.fold[from];
    g.block[to] = g.block[from];
}

} // namespace

Grouping groupingOf(const Likelihood& likelihood) {
    if (likelihood.data().free)
        return forwardGroupingOf(likelihood);
    Grouping g;
    const bool byRun = likelihood.runs() > 1;
    const std::vector<int> runFolds = foldsOf(likelihood.data());
    for (std::size_t r = 0; r < likelihood.runs(); ++r) {
        const RecordedRun& run = likelihood.data().runs[r];
        // Cycles of a single run: each loading begins a new one.
        std::vector<int> cycle;
        for (const Stroke& stroke : run.strokes)
            cycle.push_back((cycle.empty() ? 0 : cycle.back()) + (stroke.phase == Phase::Loading ? 1 : 0));
        std::map<std::pair<std::size_t, std::size_t>, int> blocks;
        for (Index k = 0; k < likelihood.rowsOf(r); ++k) {
            const std::size_t stroke = likelihood.stroke(r, k);
            if (!likelihood.counts(r, k)) {
                g.fold.push_back(-1);
                g.block.push_back(-1);
                continue;
            }
            g.fold.push_back(byRun ? runFolds[r] : std::max(0, cycle[stroke] - 1));
            const auto at = blocks.emplace(std::pair(stroke, likelihood.channelOf(r, k)), g.blocks);
            g.blocks += at.second ? 1 : 0;
            g.block.push_back(at.first->second);
        }
    }
    for (const int f : g.fold)
        g.folds = std::max(g.folds, f + 1);
    for (int f = 0; f < g.folds; ++f)
        g.names.push_back(byRun ? nameOf(likelihood.data(), runFolds, f) : "cycle " + std::to_string(f + 1));
    if (g.folds < 2) {
        constexpr int kParts = 5;
        splitByTime(g, likelihood, kParts);
        g.names.clear();
        for (int f = 0; f < kParts; ++f)
            g.names.push_back("fifth " + std::to_string(f + 1));
        for (std::size_t r = 0; r < likelihood.runs(); ++r)
            for (Index k = likelihood.data().runs[r].rows(); k < likelihood.rowsOf(r); ++k)
                joinNearestForce(g, likelihood, r, k);
    }
    return g;
}

double forceRmse(const Likelihood& likelihood, const std::vector<Response>& simulated, const Grouping* grouping,
                 int fold, double* chiSquared, double* count) {
    double sum = 0.0, rows = 0.0;
    for (std::size_t r = 0; r < likelihood.runs(); ++r) {
        const RecordedRun& run = likelihood.data().runs[r];
        const RawDifference rawResidual = likelihood.rawResidual(r, simulated[r]);
        if (rawResidual.rows.size() == 0)
            continue;
        std::vector<double> d;
        double mean = 0.0;
        for (Index k = 0; k < run.force.size(); ++k)
            if (std::isfinite(likelihood.errors(r).force[k]) && !rawResidual.masked[static_cast<std::size_t>(k)] &&
                (grouping == nullptr || grouping->fold[static_cast<std::size_t>(likelihood.start(r) + k)] == fold)) {
                d.push_back(rawResidual.rows[k]);
                mean += d.back();
            }
        mean /= std::max<double>(1.0, static_cast<double>(d.size()));
        const double known = 2.0 * likelihood.zeroStd(r); // larger offsets are not errors of the zero
        mean = std::clamp(mean, -known, known);
        for (const double v : d)
            sum += (v - mean) * (v - mean);
        rows += static_cast<double>(d.size());
    }
    if (chiSquared != nullptr)
        *chiSquared += sum;
    if (count != nullptr)
        *count += rows;
    return rows > 0.0 ? std::sqrt(sum / rows) : 0.0;
}

PredictiveScore inSampleScore(const Likelihood& likelihood, const Grouping& g, const FitResult& fitted) {
    PredictiveScore out;
    out.energy = out.volume = out.rows = Eigen::VectorXd::Zero(g.blocks);
    out.error = Eigen::VectorXd::Zero(likelihood.rows());
    const Eigen::VectorXd maskPenalty = likelihood.maskPenalty(fitted.responses);
    for (Index k = 0; k < likelihood.rows(); ++k)
        if (const int b = g.block[static_cast<std::size_t>(k)]; b >= 0) {
            out.energy[b] += fitted.residual[k] * fitted.residual[k] + maskPenalty[k];
            out.rows[b] += 1.0;
            out.error[k] = fitted.residual[k];
        }
    out.forceRmse = forceRmse(likelihood, fitted.responses);
    return out;
}

namespace {

Eigen::VectorXd variances(const Eigen::MatrixXd& precision) {
    return dense::inverseLlt(precision).diagonal();
}

/// Marks parameters that all runs determine well, but not without one fold.
/// @param known, left their variances by all rows and by those of the other folds
void markIdentifiedOnly(const Variables& v, const Eigen::VectorXd& known, const Eigen::VectorXd& left,
                        const Eigen::MatrixXd& prior, int fold, std::vector<int>& only) {
    constexpr double kPriorAdequate = 0.5, kMuch = 0.05; // of the prior variance
    for (Index k = v.nominal; k < v.size(); ++k)
        if (known[k] * prior(k, k) < kMuch && left[k] * prior(k, k) > kPriorAdequate)
            only[static_cast<std::size_t>(k)] = fold;
}

/// The effect's parameter, or the deviation of a specimen, that moved most, in prior sigma.
Index mostMoved(const Variables& v, const Eigen::VectorXd& step, const Eigen::MatrixXd& prior) {
    Index most = v.nominal;
    for (Index k = 0; k < v.size(); ++k)
        if ((k >= v.nominal || v.scalar(k).batch >= 0) &&
            std::abs(step[k]) * std::sqrt(prior(k, k)) > std::abs(step[most]) * std::sqrt(prior(most, most)))
            most = k;
    return most;
}

/// Parameters and their residual.
struct FoldFit {
    Eigen::VectorXd x, residual, maskPenalty;
    std::vector<Response> responses;
    /// Chi-squared of the rows of an indicator.
    [[nodiscard]] double chiSquared(const Eigen::VectorXd& rows) const {
        return rows.cwiseProduct(residual).squaredNorm() + rows.dot(maskPenalty);
    }
};

/// Fit to the training rows: the linearised minimum inside the bounds, simulated, and one correction.
FoldFit fitToTraining(Evaluator& evaluator, const Likelihood& likelihood, const Variables& v, const Eigen::MatrixXd& J,
                      const Eigen::MatrixXd& damped, const Eigen::VectorXd& train, FoldFit at) {
    constexpr double kPromises = 0.1; // smaller predicted decreases are not worth a simulation
    const Eigen::VectorXd precision = v.normalPrecision();
    const auto priors = [&](const Eigen::VectorXd& x) { return x.dot(precision.cwiseProduct(x)); };
    for (int correction = 0; correction < 2; ++correction) {
        const Eigen::VectorXd far = Eigen::VectorXd::Constant(v.size(), 2.0);
        const Eigen::VectorXd gradient = J.transpose() * train.cwiseProduct(at.residual) - v.penalty * at.x;
        const Eigen::VectorXd step =
            solveBoxQp(damped, gradient, (v.lower - at.x).cwiseMax(-far), (v.upper - at.x).cwiseMin(far));
        if (2.0 * gradient.dot(step) - step.dot(damped * step) < kPromises)
            break;
        FoldFit to{at.x + step, {}, {}, evaluator.simulateAllRuns({v.at(at.x + step)}, Fidelity::Fine).front()};
        const auto residual = likelihood.residual(to.responses);
        if (!residual)
            break;
        to.residual = *residual;
        to.maskPenalty = likelihood.maskPenalty(to.responses);
        // A step that increases chi-squared of the training rows is rejected.
        if (to.chiSquared(train) + priors(to.x) > at.chiSquared(train) + priors(at.x) + 1.0)
            break;
        at = std::move(to);
    }
    return at;
}

} // namespace

void addHeldOut(const Grouping& g, const Eigen::VectorXd& held, const Eigen::VectorXd& e,
                const Eigen::VectorXd& maskPenalty, double volume, PredictiveScore& score) {
    for (Index k = 0; k < e.size(); ++k)
        if (const int b = g.block[static_cast<std::size_t>(k)]; b >= 0 && held[k] > 0.0) {
            score.energy[b] += e[k] * e[k] + maskPenalty[k];
            score.volume[b] += volume;
            score.rows[b] += 1.0;
            score.error[k] = e[k];
        }
}

PredictiveScore crossValidate(Evaluator& evaluator, const Likelihood& likelihood, const Grouping& g,
                              const FitResult& fitted) {
    if (g.forward)
        return forwardValidate(evaluator, likelihood, g, fitted);
    // Differences of chi-squared above which the density counts as nonlinear, and below which the other rows are
    // indifferent (cross_validation.h).
    constexpr double kNonlinear = 6.0, kIndifferent = 2.0;
    PredictiveScore out;
    const Variables v(evaluator.model(), fitted.point);
    out.energy = out.volume = out.rows = Eigen::VectorXd::Zero(g.blocks);
    out.error = Eigen::VectorXd::Zero(likelihood.rows());
    const Eigen::MatrixXd& J = fitted.jacobian;
    const Eigen::MatrixXd prior = priorPrecision(v);
    const Eigen::VectorXd known = variances(J.transpose() * J + prior);
    out.identifiedOnlyBy.assign(static_cast<std::size_t>(v.size()), -1);
    out.folds = g.folds;
    double chiSquared = 0.0, count = 0.0;
    const FoldFit best{fitted.x, fitted.residual, likelihood.maskPenalty(fitted.responses), fitted.responses};
    for (int f = 0; f < g.folds; ++f) {
        evaluator.stop().poll();
        const Eigen::VectorXd held = maskOf(g, f);
        const Eigen::VectorXd train = Eigen::VectorXd::Ones(held.size()) - held;
        const Eigen::MatrixXd G = J.transpose() * train.asDiagonal() * J;
        markIdentifiedOnly(v, known, variances(G + prior), prior, f, out.identifiedOnlyBy);
        // Parameters that the training rows do not determine stay.
        FoldFit at = fitToTraining(evaluator, likelihood, v, J, G + 1e-3 * prior + v.penalty, train, best);
        Eigen::VectorXd e = held.cwiseProduct(at.residual);
        const Eigen::MatrixXd root = dense::inverseCholeskyFactor(G + prior).transpose();
        const double logDet = standardise(held.asDiagonal() * (J * root), e);
        const double rows = held.sum();
        const auto others = [&](const FoldFit& p) { return p.chiSquared(train) + p.x.dot(v.penalty * p.x); };
        const double trainingGain = std::max(0.0, others(best) - others(at));
        const double direct = e.squaredNorm() + held.dot(at.maskPenalty), whole = best.chiSquared(held) + trainingGain;
        if (std::abs(direct - whole) > kNonlinear) {
            ++out.substituted;
            e = held.cwiseProduct(best.residual);
            at.maskPenalty = best.maskPenalty + trainingGain / rows * held;
            if (direct > whole && trainingGain < kIndifferent) {
                at.responses = best.responses;
                if (v.size() > v.nominal)
                    out.identifiedOnlyBy[static_cast<std::size_t>(mostMoved(v, at.x - best.x, prior))] = f;
            }
        }
        addHeldOut(g, held, e, at.maskPenalty, logDet / rows, out);
        forceRmse(likelihood, at.responses, &g, f, &chiSquared, &count);
    }
    out.forceRmse = count > 0.0 ? std::sqrt(chiSquared / count) : 0.0;
    return out;
}

} // namespace supercircle::diagnosis
