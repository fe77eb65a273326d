#include "supercircle/rod/kinematics.h"

#include "supercircle/support/invariants.h"
#include "supercircle/support/trig.h"

namespace supercircle::rod {

MaterialPoint locate(const RodModel& model, int element, double s) {
    SC_ASSERT(element >= 0 && element < model.elements(), "an element of the rod");
    const int half = model.elements() / 2;
    const bool odd = model.elements() % 2 == 1;
    MaterialPoint at;
    if (odd && element == half) {
        at.side = s >= model.midS() ? 0 : 1;
        at.segment = 0;
    } else if (element >= half) {
        at.side = 0;
        at.segment = odd ? element - half : element - half;
    } else {
        at.side = 1;
        at.segment = odd ? half - element : half - 1 - element;
    }
    at.local = s - model.side(at.side)[static_cast<std::size_t>(at.segment)].innerS;
    return at;
}

MaterialPoint locate(const RodModel& model, double s) {
    return locate(model, model.elementAt(s), s);
}

void Kinematics::evaluate(const RodModel& model, const Eigen::VectorXd& q) {
    SC_ASSERT(q.size() == model.dofs(), "one coordinate for each degree of freedom");
    middle_ = {q[model.dofX()], q[model.dofY()]};
    const double theta = q[model.dofTheta()];
    // The tangent is rotated from element to element: one sine and cosine per rod instead of one per element. Its
    // round-off grows like that of the angle itself, by about one unit in the last place per element.
    const math::SinCos turned = math::sinCos(theta);
    const Vec2 middleTangent(turned.cosine, turned.sine);
    arcs_.resize(static_cast<std::size_t>(model.elements()));
    for (int side = 0; side < 2; ++side) {
        const auto& list = model.side(side);
        segments_[side].resize(list.size());
        centroids_[side].resize(list.size());
        tangents_[side].resize(list.size());
        Vec2 point = middle_;
        Vec2 tangent = middleTangent;
        double angle = theta;
        for (std::size_t k = 0; k < list.size(); ++k) {
            const Segment& seg = list[k];
            Arc& arc = segments_[side][k];
            arc = {point, angle, q[seg.dof], seg.signedLength};
            tangents_[side][k] = tangent;
            const double x = arc.curvature * seg.signedLength;
            const TurnFactors f = TurnFactors::of(x);
            const double sine = 1.0 - x * x * f.deficit; // over x
            const double rise = x * f.versine;           // (1 - cos x)/x
            const Vec2 normal = perp(tangent);
            centroids_[side][k] = point + seg.signedLength * (f.versine * tangent + x * f.deficit * normal);
            point += seg.signedLength * (sine * tangent + rise * normal);
            angle += x;
            tangent += x * (sine * normal - rise * tangent);
            Arc& full = arcs_[static_cast<std::size_t>(seg.element)];
            if (side == 1)
                full = {point, angle, arc.curvature, model.elementLength(seg.element)};
            else if (k > 0 || model.elements() % 2 == 0) // not the half of the middle element
                full = {arc.start, arc.angle, arc.curvature, model.elementLength(seg.element)};
        }
        if (side == 0)
            lastNode_ = point;
    }
}

Kinematics::PointWithDerivative Kinematics::pointOf(const MaterialPoint& at) const {
    const Arc& arc = segmentArc(at.side, at.segment);
    const Vec2& tangent = segmentTangent(at.side, at.segment);
    const Vec2 normal = perp(tangent);
    const double s = at.local;
    const double x = arc.curvature * s;
    const TurnFactors f = TurnFactors::of(x);
    const double sine = 1.0 - x * x * f.deficit; // over x
    return {arc.start + s * (sine * tangent + x * f.versine * normal),
            (s * s) * ((sine - f.versine) * normal - x * (f.versine - f.deficit) * tangent)};
}

void Kinematics::addPointRows(const RodModel& model, const MaterialPoint& at, const Vec2& offset, const Vec2& first,
                              const Vec2& second, Eigen::Ref<Eigen::Matrix<double, 2, Eigen::Dynamic>> rows) const {
    SC_ASSERT_EXPENSIVE(rows.cols() == model.dofs(), "one column for each degree of freedom");
    SC_ASSERT_EXPENSIVE(static_cast<std::size_t>(at.segment) < model.side(at.side).size(), "a segment of the rod");
    const auto& list = model.side(at.side);
    const PointWithDerivative own = pointOf(at);
    const Vec2 p = own.position + offset;
    const auto rotation = [&](int dof, double factor, const Vec2& pivot) {
        const Vec2 arm = perp(p - pivot) * factor;
        rows(0, dof) += first.dot(arm);
        rows(1, dof) += second.dot(arm);
    };
    rows(0, model.dofX()) += first.x();
    rows(1, model.dofX()) += second.x();
    rows(0, model.dofY()) += first.y();
    rows(1, model.dofY()) += second.y();
    rotation(model.dofTheta(), 1.0, middle_);
    for (int k = 0; k < at.segment; ++k) {
        const Segment& seg = list[static_cast<std::size_t>(k)];
        rotation(seg.dof, seg.signedLength, centroid(at.side, k));
    }
    const Vec2 e = own.own + at.local * perp(offset);
    const int dof = list[static_cast<std::size_t>(at.segment)].dof;
    rows(0, dof) += first.dot(e);
    rows(1, dof) += second.dot(e);
}

void Kinematics::addAngleRow(const RodModel& model, const MaterialPoint& at, double sign, RowRef row) const {
    SC_ASSERT_EXPENSIVE(row.size() == model.dofs(), "one column for each degree of freedom");
    row[model.dofTheta()] += sign;
    const auto& list = model.side(at.side);
    for (int k = 0; k < at.segment; ++k)
        row[list[static_cast<std::size_t>(k)].dof] += sign * list[static_cast<std::size_t>(k)].signedLength;
    row[list[static_cast<std::size_t>(at.segment)].dof] += sign * at.local;
}

void Kinematics::pointRows(const RodModel& model, const MaterialPoint& at, const Vec2& offset, const Vec2& first,
                           const Vec2& second, Eigen::Ref<Eigen::Matrix<double, 2, Eigen::Dynamic>> rows) const {
    rows.setZero();
    addPointRows(model, at, offset, first, second, rows);
}

void Kinematics::angleRow(const RodModel& model, const MaterialPoint& at, RowRef row) const {
    row.setZero();
    addAngleRow(model, at, 1.0, row);
}

void Kinematics::closureRows(const RodModel& model, Eigen::Ref<Eigen::Matrix<double, 3, Eigen::Dynamic>> rows) const {
    rows.setZero();
    const auto add = [&](int element, double s, double sign) {
        const MaterialPoint at = locate(model, element, s);
        addPointRows(model, at, Vec2::Zero(), sign * Vec2::UnitX(), sign * Vec2::UnitY(), rows.topRows<2>());
        addAngleRow(model, at, sign, rows.row(2));
    };
    add(model.elements() - 1, model.definition().length, 1.0);
    add(0, 0.0, -1.0);
}

} // namespace supercircle::rod
