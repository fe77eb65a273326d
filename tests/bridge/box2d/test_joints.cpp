// Box2D's joints on bodies carried by shells: each stays closed, at rest, and gains no energy. `[.joints]` and
// `[.heap]` print the figures of the documentation.

#include "tests/bridge/box2d/coupled_world.h"

#include <cstdio>
#include <functional>
#include <string>
#include <vector>

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

constexpr double kStep = 1.0 / 120.0;
constexpr double kDomeTop = kRadius + kThick; ///< of an unloaded dome, m
constexpr double kHalf = 0.005;               ///< of the crates' height, m
constexpr double kMass = 0.005;               ///< of the crates, kg
constexpr double kWeight = kMass * kFall;     ///< N

float units(double metres) {
    return static_cast<float>(metres * kScale);
}
/// Forces scale with the length, torques with its square.
float torque(double newtonMetres) {
    return static_cast<float>(newtonMetres * kScale * kScale);
}
double metres(float inUnits) {
    return static_cast<double>(inUnits) / kScale;
}

/// A joint on a loaded crate, and how far it is from closed, m.
struct Jointed {
    b2Body* crate = nullptr;
    std::function<double()> error = [] { return 0.0; };
};

/// A crate on the crown of a dome at x = 0.
b2Body* crateOn(CoupledWorld& p) {
    p.dome(0.0);
    return p.box(0.0, kDomeTop + kHalf + 1e-4, 0.01, kHalf, kMass);
}

b2Joint* prismaticTo(CoupledWorld& p, b2Body* ground, b2Body* body) {
    b2PrismaticJointDef j;
    j.Initialize(ground, body, body->GetWorldCenter(), {0.0F, 1.0F});
    return p.world.CreateJoint(&j);
}

std::function<double()> apart(b2Joint* j) {
    return [j] { return metres((j->GetAnchorA() - j->GetAnchorB()).Length()); };
}

Jointed revolute(CoupledWorld& p, b2Body* ground) { // a lever on a pivot rests on the dome
    p.dome(0.0);
    b2Body* lever = p.box(-0.02, kDomeTop + kHalf + 1e-4, 0.04, kHalf, kMass);
    b2RevoluteJointDef j;
    j.Initialize(ground, lever, host(-0.055, kDomeTop + kHalf));
    return {lever, apart(p.world.CreateJoint(&j))};
}

Jointed prismatic(CoupledWorld& p, b2Body* ground) {
    b2Body* crate = crateOn(p);
    (void)prismaticTo(p, ground, crate);
    return {crate, [crate] {
                return std::abs(metres(crate->GetWorldCenter().x)) +
                       kHalf * std::abs(static_cast<double>(crate->GetAngle()));
            }};
}

Jointed distance(CoupledWorld& p, b2Body* ground) { // a rigid rod from the side
    b2Body* crate = crateOn(p);
    b2DistanceJointDef j;
    j.Initialize(ground, crate, host(-0.06, kDomeTop + 0.03), crate->GetWorldCenter());
    const b2Joint* made = p.world.CreateJoint(&j);
    return {crate, [made, length = j.length] {
                return std::abs(metres((made->GetAnchorA() - made->GetAnchorB()).Length() - length));
            }};
}

Jointed pulley(CoupledWorld& p, b2Body*) { // a counterweight of half the crate's
    b2Body* crate = crateOn(p);
    b2Body* weight = p.box(0.1, 0.06, 0.005, 0.005, 0.5 * kMass);
    b2PulleyJointDef j;
    j.Initialize(crate, weight, host(0.0, 0.12), host(0.1, 0.12), crate->GetWorldCenter(), weight->GetWorldCenter(),
                 1.0F);
    const auto* made = static_cast<b2PulleyJoint*>(p.world.CreateJoint(&j));
    return {crate, [made, sum = j.lengthA + j.lengthB] {
                return std::abs(metres(made->GetCurrentLengthA() + made->GetCurrentLengthB() - sum));
            }};
}

Jointed mouse(CoupledWorld& p, b2Body* ground) { // pulls to the side and up with half the weight at most
    b2Body* crate = crateOn(p);
    b2MouseJointDef j;
    j.bodyA = ground;
    j.bodyB = crate;
    j.target = crate->GetWorldCenter();
    j.maxForce = units(0.5 * kWeight);
    b2LinearStiffness(j.stiffness, j.damping, 5.0F, 0.7F, ground, crate);
    auto* made = static_cast<b2MouseJoint*>(p.world.CreateJoint(&j));
    made->SetTarget(host(0.001, kDomeTop + kHalf + 0.001));
    return {crate, [made] { // beyond its largest force
                return std::max(0.0,
                                static_cast<double>(made->GetReactionForce(static_cast<float>(1.0 / kStep)).Length()) -
                                    1.001 * static_cast<double>(made->GetMaxForce()));
            }};
}

