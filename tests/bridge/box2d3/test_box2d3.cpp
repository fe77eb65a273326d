// Shells in Box2D 3 worlds through the public headers, as a program uses them, and through the port for what shows only
// there.

#include "bridge/box2d3/box2d3_port.h"

#include <algorithm>
#include <array>
#include <box2d/box2d.h>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <supercircle/box2d3.hpp>
#include <supercircle/shells.hpp>
#include <vector>

using namespace supercircle;

namespace {

constexpr double kFall = 10.0; // m/s^2
constexpr int kSubsteps = 4;
constexpr double kDt = 1.0 / 60.0; // s

/// A world with a static box whose upper face is y = 0; one unit is a metre.
class Ground {
public:
    Ground() {
        b2WorldDef def = b2DefaultWorldDef();
        def.gravity = {0.0F, static_cast<float>(-kFall)};
        world = b2CreateWorld(&def);
        ground = body(b2_staticBody, 0.0F, -10.0F);
        box(ground, 50.0F, 10.0F, 0.0);
    }
    ~Ground() {
        if (b2World_IsValid(world))
            b2DestroyWorld(world);
    }
    Ground(const Ground&) = delete;
    Ground& operator=(const Ground&) = delete;

    b2BodyId body(b2BodyType type, float x, float y) const {
        b2BodyDef def = b2DefaultBodyDef();
        def.type = type;
        def.position = {x, y};
        return b2CreateBody(world, &def);
    }
    static b2ShapeId box(b2BodyId body, float halfX, float halfY, double mass) {
        b2ShapeDef def = b2DefaultShapeDef();
        def.density = static_cast<float>(mass) / (4.0F * halfX * halfY);
        const b2Polygon shape = b2MakeBox(halfX, halfY);
        return b2CreatePolygonShape(body, &def, &shape);
    }
    void frames(Shells& shells, int count, double dt = kDt) const {
        for (int i = 0; i < count; ++i) {
            const auto report = shells.pre_step(dt);
            INFO(report.failure);
            REQUIRE(report.failure.empty());
            b2World_Step(world, static_cast<float>(report.advanced), kSubsteps);
            REQUIRE(shells.post_step());
        }
    }

    b2WorldId world{};
    b2BodyId ground{};
};

ShellDef dome() {
    ShellDef d = scaled_shell(1.0, 2.0, 0.5);
    d.angle = std::numbers::pi;
    d.position = {0.0, 1.0 + 0.5 * d.thickness + 0.001};
    return d;
}

/// The only outline of the body.
step::BodyOutline outline(const box2d3::Attachment& port, b2BodyId body) {
    std::vector<step::BodyOutline> all;
    port->everything(all);
    const step::BodyOutline* found = nullptr;
    for (const auto& o : all)
        if (o.body == port.body_id(body)) {
            REQUIRE(found == nullptr);
            found = &o;
        }
    REQUIRE(found != nullptr);
    return *found;
}

} // namespace

TEST_CASE("box2d3: a shell dropped on a static box comes to rest on it", "[box2d3]") {
    Ground g;
    Shells shells(box2d3::attach(g.world));
    ShellDef d = scaled_shell(1.0, 2.0);
    d.position = {0.3, 0.5};
    const auto shell = shells.create(d);
    REQUIRE(shell);
    g.frames(shells, 600);
    const auto m = shells.state(*shell);
    REQUIRE(m);
    CHECK(std::abs(m->box.lower.y) < 0.01 * d.thickness);         // true faces, without Box2D's skin
    CHECK(m->kinetic_energy < 1e-6 * m->mass * kFall * d.radius); // a millionth of the fall's
}

