#pragma once
// What a stepper keeps between frames beside its settings (private to step/): work spaces, no state.

#include "supercircle/step/coupling/host_coupling.h"
#include "supercircle/step/stages/join_outlines.h"
#include "supercircle/step/stages/trial_step.h"

namespace supercircle::step {

/// What is read from the host, before it takes the place of what the world knew.
struct HostReading {
    std::vector<BodyOutline> outlines;
    std::vector<BodyId> ids;
    std::vector<Body> bodies;
    std::vector<BodyId> refused; ///< bodies with numbers that are not finite
    std::string why;             ///< what was left out, for the user; empty: nothing
    OutlineJoining joining;
    std::vector<Box> regions; ///< per rod, of which the hull was read. No step is accepted that leaves it
};

struct Stepper::Work {
    TrialStep trial;
    double lastDt = 0.0;
    HostReading reading;
    HostCouplingWork coupling;
};

} // namespace supercircle::step
