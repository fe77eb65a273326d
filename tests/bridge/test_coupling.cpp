// Shells and dynamic Box2D bodies, both ways (docs/coupling.md has the figures this file prints).

#include "tests/bridge/playground.h"

#include <cstdio>
#include <vector>

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

struct Standing {
    double gap = 0.0;    ///< largest |gap| of the lowest crate in the last second over h
    double jitter = 0.0; ///< largest speed of any body in that time, m/s
    double growth = 0.0; ///< rise of total energy over its least value before, largest over the whole run, J
    double height = 0.0; ///< of the lowest crate at the end, m
};

struct StackCase {
    double mass = 0.005; ///< of the lowest crate, kg
    double ratio = 10.0; ///< of the others' mass to it
    int above = 2;       ///< crates on top
    double torque = 0.0; ///< of the motor arm, N m
    double dt = 1.0 / 240.0;
    double time = 5.0;
    bool verbose = false;
};

/// Two domes carry a crate, that carries heavier ones, and a motor presses an arm on top.
Standing stand(const StackCase& c) {
    Playground p;
    b2Body* ground = p.floor();
    p.dome(-0.025);
    p.dome(0.025);
    const double half = 0.01, top = kRadius + kThick;
    std::vector<b2Body*> crates;
    const double skin = 2.0 * b2_linearSlop / kScale; // Box2D's polygons stand this far apart, roughly
    double y = top + 1e-4 + half;
    for (int i = 0; i <= c.above; ++i) {
        crates.push_back(p.box(0.0, y, 0.05, half, i == 0 ? c.mass : c.ratio * c.mass));
        y += 2.0 * half + skin;
    }
    if (c.torque > 0.0) {
        b2Body* arm = p.box(-0.1, y - half + 0.005, 0.1, 0.005, 0.02);
        b2RevoluteJointDef j;
        j.Initialize(ground, arm, host(-0.2, y - half + 0.005));
        j.enableMotor = true;
        j.maxMotorTorque = static_cast<float>(c.torque * kScale * kScale);
        j.motorSpeed = -1.0F;
        p.world.CreateJoint(&j);
        crates.push_back(arm);
    }
    Standing out;
    const int frames = static_cast<int>(c.time / c.dt), last = static_cast<int>(1.0 / c.dt);
    double least = 1e9;
    for (int i = 0; i < frames; ++i) {
        p.frame(c.dt);
        const double e = p.energy();
        least = std::min(least, e);
        if (i > frames / 2)
            out.growth = std::max(out.growth, e - least);
        static const double from = getenv("FROM") ? atof(getenv("FROM")) : 0.0, to = getenv("TO") ? atof(getenv("TO")) : 0.2;
        if (c.verbose && i * c.dt >= from && i * c.dt < to) {
            std::printf("%7.4f gap/h %8.4f E %.6f st %llu |", i * c.dt, p.gap(crates[0]) / kThick, e, (unsigned long long)p.shells.counters.steps);
            for (b2Body* b : crates) {
                std::printf(" y %.5f v %7.4f w %6.3f", b->GetWorldCenter().y / kScale, b->GetLinearVelocity().y / kScale, b->GetAngularVelocity());
                for (const step::Body& q : p.shells.bodies) if (q.id == p.port->idOf(*b))
                    std::printf(" u %5.1f J %.1e P %.1e%s;", q.handover.unexplained.linear.y(), q.impulse.y(), q.handover.hostImpulse.y(), q.handover.coupled ? "c" : "");
            }
            std::printf("\n");
        }
        if (i < frames - last)
            continue;
        out.gap = std::max(out.gap, std::abs(p.gap(crates[0])) / kThick);
        for (const b2Body* b : crates)
            out.jitter = std::max(out.jitter, Playground::speed(b));
    }
    out.height = static_cast<double>(crates[0]->GetWorldCenter().y) / kScale;
    return out;
}

} // namespace

TEST_CASE("limits of a stack on shells", "[.][coupling]") {
    for (const double dt : {1.0 / 60.0})
        for (const int above : {0, 1, 2})
            for (const double ratio : {1.0, 10.0})
                for (const double torque : {0.0, 0.02}) {
                    StackCase c;
                    c.dt = dt;
                    c.above = above;
                    c.ratio = ratio;
                    c.torque = torque;
                    if (above == 0 && torque > 0.0)
                        continue;
                    const Standing s = stand(c);
                    std::printf("1/%3.0f s, %d above, ratio %5.1f, torque %.3f: gap %.4f h, jitter %.1e m/s, growth "
                                "%.1e J, height %.4f\n",
                                1.0 / dt, above, ratio, torque, s.gap, s.jitter, s.growth, s.height);
                    std::fflush(stdout);
                }
}
TEST_CASE("one stack", "[.][one]") {
    StackCase c;
    c.verbose = true;
    c.torque = 0.02;
    if (const char* e = getenv("DT"))
        c.dt = atof(e);
    if (const char* e = getenv("RATIO"))
        c.ratio = atof(e);
    if (const char* e = getenv("ABOVE"))
        c.above = atoi(e);
    if (const char* e = getenv("TORQUE"))
        c.torque = atof(e);
    if (const char* e = getenv("MASS"))
        c.mass = atof(e);
    if (const char* e = getenv("TIME"))
        c.time = atof(e);
    const Standing s = stand(c);
    std::printf("gap %.4f h, jitter %.1e m/s, growth %.1e J, height %.4f\n", s.gap, s.jitter, s.growth, s.height);
}
