#include "plugin/identification/diagnosis/diagnose.h"

#include "plugin/identification/diagnosis/estimation/homogeneity.h"
#include "plugin/identification/diagnosis/estimation/nominal.h"
#include "plugin/identification/diagnosis/estimation/profile.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/next_experiment/suspects.h"
#include "plugin/identification/diagnosis/result/conclude.h"
#include "plugin/identification/diagnosis/result/present.h"
#include "plugin/identification/diagnosis/screening/hollows.h"
#include "plugin/identification/diagnosis/selection/heldout.h"
#include "plugin/identification/diagnosis/selection/ranking.h"
#include "plugin/identification/diagnosis/selection/search.h"
#include "plugin/identification/diagnosis/selection/weigh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

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
        if (!(out_.noise.total() > 0.0))
            withoutNoise();
        else if (nominal() && !evaluator_.stopped()) {
            lookAround();
            if (!evaluator_.stopped())
                summarise();
            if (!evaluator_.stopped())
                tryHypotheses(true);
            if (!evaluator_.stopped() && out_.failure.empty())
                conclude();
        }
        if (data_.free) // markers sit on bodies, not along a specimen
            for (Localisation* l : {&out_.mismatch, &out_.left})
                for (Window& w : l->significant)
                    w.arcFraction = -1.0;
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

    void lookAround() {
        stage(0.2, "screening the catalogue");
        look();
        stage(0.31, "where");
        locate();
        if (!hardlyStandsOut() && !heldAtAnEdge())
            return;
        stage(0.33, "nominal fit from all over");
        if (searchOn(evaluator_, settings_, *misfit_, base_)) {
            look();
            locate();
        }
    }
    /// Once more from what the search came upon beside effects, if it is a better nominal fit.
    void lookAgain(const Point& from) {
        stage(0.34, "nominal fit once more");
        if (!searchFrom(evaluator_, *misfit_, from, base_))
            return;
        look();
        locate();
        if (evaluator_.stopped())
            return;
        summarise();
        tryHypotheses(false);
    }
    /// An alarm of so few squares that another fit may have it gone; with larger ones effects are tried anyway.
    [[nodiscard]] bool hardlyStandsOut() const {
        constexpr double kPlain = 6.0; // deviations
        return !evaluator_.stopped() && !data_.free && out_.mismatch.p <= kFamilyWise &&
               out_.mismatch.signature < kPlain;
    }
    /// Whatever stands out: what nominal numbers would do beyond the edge is absorbed and raises no alarm, but effects
    /// would be measured against a fit that is none.
    [[nodiscard]] bool heldAtAnEdge() const { return !evaluator_.stopped() && !data_.free && base_.atEdge; }

    void withoutNoise();
    bool nominal();
    bool fitBy(const Noise& noise);
    void locate();
    void look();
    void summarise();
    void tryHypotheses(bool first);
    std::vector<Interval> profiled(Tried& t, Eigen::MatrixXd& careful);
    [[nodiscard]] Spread spreadOf(const Entry& entry);
    void conclude();
    void weighAll(Weighed& w);
    /// What a hypothesis leaves, looked for as the nominal fit's misfit was.
    const Localisation& leftOf(std::size_t model);
    void conclusions(const Weighed& w, Evidence& evidence);
    void suggest();
    void present();

    const Data& data_;
    Evaluator& evaluator_;
    const Settings& settings_;
    std::chrono::steady_clock::time_point begin_;
    Diagnosis out_;
    std::unique_ptr<Misfit> misfit_;
    Fitted base_;
    double noiseSquares_ = 1.0; ///< mostSquares()
    HeldOut baseHeld_;
    Grouping grouping_;
    std::vector<Screened> screened_;
    std::vector<Tried> tried_;
    std::vector<Entry> entries_;               ///< as out_.effects
    std::map<std::size_t, Localisation> left_; ///< by what of tried_
};

/// Recorded minus simulated force where it counts, N; elsewhere not a number.
Eigen::VectorXd forceLeft(const Misfit& misfit, std::size_t run, const Response& simulated) {
    const Departure d = misfit.departure(run, simulated);
    Eigen::VectorXd left =
        Eigen::VectorXd::Constant(misfit.data().runs[run].force.size(), std::numeric_limits<double>::quiet_NaN());
    for (Index k = 0; k < left.size() && d.rows.size() > 0; ++k)
        if (misfit.counts(run, k))
            left[k] = d.rows[k];
    return left;
}

