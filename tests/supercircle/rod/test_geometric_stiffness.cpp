#include "shapes.h"
#include "supercircle/rod/geometric_stiffness.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::rod;
using namespace supercircle::rod::shapes;

namespace {

Eigen::VectorXd pointForce(const RodModel& model, const Kinematics& kin, const MaterialPoint& point,
                           const Vec2& section, const Vec2& f, Vec2* offset = nullptr) {
    const double a = kin.angle(point);
    const Vec2 t(std::cos(a), std::sin(a));
    const Vec2 o = section.x() * t + section.y() * perp(t);
    if (offset)
        *offset = o;
    Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, model.dofs());
    kin.pointRows(model, point, o, f, Vec2::Zero(), rows);
    return rows.row(0).transpose();
}

/// -d force / dq by central differences.
template <class Force>
Eigen::MatrixXd differenced(const RodModel& model, const Eigen::VectorXd& q, Force force) {
    const double h = 2e-5;
    Eigen::MatrixXd K(model.dofs(), model.dofs());
    for (int j = 0; j < model.dofs(); ++j) {
        const Eigen::VectorXd d = h * Eigen::VectorXd::Unit(model.dofs(), j);
        K.col(j) = (force(at(model, q - d)) - force(at(model, q + d))) / (2.0 * h);
    }
    return K;
}

} // namespace

TEST_CASE("the chord's second derivative equals differences and its limits", "[stiffness]") {
    for (const double k : {0.0, 1e-200, 1e-9, -1e-6, 1e-3, 0.5, -3.0, 7.0, 20.0})
        for (const double s : {0.4, -0.7, 1.0}) {
            INFO("k = " << k << ", s = " << s);
            const double h = 1e-5;
            const Arc plus{Vec2(0.1, 0.2), 0.7, k + h, 1.0};
            const Arc minus{Vec2(0.1, 0.2), 0.7, k - h, 1.0};
            const Vec2 slope = (plus.chordCurvatureDerivative(s) - minus.chordCurvatureDerivative(s)) / (2.0 * h);
            CHECK((chordSecondDerivative({Vec2(0.1, 0.2), 0.7, k, 1.0}, s) - slope).norm() < 1e-10);
        }
    // Straight: -int sigma^2 t d sigma = -s^3/3 t
    const Vec2 straight = chordSecondDerivative({Vec2::Zero(), 0.0, 0.0, 1.0}, 0.5);
    CHECK(straight.x() == Approx(-0.125 / 3.0).epsilon(1e-15));
    CHECK(straight.y() == 0.0);
    // First order in k: -k s^4/4 along the normal. Tiny curvature keeps all its digits.
    CHECK(chordSecondDerivative({Vec2::Zero(), 0.0, 1e-9, 1.0}, 1.0).y() == Approx(-0.25e-9).epsilon(1e-9));
}

TEST_CASE("stiffness of a dead point force equals differences of J^T f", "[stiffness]") {
    const Vec2 f(1.3, -0.7);
    for (const RodModel& model : models()) {
        const int n = model.elements();
        for (const Shape& shape : shapesOf(model))
            for (const Vec2& section : {Vec2(0.0, 0.0), Vec2(0.02, -0.05)}) {
                const Kinematics kin = at(model, shape.q);
                const auto points = materialPointsOf(model);
                for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 12) {
                    INFO("N = " << n << ", " << shape.name << ", point " << i);
                    Vec2 offset;
                    pointForce(model, kin, points[i], section, f, &offset);
                    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(model.dofs(), model.dofs());
                    addPointForceStiffness(model, kin, points[i], offset, f, K);
                    const Eigen::MatrixXd reference = differenced(model, shape.q, [&](const Kinematics& k) {
                        return pointForce(model, k, points[i], section, f);
                    });
                    CHECK((K - K.transpose()).norm() == 0.0);
                    CHECK((K - reference).cwiseAbs().maxCoeff() < 2e-9); // h^2/6 and 1e-15/h, see the kinematics test
                }
            }
    }
}

TEST_CASE("stiffness of a uniform acceleration equals differences of uniformForce", "[stiffness]") {
    const Vec2 a(1.7, -9.81);
    for (const RodModel& model : models()) {
        const int n = model.elements();
        for (const Shape& shape : shapesOf(model)) {
            INFO("N = " << n << ", " << shape.name);
            const Kinematics kin = at(model, shape.q);
            GaussField field;
            evaluateGauss(model, kin, field);
            Eigen::MatrixXd K = Eigen::MatrixXd::Zero(model.dofs(), model.dofs());
            addUniformStiffness(model, kin, field, a, K);
            const Eigen::MatrixXd reference = differenced(model, shape.q, [&](const Kinematics& k) {
                GaussField local;
                evaluateGauss(model, k, local);
                Eigen::VectorXd force;
                uniformForce(model, k, local, a, force);
                return force;
            });
            CHECK((K - K.transpose()).norm() == 0.0);
            // N = 1: the outer element's centroid and the Gauss points differ by the rule's error at 2.9 rad.
            CHECK((K - reference).cwiseAbs().maxCoeff() < (n < 3 ? 1e-4 : 1e-8));
        }
    }
}

TEST_CASE("the stiffness adds and scales with the force", "[stiffness]") {
    const RodModel model = rod(5);
    const Kinematics kin = at(model, shapesOf(model)[2].q);
    const MaterialPoint tip = locate(model, model.definition().length);
    Eigen::MatrixXd one = Eigen::MatrixXd::Zero(8, 8);
    addPointForceStiffness(model, kin, tip, Vec2(0.0, 0.01), Vec2(1.0, 2.0), one);
    Eigen::MatrixXd back = one;
    addPointForceStiffness(model, kin, tip, Vec2(0.0, 0.01), Vec2(-1.0, -2.0), back);
    CHECK(back.norm() < 1e-16);
    // A rigid turn by theta of the rod in a dead force: f . (p - r_m) is the pendulum's stiffness.
    CHECK(one(7, 7) == Approx(Vec2(1.0, 2.0).dot(kin.point(tip) + Vec2(0.0, 0.01) - kin.middle())));
}
