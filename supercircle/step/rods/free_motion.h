#pragma once
// The motion of a rod that touches nothing, to second order, in steps of its own within the step (private to step/).
//
// SDIRK2, two stages with the factor gamma = 1 - 1/sqrt(2), L-stable (R. Alexander, SIAM J. Numer. Anal. 14, 1006,
// 1977). Each stage is an implicit Euler step of gamma dt from an extrapolated start:
//     M(q) v = P + gamma dt (dT/dq + F(q) - D v) + C^T (hold impulses),
//     C v = velocity of the holds,   q = Q + gamma dt v.
// Unknowns are q and the generalised momentum p = int lambda J^T u in the inertial frame. With the centre of mass in
// place of the middle, momentum, angular momentum and rigid motion are exact. The steps follow the embedded estimate
// gamma dt (k2 - k1) in the norm of energy, against the energy of vibration. Rods that joints tie move as one group
// (decisions 0183 and 0189).

#include "supercircle/step/contacts/contact_rows.h"
#include "supercircle/step/rods/rod_system.h"

namespace supercircle::step {

/// Whether gravity, holds to places, forces, mouse joints and effects without memory are all that acts on the rod,
/// contacts left aside.
[[nodiscard]] bool mayMoveFreely(const Rod& rod);
/// The motion of a group over `dt` s: of its rods q1, v, kin1, u1, moved. `motion` of bodies that are given. False: it
/// was not found.
[[nodiscard]] bool moveFreely(const World& world, const Settings& settings, const std::vector<BodyMotion>& motion,
                              double dt, std::vector<RodWork>& rods, FreeGroup& group);
/// Leaves the rod out of a trial that makes a stage of the others' motion.
void standAside(const Rod& rod, RodWork& w);
/// Accepts that motion.
RodEnergies acceptFreeMotion(const World& world, Rod& rod, double dt, RodWork& w);
/// Accepts what its joints did, and the bodies that hang on them; after all other bodies have moved.
void acceptFreeJoints(World& world, double dt, const FreeGroup& group);

} // namespace supercircle::step
