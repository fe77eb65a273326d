#include "plugin/graphics/decimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::graphics {

std::vector<RowRange> finiteRanges(const std::vector<double>& x, const std::vector<double>& y) {
    std::vector<RowRange> ranges;
    const std::size_t n = std::min(x.size(), y.size());
    bool inside = false;
    for (std::size_t i = 0; i < n; ++i) {
        const bool finite = std::isfinite(x[i]) && std::isfinite(y[i]);
        if (finite && inside)
            ranges.back().last = i;
        else if (finite)
            ranges.push_back({i, i});
        inside = finite;
    }
    return ranges;
}

std::vector<std::size_t> decimate(const std::vector<double>& y, const RowRange& range, std::size_t buckets) {
    std::vector<std::size_t> rows;
    const std::size_t n = range.last - range.first + 1;
    buckets = std::max<std::size_t>(buckets, 1);
    if (n <= 4 * buckets) {
        for (std::size_t i = range.first; i <= range.last; ++i)
            rows.push_back(i);
        return rows;
    }
    for (std::size_t b = 0; b < buckets; ++b) {
        const std::size_t first = range.first + n * b / buckets;
        const std::size_t last = range.first + n * (b + 1) / buckets - 1;
        const auto begin = y.begin();
        const auto [low, high] = std::minmax_element(begin + static_cast<std::ptrdiff_t>(first),
                                                     begin + static_cast<std::ptrdiff_t>(last) + 1);
        const auto a = static_cast<std::size_t>(low - begin), c = static_cast<std::size_t>(high - begin);
        for (const std::size_t row : {first, std::min(a, c), std::max(a, c), last})
            if (rows.empty() || row > rows.back())
                rows.push_back(row);
    }
    return rows;
}

std::vector<CurveBranch> curveBranches(const std::vector<double>& displacement, double hysteresis) {
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const double d : displacement)
        if (std::isfinite(d)) {
            lo = std::min(lo, d);
            hi = std::max(hi, d);
        }
    std::vector<CurveBranch> result;
    if (!(lo <= hi))
        return result;
    const double threshold = hysteresis * (hi - lo);
    const auto finiteFrom = [&](std::size_t i) {
        while (i < displacement.size() && !std::isfinite(displacement[i]))
            ++i;
        return i;
    };
    std::size_t start = finiteFrom(0), extreme = start, last = start;
    int direction = 0; // until the first displacement beyond the threshold
    int cycle = 0;
    const auto finish = [&](std::size_t end) {
        cycle += direction >= 0 || cycle == 0 ? 1 : 0;
        result.push_back({{start, end}, direction >= 0, cycle});
        start = end;
    };
    for (std::size_t i = start; i < displacement.size(); i = finiteFrom(i + 1)) {
        last = i;
        const double d = displacement[i];
        const double beyond = d - displacement[extreme];
        if (direction == 0) {
            if (std::abs(d - displacement[start]) > threshold) {
                direction = d > displacement[start] ? 1 : -1;
                extreme = i;
            }
        } else if (direction * beyond >= 0.0) {
            extreme = i;
        } else if (direction * beyond < -threshold) {
            finish(extreme);
            direction = -direction;
            extreme = i;
        }
    }
    finish(last);
    return result;
}

} // namespace supercircle::graphics
