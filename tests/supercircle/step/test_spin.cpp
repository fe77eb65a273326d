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
    // At steady spin w each curvature is in balance with w^2 / 2 dI/dkappa at the open shape. At 50 rad/s the shell
    // opens by less than a per cent, at 400 by a third of its curvature. The elastica of the same angular momentum,
    // B kappa' = B kappa_0' - t x N, N' = -lambda w^2 r with free ends (shooting, 1e-10), ends at these spins, with its
    // tips so far apart.
    struct Case {
        double spin, end, tips; // rad/s, rad/s, R
    };
    for (const bool game : {false, true})
        for (const auto& [spin, end, tips] :
             {Case{50.0, 49.4490382, 1.45094656}, Case{400.0, 285.616905, 2.66360985}}) {
            CAPTURE(game, spin);
            step::World w;
            put(w, paperShell(), {0.0, 0.0}, 0.0, 0.35);
            step::Rod& r = w.rods[0];
            const Vec2 v = spin * rod::perp(r.kin.middle() - centre(r));
            r.v[r.model.dofX()] = v.x();
            r.v[r.model.dofY()] = v.y();
            r.v[r.model.dofTheta()] = spin;
            step::refreshRod(r);
            r.dampingRatio = 0.3; // the swing that the sudden start makes dies; a rigid spin is not damped
            const double momentum = angularMomentum(r);
            step::Stepper s(game ? step::gameSettings() : step::Settings{});
            const double frame = game ? 1.0 / 60.0 : 4e-3;
            while (w.time < 1.0)
                REQUIRE(s.advance(w, frame, nullptr, {}).failure.empty());
            const double now = momentum / inertiaAt(r, r.q); // opening lowers the spin
            double off = 0.0, all = 0.0;
            Eigen::VectorXd force = Eigen::VectorXd::Zero(r.model.dofs());
            rod::addBendingForce(r.model, r.q, force);
            for (int i = 0; i < r.model.elements(); ++i) {
                Eigen::VectorXd more = r.q, less = r.q;
                more[i] += 1e-3;
                less[i] -= 1e-3;
                force[i] += 0.5 * now * now * (inertiaAt(r, more) - inertiaAt(r, less)) / 2e-3;
                off = std::max(off, std::abs(force[i] / rod::bendingStiffness(r.model, r.model.elementOfDof(i))));
                all = std::max(all, std::abs(r.q[i] - 1.0 / kR));
            }
            const double apart = (r.kin.node(r.model.elements()) - r.kin.node(0)).norm() / kR;
            CHECK(now == Approx(end).epsilon(game ? 0.03 : 0.01));
            CHECK(apart - std::sqrt(2.0) == Approx(tips - std::sqrt(2.0)).epsilon(game ? 0.03 : 0.01));
            CHECK(off < 1e-5 * all); // what is left of the swing, and of the differences that give the force
            CHECK(angularMomentum(r) == Approx(momentum).epsilon(game ? 1e-6 : 1e-9));
        }
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
        step::Stepper s(game ? step::gameSettings() : step::Settings{});
        const double dt = game ? 1.0 / 60.0 : 4e-3;
        while (w.time < 100.0 * 2.0 * M_PI / spin)
            REQUIRE(s.advance(w, dt, nullptr, {}).failure.empty());
        // No stage has a torque about the centre of mass. What is left is the tolerance of the stages.
        CHECK(angularMomentum(r) == Approx(before).epsilon(game ? 1e-6 : 1e-9));
    }
}

TEST_CASE("a force at the end of a strip turns it as a rigid bar, in frames of a game", "[step]") {
    // A bar of mass m and length L, force F along x at its end, at the angle a to it: the centre moves by F t^2 / 2 m,
    // and m L^2 / 12 a'' = -F L / 2 sin a.
    const rod::RodDefinition d = strip(0.1, 1e4);
    const double mass = rod::RodModel(d).mass(), force = 8.0 * mass * d.length, start = 2.5; // swings at 7 rad/s
    for (const double faster : {1.0, 10.0, 60.0}) {
        step::World w;
        put(w, d, {0.0, 0.0}, start, 0.35);
        const double f = faster * faster * force;
        w.rods[0].forces.push_back({d.length, Vec2(f, 0.0), 0.0, false, 0});
        step::Stepper s(step::gameSettings());
        double a = start, spin = 0.0, gained = 0.0;
        const double duration = 3.0 / faster;
        const int frames = static_cast<int>(std::ceil(60.0 * duration));
        for (int i = 0; i < frames; ++i) {
            const step::FrameResult out = s.advance(w, duration / frames, nullptr, {});
            REQUIRE(out.failure.empty());
            gained += out.gained;
        }
        const int most = 40000;
        const double h = duration / most;
        for (int i = 0; i < most; ++i) { // leap frog, 1e-8 of a turn
            spin -= 0.5 * h * 6.0 * f / (mass * d.length) * std::sin(a);
            a += h * spin;
            spin -= 0.5 * h * 6.0 * f / (mass * d.length) * std::sin(a);
        }
        INFO("faster " << faster << ", energy " << w.energyBalance.kinetic << " J");
        const step::Rod& r = w.rods[0];
        CHECK(gained == 0.0);
        CHECK(centre(r).x() == Approx(0.5 * f / mass * duration * duration).epsilon(1e-9));
        // eight steps a frame at most: a period of 0.9 s, at the fastest rate of 15 ms
        CHECK(r.q[r.model.dofTheta()] == Approx(a).margin(faster < 20.0 ? 0.02 : 0.2));
        CHECK(std::abs(w.energyBalance.numerical) < 1e-3 * w.energyBalance.work);
    }
}
