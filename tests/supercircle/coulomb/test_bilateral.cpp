// Joint points in the same problem as the contacts: closed forms, a dense reference, and every method.

#include "supercircle/coulomb/dump.h"
#include "supercircle/coulomb/law.h"
#include "supercircle/coulomb/residual.h"
#include "supercircle/coulomb/solver.h"
#include "tests/supercircle/coulomb/generator.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace supercircle::coulomb;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Method kMethods[] = {Method::Strategy, Method::GaussSeidel, Method::Accelerated, Method::Path,
                               Method::Newton};

struct BilateralSolution {
    SolveReport report;
    Eigen::VectorXd r;
    std::vector<Eigen::VectorXd> v;
};

BilateralSolution solve(const Problem& problem, const SolverOptions& options) {
    Solver solver;
    BilateralSolution solution;
    solution.report = solver.solve(problem, options, solution.r, solution.v);
    return solution;
}

/// Rows of point (x, y) of a rigid body in the frame of unit normal n: velocity along n and along n turned by 90 deg.
Eigen::Matrix<double, 2, Eigen::Dynamic> pointRows(double x, double y, const Eigen::Vector2d& n) {
    Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, 3);
    rows << n.x(), n.y(), -y * n.x() + x * n.y(), -n.y(), n.x(), y * n.y() + x * n.x();
    return rows;
}

Contact joint(std::int32_t a, std::int32_t b, bool locked) {
    Contact contact;
    contact.a = a;
    contact.b = b;
    contact.kind = ContactKind::Bilateral;
    contact.mu = locked ? kInfinity : 0.0;
    return contact;
}

Body rigid(double mass, double inertia, const Eigen::Vector3d& vFree) {
    return {Eigen::MatrixXd(Eigen::Vector3d(mass, mass, inertia).asDiagonal()), vFree};
}

/// Makes every `nth` contact a joint, locked and free in turn, without drive: v = 0 stays admissible, so a solution
/// exists (the cone of a joint's impulses is a linear space, the argument of generator.h holds).
Problem withJoints(Problem problem, std::size_t nth) {
    for (std::size_t c = 0; c < problem.contacts.size(); c += nth) {
        Contact& contact = problem.contacts[c];
        contact.kind = ContactKind::Bilateral;
        contact.mu = c / nth % 2 == 0 ? kInfinity : 0.0;
        contact.w.setZero();
    }
    return problem;
}

double energy(const Problem& problem, const std::vector<Eigen::VectorXd>& v) {
    double sum = 0.0;
    for (std::size_t b = 0; b < v.size(); ++b)
        sum += v[b].dot(problem.bodies[b].A * v[b]);
    return sum;
}

} // namespace

TEST_CASE("a bilateral law prescribes its rows and nothing else") {
    generator::Random random(3);
    for (int k = 0; k < 2000; ++k) {
        const double nn = std::pow(10.0, random.uniform(-3.0, 3.0)),
                     tt = nn * std::pow(10.0, random.uniform(-1.0, 1.0));
        const double nt = random.uniform(-0.99, 0.99) * std::sqrt(nn * tt);
        const double qn = random.uniform(-1.0, 1.0), qt = random.uniform(-1.0, 1.0);
        const LocalImpulse both = LocalLaw(nn, nt, tt, 0.0, BilateralRows::Both).solve(qn, qt);
        CHECK(std::abs(nn * both.n + nt * both.t + qn) < 1e-12); // 1 - .99^2 costs two digits of sixteen
        CHECK(std::abs(nt * both.n + tt * both.t + qt) < 1e-12);
        const LocalImpulse normal = LocalLaw(nn, nt, tt, 0.0, BilateralRows::Normal).solve(qn, qt);
        CHECK(normal.t == 0.0);
        CHECK(std::abs(nn * normal.n + qn) < 1e-15);
    }
    // One freedom behind two rows: what can be held is held, and the impulse stays of the size of the load.
    const LocalImpulse single = LocalLaw(1.0, 2.0, 4.0, 0.0, BilateralRows::Both).solve(0.5, 1.0);
    CHECK(std::abs(single.n + 2.0 * single.t + 0.5) < 1e-9);
    CHECK(std::hypot(single.n, single.t) < 1.0);
    const LocalImpulse nothing = LocalLaw(0.0, 0.0, 0.0, 0.0, BilateralRows::Both).solve(1.0, 1.0);
    CHECK((nothing.n == 0.0 && nothing.t == 0.0));
}

