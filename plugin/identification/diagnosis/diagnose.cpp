#include "plugin/identification/diagnosis/diagnose.h"

#include "plugin/identification/diagnosis/estimation/baseline_fit.h"
#include "plugin/identification/diagnosis/estimation/homogeneity.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/localisation/validity.h"
#include "plugin/identification/diagnosis/next_experiment/competing_hypotheses.h"
#include "plugin/identification/diagnosis/result/effect_intervals.h"
#include "plugin/identification/diagnosis/result/report_values.h"
#include "plugin/identification/diagnosis/result/specimens.h"
#include "plugin/identification/diagnosis/result/verdict.h"
#include "plugin/identification/diagnosis/screening/local_minima.h"
#include "plugin/identification/diagnosis/selection/cross_validation.h"
#include "plugin/identification/diagnosis/selection/forward_validation.h"
#include "plugin/identification/diagnosis/selection/hypothesis_search.h"
#include "plugin/identification/diagnosis/selection/model_weights.h"
#include "plugin/identification/diagnosis/selection/ranking.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <tuple>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

class Procedure {
public:
    Procedure(const RecordedData& data, Evaluator& evaluator, const DiagnosisSettings& settings)
        : data_(data), evaluator_(evaluator), settings_(settings), begin_(std::chrono::steady_clock::now()),
          cpuBegin_(std::clock()) {}

    Diagnosis run() {
        out_.seed = settings_.seed;
        out_.channel = data_.channel;
        out_.unit = data_.unit;
        out_.drive = data_.drive;
        out_.table = data_.table;
        stage(0.0, "noise");
        try {
            decide();
        } catch (const Stopped&) { // by an interrupt
        }
        if (data_.free) // markers sit on bodies, not along a specimen
            for (Localisation* l : {&out_.misfit, &out_.residualAfterBest})
                for (ResidualWindow& w : l->significant)
                    w.arcFraction = -1.0;
        out_.stopped = evaluator_.stop().interrupted();
        out_.forwardRuns = evaluator_.distinctRequests();
        out_.elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
        out_.cpuSeconds = static_cast<double>(std::clock() - cpuBegin_) / CLOCKS_PER_SEC;
        return std::move(out_);
    }

private:
    void decide() {
        out_.noise = estimateNoise(data_, {}, evaluator_.stop());
        bool going = out_.noise.total() > 0.0;
        if (!going)
            reportUnknownNoise();
        else if (!evaluator_.stop().attempt([&] {
                     going = prepareBaseline();
                     if (going) {
                         examineBaseline();
                         summarise();
                     }
                 })) {
            reportNoTime();
            return;
        }
        if (!going)
            return;
        tryHypotheses(true);
        if (out_.failure.empty())
            conclude();
        noteNotTried();
    }
    void stage(double fraction, const std::string& words) const {
        if (settings_.progress)
            settings_.progress(fraction, words);
    }
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const { return evaluator_.model().candidates(); }

