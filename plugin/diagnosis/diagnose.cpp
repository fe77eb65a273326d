#include "plugin/diagnosis/diagnose.h"

#include "plugin/diagnosis/conclude.h"
#include "plugin/diagnosis/fit.h"
#include "plugin/diagnosis/forms.h"
#include "plugin/diagnosis/heldout.h"
#include "plugin/diagnosis/homogeneity.h"
#include "plugin/diagnosis/learn.h"
#include "plugin/diagnosis/next.h"
#include "plugin/diagnosis/pairs.h"
#include "plugin/diagnosis/present.h"
#include "plugin/diagnosis/screen.h"
#include "plugin/diagnosis/weigh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <set>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// Share of the misfit on unseen runs that a named effect may leave before laws are learned.
constexpr double kLeftOver = 0.05;

/// A label of the report and the hypothesis it is best shown by.
struct Entry {
    std::string label;
    std::size_t model = 0; ///< of tried_
    std::size_t term = 0;
    double probability = 0.0; ///< of all hypotheses that contain it
};

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
    void tryMore();
    void tryForms(double dispersion);
    void rank(double dispersion);
    void tryLearned(double left);
    void conclude();
    void enter(const Weighed& w);
    void weighAll(Weighed& w) const;
    void groups(const Weighed& w, Evidence& evidence);
    void conclusions(const Weighed& w, Evidence& evidence);
    void suggest();
    void present();
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
    std::set<std::size_t> fitted_; ///< candidates that were fitted in full
    double least_ = 0.0;           ///< misfit of any fit so far
    std::vector<Entry> entries_;   ///< as out_.effects
    std::size_t best_ = 0;         ///< of tried_: what the curves show
    bool any_ = false;             ///< whether there is a best one
};

bool Work::nominal() {
    stage(0.02, "nominal fit");
    if (settings_.ablation.whitening)
        out_.noise = out_.noise.asWhite();
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
    HeldOut h =
        settings_.ablation.heldOut ? inSample(*misfit_, grouping_, f) : leaveOut(evaluator_, *misfit_, grouping_, f);
    return &f == &base_ ? h : usable(std::move(h), baseHeld_);
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
    if (!evaluator_.stopped())
        tryMore();
}

/// Where the best single effect leaves something: two at a time, and laws that are learned.
void Work::tryMore() {
    // Scores at one dispersion rank the singles; the first of them is what the rest must beat.
    double least = dispersionOf(baseHeld_);
    for (const Tried& t : tried_)
        least = std::min(least, dispersionOf(t.held));
    const double dispersion = std::max(1.0, least);
    rank(dispersion);
    // Pure noise, its size known to 5 %, leaves up to this much.
    const double rows = std::max(1.0, baseHeld_.rows.sum());
    const double floor = 1.1 + 2.0 * std::sqrt(2.0 / rows), excess = dispersionOf(baseHeld_) - 1.0;
    const auto leftBy = [&](const Tried& t) {
        return excess > 0.0 ? std::max(0.0, t.perRow() - floor) / excess : t.perRow() > floor ? 1.0 : 0.0;
    };
    double left = 1.0;
    if (!tried_.empty()) {
        const Fitted& f = tried_.front().fit;
        out_.left = localise(*misfit_, f.residual, freeColumns(f), settings_.seed + 2, settings_.draws);
        left = leftBy(tried_.front());
        if (out_.left.p <= 0.01 && left > kLeftOver)
            tryForms(dispersion);
        left = leftBy(tried_.front());
        if (out_.left.p <= 0.01) {
            stage(0.8, "two effects at a time");
            std::vector<Tried> pairs = fitPairs(evaluator_, *misfit_, screened_, tried_);
            for (Tried& t : pairs)
                if (!evaluator_.stopped()) {
                    t.held = scored(t.fit);
                    left = std::min(left, leftBy(t));
                    tried_.push_back(std::move(t));
                }
        }
    }
    if (out_.mismatch.p <= 0.01 && left > kLeftOver && !settings_.ablation.unknown)
        tryLearned(left);
}

void Work::tryForms(double dispersion) {
    stage(0.78, "other forms of the best laws");
    for (std::size_t i = 0; i < tried_.size() && i < 2; ++i)
        if (auto better = betterForm(evaluator_, *misfit_, base_, screened_, tried_[i], fitted_);
            better && !evaluator_.stopped()) {
            better->held = scored(better->fit);
            if (better->held.score(dispersion).sum() > tried_[i].held.score(dispersion).sum())
                tried_[i] = std::move(*better);
        }
    rank(dispersion);
    const Fitted& f = tried_.front().fit;
    out_.left = localise(*misfit_, f.residual, freeColumns(f), settings_.seed + 2, settings_.draws);
}