TEST_CASE("two welded bodies move as one") {
    // Centre of mass and spin of the compound: momentum / mass, moment of momentum / inertia (Steiner).
    Problem problem;
    problem.dt = 1e-2;
    problem.bodies = {rigid(2.0, 0.3, {1.0, -0.5, 4.0}), rigid(3.0, 0.7, {-2.0, 0.2, -1.0})};
    const Eigen::Vector2d ca(0.0, 0.0), cb(1.0, 0.4), weld(0.6, -0.1), second(0.2, 0.5);
    const Eigen::Vector2d n = Eigen::Vector2d(0.6, 0.8);
    Contact point = joint(0, 1, true);
    point.Ha = pointRows(weld.x() - ca.x(), weld.y() - ca.y(), n);
    point.Hb = -pointRows(weld.x() - cb.x(), weld.y() - cb.y(), n);
    Contact item = joint(0, 1, false); // a second point along a line that does not pass through the first
    item.Ha = pointRows(second.x() - ca.x(), second.y() - ca.y(), {1.0, 0.0});
    item.Hb = -pointRows(second.x() - cb.x(), second.y() - cb.y(), {1.0, 0.0});
    problem.contacts = {point, item};
    const Eigen::Vector2d centre = (2.0 * ca + 3.0 * cb) / 5.0;
    const Eigen::Vector2d mean = (2.0 * Eigen::Vector2d(1.0, -0.5) + 3.0 * Eigen::Vector2d(-2.0, 0.2)) / 5.0;
    const auto moment = [&](const Eigen::Vector2d& c, const Eigen::Vector2d& v) {
        return (c - centre).x() * v.y() - (c - centre).y() * v.x();
    };
    const double inertia = 0.3 + 0.7 + 2.0 * (ca - centre).squaredNorm() + 3.0 * (cb - centre).squaredNorm();
    const double spin = (0.3 * 4.0 - 0.7 + 2.0 * moment(ca, {1.0, -0.5}) + 3.0 * moment(cb, {-2.0, 0.2})) / inertia;
    for (const Method method : kMethods) {
        const BilateralSolution solution =
            solve(problem, {.method = method, .tolerance = 1e-12, .maxGaussSeidelIterations = 5000});
        CAPTURE(std::string(name(method)), solution.report.contactResidual);
        CHECK(solution.report.converged);
        const Eigen::Vector2d arm = ca - centre;
        CHECK((solution.v[0] - Eigen::Vector3d(mean.x() - spin * arm.y(), mean.y() + spin * arm.x(), spin)).norm() <
              1e-9);
        CHECK(std::abs(solution.v[1][2] - spin) < 1e-9);
        CHECK(evaluateResidual(problem, solution.r).contactResidual < 1e-11);
    }
}

TEST_CASE("a row of hanging bobs pulls, a standing one pushes, and each link carries what lies beyond") {
    constexpr int count = 40;
    constexpr double g = 9.81, dt = 1e-2, mass = 0.2, angle = 0.3;
    for (const double sign : {1.0, -1.0}) {
        // Links along the direction `angle` off the vertical at rest; the bob's weight component along it is carried.
        Problem problem;
        problem.dt = dt;
        const Eigen::Vector2d along(std::sin(angle), std::cos(angle));
        for (int k = 0; k < count; ++k) {
            problem.bodies.push_back(
                {Eigen::MatrixXd(mass * Eigen::Matrix2d::Identity()), Eigen::Vector2d(0.0, -g * dt)});
            Contact link = joint(k, k == 0 ? -1 : k - 1, false);
            link.Ha.resize(2, 2);
            link.Ha << sign * along.x(), sign * along.y(), -sign * along.y(), sign * along.x();
            if (k > 0)
                link.Hb = -link.Ha;
            problem.contacts.push_back(link);
        }
        for (const Method method : {Method::Strategy, Method::Path, Method::Newton}) {
            const BilateralSolution solution = solve(problem, {.method = method, .tolerance = 1e-11});
            CAPTURE(sign, std::string(name(method)), solution.report.contactResidual);
            CHECK(solution.report.converged);
            for (Eigen::Index k = 0; k < count; ++k) {
                const double load = sign * static_cast<double>(count - k) * mass * g * dt * std::cos(angle);
                CHECK(solution.r[2 * k] == Approx(load).epsilon(1e-7)); // condition of a chain of 40: some 600
                CHECK(solution.r[2 * k + 1] == 0.0);
            }
        }
    }
}

