// Elements of unequal length: layout, limits, and what they do to solved problems. The kinematics, inertia and
// stiffness of graded rods are tested along with those of equal arcs (shapes.h, models()).

#include "shapes.h"
#include "supercircle/rod/elasticity.h"
#include "supercircle/rod/equilibrium.h"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

using namespace supercircle::rod;
using namespace supercircle::rod::shapes;

namespace {

/// Load of a straight unit strip, both ends clamped, its middle pushed aside by a tenth of its half span; B = 1.
double clampedStrip(int elements, double tipRefinement) {
    RodDefinition d;
    d.length = 2.0;
    d.thickness = 1e-3;
    d.linearMass = d.bendingModulus = 1.0;
    d.naturalCurvature.assign(static_cast<std::size_t>(elements), 0.0);
    d.elementLength = gradedLengths(d.length, elements, tipRefinement);
    const RodModel model(d);
    EquilibriumProblem problem; // one end free to come closer: no stretching
    problem.supports = {clamp(0.0, {-1.0, 0.0}, 0.0),
                        {1.0, false, true, false, {0.0, 0.1}, 0.0},
                        {2.0, false, true, true, {0.0, 0.0}, 0.0}};
    const Equilibrium e = solveEquilibrium(model, problem, naturalShape(model));
    INFO(e.failure);
    REQUIRE(e.converged());
    return e.reactions[1].force.y();
}

} // namespace

TEST_CASE("graded lengths add up, mirror each other and run geometrically", "[grading]") {
    for (const int n : {1, 2, 3, 4, 15, 16, 31})
        for (const double refinement : {1.0, 3.0, 0.25}) {
            INFO("N = " << n << ", refinement " << refinement);
            const std::vector<double> l = gradedLengths(1.3, n, refinement);
            REQUIRE(static_cast<int>(l.size()) == n);
            CHECK(std::accumulate(l.begin(), l.end(), 0.0) == Approx(1.3).epsilon(1e-14));
            for (std::size_t i = 0; i < l.size(); ++i)
                CHECK(l[i] == Approx(l[l.size() - 1 - i]).epsilon(1e-15));
            if (n > 2)
                CHECK(l[static_cast<std::size_t>(n / 2)] / l[0] == Approx(refinement).epsilon(1e-14));
            for (std::size_t i = 1; i + 1 < (l.size() + 1) / 2; ++i)
                CHECK(l[i + 1] / l[i] == Approx(l[i] / l[i - 1]).epsilon(1e-13));
        }
}

TEST_CASE("equal lengths that are spelled out are the same rod", "[grading]") {
    for (const int n : {1, 2, 15, 16}) {
        const RodModel implied = rod(n);
        RodDefinition d = implied.definition();
        d.elementLength = gradedLengths(d.length, n, 1.0);
        CHECK(validate(d).empty());
        const RodModel spelled(d);
        for (int i = 0; i < n; ++i)
            CHECK(spelled.elementLength(i) == Approx(implied.elementLength(i)).epsilon(1e-14));
        for (int i = 0; i <= n; ++i)
            CHECK(spelled.nodeS(i) == Approx(implied.nodeS(i)).margin(1e-14));
    }
}

TEST_CASE("nodes of a graded rod mirror each other, and every element is found", "[grading]") {
    for (const RodModel& model : models()) {
        const int n = model.elements();
        INFO("N = " << n);
        CHECK(model.nodeS(0) == 0.0);
        double longest = 0.0;
        for (int i = 0; i < n; ++i) {
            longest = std::max(longest, model.elementLength(i));
            CHECK(model.nodeS(i + 1) - model.nodeS(i) == Approx(model.elementLength(i)).epsilon(1e-13));
            CHECK(model.nodeS(i) + model.nodeS(n - i) == Approx(1.3).epsilon(1e-15));
            CHECK(model.elementAt(model.nodeS(i) + 0.5 * model.elementLength(i)) == i);
            CHECK(model.elementOfDof(model.dofOfElement(i)) == i);
        }
        CHECK(model.longestElement() == longest);
        CHECK(model.elementAt(-1.0) == 0);
        CHECK(model.elementAt(1.3) == n - 1);
        CHECK(model.elementAt(2.0) == n - 1);
    }
}

TEST_CASE("invalid element lengths are refused with the reason", "[grading]") {
    const auto message = [](std::vector<double> lengths) {
        RodDefinition d;
        d.length = 1.0;
        d.naturalCurvature.assign(3, 0.0);
        d.elementLength = std::move(lengths);
        return validate(d);
    };
    CHECK(message({}).empty());
    CHECK(message({0.25, 0.5, 0.25}).empty());
    CHECK_THAT(message({0.5, 0.5}), Catch::Contains("one value per element"));
    CHECK_THAT(message({0.2, 0.5, 0.3}), Catch::Contains("mirrored"));
    CHECK_THAT(message({0.3, 0.5, 0.3}), Catch::Contains("add up"));
    CHECK_THAT(message({0.0, 1.0, 0.0}), Catch::Contains("millionth"));
    CHECK_THAT(message({NAN, 0.5, NAN}), Catch::Contains("finite"));
    CHECK_THAT(message({-0.25, 1.5, -0.25}), Catch::Contains("millionth"));
}

