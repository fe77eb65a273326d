#pragma once
// Fewer points that look the same.

#include <cstddef>
#include <vector>

namespace supercircle::report {

/// A stretch of rows, last one included.
struct Stretch {
    std::size_t first = 0, last = 0;
};

/// Stretches in which both columns are finite.
[[nodiscard]] std::vector<Stretch> finiteStretches(const std::vector<double>& x, const std::vector<double>& y);

/// Rows of `stretch` worth drawing: each of `buckets` equal parts keeps its first and last row and those of its
/// smallest and largest y, in order. Spikes survive whatever their width; at most 4 * buckets rows remain.
[[nodiscard]] std::vector<std::size_t> decimate(const std::vector<double>& y, const Stretch& stretch,
                                                std::size_t buckets);

/// A branch of a force-displacement curve.
struct Leg {
    Stretch rows;
    bool loading = true;
    int cycle = 1; ///< counted by loading legs
};

/// Branches of a displacement history: it turns where it goes back by more than `hysteresis` of its whole span. Rows
/// that are not finite are passed over; neighbouring legs share their turning row.
[[nodiscard]] std::vector<Leg> legs(const std::vector<double>& displacement, double hysteresis = 0.03);

} // namespace supercircle::report
