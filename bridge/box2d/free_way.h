#pragma once
// How far a body gets that is put somewhere else, before it meets what cannot give way.

#include "bridge/box2d/foreseen_bodies.h"
#include "bridge/box2d/outline_query.h"

namespace supercircle::bridge {

/// Moves a body to a pose (centre of mass, host units; Box2D's own is that of the origin), whatever is there.
void moveTo(b2Body& body, const b2Vec2& centre, float angle);

/// The same in a straight line until it meets a static or kinematic body, which stands still meanwhile. Motions within
/// Box2D's slops are free.
void moveAsFar(b2Body& body, const b2Vec2& centre, float angle, OutlineQuery& query);

/// The same as if it had moved there from where it was at the start of the frame, and whatever it touched then. What
/// moved within the frame, such as a bat, does not stop it.
void moveBack(b2Body& body, const b2Vec2& centre, float angle, const ForeseenBodies& frame, OutlineQuery& query);

} // namespace supercircle::bridge
