#pragma once
// Quantities read from a force-displacement curve: loop area, force drops, peaks.

#include <cstddef>
#include <span>
#include <vector>

namespace supercircle::lab {

/// Integral of F d(displacement) by the trapezoid rule over the given samples, J.
double workOf(std::span<const double> displacement, std::span<const double> force);

/// A drop of the force: from a local maximum to the following local minimum.
struct ForceDrop {
    std::size_t top = 0;    ///< sample of the maximum
    std::size_t bottom = 0; ///< sample of the minimum
    double size = 0.0;      ///< N
};

/// Drops of at least `threshold` (N); smaller wiggles in between are ignored (hysteresis, as in rainflow counting).
/// A drop must happen within `maxTravel` (m): slow softening is no snap-fit.
std::vector<ForceDrop> forceDrops(std::span<const double> displacement, std::span<const double> force, double threshold,
                                  double maxTravel);

/// Merges drops whose tops lie within `maxGap` (m) of the end of the drop before: the force rings after a snap and
/// rebounds in a long fall. The size of a merged drop is the fall from its first top to its lowest bottom, or the
/// largest of its parts; its `top` is that of the first part, its `bottom` that of the last one.
std::vector<ForceDrop> mergeDrops(std::span<const double> displacement, std::span<const double> force,
                                  const std::vector<ForceDrop>& drops, double maxGap);

/// Extremes of the moving average of a force, as a load cell would report them. The force on a rigid crosshead rings
/// for a tenth of a millisecond after a snap, to twice what the specimen carried.
struct ForceExtremes {
    double peak = 0.0;            ///< N, largest mean, at least 0
    std::size_t from = 0, to = 0; ///< rows between which it is the mean; equal without a peak
    double pullOff = 0.0;         ///< N, smallest mean, at most 0
};
/// Of one branch (time s, displacement m, monotonic; force N held since the row before); `window` in m.
ForceExtremes averagedExtremes(std::span<const double> time, std::span<const double> displacement,
                               std::span<const double> force, double window);

} // namespace supercircle::lab
