// Dynamic Box2D bodies in contact with shells, changed by their user. CoupledWorld::frame requires every frame to
// succeed.

#include "tests/bridge/box2d/coupled_world.h"

#include <vector>

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

constexpr double kDt = 1.0 / 120.0;
constexpr double kTop = kRadius + kThick; ///< of an unloaded dome, m

double y(const b2Body* b) {
    return static_cast<double>(b->GetWorldCenter().y) / kScale;
}
double x(const b2Body* b) {
    return static_cast<double>(b->GetWorldCenter().x) / kScale;
}
/// Of the shell's highest node, m.
double crown(const CoupledWorld& p, std::size_t rod = 0) {
    double top = -1e9;
    for (int i = 0; i <= p.shells.rods[rod].model.elements(); ++i)
        top = std::max(top, p.shells.rods[rod].kin.node(i).y());
    return top;
}
void simulate(CoupledWorld& p, double time) {
    for (int i = 0; i < static_cast<int>(time / kDt); ++i)
        p.frame(kDt);
}

/// A crate at rest on one dome.
struct OnDome {
    OnDome() {
        ground = p.floor();
        p.dome(0.0);
        crate = p.box(0.0, kTop + 0.0051, 0.01, 0.005, 0.005);
        simulate(p, 1.0);
        REQUIRE(p.gap(crate) < 0.01 * kThick);
        loaded = crown(p);
    }
    CoupledWorld p;
    b2Body* ground = nullptr;
    b2Body* crate = nullptr;
    double loaded = 0.0; ///< height of the crown under the crate, m
    /// Without load the crown springs back above its position under the crate.
    void requireFree() {
        simulate(p, 0.5);
        CHECK(crown(p) > loaded);
    }
};

Vec2 momentumOf(const CoupledWorld& p) {
    Vec2 sum = Vec2::Zero();
    for (const step::Rod& r : p.shells.rods)
        for (std::size_t g = 0; g < r.u.size(); ++g)
            sum += r.gauss.mass[g] * r.u[g];
    for (const b2Body* b = p.world.GetBodyList(); b != nullptr; b = b->GetNext())
        sum += static_cast<double>(b->GetMass()) / kScale *
               Vec2(static_cast<double>(b->GetLinearVelocity().x), static_cast<double>(b->GetLinearVelocity().y));
    return sum;
}

} // namespace

TEST_CASE("a shell that flies into a crate launches it, and momentum is conserved", "[bridge]") {
    CoupledWorld p(0.0);
    rod::RodDefinition d;
    d.length = M_PI * kRadius;
    d.naturalCurvature.assign(15, 1.0 / kRadius);
    p.put(d, {0.0, -0.01}, M_PI, 0.5, {0.0, 2.0});
    b2Body* crate = p.box(0.003, 0.01, 0.02, 0.005, 0.002);
    b2Body* rider = p.box(0.004, 0.0202, 0.01, 0.005, 0.004);
    const Vec2 before = momentumOf(p);
    simulate(p, 0.25);
    CHECK(static_cast<double>(crate->GetLinearVelocity().y) / kScale > 0.02);
    CHECK(static_cast<double>(rider->GetLinearVelocity().y) / kScale > 0.02); // Box2D's contact passes it on
    CHECK((momentumOf(p) - before).norm() < 1e-5 * before.norm());            // Box2D's floats
}

TEST_CASE("one shell carries several bodies, and one body lies on several shells", "[bridge]") {
    CoupledWorld p;
    p.floor();
    rod::RodDefinition d; // a flat strip on two posts
    d.length = 0.1;
    d.naturalCurvature.assign(12, 0.0);
    for (const double at : {-0.04, 0.04}) {
        b2Body* post = p.box(at, 0.01, 0.004, 0.01, 0.1);
        post->SetType(b2_staticBody);
    }
    p.put(d, {0.0, 0.02 + 0.5 * kThick + 1e-5}, 0.0, 0.5);
    b2Body* left = p.box(-0.03, 0.0206 + 0.004, 0.004, 0.004, 0.002);
    b2Body* right = p.disc(0.03, 0.0206 + 0.004, 0.004, 0.003, 0.8);
    right->SetAngularDamping(50.0F); // it would roll to the middle
    p.dome(0.2);
    p.dome(0.25);
    p.dome(0.3);
    b2Body* plank = p.box(0.25, kTop + 0.0041, 0.08, 0.004, 0.03);
    simulate(p, 0.6);
    for (b2Body* b : {left, right, plank}) {
        CAPTURE(x(b), y(b));
        CHECK(std::abs(p.gap(b)) < 0.02 * kThick);
        CHECK(y(b) > 0.012);
    }
    CHECK(std::abs(plank->GetAngle()) < 0.01F);
}

