#pragma once
// Random changes of the Box2D world around the shells.

#include "bridge/box2d/include/supercircle/box2d.hpp"
#include "tests/fuzz/byte_source.h"

#include <box2d/box2d.h>

namespace supercircle::fuzz {

/// A disc or a box; null while the world is locked.
b2Body* addBody(b2World& world, ByteSource& bytes, b2BodyType type, const b2Vec2& at, float halfWidth,
                float halfHeight);
/// Null in an empty world.
b2Body* someBody(b2World& world, ByteSource& bytes);
/// Makes, destroys, teleports, throws or changes a body, or turns gravity; nothing while the world is locked.
void changeWorld(b2World& world, const bridge::Attachment& attachment, ByteSource& bytes);

} // namespace supercircle::fuzz