TEST_CASE("box2d3: a crate stands on a dome", "[box2d3]") {
    Ground g;
    Shells shells(box2d3::attach(g.world, {1.0, kSubsteps}));
    const ShellDef d = dome();
    const auto shell = shells.create(d);
    REQUIRE(shell);
    g.frames(shells, 120); // sags under its own weight
    const double top = shells.state(*shell)->box.upper.y;
    // Lower than the dome's radius of curvature: it does not roll off.
    const b2BodyId crate = g.body(b2_dynamicBody, 0.0F, static_cast<float>(top + 0.1));
    Ground::box(crate, 0.2F, 0.1F, 0.4);
    g.frames(shells, 600);
    const auto m = shells.state(*shell);
    const double bottom = static_cast<double>(b2Body_GetWorldCenterOfMass(crate).y) - 0.1;
    CAPTURE(top, bottom, m->box.upper.y, m->kinetic_energy, d.thickness);
    // It stands level up to a tilt within the tolerance. A fiftieth of a thickness may remain between the copy and the
    // original of a body (host coupling in step/).
    CHECK(std::abs(bottom - m->box.upper.y) < 0.05 * d.thickness);
    CHECK(bottom < top); // the dome carries it and deforms
    CHECK(bottom > 0.5);
    CHECK(static_cast<double>(b2Length(b2Body_GetLinearVelocity(crate))) < 1e-3);
}

TEST_CASE("box2d3: the original of a falling body goes where its copy goes", "[box2d3]") {
    // A body near shells, but in no contact, given the velocity of free fall's mean: after a frame it is where exact
    // free fall has it, although Box2D's substeps alone lag by g T^2 / (2 n).
    Ground g;
    const auto port = box2d3::attach(g.world, {1.0, kSubsteps});
    const b2BodyId crate = g.body(b2_dynamicBody, 0.0F, 5.0F);
    Ground::box(crate, 0.1F, 0.1F, 1.0);
    const auto id = port.body_id(crate);
    for (const float damping : {0.0F, 2.0F}) {
        b2Body_SetTransform(crate, {0.0F, 5.0F}, b2Rot_identity);
        b2Body_SetLinearVelocity(crate, {0.0F, 0.0F});
        b2Body_SetAngularVelocity(crate, 0.0F);
        b2Body_SetLinearDamping(crate, damping);
        b2Body_SetAngularDamping(crate, damping);
        step::HostConstraints none;
        port->constraints({id}, kDt, none);
        CHECK(none.contacts.empty());
        step::BodyState s;
        REQUIRE(port->state(id, s));
        const step::Vec2 mean(0.3, -0.5 * kFall * kDt);
        const double slow = 1.0 + kDt * s.linearDamping;
        const step::Vec2 impulse = s.mass * (slow * mean - s.velocity - kDt * port->gravity());
        const double spin = 0.7;
        port->applyImpulse(id, impulse, s.inertia * (1.0 + kDt * s.angularDamping) * spin);
        b2World_Step(g.world, static_cast<float>(kDt), kSubsteps);
        port->impulses(kDt, none);
        REQUIRE(port->state(id, s));
        const step::Vec2 way = s.centre - step::Vec2(0.0, 5.0);
        CHECK((way - kDt * mean).norm() < 2e-6); // floats at 5 m: 5e-7 a substep
        CHECK(std::abs(s.angle - kDt * spin) < 1e-6);
        CHECK((s.velocity - mean).norm() < 1e-6); // the core reads back the velocity it applied
        CHECK(std::abs(s.spin - spin) < 1e-6);
    }
}

TEST_CASE("box2d3: the loop of the hello example", "[box2d3]") {
    Ground g;
    const b2BodyId crate = g.body(b2_dynamicBody, 0.0F, 4.0F);
    Ground::box(crate, 0.5F, 0.5F, 1.0);
    Shells shells(box2d3::attach(g.world));
    REQUIRE(shells.set_quality(Quality::Game));
    ShellDef def = scaled_shell(1.0, 2.0);
    def.position = {3.0, 4.0};
    const auto shell = shells.create(def);
    REQUIRE(shell);
    g.frames(shells, 300);
    CHECK(std::abs(static_cast<double>(b2Body_GetPosition(crate).y) - 0.5) < 0.02); // four of Box2D's slops
    CHECK(std::abs(shells.state(*shell)->box.lower.y) < def.thickness);             // still rocking
}

