// Rigid bodies by handle. Box2D ends the process on numbers that are not finite: all are checked here.

#include "bridge/box2d/box2d_port.h"
#include "bridge/c/include/supercircle_box2d.h"
#include "bridge/c/world.h"
#include "supercircle/support/trig.h"

using namespace supercircle::c;
using supercircle::BodyId;
using supercircle::step::BodyDefinition;
using supercircle::step::BodyType;
using supercircle::step::FixtureDefinition;
using supercircle::step::RigidWorldDefinition;
using supercircle::step::ShapeKind;
using supercircle::step::Vec2;

namespace {

constexpr double kFarthest = 1e6; ///< in Box2D units: beyond it floats resolve a tenth of a unit

constexpr int32_t kMostPoints = 10000; ///< of a line: twice as many cost twice the memory of a fixture list
constexpr double kFastest = 1e12;      ///< in Box2D units per second, rad/s: far below overflow

float hostNumber(double number, const char* what) {
    if (!(std::abs(number) < kFarthest))
        refuse(SC_BAD_INPUT, std::string(what) + " is not finite or above a million Box2D units");
    return static_cast<float>(number);
}

b2Vec2 hostPoint(sc_point p, double scale, const char* what) {
    return {hostNumber(p.x * scale, what), hostNumber(p.y * scale, what)};
}

sc_point fromHost(const b2Vec2& v, double scale) {
    return {static_cast<double>(v.x) / scale, static_cast<double>(v.y) / scale};
}

/// Numbered from the oldest, as everywhere; the list begins with the newest.
int32_t fixturesOf(const b2Body& body) {
    int32_t n = 0;
    for (const b2Fixture* f = body.GetFixtureList(); f != nullptr; f = f->GetNext())
        ++n;
    return n;
}

std::vector<b2Vec2> outlineOf(const b2Shape& shape) {
    std::vector<b2Vec2> points;
    if (shape.GetType() == b2Shape::e_polygon) {
        const auto& polygon = static_cast<const b2PolygonShape&>(shape);
        points.assign(polygon.m_vertices, polygon.m_vertices + polygon.m_count);
    } else if (shape.GetType() == b2Shape::e_chain) {
        const auto& chain = static_cast<const b2ChainShape&>(shape);
        points.assign(chain.m_vertices, chain.m_vertices + chain.m_count);
    } else if (shape.GetType() == b2Shape::e_edge) {
        const auto& edge = static_cast<const b2EdgeShape&>(shape);
        points = {edge.m_vertex1, edge.m_vertex2};
    } else {
        const auto& circle = static_cast<const b2CircleShape&>(shape);
        for (int i = 0; i < 32; ++i) {
            const auto a = supercircle::math::sinCos(2.0 * M_PI * i / 32.0);
            points.push_back(circle.m_p +
                             circle.m_radius * b2Vec2(static_cast<float>(a.cosine), static_cast<float>(a.sine)));
        }
    }
    return points;
}

FixtureDefinition shapeOf(const sc_body_def& d, const sc_point* points, int32_t count) {
    const bool byPoints = d.shape == SC_SHAPE_POLYGON || d.shape == SC_SHAPE_LINE;
    if (count < 0 || count > kMostPoints || (count > 0) != (points != nullptr) || (count > 0) != byPoints)
        refuse(SC_BAD_INPUT, byPoints ? "a polygon or line needs its points, at most 10000"
                                      : "a box or circle has no points: pass null and 0");
    if (d.shape == SC_SHAPE_LINE && d.type == SC_BODY_DYNAMIC)
        refuse(SC_BAD_INPUT, "a line has no mass: make the body static or kinematic");
    FixtureDefinition f;
    f.density = d.density;
    f.friction = d.friction;
    f.restitution = d.restitution;
    f.filterCategoryBits = bits16(d.category, "the category");
    f.filterMaskBits = bits16(d.mask, "the mask");
    f.filterGroupIndex = group16(d.group);
    f.radius = d.radius;
    for (int32_t i = 0; i < count; ++i)
        f.vertices.emplace_back(points[i].x, points[i].y);
    if (d.shape == SC_SHAPE_CIRCLE)
        f.shape = ShapeKind::Circle;
    if (d.shape == SC_SHAPE_LINE) {
        f.shape = ShapeKind::Chain;
        f.twoSided = true;
    }
    if (d.shape == SC_SHAPE_BOX) {
        if (!(d.width > 0.0 && d.height > 0.0))
            refuse(SC_BAD_INPUT, "a box needs a width and a height above 0 (m)");
        for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
            f.vertices.emplace_back(x * d.width, y * d.height);
    }
    return f;
}

} // namespace

