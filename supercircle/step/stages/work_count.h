#pragma once
// The work of trial steps, counted instead of timed (private to step/): a result must not depend on how busy the
// machine is. One unit is about a microsecond of one core of 2.5 GHz.
//
// The weights are a non-negative least-squares fit to the CPU time of 1700 frames of the scenes of `bench --filter
// frames`. Predicted over measured time, 5 % to 95 % of the frames above 1 ms:
// rain of 200 shells 0.6 to 1.1, press 0.9 to 1.1, 300 crates 0.7 to 1.1, piston 0.8 to 1.2, ribbon 0.9 to 1.3; blows
// 0.9. Halving or doubling one moves the share of its stage in a frame that is slowed, no result of one that is not.

#include "supercircle/contact/crossing.h"
#include "supercircle/coulomb/solver.h"

namespace supercircle::step {

struct WorkCount {
    double outlines = 0.0; ///< read from the host, once a frame
    double rods = 0.0;     ///< linearisations times awake rods
    double freedoms = 0.0; ///< the same, squares of the rods' degrees of freedom
    double contacts = 0.0; ///< linearisations times contacts, links and rows of the host
    coulomb::SolveEffort solver;
    contact::CheckEffort check;

    static constexpr double kSolverUnit = 0.034; ///< of a visit of a contact by the solver
    static constexpr double kCheckUnit = 0.5;    ///< of a sample of the crossing check

    void add(const WorkCount& o) {
        outlines += o.outlines;
        rods += o.rods;
        freedoms += o.freedoms;
        contacts += o.contacts;
        solver.add(o.solver);
        check.add(o.check);
    }
    [[nodiscard]] double units() const {
        return 8.0 * outlines + 4.0 * rods + 0.02 * freedoms + 1.5 * contacts + kSolverUnit * solver.units() +
               kCheckUnit * check.units();
    }
};

} // namespace supercircle::step
