#include "definitions.h"

#include "bridge/box2d/lab_world.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace supercircle;
using namespace supercircle::step;
using namespace supercircle::bridge_test;

const double kScales[] = {1.0, 10.0, 52.1, 1000.0};

TEST_CASE("definitions survive the length scale", "[bridge]") {
    for (const double scale : kScales) {
        INFO("scale " << scale);
        BodyDefinition b = body(BodyType::Dynamic, box(0.02, 0.03), "crate");
        b.position = Vec2(0.13, -0.27);
        b.angle = 0.4;
        b.linearVelocity = Vec2(0.5, -0.25);
        b.angularVelocity = 3.0;
        b.linearDamping = 0.1;
        b.angularDamping = 0.2;
        b.gravityScale = 0.5;
        b.fixtures[0].friction = 0.35;
        auto world = build(worldWith(b, scale));
        CHECK(world->unitsPerMetre() == scale);
        CHECK(world->gravity().y() == Approx(-9.81).epsilon(1e-6)); // single precision from here on
        const BodyId id = world->find("crate");
        REQUIRE(id == 1);
        CHECK(world->find("nobody") == 0);
        BodyState s;
        REQUIRE(world->state(id, s));
        CHECK_FALSE(world->state(id + 1, s));
        REQUIRE(world->state(id, s));
        CHECK((s.centre - b.position).norm() < 1e-6);
        CHECK(s.angle == Approx(0.4).epsilon(1e-6));
        CHECK((s.velocity - b.linearVelocity).norm() < 1e-6);
        CHECK(s.spin == Approx(3.0).epsilon(1e-6));
        // m = rho 4 a b, I = m (4a^2 + 4b^2)/12
        CHECK(s.mass == Approx(2.4).epsilon(1e-5));
        CHECK(s.inertia == Approx(2.4 * (0.0016 + 0.0036) / 12.0).epsilon(1e-5));
        CHECK(s.linearDamping == Approx(0.1).epsilon(1e-6));
        CHECK(s.angularDamping == Approx(0.2).epsilon(1e-6));
        CHECK(s.gravityScale == 0.5);
        CHECK(s.awake);
        CHECK(s.enabled);
        CHECK(s.moving);

        std::vector<BodyOutline> all;
        world->everything(all);
        REQUIRE(all.size() == 1);
        CHECK(all[0].body == id);
        CHECK(all[0].friction == Approx(0.35).epsilon(1e-6));
        CHECK(all[0].local.kind == contact::OutlineKind::Polygon);
        CHECK(all[0].local.radius == 0.0); // true faces, no skin
        REQUIRE(all[0].local.points.size() == 4);
        for (const Vec2& p : all[0].local.points) {
            CHECK(std::abs(p.x()) == Approx(0.02).epsilon(1e-6));
            CHECK(std::abs(p.y()) == Approx(0.03).epsilon(1e-6));
        }
        const Vec2 e0 = all[0].local.points[1] - all[0].local.points[0];
        const Vec2 e1 = all[0].local.points[2] - all[0].local.points[1];
        CHECK(rod::cross(e0, e1) > 0.0); // counter-clockwise
    }
}

TEST_CASE("free fall follows g t^2 / 2 at every scale", "[bridge]") {
    for (const double scale : kScales) {
        INFO("scale " << scale);
        auto world = build(worldWith(body(BodyType::Dynamic, box(0.02, 0.02), "b"), scale));
        // Semi-implicit Euler falls g dt^2 n (n + 1)/2 exactly: g t^2/2 plus g t dt/2. Host speeds stay below its cap
        // of 2 units a step: 1000 units/m * 9.81 * 0.2 s * 1 ms = 1.96.
        const int n = 200;
        const double dt = 1e-3;
        for (int i = 0; i < n; ++i)
            world->step(dt);
        BodyState s;
        REQUIRE(world->state(1, s));
        const double t = n * dt;
        CHECK(s.centre.y() == Approx(-9.81 * t * (t + dt) / 2.0).epsilon(2e-5)); // 200 float additions
        CHECK(s.centre.y() == Approx(-9.81 * t * t / 2.0).epsilon(2.0 * dt / t));
        CHECK(s.velocity.y() == Approx(-9.81 * t).epsilon(2e-5));
        CHECK(std::abs(s.centre.x()) < 1e-8); // the centre of mass is a rounded sum over triangles: one ulp of 0.02 m
    }
}

