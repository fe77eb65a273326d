#include "plugin/identification/diagnosis/recorded/repeats.h"

#include "plugin/identification/diagnosis/recorded/difference_scale.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace supercircle::diagnosis {

namespace {

using Eigen::Index;

/// By how much speeds of legs, dwells and turning points may differ. Half tells two settings of one machine apart that
/// drift by 1 % in a day; double takes 5 mm/s and 5.2 mm/s as repeats.
constexpr double kAlike = 0.02;
/// Least shared travel, of the shorter run's.
constexpr double kShared = 0.5;

/// A stroke as travel over time, both from its start; straight in between.
struct Leg {
    Phase phase = Phase::Hold;
    double start = 0.0; ///< s
    std::vector<double> time{0.0}, travel{0.0};
    [[nodiscard]] double length() const { return travel.back(); }
    [[nodiscard]] double duration() const { return time.back(); }
    [[nodiscard]] double travelAt(double t) const { return between(time, travel, t); }
    [[nodiscard]] double timeAt(double way) const { return between(travel, time, way); }

private:
    static double between(const std::vector<double>& x, const std::vector<double>& y, double at) {
        std::size_t i = 1;
        while (i + 1 < x.size() && x[i] < at)
            ++i;
        if (x.size() < 2 || x[i] <= x[i - 1])
            return y[std::min(i, y.size() - 1)];
        return y[i - 1] + (y[i] - y[i - 1]) * std::clamp((at - x[i - 1]) / (x[i] - x[i - 1]), 0.0, 1.0);
    }
};

/// The legs of a run from its first motion on.
std::vector<Leg> legsOf(const RecordedRun& run) {
    std::vector<Leg> all(run.strokes.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
        all[k].phase = run.strokes[k].phase;
        all[k].start = run.strokes[k].from;
    }
    for (const DriveSegment& s : run.segments) {
        Leg& leg = all[s.stroke];
        leg.time.push_back(s.to - leg.start);
        leg.travel.push_back(leg.travel.back() + std::abs(s.speed) * (s.to - s.from));
    }
    while (!all.empty() && all.front().phase == Phase::Hold)
        all.erase(all.begin());
    return all;
}

bool near(double a, double b) {
    return std::abs(a - b) <= kAlike * std::max(a, b);
}

/// Whether two legs of one direction are passed at the same speed as far as both go.
bool sameSpeed(const Leg& a, const Leg& b) {
    constexpr int kPoints = 8;
    const double way = std::min(a.length(), b.length()), all = std::max(a.timeAt(way), b.timeAt(way));
    for (int i = 1; i <= kPoints; ++i)
        if (const double at = way * i / kPoints; std::abs(a.timeAt(at) - b.timeAt(at)) > kAlike * all)
            return false;
    return true;
}

/// How far a leg of two runs is shared: m, or s of a dwell.
using Extents = std::vector<double>;

/// Of each leg that both begin; nothing if the runs are no repeats. They part where one ends or turns earlier.
std::optional<Extents> sharedExtents(const std::vector<Leg>& a, const std::vector<Leg>& b) {
    Extents out;
    double shared = 0.0, ofA = 0.0, ofB = 0.0;
    for (const Leg& leg : a)
        ofA += leg.length();
    for (const Leg& leg : b)
        ofB += leg.length();
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
        if (a[k].phase != b[k].phase)
            return std::nullopt;
        const bool dwells = a[k].phase == Phase::Hold;
        if (!dwells && !sameSpeed(a[k], b[k]))
            return std::nullopt;
        out.push_back(dwells ? std::min(a[k].duration(), b[k].duration()) : std::min(a[k].length(), b[k].length()));
        shared += dwells ? 0.0 : out.back();
        const bool last = k + 1 == std::min(a.size(), b.size());
        if (!(dwells ? near(a[k].duration(), b[k].duration()) : near(a[k].length(), b[k].length()))) {
            if (dwells && !last)
                return std::nullopt;
            break;
        }
    }
    const double shorter = std::min(ofA, ofB);
    return shorter > 0.0 && shared >= (1.0 - 1e-9) * kShared * shorter ? std::optional(out) : std::nullopt;
}

/// Whether their readings can be subtracted row by row.
bool sameRows(const RecordedRun& a, const RecordedRun& b) {
    return a.time.size() == b.time.size() && a.time.size() >= 20 &&
           (a.time - b.time).cwiseAbs().maxCoeff() < 1e-3 * a.units.time && identicalDrive(a, b);
}

/// Differences of the readings of two repeats. Where rows lie between those of the other run, white noise of the line
/// between these is smaller, and the difference is scaled to that of two rows.
std::vector<double> differencesOf(const RecordedRun& a, const RecordedRun& b) {
    std::vector<double> d;
    if (sameRows(a, b)) {
        for (Index k = 0; k < a.force.size(); ++k)
            if (const double x = a.force[k] - b.force[k]; std::isfinite(x))
                d.push_back(x);
        return d;
    }
    Index row = 0;
    for (const auto& [k, t] : sharedRows(a, b)) {
        while (row + 2 < b.time.size() && b.time[row + 1] < t)
            ++row;
        if (b.time.size() < 2 || t < b.time[row] || t > b.time[row + 1])
            continue;
        const double w = (t - b.time[row]) / (b.time[row + 1] - b.time[row]);
        const double x = a.force[k] - (1.0 - w) * b.force[row] - w * b.force[row + 1];
        if (std::isfinite(x))
            d.push_back(x * std::sqrt(2.0 / (1.0 + (1.0 - w) * (1.0 - w) + w * w)));
    }
    if (d.size() < 20)
        d.clear();
    return d;
}

