#pragma once
// Converts Box2D 3 shapes to outlines of the core.

#include "supercircle/step/port.h"

#include <box2d/box2d.h>

namespace supercircle::box2d3 {

/// A shape in SI units, in the frame of its body (origin at the centre of mass, unrotated). Capsules are segments with
/// a skin, rounded polygons polygons with one. Of the filter's 64 bits a category the lower 32 count.
contact::Outline outlineOf(b2ShapeId shape, double unitsPerMetre);

/// False for shapes that no shell touches: sensors, and shapes that collide with no category.
bool isSolid(b2ShapeId shape);

} // namespace supercircle::box2d3
