#pragma once
// Mass matrix, momenta and velocity fields of a rod.
//
// All integrals over the rod use the same points: Gauss points (RodModel::kGauss per segment, exact to round-off for
// arcs), and those that carry point masses.
// Hence
//     v . (M v - p) = change of kinetic energy + 1/2 |u_new - u_old|^2
// holds to round-off, which the energy balance relies on. M is assembled from the mass moments of everything beyond
// each element (kinematics.h): O(N^2) with a small constant instead of a rank-2 update per Gauss point.

#include "supercircle/rod/kinematics.h"

namespace supercircle::rod {

/// The points of one configuration: Gauss points, then those that carry point masses.
struct GaussField {
    std::vector<Vec2> arm;    ///< position minus the middle, m; side 0 outward, then side 1 outward
    std::vector<Vec2> own;    ///< derivative by the curvature of the point's own segment, inner end fixed, m^2
    std::vector<double> mass; ///< kg
};

/// Fills `field` for the configuration of `kin`.
void evaluateGauss(const RodModel& model, const Kinematics& kin, GaussField& field);

/// M = int lambda J^T J ds, n x n, overwritten (both triangles).
void massMatrix(const RodModel& model, const Kinematics& kin, const GaussField& field, Eigen::MatrixXd& M);

/// p = int lambda J^T u ds for a velocity (or acceleration) given at the Gauss points; n entries, overwritten.
void momentum(const RodModel& model, const Kinematics& kin, const GaussField& field, const std::vector<Vec2>& u,
              Eigen::VectorXd& p);

/// u = J v at the Gauss points.
void velocityField(const RodModel& model, const Kinematics& kin, const GaussField& field, const Eigen::VectorXd& v,
                   std::vector<Vec2>& u);

/// int lambda J^T a ds for a uniform acceleration a (gravity), n entries, overwritten.
void uniformForce(const RodModel& model, const Kinematics& kin, const GaussField& field, const Vec2& acceleration,
                  Eigen::VectorXd& force);

/// dT/dq at fixed v of the kinetic energy T = 1/2 v . M(q) v, whose velocityField is `u`: centrifugal and Coriolis
/// forces, n entries, overwritten. With `u` less its mean, of the energy of motion about the centre of mass.
void inertialForce(const RodModel& model, const Kinematics& kin, const GaussField& field, const Eigen::VectorXd& v,
                   const std::vector<Vec2>& u, Eigen::VectorXd& force);

/// 1/2 int lambda |u|^2 ds, J.
double kineticEnergy(const GaussField& field, const std::vector<Vec2>& u);

/// Centre of mass, m.
Vec2 massCentre(const Kinematics& kin, const GaussField& field);

} // namespace supercircle::rod
