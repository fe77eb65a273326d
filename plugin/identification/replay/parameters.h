#pragma once
// The physical numbers of a replay: the experiment's nominal ones unless set otherwise, reachable by name for command
// lines and fits.

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

/// A parameter of a free scene: of all runs, or how one of them was let go.
struct SceneValue {
    std::string name;
    int run = -1; ///< -1: all
    double value = 0.0;
};

struct Parameters {
    std::vector<SpecimenParameters> specimens; ///< as Experiment::specimens
    double friction = 0.0;                     ///< coefficient of all contacts, 1
    double gapShift = 0.0;                     ///< the head stands this much higher at displacement 0 than stated, m
    Point gravity{};                           ///< m/s^2
    /// Where on the section the force of a rigid obstacle attacks, as a share of half the thickness: 1 is the surface
    /// (a sticking round end rolls, friction has the arm h/2), 0 the centre line. The gap is the same.
    double contactArm = 0.0;
    /// Give of everything in series with the specimen, m/N: the head goes this much less far per newton of force.
    double seriesCompliance = 0.0;
    /// Give of each touch, m/N. The rods are inextensible, so the stretch L / EA of a strip pressed lengthwise stands
    /// here (the nominal value): without it meeting the floor is an impact of rigid on inextensible, whose bounce lets
    /// the tip slip. A machine's give is no help there, its head is too heavy to follow within a millisecond.
    double touchCompliance = 0.0;
    std::vector<SceneValue> scene;         ///< free scenes: as described, those of all runs first
    double readingZero = 0.0;              ///< free scenes: the reading where the scene says 0, rad or m
    std::vector<effects::Setting> effects; ///< extra physics; specimens go by their ids
};

/// What a name stands for.
struct ParameterInfo {
    std::string name;
    std::string unit;
    std::string about;
    experiment::Stated stated; ///< nominal value and half-width of its interval (0: taken as exact)
};

/// The nominal parameters of an experiment.
Parameters nominal(const experiment::Experiment& experiment);

/// All names: shared ones ("friction", "bending_modulus", ...: all specimens at once) and, where there are several
/// specimens, one per specimen ("bending_modulus.B"). The stated interval of a shared name is the first specimen's.
/// Free scenes have the parameters their description names, those of run 2 as "NAME_run2", and "reading_zero".
std::vector<ParameterInfo> parameterList(const experiment::Experiment& experiment);

/// Sets a parameter by name, "KEY:NAME" for one of an effect's (which comes into being with it); empty, or why not
/// (unknown name with the nearest known one, value out of physical range).
std::string set(Parameters& parameters, const experiment::Experiment& experiment, const std::string& name,
                double value);

/// Whether an effect has something to act on in this experiment.
bool acts(const experiment::Experiment& experiment, effects::Key key);

/// Empty, or which effects do not go together or with this experiment.
std::string checkEffects(const Parameters& parameters, const experiment::Experiment& experiment);

/// Value by name (of the first specimen for shared names); empty: no such name.
std::optional<double> get(const Parameters& parameters, const experiment::Experiment& experiment,
                          const std::string& name);

} // namespace supercircle::replay