TEST_CASE("box2d3: bodies and worlds may be destroyed", "[box2d3]") {
    Ground g;
    const auto port = box2d3::attach(g.world);
    Shells shells(port);
    const b2BodyId shelf = g.body(b2_staticBody, 0.0F, 1.0F);
    Ground::box(shelf, 2.0F, 0.1F, 0.0);
    port.set_name(shelf, "shelf");
    const auto id = port.body_id(shelf);
    CHECK(id != 0);
    CHECK(port->find("shelf") == id);
    ShellDef d = scaled_shell(1.0, 2.0);
    d.position = {0.0, 1.1 + d.thickness};
    const auto shell = shells.create(d);
    g.frames(shells, 60);
    CHECK(shells.state(*shell)->box.lower.y > 1.0);
    b2DestroyBody(shelf);
    CHECK(port->find("shelf") == 0);
    CHECK(port.body_id(shelf) == 0);
    step::BodyState s;
    CHECK_FALSE(port->state(id, s));
    const b2BodyId next = g.body(b2_staticBody, 30.0F, 1.0F); // takes the slot
    CHECK(port.body_id(next) != id);
    g.frames(shells, 180);
    CHECK(shells.state(*shell)->box.lower.y < 0.1); // fell on the ground
    port->applyImpulse(id, {1.0, 0.0}, 0.0);
    CHECK(port.error_count() == 1);
    port->applyImpulse(port.body_id(g.ground), {std::numeric_limits<double>::quiet_NaN(), 0.0}, 0.0);
    CHECK(port.error_count() == 2);
    b2DestroyWorld(g.world);
    CHECK_FALSE(port->state(port.body_id(next), s));
    CHECK(shells.pre_step(kDt).failure.empty());
    CHECK(shells.post_step());
    CHECK_THROWS_AS(box2d3::attach(g.world), std::invalid_argument);
}

TEST_CASE("box2d3: two worlds with equal histories are bitwise identical", "[box2d3]") {
    Ground a, b;
    const auto portA = box2d3::attach(a.world), portB = box2d3::attach(b.world);
    Shells inA(portA), inB(portB);
    for (const auto& [ground, shells] : {std::pair{&a, &inA}, std::pair{&b, &inB}}) {
        const b2BodyId crate = ground->body(b2_dynamicBody, 0.1F, 2.3F);
        Ground::box(crate, 0.2F, 0.1F, 0.4);
        REQUIRE(shells->create(dome()));
    }
    CHECK(portA.body_id(b.ground) == 0);
    for (int i = 0; i < 60; ++i) { // alternately: the worlds are independent
        a.frames(inA, 1);
        b.frames(inB, 1);
    }
    CHECK(inA.hash() == inB.hash());
}

