#pragma once
// Physical parameters of a replay, nominal unless set otherwise, accessible by name for command lines and fits.

#include "plugin/recording/experiment/experiment.h"
#include "supercircle/effects/effect.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::replay {

struct SpecimenParameters {
    double bendingModulus = 0.0;   ///< N m^2
    double naturalCurvature = 0.0; ///< 1/m
    double thickness = 0.0;        ///< m
    double linearMass = 0.0;       ///< kg/m
};

/// A parameter of a free scene, common to all runs, of one specimen, or the initial state of one run.
struct SceneValue {
    std::string name;
    int run = -1;       ///< -1: all
    double value = 0.0; ///< of a specimen not a number: the common one
    int specimen = -1;  ///< -1: all
};

/// Whether a value holds in a run. Later ones of Parameters::scene replace earlier ones.
bool holdsIn(const SceneValue& value, const experiment::Experiment& experiment, std::size_t run);

struct Parameters {
    std::vector<SpecimenParameters> specimens; ///< in the order of Experiment::specimens
    double friction = 0.0;                     ///< 1, coefficient of all contacts
    double gapShift = 0.0; ///< m, the crosshead stands this much higher at displacement 0 than stated
    Point gravity{};       ///< m/s^2
    /// Where contact forces act on the section, as a share of half the thickness: 1 surface (a sticking round end
    /// rolls, friction has the arm h/2), 0 centre line. The gap is the same.
    double contactArm = 0.0;
    /// Compliance in series with the specimen, m/N: the crosshead moves this much less per newton of force.
    double seriesCompliance = 0.0;
    /// Compliance of each contact, m/N, with the axial compliance L / EA of a strip pressed lengthwise (the nominal
    /// value). Without it an inextensible strip would meet a rigid floor in an impact and its tip would slip. A machine
    /// compliance does not help there, because its crosshead cannot follow within a millisecond.
    double touchCompliance = 0.0;
    std::vector<SceneValue> scene;         ///< free scenes: as described, common parameters first
    double readingZero = 0.0;              ///< rad or m, free scenes: the reading at pose zero
    std::vector<double> furtherZero;       ///< the same of channels beside the first one
    std::vector<effects::Setting> effects; ///< effects; specimens are named by their ids
};

/// A parameter and its description.
struct ParameterInfo {
    std::string name;
    std::string unit;
    std::string about;
    experiment::Stated stated; ///< nominal value and half-width of its interval (0: exact)
    int specimen = -1;         ///< scenes: of one specimen
    bool ofBatch = false;      ///< deviates from the common value, if it is set (BatchParameter)
    bool ofRecording = false;  ///< of one run, or the zero of a reading; else of the set-up or its specimens
    int run = -1;              ///< scenes: of one run
};

/// The nominal parameters of an experiment.
Parameters nominal(const experiment::Experiment& experiment);

/// All names: shared ones ("friction", "bending_modulus", ...) that set all specimens at once, and with several
/// specimens one each ("bending_modulus.B"). The stated interval of a shared name is the first specimen's. Free scenes
/// have the parameters of their description, those of specimen B as "NAME.B", those of run 2 as "NAME_run2", and
/// "reading_zero", of a further channel "reading_zero.NAME".
std::vector<ParameterInfo> parameterList(const experiment::Experiment& experiment);

/// Sets a parameter by name, "KEY:NAME" for one of an effect, which is added. Returns an error text or nothing: unknown
/// name with the nearest known one, or value out of range.
[[nodiscard]] std::string set(Parameters& parameters, const experiment::Experiment& experiment, const std::string& name,
                              double value);

/// Number of parameters with an interval: what a fit without effects may choose.
std::size_t freeNumbers(const experiment::Experiment& experiment);

/// Whether an effect has something to act on in this experiment.
/// @param channel of a sensor; 0: the first one
bool acts(const experiment::Experiment& experiment, effects::Key key, std::size_t channel = 0);

/// Error text for effects that exclude each other or this experiment, or nothing.
[[nodiscard]] std::string checkEffects(const Parameters& parameters, const experiment::Experiment& experiment);

/// Value by name (of the first specimen for shared names); empty: no such name.
[[nodiscard]] std::optional<double> get(const Parameters& parameters, const experiment::Experiment& experiment,
                                        const std::string& name);

} // namespace supercircle::replay
