#include "shapes.h"
#include "supercircle/rod/equilibrium.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace supercircle::rod;
using namespace supercircle::rod::shapes;

namespace {

constexpr double kLength = 1.3, kModulus = 0.4; // of shapes::rod

/// Start with the first tip at the origin, pointing along +x.
Eigen::VectorXd straightFromOrigin(const RodModel& model) {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(model.dofs());
    q[model.dofX()] = 0.5 * kLength;
    return q;
}

Vec2 pointOf(const RodModel& model, const Eigen::VectorXd& q, double s) {
    return at(model, q).point(locate(model, s));
}

} // namespace

TEST_CASE("a cantilever with a small tip load bends by P L^3 / 3 B", "[equilibrium]") {
    for (const int n : kElementCounts) {
        const RodModel model = rod(n, 0.0);
        EquilibriumProblem problem;
        problem.supports = {clamp(0.0, Vec2::Zero(), 0.0)};
        const double P = 1e-5 * kModulus / (kLength * kLength);
        problem.pointLoads = {{kLength, Vec2(0.0, P)}};
        const Equilibrium e = solveEquilibrium(model, problem, straightFromOrigin(model), {1e-14});
        INFO("N = " << n << ": " << e.failure);
        REQUIRE(e.converged());
        // Elements at the ends have one neighbour: 5 / (48 N^3) softer for long rods, twice as much for two elements.
        const double exact = P * std::pow(kLength, 3) / (3.0 * kModulus);
        const double error = pointOf(model, e.q, kLength).y() / exact - 1.0;
        CHECK(std::abs(error) < 0.3 / (n * n * n) + 1e-7); // geometric nonlinearity 1e-10, tolerance
        CHECK(e.reactions[0].force.y() == Approx(-P).epsilon(1e-8));
        CHECK(e.reactions[0].moment == Approx(-P * kLength).epsilon(1e-8));
        CHECK(e.smallestStiffness > 0.0);
    }
}

TEST_CASE("reactions balance the loads, forces and moments", "[equilibrium]") {
    const RodModel model = rod(15, 1.1);
    const Vec2 g(0.4, -6.0), load(0.3, -1.1);
    EquilibriumProblem problem;
    problem.gravity = g;
    const Eigen::VectorXd start = naturalShape(model, Vec2(0.2, 0.1), 0.3);
    const Vec2 a = pointOf(model, start, 0.1), b = pointOf(model, start, 1.2);
    problem.supports = {pin(0.1, a + Vec2(0.05, 0.02)), clamp(1.2, b, at(model, start).angle(locate(model, 1.2)))};
    problem.supports[0].section = Vec2(0.0, 0.03);
    problem.pointLoads = {{0.7, load, Vec2(0.01, -0.05)}};
    const Equilibrium e = solveEquilibrium(model, problem, start);
    INFO(e.failure);
    REQUIRE(e.converged());
    const Kinematics kin = at(model, e.q);
    GaussField field;
    evaluateGauss(model, kin, field);
    const auto material = [&](double s, const Vec2& section) {
        const double angle = kin.angle(locate(model, s));
        const Vec2 t(std::cos(angle), std::sin(angle));
        return Vec2(kin.point(locate(model, s)) + section.x() * t + section.y() * perp(t));
    };
    CHECK((material(0.1, Vec2(0.0, 0.03)) - a - Vec2(0.05, 0.02)).norm() < 1e-10); // at the prescribed position
    Vec2 force = model.mass() * g + load;
    double moment = model.mass() * cross(massCentre(kin, field), g) + cross(material(0.7, Vec2(0.01, -0.05)), load);
    force += e.reactions[0].force + e.reactions[1].force;
    moment += cross(material(0.1, Vec2(0.0, 0.03)), e.reactions[0].force) +
              cross(material(1.2, Vec2::Zero()), e.reactions[1].force) + e.reactions[1].moment;
    CHECK(e.reactions[0].moment == 0.0);
    CHECK(force.norm() < 1e-9); // tolerance 1e-10 B/L^2
    CHECK(std::abs(moment) < 1e-9);
}

