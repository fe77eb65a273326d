#pragma once
// Moment-curvature law of an element: everything that differs from B (kappa - kappa0).
//
//     m = f(t) phi B g(kappa - kappa0 - delta - kappa_p)  +  eta dkappa/dt  +  sum of Maxwell branches
//
// phi, delta: profiles (damage, defects, gradients), averaged over the element (profile.h); f(t): softening with age;
// g: elastic law (linear, softening, stiffening, Ramberg-Osgood, learned); kappa_p: plastic curvature, found by
// implicit return mapping. Curvature is a coordinate of the rod, so the law is local, but for what neighbours take from
// each other where the moment varies along the rod (rod/elasticity.h). It is evaluated at the end of a step; Maxwell
// branches use the exact answer to a steady rate within the step, which neither oscillates nor needs small steps.

#include "supercircle/effects/laws/profile.h"
#include "supercircle/rod/model.h"

#include <Eigen/Core>

namespace supercircle::effects {

/// A material model on a rod and its state: plain data.
struct Material {
    MaterialModel model;
    std::vector<Section> cumulativeSections;     ///< sections of the first 0, 1, ... profiles; the last one acts
    double age = 0.0;                            ///< since the last long rest, s
    std::vector<double> plastic;                 ///< per element, kappa_p, 1/m
    std::vector<double> hardened;                ///< per element, accumulated plastic curvature, 1/m
    std::vector<std::vector<double>> overstress; ///< per branch and element, its elastic curvature, 1/m
    [[nodiscard]] bool on() const { return !cumulativeSections.empty(); }
};

Material makeMaterial(const rod::RodModel& rod, const MaterialModel& model);

/// Resets age and overstress, as after a long rest; plastic curvature stays.
void applyLongRest(Material& material);

/// How viscous moments act while a rod comes to rest.
enum class ViscousMoments : std::uint8_t {
    Gone, ///< as after a long rest: what is left is B (kappa - kappa0)
    Held  ///< as at once: branches are elastic and dashpots rigid, for they have no time to move
};
/// The model with viscous moments of that kind; the branches keep their places.
MaterialModel whileResting(MaterialModel model, ViscousMoments viscous);

/// The response of one element.
struct MaterialResponse {
    double moment = 0.0;                  ///< total moment, N m
    double tangent = 0.0;                 ///< d moment / d kappa, N m^2
    double plastic = 0.0, hardened = 0.0; ///< 1/m
};

/// The same without viscosity and Maxwell branches, `ahead` s from now.
MaterialResponse springResponse(const rod::RodModel& rod, const Material& material, int element, double curvature,
                                double ahead);

/// What neighbouring elements take from each other, beside their own moments.
struct NeighbourResponse {
    int before = 0, after = 0;                  ///< elements
    double forceBefore = 0.0, forceAfter = 0.0; ///< on their curvatures, N m^2
    double ownBefore = 0.0, ownAfter = 0.0,
           cross = 0; ///< slopes of these forces, those of nonlinear laws roughly, N m^3
};

/// The pairs of springResponse(), in `out`, at the curvatures of q.
void springNeighbours(const rod::RodModel& rod, const Material& material, const Eigen::VectorXd& q, double ahead,
                      std::vector<NeighbourResponse>& out);

/// Adds factor times the stiffness of these pairs to `matrix`.
void addNeighbourStiffness(const rod::RodModel& rod, const std::vector<NeighbourResponse>& pairs, double factor,
                           Eigen::MatrixXd& matrix);

/// Energy of these springs in place of the rod's own, J, `ahead` s from now at the curvatures of q.
double springEnergy(const rod::RodModel& rod, const Material& material, const Eigen::VectorXd& q, double ahead);

/// Moment at the end of a step of `dt` from curvature `before` to `now`.
MaterialResponse materialResponse(const rod::RodModel& rod, const Material& material, int element, double before,
                                  double now, double dt);

/// The pairs of materialResponse(), in `out`, at the end of a step of `dt` from q to q1.
void materialNeighbours(const rod::RodModel& rod, const Material& material, const Eigen::VectorXd& q,
                        const Eigen::VectorXd& q1, double dt, std::vector<NeighbourResponse>& out);

/// Energy stored in the effects beyond the rod's own bending energy, by cause, J.
void storedEnergy(const rod::RodModel& rod, const Material& material, const Eigen::VectorXd& q,
                  EffectEnergies& energies);

/// Moves the state over a step from q to q1. Adds the dissipated energy to `energies` and sets the stored energy there.
void advance(const rod::RodModel& rod, const Eigen::VectorXd& q, const Eigen::VectorXd& q1, double dt,
             Material& material, EffectEnergies& energies);

} // namespace supercircle::effects
