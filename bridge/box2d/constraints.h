#pragma once
// Box2D's own contacts and joints as rows of the core's contact problem.

#include "bridge/box2d/body_registry.h"
#include "supercircle/step/host_constraints.h"

namespace supercircle::bridge {

/// True if a touching contact exerts forces on its bodies.
bool pushes(const b2Contact& contact);
/// Whether immovable bodies that a body touches block a displacement of it, which loses what is blocked.
bool isBlocked(const b2Body& body, b2Vec2& displacement);

/// Workspace of appendConstraints(); its storage is kept from frame to frame.
struct ConstraintWorkspace {
    std::vector<step::BodyId> found, in, done;
    std::vector<step::HostRow> rows;
};

/// Appends contacts and joints of `seeds` and of all dynamic bodies reached from them. `dt`: the next step, s;
/// `lastDt`: the last one, to which the impulses belong, s. Gear joints are left out, because they connect four bodies;
/// their effect is taken from frame to frame instead.
void appendConstraints(const BodyRegistry& registry, const std::vector<step::BodyId>& seeds, double unitsPerMetre,
                       double dt, double lastDt, ConstraintWorkspace& work, step::HostConstraints& out);

/// After a step of `dt` s: fills in Box2D's impulses of the constraints in `io` that still exist.
void readImpulses(const BodyRegistry& registry, double unitsPerMetre, double dt, ConstraintWorkspace& work,
                  step::HostConstraints& io);

} // namespace supercircle::bridge
