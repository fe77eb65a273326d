// Mechanics with closed forms, stepped with the solver: v+ = v_free + A^-1 H^T r, nothing else.

#include "supercircle/coulomb/residual.h"
#include "supercircle/coulomb/solver.h"
#include "tests/supercircle/coulomb/generator.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::coulomb;

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

Contact floorContact(double x, double y, double mu) {
    Contact contact; // point (x, y) of a rigid body on a horizontal floor
    contact.a = 0;
    contact.mu = mu;
    contact.Ha.resize(2, 3);
    contact.Ha << 0.0, 1.0, x, 1.0, 0.0, -y;
    return contact;
}

/// Velocity after `time` of a unit block (0.2 x 0.1 m) on a slope, in the slope's frame, g = 1.
Eigen::Vector3d slide(double slope, double mu, double time, int steps) {
    const double dt = time / steps;
    Problem problem;
    problem.dt = dt;
    problem.bodies.push_back({Eigen::MatrixXd(Eigen::Vector3d(1.0, 1.0, 0.05 / 12.0).asDiagonal()), {}});
    for (const double x : {-0.1, 0.1})
        problem.contacts.push_back(floorContact(x, -0.05, mu));
    Solver solver;
    Eigen::VectorXd r;
    std::vector<Eigen::VectorXd> v(1, Eigen::Vector3d::Zero());
    for (int k = 0; k < steps; ++k) {
        problem.bodies[0].vFree = v[0] + dt * Eigen::Vector3d(std::sin(slope), -std::cos(slope), 0.0);
        REQUIRE(solver.solve(problem, {.tolerance = 1e-10}, r, v).converged);
        problem.r0 = r;
    }
    return v[0];
}

} // namespace

TEST_CASE("a block slides down a slope or stays") {
    // a / g = sin - mu cos; Moreau's step is exact for constant forces, so 1e-9 is the solver's tolerance adding up
    CHECK(slide(30.0 * kDegree, 0.35, 1.0, 200)[0] == Approx(0.196891109).epsilon(3e-9));
    CHECK(slide(10.0 * kDegree, 0.1, 1.0, 200)[0] == Approx(0.0751674024).epsilon(3e-9));
    CHECK(slide(19.0 * kDegree, 0.35, 1.0, 200).norm() < 1e-9);           // tan 19 = .344: sticks
    CHECK(slide(19.6 * kDegree, 0.35, 1.0, 200)[0] > 1e-3);               // tan 19.6 = .356: slides
    CHECK(slide(30.0 * kDegree, 0.35, 1.0, 200).tail<2>().norm() < 1e-9); // neither lifts nor turns
}

TEST_CASE("a sliding ring comes to roll") {
    // Friction mu g brakes v and spins the ring up; both meet at v0/2 after x* = 3 v0^2 / (8 mu g)  (g = R = m = 1).
    for (const auto& [mu, expected] : {std::pair{0.1, 3.75}, std::pair{0.35, 1.07142857}}) {
        const double dt = 1e-3;
        Problem problem;
        problem.dt = dt;
        problem.bodies.push_back({Eigen::MatrixXd::Identity(3, 3), {}});
        problem.contacts.push_back(floorContact(0.0, -1.0, mu));
        Solver solver;
        Eigen::VectorXd r;
        std::vector<Eigen::VectorXd> v(1, Eigen::Vector3d(1.0, 0.0, 0.0));
        double x = 0.0;
        int steps = 0;
        while (std::abs(v[0][0] + v[0][2]) > 1e-9 && steps < 20000) {
            const double before = v[0][0];
            problem.bodies[0].vFree = v[0] + dt * Eigen::Vector3d(0.0, -1.0, 0.0);
            REQUIRE(solver.solve(problem, {.tolerance = 1e-12}, r, v).converged);
            x += 0.5 * dt * (before + v[0][0]); // exact for constant acceleration
            ++steps;
        }
        CHECK(v[0][0] == Approx(0.5).epsilon(1e-9));
        CHECK(x == Approx(expected).margin(dt)); // sliding ends inside a step
        CHECK(static_cast<double>(steps) * dt == Approx(0.5 / mu).margin(1.01 * dt));
    }
}

TEST_CASE("a tower at rest carries its weight") {
    // Static determinacy: contacts of level k together carry the weight above, whatever its share left and right.
    generator::Random random(9);
    Problem problem = generator::tower(8, 0.5, 1.0, 1e-2, random);
    for (Body& body : problem.bodies)
        body.vFree = Eigen::Vector3d(0.0, -0.0981, 0.0);
    Solver solver;
    Eigen::VectorXd r;
    std::vector<Eigen::VectorXd> v;
    REQUIRE(solver.solve(problem, {.tolerance = 1e-10}, r, v).converged);
    for (Eigen::Index k = 0; k < 8; ++k)
        CHECK(r[4 * k] + r[4 * k + 2] == Approx(0.0981 * static_cast<double>(8 - k)).epsilon(1e-7));
}

TEST_CASE("contacts never add energy") {
    // v A (v - v_free) = (u - w) r = -mu r_n |u_t| - w_n r_n <= 0, hence |v|_A <= |v_free|_A.
    generator::Random random(10);
    Solver solver;
    for (int k = 0; k < 50; ++k) {
        const Problem problem =
            generator::cloud({.bodies = 8, .contacts = 30, .mu = random.uniform(0.0, 1.0), .self = 0.1}, random);
        Eigen::VectorXd r;
        std::vector<Eigen::VectorXd> v;
        REQUIRE(solver.solve(problem, {}, r, v).converged);
        double before = 0.0, after = 0.0;
        for (std::size_t b = 0; b < v.size(); ++b) {
            before += problem.bodies[b].vFree.dot(problem.bodies[b].A * problem.bodies[b].vFree);
            after += v[b].dot(problem.bodies[b].A * v[b]);
        }
        CHECK(after <= before * (1.0 + 1e-7)); // the contact residual is 1e-8
    }
}
