#pragma once
// Adhesion: attraction of near surfaces, a force per length of rod that depends on the gap.
//
// It is a field, not a contact. It acts at quadrature points much closer than the elements are long, because a gap of a
// tenth of a millimetre closes within a millimetre of a touching tip. Where it presses surfaces together, contacts
// carry it, so that friction acts without load (shear adhesion).

#include "supercircle/effects/model.h"
#include "supercircle/rod/kinematics.h"

namespace supercircle::effects {

/// An adhesion model on a rod: constants only, plain data.
struct Adhesion {
    AdhesionModel model;
    std::vector<rod::MaterialPoint> points; ///< quadrature points
    std::vector<double> weight;             ///< length of rod per quadrature point, m
    [[nodiscard]] bool on() const { return !points.empty(); }
};

Adhesion makeAdhesion(const rod::RodModel& rod, const AdhesionModel& model);

/// The law at one gap, per length.
struct AdhesionResponse {
    double force = 0.0;  ///< attraction, N/m
    double slope = 0.0;  ///< d force / d gap, N/m^2
    double energy = 0.0; ///< <= 0, zero beyond the range, J/m; its derivative is the force
};
AdhesionResponse adhesionAt(const AdhesionModel& model, double gap);

} // namespace supercircle::effects