TEST_CASE("impulses change velocities by their closed forms and wake", "[bridge]") {
    for (const double scale : kScales) {
        INFO("scale " << scale);
        RigidWorldDefinition d = worldWith(body(BodyType::Dynamic, box(0.02, 0.03, Vec2(0.05, -0.01)), "b"), scale);
        d.gravity = Vec2::Zero();
        d.bodies[0].awake = false;
        d.bodies[0].angle = 0.3;
        auto world = build(d);
        BodyState before;
        REQUIRE(world->state(1, before));
        CHECK_FALSE(before.awake);
        world->applyImpulse(1, Vec2::Zero(), 0.0);
        REQUIRE(world->state(1, before));
        CHECK_FALSE(before.awake); // a zero impulse does not wake a body
        // Off-centre fixture: inertia about the centre of mass, not the origin.
        const double mass = 2.4;
        const double inertia = mass * (0.0016 + 0.0036) / 12.0;
        CHECK(before.inertia == Approx(inertia).epsilon(1e-4)); // float difference of I_origin (6 times I) and m c^2
        const Vec2 centre(0.05 * std::cos(0.3) + 0.01 * std::sin(0.3), 0.05 * std::sin(0.3) - 0.01 * std::cos(0.3));
        CHECK((before.centre - centre).norm() < 1e-7);

        world->applyImpulse(1, Vec2(0.12, -0.24), 1e-3);
        BodyState s;
        REQUIRE(world->state(1, s));
        CHECK(s.awake);
        CHECK(s.velocity.x() == Approx(0.12 / mass).epsilon(1e-5));
        CHECK(s.velocity.y() == Approx(-0.24 / mass).epsilon(1e-5));
        CHECK(s.spin == Approx(1e-3 / inertia).epsilon(1e-4));
        world->step(0.01); // the impulse acts on the next step
        BodyState after;
        REQUIRE(world->state(1, after));
        CHECK((after.centre - s.centre - 0.01 * s.velocity).norm() < 1e-6);
    }
}

TEST_CASE("fixed rotation is infinite inertia, static and kinematic bodies are infinite mass", "[bridge]") {
    RigidWorldDefinition d = worldWith(body(BodyType::Dynamic, box(0.02, 0.02, Vec2(0.1, 0.0))));
    d.bodies[0].fixedRotation = true;
    d.bodies.push_back(body(BodyType::Static, box(0.02, 0.02)));
    d.bodies.push_back(body(BodyType::Kinematic, box(0.02, 0.02)));
    auto world = build(d);
    BodyState s;
    REQUIRE(world->state(1, s));
    CHECK(s.mass > 0.0);
    CHECK(s.inertia == 0.0);
    REQUIRE(world->state(2, s));
    CHECK(s.mass == 0.0);
    CHECK(s.inertia == 0.0);
    CHECK_FALSE(s.moving);
    REQUIRE(world->state(3, s));
    CHECK(s.mass == 0.0);
    CHECK(s.moving);
}

TEST_CASE("mass data replace the masses of the fixtures", "[bridge]") {
    RigidWorldDefinition d = worldWith(body(BodyType::Dynamic, box(0.02, 0.02)));
    d.bodies[0].massData = MassData{2.0, Vec2(0.01, 0.02), 3e-3};
    auto world = build(d);
    BodyState s;
    REQUIRE(world->state(1, s));
    CHECK(s.mass == 2.0);
    CHECK((s.centre - Vec2(0.01, 0.02)).norm() < 1e-8);
    CHECK(s.inertia == Approx(3e-3 - 2.0 * 5e-4).epsilon(1e-6)); // given about the origin
    d.bodies[0].massData->inertia = 0.9e-3;
    CHECK(errorOf(d).find("inertia") != std::string::npos);
}

TEST_CASE("two-sided chains become segments", "[bridge]") {
    FixtureDefinition edge;
    edge.shape = ShapeKind::Chain;
    edge.twoSided = true;
    edge.vertices = {{-0.2, 0.1}, {0.2, 0.1}};
    auto world = build(worldWith(body(BodyType::Static, edge)));
    std::vector<BodyOutline> all;
    world->everything(all);
    REQUIRE(all.size() == 1);
    CHECK(all[0].local.kind == contact::OutlineKind::Segment);
    CHECK((all[0].local.points[0] - Vec2(-0.2, 0.1)).norm() < 1e-7);
    CHECK((all[0].local.points[1] - Vec2(0.2, 0.1)).norm() < 1e-7);
}

