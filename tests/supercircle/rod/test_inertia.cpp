#include "shapes.h"
#include "supercircle/support/dense.h"

#include <Eigen/Cholesky>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace supercircle::rod;
using namespace supercircle::rod::shapes;

namespace {

/// Composite Gauss-Legendre (8 points on each of 8 panels per segment) of lambda J^T J ds from pointRows. Order and
/// panels differ from the model's, so agreement also shows that the model's 5-point rule is exact to round-off.
Eigen::MatrixXd bruteForceMass(const RodModel& model, const Kinematics& kin) {
    static const double node[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
    static const double weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
    const int panels = 8;
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(model.dofs(), model.dofs());
    Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, model.dofs());
    for (int side = 0; side < 2; ++side)
        for (std::size_t k = 0; k < model.side(side).size(); ++k) {
            const double half = model.side(side)[k].signedLength / (2.0 * panels);
            for (int p = 0; p < panels; ++p)
                for (int i = 0; i < 8; ++i) {
                    const double u = (i % 2 == 0 ? 1.0 : -1.0) * node[i / 2];
                    const MaterialPoint point{side, static_cast<int>(k), half * (2.0 * p + 1.0 + u)};
                    kin.pointRows(model, point, Vec2::Zero(), Vec2(1, 0), Vec2(0, 1), rows);
                    M += model.definition().linearMass * std::abs(half) * weight[i / 2] * rows.transpose() * rows;
                }
        }
    return M;
}

Eigen::MatrixXd massOf(const RodModel& model, const Kinematics& kin) {
    GaussField field;
    evaluateGauss(model, kin, field);
    Eigen::MatrixXd M;
    massMatrix(model, kin, field, M);
    return M;
}

/// Largest entry of the difference, each entry relative to the diagonal scale sqrt(M_ii M_jj).
double scaledDifference(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
    double worst = 0.0;
    for (int i = 0; i < A.rows(); ++i)
        for (int j = 0; j < A.cols(); ++j)
            worst = std::max(worst, std::abs(A(i, j) - B(i, j)) / std::sqrt(B(i, i) * B(j, j)));
    return worst;
}

} // namespace

TEST_CASE("the mass matrix equals the brute-force integral of J^T J", "[inertia]") {
    for (const RodModel& model : models()) {
        const int n = model.elements();
        for (const Shape& shape : shapesOf(model)) {
            const Kinematics kin = at(model, shape.q);
            double turn = 0.0;
            for (int side = 0; side < 2; ++side)
                for (const Segment& seg : model.side(side))
                    turn = std::max(turn, std::abs(seg.signedLength * shape.q[seg.dof]));
            INFO("N = " << n << ", " << shape.name << ", turn per segment " << turn);
            // Remainder of the 5-point rule: the own diagonal entry, the integral of about s^4/4 (1 + ... turn^6),
            // loses 1.4e-10 turn^6 of itself. Below 0.4 rad a segment (a shell curled to 350 degrees) that is under
            // 1e-12.
            const double quadrature = turn < 0.4 ? 0.0 : 2e-10 * std::pow(turn, 6);
            CHECK(scaledDifference(massOf(model, kin), bruteForceMass(model, kin)) < 1e-12 + quadrature);
        }
    }
}

TEST_CASE("the mass matrix is symmetric and positive definite with the closed-form rigid block", "[inertia]") {
    for (const RodModel& model : models()) {
        const int n = model.elements();
        for (const Shape& shape : shapesOf(model)) {
            INFO("N = " << n << ", " << shape.name);
            const Eigen::MatrixXd M = massOf(model, at(model, shape.q));
            CHECK(M == M.transpose());
            CHECK(Eigen::LLT<Eigen::MatrixXd>(M).info() == Eigen::Success);
            CHECK(M(model.dofX(), model.dofX()) == Approx(model.mass()).epsilon(1e-14));
            CHECK(M(model.dofX(), model.dofY()) == 0.0);
        }
        // A straight rod about its middle: m L^2 / 12, and no coupling of theta with the translations.
        const Eigen::MatrixXd M = massOf(model, at(model, shapesOf(model)[0].q));
        const double length = model.definition().length;
        CHECK(M(model.dofTheta(), model.dofTheta()) == Approx(model.mass() * length * length / 12.0).epsilon(1e-14));
        CHECK(std::abs(M(model.dofTheta(), model.dofX())) < 1e-15);
    }
}

