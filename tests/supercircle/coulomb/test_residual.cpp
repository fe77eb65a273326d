// The residual evaluation: its projection, its definition on a problem solved by hand, and its special cases.

#include "supercircle/coulomb/residual.h"
#include "supercircle/coulomb/solver.h"
#include "tests/supercircle/coulomb/generator.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace supercircle::coulomb;

TEST_CASE("the projection is the nearest point of the cone") {
    generator::Random random(3);
    for (int k = 0; k < 1000; ++k) {
        const double mu = random.index(4) == 0 ? 0.0 : random.uniform(0.0, 2.0);
        const double n = random.uniform(-1.0, 1.0), t = random.uniform(-1.0, 1.0);
        double pn = n, pt = t;
        projectOnCone(mu, pn, pt);
        CHECK(pn >= 0.0);
        CHECK(std::abs(pt) <= mu * pn + 1e-15);
        // Moreau: x - P(x) is normal to P(x) and in the polar cone, to round-off of numbers of size one.
        CHECK(std::abs((n - pn) * pn + (t - pt) * pt) < 1e-14);
        for (const double edge : {mu, -mu})
            CHECK((n - pn) + edge * (t - pt) < 1e-14);
    }
}

namespace {

/// A point mass m on the floor with free velocity v.
Problem particle(double m, double vx, double vy, double mu) {
    Problem problem;
    problem.dt = 1e-3;
    problem.bodies.push_back({Eigen::MatrixXd(Eigen::Vector2d(m, m).asDiagonal()), Eigen::Vector2d(vx, vy)});
    Contact contact;
    contact.a = 0;
    contact.mu = mu;
    contact.Ha.resize(2, 2);
    contact.Ha << 0.0, 1.0, 1.0, 0.0;
    problem.contacts.push_back(contact);
    return problem;
}

} // namespace

TEST_CASE("contact residual of a particle on the floor, by hand") {
    // m = 2, v = (3, -1), mu = 0.5: it must slip; r_n = 2, r_t = -1, and d = 1/2.
    const Problem problem = particle(2.0, 3.0, -1.0, 0.5);
    CHECK(evaluateResidual(problem, Eigen::Vector2d(2.0, -1.0)).contactResidual < 1e-15);
    // r = 0: u = (-1, 3); p = -(u + mu |u_t| n)/d = (-1, -6), projected on the cone: n = (-1 + 0.5 * 6) / 1.25 = 1.6,
    // t = -0.8. F = (-1.6, 0.8), d F^2 = 1.6; q^2/d = 20.
    const Residual zero = evaluateResidual(problem, Eigen::Vector2d::Zero());
    CHECK(zero.contactResidual == Approx(std::sqrt(1.6 / 20.0)).epsilon(1e-14));
    CHECK(zero.penetrationSpeed == Approx(1.0).epsilon(1e-15));
    CHECK(zero.impulseError == Approx(std::sqrt(3.2)).epsilon(1e-14));
}

TEST_CASE("rows that contradict each other are no solution, however large the impulses") {
    // Floor and ceiling both close at 1 m/s on a point mass of 2 kg. Beside 1e20 N s the speeds are lost: r - r = 0.
    Problem problem = particle(2.0, 0.0, 0.0, 0.0);
    problem.contacts.push_back(problem.contacts[0]);
    problem.contacts[1].Ha.row(0) *= -1.0;
    for (Contact& c : problem.contacts)
        c.w.x() = -1.0;
    for (const double r : {0.0, 1.0, 1e6, 1e9, 1e14, 1e20, 1e50})
        CHECK(evaluateResidual(problem, Eigen::Vector4d(r, 0.0, r, 0.0)).contactResidual > 1e-8);
    Solver solver;
    for (const double r : {0.0, 1e14, 1e50}) {
        problem.r0 = Eigen::Vector4d(r, 0.0, r, 0.0);
        Eigen::VectorXd found;
        std::vector<Eigen::VectorXd> velocity;
        CHECK_FALSE(solver.solve(problem, SolverOptions{}, found, velocity).converged);
    }
}

TEST_CASE("no contact closes") {
    const Problem problem = particle(2.0, 3.0, 1.0, 0.5);
    CHECK(evaluateResidual(problem, Eigen::Vector2d::Zero()).contactResidual == 0.0);
    CHECK(evaluateResidual(problem, Eigen::Vector2d(1.0, 0.0)).contactResidual > 0.1); // finite, and not small
    CHECK(std::isfinite(evaluateResidual(problem, Eigen::Vector2d(1.0, 0.0)).contactResidual));
}