TEST_CASE("a driven body does not drift", "[bridge]") {
    // A plate at 5 mm/s for 10^5 steps of 1e-4 s: 0.5 um a step, which single precision rounds by several per cent.
    RigidWorldDefinition d = worldWith(body(BodyType::Kinematic, box(0.1, 0.005), "plate"));
    d.bodies[0].position = Vec2(0.0, 0.2);
    auto world = build(d);
    const BodyId plate = world->find("plate");
    const double dt = 1e-4;
    double worst = 0.0;
    double worstHost = 0.0;
    Vec2 centre(0.0, 0.2);
    const Vec2 velocity(0.0, -0.005);
    BodyState s;
    for (int i = 0; i < 100000; ++i) {
        world->drive(plate, centre, 0.0, velocity, 0.0);
        world->step(dt);
        centre = Vec2(0.0, 0.2 - 0.005 * dt * (i + 1));
        REQUIRE(world->state(plate, s));
        worst = std::max(worst, (s.centre - centre).norm());
        if (i % 1000 == 0) { // as Box2D itself reports it: an outline's world place through query
            std::vector<BodyOutline> hit;
            const double face = centre.y() - 0.005;
            world->query({Vec2(-0.01, face - 1.0), Vec2(0.01, face - 2e-3)}, hit);
            worstHost = std::max(worstHost, hit.empty() ? 0.0 : 1.0);
        }
    }
    CHECK(s.velocity == velocity);
    CHECK(worst < 1e-12);    // the exact pose is kept to doubles
    CHECK(worstHost == 0.0); // and Box2D's is where it should be, within its 10 mm unit skin
    CHECK(s.centre.y() == Approx(0.15).epsilon(1e-12));
}

TEST_CASE("a driven body moves and rotates as prescribed", "[bridge]") {
    RigidWorldDefinition d = worldWith(body(BodyType::Kinematic, box(0.1, 0.005, Vec2(0.03, 0.0)), "arm"));
    auto world = build(d);
    world->drive(1, Vec2(0.1, 0.2), 0.5, Vec2(0.01, 0.0), 2.0);
    BodyState s;
    REQUIRE(world->state(1, s));
    CHECK(s.centre == Vec2(0.1, 0.2));
    CHECK(s.angle == 0.5);
    CHECK(s.spin == 2.0);
    world->step(0.01);
    REQUIRE(world->state(1, s));
    CHECK((s.centre - Vec2(0.1001, 0.2)).norm() < 1e-12);
    CHECK(s.angle == Approx(0.52).epsilon(1e-12));
    world->step(0.01); // not driven again: it continues
    REQUIRE(world->state(1, s));
    CHECK((s.centre - Vec2(0.1002, 0.2)).norm() < 1e-12);
}

TEST_CASE("chains become one-sided edges with their neighbours", "[bridge]") {
    RigidWorldDefinition d;
    d.lengthScale = 52.1;
    FixtureDefinition chain;
    chain.shape = ShapeKind::Chain;
    chain.vertices = {{-0.2, 0.3}, {-0.2, 0.0}, {0.2, 0.0}, {0.2, 0.3}};
    FixtureDefinition loop;
    loop.shape = ShapeKind::Loop;
    loop.vertices = {{1.0, 1.0}, {1.0, 2.0}, {2.0, 2.0}, {2.0, 1.0}}; // clockwise: a container
    BodyDefinition b = body(BodyType::Static, chain);
    b.fixtures.push_back(loop);
    d.bodies = {b};
    auto world = build(d);
    std::vector<BodyOutline> all;
    world->everything(all);
    REQUIRE(all.size() == 7);
    for (std::size_t i = 0; i < all.size(); ++i) {
        CHECK(all[i].local.key == i); // fixture order, then child
        CHECK(all[i].local.kind == contact::OutlineKind::OneSided);
        REQUIRE(all[i].local.points.size() == 2);
    }
    const auto near = [](const Vec2& a, const Vec2& p) { return (a - p).norm() < 1e-6; };
    // The core's solid is on the right, Box2D holds what is on the right: edges are reversed.
    CHECK(all[0].local.joinedStart);
    CHECK_FALSE(all[0].local.joinedEnd); // an open end is a corner, ghost vertices or not
    CHECK(near(all[0].local.neighbourStart, {0.2, 0.0}));
    CHECK(near(all[1].local.points[0], {0.2, 0.0}));
    CHECK(near(all[1].local.points[1], {-0.2, 0.0}));
    CHECK(near(all[1].local.neighbourStart, {0.2, 0.3}));
    CHECK(near(all[1].local.neighbourEnd, {-0.2, 0.3}));
    CHECK_FALSE(all[2].local.joinedStart);
    CHECK(all[2].local.joinedEnd);
    CHECK(near(all[3].local.points[1], {1.0, 1.0}));
    CHECK(near(all[3].local.neighbourEnd, {2.0, 1.0}));
    CHECK(near(all[6].local.points[0], {1.0, 1.0}));
    CHECK(near(all[6].local.neighbourStart, {1.0, 2.0}));

    std::vector<BodyOutline> hit; // only the child that is near, with the same key
    world->query({Vec2(-0.05, -0.01), Vec2(0.05, 0.01)}, hit);
    REQUIRE(hit.size() == 1);
    CHECK(hit[0].local.key == 1);
}