void Work::rank(double dispersion) {
    std::stable_sort(tried_.begin(), tried_.end(), [&](const Tried& a, const Tried& b) {
        return a.held.score(dispersion).sum() > b.held.score(dispersion).sum();
    });
}

void Work::tryLearned(double left) {
    stage(0.85, "learning a law");
    const std::size_t named = tried_.size();
    // The more is left, the more is worth trying.
    for (Tried& t : learn(evaluator_, *misfit_, base_, left > 0.3 ? 3 : 2)) {
        if (evaluator_.stopped())
            return;
        t.held = scored(t.fit);
        for (std::size_t i = 0; i < named; ++i)
            t.parts.push_back(i);
        tried_.push_back(std::move(t));
    }
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
        fitted_.insert(s->candidate);
        Tried t;
        t.candidates = {s->candidate};
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

/// Which effects cannot be told apart, and how probable the first one's group is. Effects that act together are no
/// rivals.
void Work::groups(const Weighed& w, Evidence& evidence) {
    for (std::size_t a = 0; a < entries_.size(); ++a) {
        FoundEffect& e = out_.effects[a];
        e.group = {e.label};
        double together = e.probability;
        for (std::size_t b = 0; b < entries_.size(); ++b) {
            if (a == b || std::find(e.with.begin(), e.with.end(), entries_[b].label) != e.with.end())
                continue;
            const Tried &s = tried_[entries_[a].model], &t = tried_[entries_[b].model];
            const auto apart = misfit_->difference(s.fit.responses, t.fit.responses);
            if (apart && alike(s.held, t.held, apart->norm(), w.dispersion)) {
                e.group.push_back(out_.effects[b].label);
                together += out_.effects[b].probability;
            }
        }
        if (a == 0)
            evidence.bestGroup = std::min(1.0, together);
    }
}

/// Labels with the probability of every hypothesis that contains them, and the best one to show them by.
void Work::enter(const Weighed& w) {
    const auto better = [&](std::size_t a, std::size_t b) {
        return w.effects[a] != w.effects[b] ? w.effects[a] > w.effects[b] : w.gain[a] > w.gain[b];
    };
    std::map<std::string, double> alone; // gain of the label by itself, to order those that act together
    for (std::size_t i = 0; i < tried_.size(); ++i) {
        if (tried_[i].learned) {
            LearnedLaw law = describe(evaluator_.model(), *misfit_, tried_[i]);
            law.probability = w.effects[i];
            law.gain = w.gain[i];
            law.gainError = w.gainError[i];
            law.heldOutRmse = tried_[i].held.forceRmse;
            out_.learned.push_back(std::move(law));
            continue;
        }
        if (!any_ || better(i, best_))
            best_ = i;
        any_ = true;
        for (std::size_t term = 0; term < tried_[i].candidates.size(); ++term) {
            const std::string& label = candidates()[tried_[i].candidates[term]].label;
            if (tried_[i].candidates.size() == 1)
                alone[label] = std::max(alone.emplace(label, w.gain[i]).first->second, w.gain[i]);
            const auto at =
                std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.label == label; });
            if (at == entries_.end()) {
                entries_.push_back({label, i, term, w.effects[i]});
                continue;
            }
            at->probability += w.effects[i];
            if (better(i, at->model)) {
                at->model = i;
                at->term = term;
            }
        }
    }
    const auto own = [&](const std::string& label) {
        const auto at = alone.find(label);
        return at != alone.end() ? at->second : -1e300;
    };
    std::stable_sort(entries_.begin(), entries_.end(), [&](const Entry& a, const Entry& b) {
        return std::abs(a.probability - b.probability) > 1e-3 ? a.probability > b.probability
                                                              : own(a.label) > own(b.label);
    });
    std::stable_sort(out_.learned.begin(), out_.learned.end(), [](const LearnedLaw& a, const LearnedLaw& b) {
        return a.probability != b.probability ? a.probability > b.probability : a.gain > b.gain;
    });
}

