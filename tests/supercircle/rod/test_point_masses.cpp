// Point masses on a rod against J^T J at their places, and the frequency of a cantilever with a tip mass.

#include "shapes.h"
#include "supercircle/rod/geometric_stiffness.h"
#include "supercircle/rod/modes.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::rod;
using namespace supercircle::rod::shapes;

namespace {

RodModel carrying(int elements, const std::vector<PointMass>& masses, double curvature = 0.6) {
    RodDefinition d = rod(elements, curvature).definition();
    d.pointMasses = masses;
    REQUIRE(validate(d).empty());
    return RodModel(d);
}

Eigen::MatrixXd massMatrixOf(const RodModel& model, const Eigen::VectorXd& q) {
    const Kinematics kin = at(model, q);
    GaussField field;
    evaluateGauss(model, kin, field);
    Eigen::MatrixXd M;
    massMatrix(model, kin, field, M);
    return M;
}

/// Positive root of the characteristic equation of a cantilever with a mass and an inertia at its end, times L; ratios
/// of them to lambda L and lambda L^3 (Blevins, Formulas for Natural Frequency and Mode Shape, 1979, table 8-8).
double rootOf(double mass, double inertia) {
    const auto f = [&](double x) {
        const double c = std::cos(x), s = std::sin(x), C = std::cosh(x), S = std::sinh(x);
        return 1.0 + c * C + mass * x * (c * S - s * C) - inertia * x * x * x * (c * S + s * C) +
               mass * inertia * x * x * x * x * (1.0 - c * C);
    };
    double low = 1e-3, high = low;
    while (f(low) * f(high) > 0.0)
        high += 1e-3;
    for (int i = 0; i < 60; ++i)
        (f(low) * f(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
}

} // namespace

TEST_CASE("a point mass adds m J^T J of its place and its inertia a^T a of the angle there", "[inertia]") {
    const double m = 2.3; // two and a half times the rod
    for (const int n : {3, 8, 15, 16})
        for (const double fraction : {0.0, 0.13, 0.5, 0.77, 1.0})
            for (const double inertia : {0.0, 0.4}) { // a radius of gyration of a third of the rod
                const RodModel bare = rod(n), model = carrying(n, {{fraction * 1.3, m, inertia}});
                CHECK(model.mass() == Approx(bare.mass() + m).epsilon(1e-15));
                for (const Shape& shape : shapesOf(model)) {
                    INFO("N = " << n << ", at " << fraction << ", " << inertia << ", " << shape.name);
                    const Kinematics kin = at(model, shape.q);
                    const MaterialPoint place = locate(model, fraction * 1.3);
                    Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, model.dofs());
                    kin.pointRows(model, place, Vec2::Zero(), Vec2(1, 0), Vec2(0, 1), rows);
                    Eigen::RowVectorXd angle = Eigen::RowVectorXd::Zero(model.dofs());
                    angle[model.dofTheta()] = 1.0;
                    for (int k = 0; k <= place.segment; ++k) {
                        const Segment& s = model.side(place.side)[static_cast<std::size_t>(k)];
                        angle[s.dof] += k < place.segment ? s.signedLength : place.local;
                    }
                    const Eigen::MatrixXd added = massMatrixOf(model, shape.q) - massMatrixOf(bare, shape.q);
                    const Eigen::MatrixXd wanted = m * rows.transpose() * rows + inertia * angle.transpose() * angle;
                    CHECK((added - wanted).cwiseAbs().maxCoeff() < 1e-12 * wanted.cwiseAbs().maxCoeff());
                }
            }
}

TEST_CASE("forces of a rod with point masses are derivatives of its energies", "[inertia]") {
    const Vec2 a(1.7, -9.81);
    for (const int n : {8, 15}) {
        const RodModel model = carrying(n, {{0.4, 0.8, 1e-3}, {1.3, 2.3, 0.0}});
        const Eigen::VectorXd v = velocity(model);
        for (const Shape& shape : shapesOf(model)) {
            INFO("N = " << n << ", " << shape.name);
            const Kinematics kin = at(model, shape.q);
            GaussField field;
            evaluateGauss(model, kin, field);
            std::vector<Vec2> u;
            velocityField(model, kin, field, v, u);
            Eigen::VectorXd inertial, weight;
            inertialForce(model, kin, field, v, u, inertial);
            uniformForce(model, kin, field, a, weight);
            Eigen::MatrixXd K = Eigen::MatrixXd::Zero(model.dofs(), model.dofs());
            addUniformStiffness(model, kin, field, a, K);
            CHECK(kineticEnergy(field, u) ==
                  Approx(0.5 * v.dot(massMatrixOf(model, shape.q) * v)).epsilon(1e-12)); // one quadrature
            for (int i = 0; i < model.dofs(); ++i) {
                // Central differences of fourth order, near 1e-9 of the largest terms.
                const double h = 2e-3;
                const auto differenced = [&](const auto& of) {
                    const auto moved = [&](double factor) {
                        Eigen::VectorXd q = shape.q;
                        q[i] += factor * h;
                        return of(q);
                    };
                    return (8.0 * (moved(1.0) - moved(-1.0)) - (moved(2.0) - moved(-2.0))) / (12.0 * h);
                };
                const double kinetic =
                    differenced([&](const Eigen::VectorXd& q) { return 0.5 * v.dot(massMatrixOf(model, q) * v); });
                CHECK(inertial[i] == Approx(kinetic).epsilon(1e-7).margin(1e-7 * kineticEnergy(field, u)));
                const double height = differenced([&](const Eigen::VectorXd& q) {
                    const Kinematics k = at(model, q);
                    GaussField f;
                    evaluateGauss(model, k, f);
                    return model.mass() * a.dot(massCentre(k, f));
                });
                CHECK(weight[i] == Approx(height).margin(1e-5 * weight.norm())); // centroids and Gauss points
                for (int j = 0; j < model.dofs(); ++j) {
                    const double slope = differenced([&](const Eigen::VectorXd& q) {
                        const Kinematics k = at(model, q);
                        GaussField f;
                        evaluateGauss(model, k, f);
                        Eigen::VectorXd force;
                        uniformForce(model, k, f, a, force);
                        return force[j];
                    });
                    CHECK(K(i, j) == Approx(-slope).margin(1e-7 * weight.norm()));
                }
            }
        }
    }
}

TEST_CASE("a cantilever with a tip mass has the frequency of the closed form", "[inertia]") {
    const RodDefinition d = rod(24, 0.0).definition();
    const double line = d.linearMass, L = d.length;
    for (const double ratio : {0.0, 0.1, 1.0, 20.0})
        for (const double gyration : {0.0, 0.03}) { // over the length
            CAPTURE(ratio, gyration);
            const double m = ratio * line * L, J = m * gyration * gyration * L * L;
            const RodModel model = carrying(24, {{L, m, J}}, 0.0);
            const Eigen::VectorXd q = Eigen::VectorXd::Zero(model.dofs());
            const Kinematics kin = at(model, q);
            Eigen::MatrixXd held(3, model.dofs());
            Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, model.dofs());
            kin.pointRows(model, locate(model, 0.0), Vec2::Zero(), Vec2(1, 0), Vec2(0, 1), rows);
            held.topRows(2) = rows;
            // The section's angle: of the middle, less what the elements in between turn.
            held.row(2).setZero();
            held(2, model.dofTheta()) = 1.0;
            for (const Segment& s : model.side(1))
                held(2, s.dof) = s.signedLength;
            const double w = circularFrequencies(model, q, held)[0];
            const double x = rootOf(ratio, ratio * gyration * gyration);
            // 24 arcs: the frequency of 12 arcs errs by 1e-4, with the square of the number.
            CHECK(w == Approx(x * x / (L * L) * std::sqrt(d.bendingModulus / line)).epsilon(1e-4));
        }
}

TEST_CASE("point masses that cannot be are refused", "[model]") {
    RodDefinition d = rod(10).definition();
    const auto why = [&](const PointMass& p) {
        d.pointMasses = {p};
        return validate(d);
    };
    CHECK(why({0.5, 0.1, 1e-4}).empty());
    CHECK_FALSE(why({-0.1, 0.1, 0.0}).empty());
    CHECK_FALSE(why({1.31, 0.1, 0.0}).empty());
    CHECK_FALSE(why({0.5, -0.1, 0.0}).empty());
    CHECK_FALSE(why({0.5, std::nan(""), 0.0}).empty());
    CHECK(why({0.5, 0.1, 0.2}).find("length of the rod") != std::string::npos);
}
