// Break points of a piecewise linear motion from noisy samples. Each line covers as many samples as the tolerance
// allows (by doubling and halving). Lines are then fitted to the middle of their segments, and neighbouring lines are
// intersected, which locates corners better than one sample. Nearly parallel lines keep their boundary.

#include "plugin/recording/import/drive.h"

#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>

namespace supercircle::importing {

namespace {

constexpr std::size_t kMost = 500000; ///< largest number of samples used

struct DriveLine {
    double t0 = 0.0, value = 0.0, slope = 0.0; ///< value at t0
    [[nodiscard]] double at(double t) const { return value + slope * (t - t0); }
};

/// Prefix sums, for lines through any interval without a loop.
class Samples {
public:
    Samples(std::vector<double> times, std::vector<double> values) : t(std::move(times)), d(std::move(values)) {
        sums_.resize(t.size() + 1);
        for (std::size_t i = 0; i < t.size(); ++i) {
            const long double x = t[i] - t[0], y = d[i];
            sums_[i + 1] = {sums_[i].x + x, sums_[i].y + y, sums_[i].xx + x * x, sums_[i].xy + x * y};
        }
    }
    /// Least squares over samples first to last - 1.
    [[nodiscard]] DriveLine fit(std::size_t first, std::size_t last) const {
        const auto n = static_cast<long double>(last - first);
        const long double x = sums_[last].x - sums_[first].x, y = sums_[last].y - sums_[first].y;
        const long double xx = sums_[last].xx - sums_[first].xx - x * x / n;
        const long double xy = sums_[last].xy - sums_[first].xy - x * y / n;
        DriveLine line{t[0] + static_cast<double>(x / n), static_cast<double>(y / n), 0.0};
        if (last - first >= 2 && xx > 0.0L)
            line.slope = static_cast<double>(xy / xx);
        return line;
    }
    [[nodiscard]] bool follows(std::size_t first, std::size_t last, double tolerance) const {
        const DriveLine line = fit(first, last);
        for (std::size_t i = first; i < last; ++i)
            if (std::abs(d[i] - line.at(t[i])) > tolerance)
                return false;
        return true;
    }
    std::vector<double> t, d;

private:
    struct Sums {
        long double x = 0.0L, y = 0.0L, xx = 0.0L, xy = 0.0L;
    };
    std::vector<Sums> sums_;
};

/// White noise from second differences (median: corners do not matter), and the smallest step of the signal.
void roughness(const Samples& s, double& noise, double& resolution) {
    std::vector<double> bends, steps;
    for (std::size_t i = 1; i < s.t.size(); ++i) {
        if (const double step = std::abs(s.d[i] - s.d[i - 1]); step > 0.0)
            steps.push_back(step);
        if (i + 1 == s.t.size())
            break;
        const double share = (s.t[i] - s.t[i - 1]) / (s.t[i + 1] - s.t[i - 1]);
        bends.push_back(std::abs(s.d[i] - (1.0 - share) * s.d[i - 1] - share * s.d[i + 1]));
    }
    noise = 1.4826 * upperMedian(std::move(bends)) / std::sqrt(1.5);
    // a quantised ramp repeats values: the smallest step is then the resolution, else it is only the slope
    const bool repeats = 10 * steps.size() < 9 * s.t.size();
    resolution = repeats && !steps.empty() ? *std::min_element(steps.begin(), steps.end()) : 0.0;
}

/// Last sample (one past) of the longest segment from `first`.
std::size_t reach(const Samples& s, std::size_t first, double tolerance) {
    const std::size_t n = s.t.size();
    std::size_t good = std::min(first + 2, n), step = 2;
    while (good < n && s.follows(first, std::min(good + step, n), tolerance)) {
        good = std::min(good + step, n);
        step *= 2;
    }
    for (; step > 0; step /= 2)
        if (good + step <= n && s.follows(first, good + step, tolerance))
            good += step;
    return good;
}

double valueAt(const Drive& drive, double t) {
    const auto after = std::upper_bound(drive.time.begin() + 1, drive.time.end() - 1, t);
    const std::size_t i = static_cast<std::size_t>(after - drive.time.begin());
    const double share = (t - drive.time[i - 1]) / (drive.time[i] - drive.time[i - 1]);
    return drive.displacement[i - 1] + share * (drive.displacement[i] - drive.displacement[i - 1]);
}

double largestDistance(const std::vector<double>& t, const std::vector<double>& d, const Drive& drive) {
    double most = 0.0;
    for (std::size_t i = 0; i < t.size(); ++i)
        if (std::isfinite(d[i]))
            most = std::max(most, std::abs(d[i] - valueAt(drive, t[i])));
    return most;
}

/// Line through the middle of a segment, away from corners.
DriveLine middleLine(const Samples& s, std::size_t first, std::size_t last) {
    const std::size_t off = (last - first) / 8;
    return s.fit(first + off, last - off);
}

/// Corners at the intersections of neighbouring lines; lines without one are joined by a step.
Drive cut(const Samples& s, const std::vector<std::size_t>& bounds, double tolerance) {
    Drive drive;
    std::vector<DriveLine> lines;
    for (std::size_t k = 0; k + 1 < bounds.size(); ++k)
        lines.push_back(middleLine(s, bounds[k], bounds[k + 1]));
    drive.time.push_back(s.t.front());
    drive.displacement.push_back(lines.front().at(s.t.front()));
    for (std::size_t k = 1; k < lines.size(); ++k) {
        const DriveLine &a = lines[k - 1], &b = lines[k];
        const double boundary = 0.5 * (s.t[bounds[k] - 1] + s.t[bounds[k]]);
        const double cutAt = boundary + (b.at(boundary) - a.at(boundary)) / (a.slope - b.slope);
        const bool meets = std::isfinite(cutAt) && cutAt > a.t0 && cutAt < b.t0;
        const double before = s.t[bounds[k] - 1], after = s.t[bounds[k]];
        if (!meets && std::abs(b.at(boundary) - a.at(boundary)) > tolerance && before > drive.time.back()) {
            drive.time.insert(drive.time.end(), {before, after}); // a step within one row
            drive.displacement.insert(drive.displacement.end(), {a.at(before), b.at(after)});
            continue;
        }
        const double t = std::max(meets ? cutAt : boundary, drive.time.back() + 1e-9);
        drive.time.push_back(t);
        drive.displacement.push_back(meets ? a.at(t) : 0.5 * (a.at(t) + b.at(t)));
    }
    drive.time.push_back(s.t.back());
    drive.displacement.push_back(lines.back().at(s.t.back()));
    return drive;
}

/// Removes corners that make no difference within the tolerance.
void dropIdle(Drive& drive, double tolerance) {
    for (std::size_t i = 1; i + 1 < drive.time.size();) {
        const double share = (drive.time[i] - drive.time[i - 1]) / (drive.time[i + 1] - drive.time[i - 1]);
        const double straight =
            drive.displacement[i - 1] + share * (drive.displacement[i + 1] - drive.displacement[i - 1]);
        if (std::abs(drive.displacement[i] - straight) > 0.25 * tolerance) {
            ++i;
            continue;
        }
        drive.time.erase(drive.time.begin() + static_cast<std::ptrdiff_t>(i));
        drive.displacement.erase(drive.displacement.begin() + static_cast<std::ptrdiff_t>(i));
    }
}

} // namespace

Drive findDrive(const std::vector<double>& time, const std::vector<double>& displacement, double tolerance) {
    const auto known = static_cast<std::size_t>(
        std::count_if(displacement.begin(), displacement.end(), [](double v) { return std::isfinite(v); }));
    const std::size_t every = known / kMost + 1; // lines locate corners, so fewer samples suffice
    std::vector<double> t, d;
    for (std::size_t i = 0, k = 0; i < time.size(); ++i)
        if (std::isfinite(displacement[i]) && (k++ % every == 0 || k == known)) {
            t.push_back(time[i]);
            d.push_back(displacement[i]);
        }
    const Samples s(std::move(t), std::move(d));
    double noise = 0.0, resolution = 0.0;
    roughness(s, noise, resolution);
    const auto [lo, hi] = std::minmax_element(s.d.begin(), s.d.end());
    const double size = std::max(std::abs(*lo), std::abs(*hi)); // its last digits are rounded
    const double usual = std::max({5.0 * noise, resolution, 5e-4 * (*hi - *lo), 1e-9 * size, 1e-12});
    const double wanted = tolerance > 0.0 ? tolerance : usual;
    std::vector<std::size_t> bounds{0};
    while (bounds.back() < s.t.size())
        bounds.push_back(reach(s, bounds.back(), wanted));
    if (bounds.size() > 2 && bounds.back() - bounds[bounds.size() - 2] < 2) // drops a last segment of one sample
        bounds.erase(bounds.end() - 2);
    Drive drive = cut(s, bounds, wanted);
    dropIdle(drive, wanted);
    drive.tolerance = wanted;
    drive.noise = noise;
    drive.largestDistance = largestDistance(time, displacement, drive);
    return drive;
}

} // namespace supercircle::importing
