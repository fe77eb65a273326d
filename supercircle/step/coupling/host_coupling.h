#pragma once
// Two solvers and one body: how a dynamic body of the host lives in the shells' steps and in the host's (private to
// step/; measured limits are in docs/theory/coupling.md).
//
// A host such as Box2D steps by frames of 1/60 s, moves a body by x += T v with the velocity of the frame's end, and
// solves its contacts and joints with a few sweeps. Shells take ten to a thousand steps in that time, with exact gaps
// and exact friction. Each body near shells therefore has a copy here in double precision. A frame goes
//     pull   copies take up where they were; the host lists its own constraints on them;
//     steps  shells, copies and those constraints are one contact problem per step;
//     push   the host gets the impulse that takes the original where the copy went;
//     (host's step)
//     learn  what the host made of it: velocities, then places.
//
// What was tried, with a crate of 5 g on two half circles, two crates of 50 g on it and a motor arm above, 1/240 s:
// - The shells' impulse alone, copies read anew each frame (plain staggering). A free crate bounced: our steps move it
//   by the integral of its velocity, x += T v does not, and the difference of up to g T^2 / 2 (.17 h at 1/240) was
//   pushed out within a step of .1 ms. Cure: the original gets the *mean* velocity of its copy, so that both end in
//   one place, and the velocity of the end after the host's step. Free bodies of any mass then stand without motion.
// - Feeding forward the acceleration that the host's constraints caused in the last frame: gap 4.5 h, jitter .2 m/s,
//   because it treats the inertia of whatever stands on the body explicitly. Cure: the host's touching contacts and
//   joints are rows of our own problem (host_constraints.h). Gap and jitter fall to float rounding. What no row
//   explains (forces of the user, gear joints) is still fed forward: the smaller of the last two frames where they
//   agree, since fed whole it rang (gap .1 h) and a blow is no force.
// - Rows of the host's last step. Contacts that have come or gone since made the host answer with an impulse we had
//   not expected, and a light body takes off with it. The manifolds must be those the coming step will find.
// - Taking over the host's velocities as they are. After eight sweeps a few per cent of the impulse on a light body
//   under heavy ones are missing, which is metres per second where masses differ by 100. The host's impulses are known
//   after its step, so that error can be told from everything else: same constraints, other impulses. It is dropped;
//   what else happened to the body (blows of bodies we did not know of, the user's forces) is kept to the last digit.
// - Letting the copy drift to the original's place over the next frame whatever the distance: a blow at 1/60 s moves a
//   body by millimetres into the shell, and pressing the copy there is free work on the shell (energy rose by a
//   quarter). Only distances below h / 50 drift. Beyond that an original that stands deeper in a shell than its copy,
//   or beyond it, is set back to the copy - except into walls - and any other copy is set to its original.
// - Letting the copies of bodies at rest drift to their originals. These are floats: bodies that press on each other
//   part by roundings, and nothing brings them together again above the host's tolerance. A crate in a stack rose by
//   0.6 um in a minute. Cure: a copy at rest stays where it is, and its original goes to it.
//
// Momentum: shells and host exchange exactly what the contact problem says; dropping the unsolved part restores the
// balance the host's sweeps left open. Energy: the host's own position correction may lift bodies that it let overlap,
// as it does without shells.

#include "supercircle/step/contacts/contact_rows.h"

namespace supercircle::step {

/// Storage of the two below, kept from frame to frame.
struct HostCouplingWork {
    std::vector<BodyMotion> unsolved; ///< per World::bodies
    std::vector<BodyId> impulseUnknown;
    std::vector<int> woken;            ///< sleepers that the host woke within its step, indices into World::bodies
    std::vector<std::uint32_t> struck; ///< islands that must not fall asleep after all
    std::vector<int> suspects, intruding, owner;
    std::vector<contact::RodCurve> curves;
    std::vector<contact::Outline> copies, originals;
    std::vector<double> depthOfCopy, depthOfOriginal;
    contact::Detector detector;
    std::vector<contact::Candidate> near;
    std::vector<contact::Crossing> crossings;
};

/// Distance of a body's farthest point from its centre of mass, m.
double farthestPoint(const std::vector<BodyOutline>& outlines, BodyId body);

/// How well a host that uses floats knows the place of a body whose points are up to `reach` m from its centre, m.
double hostRounding(const BodyState& state, double reach);

/// Part of each body's velocity after the host's step that is no more than the host's solver stopping early: the
/// difference between its impulses and ours on the same constraints (m/s, rad/s): HostCouplingWork::unsolved.
void unsolvedByHost(const World& world, const Port& port, double advanced, HostCouplingWork& work);

/// After the host's step: decides for every dynamic body near shells whether its copy or its original is where it
/// should be. What is left between them (less than a fiftieth of a thickness as a rule) is the drift of the next frame.
void reconcilePoses(World& world, Port& port, double advanced, HostCouplingWork& work);

/// After the host's own step of `advanced` seconds: gives the bodies the velocities they have at the end of the frame
/// and learns what the host's constraints did to them.
void learnFromHost(World& world, const Settings& settings, Port& port, double advanced, HostCouplingWork& work);

} // namespace supercircle::step