    void examineBaseline() {
        stage(0.2, "screening the catalogue");
        screenEffects();
        stage(0.31, "localisation");
        locate();
        if (!isMarginal() && !isHeldAtBranchEdge())
            return;
        stage(0.33, "baseline fit from further starts");
        if (searchLowerMinimum(evaluator_, settings_, *likelihood_, baseline_)) {
            screenEffects();
            locate();
        }
    }
    /// Does what a verdict can do without. If the time limit ends it, all is as before, and it is told.
    template <class Work>
    bool attempt(const std::string& what, const Work& work) {
        const auto kept = std::tuple(baseline_, baselineScore_, grouping_, screened_, hypotheses_, out_.misfit,
                                     out_.residualAfterBest, out_.homogeneity, out_.screening);
        if (evaluator_.stop().attempt(work))
            return true;
        std::tie(baseline_, baselineScore_, grouping_, screened_, hypotheses_, out_.misfit, out_.residualAfterBest,
                 out_.homogeneity, out_.screening) = kept;
        out_.notTried.push_back(what);
        return false;
    }
    /// Repeats the baseline fit from a point that the hypothesis search found, if it is better there.
    void repeatFrom(const ParameterPoint& from) {
        stage(0.34, "baseline fit, refined");
        if (!refitFrom(evaluator_, *likelihood_, from, baseline_))
            return;
        screenEffects();
        locate();
        if (evaluator_.stopped())
            return;
        summarise();
        tryHypotheses(false);
    }
    /// A marginal misfit that a better baseline fit might remove. For larger ones effects are tried anyway.
    [[nodiscard]] bool isMarginal() const {
        constexpr double kMarginal = 6.0; // sigma
        return !evaluator_.stopped() && !data_.free && out_.misfit.p <= kFamilyWise &&
               out_.misfit.largestSignature < kMarginal;
    }
    /// The baseline fit is held at the edge of its branch. Effects would then be compared with a fit that is not a
    /// minimum.
    [[nodiscard]] bool isHeldAtBranchEdge() const {
        return !evaluator_.stopped() && !data_.free && baseline_.atBranchEdge;
    }

    void reportUnknownNoise();
    void reportNoTime();
    void reportPriors();
    void noteNotTried();
    bool prepareBaseline();
    bool fitWith(const Noise& noise);
    void locate();
    void screenEffects();
    void summarise();
    void tryHypotheses(bool first);
    [[nodiscard]] ParameterIntervals intervalsOf(const Entry& entry);
    void conclude();
    void computeWeights(ModelWeights& w);
    /// The residual of a hypothesis, localised as the baseline residual is.
    const Localisation& residualOf(std::size_t model);
    [[nodiscard]] std::vector<RunForecast> forecastsOfRuns(const PredictiveScore& score) const;
    [[nodiscard]] bool forecastHolds(const PredictiveScore& score) const;
    void summariseEvidence(const ModelWeights& w, Evidence& evidence);
    void proposeNextExperiment();
    void present();

    const RecordedData& data_;
    Evaluator& evaluator_;
    const DiagnosisSettings& settings_;
    std::chrono::steady_clock::time_point begin_;
    std::clock_t cpuBegin_;
    Diagnosis out_;
    std::unique_ptr<Likelihood> likelihood_;
    FitResult baseline_;
    double noiseChiSquared_ = 1.0; ///< mostSquares()
    PredictiveScore baselineScore_;
    Grouping grouping_;
    std::vector<ScreenedProbe> screened_;
    std::vector<FittedHypothesis> hypotheses_;
    std::vector<Entry> entries_;                    ///< in the order of out_.effects
    std::map<std::size_t, Localisation> residuals_; ///< by index into hypotheses_
};

/// All statistics are in units of the noise. Without a noise estimate the priors are the result.
void Procedure::reportUnknownNoise() {
    out_.statement =
        "The noise of the readings is not stated and cannot be estimated, because all readings of a run are "
        "equal or missing. State the noise (" +
        out_.channel + "_noise_std_" + out_.unit + "_approx), or record with a finer resolution.";
    out_.noise.source = "not stated, and cannot be estimated from equal readings";
    reportPriors();
}

/// The time limit is over before anything can be compared with the fit without an effect.
void Procedure::reportNoTime() {
    out_.statement = "The time limit ended the diagnosis before the fit without an effect and its screening were "
                     "complete. Nothing was compared. Allow more time with --time-limit; the simulations are kept.";
    out_.misfit = {};
    out_.screening.clear();
    out_.notTried = {"all effects of the catalogue"};
    reportPriors();
    noteNotTried();
}

void Procedure::noteNotTried() {
    if (out_.notTried.empty())
        return;
    std::string all;
    for (const std::string& what : out_.notTried)
        all += (all.empty() ? "" : "; ") + what;
    out_.notes.push_back("The time limit ended the search. Not tried: " + all + ".");
}

