#include "plugin/identification/diagnosis/recorded/difference_scale.h"

#include "supercircle/support/elementary.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supercircle::diagnosis {

std::vector<double> secondDifferences(const Eigen::VectorXd& v, Eigen::Index from, Eigen::Index n) {
    std::vector<double> d;
    for (Eigen::Index k = from; k + 2 < from + n; ++k)
        if (const double x = std::abs(v[k + 2] - 2.0 * v[k + 1] + v[k]); std::isfinite(x))
            d.push_back(x);
    return d;
}

namespace {

/// Gaps between neighbouring distinct readings, beyond round-off.
std::vector<double> gapsOf(const Eigen::Ref<const Eigen::VectorXd>& v) {
    std::vector<double> sorted, gaps;
    for (const double x : v)
        if (std::isfinite(x))
            sorted.push_back(x);
    std::sort(sorted.begin(), sorted.end());
    const double digits = sorted.empty() ? 0.0 : 1e-12 * std::max(-sorted.front(), sorted.back());
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (const double gap = sorted[i] - sorted[i - 1]; gap > digits)
            gaps.push_back(gap);
    return gaps;
}

constexpr double kFourthSquares = 70.0; ///< of the weights: 1 + 16 + 36 + 16 + 1

} // namespace

void addFourthDifferences(const Eigen::Ref<const Eigen::VectorXd>& v, std::vector<double>& to) {
    for (Eigen::Index k = 2; k + 2 < v.size(); ++k)
        if (const double x = std::abs(v[k - 2] - 4.0 * v[k - 1] + 6.0 * v[k] - 4.0 * v[k + 1] + v[k + 2]);
            std::isfinite(x))
            to.push_back(x);
}

double whiteStdOf(std::vector<double> fourthDifferences) {
    return kMadToSigma * upperMedian(std::move(fourthDifferences)) / std::sqrt(kFourthSquares);
}

double smallestGap(const Eigen::Ref<const Eigen::VectorXd>& v) {
    const std::vector<double> gaps = gapsOf(v);
    return gaps.empty() ? std::numeric_limits<double>::infinity() : *std::min_element(gaps.begin(), gaps.end());
}

double quantisationStep(const Eigen::Ref<const Eigen::VectorXd>& v) {
    constexpr double kNone = std::numeric_limits<double>::infinity(), kOff = 0.1; // of a step, rounding in the file
    constexpr std::size_t kFewest = 5;                                            // fewer distinct values prove nothing
    const std::vector<double> apart = gapsOf(v);
    if (apart.size() + 1 < kFewest || 2 * (apart.size() + 1) > static_cast<std::size_t>(v.size()))
        return kNone;
    const double least = *std::min_element(apart.begin(), apart.end());
    const bool multiples = std::all_of(apart.begin(), apart.end(),
                                       [&](double d) { return std::abs(d / least - std::round(d / least)) < kOff; });
    return multiples ? least : kNone;
}

double quantisationNoise(double step) {
    return std::isfinite(step) ? step / std::sqrt(12.0) : 0.0;
}

double quantisationForceNoise(const RecordedData& data, double (*size)(const Eigen::Ref<const Eigen::VectorXd>&)) {
    double step = std::numeric_limits<double>::infinity();
    for (const RecordedRun& run : data.runs)
        step = std::min(step, size(run.force));
    return quantisationNoise(step);
}

