#pragma once
// A law that the user writes down, as an effect: --effect NAME:FORMULA.
//
// | names in the formula | law | acts as |
// | mu, v | friction coefficient at a speed of sliding, m/s | rate_dependent_friction, law table |
// | mu, s | friction coefficient after a slip, m | wear, law table |
// | B, u | bending moment at a curvature change, 1/m | nonlinear_elasticity, law table |
//
// All other names are parameters of the law. The formula becomes a cubic spline over the range of the experiment, since
// the simulator knows no formulas.

#include "plugin/identification/replay/parameters.h"
#include "plugin/scene/loader/formula.h"
#include "supercircle/support/result.h"

#include <atomic>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

enum class OwnLawKind : std::uint8_t { FrictionOfSpeed, FrictionOfSlip, Moment };

struct OwnLaw {
    std::string name;
    scene::Formula formula;
    OwnLawKind kind = OwnLawKind::FrictionOfSpeed;
    std::vector<std::string> parameters; ///< names that need values
};

/// Where the table of a law lies.
struct OwnLawRange {
    double speed = 1e-3; ///< m/s, middle of six decades
    double slip = 0.1;   ///< m, from 0
    double bend = 100.0; ///< 1/m, from 0
};
/// Reads a law. Fails with what is wrong and what is expected.
Result<OwnLaw> readOwnLaw(const std::string& name, const std::string& formula);

/// The setting of the catalogue that acts as the law does; `values` in the order of OwnLaw::parameters. Fails where the
/// law has no value, or falls too far: a friction coefficient below a hundredth of the declared one, a moment that
/// falls with curvature.
Result<effects::Setting> settingOf(const OwnLaw& law, const std::vector<double>& values, const OwnLawRange& range);

/// A law with the values that its parameters start from.
struct StartedLaw {
    OwnLaw law;
    std::vector<double> values; ///< of all parameters
};

/// Takes the laws out of a list of "NAME:FORMULA" and "KEY:PARAMETER=VALUE". What belongs to the catalogue stays.
/// Empty, or what is wrong.
[[nodiscard]] std::string takeOwnLaws(std::vector<std::string>& texts, std::vector<StartedLaw>& laws);

/// Adds effects to the parameters of a replay: texts of the catalogue, and laws of the user with values. Empty, or what
/// is wrong.
[[nodiscard]] std::string addEffects(const std::vector<std::string>& texts, const experiment::Experiment& experiment,
                                     replay::Parameters& parameters, const std::atomic<bool>* interrupt = nullptr);

} // namespace supercircle::diagnosis
