#pragma once
// Box2D's own contacts and joints as the rows the core knows.

#include "bridge/box2d/body_registry.h"
#include "supercircle/step/host_constraints.h"

namespace supercircle::bridge {

/// Whether a contact acts on its bodies when it touches.
bool pushes(const b2Contact& contact);

/// What appendConstraints() walks with; its storage is kept from frame to frame.
struct ConstraintWork {
    std::vector<step::BodyId> found, in, done;
    std::vector<step::HostRow> rows;
};

/// Appends contacts and joints of `seeds` and of all dynamic bodies reached from them. `dt`: the coming step, s;
/// `lastDt`: the last one (impulses are of that), s. Gear joints are left out: they tie four bodies, and what they do
/// is followed from frame to frame instead.
void appendConstraints(const BodyRegistry& registry, const std::vector<step::BodyId>& seeds, double unitsPerMetre,
                       double dt, double lastDt, ConstraintWork& work, step::HostConstraints& out);

/// After a step of `dt` s: fills in Box2D's impulses of the constraints in `io` that still exist.
void readImpulses(const BodyRegistry& registry, double unitsPerMetre, double dt, ConstraintWork& work,
                  step::HostConstraints& io);

} // namespace supercircle::bridge
