#pragma once
// Friction that remembers: what the surface of a rod has gone through, place by place.
//
// The memory belongs to places of the rod's surface, not to contacts. Contacts come and go, change their ids when they
// roll over a joint and split where surfaces nest; a first version that carried the state by contact id needed rules of
// inheritance for all of that. A place is a quarter of an element, so a tip has one of its own.

#include "supercircle/effects/model.h"
#include "supercircle/rod/model.h"

#include <cstddef>

namespace supercircle::effects {

/// Memory of one place of a rod's surface.
struct Site {
    double weakened = 0.0; ///< 1 - w: share of the static excess that slip has taken, 1
    double slid = 0.0;     ///< slip it has seen, m
    double speed = 0.0;    ///< of slip in the last step, m/s
};

/// Contact effects on a rod and its state: plain data.
struct Surface {
    ContactModel model;
    double spacing = 0.0;    ///< of the sites, m
    std::vector<Site> sites; ///< from the first tip to the last; empty: friction is constant
    [[nodiscard]] bool on() const { return !sites.empty(); }
};

Surface makeSurface(const rod::RodModel& rod, const ContactModel& model);
/// Fully healed; wear stays.
void rest(Surface& surface);

/// Nearest site to arc length s (m).
std::size_t siteAt(const Surface& surface, double s);

/// Factor of the friction coefficient, at least 0.01, at the end of a step `dt` (s) of slip at `speed` (m/s, >= 0).
double frictionFactor(const FrictionModel& model, const Site& site, double speed, double dt);
/// Moves a site through that step.
void advance(const FrictionModel& model, Site& site, double speed, double dt);

} // namespace supercircle::effects