Jointed gear(CoupledWorld& p, b2Body* ground) { // the weight of an arm presses the crate through a gear
    b2Body* crate = crateOn(p);
    b2Joint* slide = prismaticTo(p, ground, crate);
    b2Body* arm = p.box(0.11, 0.05, 0.01, 0.002, 0.4 * kMass);
    b2RevoluteJointDef pivot;
    pivot.Initialize(ground, arm, host(0.1, 0.05));
    b2Joint* turn = p.world.CreateJoint(&pivot);
    b2GearJointDef j;
    j.bodyA = crate;
    j.bodyB = arm;
    j.joint1 = slide;
    j.joint2 = turn;
    j.ratio = units(-0.02); // 2 cm a radian
    p.world.CreateJoint(&j);
    return {crate, [slide, turn, ratio = j.ratio] {
                return std::abs(metres(static_cast<b2PrismaticJoint*>(slide)->GetJointTranslation() +
                                       ratio * static_cast<b2RevoluteJoint*>(turn)->GetJointAngle()));
            }};
}

Jointed wheel(CoupledWorld& p, b2Body*) { // a braked wheel on the dome carries a chassis on its spring
    p.dome(0.0);
    b2Body* disc = p.disc(0.0, kDomeTop + 0.0101, 0.01, 0.4 * kMass, 0.8);
    b2Body* chassis = p.box(0.0, kDomeTop + 0.03, 0.01, kHalf, kMass);
    chassis->SetFixedRotation(true);
    b2WheelJointDef j;
    j.Initialize(chassis, disc, disc->GetWorldCenter(), {0.0F, 1.0F});
    b2LinearStiffness(j.stiffness, j.damping, 8.0F, 0.7F, chassis, disc);
    j.enableMotor = true;
    j.maxMotorTorque = torque(0.01);
    p.world.CreateJoint(&j);
    return {disc, [disc, chassis] { return std::abs(metres(disc->GetWorldCenter().x - chassis->GetWorldCenter().x)); }};
}

Jointed weld(CoupledWorld& p, b2Body*) { // a heavier one on top
    b2Body* crate = crateOn(p);
    b2Body* above = p.box(0.0, kDomeTop + 3.0 * kHalf + 2e-4, 0.01, kHalf, 2.0 * kMass);
    b2WeldJointDef j;
    j.Initialize(crate, above, host(0.0, kDomeTop + 2.0 * kHalf));
    b2Joint* made = p.world.CreateJoint(&j);
    return {crate, [crate, above, gap = apart(made)] {
                return gap() + kHalf * std::abs(static_cast<double>(above->GetAngle() - crate->GetAngle()));
            }};
}

Jointed friction(CoupledWorld& p, b2Body* ground) {
    b2Body* crate = crateOn(p);
    b2FrictionJointDef j;
    j.Initialize(ground, crate, crate->GetWorldCenter());
    j.maxForce = units(0.3 * kWeight);
    j.maxTorque = torque(1e-4);
    p.world.CreateJoint(&j);
    return {crate};
}

Jointed motorJoint(CoupledWorld& p, b2Body* ground) { // pushes aside with a fifth of the weight
    b2Body* crate = crateOn(p);
    b2MotorJointDef j;
    j.Initialize(ground, crate);
    j.linearOffset = ground->GetLocalPoint(host(0.002, kDomeTop + kHalf));
    j.maxForce = units(0.2 * kWeight);
    j.maxTorque = torque(1e-4);
    p.world.CreateJoint(&j);
    return {crate};
}

struct JointCase {
    const char* name;
    Jointed (*make)(CoupledWorld&, b2Body* ground);
};
const JointCase kJointCases[] = {{"revolute", revolute}, {"prismatic", prismatic}, {"distance", distance},
                                 {"pulley", pulley},     {"mouse", mouse},         {"gear", gear},
                                 {"wheel", wheel},       {"weld", weld},           {"friction", friction},
                                 {"motor", motorJoint}};

/// Observations of the last second.
struct ObservedJoint {
    double gap = 0.0;    ///< largest distance from touching, m
    double jitter = 0.0; ///< largest speed of a body, m/s
    double error = 0.0;  ///< largest of the joint, m
    double growth = 0.0; ///< largest rise of the energy over its least so far, J
    double worst = 0.0;  ///< largest error of the joint at any time, m
    bool finite = true;
};

void look(CoupledWorld& p, double least, ObservedJoint& s) {
    for (const b2Body* b = p.world.GetBodyList(); b != nullptr; b = b->GetNext()) {
        s.jitter = std::max(s.jitter, CoupledWorld::speed(b));
        s.finite &= b->GetPosition().IsValid() && b->GetLinearVelocity().IsValid();
    }
    s.growth = std::max(s.growth, p.energy() - least);
}

