#pragma once
// What a diagnosis found, as plain data. The JSON file and the page are written from it.

#include "plugin/identification/diagnosis/localisation/localise.h"
#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/diagnosis/noise.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

struct Interval {
    double low = 0.0, high = 0.0;
    bool eitherSide = false; ///< it holds the mirror image, too: the runs do not tell to which side (hollows.h)
    double least = 0.0;      ///< then the smallest size to either side; what is nearer to 0 is not held
};

struct FittedParameter {
    std::string name, unit;
    double value = 0.0;
    Interval ci90;
    std::string only = {}; ///< the run, cycle or fifth without which nothing is known of it (HeldOut::only), else empty
    std::string about = {}; ///< what it is, in words (Scalar::about)
};

/// An effect that was fitted to all runs.
struct FoundEffect {
    std::string label, slot, form, law;
    double probability = 0.0;
    std::vector<std::string> group; ///< labels that these runs cannot tell from it, itself first
    std::vector<std::string> with;  ///< labels that act beside it in its best model
    /// Names of its sizes that lie at the end of what is plausible while the runs want more (pressedAmplitudes()).
    std::vector<std::string> pressed;
    std::vector<FittedParameter> parameters;
    std::vector<FittedParameter> products;        ///< what the law is worth in all (Candidate::products)
    double gain = 0.0, gainError = 0.0;           ///< held-out log score over "nothing"
    double trainingRmse = 0.0, heldOutRmse = 0.0; ///< N
    double misfitPerRow = 0.0;                    ///< chi^2 / rows, training
};

/// What the screen saw of a label.
struct SeenEffect {
    std::string label;
    double gain = 0.0;     ///< misfit that its best probe explains
    double absorbed = 0.0; ///< share of its signature that the nominal parameters can imitate
    double visible = 0.0;  ///< smallest size seen with 80 % power, in units of a size that matters
    double reading = 0.0;  ///< |signature| of a size that matters, noise units
    double unseen = 0.0;   ///< probability that it is there and too small to be seen (shareUnseen())
};

/// A law that was learned, at 41 places of its state.
struct LearnedLaw {
    std::string label, slot, law, words;
    std::string of, ofUnit, over, overUnit; ///< what changes with what
    bool logarithmic = false;               ///< in the state
    std::vector<double> at, value, deviation;
    std::vector<bool> visited;                  ///< elsewhere the runs say nothing
    double change = 0.0, changeDeviation = 0.0; ///< from one end of what was visited to the other
    double probability = 0.0, gain = 0.0, gainError = 0.0;
    double heldOutRmse = 0.0; ///< N
};

struct NominalResult {
    std::string name, unit;
    double stated = 0.0, uncertainty = 0.0, fitted = 0.0;
    double tension = 0.0; ///< (fitted - stated) / half-width
};

struct FurtherRun {
    Design design;
    std::size_t repeats = 1; ///< how often to make it
};

struct NextExperiment {
    std::vector<FurtherRun> runs;       ///< all of them are to be made; one, or two of different kinds
    std::vector<std::string> separates; ///< labels
    bool side = false;                  ///< it tells to which side the first of them acts
    double power = 0.0;
    bool settles = false; ///< they are expected to tell them apart beyond doubt; else they are what tells most
};

/// A stretch of time of a run, s.
struct Stretch {
    double from = 0.0, to = 0.0;
};

/// What is left of one coordinate of one marker, in rows of its run's `markerTime`.
struct MarkerCurve {
    std::string channel;                            ///< "M1_x", as in windows
    double arcFraction = -1.0;                      ///< -1: its body has none
    std::vector<double> residual, residualImproved; ///< whitened; improved empty: none
    std::vector<bool> counts;
};

/// Curves for pictures.
struct RunCurves {
    std::string name;
    std::vector<double> time, displacement, recorded; ///< s, m, N
    std::vector<double> baseline, improved;           ///< N; improved empty: none
    std::vector<double> residual, residualImproved;   ///< whitened; 0 where missing
    std::vector<bool> counts;
    std::vector<double> markerTime; ///< s
    std::vector<MarkerCurve> markers;
    /// Where the most probable effect shows in the reading, beyond what nominal parameters can imitate.
    std::vector<Stretch> shows;
};

struct Homogeneity {
    double q = 0.0, p = 1.0; ///< chi^2 of the parameters of single runs around the common fit
    double degrees = 0.0;
};

struct Diagnosis {
    /// Probability that an effect is there which is too small for these runs, of all together; beside `nothing`.
    [[nodiscard]] double unseen() const {
        double sum = 0.0;
        for (const SeenEffect& s : seen)
            sum += s.unseen;
        return sum;
    }
    std::string channel = "force", unit = "N";                ///< of everything that is said to be in N below
    [[nodiscard]] bool driven() const { return unit == "N"; } ///< else bodies move freely, and poses are read
    std::string failure;                                      ///< the experiment cannot be simulated: why
    bool stopped = false;                                     ///< interrupted; what was simulated is kept
    std::string verdict, statement;
    Noise noise;
    Localisation mismatch, left;      ///< of the nominal fit; of the best effect's
    std::vector<FoundEffect> effects; ///< most probable first
    std::vector<SeenEffect> seen;     ///< whole catalogue
    std::vector<LearnedLaw> learned;  ///< best first
    double nothing = 0.0, unknown = 0.0;
    double baselineTraining = 0.0, baselineHeldOut = 0.0, improvedTraining = 0.0, improvedHeldOut = 0.0; ///< N
    bool improved = false; ///< whether the last two are an effect's; else they are those of the simulation as it is
    double improvement = 0.0;
    Interval improvementCi{};
    double baselinePerRow = 0.0; ///< chi^2 / rows
    std::vector<NominalResult> nominal;
    Homogeneity homogeneity;
    std::optional<NextExperiment> next;
    std::size_t nextTried =
        0; ///< further runs that were looked at, none of which would tell; 0: none was, or one would
    std::vector<std::string> similarityLabels;
    std::vector<std::vector<double>> similarity; ///< cosines of the fitted effects' signatures
    std::vector<RunCurves> runs;
    std::vector<std::string> notes;
    std::uint64_t seed = 1;
    double elapsed = 0.0; ///< s
    std::size_t forwardRuns = 0;
};

/// A label as words: "planar drag".
std::string plainWords(std::string label);

} // namespace supercircle::diagnosis
