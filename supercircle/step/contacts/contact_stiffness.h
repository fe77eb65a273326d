#pragma once
// What contact forces do when the rod under them turns within the step (private to step/).
//
// Forces frozen on rows of the step's middle are an explicit geometric stiffness. Above about half the bending
// stiffness that oscillates with a period of two steps. Two terms of second order make it implicit (decisions 0043 and
// 0055):
// - Rolling (work.h): the contact point of two smooth surfaces moves along them;
// - axial force N (tension positive): -sum f . d^2 r / dq^2 = int N(s) (d theta / dq)^T (d theta / dq) ds, since theta
//   is linear in q. Only stretches in tension go into A, which stays positive definite.

#include "supercircle/step/contacts/contact_rows.h"

namespace supercircle::step {

/// Fills RodWork::rolling from the framed candidates and the normal forces known so far (`warm`).
void collectRolling(const World& world, std::vector<RodWork>& rods, double dt, const std::vector<ContactImpulse>& warm,
                    bool firstIteration, ContactStage& stage);

/// Fills RodWork::axial from the contact forces known so far and the reactions of holds.
void collectAxial(const World& world, std::vector<RodWork>& rods, const std::vector<ContactImpulse>& warm,
                  const ContactStage& stage);

/// Energy that both terms bring in with the motion `w.v` that was found, J. They stand for forces that act on rows
/// which turn, and know the forces of the step before. Where the motion is another one, their work is nobody's.
[[nodiscard]] double turningWork(const Rod& rod, double dt, RodWork& w);
/// Whether that is too much: the step has to be linearised about the motion found, or cut. Keeps it in the rod's work.
[[nodiscard]] bool turnsTooMuch(const Rod& rod, double dt, RodWork& w);

/// The same of one rod, whose geometry was evaluated: begins, adds a point force (N) to the axial force of every
/// segment that it pulls at, fills RodWork::axial.
void beginPulls(const rod::RodModel& model, RodWork& w);
void pull(const rod::RodModel& model, const rod::MaterialPoint& at, const Vec2& force, RodWork& w);
void axialOfPulls(const rod::RodModel& model, RodWork& w);

/// Geometric stiffness of the axial forces, N m^2 per (1/m)^2 in the curvatures: `out` (n x n) is overwritten.
void axialStiffness(const rod::RodModel& model, const RodWork& w, Eigen::MatrixXd& out);

} // namespace supercircle::step