TEST_CASE("the halves do not couple through the curvatures, so the Cholesky factor has no fill", "[inertia]") {
    for (const int n : {15, 16}) {
        const RodModel model = rod(n);
        const Eigen::MatrixXd M = massOf(model, at(model, shapesOf(model)[3].q));
        const int half = n / 2;
        CHECK(M.block(half, 0, half, half).norm() == 0.0);
        const Eigen::MatrixXd L = Eigen::LLT<Eigen::MatrixXd>(M).matrixL();
        CHECK(L.block(half, 0, half, half).norm() == 0.0);
    }
}

TEST_CASE("the condition number leaves digits to spare", "[inertia]") {
    // Scaled by its diagonal, M is the Gram matrix of n velocity fields. Double integrals of neighbouring curvatures
    // differ ever less: the zigzag of curvatures moves the rod N^-2 times as far as a uniform one, its energy is N^-4.
    // A Cholesky solve loses log10 of a few N^4, five digits of sixteen at N = 15.
    for (const int n : {5, 15, 16, 31}) {
        const RodModel model = rod(n);
        for (const Shape& shape : shapesOf(model)) {
            const Eigen::MatrixXd M = massOf(model, at(model, shape.q));
            const Eigen::VectorXd d = M.diagonal().cwiseSqrt().cwiseInverse();
            const Eigen::VectorXd eigen = supercircle::dense::symmetricEigenvalues(d.asDiagonal() * M * d.asDiagonal());
            const double condition = eigen.maxCoeff() / eigen.minCoeff();
            INFO("N = " << n << ", " << shape.name << ", condition " << condition);
            CHECK(eigen.minCoeff() > 0.0);
            CHECK(condition < 5.0 * std::pow(n, 4));
        }
    }
}

TEST_CASE("velocity field, momentum and mass matrix are one quadrature", "[inertia]") {
    for (const RodModel& model : models()) {
        const int n = model.elements();
        const Eigen::VectorXd v = velocity(model);
        for (const Shape& shape : shapesOf(model)) {
            INFO("N = " << n << ", " << shape.name);
            const Kinematics kin = at(model, shape.q);
            GaussField field;
            evaluateGauss(model, kin, field);
            std::vector<Vec2> u;
            velocityField(model, kin, field, v, u);
            // u = J v, row by row
            Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, model.dofs());
            std::size_t g = 0;
            double worst = 0.0;
            for (int side = 0; side < 2; ++side)
                for (std::size_t k = 0; k < model.side(side).size(); ++k)
                    for (int i = 0; i < RodModel::kGauss; ++i, ++g) {
                        const double s = RodModel::kGaussNode[i] * model.side(side)[k].signedLength;
                        const MaterialPoint point{side, static_cast<int>(k), s};
                        kin.pointRows(model, point, Vec2::Zero(), Vec2(1, 0), Vec2(0, 1), rows);
                        worst = std::max(worst, (u[g] - rows * v).norm());
                        worst = std::max(worst, (kin.middle() + field.arm[g] - kin.point(point)).norm());
                    }
            CHECK(worst < 1e-14 * n + 1e-14);
            // p(J v) = M v, and v . M v / 2 = kinetic energy: same Gauss points, so round-off only.
            Eigen::VectorXd p;
            momentum(model, kin, field, u, p);
            Eigen::MatrixXd M;
            massMatrix(model, kin, field, M);
            const Eigen::VectorXd scale = M.diagonal().cwiseSqrt();
            const double size = scale.cwiseProduct(v).norm();
            CHECK((p - M * v).cwiseQuotient(scale).norm() < 1e-13 * size);
            CHECK(kineticEnergy(field, u) == Approx(0.5 * v.dot(M * v)).epsilon(1e-13));
            // Linear momentum and moment about the middle, summed point by point.
            Vec2 linear = Vec2::Zero();
            double moment = 0.0;
            for (std::size_t i = 0; i < u.size(); ++i) {
                linear += field.mass[i] * u[i];
                moment += field.mass[i] * cross(field.arm[i], u[i]);
            }
            CHECK(p[model.dofX()] == Approx(linear.x()).margin(1e-14));
            CHECK(p[model.dofY()] == Approx(linear.y()).margin(1e-14));
            CHECK(p[model.dofTheta()] == Approx(moment).margin(1e-14));
        }
    }
}

