#include "shapes.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::rod;
using namespace supercircle::rod::shapes;

namespace {

/// The material point `offset` away from the centre line, the offset given in the section's own axes.
Vec2 offsetPoint(const Kinematics& kin, const MaterialPoint& point, const Vec2& section) {
    const double a = kin.angle(point);
    const Vec2 t(std::cos(a), std::sin(a));
    return kin.point(point) + section.x() * t + section.y() * perp(t);
}

Vec2 offsetOf(const Kinematics& kin, const MaterialPoint& point, const Vec2& section) {
    return offsetPoint(kin, point, section) - kin.point(point);
}

/// r(s) by integrating the tangent from the middle with the composite midpoint rule and Richardson extrapolation:
/// knows nothing of arcs.
Vec2 marched(const RodModel& model, const Eigen::VectorXd& q, double s) {
    const auto angleAt = [&](double sigma) {
        double angle = q[model.dofTheta()];
        const double from = std::min(sigma, model.midS());
        const double to = std::max(sigma, model.midS());
        for (int i = 0; i < model.elements(); ++i) {
            const double a = std::max(from, model.nodeS(i));
            const double b = std::min(to, model.nodeS(i + 1));
            if (b > a)
                angle += (sigma > model.midS() ? 1.0 : -1.0) * (b - a) * q[model.dofOfElement(i)];
        }
        return angle;
    };
    // Simpson on each element's part: panels never straddle a jump of the curvature.
    Vec2 r(q[model.dofX()], q[model.dofY()]);
    const double sign = s > model.midS() ? 1.0 : -1.0;
    const double from = std::min(s, model.midS());
    const double to = std::max(s, model.midS());
    for (int i = 0; i < model.elements(); ++i) {
        const double a = std::max(from, model.nodeS(i));
        const double b = std::min(to, model.nodeS(i + 1));
        if (b <= a)
            continue;
        const int panels = 200;
        const double h = (b - a) / panels;
        for (int p = 0; p < panels; ++p)
            for (int k = 0; k < 3; ++k) {
                const double w = (k == 1 ? 4.0 : 1.0) * h / 6.0;
                const double angle = angleAt(a + h * (p + 0.5 * k));
                r += sign * w * Vec2(std::cos(angle), std::sin(angle));
            }
    }
    return r;
}

} // namespace

TEST_CASE("the curve is the integral of its tangent", "[kinematics]") {
    for (const RodModel& model : models()) {
        const int n = model.elements();
        for (const Shape& shape : shapesOf(model)) {
            INFO("N = " << n << ", " << shape.name);
            const Kinematics kin = at(model, shape.q);
            for (const double t : {0.0, 0.13, 0.5, 0.71, 1.0}) {
                const double s = t * model.definition().length;
                // Simpson: h^4 k^4 / 2880 with k h < 7.2/200 at N = 1.
                CHECK((kin.point(locate(model, s)) - marched(model, shape.q, s)).norm() < 1e-9);
            }
        }
    }
}

TEST_CASE("the frame sits at mid-length, and nodes, arcs and segments agree", "[kinematics]") {
    for (const RodModel& model : models()) {
        const int n = model.elements();
        for (const Shape& shape : shapesOf(model)) {
            INFO("N = " << n << ", " << shape.name);
            const Kinematics kin = at(model, shape.q);
            const MaterialPoint mid = locate(model, model.midS());
            const Vec2 frame(shape.q[model.dofX()], shape.q[model.dofY()]);
            CHECK((kin.point(mid) - frame).norm() < 1e-15);
            CHECK(kin.angle(mid) == Approx(shape.q[model.dofTheta()]).epsilon(1e-15));
            const double round =
                1e-15 * (n + 5); // one unit in the last place per element passed, coordinates of order 1
            for (int i = 0; i < n; ++i) {
                const Arc& arc = kin.arcs()[static_cast<std::size_t>(i)];
                CHECK(arc.curvature == shape.q[model.dofOfElement(i)]);
                CHECK((arc.start - kin.node(i)).norm() <= round);
                CHECK((arc.pointAt(arc.length) - kin.node(i + 1)).norm() <= round);
                const Vec2 inside = kin.point(locate(model, i, model.nodeS(i) + 0.4 * model.elementLength(i)));
                CHECK((arc.pointAt(0.4 * arc.length) - inside).norm() <= round);
            }
            for (int side = 0; side < 2; ++side)
                for (std::size_t k = 0; k < model.side(side).size(); ++k) {
                    const Arc& arc = kin.segmentArc(side, static_cast<int>(k));
                    CHECK((kin.segmentTangent(side, static_cast<int>(k)) - arc.tangentAt(0.0)).norm() <= round);
                    CHECK((kin.centroid(side, static_cast<int>(k)) - arc.centroid(arc.length)).norm() <= round);
                }
        }
    }
}

