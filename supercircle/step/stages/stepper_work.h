#pragma once
// What a stepper keeps between frames beside its settings (private to step/): work spaces, no state.

#include "supercircle/step/coupling/handover.h"
#include "supercircle/step/stages/attempt.h"

namespace supercircle::step {

/// What is read from the host, before it takes the place of what the world knew.
struct PullWork {
    std::vector<BodyOutline> outlines;
    std::vector<BodyId> ids;
    std::vector<Body> bodies;
};

struct Stepper::Work {
    Attempt attempt;
    double lastDt = 0.0;
    PullWork pull;
    HandoverWork handover;
};

} // namespace supercircle::step