void Procedure::reportPriors() {
    out_.verdict = "inconclusive";
    out_.adequate = kPriorAdequate;
    out_.outsideCatalogue = kPriorOutsideCatalogue;
    out_.baselineTraining = out_.baselineHeldOut = out_.baselineChiSquaredPerReading =
        std::numeric_limits<double>::quiet_NaN();
    out_.improvedTraining = out_.improvedHeldOut = out_.baselineTraining;
}

bool Procedure::prepareBaseline() {
    if (!fitWith(out_.noise))
        return false;
    if (evaluator_.stopped() || data_.free || out_.noise.disturbance > 0.0)
        return true;
    std::vector<Eigen::VectorXd> left;
    for (std::size_t r = 0; r < data_.runs.size(); ++r)
        left.push_back(forceResidual(*likelihood_, r, baseline_.responses[r]));
    const PeriodicDisturbance disturbance = findDisturbanceInResidual(data_, left);
    return disturbance.period <= 0.0 || fitWith(estimateNoise(data_, disturbance, evaluator_.stop()));
}

bool Procedure::fitWith(const Noise& noise) {
    out_.noise = settings_.ablation.whitening ? noise.asWhite() : noise;
    BaselineFit found = fitBaseline(data_, evaluator_, out_.noise, settings_,
                                    [&](double fraction, const std::string& words) { stage(fraction, words); });
    noiseChiSquared_ = noiseChiSquaredBound(data_, out_.noise, settings_.seed);
    out_.failure = std::move(found.failure);
    likelihood_ = std::move(found.likelihood);
    baseline_ = std::move(found.fit);
    return out_.failure.empty();
}

void Procedure::locate() {
    if (evaluator_.stopped())
        return;
    grouping_ = groupingOf(*likelihood_);
    std::vector<const Eigen::VectorXd*> simulated;
    for (const ScreenedProbe& s : screened_)
        if (s.simulated && s.norm > 1e-6 && !candidates()[s.candidate].isNumber())
            simulated.push_back(&s.signature);
    Eigen::MatrixXd signatures(likelihood_->rows(), static_cast<Index>(simulated.size()));
    for (std::size_t i = 0; i < simulated.size(); ++i)
        signatures.col(static_cast<Index>(i)) = *simulated[i];
    out_.misfit = localise(*likelihood_, baseline_.residual, freeColumns(evaluator_.model(), baseline_), settings_.seed,
                           settings_.draws, signatures, evaluator_.stop());
}

void Procedure::tryHypotheses(bool first) {
    const SearchInput input{data_,           evaluator_,     settings_, *likelihood_,  grouping_,
                            baseline_,       baselineScore_, screened_, out_.misfit.p, out_.noise.excessKurtosis,
                            noiseChiSquared_};
    SearchResult found = search(input, [&](double fraction, const std::string& words) { stage(fraction, words); });
    if (!first && !found.notTried.empty())
        throw Stopped{}; // the whole search before is better than a part of this one
    hypotheses_ = std::move(found.hypotheses);
    out_.residualAfterBest = std::move(found.residualAfterBest);
    out_.notTried = std::move(found.notTried);
    if (first && found.elsewhere)
        attempt("the fit without an effect from the parameters of the best law", [&] { repeatFrom(*found.elsewhere); });
}

void Procedure::screenEffects() {
    screened_ = screen(evaluator_, *likelihood_, baseline_, settings_.probeShare());
}

void Procedure::summarise() {
    baselineScore_ = predictiveScoreOf(evaluator_, *likelihood_, grouping_, baseline_, settings_);
    out_.homogeneity = homogeneityOf(evaluator_.model(), *likelihood_, baseline_);
    out_.screening = presentScreening(candidates(), screened_, out_.misfit.critical);
}

