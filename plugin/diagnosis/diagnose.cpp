#include "plugin/diagnosis/diagnose.h"

#include "plugin/diagnosis/conclude.h"
#include "plugin/diagnosis/fit.h"
#include "plugin/diagnosis/heldout.h"
#include "plugin/diagnosis/homogeneity.h"
#include "plugin/diagnosis/next.h"
#include "plugin/diagnosis/screen.h"
#include "plugin/diagnosis/weigh.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <set>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// One effect that was fitted.
struct Tried {
    std::size_t candidate = 0;
    Fitted fit;
    HeldOut held;
};

Noise takenAsWhite(Noise n) {
    n.white = n.total();
    n.coloured = 0.0;
    return n;
}

void leaveUnknownOut(Weighed& w) {
    const double rest = 1.0 - w.unknown;
    w.unknown = 0.0;
    w.nothing = rest > 0.0 ? w.nothing / rest : 1.0;
    for (double& p : w.effects)
        p = rest > 0.0 ? p / rest : 0.0;
}

class Work {
public:
    Work(const Data& data, Evaluator& evaluator, const Settings& settings)
        : data_(data), evaluator_(evaluator), settings_(settings), begin_(std::chrono::steady_clock::now()) {}

    Diagnosis run() {
        out_.seed = settings_.seed;
        out_.channel = data_.channel;
        out_.unit = data_.unit;
        stage(0.0, "noise");
        out_.noise = estimateNoise(data_);
        if (nominal() && !evaluator_.stopped()) {
            stage(0.2, "screening the catalogue");
            look();
            stage(0.33, "where");
            locate();
            tryEffects();
            if (!evaluator_.stopped() && out_.failure.empty())
                conclude();
        }
        out_.stopped = evaluator_.stopped();
        out_.forwardRuns = evaluator_.asked();
        out_.elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
        return std::move(out_);
    }

private:
    void stage(double fraction, const std::string& words) const {
        if (settings_.progress)
            settings_.progress(fraction, words);
    }
    [[nodiscard]] const std::vector<Candidate>& candidates() const { return evaluator_.model().candidates(); }

    bool nominal();
    void locate();
    void look();
    void summarise();
    [[nodiscard]] HeldOut scored(const Fitted& f);
    void tryEffects();
    void tryLabel(const std::vector<const Screened*>& probes);
    void conclude();
    void groups(const Weighed& w, Evidence& evidence);
    [[nodiscard]] FoundEffect found(const Tried& t, const Weighed& w, std::size_t i) const;
    void curves();
    void nominalResults();
    Eigen::MatrixXd freeColumns(const Fitted& f) const;

    const Data& data_;
    Evaluator& evaluator_;
    const Settings& settings_;
    std::chrono::steady_clock::time_point begin_;
    Diagnosis out_;
    std::unique_ptr<Misfit> misfit_;
    Fitted base_;
    HeldOut baseHeld_;
    Grouping grouping_;
    std::vector<Screened> screened_;
    std::vector<Tried> tried_;
    double least_ = 0.0;             ///< misfit of any fit so far
    std::vector<std::size_t> order_; ///< of tried_, as out_.effects
};

