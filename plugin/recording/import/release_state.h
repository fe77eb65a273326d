#pragma once
// Angle and spin with which a freely swinging body is released, from the first rows of its recording (private to
// import/; decisions 0022 and 0205).

#include "plugin/recording/import/signals.h"

#include <vector>

namespace supercircle::importing {

struct ReleaseState {
    double angle = 0.0, spin = 0.0;                 ///< rad, rad/s
    double angleHalfWidth = 0.0, spinHalfWidth = 0; ///< three sigma and half an encoder step
    bool bySpin = false;                            ///< recorded angular velocities are used too
    double spinApart = 0.0; ///< rad/s, from the angles alone minus with angular velocities that contradict them; else 0
};

/// Where a swing has at least nine rows in a twelfth of its period: a polynomial of degree four through these. Else the
/// equation of a swing with a nonlinear restoring moment and damping, through half a period and at least twelve rows.
ReleaseState releaseStateOf(const Signals& signals);

/// Smallest nonzero difference of two readings, rad; 0: none.
double encoderStep(const std::vector<double>& angle);

/// Period of the swing, s, from its crossings of the mean; the whole time if it crosses less than twice.
double swingPeriod(const std::vector<double>& time, const std::vector<double>& angle);

/// Removes an angular velocity that is nothing but the difference of neighbouring angles, and says so: it measures
/// nothing, and differences of past rows lag by half a row.
void dropDifferences(Signals& signals, std::vector<Remark>& remarks);

} // namespace supercircle::importing