TEST_CASE("box2d3: outlines of all shapes", "[box2d3]") {
    Ground g;
    constexpr double kScale = 50.0;
    const auto port = box2d3::attach(g.world, {kScale, kSubsteps});
    b2ShapeDef def = b2DefaultShapeDef();
    def.material.friction = 0.25F;
    def.filter.categoryBits = 4;
    def.filter.maskBits = 6;
    def.filter.groupIndex = -3;
    SECTION("circle with its filter and friction") {
        const b2BodyId b = g.body(b2_kinematicBody, 5.0F, 5.0F);
        const b2Circle c = {{1.0F, 2.0F}, 0.5F};
        b2CreateCircleShape(b, &def, &c);
        const auto o = outline(port, b);
        CHECK(o.local.kind == contact::OutlineKind::Circle);
        CHECK(o.local.radius == Approx(0.5 / kScale));
        CHECK(o.local.points.at(0).isApprox(step::Vec2(1.0, 2.0) / kScale));
        CHECK(o.friction == Approx(0.25));
        CHECK(o.local.category == 4);
        CHECK(o.local.mask == 6);
        CHECK(o.local.group == -3);
    }
    SECTION("capsule, rounded polygon: skins, about the centre of mass") {
        const b2BodyId b = g.body(b2_dynamicBody, 5.0F, 5.0F);
        const b2Capsule c = {{0.0F, 0.0F}, {2.0F, 0.0F}, 0.25F};
        b2CreateCapsuleShape(b, &def, &c);
        const auto o = outline(port, b);
        CHECK(o.local.kind == contact::OutlineKind::Segment);
        CHECK(o.local.radius == Approx(0.25 / kScale));
        CHECK(o.local.points.at(0).x() == Approx(-1.0 / kScale));
        CHECK(o.local.points.at(1).x() == Approx(1.0 / kScale));
        const b2BodyId r = g.body(b2_staticBody, 9.0F, 5.0F);
        const b2Polygon p = b2MakeRoundedBox(1.0F, 0.5F, 0.125F);
        b2CreatePolygonShape(r, &def, &p);
        CHECK(outline(port, r).local.radius == Approx(0.125 / kScale));
        CHECK(outline(port, r).local.points.size() == 4);
    }
    SECTION("sensors and masks of nothing are not solid") {
        const b2BodyId b = g.body(b2_staticBody, 5.0F, 5.0F);
        const b2Circle c = {{0.0F, 0.0F}, 0.5F};
        def.isSensor = true;
        b2CreateCircleShape(b, &def, &c);
        def.isSensor = false;
        def.filter.maskBits = 0;
        b2CreateCircleShape(b, &def, &c);
        std::vector<step::BodyOutline> all;
        port->everything(all);
        CHECK(all.size() == 1); // the ground
    }
    SECTION("an open chain has free corners at its ends, a loop none") {
        const std::array<b2Vec2, 5> points = {{{4.0F, 0.0F}, {3.0F, 0.0F}, {2.0F, 0.5F}, {1.0F, 0.0F}, {0.0F, 0.0F}}};
        b2ChainDef chain = b2DefaultChainDef();
        chain.points = points.data();
        chain.count = 5;
        b2CreateChain(g.body(b2_staticBody, 0.0F, 5.0F), &chain);
        std::vector<step::BodyOutline> all;
        port->everything(all);
        REQUIRE(all.size() == 3); // the ground and two segments: Box2D has none at the ends
        CHECK(all[1].local.points.at(1).isApprox(step::Vec2(3.0, 0.0) / kScale));
        CHECK(all[1].local.joinedStart);
        CHECK_FALSE(all[1].local.joinedEnd);
        CHECK_FALSE(all[2].local.joinedStart);
        CHECK(all[2].local.joinedEnd);
        chain.isLoop = true;
        b2CreateChain(g.body(b2_staticBody, 20.0F, 5.0F), &chain);
        all.clear();
        port->everything(all);
        REQUIRE(all.size() == 8);
        for (std::size_t i = 3; i < all.size(); ++i)
            CHECK((all[i].local.joinedStart && all[i].local.joinedEnd));
    }
}

