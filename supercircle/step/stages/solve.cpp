// Stage Solve: 0 <= u_n + g/dt, r_n >= 0, r_n (u_n + g/dt) = 0, and |r_t| <= mu r_n against the slip.

#include "supercircle/step/contacts/friction_state.h"
#include "supercircle/step/coupling/host_rows.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <algorithm>

namespace supercircle::step {

namespace {

/// One call of the contact solver, counted.
void solveOnce(const World& world, const Settings& settings, TrialStep& t) {
    coulomb::SolverOptions options = settings.contact;
    options.absoluteImpulse *= t.impulseScale;
    if (t.stage.candidates.size() > settings.sweepAbove) {
        options.method = coulomb::Method::Accelerated;
        options.maxGaussSeidelIterations = settings.cappedSweeps;
    }
    options.giveUpEarly = !t.fullEffort;
    if (t.solveLimit > 0.0) { // all contact problems of a trial together; the least is what first iterations need
        const double spent = WorkCount::kSolverUnit * t.result.work.solver.units();
        options.maxWork = std::max(t.solveLimit - spent, 0.05 * t.solveLimit) / WorkCount::kSolverUnit;
    }
    solveContacts(world, t.rods, options, t.stage);
    ++t.result.solves;
    t.result.work.solver.add(t.stage.report.effort);
    t.result.gaussSeidelIterations += static_cast<std::uint64_t>(t.stage.report.gaussSeidelIterations);
    t.result.pivots += static_cast<std::uint64_t>(t.stage.report.pivots);
    SC_ASSERT(t.stage.r.size() == 2 * static_cast<Eigen::Index>(t.stage.problem.contacts.size()),
              "two impulses a contact");
    SC_ASSERT(t.stage.host.motion.size() == world.bodies.size(), "one motion a body");
}

} // namespace

void solve(const World& world, const Settings& settings, TrialStep& t) {
    t.enter(Stage::Solve, Stage::Assemble);
    solveOnce(world, settings, t);
    for (int again = 0; again < 3 && !t.endsForWork() && boundHostRows(world, t.dt, t.stage); ++again) {
        renewHostBlocks(world, t.dt, t.stage);
        solveOnce(world, settings, t);
    }
    constexpr int kMostFactors = 25; // false position halves at worst every second turn
    for (int turn = 0; turn < kMostFactors && !t.endsForWork() && refineFriction(world, t.rods, t.dt, t.stage); ++turn)
        solveOnce(world, settings, t);
}

} // namespace supercircle::step
