#include "bridge/box2d/free_way.h"

#include "bridge/box2d/constraints.h"

#include <algorithm>
#include <box2d/b2_time_of_impact.h>
#include <cmath>

namespace supercircle::bridge {

namespace {

/// Whether a joint keeps two bodies from colliding.
bool joined(const b2Body& body, const b2Body* other) {
    for (const b2JointEdge* e = body.GetJointList(); e != nullptr; e = e->next)
        if (e->other == other && !e->joint->GetCollideConnected())
            return true;
    return false;
}

b2Sweep sweepOf(const b2Body& body, const Motion& motion) {
    b2Sweep s;
    s.localCenter = body.GetLocalCenter();
    s.c0 = body.GetWorldCenter();
    s.c = s.c0 + motion.way;
    s.a0 = body.GetAngle();
    s.a = s.a0 + motion.turn;
    s.alpha0 = 0.0F;
    return s;
}

bool touches(const b2Body& body, const Piece& p) {
    for (const b2ContactEdge* e = body.GetContactList(); e != nullptr; e = e->next) {
        const b2Contact& c = *e->contact;
        const bool isIts = (c.GetFixtureA() == p.fixture && c.GetChildIndexA() == p.child) ||
                           (c.GetFixtureB() == p.fixture && c.GetChildIndexB() == p.child);
        if (isIts && c.IsTouching())
            return true;
    }
    return false;
}

/// Share of the sweep of a fixture's child until it meets `still`, 1 also where they overlap at its start.
float shareUntil(const Piece& still, const b2Fixture& moving, int32 child, const b2Sweep& sweep) {
    b2TOIInput in;
    in.proxyA.Set(still.fixture->GetShape(), still.child);
    in.proxyB.Set(moving.GetShape(), child);
    in.sweepA = sweepOf(*still.body, {});
    in.sweepB = sweep;
    in.tMax = 1.0F;
    b2TOIOutput out;
    b2TimeOfImpact(&out, &in);
    return out.state == b2TOIOutput::e_touching ? out.t : 1.0F;
}

/// Share of a motion until the body meets an obstacle, 0 to 1.
/// @param isObstacle (piece, share until it is met)
template <class IsObstacle>
float freeShareOf(b2Body& body, const Motion& motion, const IsObstacle& isObstacle, OutlineQuery& query) {
    if (motion.way.Length() <= b2_linearSlop && std::abs(motion.turn) <= b2_angularSlop)
        return 1.0F;
    b2World& world = *body.GetWorld();
    b2ContactFilter* filter = world.GetContactManager().m_contactFilter;
    const b2Sweep sweep = sweepOf(body, motion);
    float share = 1.0F;
    for (b2Fixture* own = body.GetFixtureList(); own != nullptr; own = own->GetNext()) {
        if (own->IsSensor())
            continue;
        for (int32 child = 0; child < own->GetShape()->GetChildCount(); ++child)
            for (const Piece& p : query.now(world, sweptBox({&body, own, child}, motion))) {
                if (p.body->GetType() == b2_dynamicBody || joined(body, p.body) ||
                    (filter != nullptr && !filter->ShouldCollide(const_cast<b2Fixture*>(p.fixture), own)))
                    continue;
                if (const float until = shareUntil(p, *own, child, sweep); isObstacle(p, until))
                    share = std::min(share, until);
            }
    }
    return share;
}

} // namespace

void moveTo(b2Body& body, const b2Vec2& centre, float angle) {
    body.SetTransform(centre - b2Mul(b2Rot(angle), body.GetLocalCenter()), angle);
}

void moveAsFar(b2Body& body, const b2Vec2& centre, float angle, OutlineQuery& query) {
    Motion m{centre - body.GetWorldCenter(), angle - body.GetAngle()};
    const bool blocked = isBlocked(body, m.way);
    m.turn = blocked ? 0.0F : m.turn;
    const auto apart = [&](const Piece& p, float) { return !touches(body, p); }; // the others block it already
    const float share = freeShareOf(body, m, apart, query);
    if (!blocked && share >= 1.0F)
        moveTo(body, centre, angle);
    else
        moveTo(body, body.GetWorldCenter() + share * m.way, body.GetAngle() + share * m.turn);
}

void moveBack(b2Body& body, const b2Vec2& centre, float angle, const ForeseenBodies& frame, OutlineQuery& query) {
    if (const ForeseenBodies::Pose* start = frame.startOf(body)) {
        moveTo(body, start->centre, start->angle);
        const Motion m{centre - start->centre, angle - start->angle};
        const auto stood = [&](const Piece& p, float until) {
            return until > 0.0F && (p.body->GetType() == b2_staticBody || frame.stood(*p.body));
        };
        if (const float share = freeShareOf(body, m, stood, query); share < 1.0F) {
            moveTo(body, start->centre + share * m.way, start->angle + share * m.turn);
            return;
        }
    }
    moveTo(body, centre, angle);
}

} // namespace supercircle::bridge
