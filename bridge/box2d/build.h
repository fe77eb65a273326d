#pragma once
// Creates rigid bodies and joints from plain definitions in an existing Box2D world.

#include "supercircle/step/rigid_definition.h"

#include <vector>

class b2Body;
class b2World;

namespace supercircle::bridge {

/// Creates the bodies, fixtures and joints of a definition that has passed checkDefinition (rigid_check.h), with
/// definition.lengthScale host units per metre. Returns the bodies in the order of the definition.
std::vector<b2Body*> buildBodies(const step::RigidWorldDefinition& definition, b2World& world);

} // namespace supercircle::bridge
