// Shells under stacks of dynamic Box2D bodies, coupled both ways. The hidden test prints the figures of the
// documentation.

#include "tests/bridge/box2d/coupled_world.h"

#include <cstdio>
#include <vector>

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

struct StackCase {
    double mass = 0.005; ///< of the lowest crate, kg
    double ratio = 10.0; ///< of the others' mass to it
    int above = 2;       ///< crates on top
    double torque = 0.0; ///< of the motor arm, N m
    double dt = 1.0 / 240.0;
    double time = 5.0; ///< s
};

struct StackResult {
    double gap = 0.0;    ///< largest |gap| of the lowest crate in the last second over h
    double jitter = 0.0; ///< largest speed of any body in that time, m/s
    double growth =
        0.0; ///< largest rise of the energy without the motor's work over its least so far, in the second half, J
    double height = 0.0; ///< of the lowest crate at the end, m
    double parted = 0.0; ///< what the distance between the two highest crates grew by in the second half, m
};

/// Presses an arm that hangs on the ground down on what lies under it at height `y`.
b2RevoluteJoint* addMotorArm(CoupledWorld& p, b2Body* ground, double y, double torque) {
    b2Body* arm = p.box(-0.1, y + 0.005, 0.1, 0.005, 0.02);
    b2RevoluteJointDef j;
    j.Initialize(ground, arm, host(-0.2, y + 0.005));
    j.enableMotor = true;
    j.maxMotorTorque = static_cast<float>(torque * kScale * kScale);
    j.motorSpeed = -1.0F;
    return static_cast<b2RevoluteJoint*>(p.world.CreateJoint(&j));
}

/// Two domes carry a crate that carries heavier ones; a motor presses an arm on top.
StackResult stand(const StackCase& c) {
    CoupledWorld p;
    b2Body* ground = p.floor();
    p.dome(-0.025);
    p.dome(0.025);
    const double half = 0.01;
    std::vector<b2Body*> bodies;
    const double skin =
        static_cast<double>(2.0F * b2_polygonRadius - b2_linearSlop) / kScale; // Box2D rests polygons so
    double y = kRadius + kThick + 1e-4 + half;
    for (int i = 0; i <= c.above; ++i) {
        bodies.push_back(p.box(0.0, y, 0.05, half, i == 0 ? c.mass : c.ratio * c.mass));
        y += 2.0 * half + skin;
    }
    b2RevoluteJoint* motor = c.torque > 0.0 ? addMotorArm(p, ground, y - half, c.torque) : nullptr;
    if (motor)
        bodies.push_back(motor->GetBodyB());
    // Lets Box2D find its contacts. It finds bodies that meet within a frame one frame later; they then overlap by up
    // to g T^2, and its position correction lifts them, with or without shells.
    p.world.Step(0.0F, 8, 3);
    StackResult out;
    const int frames = static_cast<int>(c.time / c.dt), last = static_cast<int>(1.0 / c.dt);
    double least = 1e9, work = 0.0, apart = 0.0;
    const auto distance = [&] {
        const b2Vec2 d = bodies[static_cast<std::size_t>(c.above)]->GetWorldCenter() -
                         bodies[static_cast<std::size_t>(std::max(0, c.above - 1))]->GetWorldCenter();
        return static_cast<double>(d.y) / kScale;
    };
    for (int i = 0; i < frames; ++i) {
        const double angle = motor ? static_cast<double>(motor->GetJointAngle()) : 0.0;
        p.frame(c.dt);
        if (motor)
            work += static_cast<double>(motor->GetMotorTorque(static_cast<float>(1.0 / c.dt))) / (kScale * kScale) *
                    (static_cast<double>(motor->GetJointAngle()) - angle);
        const double e = p.energy() - work;
        least = std::min(least, e);
        if (i == frames / 2)
            apart = distance();
        if (i > frames / 2)
            out.growth = std::max(out.growth, e - least);
        if (i < frames - last)
            continue;
        out.gap = std::max(out.gap, std::abs(p.gap(bodies[0])) / kThick);
        for (const b2Body* b : bodies)
            out.jitter = std::max(out.jitter, CoupledWorld::speed(b));
    }
    out.parted = distance() - apart;
    out.height = static_cast<double>(bodies[0]->GetWorldCenter().y) / kScale;
    return out;
}

