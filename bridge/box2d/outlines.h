#pragma once
// Converts Box2D shapes to outlines of the core.

#include "supercircle/step/port.h"

#include <box2d/box2d.h>
#include <cstdint>

namespace supercircle::bridge {

/// Child `child` of a fixture as an outline in SI units, in the frame of its body (origin at the centre of mass,
/// unrotated). `key` is copied.
contact::Outline outlineOf(const b2Fixture& fixture, int32 child, double unitsPerMetre, std::uint32_t key);

/// False for fixtures that no shell touches: sensors, and fixtures that collide with no category.
bool isSolid(const b2Fixture& fixture);

} // namespace supercircle::bridge