ObservedJoint simulate(const JointCase& kind, double seconds, double dt = kStep) {
    CoupledWorld p;
    b2Body* ground = p.floor();
    const Jointed j = kind.make(p, ground);
    ObservedJoint s;
    double least = 1e9;
    const int frames = static_cast<int>(seconds / dt), last = static_cast<int>(1.0 / dt);
    for (int i = 0; i < frames; ++i) {
        p.frame(dt);
        s.worst = std::max(s.worst, j.error());
        if (i < frames - last)
            continue;
        s.gap = std::max(s.gap, std::abs(p.gap(j.crate)));
        s.error = std::max(s.error, j.error());
        least = std::min(least, p.energy());
        look(p, least, s);
    }
    return s;
}

/// Piles of `high` crates on a plank that domes carry.
ObservedJoint heap(int piles, int high, double dt, double seconds, std::size_t* inProblem = nullptr) {
    CoupledWorld p;
    p.floor();
    const double width = 0.022 * piles;
    for (double x = 0.0; x < width + 0.02; x += 0.045)
        p.dome(x);
    b2Body* plank = p.box(0.5 * width, kDomeTop + 0.003 + 1e-5, 0.5 * width + 0.03, 0.003, 0.01);
    for (int i = 0; i < piles; ++i)
        for (int k = 0; k < high; ++k)
            p.box(0.011 + 0.022 * i, kDomeTop + 0.0061 + 0.006 * (k + 0.5) + 2e-5 * k, 0.008, 0.003, 0.0005);
    ObservedJoint s;
    double least = 1e9;
    const int frames = static_cast<int>(seconds / dt), last = static_cast<int>(0.5 * seconds / dt);
    for (int i = 0; i < frames; ++i) {
        p.frame(dt);
        if (i < frames - last)
            continue;
        s.gap = std::max(s.gap, std::abs(p.gap(plank)));
        least = std::min(least, p.energy());
        look(p, least, s);
    }
    if (inProblem) {
        *inProblem = 0;
        for (const step::Body& b : p.shells.bodies)
            *inProblem += b.dynamic && b.hostCoupling.coupled ? 1 : 0;
    }
    return s;
}

} // namespace

TEST_CASE("every joint of Box2D stays closed and quiet on a body that a shell carries", "[bridge]") {
    // Box2D lets joints err by its slop: 5 mm in its units. Energy: as for stacks (test_coupling.cpp).
    constexpr double slop = 0.005 / kScale;
    for (const JointCase& kind : kJointCases) {
        INFO(kind.name);
        const ObservedJoint s = simulate(kind, 3.0);
        CAPTURE(s.gap / kThick, s.jitter, s.error, s.worst, s.growth);
        CHECK(s.finite);
        CHECK(s.gap < 0.1 * kThick);
        CHECK(s.jitter < 1e-3);
        CHECK(s.error < slop);
        CHECK(s.growth < 2e-5);
    }
}

TEST_CASE("a heap of 72 crates on shells comes to rest", "[bridge]") {
    std::size_t coupled = 0;
    const ObservedJoint s = heap(9, 8, kStep, 1.0, &coupled);
    CAPTURE(s.gap / kThick, s.jitter, s.growth, coupled);
    CHECK(s.finite);
    CHECK(coupled == 73); // all crates and the plank
    CHECK(s.gap < 0.1 * kThick);
    CHECK(s.jitter < 1e-3);
    CHECK(s.growth < 1e-3); // they overlap at first contact, after a fall of some hundredths of h
}

TEST_CASE("figures of joints on loaded bodies", "[.joints]") {
    for (const JointCase& kind : kJointCases)
        for (const double dt : {1.0 / 240.0, 1.0 / 60.0}) {
            const ObservedJoint s = simulate(kind, 3.0, dt);
            std::printf("%-10s 1/%.0f s: gap %.0e h, jitter %.0e m/s, joint %.0e m (worst %.0e), growth %.0e J\n",
                        kind.name, 1.0 / dt, s.gap / kThick, s.jitter, s.error, s.worst, s.growth);
        }
}

TEST_CASE("figures of heaps", "[.heap]") {
    for (const int high : {6, 8, 12})
        for (const double dt : {1.0 / 240.0, 1.0 / 60.0}) {
            std::size_t coupled = 0;
            const ObservedJoint s = heap(9, high, dt, 4.0, &coupled);
            std::printf("%d bodies (%zu in the problem), 1/%.0f s: gap %.0e h, jitter %.0e m/s, growth %.0e J\n",
                        9 * high + 1, coupled, 1.0 / dt, s.gap / kThick, s.jitter, s.growth);
        }
}
