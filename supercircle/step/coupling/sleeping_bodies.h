#pragma once
// Dynamic bodies of the host in sleeping islands (private to step/; what an island is, is said in sleep.h).
//
// An island is found to be at rest at the end of a frame. Its bodies are put to sleep after the host's step of that
// frame, unless something struck them in it. From then on a body is an immovable piece that keeps the pose, the
// accelerations and the place in the host that it had; the shells do not push it, the host does not move it.
//
// The island wakes before a step if the host or its user has woken, moved or changed a body, or if a body outside
// touches one of it: the host acts on contacts no earlier than they are listed. A body that the host wakes within its
// step (by continuous collision, by a listener) has fallen for a step without the shells' support. What its own weight
// and the host's known contacts did to it is taken back; what struck it stays.

#include "supercircle/step/coupling/host_coupling.h"

namespace supercircle::step {

/// Of an island that wakes.
void wakeBody(Body& body);
/// Before bodies are read: wakes the islands whose bodies are not as they fell asleep.
void wakeChanged(World& world, const Port& port);
/// A body that is read: it sleeps on as it did in the last frame.
void sleepOn(const Body& old, double frame, Body& body);
/// Wakes the islands whose sleepers among `bodies` (as read) are joined to something awake, touch a body outside in the
/// host, or lie in the way of a hold that moves; `regions`: where rods may come to.
void wakeTouched(World& world, const std::vector<Body>& bodies, const std::vector<BodyOutline>& outlines,
                 const std::vector<Box>& regions);
/// What is true of the old bodies is true of those that were read.
void wakeAsBefore(const std::vector<Body>& old, std::vector<Body>& bodies);

/// Within a step of `dt` s: what the host's constraints give a sleeper, should it wake in this frame.
void keepHostImpulse(Body& sleeper, double dt);

/// After the host's step of `advanced` s: wakes what it woke within (HostCouplingWork::woken).
void wakeWoken(World& world, const Port& port, double advanced, HostCouplingWork& work);
/// Measures how long bodies have been still; puts those of islands that fell asleep in this frame to sleep in the host.
/// Islands in HostCouplingWork::struck wake instead.
void settleBodies(World& world, const Settings& settings, Port& port, double advanced, const HostCouplingWork& work);
/// Whether a velocity and a spin, or a change of them, carry a body out of its rest within Settings::sleepAfter.
[[nodiscard]] bool isStruck(const World& world, const Settings& settings, const Body& body, const Vec2& velocity,
                            double spin, double advanced);

} // namespace supercircle::step
