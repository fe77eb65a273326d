#pragma once
// What every method passes on: impulses, the mass-normalised velocities for them, and the best solution so far.

#include "supercircle/coulomb/law.h"
#include "supercircle/coulomb/strategy/mass_normalised.h"

#include <vector>

namespace supercircle::coulomb {

/// Target of all methods of one solve.
struct SolveTarget {
    double contactResidual = 1e-8; ///< to be reached, 1
    double impulse = 1e-13;        ///< N s, natural-map error that excuses a residual up to kExcused, not beyond:
                                   ///< else r = 0 would pass as the solution where all impulses are small
    double speed = 0.0;            ///< m/s, round-off of the velocities: bodies at rest close no faster
    static constexpr double kExcused = 1e-3; ///< of the contact residual, 1
    bool reached(const Residual& residual) const {
        return residual.contactResidual <= contactResidual || isRoundOff(residual) ||
               (residual.impulseError <= impulse && residual.contactResidual <= kExcused);
    }
    /// All that is left is round-off of the data, whatever its ratio to free velocities that are round-off as well.
    bool isRoundOff(const Residual& residual) const { return residual.speedError <= speed; }
};

struct SolverState {
    std::vector<double> r; ///< 2 per contact, N s
    std::vector<double> w; ///< mass-normalised body velocities for r
    std::vector<ContactStatus> status;

    void start(const MassNormalisedProblem& problem, const Eigen::VectorXd& warm);
    /// Statuses of impulses that lie inside their cones.
    void findStatuses(const MassNormalisedProblem& problem);
};

/// Keeps the impulses with the smallest residual; of equal ones the earlier.
struct BestSolution {
    std::vector<double> r;
    Residual residual;

    void reset() { r.clear(); }
    /// True if `candidate` is the new best.
    bool offer(const std::vector<double>& candidate, const Residual& value);
};

} // namespace supercircle::coulomb
