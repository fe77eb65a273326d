#pragma once
// Thinning of curves for drawing, and loading branches of a displacement history.

#include <cstddef>
#include <vector>

namespace supercircle::graphics {

/// Rows of a table, the last one included.
struct RowRange {
    std::size_t first = 0, last = 0;
};

/// Ranges in which both columns are finite.
[[nodiscard]] std::vector<RowRange> finiteRanges(const std::vector<double>& x, const std::vector<double>& y);

/// Rows of `range` to be drawn: each of `buckets` equal parts keeps its first and last row and those of its smallest
/// and largest y, in order. Spikes of any width remain; at most 4 * buckets rows remain.
[[nodiscard]] std::vector<std::size_t> decimate(const std::vector<double>& y, const RowRange& range,
                                                std::size_t buckets);

/// A branch of a force-displacement curve.
struct CurveBranch {
    RowRange rows;
    bool loading = true;
    int cycle = 1; ///< counted by loading branches
};

/// Branches of a displacement history: a branch ends where the displacement reverses by more than `hysteresis` of its
/// whole range. Rows that are not finite are skipped; neighbouring branches share their turning row.
[[nodiscard]] std::vector<CurveBranch> curveBranches(const std::vector<double>& displacement, double hysteresis = 0.03);

} // namespace supercircle::graphics