const Localisation& Procedure::residualOf(std::size_t model) {
    const auto at = residuals_.find(model);
    return at != residuals_.end()
               ? at->second
               : residuals_
                     .emplace(model, localiseResidual(evaluator_, *likelihood_, hypotheses_[model].fit, settings_))
                     .first->second;
}

std::vector<RunForecast> Procedure::forecastsOfRuns(const PredictiveScore& score) const {
    return grouping_.forward ? forecastsOf(*likelihood_, grouping_, score, settings_.seed + 4)
                             : std::vector<RunForecast>();
}

bool Procedure::forecastHolds(const PredictiveScore& score) const {
    const std::vector<RunForecast> runs = forecastsOfRuns(score);
    return std::all_of(runs.begin(), runs.end(), [](const RunForecast& run) { return run.holds; });
}

void Procedure::computeWeights(ModelWeights& w) {
    std::vector<PredictiveScore> held;
    WeightingInput given;
    given.catalogue = out_.screening.size();
    for (const FittedHypothesis& t : hypotheses_) {
        held.push_back(t.held);
        given.mustBeat.push_back(t.mustBeat);
        given.outside.push_back(t.learned ? 1 : 0);
        given.atBound.push_back(
            !t.learned &&
            !amplitudesAtBound(evaluator_.model(), t.fit, std::max(1.0, chiSquaredPerReading(*likelihood_, t.fit)))
                 .empty());
        given.forecastFails.push_back(!forecastHolds(t.held));
        const HypothesisPrior prior = priorOf(candidates(), t, given.catalogue);
        given.prior.push_back(prior.weight);
        given.beside.push_back(prior.beside ? 1 : 0);
    }
    given.p = out_.misfit.extendedP;
    given.excessKurtosis = out_.noise.excessKurtosis;
    given.noiseChiSquared = noiseChiSquared_;
    const double disturbance = out_.noise.disturbance, noise = out_.noise.total(), left = baselineScore_.forceRmse;
    given.periodicDisturbance = disturbance > 0.0 && 0.5 * disturbance * disturbance >
                                                         0.5 * (left * left - noise * noise); // mean squared values
    given.seed = settings_.seed + 1;
    // The residual of a component decides whether a second effect is needed; that of the best one whether it is
    // believed.
    given.largestZ.assign(hypotheses_.size(), 0.0);
    for (const FittedHypothesis& t : hypotheses_)
        for (const std::size_t part : t.learned ? std::vector<std::size_t>{} : t.mustBeat)
            if (!evaluator_.stopped())
                given.largestZ[part] = largestResidualZ(residualOf(part));
    w = modelWeights(baselineScore_, held, given);
    if (!hypotheses_.empty() && !evaluator_.stopped()) {
        given.residualP = residualOf(w.best).extendedP;
        w = modelWeights(baselineScore_, held, given);
    }
    if (settings_.ablation.openSet)
        removeOutsideCatalogue(w);
}

/// Intervals by cost: the first effect and probable ones get careful derivatives, those above 0.3 with a significant
/// misfit get profiles.
ParameterIntervals Procedure::intervalsOf(const Entry& entry) {
    FittedHypothesis& hypotheses = hypotheses_[entry.model];
    const FitResult& f = hypotheses.fit;
    const bool worth = &entry == &entries_.front() || entry.probability >= 0.05;
    if (!worth || evaluator_.stopped())
        return {linearIntervals(*likelihood_, evaluator_.model(), f, f.jacobian), {}};
    ParameterIntervals out;
    const FittedHypothesis kept = hypotheses;
    const bool careful = evaluator_.stop().attempt([&] {
        const IntervalSearch input{evaluator_, *likelihood_,   grouping_,           settings_,
                                   screened_,  baselineScore_, baseline_.chiSquared};
        const bool profiles = entry.probability >= 0.3 && out_.misfit.p <= kFamilyWise;
        out = carefulIntervals(input, profiles, hypotheses);
    });
    if (careful)
        return out;
    hypotheses = kept;
    out_.notTried.push_back("profiles of " + plainWords(entry.label));
    return {linearIntervals(*likelihood_, evaluator_.model(), f, f.jacobian), {}};
}

