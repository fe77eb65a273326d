#pragma once
// Adhesion: attraction of near surfaces, a force per length of rod that depends on the gap.
//
// It is a field, not a contact: it acts at quadrature points along the rod that are much closer than the elements are
// long, because a gap of a tenth of a millimetre closes within a millimetre of a touching tip. Where it presses
// surfaces together the contacts carry it, so that friction acts without load (shear adhesion).

#include "supercircle/effects/model.h"
#include "supercircle/rod/kinematics.h"

namespace supercircle::effects {

/// An adhesion model on a rod: constants only, plain data.
struct Attraction {
    AdhesionModel model;
    std::vector<rod::Place> place; ///< of the quadrature points
    std::vector<double> weight;    ///< length they stand for, m
    [[nodiscard]] bool on() const { return !place.empty(); }
};

Attraction makeAttraction(const rod::RodModel& rod, const AdhesionModel& model);

/// Of the law at one gap, per length.
struct AttractionPoint {
    double force = 0.0;  ///< towards each other, N/m
    double slope = 0.0;  ///< d force / d gap, N/m^2
    double energy = 0.0; ///< <= 0, zero beyond the range, J/m; its derivative is the force
};
AttractionPoint attractionAt(const AdhesionModel& model, double gap);

} // namespace supercircle::effects
