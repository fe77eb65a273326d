#pragma once
// Moment-curvature law of an element: everything that makes it differ from B (kappa - kappa0).
//
//     m = f(t) phi B g(kappa - kappa0 - delta - kappa_p)  +  eta dkappa/dt  +  sum of Maxwell branches
//
// phi, delta: profiles (damage, defects, gradients), averaged over the element (profile.h); f(t): softening with age;
// g: backbone (linear, softening, stiffening, Ramberg-Osgood); kappa_p: plastic curvature, found by implicit return
// mapping. Curvature is a coordinate of the rod, so the law is local: one number in, one number and its slope out.
// Everything is evaluated at the end of a step; branches use the exact answer to a steady rate within the step, which
// neither oscillates nor needs small steps.

#include "supercircle/effects/laws/profile.h"
#include "supercircle/rod/model.h"

#include <Eigen/Core>

namespace supercircle::effects {

/// A material model on a rod and its state: plain data.
struct Material {
    MaterialModel model;
    std::vector<Section> upTo;    ///< sections of the first 0, 1, ... profiles; the last one is what acts
    double age = 0.0;             ///< since the specimen was rested, s
    std::vector<double> plastic;  ///< per element, kappa_p, 1/m
    std::vector<double> hardened; ///< per element, accumulated plastic curvature, 1/m
    std::vector<std::vector<double>> overstress; ///< per branch and element, its elastic curvature, 1/m
    [[nodiscard]] bool on() const { return !upTo.empty(); }
};

Material makeMaterial(const rod::RodModel& rod, const MaterialModel& model);

/// Forgets age and overstress, as a long rest does; plastic curvature stays.
void rest(Material& material);

/// Energies per length, J/m, by cause. Stored is what the state holds beyond the rod's own 1/2 B (kappa - kappa0)^2.
struct LineBook {
    double stored = 0.0;
    double dissipated = 0.0;
};

/// The answer of one element.
struct Response {
    double moment = 0.0;  ///< in all, N m
    double tangent = 0.0; ///< d moment / d kappa, N m^2
    double plastic = 0.0, hardened = 0.0;
};

/// Moment at the end of a step of `dt` from curvature `before` to `now`.
Response respond(const rod::RodModel& rod, const Material& material, int element, double before, double now, double dt);

/// Energy stored in the effects at curvature `now`, per cause, J.
void storedEnergy(const rod::RodModel& rod, const Material& material, const Eigen::VectorXd& q, Books& books);

/// Moves the state over a step from q to q1; what was dissipated goes into `books`, `stored` there is set anew.
void advance(const rod::RodModel& rod, const Eigen::VectorXd& q, const Eigen::VectorXd& q1, double dt,
             Material& material, Books& books);

} // namespace supercircle::effects