TEST_CASE("a vehicle with a motor drives over a shell", "[bridge]") {
    CoupledWorld p;
    p.floor(1.0);
    rod::RodDefinition d; // a low hump, tips on the floor
    d.length = 0.06;
    d.naturalCurvature.assign(15, 10.0);
    p.put(d, {0.06, 0.1 - 0.1 * std::cos(0.3) + 0.5 * kThick + 1e-5}, M_PI, 1.0);
    b2Body* chassis = p.box(-0.03, 0.016, 0.025, 0.004, 0.02);
    for (const double at : {-0.05, -0.01}) {
        b2Body* wheel = p.disc(at, 0.0081, 0.008, 0.005, 1.0);
        b2WheelJointDef j;
        j.Initialize(chassis, wheel, wheel->GetPosition(), {0.0F, 1.0F});
        j.enableMotor = true;
        j.motorSpeed = -25.0F;
        j.maxMotorTorque = static_cast<float>(1e-3 * kScale * kScale);
        b2LinearStiffness(j.stiffness, j.damping, 20.0F, 0.7F, chassis, wheel);
        p.world.CreateJoint(&j);
    }
    double flat = 0.0, highest = 0.0;
    for (int i = 0; i < 240 && x(chassis) < 0.14; ++i) {
        p.frame(kDt);
        if (x(chassis) < 0.0)
            flat = y(chassis);
        else
            highest = std::max(highest, y(chassis));
    }
    CHECK(x(chassis) > 0.1);
    CHECK(highest > flat + kThick); // it was lifted
    CHECK(p.shells.counters.penetrationMax < 0.1 * kThick);
}

TEST_CASE("a bullet body does not pass through a shell", "[bridge]") {
    CoupledWorld p(0.0);
    b2Body* wall = p.floor();
    (void)wall;
    p.dome(0.0);
    b2Body* ball = p.disc(0.0, 0.1, 0.003, 0.001);
    ball->SetBullet(true);
    ball->SetLinearVelocity(host(0.0, -5.0)); // 5 m/s: 80 thicknesses a frame
    for (int i = 0; i < 24; ++i) {
        p.frame(kDt);
        CHECK(y(ball) > crown(p) - 2.0 * kThick); // it does not pass through
    }
    CHECK(p.shells.counters.crossings == 0);
}

TEST_CASE("sensors change nothing", "[bridge]") {
    const auto run = [](bool sensor) {
        CoupledWorld p;
        p.floor();
        p.dome(0.0);
        b2Body* crate = p.box(0.0, kTop + 0.0051, 0.01, 0.005, 0.005);
        if (sensor) {
            b2CircleShape shape;
            shape.m_radius = static_cast<float>(0.05 * kScale);
            b2FixtureDef f;
            f.shape = &shape;
            f.isSensor = true;
            crate->CreateFixture(&f); // density 0
        }
        simulate(p, 0.3);
        return std::pair(p.shells.rods[0].q, y(crate));
    };
    const auto with = run(true), without = run(false);
    CHECK(with.first == without.first);
    CHECK(with.second == without.second);
}

TEST_CASE("a crate and a shell on a one-sided chain", "[bridge]") {
    CoupledWorld p;
    b2BodyDef def;
    b2Body* ground = p.world.CreateBody(&def);
    const b2Vec2 points[] = {host(0.3, 0.0), host(0.05, 0.0), host(-0.05, 0.0), host(-0.3, 0.0)};
    b2ChainShape chain; // solid on the right of its way: below
    chain.CreateChain(points, 4, host(0.4, 0.0), host(-0.4, 0.0));
    ground->CreateFixture(&chain, 0.0F);
    p.dome(0.0);
    b2Body* crate = p.box(0.0, kTop + 0.0051, 0.01, 0.005, 0.005);
    b2Body* beside = p.box(0.1, 0.0052, 0.01, 0.005, 0.005);
    simulate(p, 0.6);
    CHECK(std::abs(p.gap(crate)) < 0.01 * kThick);
    CHECK(y(beside) == Approx(0.005).margin(2.0 * static_cast<double>(b2_linearSlop + b2_polygonRadius) / kScale));
}

TEST_CASE("a body that is destroyed while touched releases the shell, and another may get its address", "[bridge]") {
    OnDome s;
    s.p.world.DestroyBody(s.crate);
    s.crate = s.p.box(0.0, kTop + 0.03, 0.01, 0.005, 0.005);
    simulate(s.p, 0.03); // the new one is still falling
    CHECK(crown(s.p) > s.loaded);
    simulate(s.p, 1.0);
    CHECK(std::abs(s.p.gap(s.crate)) < 0.05 * kThick);
}

TEST_CASE("a body may be destroyed between the shells' frame and Box2D's", "[bridge]") {
    OnDome s;
    CHECK(s.p.stepper.advance(s.p.shells, kDt, s.p.port.get(), {}).failure.empty());
    s.p.world.DestroyBody(s.crate);
    s.p.world.Step(static_cast<float>(kDt), 8, 3);
    s.p.stepper.learnFromHost(s.p.shells, *s.p.port, kDt);
    s.requireFree();
}

