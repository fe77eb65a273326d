#pragma once
// Result of a diagnosis as plain data. The JSON file and the page are written from it.

#include "plugin/identification/diagnosis/localisation/localise.h"
#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/diagnosis/noise.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

struct Interval {
    double low = 0.0, high = 0.0;
    bool signAmbiguous = false;     ///< the runs do not resolve the sign; it contains the mirror image (local_minima.h)
    double smallestMagnitude = 0.0; ///< smallest magnitude for an ambiguous sign; values nearer to 0 are excluded
};

struct FittedParameter {
    std::string name, unit;
    double value = 0.0;
    Interval ci90;
    std::string identifiedOnlyBy = {}; ///< the run, cycle or fifth without which it is unknown; empty: none
    std::string about = {};            ///< meaning (Scalar::about)
};

/// An effect fitted to all runs.
struct FittedEffect {
    std::string label, slot, variant, law;
    double probability = 0.0;
    std::vector<std::string> confoundedWith; ///< labels that these runs cannot distinguish from it, itself first
    std::vector<std::string> jointWith;      ///< labels of the other effects of its best hypothesis
    /// Names of amplitudes at the end of their plausible range (amplitudesAtBound()).
    std::vector<std::string> atBound;
    std::vector<FittedParameter> parameters;
    std::vector<FittedParameter> derived; ///< derived quantities (CandidateEffect::derived)
    double gain = 0.0, gainError = 0.0;   ///< gain in held-out log score over the baseline, and its standard error
    double trainingRmse = 0.0, heldOutRmse = 0.0; ///< N
    double deltaChiSquared = 0.0;                 ///< decrease of chi-squared against the baseline, training
    double chiSquaredPerReading = 0.0;            ///< mean squared residual, training
    int starts = 0, startsAgreed = 0; ///< fits of free runs from different starts, and those that found this minimum
    ParameterPoint point{};           ///< of its hypothesis
};

/// Screening result of a label.
struct ScreenedEffect {
    std::string label;
    double gain = 0.0;             ///< decrease of chi-squared by its best probe, linearised
    double absorbedFraction = 0.0; ///< fraction of its signature that nominal parameters explain
    double detectable = 0.0;       ///< amplitude detectable with 80 % power, in relevant amplitudes
    double signatureNorm = 0.0;    ///< norm of the signature of a relevant amplitude, sigma
    double undetectable = 0.0;     ///< probability that it acts and is too small to be detected
};

/// A learned law at 41 values of its state.
struct LearnedLaw {
    std::string label, slot, law, description;
    std::string response, responseUnit, state, stateUnit; ///< names and units
    bool logarithmic = false;                             ///< logarithmic scale of the state
    std::vector<double> states, value, sigma;
    std::vector<bool> inStateRange;         ///< whether the runs determine the law there
    double change = 0.0, changeSigma = 0.0; ///< change across that range, and its standard deviation
    double probability = 0.0, gain = 0.0, gainError = 0.0;
    double heldOutRmse = 0.0; ///< N
    ParameterPoint point{};
};

struct NominalResult {
    std::string name, unit;
    double stated = 0.0, uncertainty = 0.0, fitted = 0.0;
    double standardisedShift = 0.0; ///< (fitted - stated) / half-width
    std::string prior{};            ///< normal or log_normal; empty: an interval
};

/// A parameter that differs between specimens.
struct BatchResult {
    std::string name, unit;
    std::vector<std::string> merged; ///< parameters whose deviations cannot be told from its own
    double common = 0.0;             ///< fitted value
    double scale = 0.0;              ///< stated, of the standard deviation
    double std = 0.0;                ///< standard deviation between specimens, median
    Interval ci90{};                 ///< of it
    bool isPrior = false;            ///< fewer than three specimens: only what was stated
    double evidence = 0.0;           ///< log Bayes factor over equal specimens
    std::vector<std::pair<std::string, double>> specimens{}; ///< ids and fitted values
};

struct FurtherRun {
    CandidateRun candidateRun;
    std::size_t repeats = 1; ///< number of repeats
};

struct NextExperiment {
    std::vector<FurtherRun> runs;           ///< all of them are to be made; one kind or two
    std::vector<std::string> discriminates; ///< labels
    bool resolvesSign = false;              ///< it resolves the sign of the first of them
    double power = 0.0;
    bool expectedConclusive = false; ///< expected to be conclusive; otherwise the best of those considered
};

/// An interval of time of a run, s.
struct TimeInterval {
    double from = 0.0, to = 0.0;
};

/// Residual of one coordinate of one marker, or of a further channel.
struct MarkerCurve {
    std::string channel;                            ///< "M1_x", as in windows
    bool ofMarker = true;                           ///< in rows of `markerTime`; else of `time`
    double arcFraction = -1.0;                      ///< -1: the marker is on a body
    std::vector<double> residual, residualImproved; ///< whitened; improved empty: none
    std::vector<bool> counts;
};

/// Curves for figures.
struct RunCurves {
    std::string name;
    std::vector<double> time, displacement, recorded; ///< s, m, N
    std::vector<double> baseline, improved;           ///< N; improved empty: none
    std::vector<double> statedLow, statedHigh;        ///< N, of the stated intervals; empty: free runs
    std::vector<double> residual, residualImproved;   ///< whitened; 0 where missing
    std::vector<bool> counts;
    std::vector<double> markerTime; ///< s
    std::vector<MarkerCurve> markers;
    /// Intervals in which the most probable effect is visible in the reading, beyond nominal parameters.
    std::vector<TimeInterval> visibleIntervals;
};