bool Work::nominal() {
    stage(0.02, "nominal fit");
    if (settings_.ablation.whitening)
        out_.noise = takenAsWhite(out_.noise);
    Point stated;
    for (const Scalar& s : evaluator_.model().nominal())
        stated.nominal.push_back(s.value);
    Point at = stated;
    evaluator_.checkStore({0, stated, Fineness::Coarse});
    // The second round weighs rows by what the simulation looks like where it fits.
    for (int round = 0; round < 2; ++round) {
        const auto fine = evaluator_.everywhere({at}, Fineness::Fine).front();
        const auto coarse = evaluator_.everywhere({at}, Fineness::Coarse).front();
        misfit_ = std::make_unique<Misfit>(data_, out_.noise, fine, coarse, settings_.misfit);
        base_ = fit(evaluator_, *misfit_, at);
        if (!base_.failure.empty() || evaluator_.stopped()) {
            out_.failure = evaluator_.stopped() ? "" : base_.failure;
            return false;
        }
        at = base_.point;
    }
    const Variables v(evaluator_.model(), at);
    if (base_.misfit > 1.3 * static_cast<double>(misfit_->present())) { // below, there is nothing better to find
        stage(0.14, "nominal fit from elsewhere");
        const Eigen::VectorXd elsewhere = base_.x.unaryExpr([](double x) { return x > 0.0 ? -0.7 : 0.7; });
        FitSettings given;
        given.rival = base_.misfit / 2.0;
        Fitted other = fit(evaluator_, *misfit_, v.at(elsewhere), given);
        if (other.failure.empty() && other.misfit < base_.misfit - 1.0)
            base_ = std::move(other);
    }
    differentiate(
        evaluator_, *misfit_, v, base_.x, 0.2,
        [&] {
            std::vector<Index> all;
            for (Index i = 0; i < v.size(); ++i)
                all.push_back(i);
            return all;
        }(),
        base_.jacobian);
    return true;
}

Eigen::MatrixXd Work::freeColumns(const Fitted& f) const {
    const Variables v(evaluator_.model(), f.point);
    std::vector<Index> free;
    for (Index i = 0; i < v.size(); ++i)
        if (f.x[i] > v.lower[i] + 1e-6 && f.x[i] < v.upper[i] - 1e-6)
            free.push_back(i);
    Eigen::MatrixXd columns(f.jacobian.rows(), static_cast<Index>(free.size()));
    for (std::size_t i = 0; i < free.size(); ++i)
        columns.col(static_cast<Index>(i)) = f.jacobian.col(free[i]);
    return columns;
}

void Work::locate() {
    grouping_ = groupingOf(*misfit_);
    std::vector<const Eigen::VectorXd*> seen;
    for (const Screened& s : screened_)
        if (s.simulated && s.size > 1e-6)
            seen.push_back(&s.signature);
    Eigen::MatrixXd signatures(misfit_->rows(), static_cast<Index>(seen.size()));
    for (std::size_t i = 0; i < seen.size(); ++i)
        signatures.col(static_cast<Index>(i)) = *seen[i];
    out_.mismatch = localise(*misfit_, base_.residual, freeColumns(base_), settings_.seed, settings_.draws, signatures);
    summarise();
    baseHeld_ = scored(base_);
    out_.homogeneity = homogeneityOf(*misfit_, base_);
}

HeldOut Work::scored(const Fitted& f) {
    return settings_.ablation.heldOut ? inSample(*misfit_, grouping_, f) : leaveOut(evaluator_, *misfit_, grouping_, f);
}

void Work::look() {
    screened_ = screen(evaluator_, *misfit_, base_, settings_.ablation.probes ? 1e-3 : 1.0);
}

void Work::summarise() {
    std::map<std::string, SeenEffect> byLabel;
    std::vector<std::string> order;
    for (const Screened& s : screened_) {
        const std::string& label = candidates()[s.candidate].label;
        const auto [at, fresh] = byLabel.emplace(label, SeenEffect{});
        SeenEffect& seen = at->second;
        if (fresh) {
            order.push_back(label);
            seen.label = label;
            seen.visible = std::numeric_limits<double>::infinity();
        }
        if (!s.simulated || s.size <= 1e-6)
            continue;
        if (s.visible(out_.mismatch.critical) < seen.visible) {
            seen.visible = s.visible(out_.mismatch.critical);
            seen.absorbed = 1.0 - std::min(1.0, s.own / s.size);
            seen.reading = s.size;
        }
        seen.gain = std::max(seen.gain, s.gain);
    }
    for (const std::string& label : order)
        out_.seen.push_back(byLabel[label]);
}

