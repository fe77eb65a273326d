#pragma once
// Islands at rest fall asleep: they neither move nor cost anything until something touches them.
//
// An island is what loaded contacts and links hang together, with the dynamic bodies that lie on its rods or are joined
// to them, and those that the host's own contacts and joints add; it falls asleep and wakes as a whole, and the forces
// of its contacts are kept meanwhile, so that it wakes in the balance it fell asleep in. A sleeper is an immovable
// obstacle for the rods that are awake; a step in which one of them presses on it is not accepted but made again with
// the island awake, so no motion ever happens against a sleeper. How bodies sleep: coupling/sleeping_bodies.h.
//
// Rest is measured by drift, not by speed: a loaded pile trembles at the accuracy of its gaps long after it has come to
// rest (thirty shells of R = 1 m at 4 ms: tips at 1 h/s within some hundredths of h), and no bound on speeds that lets
// it sleep would keep a slowly toppling shell awake.

#include "supercircle/step/world.h"

#include <string>

namespace supercircle::step {

/// Wakes the island of a rod (does nothing to one that is awake, except that it counts as unrested).
void wake(World& world, std::size_t rod);
void wakeIsland(World& world, std::uint32_t island);
void wakeAll(World& world);

/// Puts the island of a rod to sleep, whatever its speed (its motion is booked as removed). Empty, or why it cannot:
/// islands with dynamic bodies fall asleep by themselves only.
[[nodiscard]] std::string putToSleep(World& world, std::size_t rod);

/// Measures, after a step of `dt` seconds, how long rods have been still.
void measureRest(World& world, const Settings& settings, double dt);

/// Puts islands to sleep all of whose rods and bodies have been still for Settings::sleepAfter (what little the rods
/// move is booked as numerical loss), together with the bodies beside them that would wake them in the coming `frame`
/// seconds. Call it at the end of a frame, when the host's constraints are known.
void sleepAtRest(World& world, const Settings& settings, double frame);

/// Wakes the islands that bodies of the host come near or have left: those whose outlines are new, gone, moved or
/// moving within `frame` seconds. The world still has what was pulled before; sleepers among `bodies` stay as they are.
void wakeByHost(World& world, const std::vector<Body>& bodies, const std::vector<BodyOutline>& outlines, double frame);

} // namespace supercircle::step
