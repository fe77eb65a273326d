#pragma once
// Positions and Jacobians of a rod in closed form: r(s) = r_m + int (cos theta, sin theta) ds.
//
// For a point beyond an element, a change of that element's curvature is a rigid rotation about the centroid of its arc
// by (signed length) * d kappa. Jacobian rows, mass matrix and momenta all follow from this.

#include "supercircle/rod/model.h"

#include <Eigen/Core>
#include <vector>

namespace supercircle::rod {

/// A point of the centre line that moves with the material: side and segment of the model, and the signed arc length
/// from the segment's inner end.
struct MaterialPoint {
    int side = 0;
    int segment = 0;
    double local = 0.0; ///< m, sign of the side
};

/// Finds the material point at arc length s (m, from the first tip) on `element`.
MaterialPoint locate(const RodModel& model, int element, double s);
/// The same when the element is not known.
MaterialPoint locate(const RodModel& model, double s);

/// A row of any matrix, or a vector of its own.
using RowRef = Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>>;

/// The rod's curve at one q.
class Kinematics {
public:
    /// Evaluates nodes, arcs and centroids at q (n entries, layout of RodModel). O(N).
    void evaluate(const RodModel& model, const Eigen::VectorXd& q);

    [[nodiscard]] const Vec2& middle() const { return middle_; }
    [[nodiscard]] const std::vector<Arc>& arcs() const { return arcs_; } ///< element i from node i to node i + 1
    [[nodiscard]] Vec2 node(int i) const {
        return i < static_cast<int>(arcs_.size()) ? arcs_[static_cast<std::size_t>(i)].start : lastNode_;
    }
    [[nodiscard]] const Arc& segmentArc(int side, int k) const { return segments_[side][static_cast<std::size_t>(k)]; }
    [[nodiscard]] const Vec2& centroid(int side, int k) const { return centroids_[side][static_cast<std::size_t>(k)]; }

    /// Unit tangent at the inner end of a segment.
    [[nodiscard]] const Vec2& segmentTangent(int side, int k) const {
        return tangents_[side][static_cast<std::size_t>(k)];
    }

    [[nodiscard]] Vec2 point(const MaterialPoint& at) const { return pointOf(at).position; }
    [[nodiscard]] double angle(const MaterialPoint& at) const {
        return segmentArc(at.side, at.segment).angleAt(at.local);
    }

    /// Two Jacobian rows of the material point `offset` away from the centre line (rigidly attached to its section):
    /// row 0 = d . dr/dq along `first`, row 1 along `second`. `rows` is 2 x n and overwritten.
    void pointRows(const RodModel& model, const MaterialPoint& at, const Vec2& offset, const Vec2& first,
                   const Vec2& second, Eigen::Ref<Eigen::Matrix<double, 2, Eigen::Dynamic>> rows) const;
    /// d theta(s) / dq, n entries, overwritten.
    void angleRow(const RodModel& model, const MaterialPoint& at, RowRef row) const;
    /// Place and angle of the last end less those of the first one, which a ring keeps together; 3 x n, overwritten.
    void closureRows(const RodModel& model, Eigen::Ref<Eigen::Matrix<double, 3, Eigen::Dynamic>> rows) const;

private:
    struct PointWithDerivative {
        Vec2 position;
        Vec2 own; ///< derivative by the curvature of the point's own segment, m^2
    };
    /// From the tangent at the segment's inner end, without sines.
    [[nodiscard]] PointWithDerivative pointOf(const MaterialPoint& at) const;
    void addPointRows(const RodModel& model, const MaterialPoint& at, const Vec2& offset, const Vec2& first,
                      const Vec2& second, Eigen::Ref<Eigen::Matrix<double, 2, Eigen::Dynamic>> rows) const;
    void addAngleRow(const RodModel& model, const MaterialPoint& at, double sign, RowRef row) const;

    Vec2 middle_ = Vec2::Zero();
    Vec2 lastNode_ = Vec2::Zero();
    std::vector<Arc> arcs_;
    std::vector<Arc> segments_[2];   ///< start at the inner end, run with signed length
    std::vector<Vec2> tangents_[2];  ///< at the inner ends
    std::vector<Vec2> centroids_[2]; ///< of the whole segment
};

} // namespace supercircle::rod