/// Errors of a further channel, in its unit, in rows that count.
struct ChannelError {
    std::string name, unit;
    double noise = 0.0;                    ///< standard deviation
    double baseline = 0.0, improved = 0.0; ///< root mean square; improved 0: there is none
};

struct Homogeneity {
    double q = 0.0, p = 1.0;      ///< chi-squared of single-run parameters about the common fit, and its p-value
    double degrees = 0.0;         ///< degrees of freedom
    std::string number{}, unit{}; ///< parameter that explains most with a value of its own in each run; if they differ
    std::vector<std::pair<std::string, double>> values{}; ///< of it, by runs
    [[nodiscard]] bool differ() const { return degrees > 0.0 && p < 0.01; }
    /// Root mean square shift of single-run parameters from the common fit, sigma; 0 of a single run.
    [[nodiscard]] double shift() const { return degrees > 0.0 ? std::sqrt(q / degrees) : 0.0; }
};

/// How far a driven run is explained without an effect inside the stated intervals (localisation/validity.h).
struct ValidRange {
    struct Place {
        double time = 0.0;  ///< s
        double drive = 0.0; ///< displacement, m, or load
        Phase phase = Phase::Hold;
    };
    std::string run;
    bool known = false;           ///< it can be simulated with the stated numbers
    bool whole = false;           ///< all of it is explained
    Place until;                  ///< end of the longest beginning that is
    Place departs;                ///< where it most probably begins to depart; not if `whole`
    Place departsFrom, departsTo; ///< 90 % interval
};

/// Forecasts of a free run from its beginning.
struct RunForecast {
    std::string run;
    double squares = 0.0; ///< standardised squared error a row
    double atLeast = 0.0; ///< its lower bound with 95 %
    bool holds = true;
};

/// Held-out errors of a hypothesis as forecasts.
struct Forecast {
    std::vector<RunForecast> runs; ///< of free runs; else empty
    int of = 0;                    ///< number of forecasts
    int substituted = 0;           ///< where the fit to all readings stands in for a forecast
    int nonlinear = 0;             ///< where the error is not that of a linear forecast
};

struct Diagnosis {
    /// Probability of an effect too small to be detected, all labels together.
    [[nodiscard]] double undetectable() const {
        double sum = 0.0;
        for (const ScreenedEffect& s : screening)
            sum += s.undetectable;
        return sum;
    }
    std::string channel = "force", unit = "N";    ///< channel and unit of everything given in N below
    std::optional<experiment::DriveAxis> drive{}; ///< empty: nothing is driven
    bool table = false;                           ///< runs are points read at rest; their clock is made up
    std::string failure;                          ///< why the experiment cannot be simulated; empty: it can
    bool stopped = false;                         ///< interrupted; simulations are kept
    std::vector<std::string> notTried;            ///< what the time limit has left out, in words
    std::string verdict, statement;
    Noise noise;
    Localisation misfit, residualAfterBest; ///< of the baseline; of the best hypothesis
    std::vector<FittedEffect> effects;      ///< most probable first
    std::vector<ScreenedEffect> screening;  ///< of the whole catalogue
    std::vector<LearnedLaw> learned;        ///< best first
    double adequate = 0.0, outsideCatalogue = 0.0;
    double baselineTraining = 0.0, baselineHeldOut = 0.0, improvedTraining = 0.0, improvedHeldOut = 0.0; ///< N
    bool wrongNumber = false; ///< a stated number is wrong, and nothing else is shown to be missing
    bool improved = false;    ///< whether the last two belong to an effect; otherwise to the baseline
    Forecast forecast;        ///< of the same hypothesis
    double improvement = 0.0;
    Interval improvementCi{};
    double baselineChiSquaredPerReading = 0.0; ///< mean squared residual of the baseline
    ParameterPoint baseline;                   ///< fitted, without an effect
    std::vector<NominalResult> nominal;
    std::vector<BatchResult> batch; ///< of the best hypothesis
    Homogeneity homogeneity;
    std::vector<ValidRange> validity; ///< of driven runs with a significant misfit
    std::optional<NextExperiment> next;
    std::size_t candidateRunsConsidered =
        0; ///< number of candidate runs considered if none discriminates; 0: not considered, or one does
    std::vector<std::string> similarityLabels;
    std::vector<std::vector<double>> similarity; ///< cosines between the fitted effects' signatures
    std::vector<RunCurves> runs;
    std::vector<ChannelError> further; ///< channels beside `channel`
    std::vector<std::string> notes;
    std::uint64_t seed = 1;
    double elapsed = 0.0;    ///< s
    double cpuSeconds = 0.0; ///< s, of all threads of the program
    std::size_t forwardRuns = 0;
};

/// Slot of a stated number among the effects (CandidateEffect::number).
inline constexpr const char* kDescription = "description";

/// A label as words: "planar drag".
std::string plainWords(std::string label);

/// A verdict as a sentence: "The simulation is adequate".
std::string verdictTitle(const std::string& verdict);
/// That of a diagnosis, which may also be "A stated number is wrong".
std::string titleOf(const Diagnosis& diagnosis);

/// p-value of a screening gain: chi-squared with one degree of freedom, of one probe, not corrected for the search.
double screeningP(const ScreenedEffect& effect);

} // namespace supercircle::diagnosis