/// Everything is said in units of the noise: without one nothing is known beyond what was believed before.
void Work::withoutNoise() {
    out_.verdict = "not_enough_information";
    out_.statement = "How noisy the readings are is neither stated nor to be told from them: in each run all are the "
                     "same, or there are none. State the noise (" +
                     out_.channel + "_noise_std_" + out_.unit + "_approx), or record with a finer resolution.";
    out_.noise.source = "not stated, and readings that are all the same do not tell";
    out_.nothing = kNothing;
    out_.unknown = kUnknown;
    out_.baselineTraining = out_.baselineHeldOut = out_.baselinePerRow = std::numeric_limits<double>::quiet_NaN();
    out_.improvedTraining = out_.improvedHeldOut = out_.baselineTraining;
}

bool Work::nominal() {
    if (!fitBy(out_.noise))
        return false;
    if (evaluator_.stopped() || data_.free || out_.noise.swing > 0.0)
        return true;
    std::vector<Eigen::VectorXd> left;
    for (std::size_t r = 0; r < data_.runs.size(); ++r)
        left.push_back(forceLeft(*misfit_, r, base_.responses[r]));
    const Swing swing = swingOfMisfit(data_, left);
    return swing.period <= 0.0 || fitBy(estimateNoise(data_, swing));
}

bool Work::fitBy(const Noise& noise) {
    out_.noise = settings_.ablation.whitening ? noise.asWhite() : noise;
    Nominal found = fitNominal(data_, evaluator_, out_.noise, settings_,
                               [&](double fraction, const std::string& words) { stage(fraction, words); });
    noiseSquares_ = mostSquares(data_, out_.noise, settings_.seed);
    out_.failure = std::move(found.failure);
    misfit_ = std::move(found.misfit);
    base_ = std::move(found.fit);
    return out_.failure.empty();
}

void Work::locate() {
    if (evaluator_.stopped())
        return;
    grouping_ = groupingOf(*misfit_);
    std::vector<const Eigen::VectorXd*> seen;
    for (const Screened& s : screened_)
        if (s.simulated && s.size > 1e-6)
            seen.push_back(&s.signature);
    Eigen::MatrixXd signatures(misfit_->rows(), static_cast<Index>(seen.size()));
    for (std::size_t i = 0; i < seen.size(); ++i)
        signatures.col(static_cast<Index>(i)) = *seen[i];
    out_.mismatch = localise(*misfit_, base_.residual, freeColumns(evaluator_.model(), base_), settings_.seed,
                             settings_.draws, signatures);
}

void Work::tryHypotheses(bool first) {
    const Ground ground{data_,     evaluator_, settings_,       *misfit_,         grouping_,    base_,
                        baseHeld_, screened_,  out_.mismatch.p, out_.noise.tails, noiseSquares_};
    Searched found = search(ground, [&](double fraction, const std::string& words) { stage(fraction, words); });
    tried_ = std::move(found.tried);
    out_.left = std::move(found.left);
    if (first && found.elsewhere && !evaluator_.stopped())
        lookAgain(*found.elsewhere);
}

void Work::look() {
    screened_ = screen(evaluator_, *misfit_, base_, settings_.probeShare());
}

void Work::summarise() {
    baseHeld_ = heldOutOf(evaluator_, *misfit_, grouping_, base_, settings_);
    out_.homogeneity = homogeneityOf(*misfit_, base_);
    out_.seen.clear();
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
        if (const double visible = s.visible(out_.mismatch.critical); visible < seen.visible) {
            seen.visible = visible;
            seen.absorbed = 1.0 - std::min(1.0, s.own / s.size);
            seen.reading = s.size / s.times;
        }
        seen.gain = std::max(seen.gain, s.gain);
    }
    for (const std::string& label : order)
        out_.seen.push_back(byLabel[label]);
}

const Localisation& Work::leftOf(std::size_t model) {
    const auto at = left_.find(model);
    return at != left_.end()
               ? at->second
               : left_.emplace(model, leftBy(evaluator_.model(), *misfit_, tried_[model].fit, settings_)).first->second;
}

void Work::weighAll(Weighed& w) {
    std::vector<HeldOut> held;
    Weighing given;
    given.catalogue = out_.seen.size();
    const double share = kCatalogue / static_cast<double>(std::max<std::size_t>(1, given.catalogue));
    for (const Tried& t : tried_) {
        held.push_back(t.held);
        given.parts.push_back(t.parts);
        given.outside.push_back(t.learned ? 1 : 0);
        given.pressed.push_back(
            !t.learned &&
            !pressedAmplitudes(evaluator_.model(), t.fit, std::max(1.0, misfitPerRow(*misfit_, t.fit))).empty());
        // Two causes at once are ten times rarer than one; a learned law has half of what "none of these" has.
        given.prior.push_back(t.learned ? 0.5 * kUnknown : t.candidates.size() > 1 ? 0.1 * share : share);
    }
    given.p = out_.mismatch.tail;
    given.tails = out_.noise.tails;
    given.noiseSquares = noiseSquares_;
    const double swing = out_.noise.swing, noise = out_.noise.total(), left = baseHeld_.forceRmse;
    given.swings = swing > 0.0 && 0.5 * swing * swing > 0.5 * (left * left - noise * noise); // mean squares
    given.seed = settings_.seed + 1;
    // Of a pair's parts it decides whether the pair is needed, of the best one whether that is believed.
    given.left.assign(tried_.size(), 0.0);
    for (const Tried& t : tried_)
        for (const std::size_t part : t.learned ? std::vector<std::size_t>{} : t.parts)
            if (!evaluator_.stopped())
                given.left[part] = standsOut(leftOf(part));
    w = weigh(baseHeld_, held, given);
    if (!tried_.empty() && !evaluator_.stopped()) {
        given.left[w.best] = standsOut(leftOf(w.best));
        w = weigh(baseHeld_, held, given);
    }
    if (settings_.ablation.unknown)
        leaveUnknownOut(w);
}

