#pragma once
// Simulations at the stated numbers and beside them, one number at a time: the derivatives of a driven run before any
// fit. They are those that the fit without an effect begins with, so that nothing new is simulated.

#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/fit.h"

#include <vector>

namespace supercircle::diagnosis {

struct BesideStated {
    std::vector<Response> fine;            ///< at the stated numbers, by run
    std::vector<std::vector<Response>> up; ///< by number and run, coarse: it is larger
    std::vector<std::vector<Response>> down;
    Eigen::VectorXd span; ///< between the two, in steps of the number
};

/// Throws Stopped.
BesideStated simulateBesideStated(Evaluator& evaluator, const Variables& stated);

} // namespace supercircle::diagnosis
