#pragma once
// Recordings of a mechanism that moves by itself: cut to where it is let go, thinned, and described (private to
// importing/).

#include "plugin/recording/import/import.h"
#include "plugin/recording/import/template.h"

#include <string>
#include <vector>

namespace supercircle::importing {

/// How a free run begins, from its first rows: a curve of the fourth degree through the first 60 ms.
struct Beginning {
    double angle = 0.0, spin = 0.0;                 ///< rad, rad/s
    double angleHalfWidth = 0.0, spinHalfWidth = 0; ///< three standard deviations and half a step of the encoder
};
Beginning beginningOf(const Track& track);

/// Smallest difference of two readings that differ, rad; 0: none differ.
double encoderStep(const std::vector<double>& angle);

/// Drops what comes before a turning point of the angle, 1: the first, before which the hand still lifts. A hand that
/// lets go slowly drags through the first half swing: the second is safe.
void cutToTurn(Track& track, int which, std::vector<Remark>& remarks);

/// Means of blocks of `size` rows.
void average(Track& track, int size, std::vector<Remark>& remarks);

/// experiment.json of angle-only runs.
record::Result<Description> describeFree(const Imported& imported, const TemplateOptions& options);

} // namespace supercircle::importing
