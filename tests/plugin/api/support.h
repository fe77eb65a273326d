#pragma once
// Helpers of the tests of plugin/api: strips, domes, settling, sums over a world.

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/stepper.h"
#include "tests/support/fake_host.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

namespace supercircle::test {

constexpr double kG = 9.81;           ///< m/s^2
constexpr double kFrame = 1.0 / 60.0; ///< s
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// A straight strip with its middle at (x, y) along `angle`; `stiffness` multiplies Young's modulus.
inline ShellDef strip(double length, Point middle, double angle = 0.0, double stiffness = 1.0, int elements = 8) {
    ShellDef d;
    d.length = length;
    d.radius = kInf;
    d.position = middle;
    d.angle = angle;
    d.young_modulus *= stiffness;
    d.elements = elements;
    return d;
}

/// A dome over the origin: half a circle of radius R about the origin, ends at (-R, 0) and (R, 0).
inline ShellDef dome(double radius = 0.05, double thickness = 0.002, int elements = 9) {
    ShellDef d;
    d.radius = radius;
    d.thickness = thickness;
    d.phi_bar = 0.5;
    d.elements = elements;
    d.position = {0.0, radius};
    d.angle = M_PI;
    return d;
}

inline double massOf(const ShellDef& d) {
    return d.density * d.width * d.thickness * d.length;
}

/// Advances by frames of `dt` seconds; fails the test on a failure.
inline void advance(Shells& shells, FakeHost* host, double dt, int frames, const std::function<bool()>& observer = {}) {
    for (int i = 0; i < frames; ++i) {
        const FrameReport r = shells.pre_step(dt, observer);
        INFO(r.failure);
        REQUIRE(r.failure.empty());
        if (host)
            host->step(r.advanced);
        REQUIRE(shells.post_step());
    }
}

/// Long steps, in which implicit Euler damps all motion: static equilibrium.
inline void settle(Shells& shells, FakeHost* host, int frames = 400) {
    step::Settings& s = shells.stepper().settings();
    const step::Settings before = s;
    s.dtMax = 0.02;
    s.localError = 10.0;
    s.motionLimit = 100.0;
    s.dampingRatio = 1.0;
    advance(shells, host, 0.02, frames);
    s = before;
}

inline Vec2 momentum(const Shells& shells) {
    Vec2 p = Vec2::Zero();
    for (const step::Rod& r : shells.world().rods)
        for (std::size_t g = 0; g < r.u.size(); ++g)
            p += r.gauss.mass[g] * r.u[g];
    return p;
}

/// About the origin, kg m^2/s.
inline double angularMomentum(const Shells& shells) {
    double l = 0.0;
    for (const step::Rod& r : shells.world().rods)
        for (std::size_t g = 0; g < r.u.size(); ++g)
            l += r.gauss.mass[g] * rod::cross(r.kin.middle() + r.gauss.arm[g], r.u[g]);
    return l;
}

inline Vec2 pointAt(const Shells& shells, std::size_t rod, double fraction) {
    const step::Rod& r = shells.world().rods[rod];
    return r.kin.point(rod::locate(r.model, fraction * r.model.definition().length));
}
inline double angleAt(const Shells& shells, std::size_t rod, double fraction) {
    const step::Rod& r = shells.world().rods[rod];
    return r.kin.angle(rod::locate(r.model, fraction * r.model.definition().length));
}
inline Vec2 centreOf(const Shells& shells, std::size_t rod) {
    const step::Rod& r = shells.world().rods[rod];
    return rod::massCentre(r.kin, r.gauss);
}

inline std::shared_ptr<FakeHost> emptyHost(double gravity = 0.0) {
    auto host = std::make_shared<FakeHost>();
    host->g = {0.0, -gravity};
    return host;
}
/// With gravity and a ground, body 1, whose face is y = 0.
inline std::shared_ptr<FakeHost> groundHost(double friction = 0.35) {
    auto host = emptyHost(kG);
    host->addGround(1, friction);
    return host;
}

} // namespace supercircle::test