/// Half the mean squared difference of two runs about its median, without outliers beyond three sigma (snaps one row
/// apart). A median of absolute values would be one or two quantisation steps.
double halfSquare(std::vector<double> difference, double sensor) {
    constexpr double kFar = 3.0, kInside = 0.9733; // mean square of a normal variable within three sigma
    const double middle = upperMedian(difference);
    std::vector<double> size;
    for (double& x : difference) {
        x -= middle;
        size.push_back(std::abs(x));
    }
    const double far = kFar * std::max(kMadToSigma * upperMedian(size), std::sqrt(2.0) * sensor);
    double sum = 0.0, rows = 0.0;
    for (const double x : difference)
        if (std::abs(x) <= far) {
            sum += x * x;
            rows += 1.0;
        }
    return rows > 0.0 ? 0.5 * sum / rows / kInside : 0.0;
}

/// Variance of halfSquare() of one pair times its rows for sensor noise alone. Correlation reduces the effective number
/// of rows.
double varianceByRow(const Noise& n, double dt) {
    const double keep = math::exp(-2.0 * dt / n.correlationTime),
                 total = n.white * n.white + n.correlated * n.correlated;
    return 2.0 * (total * total + 2.0 * math::pow(n.correlated, 4) * keep / (1.0 - keep));
}

/// Posterior variance of the noise variance.
double varianceOfSquare(const Noise& n) {
    double sum = 0.0, squares = 0.0;
    for (const Noise::PosteriorDraw& p : n.posterior) {
        const double v = p.white * p.white + p.correlated * p.correlated;
        sum += v;
        squares += v * v;
    }
    const double many = static_cast<double>(std::max<std::size_t>(1, n.posterior.size()));
    return std::max(0.0, squares / many - sum * sum / (many * many));
}

} // namespace

bool identicalDrive(const RecordedRun& a, const RecordedRun& b) {
    constexpr double kTime = 1e-6, kSpeed = 1e-7; // natural s, of the speed
    if (a.segments.size() != b.segments.size())
        return false;
    for (std::size_t l = 0; l < a.segments.size(); ++l)
        if (std::abs(a.segments[l].to - b.segments[l].to) > kTime * a.units.time ||
            std::abs(a.segments[l].speed - b.segments[l].speed) > kSpeed * std::abs(a.segments[l].speed))
            return false;
    return true;
}

bool sameDrive(const RecordedRun& a, const RecordedRun& b) {
    return identicalDrive(a, b) || sharedExtents(legsOf(a), legsOf(b)).has_value();
}

std::vector<std::pair<Eigen::Index, double>> sharedRows(const RecordedRun& a, const RecordedRun& b) {
    std::vector<std::pair<Eigen::Index, double>> out;
    const std::vector<Leg> ofA = legsOf(a), ofB = legsOf(b);
    const auto shared = sharedExtents(ofA, ofB);
    for (Index k = 0; shared && k < a.time.size(); ++k)
        for (std::size_t l = 0; l < shared->size(); ++l) {
            const double since = a.time[k] - ofA[l].start;
            if (since < 0.0 || since > ofA[l].duration())
                continue;
            const bool dwells = ofA[l].phase == Phase::Hold;
            const double at = dwells ? since : ofA[l].travelAt(since);
            if (at <= (*shared)[l])
                out.emplace_back(k, ofB[l].start + (dwells ? since : ofB[l].timeAt(at)));
            break;
        }
    return out;
}

void scatterOfRepeats(const RecordedData& data, Noise& noise) {
    constexpr double kBeyond = 3.0; // sigma of the scatter that noise alone produces
    double sum = 0.0, rows = 0.0;   // over all pairs
    double open = 0.0, free = 0.0;  // over repeated runs: pairs of one drive share runs
    for (std::size_t b = 1; b < data.runs.size(); ++b) {
        double own = 0.0; // rows
        for (std::size_t a = 0; a < b; ++a) {
            if (data.runs[a].specimenReversed != data.runs[b].specimenReversed ||
                data.runs[a].specimen != data.runs[b].specimen || !sameDrive(data.runs[a], data.runs[b]))
                continue;
            std::vector<double> d = differencesOf(data.runs[a], data.runs[b]);
            if (d.empty())
                continue;
            own = static_cast<double>(d.size());
            sum += own * halfSquare(std::move(d), noise.total());
            rows += own;
        }
        if (own > 0.0) {
            ++noise.repeats;
            open += own * varianceByRow(noise, data.runs[b].spacing());
            free += own;
        }
    }
    if (rows <= 0.0)
        return;
    const double excess = sum / rows - noise.total() * noise.total();
    if (excess > kBeyond * std::sqrt(open / (free * free) + varianceOfSquare(noise)))
        noise.runToRun = std::sqrt(excess);
}

} // namespace supercircle::diagnosis
