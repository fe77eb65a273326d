#pragma once
// Sections that differ along the rod, averaged over elements.
//
// An element is one arc, and its moment hardly varies along it: its mean compliance is what counts. B is therefore
// averaged harmonically and natural curvature arithmetically. Both are exact for a uniform moment, also for a crease
// much shorter than an element, which the arithmetic mean of B would hide.

#include "supercircle/effects/model.h"
#include "supercircle/rod/model.h"

namespace supercircle::effects {

/// Value of the shape at arc length s, 1.
double shapeAt(const Profile& profile, double length, double s);
/// Factor of the bending modulus at s, 1, at least 1e-3.
double stiffnessAt(const Profile& profile, double length, double s);

/// The profile of the rod rotated end for end: the mirror image.
Profile mirrored(Profile profile);

/// Means over every element.
struct Section {
    std::vector<double> factor;    ///< of the bending modulus, 1
    std::vector<double> curvature; ///< added to the natural one, 1/m
};

/// The first `count` profiles together.
Section sections(const rod::RodModel& model, const std::vector<Profile>& profiles, std::size_t count);

} // namespace supercircle::effects