void Procedure::conclude() {
    stage(0.92, "model weights");
    ModelWeights w;
    computeWeights(w);
    std::vector<std::string> fitted;
    for (const FittedHypothesis& t : hypotheses_)
        for (const std::size_t c : t.candidates)
            fitted.push_back(candidates()[c].label);
    out_.adequate = splitUndetectable(w.adequate, fitted, out_.screening);
    const Ranking ranking(evaluator_.model(), *likelihood_, hypotheses_, w);
    out_.learned = ranking.learned();
    entries_ = ranking.entries();
    out_.outsideCatalogue = w.outsideCatalogue;
    for (const LearnedLaw& law : out_.learned)
        out_.outsideCatalogue += law.probability;
    std::map<std::size_t, ParameterIntervals> intervals; // by model
    for (const Entry& entry : entries_) {
        if (intervals.count(entry.model) == 0)
            intervals[entry.model] = intervalsOf(entry);
        FittedEffect f = presentEffect(evaluator_.model(), *likelihood_, grouping_, hypotheses_[entry.model],
                                       entry.term, intervals[entry.model], baseline_.chiSquared);
        f.probability = std::min(1.0, entry.probability);
        f.gain = w.gain[entry.model];
        f.gainError = w.gainError[entry.model];
        out_.effects.push_back(std::move(f));
    }
    Evidence e;
    e.p = out_.misfit.p;
    e.adequate = w.adequate; // detectable effects only
    e.outsideCatalogue = out_.outsideCatalogue;
    e.any = !entries_.empty();
    e.searched = std::none_of(out_.notTried.begin(), out_.notTried.end(),
                              [](const std::string& what) { return what.rfind("the effect ", 0) == 0; });
    for (std::size_t a = 0; a < entries_.size(); ++a)
        out_.effects[a].confoundedWith = ranking.groupOf(entries_, a, out_.effects[a].jointWith);
    if (e.any) {
        const FittedEffect& first = out_.effects.front();
        e.groupProbability = ranking.probabilityOf(first.confoundedWith);
        e.numbersOnly = ranking.allCorrect(first.confoundedWith) && ranking.allCorrect(first.jointWith);
        e.numbers = ranking.anyCorrects(first.confoundedWith) || ranking.anyCorrects(first.jointWith);
    }
    summariseEvidence(w, e);
    out_.verdict = verdictOf(e);
    out_.wrongNumber = isWrongNumber(e);
    out_.improved = out_.improved && out_.verdict != "adequate"; // the nearest effect would mislead
    if (!out_.improved) {                                        // errors and intervals are those of the baseline
        out_.improvedTraining = out_.baselineTraining;
        out_.improvedHeldOut = out_.baselineHeldOut;
        out_.improvement = 0.0;
        out_.improvementCi = {};
    }
    present();
    evaluator_.stop().attempt([&] { addStatedBand(evaluator_, *likelihood_, out_.runs); });
    if (out_.misfit.p <= kFamilyWise && !data_.free &&
        !evaluator_.stop().attempt([&] { out_.validity = rangesOfValidity(evaluator_, *likelihood_, settings_.seed); }))
        out_.notTried.push_back("the range of validity without an effect");
    if (!evaluator_.stop().attempt([&] { proposeNextExperiment(); }))
        out_.notTried.push_back("the choice of a next experiment");
    out_.statement = statementOf(out_, e);
}