TEST_CASE("a disabled body releases the shell, and loads it again when enabled", "[bridge]") {
    OnDome s;
    const double before = y(s.crate);
    s.crate->SetEnabled(false);
    s.requireFree();
    CHECK(y(s.crate) == before);
    s.crate->SetTransform(host(0.0, kTop + 0.006), 0.0F);
    s.crate->SetEnabled(true);
    simulate(s.p, 1.0);
    CHECK(std::abs(s.p.gap(s.crate)) < 0.02 * kThick);
}

TEST_CASE("a body put to sleep on a shell stays where it is", "[bridge]") {
    OnDome s;
    const double before = y(s.crate);
    s.crate->SetAwake(false);
    simulate(s.p, 1.0);
    CHECK(s.crate->IsAwake()); // the shell's impulses wake it
    CHECK(y(s.crate) == Approx(before).margin(0.1 * kThick));
    CHECK(std::abs(s.p.gap(s.crate)) < 0.02 * kThick);
}

TEST_CASE("a body that its user moves away releases the shell", "[bridge]") {
    OnDome s;
    s.crate->SetTransform(host(0.3, 0.1), 0.0F);
    s.p.frame(kDt);
    CHECK(x(s.crate) == Approx(0.3).margin(1e-6)); // the copy does not pull it back
    s.requireFree();
}

TEST_CASE("a body that its user moves into a shell is separated from it without an explosion", "[bridge]") {
    OnDome s;
    s.crate->SetTransform(s.crate->GetPosition() + host(0.0, -0.5 * kThick), 0.0F);
    const double before = s.p.energy();
    simulate(s.p, 1.0);
    CHECK(std::abs(s.p.gap(s.crate)) < 0.02 * kThick);
    // The correction lifts the crate by the imposed overlap, at the speed Settings::recovery.
    CHECK(s.p.energy() < before + 2.0 * 0.005 * kFall * kThick + 0.5 * 0.005 * std::pow(20.0 * kThick, 2));
}

TEST_CASE("types change while a shell is touched", "[bridge]") {
    OnDome s;
    const double before = y(s.crate);
    s.crate->SetType(b2_staticBody);
    simulate(s.p, 0.3);
    CHECK(y(s.crate) == before);
    s.crate->SetType(b2_kinematicBody);
    s.crate->SetLinearVelocity(host(0.0, -0.01));
    simulate(s.p, 0.3);
    CHECK(y(s.crate) == Approx(before - 0.003).margin(1e-4)); // a kinematic body is not stopped
    CHECK(crown(s.p) < s.loaded - 0.002);                     // the shell yields
    s.crate->SetType(b2_dynamicBody);
    simulate(s.p, 1.0);
    CHECK(y(s.crate) == Approx(before).margin(0.2 * kThick)); // carried up again
    CHECK(std::abs(s.p.gap(s.crate)) < 0.02 * kThick);
}

TEST_CASE("after a shift of Box2D's origin bodies are found at their new positions", "[bridge]") {
    OnDome s; // shells do not move with it: their owner moves them
    s.p.world.ShiftOrigin(host(1.0, 0.0));
    s.p.frame(kDt);
    CHECK(x(s.crate) == Approx(-1.0).margin(1e-4));
    s.requireFree();
}

TEST_CASE("bodies far from shells move bitwise as without them", "[bridge]") {
    const auto run = [](bool shells) {
        CoupledWorld p;
        p.floor();
        if (shells)
            p.dome(-1.0);
        b2Body* low = p.box(0.0, 0.02, 0.01, 0.01, 0.01);
        b2Body* high = p.box(0.003, 0.05, 0.01, 0.01, 0.1);
        b2RevoluteJointDef j;
        j.Initialize(low, high, high->GetPosition());
        p.world.CreateJoint(&j);
        simulate(p, 0.5);
        return std::array{low->GetPosition(), high->GetPosition(), low->GetLinearVelocity(), high->GetLinearVelocity()};
    };
    const auto with = run(true), without = run(false);
    for (std::size_t i = 0; i < with.size(); ++i)
        CHECK((with[i] == without[i]));
}

TEST_CASE("a pendulum on a hinge comes to rest on a shell", "[bridge]") {
    CoupledWorld p;
    b2Body* ground = p.floor();
    p.dome(0.0);
    b2Body* rod = p.box(-0.05, kTop + 0.03, 0.05, 0.003, 0.01);
    b2RevoluteJointDef j;
    j.Initialize(ground, rod, host(-0.1, kTop + 0.03));
    p.world.CreateJoint(&j);
    simulate(p, 2.0);
    CHECK(std::abs(p.gap(rod)) < 0.02 * kThick);
    const b2Vec2 hinge = rod->GetWorldPoint(j.localAnchorB) - host(-0.1, kTop + 0.03);
    CHECK(static_cast<double>(hinge.Length()) < static_cast<double>(b2_linearSlop)); // Box2D's own tolerance
    CHECK(std::abs(rod->GetAngularVelocity()) < 0.05F);
}
