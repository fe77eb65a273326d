#pragma once
// Adhesion inside a step (private to step/): the places of rods that are within reach of an outline or of another rod,
// the force there, and what it does to the rods' equations.
//
// As the other effects, the law is taken at the end of the step as predicted. The stiffness of the rising flank of the
// attraction is implicit; on the falling flank it is negative - surfaces jump into contact - and stays explicit, so
// that A remains positive definite: the controller's local error resolves the jump. Between two rods each side gets
// twice the stiffness of its own motion, which is stable while the other side is lagged. Each pair of rods is counted
// from both sides with half the weight, so that neither is special. A rod does not attract itself.

#include "supercircle/step/contacts/contact_rows.h"

namespace supercircle::step {

/// Finds stage.pulls at the predicted end of the step.
void collectAdhesion(const World& world, const std::vector<RodWork>& rods, double dt, ContactStage& stage);
/// Adds them to A and rhs of rod i.
void addAdhesion(const ContactStage& stage, int rod, double dt, RodWork& w);
/// How far the forces are from the law at the solved end, in tolerances.
double adhesionError(const World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage);

struct AdhesionEnergies {
    double taken = 0.0;       ///< change of stored energy, J
    double work = 0.0;        ///< of bodies that move as they are told, J
    double toBodies = 0.0;    ///< to dynamic ones, J
    double secondOrder = 0.0; ///< J
};
/// Records the energy of the accepted step, in the state before it; forces go to the bodies.
AdhesionEnergies recordAdhesion(World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage);

} // namespace supercircle::step