void Work::weighAll(Weighed& w) const {
    std::vector<HeldOut> held;
    Weighing given;
    given.catalogue = out_.seen.size();
    const double share = 0.6 / static_cast<double>(std::max<std::size_t>(1, given.catalogue));
    for (const Tried& t : tried_) {
        held.push_back(t.held);
        given.parts.push_back(t.parts);
        // Two causes at once are ten times rarer than one; a learned law shares what "none of these" has.
        given.prior.push_back(t.learned ? 0.05 : t.candidates.size() > 1 ? 0.1 * share : share);
    }
    given.p = out_.mismatch.tail;
    given.tails = out_.noise.tails;
    given.seed = settings_.seed + 1;
    w = weigh(baseHeld_, held, given);
    if (settings_.ablation.unknown)
        leaveUnknownOut(w);
}

void Work::conclude() {
    stage(0.92, "weighing");
    Weighed w;
    weighAll(w);
    out_.nothing = w.nothing;
    enter(w);
    out_.unknown = w.unknown;
    for (const LearnedLaw& law : out_.learned)
        out_.unknown += law.probability;
    for (const Entry& entry : entries_) {
        FoundEffect f = presentEffect(evaluator_.model(), *misfit_, tried_[entry.model], entry.term);
        f.probability = std::min(1.0, entry.probability);
        f.gain = w.gain[entry.model];
        f.gainError = w.gainError[entry.model];
        out_.effects.push_back(std::move(f));
    }
    Evidence e;
    e.p = out_.mismatch.p;
    e.nothing = out_.nothing;
    e.unknown = out_.unknown;
    e.any = any_;
    groups(w, e);
    conclusions(w, e);
    out_.verdict = verdictOf(e);
    present();
    suggest();
    out_.statement = statementOf(out_, e);
}

void Work::conclusions(const Weighed& w, Evidence& e) {
    out_.baselineTraining = forceRmse(*misfit_, base_.responses);
    out_.baselineHeldOut = baseHeld_.forceRmse;
    out_.baselinePerRow = base_.misfit / static_cast<double>(std::max<Index>(1, misfit_->present()));
    if (e.any) {
        const Tried& best = tried_[best_];
        e.gain = w.gain[best_];
        e.gainLow = w.gainLow[best_];
        out_.improved = true;
        out_.improvedTraining = forceRmse(*misfit_, best.fit.responses);
        out_.improvedHeldOut = best.held.forceRmse;
        improvementOf(baseHeld_, best.held, settings_.seed + 3, out_.improvement, out_.improvementCi);
        if (best_ != 0) // of the first one it is known
            out_.left =
                localise(*misfit_, best.fit.residual, freeColumns(best.fit), settings_.seed + 2, settings_.draws);
    }
    double matter = 0.0, blind = 0.0; // an effect matters here if a size worth knowing changes readings by 5 units
    for (const SeenEffect& s : out_.seen)
        if (s.reading > 5.0) {
            matter += 1.0;
            blind += s.visible > 1.0 ? 1.0 : 0.0;
        }
    e.blind = matter > 0.0 ? blind / matter : 1.0;
}

void Work::suggest() {
    const bool open =
        out_.verdict != "nothing_missing" && (out_.verdict != "named" || out_.effects.front().group.size() > 1);
    const bool hint = out_.verdict == "not_enough_information"; // the rival is that nothing is missing
    if (!open || entries_.size() <= (hint ? 0U : 1U))
        return;
    stage(0.96, "next experiment");
    std::vector<Rival> rivals;
    if (hint)
        rivals.push_back({"nothing", base_.point});
    for (std::size_t i = 0; i < entries_.size() && i < 3; ++i)
        rivals.push_back({out_.effects[i].label, tried_[entries_[i].model].fit.point});
    out_.next = nextExperiment(evaluator_.model(), rivals, out_.noise,
                               hint ? std::vector<std::string>{"nothing"} : out_.effects.front().group);
}

void Work::present() {
    out_.nominal = presentNominal(evaluator_.model(), base_);
    std::vector<const Fitted*> shown;
    for (const Entry& entry : entries_) {
        out_.similarityLabels.push_back(entry.label);
        shown.push_back(&tried_[entry.model].fit);
    }
    out_.similarity = presentSimilarity(*misfit_, base_, shown);
    out_.runs = presentCurves(*misfit_, base_, any_ ? &tried_[best_].fit : nullptr);
}

} // namespace

Diagnosis diagnose(const Data& data, Evaluator& evaluator, const Settings& settings) {
    return Work(data, evaluator, settings).run();
}

} // namespace supercircle::diagnosis