TEST_CASE("short elements where the moment runs steeply, and third order for any grading", "[grading]") {
    // Elastica of the strip: no closed form, but third order lets two fine meshes give the limit to 1e-8.
    const double limit = (8.0 * clampedStrip(256, 1.0) - clampedStrip(128, 1.0)) / 7.0;
    for (const double refinement : {1.0, 3.0, 0.4}) {
        const double coarse = clampedStrip(16, refinement) / limit - 1.0;
        const double fine = clampedStrip(32, refinement) / limit - 1.0;
        INFO("refinement " << refinement << ": " << coarse << ", " << fine);
        CHECK(std::abs(coarse) < 5e-3);
        CHECK(coarse / fine == Approx(8.0).epsilon(0.1));
    }
    // The moment is piecewise linear with the same slope everywhere: equal arcs are optimal.
    for (const double refinement : {3.0, 0.4})
        CHECK(std::abs(clampedStrip(16, 1.0) - limit) < std::abs(clampedStrip(16, refinement) - limit));
}

TEST_CASE("bending is stable for any lengths of elements", "[grading]") {
    // Each element keeps a third of its own stiffness at least, also beside one that is a thousand times as long.
    for (const double ratio : {1.0, 1.5, 10.0, 1000.0})
        for (const bool closed : {false, true})
            for (const int n : {3, 4, 9}) {
                RodDefinition d;
                d.length = 1.0;
                d.closed = closed;
                d.naturalCurvature.assign(static_cast<std::size_t>(n), closed ? 2.0 * M_PI : 0.0);
                double sum = 0.0;
                for (int i = 0; i < n; ++i) {
                    d.elementLength.push_back(std::min(i, n - 1 - i) % 2 == 0 ? ratio : 1.0); // mirrored
                    sum += d.elementLength.back();
                }
                for (double& l : d.elementLength)
                    l /= sum;
                INFO(n << " elements, ratio " << ratio << ", closed " << closed);
                REQUIRE(validate(d).empty());
                const RodModel model(d);
                Eigen::MatrixXd K = Eigen::MatrixXd::Zero(model.dofs(), model.dofs());
                addBendingStiffness(model, 1.0, K);
                Eigen::VectorXd own(n);
                for (int i = 0; i < n; ++i)
                    own[i] = bendingStiffness(model, model.elementOfDof(i));
                const Eigen::MatrixXd scaled = own.cwiseSqrt().cwiseInverse().asDiagonal() * K.topLeftCorner(n, n) *
                                               own.cwiseSqrt().cwiseInverse().asDiagonal();
                CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues().minCoeff() >
                      1.0 / 3.0 - 1e-12);
            }
}

TEST_CASE("a node lies where a rod is supported", "[grading]") {
    CHECK(elementsMeetingAt(0.5, 31) == 32);
    CHECK(elementsMeetingAt(0.5, 32) == 32);
    CHECK(elementsMeetingAt(0.0, 31) == 31); // an end is always a node
    CHECK(elementsMeetingAt(1.0, 15) == 15);
    CHECK(elementsMeetingAt(0.25, 15) == 16);
    CHECK(elementsMeetingAt(0.3, 31) == 33); // 9.9 of 33: three thousandths of the length off

    // Clamped in its middle and curved differently on its two sides, the rod has exactly the tips of two arcs.
    const double left = 10.0, right = 25.0, half = 0.045;
    for (const int n : {15, 16}) {
        RodDefinition d;
        d.length = 2.0 * half;
        const int used = elementsMeetingAt(0.5, n);
        for (int i = 0; i < used; ++i)
            d.naturalCurvature.push_back(2 * i < used ? left : right);
        const RodModel model(d);
        EquilibriumProblem problem;
        problem.supports = {clamp(half, {0.0, 0.0}, 0.0)};
        const Equilibrium e = solveEquilibrium(model, problem, naturalShape(model));
        REQUIRE(e.converged());
        Kinematics k;
        k.evaluate(model, e.q);
        const Vec2 first = k.point(locate(model, 0.0)), last = k.point(locate(model, d.length));
        CHECK(std::abs(last.x() - std::sin(right * half) / right) < 1e-12);
        CHECK(std::abs(last.y() - (1.0 - std::cos(right * half)) / right) < 1e-12);
        CHECK(std::abs(first.x() + std::sin(left * half) / left) < 1e-12);
        CHECK(std::abs(first.y() - (1.0 - std::cos(left * half)) / left) < 1e-12);
    }
}
