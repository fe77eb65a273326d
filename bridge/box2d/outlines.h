#pragma once
// Box2D shapes as the outlines the core knows.

#include "supercircle/step/port.h"

#include <box2d/box2d.h>
#include <cstdint>

namespace supercircle::bridge {

/// Child `child` of a fixture as an outline in SI units, in the frame of its body (origin at the centre of mass,
/// unrotated). `key` is taken as given.
contact::Outline outlineOf(const b2Fixture& fixture, int32 child, double unitsPerMetre, std::uint32_t key);

/// False for what no shell ever touches: sensors, and fixtures that collide with no category.
bool isSolid(const b2Fixture& fixture);

} // namespace supercircle::bridge
