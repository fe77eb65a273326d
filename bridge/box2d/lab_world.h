#pragma once
// A Box2D world owned by the program, built from plain definitions. No Box2D header is needed to use it.

#include "supercircle/step/port.h"
#include "supercircle/step/rigid_definition.h"

#include <memory>
#include <string>

namespace supercircle::bridge {

/// Builds the bodies, fixtures and joints of `definition` in a world of `lengthScale` host units per metre. Returns
/// null and a message in `error` if the definition is invalid: everything on which Box2D would abort, or that it would
/// merge or round to zero, is refused with its name and the limit. Ids of the bodies are 1, 2, ... in the order of the
/// definition; find() knows their names.
///
/// Chains and loops are oriented as in Box2D and its exporters: bodies stay on the right of v_i -> v_i+1 (a floor runs
/// leftwards, a container clockwise). Open chains end in free corners. A loop may repeat its first vertex or not.
/// Polygons may have either orientation. Motor joints: anchorA is the linear offset, refAngle the angular one. Joints
/// with a frequency are soft, those with frequency 0 rigid (wheel: no spring).
std::unique_ptr<step::HostWorld> makeWorld(const step::RigidWorldDefinition& definition, std::string& error);

} // namespace supercircle::bridge
