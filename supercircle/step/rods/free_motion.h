#pragma once
// The motion of a rod that touches nothing, to second order, in steps of its own within the step (private to step/).
//
// SDIRK2, two stages with the factor gamma = 1 - 1/sqrt(2), L-stable (R. Alexander, SIAM J. Numer. Anal. 14, 1006,
// 1977). Each stage is an implicit Euler step of gamma dt from an extrapolated start P, Q:
//     M(q) v = P + gamma dt (dT/dq + F(q) - D v) + C^T (impulses of holds and joints),
//     C v = their given velocity,   q = Q + gamma dt v.
// Unknowns are q and the generalised momentum p = int lambda J^T u in the inertial frame. With the centre of mass in
// place of the middle, momentum, angular momentum and rigid motion are exact, unless joints, mouse joints, forces at
// points or air act. The steps follow the embedded estimate gamma dt (k2 - k1) in the norm of energy, against the
// energy of vibration. Rods that joints tie move as one group (decisions 0183, 0189, 0230, 0243 and 0244).

#include "supercircle/step/contacts/contact_rows.h"
#include "supercircle/step/rods/rod_system.h"

namespace supercircle::step {

/// Whether nothing on the rod itself asks for the ordinary step: it does not sleep, is not quarantined, and has neither
/// drag nor adhesion. Contacts, holds and joints are asked in stages/free_rods.cpp.
[[nodiscard]] bool mayMoveFreely(const Rod& rod);
/// Moves the rods of a group over `dt` s: q1, v, kin1, u1 and moved of their entries in `rods`. `motion`: of
/// World::bodies. False: no such motion was found, or a material yields, and the ordinary step has to move them.
[[nodiscard]] bool moveFreely(const World& world, const Settings& settings, const std::vector<BodyMotion>& motion,
                              double dt, std::vector<RodWork>& rods, FreeGroup& group);
/// Leaves a rod that moves freely out of a trial that is a stage of the others' step of second order (second_order.h).
void standAside(const Rod& rod, RodWork& w);
/// Makes the motion of moveFreely() the state of the rod. Returns the energies by cause, J.
RodEnergies acceptFreeMotion(const World& world, Rod& rod, double dt, RodWork& w);
/// Accepts what its joints did, and the bodies that hang on them; after all other bodies have moved.
void acceptFreeJoints(World& world, double dt, const FreeGroup& group);

} // namespace supercircle::step