TEST_CASE("a crate on a pin with a belt under its far corner") {
    // Moments about the pin: N (a + b) -+ mu N H = m g a; friction points with the belt.
    constexpr double m = 3.0, g = 9.81, dt = 1e-2, mu = 0.4, a = 0.5, b = 0.3, h = 0.2;
    for (const double belt : {0.0, 1.0, -1.0}) {
        Problem problem;
        problem.dt = dt;
        problem.bodies.push_back(rigid(m, 0.4, {0.0, -g * dt, 0.0}));
        Contact pin = joint(0, -1, true);
        pin.Ha = pointRows(-a, h, {0.28, 0.96});
        Contact floor;
        floor.a = 0;
        floor.mu = belt == 0.0 ? 0.0 : mu;
        floor.Ha = pointRows(b, -h, {0.0, 1.0});
        floor.w = {0.0, belt}; // the tangent is -x: a belt that runs to +x gives u_t = +belt
        problem.contacts = {pin, floor};
        const double side = belt == 0.0 ? 0.0 : belt > 0.0 ? 1.0 : -1.0;
        const double normal = m * g * dt * a / (a + b + side * mu * 2.0 * h);
        for (const Method method : kMethods) {
            const BilateralSolution solution =
                solve(problem, {.method = method, .tolerance = 1e-12, .maxGaussSeidelIterations = 20000});
            CAPTURE(belt, std::string(name(method)), solution.report.contactResidual);
            CHECK(solution.report.converged);
            CHECK(solution.r[2] == Approx(normal).epsilon(1e-9));
            CHECK(solution.r[3] == Approx(-side * mu * normal).margin(1e-12));
            const Eigen::Vector2d force =
                solution.r[0] * Eigen::Vector2d(0.28, 0.96) + solution.r[1] * Eigen::Vector2d(-0.96, 0.28);
            CHECK(force.y() == Approx(m * g * dt - normal).epsilon(1e-9));
            CHECK(force.x() == Approx(-side * mu * normal).margin(1e-9));
            CHECK(solution.v[0].norm() < 1e-11);
        }
    }
}

TEST_CASE("joints alone give the constrained least-change motion") {
    // Gauss' principle: v is the A-nearest to vFree with H v = -w; the dense pseudo-inverse solves it, redundant or
    // not.
    generator::Random random(17);
    for (int k = 0; k < 20; ++k) {
        Problem problem = withJoints(
            generator::cloud({.bodies = 12, .contacts = 14, .duplicates = k % 2 == 0 ? 0.3 : 0.0}, random), 1);
        const Eigen::Index nb = 12, n = 6;
        Eigen::MatrixXd H = Eigen::MatrixXd::Zero(0, nb * n), inverse = Eigen::MatrixXd::Zero(nb * n, nb * n);
        Eigen::VectorXd free(nb * n);
        for (Eigen::Index b = 0; b < nb; ++b) {
            inverse.block(b * n, b * n, n, n) = problem.bodies[static_cast<std::size_t>(b)].A.inverse();
            free.segment(b * n, n) = problem.bodies[static_cast<std::size_t>(b)].vFree;
        }
        for (const Contact& contact : problem.contacts)
            for (Eigen::Index row = 0; row < (contact.locked() ? 2 : 1); ++row) {
                H.conservativeResize(H.rows() + 1, Eigen::NoChange);
                H.row(H.rows() - 1).setZero();
                H.block(H.rows() - 1, contact.a * n, 1, n) += contact.Ha.row(row);
                if (contact.b >= 0)
                    H.block(H.rows() - 1, contact.b * n, 1, n) += contact.Hb.row(row);
            }
        const Eigen::MatrixXd W = H * inverse * H.transpose();
        const Eigen::VectorXd r = -W.completeOrthogonalDecomposition().solve(H * free);
        const Eigen::VectorXd expected = free + inverse * (H.transpose() * r);
        for (const Method method : {Method::Strategy, Method::Path, Method::Newton}) {
            const BilateralSolution solution = solve(problem, {.method = method, .tolerance = 1e-10});
            CAPTURE(k, std::string(name(method)), solution.report.contactResidual);
            CHECK(solution.report.converged);
            for (Eigen::Index b = 0; b < nb; ++b) // condition of A 100, of W up to some 1e4
                CHECK((solution.v[static_cast<std::size_t>(b)] - expected.segment(b * n, n)).norm() <
                      1e-5 * (1.0 + expected.norm()));
        }
    }
}