/// Requirements for a stack at rest: gap h/100 (1/240 s) or h/10 (1/60 s), speed 1 mm/s, and no more energy gain than
/// lifting the crates by a thousandth of a thickness.
void checkStanding(const StackCase& c) {
    const StackResult s = stand(c);
    CAPTURE(c.dt, c.above, c.ratio, c.torque, s.gap, s.jitter, s.growth, s.height);
    CHECK(s.gap <= (c.dt < 0.01 ? 0.01 : 0.1));
    CHECK(s.jitter <= 1e-3);
    CHECK(s.growth < c.mass * (1.0 + c.above * c.ratio) * kFall * 1e-3 * kThick);
    CHECK(s.height > 0.5 * kRadius); // it stands on the shells
}

} // namespace

TEST_CASE("a crate under two of ten times its mass and a motor arm stands on shells at 240 frames a second",
          "[bridge]") {
    for (const double torque : {0.0, 0.02}) {
        StackCase c;
        c.torque = torque;
        c.time = 3.0;
        checkStanding(c);
    }
}

TEST_CASE("a crate under two of ten times its mass and a motor arm stands on shells at 60 frames a second",
          "[bridge]") {
    for (const double torque : {0.0, 0.02}) {
        StackCase c;
        c.torque = torque;
        c.dt = 1.0 / 60.0;
        c.time = 4.0;
        checkStanding(c);
    }
}

TEST_CASE("a stack on shells is at rest for a minute", "[bridge][slow]") {
    for (const double rate : {240.0, 60.0}) {
        StackCase c;
        c.torque = 0.02;
        c.dt = 1.0 / rate;
        c.time = 60.0;
        checkStanding(c);
    }
}

TEST_CASE("the host's rounding does not lift crates of a stack at rest", "[bridge]") {
    // Crates that press on each other part by roundings of the host's floats, and nothing brings them together: in 20 s
    // the highest rose by 0.2 um.
    StackCase c;
    c.torque = 0.02;
    c.dt = 1.0 / 60.0;
    c.time = 40.0;
    const StackResult s = stand(c);
    CAPTURE(s.parted, s.jitter, s.height);
    const double rounding = 4.0 * static_cast<double>(b2_epsilon) / kScale; // of a height of two to four units
    CHECK(std::abs(s.parted) <= 2.0 * rounding);                            // each crate is rounded once
}

TEST_CASE("limits of a stack on shells", "[.][bridge][limits]") {
    struct Row {
        double mass, ratio;
        int above;
    };
    const Row rows[] = {{0.005, 1.0, 0},  {0.005, 10.0, 2},   {0.005, 1.0, 5},    {0.005, 1.0, 10},
                        {0.0005, 1.0, 0}, {0.0005, 10.0, 2},  {0.0005, 30.0, 2},  {0.0005, 100.0, 2},
                        {0.0001, 1.0, 0}, {0.0001, 100.0, 2}, {0.0001, 300.0, 2}, {0.0001, 1000.0, 2}};
    for (const double rate : {240.0, 120.0, 60.0, 30.0})
        for (const Row& row : rows) {
            StackCase c;
            c.dt = 1.0 / rate;
            c.above = row.above;
            c.ratio = row.ratio;
            c.mass = row.mass;
            c.time = 6.0;
            const StackResult s = stand(c);
            std::printf("1/%3.0f s, %4.1f g, %2d above, ratio %6.1f: gap %.1e h, jitter %.1e m/s, growth %.1e J, "
                        "height %.4f m\n",
                        rate, 1e3 * c.mass, c.above, c.ratio, s.gap, s.jitter, s.growth, s.height);
            std::fflush(stdout);
        }
}
