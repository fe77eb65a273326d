#include "plugin/identification/sensitivity/derivative.h"

#include "plugin/identification/sensitivity/noise.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::sensitivity {

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Rows = Eigen::Array<bool, Eigen::Dynamic, 1>;

constexpr double kFarthest = 1.0;           ///< natural s, jumps farther apart are different events
constexpr double kRingDown = 0.3;           ///< natural s after a jump in which the specimen may oscillate
constexpr double kLeastMarkerNoise = 1e-10; ///< natural m
constexpr double kLeastNoise = 1e-9;        ///< share of the largest force used as zero noise

double rms(const VectorXd& v, const Rows* rows = nullptr) {
    double sum = 0.0, count = 0.0;
    for (Index i = 0; i < v.size(); ++i) {
        if (!std::isfinite(v[i]) || (rows != nullptr && !(*rows)[i]))
            continue;
        sum += v[i] * v[i];
        count += 1.0;
    }
    return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

double largest(const VectorXd& v) {
    double most = 0.0;
    for (Index i = 0; i < v.size(); ++i)
        most = std::isfinite(v[i]) ? std::max(most, std::abs(v[i])) : most;
    return most;
}

void markRows(Rows& kept, const std::vector<double>& time, double from, double to) {
    for (std::size_t k = 0; k < time.size(); ++k)
        if (time[k] >= from && time[k] <= to)
            kept[static_cast<Index>(k)] = false;
}

VectorXd landmarkValues(const SimulatedValues& o) {
    return Eigen::Map<const VectorXd>(o.landmarks.values.data(), static_cast<Index>(o.landmarks.values.size()));
}

/// The two difference quotients of an observable, and the effect of computational noise on them and their difference.
struct DifferencePair {
    VectorXd whole, half;
};

struct Noises {
    double whole, half, difference;
};

template <class Take>
DifferencePair differences(const Probes& p, const SimulatedValues& base, Take&& take) {
    const double h = p.step;
    if (p.side == 0)
        return {(take(p.wholePlus) - take(p.wholeMinus)) / (2.0 * h), (take(p.halfPlus) - take(p.halfMinus)) / h};
    const SimulatedValues& whole = p.side > 0 ? p.wholePlus : p.wholeMinus;
    const SimulatedValues& half = p.side > 0 ? p.halfPlus : p.halfMinus;
    const double s = p.side;
    return {(take(whole) - take(base)) / (s * h), (take(half) - take(base)) / (0.5 * s * h)};
}

Noises noises(const Probes& p) {
    const double h = p.step;
    return p.side == 0 ? Noises{std::sqrt(0.5) / h, std::sqrt(2.0) / h, std::sqrt(2.5) / h}
                       : Noises{std::sqrt(2.0) / h, 2.0 * std::sqrt(2.0) / h, std::sqrt(6.0) / h};
}

/// Whether the derivative over the whole step is better. Truncation errors from the difference d of both: two-sided 4/3
/// d and 1/3 d (second order), one-sided 2 d and d (first order).
bool wholeIsBetter(const Probes& p, double difference, double noise) {
    const Noises n = noises(p);
    const double both = n.difference * noise;
    const double true2 = std::sqrt(std::max(0.0, difference * difference - both * both));
    return p.side == 0 ? 4.0 / 3.0 * true2 + n.whole * noise < true2 / 3.0 + n.half * noise
                       : 2.0 * true2 + n.whole * noise < true2 + n.half * noise;
}

/// Largest shift of a jump between the curves, in samples, and whether their numbers agree.
void checkJumps(const std::vector<const SimulatedValues*>& curves, const Landmarks& base, double sample,
                double farthest, Quality& q) {
    for (const SimulatedValues* c : curves) {
        const auto pairs = replay::matchLandmarks(base.jumps, c->landmarks.jumps, farthest);
        if (pairs.size() != base.jumps.size() || pairs.size() != c->landmarks.jumps.size())
            q.changesJumps = true;
        for (const auto& [i, j] : pairs)
            if (sample > 0.0)
                q.jumpShift = std::max(q.jumpShift, std::abs(base.jumps[i].time - c->landmarks.jumps[j].time) / sample);
    }
    q.changesJumps = q.changesJumps || q.jumpShift > 1.0;
}

std::vector<const SimulatedValues*> used(const Probes& p) {
    if (p.side > 0)
        return {&p.wholePlus, &p.halfPlus};
    if (p.side < 0)
        return {&p.wholeMinus, &p.halfMinus};
    return {&p.wholePlus, &p.halfPlus, &p.wholeMinus, &p.halfMinus};
}

/// Derivatives of landmarks, each with its better step and its own error.
void differentiateLandmarks(const Probes& p, const SimulatedValues& base, const RunNoise& noise, Derivative& d) {
    const DifferencePair pair = differences(p, base, landmarkValues);
    const Noises n = noises(p);
    d.landmarks.resize(pair.whole.size());
    d.landmarkError.resize(pair.whole.size());
    for (Index i = 0; i < pair.whole.size(); ++i) {
        const double own = i < noise.landmarks.size() && std::isfinite(noise.landmarks[i]) ? noise.landmarks[i] : 0.0;
        const double apart = std::abs(pair.whole[i] - pair.half[i]);
        const bool whole = wholeIsBetter(p, apart, own);
        d.landmarks[i] = whole ? pair.whole[i] : pair.half[i];
        d.landmarkError[i] = math::hypot(apart, (whole ? n.whole : n.half) * own);
    }
}

/// Excludes rows in which the two derivatives disagree.
void excludeRows(const DifferencePair& pair, const Noises& n, const RunNoise& noise, Derivative& d) {
    const double usual = rms(pair.half, &d.usable);
    for (Index i = 0; i < d.usable.size(); ++i) {
        const double own = std::max(noise.force[i], 0.3 * noise.forceRms);
        const bool apart = !(std::abs(pair.whole[i] - pair.half[i]) <= 0.5 * usual + 5.0 * n.difference * own);
        d.usable[i] = d.usable[i] && !apart;
    }
}

} // namespace

