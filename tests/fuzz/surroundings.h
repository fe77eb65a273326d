#pragma once
// What a game does to the Box2D world around the shells, at random.

#include "bridge/box2d/include/supercircle/box2d.hpp"
#include "tests/fuzz/tape.h"

#include <box2d/box2d.h>

namespace supercircle::fuzz {

/// A disc or a box; null while the world is locked.
b2Body* addBody(b2World& world, Tape& tape, b2BodyType type, const b2Vec2& at, float halfWidth, float halfHeight);
/// Null in an empty world.
b2Body* someBody(b2World& world, Tape& tape);
/// Makes, destroys, teleports, throws or changes a body, or turns gravity; nothing while the world is locked.
void disturb(b2World& world, const bridge::Attachment& attachment, Tape& tape);

} // namespace supercircle::fuzz
