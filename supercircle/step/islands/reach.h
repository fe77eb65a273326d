#pragma once
// Boxes of what may move in a frame (private to step/): what lies outside of each other's boxes cannot meet in it.

#include "supercircle/step/world.h"

namespace supercircle::step {

[[nodiscard]] Box emptyBox();
void widen(Box& box, const Box& other);
void widen(Box& box, const Vec2& point, double pad);
[[nodiscard]] bool meet(const Box& a, const Box& b);
[[nodiscard]] bool contains(const Box& outer, const Box& inner);

/// How far from its nodes the surface of a rod lies, with the margin of contacts, m: arcs bulge by less than a quarter
/// of their length, and the surface is half a thickness away from them.
[[nodiscard]] double surfaceReach(const Rod& rod);
/// Where a rod at `kin` may come to in `frame` s: its nodes at twice its speed (m/s) and twice its fall or as far as
/// its holds go, twice the reach of its surface, and as far as that attracts.
[[nodiscard]] Box reachOf(const World& world, const Rod& rod, const rod::Kinematics& kin, double speed, double frame);
/// The same of a piece of a body in a state.
[[nodiscard]] Box reachOf(const World& world, const BodyState& state, const BodyOutline& piece, double frame);
/// The same of a piece of a body of the world.
[[nodiscard]] Box reachOf(const World& world, const BodyOutline& piece, double frame);

} // namespace supercircle::step
