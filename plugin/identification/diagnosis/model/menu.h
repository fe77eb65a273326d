#pragma once
// The catalogue of effects as candidates of one experiment: which numbers of each effect are fitted, on which scale,
// and where searches start. Sizes follow the experiment (its forces, lengths, speeds), not a list of cases.

#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/recording/experiment/experiment.h"
#include "supercircle/effects/effect.h"

#include <vector>

namespace supercircle::diagnosis {

/// What acts on readings only, after the simulation.
enum class Reading : std::uint8_t { None, Drift, Gain, ByTime, ByDisplacement, ByDirection };

/// How a candidate's values become a setting of the catalogue.
struct Recipe {
    effects::Setting base;                ///< with its choices made
    std::vector<std::size_t> parameterAt; ///< of each of the candidate's scalars
    Reading reading = Reading::None;
};

struct Menu {
    std::vector<Candidate> candidates;
    std::vector<Recipe> recipes; ///< one per candidate
};

/// Sizes of an experiment by which effects are measured.
struct Sizes {
    double force = 1.0;     ///< largest, N
    double travel = 1e-2;   ///< of the head, m
    double speed = 1e-3;    ///< fastest, m/s
    double duration = 10.0; ///< of the longest run, s
    double radius = 0.02;   ///< of the specimens (a straight one: length / pi), m
    double length = 0.1;    ///< m
    double modulus = 2e-4;  ///< N m^2
    double bend = 0.0;      ///< largest curvature change of a simulated run, 1/m; 0: not known
};
Sizes sizesOf(const experiment::Experiment& experiment);

/// Everything in the catalogue that can act in this experiment; `without` leaves labels out (to test "unexplained").
Menu menuFor(const experiment::Experiment& experiment, const std::vector<std::string>& without = {},
             double largestBend = 0.0);

} // namespace supercircle::diagnosis
