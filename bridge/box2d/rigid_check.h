#pragma once
// Limits of Box2D 2.4.1. It answers most invalid definitions by aborting the process, so they are refused before.

#include "supercircle/step/rigid_definition.h"

#include <string>

namespace supercircle::bridge {

/// Empty if the definition is valid, else one sentence: what is wrong, where, and the limit.
std::string checkDefinition(const step::RigidWorldDefinition& definition);

} // namespace supercircle::bridge