void Work::tryEffects() {
    std::map<std::string, std::vector<const Screened*>> byLabel;
    for (const Screened& s : screened_)
        if (s.simulated && s.gain > 8.0) // less is luck: 8 is a p-value of half a per cent for one number
            byLabel[candidates()[s.candidate].label].push_back(&s);
    std::vector<std::vector<const Screened*>> ranked;
    for (auto& [label, probes] : byLabel) {
        std::stable_sort(probes.begin(), probes.end(),
                         [](const Screened* a, const Screened* b) { return a->gain > b->gain; });
        ranked.push_back(probes);
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const auto& a, const auto& b) { return a.front()->gain > b.front()->gain; });
    // A first look is linear and may be wrong by much, not by a factor of thirty.
    while (ranked.size() > 3 &&
           (ranked.size() > settings_.fits || ranked.back().front()->gain < ranked.front().front()->gain / 30.0))
        ranked.pop_back();
    for (std::size_t i = 0; i < ranked.size() && !evaluator_.stopped(); ++i) {
        stage(0.35 + 0.55 * static_cast<double>(i) / static_cast<double>(ranked.size()),
              "fitting " + candidates()[ranked[i].front()->candidate].label);
        tryLabel(ranked[i]);
    }
    // Two rivals are always weighed; others only where they come near.
    std::stable_sort(tried_.begin(), tried_.end(),
                     [](const Tried& a, const Tried& b) { return a.fit.misfit < b.fit.misfit; });
    while (tried_.size() > 2 && tried_.back().fit.misfit > 3.0 * least_)
        tried_.pop_back();
    for (Tried& t : tried_)
        if (!evaluator_.stopped())
            t.held = scored(t.fit);
}

/// Fits an effect from its best probes: of each of its two best forms the best, and one more.
void Work::tryLabel(const std::vector<const Screened*>& probes) {
    std::vector<const Screened*> starts = {probes.front()};
    for (const Screened* p : probes)
        if (starts.size() < 2 && p->candidate != probes.front()->candidate && p->gain > 0.3 * probes.front()->gain)
            starts.push_back(p);
    // Free runs are cheap, and what a base that lost its beat says of forms is worth little: each gets its chance.
    for (const Screened* p : probes)
        if (data_.free &&
            std::none_of(starts.begin(), starts.end(), [&](const Screened* s) { return s->candidate == p->candidate; }))
            starts.push_back(p);
    if (probes.size() > 1 && starts.size() < 2 && probes[1]->gain > 0.3 * probes.front()->gain)
        starts.push_back(probes[1]);
    Tried best;
    bool any = false;
    for (const Screened* s : starts) {
        if (evaluator_.stopped())
            return;
        Point start = base_.point;
        start.terms.push_back({s->candidate, s->values});
        Tried t;
        t.candidate = s->candidate;
        FitSettings given;
        given.rival = least_;
        t.fit = fit(evaluator_, *misfit_, start, given, base_.jacobian);
        if (t.fit.failure.empty())
            least_ = least_ > 0.0 ? std::min(least_, t.fit.misfit) : t.fit.misfit;
        if (t.fit.failure.empty() && (!any || t.fit.misfit < best.fit.misfit)) {
            best = std::move(t);
            any = true;
        }
    }
    if (!any || best.fit.misfit > base_.misfit - 1.0)
        return;
    tried_.push_back(std::move(best));
}

