#pragma once
// What Box2D 2.4.1 can carry: it answers most bad definitions by aborting the process, so they are refused before.

#include "supercircle/step/rigid_definition.h"

#include <string>

namespace supercircle::bridge {

/// Empty when the definition can be built, else one sentence: what, where, which limit.
std::string checkDefinition(const step::RigidWorldDefinition& definition);

} // namespace supercircle::bridge
