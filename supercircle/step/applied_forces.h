#pragma once
// Forces, soft hands and moving targets (private to step/).
//
// A mouse joint is a spring and a damper between a point of the rod and a place, both implicit: with J the rows of the
// point, A gains dt (d + dt k) J^T J and the right-hand side dt k (target - point) J^T, so that any stiffness is
// stable. Where the force would exceed its largest value, stiffness and damping are scaled down by the same factor (a
// secant of the saturated law, found again with each linearisation): a force of constant size and an explicit direction
// would shoot over the target at the moment the saturation ends.

#include "supercircle/step/stages/workspace.h"

namespace supercircle::step {

struct Pose {
    Vec2 point = Vec2::Zero(); ///< m
    double angle = 0.0;        ///< rad
    Vec2 velocity = Vec2::Zero();
    double spin = 0.0;
};

/// Where a hold's or link's target is `ahead` seconds after World::time.
Pose poseAfter(const World& world, const Hold& hold, double ahead);
Pose poseAfter(const World& world, const Target& target, double ahead);
/// Moves the target on by a step.
void advanceTarget(const World& world, double dt, Hold& hold);
void advanceTarget(const World& world, double dt, Target& target);
/// Gives pending goals the time that they are reached in, s.
void startPaths(World& world, double time);
/// How far the held points of a rod may come in the coming frame, m. Those that the crosshead carries are left out.
[[nodiscard]] double wayOfHolds(const Rod& rod, double frame);
/// Ends the motion of held points in the coming frame where they would enter a body that cannot yield.
void stopHolds(World& world, double frame);
/// Forgets the forces that were meant for one frame.
void endOfFrame(World& world);

/// Adds forces and mouse joints to A and rhs. `first`: nothing was solved in this attempt yet.
void addLoads(const Rod& rod, double dt, bool first, RodWork& w);
/// Of a mouse joint on its point, and the part of spring and damper that its largest force leaves.
struct MouseForce {
    Vec2 force = Vec2::Zero(); ///< N
    double share = 1.0;
};
[[nodiscard]] MouseForce mouseForce(const MouseJoint& joint, const Vec2& point, const Vec2& velocity);
/// Leaves the joints' forces at the end of a free motion in the rod.
void recordMouseForces(Rod& rod, RodWork& w);
/// Work of forces and mouse joints over the step, J; leaves the joints' forces in the rod.
double recordAppliedForces(Rod& rod, double dt, const RodWork& w);
/// Whether a mouse joint's force is farther than 1 % from its law, so that another linearisation is worth while.
bool mouseJointsOff(const Rod& rod, double dt, const RodWork& w);

} // namespace supercircle::step
