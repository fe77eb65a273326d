#pragma once
// Links (pins, welds, tethers) as further contacts of the Coulomb problem (private to step/).
//
// A pin is one bilateral contact with both rows locked, a weld has another one with a normal row only for the angle
// between the sections, a tether is a frictionless unilateral contact with gap = length - distance. They are appended
// behind the contacts of the detector; stage.links.rows says what they are.
//
// Like those of contact their rows belong to the middle of the step, and w carries gap / dt. Beyond that a link knows
// its true gap at the end of the last linearisation, so from the second one on its row is Newton's,
//     gap(end) + dt H (v - v_last) = 0,
// and joints close to round-off however far the step turns them: the third-order error of a frozen row would be seen in
// a pendulum as a length that breathes by (omega dt)^3 / 24.

#include "supercircle/step/contacts/contact_rows.h"

namespace supercircle::step {

/// What an attempt starts from: stage.links.ends.
void findLinkEnds(const World& world, ContactStage& stage);

/// Finds the links that take part in this linearisation and their geometry: stage.links.rows. `again`: rods and
/// stage.host.motion hold the solution of the last linearisation.
void prepareLinks(const World& world, const std::vector<RodWork>& rods, double dt, bool again, ContactStage& stage);

/// Fills the contacts behind the candidates' and their warm start. Bodies of the problem have their places already.
void coupleLinks(const World& world, const std::vector<RodWork>& rods, double dt, ContactStage& stage);

/// Largest error of a link after the attempt over what it is allowed to be, 1: above 1 another linearisation pays.
/// `tolerance` (m) and 1e-7 of the link's own size are allowed.
double linkError(const World& world, const std::vector<RodWork>& rods, double dt, double tolerance,
                 const ContactStage& stage);

/// Largest error of a link, m: at the start and at the end of the attempt.
struct LinkGaps {
    double before = 0.0, after = 0.0;
};
LinkGaps linkGaps(const World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage);

/// A motion of the other end's body in the row's own directions, m/s.
Vec2 inRow(const LinkRow& row, const Vec2& velocity, double spin);

/// Energy of the links and what they leave for the next step; the counterpart of recordContacts.
void recordLinks(World& world, std::vector<RodWork>& rods, const ContactStage& stage, double dt);

/// Moves targets and lengths on by a step.
void advanceLinks(World& world, double dt);

} // namespace supercircle::step
