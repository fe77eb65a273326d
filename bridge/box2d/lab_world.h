#pragma once
// A Box2D world of the program's own, built from plain definitions. No Box2D header is needed to use it.

#include "supercircle/step/port.h"
#include "supercircle/step/rigid_definition.h"

#include <memory>
#include <string>

namespace supercircle::bridge {

/// Builds the bodies, fixtures and joints of `definition` in a world of `lengthScale` host units per metre. Null and a
/// message in `error` when the definition cannot be built: everything Box2D would abort on, weld away or round to
/// nothing is refused here, by name and with the limit that was met. Ids of its bodies are 1, 2, ... in the order of
/// the definition; find() knows their names.
///
/// Chains and loops run as in Box2D and its exporters: they hold what is on the right of v_i -> v_i+1 (a floor runs
/// leftwards, a container clockwise). Open chains end in free corners. A loop may repeat its first vertex or not.
/// Polygons may run either way round. Motor joints: anchorA is the linear offset, refAngle the angular one. Joints with
/// a frequency are soft, those with frequency 0 rigid (wheel: no spring).
std::unique_ptr<step::HostWorld> makeWorld(const step::RigidWorldDefinition& definition, std::string& error);

} // namespace supercircle::bridge
