#pragma once
// Geometric stiffness: how the generalised force J^T f of a dead load changes with the configuration.
//
// A dead load keeps its direction and its material point. Hence -d(J^T f)/dq = -f . d2r/dq2 is symmetric: it is the
// Hessian of the load's potential. With i closer to the middle than j on the same side,
//     d2r/dtheta dtheta = -(r - r_m)      d2r/dtheta dk_j = perp(dr/dk_j)      d2r/dk_i dk_j = l_i perp(dr/dk_j)
// For r beyond j the last one is -l_i l_j (r - c_j), with c_j the centroid of the outer element. For one element,
//     d2r/dk_j dk_j = chord_j''(l_j) - l_j^2 (r - end_j),   chord'' = d2 chord/dk2 in closed form.
// Points on different sides of the middle share no curvature; all other entries vanish.

#include "supercircle/rod/inertia.h"
#include "supercircle/rod/kinematics.h"

namespace supercircle::rod {

/// d2 (pointAt(s) - start) / d curvature^2 at fixed start and angle, m^3; full accuracy through zero curvature.
Vec2 chordSecondDerivative(const Arc& arc, double s);

/// Adds -d(J^T f)/dq of a dead force f (N) at the material point `offset` away from the centre line to K (n x n, both
/// triangles). `offset` is the present vector, attached rigidly to the section as in Kinematics::pointRows.
void addPointForceStiffness(const RodModel& model, const Kinematics& kin, const MaterialPoint& at, const Vec2& offset,
                            const Vec2& f, Eigen::MatrixXd& K);

/// Adds -d(int lambda J^T a ds)/dq of a uniform acceleration a (m/s^2) to K (n x n, both triangles). Exact for the
/// Gauss points of `field`, so it is the derivative of uniformForce to round-off.
void addUniformStiffness(const RodModel& model, const Kinematics& kin, const GaussField& field, const Vec2& a,
                         Eigen::MatrixXd& K);

} // namespace supercircle::rod