Rows awayFromJumps(const std::vector<const SimulatedValues*>& curves, const Landmarks& base,
                   const std::vector<double>& time, const experiment::NaturalUnits& units) {
    const double farthest = kFarthest * units.time, ringDown = kRingDown * units.time;
    Rows kept = Rows::Constant(static_cast<Index>(time.size()), true);
    const double ahead = 1.5 * experiment::medianStep(time);
    for (const replay::Landmark& jump : base.jumps)
        markRows(kept, time, jump.time - ahead, jump.time + ringDown);
    for (const SimulatedValues* c : curves) {
        std::vector<char> matched(c->landmarks.jumps.size(), 0);
        for (const auto& [i, j] : replay::matchLandmarks(base.jumps, c->landmarks.jumps, farthest)) {
            const double a = base.jumps[i].time, b = c->landmarks.jumps[j].time;
            markRows(kept, time, std::min(a, b) - ahead, std::max(a, b) + ringDown);
            matched[j] = 1;
        }
        for (std::size_t j = 0; j < matched.size(); ++j)
            if (!matched[j])
                markRows(kept, time, c->landmarks.jumps[j].time - ahead, c->landmarks.jumps[j].time + ringDown);
    }
    return kept;
}

RunNoise noiseOf(const std::vector<const SimulatedValues*>& curves, const Landmarks& base,
                 const std::vector<double>& time, const experiment::NaturalUnits& units) {
    RunNoise n;
    n.quiet = awayFromJumps(curves, base, time, units);
    const auto rough = [&](auto&& take, Index i) {
        std::vector<double> values;
        for (const SimulatedValues* c : curves)
            values.push_back(take(*c, i));
        return computationalNoise(values);
    };
    const SimulatedValues& first = *curves.front();
    std::vector<double> perRow(time.size(), kNone);
    for (std::size_t k = 0; k < time.size(); ++k)
        if (n.quiet[static_cast<Index>(k)])
            perRow[k] = rough([](const SimulatedValues& o, Index i) { return o.force[i]; }, static_cast<Index>(k));
    const double least = kLeastNoise * largest(first.force);
    n.forceRms = std::max(least, rms(Eigen::Map<const VectorXd>(perRow.data(), static_cast<Index>(perRow.size()))));
    const std::vector<double> smooth = smoothedRms(perRow, std::max<std::size_t>(2, time.size() / 40));
    n.force = Eigen::Map<const VectorXd>(smooth.data(), static_cast<Index>(smooth.size()));
    n.force = n.force.unaryExpr([&](double v) { return std::isfinite(v) ? std::max(v, least) : n.forceRms; });
    VectorXd markers(first.markers.size());
    for (Index i = 0; i < markers.size(); ++i)
        markers[i] = rough([](const SimulatedValues& o, Index k) { return o.markers[k]; }, i);
    // The median is robust against the few rows around a snap.
    std::vector<double> finite(markers.data(), markers.data() + markers.size());
    finite.erase(std::remove_if(finite.begin(), finite.end(), [](double v) { return !std::isfinite(v); }),
                 finite.end());
    if (!finite.empty())
        n.markerRms = std::max(upperMedian(std::move(finite)), kLeastMarkerNoise * units.length);
    n.landmarks.resize(static_cast<Index>(first.landmarks.values.size()));
    for (Index i = 0; i < n.landmarks.size(); ++i)
        n.landmarks[i] =
            rough([](const SimulatedValues& o, Index k) { return o.landmarks.values[static_cast<std::size_t>(k)]; }, i);
    return n;
}

