#pragma once
// A step of second order of rods that touch something and move (private to step/).
//
// Scheme: SDIRK2 as in rods/free_motion.h. A stage of gamma dt from an extrapolated start is a trial step of that size,
// with contacts and friction by the exact law in both:
//     W1 = step(W, gamma dt),   W2 = step(W + (1 - gamma)/gamma (W1 - W), gamma dt).
// Whatever grows linearly in a step (ways of bodies, impulses, energies passed on) is extrapolated with the state, so
// that it ends with the weights of the scheme. Numerical dissipation is what the other terms of the balance leave.
//
// It holds as long as no contact changes its status: from the step before through both stages the same ones carry force
// and stick or slip the same way. At a change the controller (stepper.cpp) makes steps shorter, and takes the shortest
// one as the first-order trial. Moving weights on impulses would be wrong by (1 - gamma)/gamma there.

#include "supercircle/step/stages/trial_step.h"

namespace supercircle::step {

/// What becomes of a trial of first order.
enum class SecondOrder : std::uint8_t {
    NotWorth,      ///< it is accurate enough, or it is none that this scheme can make
    Made,          ///< TrialStep::secondOrder holds a better one
    ErrorTooLarge, ///< that one is not good enough: both must be shorter
    StatusChanged  ///< a contact opened, closed, began to slip or to stick
};

/// Contacts that carry force and how, by id; sorted.
using ContactStatuses = std::vector<std::pair<std::uint64_t, int>>;

/// A step made of two stages: storage, and the world at its end.
struct SecondOrderStep {
    World world;
    std::array<TrialStep, 2> stages;
    ContactStatuses before, status;
    std::vector<Vec2> bodyForces; ///< of the first stage, N
    HostConstraints constraints;  ///< after the first stage
    double error = 0.0;           ///< squared, in units of what may be: above 1 it is too large
};

/// Makes a step of second order in the place of `t`, a trial that may be accepted. Its work is added to t.result.work.
[[nodiscard]] SecondOrder trySecondOrder(const World& world, const Settings& settings, TrialStep& t, StageTimes& times,
                                         const SolveObserver& onSolve);
/// It becomes the state.
void acceptSecondOrder(World& world, TrialStep& t);
/// Size of the next step that its error asks for, s.
[[nodiscard]] double nextSize(const TrialStep& t);

} // namespace supercircle::step