FoundEffect Work::found(const Tried& t, const Weighed& w, std::size_t i) const {
    const Candidate& c = candidates()[t.candidate];
    FoundEffect e;
    e.label = c.label;
    e.slot = c.slot;
    e.form = c.form;
    e.law = c.law;
    e.probability = w.effects[i];
    e.gain = w.gain[i];
    e.gainError = w.gainError[i];
    e.trainingRmse = forceRmse(*misfit_, t.fit.responses);
    e.heldOutRmse = t.held.forceRmse;
    e.misfitPerRow = t.fit.misfit / static_cast<double>(std::max<Index>(1, misfit_->present()));
    const Variables v(evaluator_.model(), t.fit.point);
    Eigen::MatrixXd precision = t.fit.jacobian.transpose() * t.fit.jacobian / std::max(1.0, e.misfitPerRow);
    for (Index k = 0; k < v.size(); ++k) {
        const double width = std::min(v.upper[k] - v.lower[k], 1e3);
        precision(k, k) += 12.0 / (width * width);
    }
    const Eigen::MatrixXd covariance = precision.ldlt().solve(Eigen::MatrixXd::Identity(v.size(), v.size()));
    constexpr double k90 = 1.6448536269514722; // of a normal distribution
    for (Index k = v.nominal; k < v.size(); ++k) {
        const Scalar& s = v.scalar(k);
        const double half = k90 * std::sqrt(std::max(0.0, covariance(k, k)));
        const auto at = [&](double x) {
            return outer(s.scale, s.value + std::clamp(x, v.lower[k], v.upper[k]) * s.step);
        };
        FittedParameter p{s.name, s.unit, at(t.fit.x[k]), {at(t.fit.x[k] - half), at(t.fit.x[k] + half)}};
        if (p.ci90.low > p.ci90.high)
            std::swap(p.ci90.low, p.ci90.high);
        e.parameters.push_back(p);
    }
    return e;
}

/// Which effects cannot be told apart, and how probable the first one's group is.
void Work::groups(const Weighed& w, Evidence& evidence) {
    for (std::size_t a = 0; a < order_.size(); ++a) {
        FoundEffect& e = out_.effects[a];
        e.group = {e.label};
        double together = e.probability;
        for (std::size_t b = 0; b < order_.size(); ++b) {
            if (a == b)
                continue;
            const Tried &s = tried_[order_[a]], &t = tried_[order_[b]];
            const auto apart = misfit_->difference(s.fit.responses, t.fit.responses);
            if (apart && alike(s.held, t.held, apart->norm(), w.dispersion)) {
                e.group.push_back(out_.effects[b].label);
                together += out_.effects[b].probability;
            }
        }
        if (a == 0)
            evidence.bestGroup = together;
    }
}

void Work::conclude() {
    stage(0.92, "weighing");
    std::vector<HeldOut> held;
    for (const Tried& t : tried_)
        held.push_back(t.held);
    Weighing given;
    given.catalogue = out_.seen.size();
    given.p = out_.mismatch.tail;
    given.seed = settings_.seed + 1;
    Weighed w = weigh(baseHeld_, held, given);
    if (settings_.ablation.unknown)
        leaveUnknownOut(w);
    out_.nothing = w.nothing;
    out_.unknown = w.unknown;
    for (std::size_t i = 0; i < tried_.size(); ++i)
        order_.push_back(i);
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
        return w.effects[a] != w.effects[b] ? w.effects[a] > w.effects[b] : w.gain[a] > w.gain[b];
    });
    for (const std::size_t i : order_)
        out_.effects.push_back(found(tried_[i], w, i));
    Evidence e;
    e.p = out_.mismatch.p;
    e.nothing = w.nothing;
    e.unknown = w.unknown;
    e.any = !tried_.empty();
    groups(w, e);
    out_.baselineTraining = forceRmse(*misfit_, base_.responses);
    out_.baselineHeldOut = baseHeld_.forceRmse;
    out_.baselinePerRow = base_.misfit / static_cast<double>(std::max<Index>(1, misfit_->present()));
    if (e.any) {
        const Tried& best = tried_[order_.front()];
        e.gain = out_.effects.front().gain;
        e.gainLow = w.gainLow[order_.front()];
        out_.improved = true;
        out_.improvedTraining = out_.effects.front().trainingRmse;
        out_.improvedHeldOut = out_.effects.front().heldOutRmse;
        out_.improvement = w.improvement;
        out_.improvementCi = {w.improvementLow, w.improvementHigh};
        out_.left = localise(*misfit_, best.fit.residual, freeColumns(best.fit), settings_.seed + 2, settings_.draws);
    }
    double matter = 0.0, blind = 0.0; // an effect matters here if a size worth knowing changes readings by 5 units
    for (const SeenEffect& s : out_.seen)
        if (s.reading > 5.0) {
            matter += 1.0;
            blind += s.visible > 1.0 ? 1.0 : 0.0;
        }
    e.blind = matter > 0.0 ? blind / matter : 1.0;
    out_.verdict = verdictOf(e);
    nominalResults();
    curves();
    const bool open =
        out_.verdict != "nothing_missing" && (out_.verdict != "named" || out_.effects.front().group.size() > 1);
    const bool hint = out_.verdict == "not_enough_information"; // the rival is that nothing is missing
    if (open && order_.size() > (hint ? 0U : 1U)) {
        stage(0.96, "next experiment");
        std::vector<Rival> rivals;
        if (hint)
            rivals.push_back({"nothing", base_.point});
        for (std::size_t i = 0; i < order_.size() && i < 3; ++i)
            rivals.push_back({out_.effects[i].label, tried_[order_[i]].fit.point});
        out_.next = nextExperiment(evaluator_.model(), rivals, out_.noise,
                                   hint ? std::vector<std::string>{"nothing"} : out_.effects.front().group);
    }
    out_.statement = statementOf(out_, e);
}

