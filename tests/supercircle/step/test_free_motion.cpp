// Motion without contact: closed forms and invariants of the step itself.

#include "supercircle/step/stepper.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;
using rod::Vec2;

namespace {

rod::RodDefinition shell(double phiBar = 0.75, int elements = 15) {
    rod::RodDefinition d; // the paper's shell
    d.length = 2.0 * M_PI * phiBar * 0.0192;
    d.naturalCurvature.assign(static_cast<std::size_t>(elements), 1.0 / 0.0192);
    return d;
}

Eigen::VectorXd natural(const rod::RodModel& m) {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(m.dofs());
    for (int i = 0; i < m.elements(); ++i)
        q[m.dofOfElement(i)] = m.definition().naturalCurvature[static_cast<std::size_t>(i)];
    return q;
}

step::Settings fixedStep(double dt) {
    step::Settings s;
    s.fixedDt = dt;
    return s;
}

} // namespace

TEST_CASE("free fall is the parabola and closes the energy balance", "[step]") {
    step::World w;
    w.gravity = {0.0, -9.81};
    const rod::RodModel model(shell());
    step::addRod(w, shell(), natural(model), Eigen::VectorXd::Zero(model.dofs()), 0.35);
    step::Stepper s(fixedStep(1e-3));
    const double y0 = w.rods[0].q[model.dofY()];
    for (int i = 0; i < 200; ++i)
        REQUIRE(s.advance(w, 1e-3, nullptr, {}).failure.empty());
    // a scheme of second order is exact for a parabola; only round-off remains
    CHECK(w.rods[0].q[model.dofY()] - y0 == Approx(-9.81 * 0.5 * 0.2 * 0.2).epsilon(1e-10));
    CHECK(std::abs(w.energyBalance.residual()) < 1e-12 * w.energyBalance.kinetic + 1e-15);
}

TEST_CASE("a rigidly spinning shell keeps its momenta and loses next to no energy", "[step]") {
    step::World w;
    const rod::RodModel model(shell());
    Eigen::VectorXd v = Eigen::VectorXd::Zero(model.dofs());
    v[model.dofTheta()] = 50.0;
    v[model.dofX()] = 0.3;
    step::addRod(w, shell(), natural(model), v, 0.35);
    step::Stepper s(fixedStep(1e-4));
    const double before = w.energyBalance.kinetic;
    const auto momentum = [&] {
        Vec2 p = Vec2::Zero();
        for (std::size_t g = 0; g < w.rods[0].u.size(); ++g)
            p += w.rods[0].gauss.mass[g] * w.rods[0].u[g];
        return p;
    };
    const Vec2 p0 = momentum();
    for (int i = 0; i < 5000; ++i)
        REQUIRE(s.advance(w, 1e-4, nullptr, {}).failure.empty());
    CHECK((momentum() - p0).norm() < 1e-12 * p0.norm() + 1e-18);
    // The centrifugal force opens the shell, which stores bending energy and swings.
    const double total = w.energyBalance.kinetic + w.energyBalance.bending;
    CHECK(total <= before * (1.0 + 1e-11)); // 5000 steps of round-off
    CHECK(total > 0.99 * before);
    CHECK(std::abs(w.energyBalance.residual()) < 1e-10 * before);
}

TEST_CASE("free vibration in several modes: the scheme takes energy and never gives any", "[step]") {
    step::World w;
    const rod::RodModel model(shell());
    Eigen::VectorXd q = natural(model);
    for (int i = 0; i < model.elements(); ++i)
        q[model.dofOfElement(i)] *= 1.0 + 0.2 * std::sin(0.7 * i);
    step::addRod(w, shell(), q, Eigen::VectorXd::Zero(model.dofs()), 0.35);
    step::Stepper s(fixedStep(1e-4));
    const double before = w.energyBalance.bending;
    double last = before;
    for (int i = 0; i < 500; ++i) {
        REQUIRE(s.advance(w, 1e-4, nullptr, {}).failure.empty());
        const double now = w.energyBalance.stored();
        CHECK(now <= last * (1.0 + 1e-12));
        last = now;
    }
    CHECK(w.energyBalance.numerical == Approx(before - last).epsilon(1e-9));
    CHECK(std::abs(w.energyBalance.residual()) < 1e-10 * before);
}