TEST_CASE("all methods agree where joints and contacts mix") {
    // Without friction the motion is unique (a convex quadratic program in v).
    generator::Random random(23);
    for (int k = 0; k < 12; ++k) {
        Problem problem = withJoints(generator::cloud({.bodies = 10, .contacts = 24, .mu = 0.0}, random), 4);
        const BilateralSolution fast = solve(problem, {.tolerance = 1e-11});
        CAPTURE(k, fast.report.contactResidual);
        CHECK(fast.report.converged);
        for (const Method method : kMethods) {
            const BilateralSolution solution =
                solve(problem, {.method = method, .tolerance = 1e-11, .maxGaussSeidelIterations = 100000});
            CAPTURE(std::string(name(method)), solution.report.contactResidual);
            CHECK(solution.report.converged);
            for (std::size_t b = 0; b < fast.v.size(); ++b)
                CHECK((solution.v[b] - fast.v[b]).norm() < 1e-6 * (1.0 + fast.v[b].norm()));
        }
    }
}

TEST_CASE("joints in loaded nests and towers, cold and warm") {
    generator::Random random(29);
    std::vector<Problem> problems;
    for (const double mu : {0.0, 0.1, 0.35, 1.0}) {
        problems.push_back(withJoints(generator::nest({.shells = 5, .perPair = 25, .mu = mu}, random), 17));
        problems.push_back(withJoints(generator::nest({.shells = 6, .perPair = 12, .mu = mu, .side = 2}, random), 5));
        problems.push_back(withJoints(generator::tower(10, mu, 1.0, 1e-2, random), 3));
        problems.push_back(withJoints(
            generator::cloud({.bodies = 6, .contacts = 40, .mu = mu, .duplicates = 0.4, .self = 0.2}, random), 6));
        problems.push_back( // more than one subdomain
            withJoints(generator::nest({.shells = 14, .perPair = 20, .mu = mu, .side = 2}, random), 40));
    }
    for (std::size_t i = 0; i < problems.size(); ++i) {
        Problem& problem = problems[i];
        const BilateralSolution solution = solve(problem, {});
        const Residual independent = evaluateResidual(problem, solution.r);
        CAPTURE(i, solution.report.contactResidual, independent.contactResidual);
        CHECK(solution.report.converged);
        CHECK(std::abs(independent.contactResidual - solution.report.contactResidual) <=
              0.01 * independent.contactResidual + 1e-11);
        std::vector<Eigen::VectorXd> free;
        for (const Body& body : problem.bodies)
            free.push_back(body.vFree);
        CHECK(energy(problem, solution.v) <= energy(problem, free) * (1.0 + 1e-7)); // joints do no work
        for (std::size_t c = 0; c < problem.contacts.size(); ++c)
            if (problem.contacts[c].bilateral() && !problem.contacts[c].locked())
                CHECK(solution.r[2 * static_cast<Eigen::Index>(c) + 1] == 0.0);
        problem.r0 = solution.r;
        const BilateralSolution again = solve(problem, {});
        CHECK((again.report.converged && again.report.pivots == 0));
    }
}

