#pragma once
// The fits of a diagnosis in the parameters of a replay, as diagnosis.json keeps them. A replay repeats one to its
// drawn curve, or carries its law to another specimen.

#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/result.h"
#include "supercircle/support/result.h"

#include <string>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

/// What the scales of a law depend on; 0: not known.
struct Section {
    double thickness = 0.0;      ///< m
    double width = 0.0;          ///< m
    double bendingModulus = 0.0; ///< N m^2
};

struct StoredFit {
    std::string label;                                      ///< of an effect, or kNothing
    bool drawn = false;                                     ///< the pictures show it
    std::vector<std::pair<std::string, double>> parameters; ///< fitted values, in the order in which they are set
    std::vector<effects::Setting> effects;
    Section section;          ///< of the first specimen, as fitted
    std::string unrepeatable; ///< why a replay cannot repeat it; empty: it can
};

inline constexpr const char* kNothing = "nothing"; ///< label of the fit without an effect

struct StoredFits {
    std::string checkSum; ///< of the experiment (checkSumOf)
    std::vector<StoredFit> fits;
};

/// All effects and learned laws of the result, most probable first, and last the fit without any.
StoredFits storedFitsOf(const ReplayModel& model, const experiment::Experiment& experiment, const Diagnosis& diagnosis);

/// Parameters and effects as a fit, without a label.
StoredFit storedFit(const experiment::Experiment& experiment, const replay::Parameters& parameters);

/// Check sum of description, scene and runs, as text.
std::string checkSumOf(const experiment::Experiment& experiment);

/// The section of the first specimen; all 0 of rigid bodies.
Section sectionOf(const experiment::Experiment& experiment, const replay::Parameters& parameters);

/// Effects as for --effect: "KEY:NAME=VALUE" with all digits.
std::vector<std::string> assignmentsOf(const std::vector<effects::Setting>& effects);
/// The reverse; returns what is wrong.
[[nodiscard]] std::string readAssignments(const std::vector<std::string>& texts, std::vector<effects::Setting>& out);

/// The fit called `label`; without a label the drawn one.
Result<StoredFit> fitCalled(const StoredFits& fits, const std::string& label);

/// Sets parameters and effects of a fit to the same experiment; or what is wrong.
[[nodiscard]] std::string setTo(const StoredFit& fit, const experiment::Experiment& experiment,
                                replay::Parameters& parameters);

/// The law of a fit, for another specimen.
struct CarriedLaw {
    std::vector<effects::Setting> effects;
    std::vector<std::string> notes; ///< what was restated or left as it is, in words
};

/// Restates the law of a fit for another section of the same material: M / (w t^2) is one function of the curvature
/// times t. Curvatures go with 1/t, forces per length with w, compliances of contacts with 1/w; times, shares and laws
/// of friction, machine and sensor do not change. Defects of one specimen are not carried.
Result<CarriedLaw> carriedTo(const Section& section, const StoredFit& fit);

} // namespace supercircle::diagnosis
