// One step of the shells, stage by stage, in the order of the enum Stage. The size of the step is chosen in
// stepper.cpp; each stage is in stages/, in the file of its name. Symbols: docs/theory/time_step.md.

#include "supercircle/step/contacts/one_sided.h"
#include "supercircle/step/contacts/overlaps.h"
#include "supercircle/step/damping.h"
#include "supercircle/step/stages/stage_timer.h"
#include "supercircle/step/stages/stages.h"

namespace supercircle::step {

void beginFrame(World& world, const Settings& s, double frame, Port* port, bool nearOnly, HostReading& reading,
                StageTimes& times) {
    timed(times, Stage::Check, [&] { checkNumbers(world, s); }); // q, v are numbers
    if (port)
        timed(times, Stage::ReadHost,
              [&] { readHost(world, *port, s, frame, nearOnly, reading); }); // bodies and outlines near by
    timed(times, Stage::Drive, [&] { drive(world, s, frame); });             // velocities and paths that are given
    refreshDamping(world, s);
    reviewOverlaps(world, true); // pairs that cross, as the host has put things
}

/// Changes nothing of the world: what it finds is in `t`, and whether it may stand in t.result.reason.
void tryStep(const World& world, const Settings& s, TrialStep& t, StageTimes& times, const SolveObserver& onSolve) {
    timed(times, Stage::Detect, [&] { detectAtStart(world, s, t); }); // pairs with gap g(q) within reach
    t.begin(world, s);
    if (s.crossingCheck)
        findOverlaps(world, t);
    if (t.result.reason != Reason::None)
        return;
    timed(times, Stage::Linearise, [&] { linearise(world, s, t); }); // H = dg/dq at q + dt v / 2
    for (bool balanced = false; !balanced;) {
        timed(times, Stage::Evaluate, [&] { evaluate(world, t); }); // F(q), K = -dF/dq
        timed(times, Stage::Predict, [&] { predict(world, t); });   // A = M + dt^2 K, v_free = A^-1 (p + dt F)
        timed(times, Stage::Assemble, [&] { assemble(world, t); }); // u = H v_free + H A^-1 H^T r
        timed(times, Stage::Solve, [&] { solve(world, s, t); });    // 0 <= u_n + g/dt  _|_  r_n >= 0, |r_t| <= mu r_n
        if (t.endsForWork())                                        // the frame's budget is gone
            return;
        timed(times, Stage::Integrate, [&] { integrate(world, t); }); // v = v_free + A^-1 H^T r, q1 = q + dt v
        if (onSolve && !t.stage.problem.contacts.empty())
            onSolve(t.stage.problem, t.stage.report);
        bool wider = false;
        if (!judgeMotion(world, s, t, wider)) // error and motion within their limits
            return;
        if (wider) {
            timed(times, Stage::Detect, [&] { detectWider(world, s, t); });
            timed(times, Stage::Linearise, [&] { linearise(world, s, t); });
            continue;
        }
        timed(times, Stage::Detect, [&] { detectAtEnd(world, s, t); }); // g(q1)
        timed(times, Stage::Linearise, [&] { balanced = !relinearise(world, s, t); });
    }
    if (s.crossingCheck && t.result.reason == Reason::None)
        timed(times, Stage::CheckCrossings, [&] { checkCrossings(world, t); }); // nothing passed through
}

void acceptStep(World& world, TrialStep& t, StageTimes& times) {
    timed(times, Stage::Accept, [&] { accept(world, t); }); // new state, energy balance, forces kept
    reviewOverlaps(world, false);                           // pairs that cross, after their push
    findPassing(world, t.stage);                            // and those that pass one-sided edges from behind
}

void endFrame(World& world, double advanced, Port* port, StageTimes& times) {
    if (port)
        timed(times, Stage::WriteHost, [&] { writeHost(world, *port, advanced); }); // impulses to bodies
}

} // namespace supercircle::step