void Work::nominalResults() {
    const Variables v(evaluator_.model(), base_.point);
    for (Index i = 0; i < v.nominal; ++i) {
        const Scalar& s = v.scalar(i);
        out_.nominal.push_back(
            {s.name, s.unit, s.value, s.step, base_.point.nominal[static_cast<std::size_t>(i)], base_.x[i]});
    }
    out_.similarityLabels.clear();
    Eigen::MatrixXd signatures(misfit_->rows(), static_cast<Index>(order_.size()));
    for (std::size_t i = 0; i < order_.size(); ++i) {
        out_.similarityLabels.push_back(out_.effects[i].label);
        const auto s = misfit_->difference(tried_[order_[i]].fit.responses, base_.responses);
        signatures.col(static_cast<Index>(i)) = s ? *s : Eigen::VectorXd::Zero(misfit_->rows());
    }
    for (Index i = 0; i < signatures.cols(); ++i) {
        out_.similarity.emplace_back();
        for (Index j = 0; j < signatures.cols(); ++j) {
            const double n = signatures.col(i).norm() * signatures.col(j).norm();
            out_.similarity.back().push_back(n > 0.0 ? signatures.col(i).dot(signatures.col(j)) / n : 0.0);
        }
    }
}

void Work::curves() {
    const auto list = [](const Eigen::VectorXd& v) { return std::vector<double>(v.data(), v.data() + v.size()); };
    for (std::size_t r = 0; r < data_.runs.size(); ++r) {
        const RecordedRun& run = data_.runs[r];
        const Index n = run.force.size();
        RunCurves c;
        c.name = run.name;
        c.time = list(run.time);
        c.displacement = list(run.displacement);
        c.recorded = list(run.force);
        c.baseline = list(base_.responses[r].force);
        c.residual = list(base_.residual.segment(misfit_->start(r), n));
        if (!order_.empty()) {
            const Fitted& best = tried_[order_.front()].fit;
            c.improved = list(best.responses[r].force);
            c.residualImproved = list(best.residual.segment(misfit_->start(r), n));
        }
        for (Index k = 0; k < n; ++k)
            c.counts.push_back(std::isfinite(misfit_->errors(r).force[k]));
        out_.runs.push_back(std::move(c));
    }
}

} // namespace

Diagnosis diagnose(const Data& data, Evaluator& evaluator, const Settings& settings) {
    return Work(data, evaluator, settings).run();
}

} // namespace supercircle::diagnosis