/// Intervals of a hypothesis by profiles. A better fit that they or other places on the arc come upon takes its place.
/// @param careful its derivatives, out
std::vector<Interval> Work::profiled(Tried& t, Eigen::MatrixXd& careful) {
    constexpr int kMoves = 2;
    constexpr double kLower = 1.0; // squares that a move to another place is worth
    std::vector<Fitted> elsewhere; // along the arc
    std::vector<Interval> intervals;
    Fitted& f = t.fit;
    int moves = 0;
    for (;; ++moves) {
        const bool may = moves < kMoves && !evaluator_.stopped();
        const Variables here(evaluator_.model(), f.point);
        careful = differentiateCarefully(evaluator_, *misfit_, here, f.x, 0.2);
        const Eigen::VectorXd dispersions =
            dispersionsOf(*misfit_, here, f.residual, careful, misfitPerRow(*misfit_, f));
        Profiled p = profileIntervals(evaluator_, *misfit_, f, careful, dispersions, may);
        if (p.better && !evaluator_.stopped()) {
            Fitted further = fit(evaluator_, *misfit_, here.at(p.better->x));
            if (!further.failure.empty() || further.misfit > p.better->misfit)
                further = std::move(*p.better);
            further.point = here.at(further.x);
            f = std::move(further);
            continue;
        }
        if (elsewhere.empty())
            elsewhere = otherHollows(evaluator_, *misfit_, f, screened_, base_.misfit);
        const auto lowest = std::min_element(elsewhere.begin(), elsewhere.end(),
                                             [](const Fitted& a, const Fitted& b) { return a.misfit < b.misfit; });
        if (may && lowest != elsewhere.end() && lowest->misfit < f.misfit - kLower) {
            std::swap(f, *lowest);
            continue;
        }
        intervals = std::move(p.intervals);
        if (const Fitted* image = widenBy(elsewhere, evaluator_.model(), f, dispersions, intervals))
            t.otherSide = *image;
        break;
    }
    if (moves > 0 && !evaluator_.stopped()) // errors on unseen runs are those of the fit that is shown
        t.held = usable(heldOutOf(evaluator_, *misfit_, grouping_, f, settings_), baseHeld_);
    return intervals;
}

/// The first effect and what is probable are worth some runs, what is more probable and stands out of the noise some
/// more: profiles of a hint took three thousand simulations of a recording that lacks nothing.
Spread Work::spreadOf(const Entry& entry) {
    Tried& tried = tried_[entry.model];
    const Fitted& f = tried.fit;
    const auto linear = [&](const Eigen::MatrixXd& jacobian) {
        const Variables v(evaluator_.model(), f.point);
        return linearIntervals(v, f, jacobian,
                               dispersionsOf(*misfit_, v, f.residual, jacobian, misfitPerRow(*misfit_, f)));
    };
    const bool worth = &entry == &entries_.front() || entry.probability >= 0.05;
    if (!worth || evaluator_.stopped())
        return {linear(f.jacobian), {}};
    Spread out;
    Eigen::MatrixXd careful;
    if (entry.probability < 0.3 || out_.mismatch.p > kFamilyWise) {
        careful = differentiateCarefully(evaluator_, *misfit_, Variables(evaluator_.model(), f.point), f.x, 0.2);
        out.intervals = linear(careful);
    } else {
        out.intervals = profiled(tried, careful);
    }
    const Variables v(evaluator_.model(), f.point);
    Index first = v.nominal;
    for (const std::size_t c : tried.candidates) {
        out.products.emplace_back();
        for (const Product& p : candidates()[c].products)
            out.products.back().push_back(productInterval(evaluator_, *misfit_, f, careful, p, first));
        first += static_cast<Index>(candidates()[c].parameters.size());
    }
    return out;
}