TEST_CASE("a chain's outline is solid where Box2D's own bodies cannot go", "[bridge]") {
    for (const bool leftwards : {true, false}) {
        RigidWorldDefinition d;
        d.lengthScale = 52.1;
        FixtureDefinition chain;
        chain.shape = ShapeKind::Chain;
        chain.vertices = {{0.3, 0.0}, {-0.3, 0.0}};
        if (!leftwards)
            std::swap(chain.vertices[0], chain.vertices[1]);
        BodyDefinition crate = body(BodyType::Dynamic, box(0.02, 0.02), "crate");
        crate.position = Vec2(0.0, 0.03);
        d.bodies = {body(BodyType::Static, chain), crate};
        auto world = build(d);
        for (int i = 0; i < 480; ++i)
            world->step(1.0 / 480.0);
        BodyState s;
        REQUIRE(world->state(world->find("crate"), s));
        CHECK((s.centre.y() > 0.0) == leftwards); // Box2D's edges hold what is on their right
        std::vector<BodyOutline> all;
        world->everything(all);
        const Vec2 along = all[0].local.points[1] - all[0].local.points[0];
        const double solidSide = -rod::perp(along).y(); // of the right-hand side
        CHECK((solidSide < 0.0) == leftwards);
    }
}

TEST_CASE("sensors, disabled bodies and masks are left out or passed on", "[bridge]") {
    RigidWorldDefinition d = worldWith(body(BodyType::Static, box(0.02, 0.02), "plain"));
    d.bodies[0].fixtures[0].filterCategoryBits = 4;
    d.bodies[0].fixtures[0].filterMaskBits = 9;
    d.bodies.push_back(body(BodyType::Static, box(0.02, 0.02), "sensor"));
    d.bodies[1].fixtures[0].sensor = true;
    d.bodies.push_back(body(BodyType::Static, box(0.02, 0.02), "off"));
    d.bodies[2].active = false;
    d.bodies.push_back(body(BodyType::Static, box(0.02, 0.02), "ghost"));
    d.bodies[3].fixtures[0].filterMaskBits = 0;
    FixtureDefinition disc;
    disc.shape = ShapeKind::Circle;
    disc.centre = Vec2(0.01, 0.0);
    disc.radius = 0.015;
    d.bodies.push_back(body(BodyType::Dynamic, disc, "disc"));
    auto world = build(d);
    for (const bool byBox : {true, false}) {
        std::vector<BodyOutline> out;
        if (byBox)
            world->query({Vec2(-1, -1), Vec2(1, 1)}, out);
        else
            world->everything(out);
        REQUIRE(out.size() == 2);
        CHECK(out[0].body == world->find("plain"));
        CHECK(out[0].local.category == 4);
        CHECK(out[0].local.mask == 9);
        CHECK(out[1].body == world->find("disc"));
        CHECK(out[1].local.kind == contact::OutlineKind::Circle);
        CHECK(out[1].local.radius == Approx(0.015).epsilon(1e-6));
        CHECK(out[1].local.points[0].norm() < 1e-9); // about the centre of mass
    }
    BodyState s;
    REQUIRE(world->state(world->find("off"), s));
    CHECK_FALSE(s.enabled);
}
