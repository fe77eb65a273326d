#pragma once
// Rigid bodies and joints from plain definitions, in a Box2D world that exists.

#include "supercircle/step/rigid_definition.h"

#include <vector>

class b2Body;
class b2World;

namespace supercircle::bridge {

/// Makes the bodies, fixtures and joints of a definition that checkDefinition (rigid_check.h) has passed, with
/// definition.lengthScale host units per metre. In the order of the definition.
std::vector<b2Body*> buildBodies(const step::RigidWorldDefinition& definition, b2World& world);

} // namespace supercircle::bridge