TEST_CASE("a column is stable below Euler's load and unstable above", "[equilibrium]") {
    const RodModel model = rod(16, 0.0);
    const double critical = M_PI * M_PI * kModulus / (4.0 * kLength * kLength);
    for (const double share : {0.98, 1.02}) { // the 16 elements raise it by (pi/2)^2/(12 16^2) = 0.08 %
        EquilibriumProblem problem;
        problem.supports = {clamp(0.0, Vec2::Zero(), 0.0)};
        problem.pointLoads = {{kLength, Vec2(-share * critical, 0.0)}};
        const Equilibrium e = solveEquilibrium(model, problem, straightFromOrigin(model));
        REQUIRE(e.converged());
        CHECK(pointOf(model, e.q, kLength).y() == Approx(0.0).margin(1e-12)); // Newton stays on the straight branch
        CHECK((e.smallestStiffness > 0.0) == (share < 1.0));
    }
}

TEST_CASE("an open arc is welded into a ring, a straight one too, through large turns", "[equilibrium]") {
    for (const double natural : {4.0, 0.0}) {
        RodDefinition d = rod(16, natural).definition();
        d.closed = true;
        const RodModel model(d);
        const Equilibrium e = solveEquilibrium(
            model,
            [] {
                EquilibriumProblem p;
                p.supports = {clamp(0.5 * kLength, Vec2::Zero(), 0.0)};
                return p;
            }(),
            naturalShape(model));
        INFO("natural curvature " << natural << ": " << e.failure);
        REQUIRE(e.converged());
        // Closed form: a uniform natural curvature closes into a circle under a pure moment B (2 pi/L - kappa0).
        const double k = 2.0 * M_PI / kLength;
        for (int i = 0; i < 16; ++i)
            CHECK(e.q[i] == Approx(k).epsilon(1e-9));
        CHECK(e.closureReaction.force.norm() < 1e-9);
        CHECK(e.closureReaction.moment == Approx(kModulus * (k - natural)).epsilon(1e-9));
        CHECK((pointOf(model, e.q, 0.0) - pointOf(model, e.q, kLength)).norm() < 1e-10);
    }
}

TEST_CASE("Newton converges quadratically, so its stiffness is the exact derivative", "[equilibrium]") {
    // Stressed joint, tilted supports, offset force and gravity at once: every term of the stiffness takes part. From
    // an error of 1e-3 the residuals go 1e-6, 1e-12; a wrong term would make it linear and take a dozen iterations.
    RodDefinition d = rod(16, 2.0).definition();
    d.closed = true;
    const RodModel model(d);
    EquilibriumProblem problem;
    problem.supports = {clamp(0.9, Vec2(0.1, 0.2), 0.4)};
    problem.gravity = Vec2(1.0, -4.0);
    problem.pointLoads = {{0.2, Vec2(2.0, -6.0), Vec2(0.03, 0.05)}, {1.2, Vec2(-5.0, 3.0), Vec2(0.0, 0.02)}};
    const Equilibrium far = solveEquilibrium(model, problem, naturalShape(model));
    INFO(far.failure);
    REQUIRE(far.converged());
    CHECK(far.closureReaction.force.norm() > 1.0); // otherwise the joint's own stiffness is not tested
    problem.pointLoads[0].force *= 1.001;
    const Equilibrium near = solveEquilibrium(model, problem, far.q);
    REQUIRE(near.converged());
    CHECK(near.loadSteps == 1);
    CHECK(near.iterations <= 4);
}

TEST_CASE("a load ramp reaches heavy loads far from the start", "[equilibrium]") {
    const RodModel model = rod(31, 0.0);
    EquilibriumProblem problem;
    problem.supports = {clamp(0.0, Vec2::Zero(), 0.5 * M_PI)}; // and the clamp rotates by a quarter turn meanwhile
    problem.gravity = Vec2(0.0, -500.0 * kModulus / (0.7 * std::pow(kLength, 3)));
    const Equilibrium e = solveEquilibrium(model, problem, straightFromOrigin(model));
    INFO(e.failure);
    REQUIRE(e.converged());
    CHECK(e.residual < 1e-10);
    CHECK(e.loadFraction == 1.0);
    CHECK(e.smallestStiffness > 0.0);
    CHECK(pointOf(model, e.q, kLength).y() < -0.8 * kLength); // hangs over the side
}