TEST_CASE("a residual of some percent is never converged, however light the body") {
    for (const double m : {1e-3, 1e-9, 1e-12, 1e-15, 1e-20}) {
        Problem problem = particle(m, 3.0, -1.0, 0.5);
        Solver solver;
        Eigen::VectorXd r;
        std::vector<Eigen::VectorXd> v;
        for (const double share : {0.0, 0.9, 0.97}) { // of the solution, as a warm start
            problem.r0 = share * m * Eigen::Vector2d(1.0, -0.5);
            SolverOptions options;
            options.method = Method::None;
            const SolveReport start = solver.solve(problem, options, r, v);
            INFO(m << " kg, share " << share << ", residual " << start.contactResidual);
            CHECK(start.contactResidual > 5e-3);
            CHECK_FALSE(start.converged);
            options.method = Method::Strategy;
            const SolveReport solved = solver.solve(problem, options, r, v);
            CHECK(solved.converged);
            CHECK(solved.contactResidual <= 1e-3);
        }
    }
}

TEST_CASE("no impulse that is small in newtons seconds makes a residual of three percent converged") {
    // Body at 3 m/s to the side that closes at 1 m/s, in units that scale masses and impulses by 1e-30 to 1e30.
    for (const double scale : {1e-30, 1e-12, 1.0, 1e12, 1e30}) {
        Problem problem = particle(scale, 3.0, -1.0, 0.5);
        problem.r0 = scale * 0.97 * Eigen::Vector2d(1.0, -0.5);
        SolverOptions options;
        options.method = Method::None;
        options.absoluteImpulse *= scale;
        Solver solver;
        Eigen::VectorXd r;
        std::vector<Eigen::VectorXd> v;
        const SolveReport report = solver.solve(problem, options, r, v);
        INFO("scale " << scale << ", residual " << report.contactResidual);
        CHECK_FALSE(report.converged);
        CHECK(report.contactResidual == Approx(evaluateResidual(problem, problem.r0).contactResidual).epsilon(1e-12));
    }
}

TEST_CASE("bodies at rest whose free velocities are round-off are solved, slow ones are not") {
    // Free velocities of 1 unit of the last digit at the contact, out of terms of 1 m/s, need no impulse. A thousand
    // times as much is beyond what the sums of two terms leave, and must be stopped.
    Problem problem = particle(1.0, 0.0, -1.0, 0.5);
    for (const double scale : {1e-12, 1.0, 1e12}) {
        for (const double units : {1.0, 1000.0}) {
            problem.bodies[0].vFree[1] = -scale;
            problem.contacts[0].w =
                Eigen::Vector2d(scale * (1.0 - units * std::numeric_limits<double>::epsilon()), 0.0);
            SolverOptions options;
            options.method = Method::None;
            options.absoluteImpulse = 0.0;
            Solver solver;
            Eigen::VectorXd r;
            std::vector<Eigen::VectorXd> v;
            const SolveReport report = solver.solve(problem, options, r, v);
            INFO("scale " << scale << ", units " << units << ", residual " << report.contactResidual);
            CHECK(report.converged == (units == 1.0));
            CHECK((report.contactResidual <= options.tolerance) == (units == 1.0));
        }
    }
}

TEST_CASE("solutions that only the absolute floor excuses are marked") {
    const Problem exact = particle(1.0, 3.0, -1.0, 0.5); // slides: r = (1, -0.5) N s
    struct {
        double share, floor;
        bool converged, byFloor;
    } const cases[] = {{1.0, 1e-3, true, false}, {1.0 - 1e-5, 1e-3, true, true}, {1.0 - 1e-5, 0.0, false, false}};
    for (const auto& c : cases) {
        Problem problem = exact;
        problem.r0 = c.share * Eigen::Vector2d(1.0, -0.5);
        SolverOptions options;
        options.method = Method::None;
        options.absoluteImpulse = c.floor;
        Solver solver;
        Eigen::VectorXd r;
        std::vector<Eigen::VectorXd> v;
        const SolveReport report = solver.solve(problem, options, r, v);
        INFO("share " << c.share << ", floor " << c.floor << ", residual " << report.contactResidual);
        CHECK(report.converged == c.converged);
        CHECK(report.byAbsoluteFloor == c.byFloor);
    }
}

TEST_CASE("numbers that are not finite never pass") {
    const Problem problem = particle(2.0, 3.0, -1.0, 0.5);
    CHECK(std::isinf(
        evaluateResidual(problem, Eigen::Vector2d(std::numeric_limits<double>::quiet_NaN(), 0.0)).contactResidual));
}

TEST_CASE("self contact: both rows of one body add up") {
    generator::Random random(4);
    Problem problem = generator::cloud({.bodies = 1, .contacts = 1, .freedoms = 4, .self = 1.0}, random);
    const Contact& contact = problem.contacts[0];
    REQUIRE(contact.a == contact.b);
    Problem merged = problem;
    merged.contacts[0].b = -1;
    merged.contacts[0].Ha = contact.Ha + contact.Hb;
    merged.contacts[0].Hb.resize(2, 0);
    const Eigen::Vector2d r(0.3, 0.1);
    CHECK(evaluateResidual(problem, r).contactResidual ==
          Approx(evaluateResidual(merged, r).contactResidual).epsilon(1e-13));
}
