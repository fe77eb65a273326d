#pragma once
// How a dynamic body of the host lives in the shells' steps and in the host's (private to step/).
//
// A host such as Box2D steps by frames of 1/60 s and moves a body by x += T v with the velocity at the frame's end.
// Shells take ten to a thousand steps in that time. Each body near shells has a copy here in double precision:
//     pull   copies go on from where they were; the host lists its own constraints on them;
//     steps  shells, copies and those constraints are one contact problem per step;
//     push   the host gets the impulse that takes the original where the copy went;
//     (host's step)
//     learn  what the host made of it: velocities, then places.
// Formulas and measured limits: docs/theory/coupling.md. What was tried: decision 0052.

#include "supercircle/step/contacts/contact_rows.h"
#include "supercircle/step/stepper.h"

namespace supercircle::step {

/// Storage of what follows the host's step, kept from frame to frame.
struct HostCouplingWork {
    std::vector<BodyMotion> unsolved; ///< per World::bodies
    std::vector<BodyId> impulseUnknown;
    std::vector<int> woken;            ///< sleepers that the host woke within its step, indices into World::bodies
    std::vector<std::uint32_t> struck; ///< islands that must not fall asleep after all
    std::vector<int> suspects, intruding, crossing, owner;
    std::vector<contact::RodCurve> curves;
    std::vector<contact::Outline> copies, originals;
    std::vector<double> depthOfCopy, depthOfOriginal;
    contact::Detector detector;
    std::vector<contact::Candidate> near;
    std::vector<contact::Crossing> crossings;
    std::vector<Box> shellBoxes; ///< of the next four see stray_bodies.h
    std::vector<BodyId> judged;
    std::vector<StrayBody> strays;
    std::vector<BodyOutline> strayOutlines;
};

/// Distance from a body's centre of mass of its farthest point in these outlines, joints and contacts, m. A joint may
/// hold a body none of whose outlines is near a shell.
double farthestPoint(const World& world, const std::vector<BodyOutline>& outlines, BodyId body);

/// How well a host that uses floats knows the place of a body whose points are up to `reach` m from its centre, m.
double hostRounding(const BodyState& state, double reach);

/// Part of each body's velocity after the host's step that is no more than the host's solver stopping early: the
/// difference between its impulses and ours on the same constraints (m/s, rad/s): HostCouplingWork::unsolved.
void unsolvedByHost(const World& world, const Port& port, double advanced, HostCouplingWork& work);

/// After the host's step: decides for every dynamic body near shells whether its copy or its original is where it
/// should be. What is left between them (less than a fiftieth of a thickness as a rule) is the drift of the next frame.
void reconcilePoses(World& world, const PairFilter& filter, Port& port, double advanced, HostCouplingWork& work);

/// After the host's own step of `advanced` seconds: gives the bodies the velocities they have at the end of the frame
/// and learns what the host's constraints did to them.
void learnFromHost(World& world, const Settings& settings, const PairFilter& filter, Port& port, double advanced,
                   HostCouplingWork& work);

} // namespace supercircle::step
