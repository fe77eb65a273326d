#pragma once
// What is known of a pair's surfaces: material, friction, speed of belts (private to step/).

#include "supercircle/step/world.h"

#include <cstdint>

namespace supercircle::step {

/// Material of a body, 0 if none was set.
[[nodiscard]] std::uint32_t materialOf(const World& world, BodyId id);

/// Of the belt that a piece is, m/s, 0 for most. The whole body's speed is behind those of its fixtures.
[[nodiscard]] double surfaceSpeedOf(const World& world, const BodyOutline& piece);

/// What a pair's own friction says, else the geometric mean of both coefficients.
/// @param a, b materials
[[nodiscard]] double frictionOf(const World& world, std::uint32_t a, double muA, std::uint32_t b, double muB);

} // namespace supercircle::step
