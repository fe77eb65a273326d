// Shells that spin freely: what the rotation does to their shape, and what their shape does to the rotation.

#include "tests/supercircle/step/setup.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Moment of inertia about the centre of mass at configuration q, kg m^2.
double inertiaAt(step::Rod r, const Eigen::VectorXd& q) {
    r.q = q;
    step::refreshRod(r);
    const Vec2 c = centre(r);
    double sum = 0.0;
    for (std::size_t g = 0; g < r.u.size(); ++g)
        sum += r.gauss.mass[g] * (r.kin.middle() + r.gauss.arm[g] - c).squaredNorm();
    return sum;
}

/// Angular momentum about the origin, kg m^2/s.
double angularMomentum(const step::Rod& r) {
    double sum = 0.0;
    for (std::size_t g = 0; g < r.u.size(); ++g)
        sum += r.gauss.mass[g] * rod::cross(r.kin.middle() + r.gauss.arm[g], r.u[g]);
    return sum;
}

} // namespace

TEST_CASE("a spinning shell opens by the centrifugal force", "[step]") {
    // At steady spin w the curvatures balance grad(w^2 I / 2): bending energy sum (w^2 / 2 dI/dkappa_i)^2 / (2 B l),
    // linear because the shell opens by less than a per cent of kappa at 50 rad/s.
    const double spin = 50.0;
    step::World w;
    put(w, paperShell(), {0.0, 0.0}, 0.0, 0.35);
    step::Rod& r = w.rods[0];
    const Vec2 v = spin * rod::perp(r.kin.middle() - centre(r));
    r.v[r.model.dofX()] = v.x();
    r.v[r.model.dofY()] = v.y();
    r.v[r.model.dofTheta()] = spin;
    step::refreshRod(r);
    double expected = 0.0;
    for (int i = 0; i < r.model.elements(); ++i) {
        Eigen::VectorXd more = r.q, less = r.q;
        more[i] += 1e-3;
        less[i] -= 1e-3;
        const double force = 0.5 * spin * spin * (inertiaAt(r, more) - inertiaAt(r, less)) / 2e-3;
        expected += 0.5 * force * force / rod::bendingStiffness(r.model, r.model.elementOfDof(i));
    }
    r.dampingRatio = 0.3; // the swing that the sudden start makes dies; a rigid spin is not damped
    const double momentum = angularMomentum(r);
    step::Stepper s({});
    for (int i = 0; i < 250; ++i)
        REQUIRE(s.advance(w, 4e-3, nullptr, {}).failure.empty());
    // Opening lowers the spin, w = L / I, and the force by its square.
    const double factor = momentum / (inertiaAt(r, r.q) * spin);
    CHECK(rod::bendingEnergy(r.model, r.q) / (expected * std::pow(factor, 4)) ==
          Approx(1.0).epsilon(0.02)); // the gradient of I is that of the shape before it opened
    CHECK(angularMomentum(r) == Approx(momentum).epsilon(1e-9));
}

TEST_CASE("a free shell that swings and spins keeps its angular momentum over a hundred turns", "[step]") {
    for (const bool game : {false, true}) {
        INFO("game " << game);
        step::World w;
        const double spin = 50.0;
        put(w, paperShell(), {0.0, 0.0}, 0.5, 0.35, {0.5, 0.0}, spin);
        step::Rod& r = w.rods[0];
        for (int i = 0; i < r.model.elements(); ++i)
            r.q[r.model.dofOfElement(i)] *= 1.0 + 0.3 * std::sin(0.7 * i);
        step::refreshRod(r);
        const double before = angularMomentum(r);
        step::Settings settings;
        if (game) {
            settings.freeError = 0.05;
            settings.freeSteps = 8;
            settings.contact.tolerance = 1e-6;
        }
        step::Stepper s(settings);
        const double dt = game ? 1.0 / 60.0 : 4e-3;
        while (w.time < 100.0 * 2.0 * M_PI / spin)
            REQUIRE(s.advance(w, dt, nullptr, {}).failure.empty());
        // No stage has a torque about the centre of mass. What is left is the tolerance of the stages.
        CHECK(angularMomentum(r) == Approx(before).epsilon(game ? 1e-6 : 1e-9));
    }
}