TEST_CASE("locate finds the same material point from either side of a boundary", "[kinematics]") {
    for (const RodModel& model : models()) {
        const int n = model.elements();
        const Kinematics kin = at(model, shapesOf(model)[3].q);
        for (int i = 1; i < n; ++i) {
            const double s = model.nodeS(i);
            CHECK((kin.point(locate(model, i - 1, s)) - kin.point(locate(model, i, s))).norm() < 1e-14);
        }
        CHECK((kin.point(locate(model, 0.0)) - kin.node(0)).norm() < 1e-14);
        CHECK((kin.point(locate(model, model.definition().length)) - kin.node(n)).norm() < 1e-14);
    }
}

TEST_CASE("Jacobian rows equal central differences, with and without offset", "[kinematics]") {
    const Vec2 first(0.6, 0.8);
    const Vec2 second(-0.3, 0.9); // neither orthogonal nor unit: the rows must not assume it
    for (const RodModel& model : models()) {
        const int n = model.elements();
        for (const Shape& shape : shapesOf(model))
            for (const Vec2& section : {Vec2(0.0, 0.0), Vec2(0.02, -0.05)}) {
                INFO("N = " << n << ", " << shape.name << ", offset " << section.transpose());
                const Kinematics kin = at(model, shape.q);
                std::vector<Kinematics> plus, minus;
                const double h = 2e-5;
                for (int j = 0; j < model.dofs(); ++j) {
                    const Eigen::VectorXd d = h * Eigen::VectorXd::Unit(model.dofs(), j);
                    plus.push_back(at(model, shape.q + d));
                    minus.push_back(at(model, shape.q - d));
                }
                double worst = 0.0;
                double worstAngle = 0.0;
                Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, model.dofs());
                Eigen::RowVectorXd angleRow(model.dofs());
                for (const MaterialPoint& point : materialPointsOf(model)) {
                    kin.pointRows(model, point, offsetOf(kin, point, section), first, second, rows);
                    kin.angleRow(model, point, angleRow);
                    for (int j = 0; j < model.dofs(); ++j) {
                        const auto& p = plus[static_cast<std::size_t>(j)];
                        const auto& m = minus[static_cast<std::size_t>(j)];
                        const Vec2 dr = (offsetPoint(p, point, section) - offsetPoint(m, point, section)) / (2.0 * h);
                        worst = std::max(
                            {worst, std::abs(first.dot(dr) - rows(0, j)), std::abs(second.dot(dr) - rows(1, j))});
                        const double da = (p.angle(point) - m.angle(point)) / (2.0 * h);
                        worstAngle = std::max(worstAngle, std::abs(da - angleRow(j)));
                    }
                }
                // h^2/6 times a third derivative of order one, and 1e-15/h of cancellation: 1e-10 each.
                CHECK(worst < 5e-10);
                CHECK(worstAngle < 5e-10);
            }
    }
}

TEST_CASE("a point does not depend on the curvatures of the other side", "[kinematics]") {
    const RodModel model = rod(15);
    const Kinematics kin = at(model, shapesOf(model)[2].q);
    Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, model.dofs());
    kin.pointRows(model, locate(model, 14, 1.3), Vec2::Zero(), Vec2(1, 0), Vec2(0, 1), rows);
    for (int i = 0; i < 7; ++i)
        CHECK(rows.col(model.dofOfElement(i)).norm() == 0.0);
    CHECK((rows.array() != 0.0).colwise().any().count() == 11); // 7 + middle + x, y, theta
}