TEST_CASE("a consistent redundant support is harmless", "[equilibrium]") {
    const RodModel model = rod(15, 0.0);
    EquilibriumProblem problem;
    problem.gravity = Vec2(0.0, -3.0);
    problem.supports = {clamp(0.0, Vec2::Zero(), 0.0)};
    const Equilibrium once = solveEquilibrium(model, problem, straightFromOrigin(model));
    problem.supports.push_back(pin(0.0, Vec2::Zero()));
    const Equilibrium twice = solveEquilibrium(model, problem, straightFromOrigin(model));
    REQUIRE(once.converged());
    REQUIRE(twice.converged());
    CHECK((once.q - twice.q).norm() < 1e-8);
    CHECK((once.reactions[0].force - twice.reactions[0].force - twice.reactions[1].force).norm() < 1e-8);
}

TEST_CASE("a problem without equilibrium fails with a reason", "[equilibrium]") {
    const RodModel model = rod(15, 0.0);
    const Eigen::VectorXd start = straightFromOrigin(model);
    SECTION("a free rod falls") {
        EquilibriumProblem problem;
        problem.gravity = Vec2(0.0, -9.81);
        const Equilibrium e = solveEquilibrium(model, problem, start);
        CHECK_THAT(e.failure, Catch::Contains("free to move"));
        CHECK(e.q.allFinite());
        CHECK(e.loadFraction < 1.0);
    }
    SECTION("contradicting supports") {
        EquilibriumProblem problem;
        problem.supports = {clamp(0.0, Vec2::Zero(), 0.0), pin(0.0, Vec2(0.1, 0.0))};
        CHECK_THAT(solveEquilibrium(model, problem, start).failure, Catch::Contains("contradict"));
    }
    SECTION("ends farther apart than the rod is long") {
        EquilibriumProblem problem;
        problem.supports = {pin(0.0, Vec2::Zero()), pin(kLength, Vec2(1.1 * kLength, 0.0))};
        CHECK_FALSE(solveEquilibrium(model, problem, start).converged());
    }
    SECTION("bad input") {
        EquilibriumProblem problem;
        CHECK_THAT(solveEquilibrium(model, problem, Eigen::VectorXd::Zero(3)).failure, Catch::Contains("entries"));
        Eigen::VectorXd bad = start;
        bad[2] = std::numeric_limits<double>::quiet_NaN();
        CHECK_THAT(solveEquilibrium(model, problem, bad).failure, Catch::Contains("finite"));
        problem.supports = {pin(2.0 * kLength, Vec2::Zero())};
        CHECK_THAT(solveEquilibrium(model, problem, start).failure, Catch::Contains("not on the rod"));
        problem.supports.clear();
        problem.pointLoads = {{0.1, Vec2(std::numeric_limits<double>::infinity(), 0.0)}};
        CHECK_THAT(solveEquilibrium(model, problem, start).failure, Catch::Contains("point load"));
        problem.pointLoads.clear();
        problem.gravity.x() = std::numeric_limits<double>::quiet_NaN();
        CHECK_THAT(solveEquilibrium(model, problem, start).failure, Catch::Contains("gravity"));
    }
}

TEST_CASE("the same problem gives bitwise identical results", "[equilibrium]") {
    const RodModel model = rod(15, 0.8);
    EquilibriumProblem problem;
    problem.gravity = Vec2(0.0, -9.0);
    problem.supports = {clamp(0.0, Vec2::Zero(), 0.0)};
    const Equilibrium first = solveEquilibrium(model, problem, straightFromOrigin(model));
    const Equilibrium second = solveEquilibrium(model, problem, straightFromOrigin(model));
    CHECK(first.q == second.q);
    CHECK(first.reactions[0].moment == second.reactions[0].moment);
}