TEST_CASE("uniform force equals the momentum of a uniform field and minus the gradient of the height energy",
          "[inertia]") {
    const Vec2 a(1.7, -9.81);
    for (const RodModel& model : models()) {
        const int n = model.elements();
        for (const Shape& shape : shapesOf(model)) {
            INFO("N = " << n << ", " << shape.name);
            const auto evaluate = [&](const Eigen::VectorXd& q, GaussField& field) {
                const Kinematics kin = at(model, q);
                evaluateGauss(model, kin, field);
                return kin;
            };
            GaussField field;
            const Kinematics kin = evaluate(shape.q, field);
            Eigen::VectorXd force, p;
            uniformForce(model, kin, field, a, force);
            momentum(model, kin, field, std::vector<Vec2>(field.arm.size(), a), p);
            // The outer parts use closed-form centroids, the momentum Gauss points: apart by the rule's own error.
            const double rule = n < 15 ? 1e-4 : 1e-13;
            CHECK((force - p).norm() < rule * p.norm());
            // -dE/dq with E = -mass a . r_G
            for (int j = 0; j < model.dofs(); ++j) {
                const double h = 1e-5;
                GaussField fp, fm;
                const Eigen::VectorXd d = h * Eigen::VectorXd::Unit(model.dofs(), j);
                const Kinematics kp = evaluate(shape.q + d, fp);
                const Kinematics km = evaluate(shape.q - d, fm);
                const double slope = model.mass() * a.dot(massCentre(kp, fp) - massCentre(km, fm)) / (2.0 * h);
                CHECK(force[j] == Approx(slope).margin((n < 15 ? 1e-4 : 1e-9) * p.norm()));
            }
        }
    }
}

TEST_CASE("the mass centre of a uniform ring is its centre", "[inertia]") {
    const RodModel model = rod(15);
    const double k = 2.0 * M_PI / model.definition().length;
    Eigen::VectorXd q = Eigen::VectorXd::Constant(model.dofs(), k);
    q.tail(3) << 0.4, 0.2, 0.9;
    const Kinematics kin = at(model, q);
    GaussField field;
    evaluateGauss(model, kin, field);
    const Vec2 centre = Vec2(0.4, 0.2) + perp(Vec2(std::cos(0.9), std::sin(0.9))) / k;
    CHECK((massCentre(kin, field) - centre).norm() < 1e-14);
    CHECK((kin.node(0) - kin.node(15)).norm() < 1e-14); // and the ring closes
}

TEST_CASE("the inertial force is the derivative of the kinetic energy by the coordinates", "[inertia]") {
    for (const bool relative : {false, true}) // to the centre of mass
        for (const RodModel& model : models())
            for (const Shape& shape : shapesOf(model)) {
                INFO("N = " << model.elements() << ", " << shape.name << ", relative " << relative);
                const Eigen::VectorXd v = velocity(model);
                GaussField field;
                std::vector<Vec2> u;
                const auto evaluate = [&](const Eigen::VectorXd& q) {
                    const Kinematics kin = at(model, q);
                    evaluateGauss(model, kin, field);
                    velocityField(model, kin, field, v, u);
                    Vec2 mean = Vec2::Zero();
                    for (std::size_t g = 0; g < u.size(); ++g)
                        mean += field.mass[g] / model.mass() * u[g];
                    for (Vec2& x : u)
                        x -= relative ? mean : Vec2(Vec2::Zero());
                    return kineticEnergy(field, u);
                };
                const double scale = evaluate(shape.q);
                Eigen::VectorXd force;
                inertialForce(model, at(model, shape.q), field, v, u, force);
                for (int i = 0; i < model.dofs(); ++i) {
                    // Central differences of fourth order: the truncation and the round-off are both near 1e-10.
                    const double step = 2e-3;
                    const auto energy = [&](double factor) {
                        Eigen::VectorXd q = shape.q;
                        q[i] += factor * step;
                        return evaluate(q);
                    };
                    const double difference =
                        (8.0 * (energy(1.0) - energy(-1.0)) - (energy(2.0) - energy(-2.0))) / (12.0 * step);
                    CHECK(std::abs(force[i] - difference) < 1e-8 * (scale + std::abs(difference)));
                }
            }
}
