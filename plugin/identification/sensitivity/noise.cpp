#include "plugin/identification/sensitivity/noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::sensitivity {

double computationalNoise(const std::vector<double>& values) {
    constexpr double kThird = 36.0 / 720.0; // (3!)^2 / 6!
    if (values.size() < 4)
        return 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i + 3 < values.size(); ++i) {
        const double d = values[i + 3] - 3.0 * values[i + 2] + 3.0 * values[i + 1] - values[i];
        sum += d * d;
    }
    return std::sqrt(kThird * sum / static_cast<double>(values.size() - 3));
}

std::vector<double> smoothedRms(const std::vector<double>& values, std::size_t width) {
    std::vector<double> sum(values.size() + 1, 0.0), count(values.size() + 1, 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool there = std::isfinite(values[i]);
        sum[i + 1] = sum[i] + (there ? values[i] * values[i] : 0.0);
        count[i + 1] = count[i] + (there ? 1.0 : 0.0);
    }
    std::vector<double> out(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t from = i > width ? i - width : 0, to = std::min(i + width + 1, values.size());
        const double n = count[to] - count[from];
        out[i] = n > 0.0 ? std::sqrt(std::max(0.0, sum[to] - sum[from]) / n) : std::numeric_limits<double>::quiet_NaN();
    }
    return out;
}

} // namespace supercircle::sensitivity
