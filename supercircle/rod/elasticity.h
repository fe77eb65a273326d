#pragma once
// Bending energy of a Kirchhoff rod of arcs:
//     E_b = 1/2 B sum_i l_i e_i^2 - 1/2 sum_j c_j (e_j - e_(j-1))^2,   e = kappa - kappa0,   c_j = B l / 12.
// The first sum takes each arc by its mean strain. Where shear forces act the moment varies linearly within an element,
// and so does the true strain: the second sum, over the nodes between elements, takes out what the mean has too much.
// Positive definite, tridiagonal, no further unknowns; deflections and frequencies err by a tenth to a fiftieth of what
// the first sum alone gives with the same elements (docs/decisions/0235).

#include "supercircle/rod/model.h"

#include <Eigen/Core>

#include <algorithm>

namespace supercircle::rod {

/// Calls visit(before, after, c / B) for each node between two elements; unit m. The shear force is constant over the
/// two elements, and the elements at the ends of an open rod count whole. At most a sixth of the shorter one: then the
/// sum is positive definite for any lengths (each element loses two thirds at most).
template <class Visit>
void forNeighbours(const RodModel& model, Visit&& visit) {
    const int n = model.elements();
    const bool closed = model.definition().closed && n > 2;
    for (int after = closed ? 0 : 1; after < n; ++after) {
        const int before = after > 0 ? after - 1 : n - 1;
        const double a = model.elementLength(before), b = model.elementLength(after), apart = 0.5 * (a + b);
        const double ofA = before == 0 && !closed ? 2.0 : 1.0, ofB = after == n - 1 && !closed ? 2.0 : 1.0;
        const double c = (ofA * a * a * a + ofB * b * b * b) / (24.0 * apart * apart);
        visit(before, after, std::min(c, std::min(a, b) / 6.0));
    }
}

/// Stored bending energy, J.
double bendingEnergy(const RodModel& model, const Eigen::VectorXd& q);
/// Adds the bending force -dE/dq to `force` (n entries).
void addBendingForce(const RodModel& model, const Eigen::VectorXd& q, Eigen::VectorXd& force);
/// Adds factor * d2E/dq2 to `matrix`.
void addBendingStiffness(const RodModel& model, double factor, Eigen::MatrixXd& matrix);
/// Adds the part of neighbours alone.
void addNeighbourStiffness(const RodModel& model, double factor, Eigen::MatrixXd& matrix);
/// Rate of the bending energy at velocities v, W.
double bendingRate(const RodModel& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v);
/// Adds -factor * (d2E/dq2) v to `force`.
void addBendingDrag(const RodModel& model, double factor, const Eigen::VectorXd& v, Eigen::VectorXd& force);
/// Stiffness of an element by itself: B l, N m^3.
inline double bendingStiffness(const RodModel& model, int element) {
    return model.definition().bendingModulus * model.elementLength(element);
}

/// v' (d2E/dq2) v of curvatures v, which may be an expression; further entries do not count.
template <class Vector>
double bendingForm(const RodModel& model, const Eigen::MatrixBase<Vector>& v) {
    double sum = 0.0;
    for (int i = 0; i < model.elements(); ++i) {
        const double own = v[model.dofOfElement(i)];
        sum += model.elementLength(i) * own * own;
    }
    forNeighbours(model, [&](int before, int after, double c) {
        const double change = v[model.dofOfElement(after)] - v[model.dofOfElement(before)];
        sum -= c * change * change;
    });
    return model.definition().bendingModulus * sum;
}

} // namespace supercircle::rod
