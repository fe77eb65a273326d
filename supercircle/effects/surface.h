#pragma once
// State-dependent friction: the history of the surface of a rod, site by site.
//
// The history belongs to sites on the rod's surface, not to contacts, because contacts come and go and change their ids
// (decision 0128). A site covers a quarter of an element, so a tip has its own.

#include "supercircle/effects/model.h"
#include "supercircle/rod/model.h"

#include <cstddef>

namespace supercircle::effects {

/// State of one site of a rod's surface.
struct Site {
    double weakened = 0.0; ///< 1 - w: fraction of the static excess lost by slip, 1
    double slid = 0.0;     ///< accumulated slip, m
    double speed = 0.0;    ///< of slip in the last step, m/s
    double age = 0.0;      ///< theta of rate and state friction, s
};

/// Contact effects on a rod and their state: plain data.
struct Surface {
    ContactModel model;
    double spacing = 0.0;    ///< of the sites, m
    std::vector<Site> sites; ///< from the first tip to the last; empty: friction is constant
    [[nodiscard]] bool on() const { return !sites.empty(); }
};

Surface makeSurface(const rod::RodModel& rod, const ContactModel& model);
/// Resets the state as after a long rest: fully healed, contacts as old as the model says; wear stays.
void applyLongRest(Surface& surface);

/// Nearest site to arc length s (m).
std::size_t siteAt(const Surface& surface, double s);

/// Factor of the friction coefficient, at least 0.01, at the end of a step `dt` (s) of slip at `speed` (m/s, >= 0).
double frictionFactor(const FrictionModel& model, const Site& site, double speed, double dt);
/// Moves a site through that step.
void advance(const FrictionModel& model, Site& site, double speed, double dt);

} // namespace supercircle::effects