TEST_CASE("box2d3: a shell rests on chain, segment and capsule where Box2D's own bodies do", "[box2d3]") {
    Ground g;
    const b2BodyId wall = g.body(b2_staticBody, 0.0F, 2.0F);
    double face = 2.0;
    b2ShapeDef def = b2DefaultShapeDef();
    const int kind = GENERATE(0, 1, 2);
    if (kind == 0) { // solid below: from right to left, Box2D holds what is on the right of it
        const std::array<b2Vec2, 6> points = {
            {{9.0F, 0.0F}, {6.0F, 0.0F}, {1.0F, 0.0F}, {-1.0F, 0.0F}, {-6.0F, 0.0F}, {-9.0F, 0.0F}}};
        b2ChainDef chain = b2DefaultChainDef();
        chain.points = points.data();
        chain.count = 6;
        b2CreateChain(wall, &chain);
    } else if (kind == 1) {
        const b2Segment s = {{-6.0F, 0.0F}, {6.0F, 0.0F}};
        b2CreateSegmentShape(wall, &def, &s);
    } else {
        const b2Capsule c = {{-6.0F, 0.0F}, {6.0F, 0.0F}, 0.25F};
        b2CreateCapsuleShape(wall, &def, &c);
        face = 2.25;
    }
    const b2BodyId ball = g.body(b2_dynamicBody, 4.0F, 3.0F);
    const b2Circle c = {{0.0F, 0.0F}, 0.3F};
    b2CreateCircleShape(ball, &def, &c);
    Shells shells(box2d3::attach(g.world));
    ShellDef d = scaled_shell(1.0, 2.0);
    d.position = {0.0, face + 0.1};
    const auto shell = shells.create(d);
    g.frames(shells, 240);
    CAPTURE(kind);
    CHECK(std::abs(static_cast<double>(b2Body_GetPosition(ball).y) - face - 0.3) < 0.02);
    CHECK(std::abs(shells.state(*shell)->box.lower.y - face) < 0.05 * d.thickness);
}

namespace {

struct Stillness {
    double gap = 0.0;   ///< largest, thicknesses
    double speed = 0.0; ///< largest of any crate, m/s
    double lift = 0.0;  ///< of the lowest crate above where the unloaded dome's top was, m; a crate lost falls far
};

/// A dome with a crate of `mass` kg, and one of `ratio` times as much on it; the last second of six.
Stillness standing(int substeps, double dt, double mass, double ratio) {
    Ground g;
    Shells shells(box2d3::attach(g.world, {1.0, substeps}));
    const ShellDef d = dome();
    const auto shell = shells.create(d);
    g.frames(shells, static_cast<int>(2.0 / dt), dt);
    const double top = shells.state(*shell)->box.upper.y;
    std::vector<b2BodyId> crates;
    for (const double m : {mass, mass * ratio})
        if (m > 0.0) {
            const double y = top + 0.1 + 0.2 * static_cast<double>(crates.size());
            crates.push_back(g.body(b2_dynamicBody, 0.0F, static_cast<float>(y)));
            Ground::box(crates.back(), 0.2F, 0.1F, m);
        }
    Stillness worst;
    for (int i = 0; i < static_cast<int>(6.0 / dt); ++i) {
        g.frames(shells, 1, dt);
        if (i * dt < 5.0)
            continue;
        const double bottom = static_cast<double>(b2Body_GetWorldCenterOfMass(crates[0]).y) - 0.1;
        worst.gap = std::max(worst.gap, std::abs(bottom - shells.state(*shell)->box.upper.y) / d.thickness);
        worst.lift = bottom - top;
        for (const b2BodyId b : crates)
            worst.speed = std::max(worst.speed, static_cast<double>(b2Length(b2Body_GetLinearVelocity(b))));
    }
    return worst;
}

} // namespace

// tests/test_box2d3 '[limits]' prints the figures of the documentation.
TEST_CASE("box2d3: residual motion of crates on a dome", "[.][box2d3][limits]") {
    std::printf("substeps substeps, T, crate kg, ratio of the one on it: gap / h, speed m/s, lift m\n");
    for (const int substeps : {kSubsteps, 1})
        for (const double dt : {1.0 / 60.0, 1.0 / 240.0})
            for (const double mass : {0.02, 0.4})
                for (const double ratio : {0.0, 1.0, 10.0, 100.0}) {
                    const Stillness s = standing(substeps, dt, mass, ratio);
                    std::printf("%d 1/%-3.0f %5.3f %3.0f: %8.1e %8.1e %6.3f\n", substeps, 1.0 / dt, mass, ratio, s.gap,
                                s.speed, s.lift);
                }
}
