#pragma once
// Rods and worlds that several tests of the step share.

#include "supercircle/step/stepper.h"
#include "tests/support/fake_host.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

namespace supercircle::test {

constexpr double kR = 0.0192; ///< m, the paper's shell
constexpr double kG = 9.81;   ///< m/s^2

inline rod::RodDefinition paperShell(double phiBar = 0.75, int elements = 15) {
    rod::RodDefinition d;
    d.length = 2.0 * M_PI * phiBar * kR;
    d.naturalCurvature.assign(static_cast<std::size_t>(elements), 1.0 / kR);
    return d;
}

/// A straight strip; `stiffness` multiplies the paper's bending modulus.
inline rod::RodDefinition strip(double length, double stiffness, int elements = 3) {
    rod::RodDefinition d;
    d.length = length;
    d.bendingModulus *= stiffness;
    d.naturalCurvature.assign(static_cast<std::size_t>(elements), 0.0);
    return d;
}

inline rod::RodDefinition ring(double radius, double stiffness, int elements = 12) {
    rod::RodDefinition d;
    d.length = 2.0 * M_PI * radius;
    d.bendingModulus *= stiffness;
    d.naturalCurvature.assign(static_cast<std::size_t>(elements), 1.0 / radius);
    d.closed = true;
    return d;
}

/// Natural shape with the middle at `middle`, its tangent at `angle`, moving as a rigid body.
inline std::size_t put(step::World& w, const rod::RodDefinition& d, const Vec2& middle, double angle, double mu,
                       const Vec2& velocity = Vec2::Zero(), double spin = 0.0) {
    const rod::RodModel m(d);
    Eigen::VectorXd q = Eigen::VectorXd::Zero(m.dofs()), v = q;
    for (int i = 0; i < m.elements(); ++i)
        q[m.dofOfElement(i)] = d.naturalCurvature[static_cast<std::size_t>(i)];
    q[m.dofX()] = middle.x();
    q[m.dofY()] = middle.y();
    q[m.dofTheta()] = angle;
    v[m.dofX()] = velocity.x();
    v[m.dofY()] = velocity.y();
    v[m.dofTheta()] = spin;
    return step::addRod(w, d, q, v, mu);
}

/// One frame of the shells and of the host, as a program would do it.
inline void frame(step::Stepper& s, step::World& w, FakeHost& host, double dt,
                  const std::function<bool(const step::World&)>& observer = {}) {
    const step::FrameResult out = s.advance(w, dt, &host, observer);
    REQUIRE(out.failure.empty());
    host.step(out.advanced);
    s.learnFromHost(w, host, out.advanced);
}

inline Vec2 centre(const step::Rod& r) {
    return rod::massCentre(r.kin, r.gauss);
}

inline Vec2 momentum(const step::World& w) {
    Vec2 p = Vec2::Zero();
    for (const step::Rod& r : w.rods)
        for (std::size_t g = 0; g < r.u.size(); ++g)
            p += r.gauss.mass[g] * r.u[g];
    return p;
}

inline bool sameBits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return a.size() == b.size() &&
           std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

/// A straight strip of 1 m and 1 kg. Its first mode is at 3.6 Hz times the root of the modulus.
inline rod::RodDefinition metreStrip(double modulus) {
    rod::RodDefinition d;
    d.length = 1.0;
    d.thickness = 0.02;
    d.linearMass = 1.0;
    d.bendingModulus = modulus;
    d.naturalCurvature.assign(6, 0.0);
    return d;
}

/// Kinetic, of bending and gravity, J.
inline double mechanicalEnergy(const step::World& w) {
    double e = 0.0;
    for (const step::Rod& r : w.rods)
        e += rod::kineticEnergy(r.gauss, r.u) + rod::bendingEnergy(r.model, r.q) -
             r.model.mass() * w.gravity.dot(centre(r));
    return e;
}

/// One frame without a host that must not bring in energy.
inline void quietFrame(step::Stepper& s, step::World& w, double dt = 1.0 / 60.0) {
    const step::FrameResult out = s.advance(w, dt, nullptr, std::function<bool(const step::World&)>{});
    REQUIRE(out.failure.empty());
    CHECK(out.gained == 0.0);
}

/// Everything physical of two worlds agrees to the last bit.
inline bool sameState(const step::World& a, const step::World& b) {
    bool same = a.rods.size() == b.rods.size() && a.time == b.time && a.dtNext == b.dtNext &&
                a.counters.steps == b.counters.steps && a.energyBalance.friction == b.energyBalance.friction &&
                a.energyBalance.residual() == b.energyBalance.residual() && a.impulses.size() == b.impulses.size();
    for (std::size_t i = 0; same && i < a.rods.size(); ++i)
        same = sameBits(a.rods[i].q, b.rods[i].q) && sameBits(a.rods[i].v, b.rods[i].v);
    for (std::size_t i = 0; same && i < a.impulses.size(); ++i)
        same = a.impulses[i].id == b.impulses[i].id && a.impulses[i].normal == b.impulses[i].normal &&
               a.impulses[i].tangent == b.impulses[i].tangent;
    return same;
}

} // namespace supercircle::test
