// Energy of a group that moves freely, with the potential of gravity and constant forces.

#include "supercircle/rod/elasticity.h"
#include "supercircle/rod/inertia.h"
#include "supercircle/step/rods/free_material.h"
#include "supercircle/step/rods/free_system.h"
#include "supercircle/step/rods/hold_springs.h"

namespace supercircle::step {

/// Of gravity and forces at the geometry evaluated last, J.
double FreeSystem::potentialOf(std::size_t i) {
    const Rod& r = rod(i);
    const rod::Kinematics& kin = work(i).kin;
    const Vec2& middle = free(i).middle;
    double energy = -r.model.mass() * world_.gravity.dot(middle + rod::massCentre(kin, work(i).gauss));
    for (const AppliedForce& a : r.forces) {
        const rod::MaterialPoint at = rod::locate(r.model, a.s);
        energy -= a.force.dot(kin.point(at) + middle) + a.torque * kin.angle(at);
    }
    return energy;
}

double FreeSystem::energyAtStart() {
    double energy = 0.0;
    for (std::size_t i = 0; i < size(); ++i)
        energy += bentEnergy(rod(i), free(i).q, free(i).overstress, 0.0) + potentialOf(i) +
                  holdSpringEnergy(world_, rod(i), work(i).kin, 0.0) + rod::kineticEnergy(rod(i).gauss, rod(i).u);
    for (const FreeBody& b : g_.bodies)
        energy += 0.5 * b.p.dot(b.v) - b.pull.dot(b.q);
    return energy;
}

double FreeSystem::energyAtEnd(double ahead) {
    double energy = 0.0;
    for (std::size_t i = 0; i < size(); ++i) {
        const FreeStage& s = free(i).stages[1];
        energy += bentEnergy(rod(i), s.q, s.overstress, ahead) + potentialOf(i) +
                  holdSpringEnergy(world_, rod(i), work(i).kin, ahead) + 0.5 * s.p.dot(s.v);
    }
    for (const FreeBody& b : g_.bodies)
        energy += 0.5 * b.stages[1].p.dot(b.stages[1].v) - b.pull.dot(b.stages[1].q);
    return energy;
}

double FreeSystem::bendingAtEnd() {
    double energy = 0.0;
    for (std::size_t i = 0; i < size(); ++i)
        energy += rod::bendingEnergy(rod(i).model, free(i).stages[1].q);
    return energy;
}

} // namespace supercircle::step
