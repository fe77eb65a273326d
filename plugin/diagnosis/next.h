#pragma once
// Which further run would tell the leading rivals apart.
//
// Two rivals' predictions of a run lie some way apart, but the run will be fitted again: what the recorded runs leave
// open in either rival's numbers may take the difference up. So their distance is measured in the covariance of what
// either foretells, 1 + J_a C_a J_a' + J_b C_b J_b', with C the posterior of a fit and J the derivatives of the new run
// (noise units; a constant shift is taken out), and in that of what every run has of its own and every simulation is
// off by: clock, scale, contact places (misfit.h). A sensor that is 6 ms late was to be told from nothing in a hold of
// 100 s, read 19 times a second, with a power of 1; a clock is known to a tenth of a row. Without all that, of seven
// runs that were proposed and made with the second simulator three settled the case: a wrong gain and a softening that
// is over in a quarter of a second differ by much in a slow run, until the modulus is fitted again.

#include "plugin/diagnosis/evaluator.h"
#include "plugin/diagnosis/fit.h"
#include "plugin/diagnosis/noise.h"
#include "plugin/diagnosis/result.h"

#include <array>
#include <optional>
#include <string>

namespace supercircle::diagnosis {

/// A model in question, as it was fitted.
struct Rival {
    std::string label;
    Point point;
    Eigen::VectorXd x;
    Eigen::MatrixXd covariance; ///< posteriorOf()
};

/// Simulates the designs with both rivals and takes the first one that sets their predictions five units apart, else
/// the one that does best. Its power is that of a one-sided test at 5 % between the two, Phi(d - 1.645) with d the
/// distance. Empty if no design can be simulated, or if the evaluator was stopped.
std::optional<NextExperiment> nextExperiment(Evaluator& evaluator, const std::array<Rival, 2>& rivals,
                                             const Noise& noise);

} // namespace supercircle::diagnosis