TEST_CASE("a joint under tension is no open contact") {
    // A warm start of the wrong sign, zero or none: the status of a joint does not follow from its impulse.
    Problem problem;
    problem.dt = 1e-2;
    problem.bodies.push_back(rigid(1.0, 1.0, {0.0, -1.0, 0.0}));
    Contact hook = joint(0, -1, false);
    hook.Ha = pointRows(0.0, 0.0, {0.0, -1.0}); // hangs: r_n < 0
    problem.contacts = {hook};
    for (const double guess : {-2.0, 0.0, 3.0}) {
        problem.r0 = Eigen::Vector2d(guess, 0.7);
        for (const Method method : kMethods) {
            const BilateralSolution solution = solve(problem, {.method = method, .tolerance = 1e-12});
            CHECK(solution.report.converged);
            CHECK(solution.r[0] == Approx(-1.0).epsilon(1e-11));
            CHECK(solution.r[1] == 0.0);
            CHECK(solution.report.activeContacts == 1);
        }
    }
    CHECK(evaluateResidual(problem, Eigen::Vector2d(0.0, 0.0)).contactResidual ==
          Approx(1.0)); // free fall: the whole velocity is error
    CHECK(evaluateResidual(problem, Eigen::Vector2d(0.0, 0.0)).penetrationSpeed == 1.0);
    CHECK(evaluateResidual(problem, Eigen::Vector2d(-1.0, 0.5)).contactResidual >
          0.1); // a free tangent carries nothing
}

TEST_CASE("contradictory joints are reported") {
    Problem problem;
    problem.dt = 1e-3;
    problem.bodies.push_back(rigid(1.0, 1.0, {0.0, 0.0, 0.0}));
    for (const double speed : {1.0, -1.0}) {
        Contact pull = joint(0, -1, true);
        pull.Ha = pointRows(0.0, 0.0, {0.0, 1.0});
        pull.w = {speed, 0.0};
        problem.contacts.push_back(pull);
    }
    const BilateralSolution solution = solve(problem, {});
    CHECK_FALSE(solution.report.converged);
    CHECK(solution.r.allFinite());
    CHECK(solution.report.penetrationSpeed >= 1.0 - 1e-9); // the best compromise is half the speed
}

TEST_CASE("a bilateral contact is free or locked") {
    generator::Random random(31);
    Problem problem = withJoints(generator::cloud({.bodies = 4, .contacts = 6}, random), 2);
    CHECK(validate(problem).empty());
    problem.contacts[2].mu = 0.3;
    CHECK(validate(problem).find("contact 2") != std::string::npos);
    problem.contacts[2].mu = std::numeric_limits<double>::quiet_NaN();
    CHECK(validate(problem).find("contact 2") != std::string::npos);
    problem.contacts[2].mu = kInfinity;
    problem.contacts[1].mu = kInfinity; // a unilateral contact
    CHECK(validate(problem).find("contact 1") != std::string::npos);
}

TEST_CASE("dumps keep joints, and files without joints keep the first format") {
    generator::Random random(37);
    const Problem plain = generator::cloud({.bodies = 4, .contacts = 9}, random);
    Problem mixed = withJoints(plain, 4);
    mixed.r0 = Eigen::VectorXd::LinSpaced(18, -1.0, 1.0);
    std::string bytes, first;
    REQUIRE(encode(mixed, bytes).empty());
    REQUIRE(encode(plain, first).empty());
    CHECK(first[20] == 0); // the flag of the kinds
    CHECK(bytes[20] == 1);
    CHECK(bytes.size() == first.size() + 18 * 8 + 9 * 4);
    Problem back;
    REQUIRE(decode(bytes, back).empty());
    for (std::size_t c = 0; c < 9; ++c)
        CHECK((back.contacts[c].kind == mixed.contacts[c].kind && back.contacts[c].mu == mixed.contacts[c].mu));
    CHECK(back.r0 == mixed.r0);
    for (std::size_t length = 0; length < bytes.size(); ++length)
        REQUIRE(decode(std::string_view(bytes).substr(0, length), back).find("byte ") != std::string::npos);
    bytes[bytes.size() - 4] = 2;
    CHECK(decode(bytes, back).find("no kind of contact 2") != std::string::npos);
}