Derivative derivativeOf(const Probes& p, const SimulatedValues& base, const experiment::Readings& readings,
                        const RunNoise& noise, const SensitivitySettings& settings,
                        const experiment::NaturalUnits& units) {
    Derivative d;
    Quality& q = d.quality;
    q.step = p.step;
    q.oneSided = p.side != 0;
    const std::vector<const SimulatedValues*> curves = used(p);
    checkJumps(curves, base.landmarks, experiment::medianStep(readings.time), kFarthest * units.time, q);
    d.usable = noise.quiet && awayFromJumps(curves, base.landmarks, readings.time, units);

    const DifferencePair force =
        differences(p, base, [](const SimulatedValues& o) -> const VectorXd& { return o.force; });
    const DifferencePair markers =
        differences(p, base, [](const SimulatedValues& o) -> const VectorXd& { return o.markers; });
    const Noises n = noises(p);
    const VectorXd apart = force.whole - force.half;
    const double size = rms(force.half, &d.usable), difference = rms(apart, &d.usable);
    q.signal = size / (n.half * noise.forceRms);
    q.markerSignal = noise.markerRms > 0.0 ? rms(markers.half) / (n.half * noise.markerRms) : 0.0;
    q.belowNoise = q.signal < settings.smallestSignal;
    q.markersBelowNoise = q.markerSignal < settings.smallestSignal;
    const double both = n.difference * noise.forceRms;
    q.twoStepError = size > 0.0 ? std::sqrt(std::max(0.0, difference * difference - both * both)) / size : 0.0;
    d.forceDisagreement = size > 0.0 ? difference / size : 0.0;
    const bool whole = wholeIsBetter(p, difference, noise.forceRms);
    q.noiseError = size > 0.0 ? (whole ? n.whole : n.half) * noise.forceRms / size : 0.0;
    d.force = whole ? force.whole : force.half;
    d.markers = whole ? markers.whole : markers.half;
    excludeRows(force, n, noise, d);
    differentiateLandmarks(p, base, noise, d);
    return d;
}

} // namespace supercircle::sensitivity