void Procedure::summariseEvidence(const ModelWeights& w, Evidence& e) {
    out_.baselineTraining = forceRmse(*likelihood_, baseline_.responses);
    out_.baselineHeldOut = baselineScore_.forceRmse;
    out_.baselineChiSquaredPerReading = chiSquaredPerReading(*likelihood_, baseline_);
    if (e.any) {
        const std::size_t first = entries_.front().model; // shown in the figures
        const FittedHypothesis& best = hypotheses_[first];
        e.gain = w.gain[first];
        e.gainLow = w.gainLow[first];
        out_.improved = true;
        out_.improvedTraining = forceRmse(*likelihood_, best.fit.responses);
        out_.improvedHeldOut = best.held.forceRmse;
        improvementOf(baselineScore_, best.held, settings_.seed + 3, out_.improvement, out_.improvementCi);
        out_.residualAfterBest = residualOf(first);
    }
    const PredictiveScore& shown = e.any ? hypotheses_[entries_.front().model].held : baselineScore_;
    out_.forecast = {forecastsOfRuns(e.adequate >= 0.5 ? baselineScore_ : shown), shown.folds, shown.substituted,
                     shown.nonlinear};
    e.forecastHolds = std::all_of(out_.forecast.runs.begin(), out_.forecast.runs.end(),
                                  [](const RunForecast& run) { return run.holds; });
    e.undetectable = undetectableShare(out_.screening);
}

void Procedure::proposeNextExperiment() {
    // If every catalogue effect is rejected, no run that discriminates two of them says what acts.
    const bool open = out_.verdict == "ambiguous" || out_.verdict == "inconclusive" ||
                      (out_.verdict == "identified" && (out_.effects.front().confoundedWith.size() > 1 ||
                                                        hypotheses_[entries_.front().model].mirrorImage.has_value()));
    if (!open || out_.wrongNumber || !settings_.nextExperiment || evaluator_.model().candidateRuns().empty())
        return;
    stage(0.96, "next experiment");
    std::vector<ReportedEffect> named;
    const std::vector<std::string> group =
        out_.effects.empty() ? std::vector<std::string>() : out_.effects.front().confoundedWith;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const std::string& label = out_.effects[i].label;
        named.push_back({label, entries_[i].probability, &hypotheses_[entries_[i].model],
                         std::find(group.begin(), group.end(), label) != group.end()});
    }
    const std::vector<CompetingHypothesis> competing =
        competingHypotheses(evaluator_, *likelihood_, baseline_, named, screened_, out_.adequate + out_.undetectable());
    out_.next = nextExperiment(evaluator_, competing, out_.noise, data_.zeroWindow);
    if (!out_.next && competing.size() > 1 && !evaluator_.stopped())
        out_.candidateRunsConsidered = evaluator_.model().candidateRuns().size();
}

void Procedure::present() {
    out_.baseline = baseline_.point;
    out_.nominal = presentNominal(evaluator_.model(), baseline_);
    out_.batch = presentBatch(evaluator_.model(), *likelihood_,
                              out_.improved ? hypotheses_[entries_.front().model].fit : baseline_);
    for (const std::string& note : specimenNotes(out_.batch))
        out_.notes.push_back(note);
    std::vector<const FitResult*> shown;
    for (const Entry& entry : entries_) {
        out_.similarityLabels.push_back(entry.label);
        shown.push_back(&hypotheses_[entry.model].fit);
    }
    out_.similarity = presentSimilarity(*likelihood_, baseline_, shown);
    out_.runs =
        presentCurves(*likelihood_, baseline_, out_.improved ? &hypotheses_[entries_.front().model].fit : nullptr);
    out_.further =
        furtherErrorsOf(*likelihood_, baseline_, out_.improved ? &hypotheses_[entries_.front().model].fit : nullptr);
    if (out_.misfit.p <= kFamilyWise && out_.misfit.significant.empty())
        out_.misfit.significant = windowsOfEffect(data_, out_.runs, out_.misfit);
}

} // namespace

Diagnosis diagnose(const RecordedData& data, Evaluator& evaluator, const DiagnosisSettings& settings) {
    return Procedure(data, evaluator, settings).run();
}

} // namespace supercircle::diagnosis
