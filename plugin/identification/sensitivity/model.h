#pragma once
// Model for derivatives: named scalars, and a simulator that takes their values. Nominal parameters, effect amplitudes
// and sensor settings become columns alike.

#include "plugin/identification/replay/parameters.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/experiment.h"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace supercircle::sensitivity {

/// A named scalar on which simulated readings depend.
struct Column {
    std::string name;
    std::string unit;
    std::string about;
    double value = 0.0; ///< value at which the derivative is taken
    /// A relevant change, > 0: half-width of the stated interval, or the usual uncertainty of a laboratory. Unit of
    /// steps and figures, and the largest step.
    double scale = 0.0;
    double lower = -std::numeric_limits<double>::infinity(); ///< smallest value that can be simulated
    double upper = std::numeric_limits<double>::infinity();
    /// The column is the inverse of the parameter: amplitudes that are infinite for an absent effect (a yield moment, a
    /// machine stiffness) are differentiated at 0.
    bool inverse = false;
};

/// A simulator of all runs of an experiment with named scalars.
struct Model {
    std::vector<Column> columns;
    std::size_t runs = 0;
    /// Simulates a run with these values, one per column. Deterministic; called from several threads at a time.
    std::function<replay::Simulated(std::size_t run, const std::vector<double>& values, const replay::Options& options)>
        simulate;
};

/// Names ("KEY:NAME") of the amplitudes of all effects (supercircle/effects/effect.h), for `names` below.
std::vector<std::string> effectNames(const experiment::Experiment& e);

/// The replay of an experiment with the parameters `names` as columns (empty: all shared ones) at `parameters`;
/// "KEY:NAME" is a parameter of an effect. `experiment` must outlive the model.
/// @return the model, or in `error` the unknown name and the nearest known one
[[nodiscard]] Model replayModel(const experiment::Experiment& experiment, const replay::Parameters& parameters,
                                const replay::Resolution& resolution, const std::vector<std::string>& names,
                                std::string& error);

} // namespace supercircle::sensitivity