void sc_body_def_init(sc_body_def* def) {
    if (def == nullptr)
        return;
    const FixtureDefinition f;
    *def = {};
    def->size = sizeof *def;
    def->type = SC_BODY_DYNAMIC;
    def->density = f.density;
    def->friction = f.friction;
    def->gravity_scale = 1.0;
    def->category = f.filterCategoryBits;
    def->mask = f.filterMaskBits;
}

sc_status sc_body_create(sc_world w, const sc_body_def* def, const char* name, const sc_point* points, int32_t count,
                         sc_body* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        x.requireUnlocked();
        const sc_body_def d = versioned(def, sc_body_def_init, sizeof(sc_body_def), "sc_body_def_init");
        requireChoice(d.type, 3, "type");
        requireChoice(d.shape, 4, "shape");
        BodyDefinition b;
        b.name = name != nullptr ? nameOf(name, "the name") : "";
        b.type = static_cast<BodyType>(d.type);
        b.position = {d.position.x, d.position.y};
        b.angle = d.angle;
        b.linearVelocity = {d.velocity.x, d.velocity.y};
        b.angularVelocity = d.spin;
        b.linearDamping = d.linear_damping;
        b.angularDamping = d.angular_damping;
        b.gravityScale = d.gravity_scale;
        b.fixedRotation = d.fixed_rotation != 0;
        b.bullet = d.bullet != 0;
        b.fixtures.push_back(shapeOf(d, points, count));
        RigidWorldDefinition rigid;
        rigid.gravity = x.attachment->gravity();
        rigid.bodies.push_back(std::move(b));
        if (const std::string why = x.attachment->build(rigid); !why.empty())
            refuse(SC_BAD_INPUT, why);
        *out = x.outBody(x.attachment.body_id(*x.box2d->GetBodyList())); // the list begins with the youngest
    });
}

sc_status sc_body_find(sc_world w, const char* name, sc_body* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        const std::string wanted = nameOf(name, "the name");
        *out = x.outBody(done(x.shells.body(wanted)));
    });
}

int32_t sc_world_bodies(sc_world w, sc_body* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        const int32_t count = x.box2d->GetBodyCount();
        int32_t place = count; // the list begins with the youngest
        for (const b2Body* b = x.box2d->GetBodyList(); b != nullptr; b = b->GetNext())
            if (--place < capacity)
                out[place] = x.outBody(x.attachment.body_id(*b));
        return count;
    });
}

int32_t sc_body_valid(sc_world w, sc_body b) {
    return validIn(w, [&](World& x) {
        const BodyId* body = x.bodyNames.find(b.id);
        return body != nullptr && x.attachment.body(*body) != nullptr;
    });
}

sc_status sc_body_state_of(sc_world w, sc_body b, sc_body_state* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        supercircle::step::BodyState s;
        const b2Body& body = x.in(b);
        if (!x.attachment->state(x.idOf(b), s))
            refuse(SC_STALE, "the body was destroyed");
        *out = {{s.centre.x(), s.centre.y()},
                s.angle,
                {s.velocity.x(), s.velocity.y()},
                s.spin,
                s.mass,
                s.inertia,
                static_cast<int32_t>(body.GetType()),
                s.awake ? 1 : 0};
    });
}

sc_status sc_body_set_pose(sc_world w, sc_body b, sc_point centre, double angle) {
    return use(w, [&](World& x) {
        x.requireUnlocked();
        b2Body& body = x.in(b);
        const b2Vec2 at = hostPoint(centre, x.scale, "the centre");
        const float turned = hostNumber(angle, "the angle");
        body.SetTransform(at - b2Mul(b2Rot(turned), body.GetLocalCenter()), turned);
    });
}

sc_status sc_body_set_velocity(sc_world w, sc_body b, sc_point velocity, double spin) {
    return use(w, [&](World& x) {
        x.requireUnlocked();
        b2Body& body = x.in(b);
        const b2Vec2 v = hostPoint(velocity, x.scale, "the velocity");
        const float turning = hostNumber(spin, "the spin");
        if (body.GetType() == b2_staticBody)
            refuse(SC_REFUSED, "a static body has no velocity; make it kinematic or dynamic");
        body.SetLinearVelocity(v);
        body.SetAngularVelocity(turning);
        body.SetAwake(true);
    });
}

