#pragma once
// What can be varied: named scalars and a simulator that takes their values. Whatever has a name and a number (nominal
// parameters of an experiment, amplitudes of effects, settings of a sensor) becomes a column the same way.

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
    double value = 0.0; ///< where the derivative is taken
    /// A change worth looking at, > 0: the half-width of the stated interval, or what a careful laboratory may be off
    /// by. Step sizes and pictures are measured in it; a step is never longer.
    double scale = 0.0;
    double lower = -std::numeric_limits<double>::infinity(); ///< least value that can be simulated
    double upper = std::numeric_limits<double>::infinity();
    /// The column is the inverse of what is set: amplitudes of effects that are off at infinity (a yield moment, the
    /// stiffness of the machine) are differentiated where they are off, at 0.
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

/// The replay of an experiment with the parameters called `names` as columns (empty: all that are shared by the
/// specimens) at `parameters`; "KEY:NAME" is a parameter of an effect. `experiment` must outlive the model.
/// @return the model, or in `error` the unknown name and the nearest known one
Model replayModel(const experiment::Experiment& experiment, const replay::Parameters& parameters,
                  const replay::Resolution& resolution, const std::vector<std::string>& names, std::string& error);

} // namespace supercircle::sensitivity