namespace {

/// Absolute second or fourth differences of rows [from, from + n).
std::vector<double> differencesOf(const Eigen::VectorXd& v, Eigen::Index from, Eigen::Index n, DifferenceOrder order) {
    if (order == DifferenceOrder::Second)
        return secondDifferences(v, from, n);
    std::vector<double> d;
    addFourthDifferences(v.segment(from, n), d);
    return d;
}

/// Scale of differences, without half natural seconds that exceed the median energy 3.5 times (snaps). A median
/// absolute deviation would underestimate heavy tails by 10 %.
DifferenceScale differenceScale(const RecordedRun& run, DifferenceOrder order) {
    constexpr double kTooRough = 3.5;
    const Eigen::Index width = order == DifferenceOrder::Second ? 2 : 4;
    DifferenceScale out;
    out.dt = (run.time[run.time.size() - 1] - run.time[0]) / static_cast<double>(run.time.size() - 1);
    const auto block = std::max<Eigen::Index>(10, std::lround(0.5 * run.units.time / out.dt + 1e-6)); // ties up
    std::vector<double> energies, counts, each, fourths;
    for (Eigen::Index from = 0; from + width < run.force.size(); from += block) {
        const std::vector<double> d =
            differencesOf(run.force, from, std::min(block + width, run.force.size() - from), order);
        double sum = 0.0, fourth = 0.0;
        for (const double x : d) {
            sum += x * x;
            fourth += x * x * x * x;
        }
        if (2 * static_cast<Eigen::Index>(d.size()) < block)
            continue;
        counts.push_back(static_cast<double>(d.size()));
        energies.push_back(sum);
        fourths.push_back(fourth);
        each.push_back(sum / counts.back());
    }
    const double most = kTooRough * upperMedian(each);
    double sum = 0.0;
    for (std::size_t k = 0; k < each.size(); ++k)
        if (each[k] <= most) {
            sum += energies[k];
            out.fourth += fourths[k];
            out.count += counts[k];
        }
    out.scale = out.count > 0.0 ? std::sqrt(sum / out.count) : 0.0;
    out.fourth /= std::max(1e-300, out.scale * out.scale * out.scale * out.scale);
    return out;
}

} // namespace

std::vector<DifferenceScale> differenceScaleOf(const RecordedData& data, DifferenceOrder order) {
    std::vector<DifferenceScale> all;
    for (const RecordedRun& run : data.runs)
        if (run.time.size() > 22)
            if (const DifferenceScale r = differenceScale(run, order); r.count > 20.0 && r.scale > 0.0)
                all.push_back(r);
    return all;
}

DifferenceScale pooledDifferenceScale(const RecordedData& data) {
    DifferenceScale out;
    std::vector<double> d;
    for (const RecordedRun& run : data.runs) {
        addFourthDifferences(run.force, d);
        out.dt = std::max(out.dt, run.spacing());
    }
    out.count = std::max(1.0, static_cast<double>(d.size()));
    out.scale = std::sqrt(6.0) * std::max(quantisationForceNoise(data, smallestGap), whiteStdOf(std::move(d)));
    out.fourth = 3.0 * out.count; // of a normal distribution: too few rows for tails
    return out;
}

double whiteStdOf(const std::vector<DifferenceScale>& fourthDifferences) {
    double sum = 0.0, count = 0.0;
    for (const DifferenceScale& r : fourthDifferences) {
        sum += r.count * r.scale * r.scale;
        count += r.count;
    }
    return count > 0.0 ? std::sqrt(sum / count / kFourthSquares) : 0.0;
}

double excessKurtosisOf(const std::vector<DifferenceScale>& scales, DifferenceOrder order) {
    // (sum of w^2)^2 / sum of w^4 of the weights w, and the sum of fourth powers of the correlations of differences.
    const bool second = order == DifferenceOrder::Second;
    const double diluted = second ? 36.0 / 18.0 : 4900.0 / 1810.0, alike = second ? 1.4 : 1.87;
    double sum = 0.0, count = 0.0;
    for (const DifferenceScale& r : scales) {
        sum += r.fourth;
        count += r.count;
    }
    if (count <= 0.0)
        return 0.0;
    const double excess = sum / count - 3.0;
    return excess > 3.0 * std::sqrt(24.0 * alike / count) ? std::min(6.0, diluted * excess) : 0.0;
}

double differenceScaleLogLikelihood(const DifferenceScale& r, double white, double correlated, double correlationTime) {
    const double phi = math::exp(-r.dt / correlationTime);
    const double expected =
        std::sqrt(6.0 * white * white + correlated * correlated * (6.0 - 8.0 * phi + 2.0 * phi * phi));
    // The logarithm of a scale from n correlated heavy-tailed values has a standard deviation of about 1.5 / sqrt(n);
    // curvature of the signal adds a few per cent.
    const double sigma = math::hypot(1.5 / std::sqrt(r.count), 0.03);
    const double z = math::log(r.scale / expected) / sigma;
    return -0.5 * z * z;
}

} // namespace supercircle::diagnosis