sc_status sc_body_apply_impulse(sc_world w, sc_body b, sc_point impulse, sc_point at) {
    return use(w, [&](World& x) {
        x.requireUnlocked();
        b2Body& body = x.in(b);
        const b2Vec2 j = hostPoint(impulse, x.scale, "the impulse"), p = hostPoint(at, x.scale, "the point");
        if (body.GetType() != b2_dynamicBody)
            refuse(SC_REFUSED, "impulses move dynamic bodies only");
        const double speed = static_cast<double>(j.Length()) / static_cast<double>(body.GetMass());
        const double arm = static_cast<double>((p - body.GetWorldCenter()).Length());
        const double inertia = static_cast<double>(body.GetInertia());
        if (!(speed < kFastest && (inertia <= 0.0 || arm * static_cast<double>(j.Length()) / inertia < kFastest)))
            refuse(SC_BAD_INPUT, "the impulse is too strong for the mass of the body");
        body.ApplyLinearImpulse(j, p, true);
    });
}

int32_t sc_body_fixtures(sc_world w, sc_body b) {
    return countIn(w, [&](World& x) { return fixturesOf(x.in(b)); });
}

int32_t sc_body_outline(sc_world w, sc_body b, int32_t fixture, sc_point* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        const b2Body& body = x.in(b);
        const b2Fixture* f =
            fixture < 0 ? nullptr : x.attachment.fixture(x.idOf(b), static_cast<std::uint32_t>(fixture));
        if (f == nullptr)
            refuse(SC_BAD_INPUT, "the body has " + std::to_string(fixturesOf(body)) + " fixtures, numbered from 0");
        return copyOut(outlineOf(*f->GetShape()), out, capacity,
                       [&](const b2Vec2& p) { return fromHost(body.GetWorldPoint(p), x.scale); });
    });
}

sc_status sc_body_set_friction_material(sc_world w, sc_body b, uint32_t material) {
    return use(w, [&](World& x) { done(x.shells.set_friction_material(x.idOf(b), material)); });
}

sc_status sc_body_set_surface_speed(sc_world w, sc_body b, int32_t fixture, double speed) {
    return use(w, [&](World& x) {
        const BodyId body = x.idOf(b);
        if (fixture < -1 || fixture >= fixturesOf(x.in(b)))
            refuse(SC_BAD_INPUT, "there is no such fixture; -1 stands for all");
        done(x.shells.set_surface_speed(body, speed,
                                        fixture < 0 ? supercircle::all_fixtures : static_cast<std::uint32_t>(fixture)));
    });
}

sc_status sc_body_destroy(sc_world w, sc_body b) {
    return use(w, [&](World& x) {
        x.requireUnlocked();
        b2Body& body = x.in(b);
        x.attachment.notify_destroyed(body);
        x.box2d->DestroyBody(&body);
    });
}

sc_status sc_crosshead_attach(sc_world w, const char* body) {
    return use(w, [&](World& x) { done(x.shells.attach_to_crosshead(nameOf(body, "the name"))); });
}

sc_status sc_crosshead_set_velocity(sc_world w, sc_point velocity) {
    return use(w, [&](World& x) { done(x.shells.set_crosshead_velocity(in(velocity))); });
}

sc_status sc_crosshead_force(sc_world w, sc_point* result) {
    return use(w, [&](World& x) { given(result, "the result") = out(x.shells.crosshead_force()); });
}

sc_status sc_body_of(sc_world w, const b2Body* body, sc_body* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        const BodyId id = x.attachment.body_id(given(body, "the body"));
        if (id == 0)
            refuse(SC_BAD_INPUT, "this is no body of the world");
        *out = x.outBody(id);
    });
}

b2Body* sc_body_pointer(sc_world w, sc_body b) {
    return valueIn<b2Body*>(w, nullptr, [&](World& x) { return &x.in(b); });
}

sc_status sc_body_set_name(sc_world w, sc_body b, const char* name) {
    return use(w, [&](World& x) { x.attachment.set_name(x.in(b), nameOf(name, "the name")); });
}

sc_status sc_body_forget(sc_world w, sc_body b) {
    return use(w, [&](World& x) { x.attachment.notify_destroyed(x.in(b)); });
}
