#pragma once
// The thirteen stages of a step in order (private to step/), each in the file of its name. step.cpp calls them.

#include "supercircle/step/stages/stepper_workspace.h"
#include "supercircle/step/stages/trial_step.h"

namespace supercircle::step {

/// Stages before the first step of a frame: Check, ReadHost, Drive.
void beginFrame(World& world, const Settings& settings, double frame, Port* port, bool nearOnly, HostReading& reading,
                StageTimes& times);
/// Stages Detect to CheckCrossings of a step of t.dt seconds.
void tryStep(const World& world, const Settings& settings, TrialStep& t, StageTimes& times,
             const SolveObserver& onSolve);
/// Stage Accept.
void acceptStep(World& world, TrialStep& t, StageTimes& times);
/// Stage WriteHost, after the last step of a frame.
void endFrame(World& world, double advanced, Port* port, StageTimes& times);

/// Check: rods with numbers that are not finite are quarantined. Those whose time is over move again.
void checkNumbers(World& world, const Settings& settings);
/// Puts a rod back where it was last good, freezes it and takes it out of collision.
void quarantine(World& world, Rod& rod, QuarantineReason reason);

/// ReadHost: gravity, bodies near the shells, their outlines and constraints. `nearOnly`: of outlines only those that a
/// shell may meet in the frame, as islands need it; else all between the shells.
void readHost(World& world, const Port& port, const Settings& settings, double frame, bool nearOnly,
              HostReading& reading);
/// Moves what is joined to bodies that their user has moved since the last frame, dynamic ones however far, others at a
/// jump: reading.jumped, reading.carried (carry_along.h).
void carryAlong(World& world, const Port& port, HostReading& reading);
[[nodiscard]] bool finite(const BodyState& state);
/// Whether a body without mass is put farther than its size `reach`, so that it is there at once, m.
[[nodiscard]] bool isJump(const BodyState& from, const BodyState& to, double thickness, double reach);
/// Whether a rod leaves at the end of the trial the region that was read; regions are then made larger for the `left` s
/// of the frame.
bool leavesRegions(const World& world, const TrialStep& t, double left, HostReading& reading);
/// Reads the regions again within a frame of `frame` s, `elapsed` s of which are over. Bodies that come in move on as
/// if the host had no constraints on them. False: nothing was there that is not known.
bool readAgain(World& world, const Port& port, const Settings& settings, double frame, double elapsed,
               HostReading& reading);

/// Drive: velocities of the crosshead's bodies, paths of held points.
void drive(World& world, const Settings& settings, double frame);

/// Detect: candidates at the start of the step, if the known ones do not reach far enough for it.
void detectAtStart(const World& world, const Settings& settings, TrialStep& t);
/// The same with the range that the trial has found to be needed.
void detectWider(const World& world, const Settings& settings, TrialStep& t);
/// Candidates at the end of the trial: what judges it, and what the next step starts from.
void detectAtEnd(const World& world, const Settings& settings, TrialStep& t);
/// Deepest overlap of a list of candidates, m.
double deepest(const std::vector<contact::Candidate>& list);

/// Before Linearise: moves the rods that touch nothing within the step (rods/free_motion.h). The further stages leave
/// them out.
void moveFreeRods(const World& world, const Settings& settings, TrialStep& t);
/// Linearise: rows of contacts and joints in the predicted middle of the step.
void linearise(const World& world, const Settings& settings, TrialStep& t);
/// Whether the nonlinear balance holds at the end of the trial. If not, and another linearisation is allowed, takes it
/// in the middle of the motion just found and returns true. Else sets the reason why the trial must not stand.
[[nodiscard]] bool relinearise(const World& world, const Settings& settings, TrialStep& t);

/// Evaluate: forces and tangents of material, loads and effects.
void evaluate(const World& world, TrialStep& t);

/// Predict: factors of A, free velocity.
void predict(const World& world, TrialStep& t);

/// Assemble: the contact problem.
void assemble(const World& world, TrialStep& t);

/// Solve: the contact problem, with the host's bounded rows and friction that depends on the slip found.
void solve(const World& world, const Settings& settings, TrialStep& t);

/// Integrate: new velocities and configurations.
void integrate(const World& world, TrialStep& t);
/// Error and motion of the trial. False: it must not stand (TrialResult::reason). `wider` is set where the candidates
/// did not reach as far as the rods moved.
[[nodiscard]] bool judgeMotion(const World& world, const Settings& settings, TrialStep& t, bool& wider);

/// Before the step is solved: pairs that cross at its start (TrialResult::overlaps), as far as deep contacts tell.
void findOverlaps(const World& world, TrialStep& t);
/// CheckCrossings: the independent check of the way from start to end.
void checkCrossings(const World& world, TrialStep& t);

/// Accept: the trial becomes the world's state; energies are recorded.
void accept(World& world, TrialStep& t);

/// WriteHost: impulses and driven poses to the host, which is about to step by `advanced` seconds.
void writeHost(World& world, Port& port, double advanced);

} // namespace supercircle::step