void Work::conclude() {
    stage(0.92, "weighing");
    Weighed w;
    weighAll(w);
    std::vector<std::string> fitted;
    for (const Tried& t : tried_)
        for (const std::size_t c : t.candidates)
            fitted.push_back(candidates()[c].label);
    out_.nothing = shareUnseen(w.nothing, fitted, out_.seen);
    const Ranking ranking(evaluator_.model(), *misfit_, tried_, w);
    out_.learned = ranking.learned();
    entries_ = ranking.entries();
    out_.unknown = w.unknown;
    for (const LearnedLaw& law : out_.learned)
        out_.unknown += law.probability;
    std::map<std::size_t, Spread> spreads; // by model
    for (const Entry& entry : entries_) {
        if (spreads.count(entry.model) == 0)
            spreads[entry.model] = spreadOf(entry);
        FoundEffect f = presentEffect(evaluator_.model(), *misfit_, grouping_, tried_[entry.model], entry.term,
                                      spreads[entry.model]);
        f.probability = std::min(1.0, entry.probability);
        f.gain = w.gain[entry.model];
        f.gainError = w.gainError[entry.model];
        out_.effects.push_back(std::move(f));
    }
    Evidence e;
    e.p = out_.mismatch.p;
    e.nothing = w.nothing; // that shows
    e.unknown = out_.unknown;
    e.any = !entries_.empty();
    for (std::size_t a = 0; a < entries_.size(); ++a)
        out_.effects[a].group = ranking.groupOf(entries_, a, out_.effects[a].with);
    if (e.any)
        e.bestGroup = ranking.probabilityOf(out_.effects.front().group);
    conclusions(w, e);
    out_.verdict = verdictOf(e);
    out_.improved = out_.improved && out_.verdict != "nothing_missing"; // what came nearest would only mislead
    if (!out_.improved) { // the simulation as it is stands: errors and intervals are its own
        out_.improvedTraining = out_.baselineTraining;
        out_.improvedHeldOut = out_.baselineHeldOut;
        out_.improvement = 0.0;
        out_.improvementCi = {};
    }
    present();
    suggest();
    out_.statement = statementOf(out_, e);
}

void Work::conclusions(const Weighed& w, Evidence& e) {
    out_.baselineTraining = forceRmse(*misfit_, base_.responses);
    out_.baselineHeldOut = baseHeld_.forceRmse;
    out_.baselinePerRow = misfitPerRow(*misfit_, base_);
    if (e.any) {
        const std::size_t first = entries_.front().model; // what the curves show
        const Tried& best = tried_[first];
        e.gain = w.gain[first];
        e.gainLow = w.gainLow[first];
        out_.improved = true;
        out_.improvedTraining = forceRmse(*misfit_, best.fit.responses);
        out_.improvedHeldOut = best.held.forceRmse;
        improvementOf(baseHeld_, best.held, settings_.seed + 3, out_.improvement, out_.improvementCi);
        out_.left = leftOf(first);
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
    // Where nothing known holds, no run that tells two refuted effects from each other says what does.
    const bool open = out_.verdict == "ambiguous" || out_.verdict == "not_enough_information" ||
                      (out_.verdict == "named" &&
                       (out_.effects.front().group.size() > 1 || tried_[entries_.front().model].otherSide.has_value()));
    if (!open || !settings_.next || evaluator_.model().designs().empty())
        return;
    stage(0.96, "next experiment");
    std::vector<Named> named;
    const std::vector<std::string> group =
        out_.effects.empty() ? std::vector<std::string>() : out_.effects.front().group;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const std::string& label = out_.effects[i].label;
        named.push_back({label, entries_[i].probability, &tried_[entries_[i].model],
                         std::find(group.begin(), group.end(), label) != group.end()});
    }
    const std::vector<Rival> rivals =
        suspects(evaluator_, *misfit_, base_, named, screened_, out_.nothing + out_.unseen());
    out_.next = nextExperiment(evaluator_, rivals, out_.noise, data_.zeroWindow);
    if (!out_.next && rivals.size() > 1 && !evaluator_.stopped())
        out_.nextTried = evaluator_.model().designs().size();
}

void Work::present() {
    out_.nominal = presentNominal(evaluator_.model(), base_);
    std::vector<const Fitted*> shown;
    for (const Entry& entry : entries_) {
        out_.similarityLabels.push_back(entry.label);
        shown.push_back(&tried_[entry.model].fit);
    }
    out_.similarity = presentSimilarity(*misfit_, base_, shown);
    out_.runs = presentCurves(*misfit_, base_, out_.improved ? &tried_[entries_.front().model].fit : nullptr);
    if (out_.mismatch.p <= kFamilyWise && out_.mismatch.significant.empty())
        out_.mismatch.significant = windowsOfEffect(data_, out_.runs, out_.mismatch);
}

} // namespace

Diagnosis diagnose(const Data& data, Evaluator& evaluator, const Settings& settings) {
    return Work(data, evaluator, settings).run();
}

} // namespace supercircle::diagnosis
