#pragma once
// Closed forms of the paper's supplement, dimensionless (B = R = 1).

#include "supercircle/support/elementary.h"

#include <cmath>

namespace supercircle::validation {

/// Ratio of the two elastic responses of a tip, Cxy / Cxx = K / K_perp, eq. (2)-(4); phi = half the opening angle.
inline double tipRatio(double phi) {
    const double c = math::cos(phi), s = math::sin(phi);
    return (0.5 - 1.5 * c * c + c - phi * s * c) / (0.5 * phi - 1.5 * s * c + phi * c * c);
}

/// Friction coefficient at the boundary of Type I and II on a cylinder of the shell's own radius, eq. (1), for
/// phi > pi / 2.
inline double boundaryOnCylinder(double phiBar) {
    const double phi = M_PI * phiBar;
    return math::tan(M_PI - phi + math::atan(tipRatio(phi)));
}

/// The same on a flat floor: pinned where mu exceeds | Cxy / Cxx |.
inline double boundaryOnFloor(double phiBar) {
    return std::abs(tipRatio(M_PI * phiBar));
}

} // namespace supercircle::validation
