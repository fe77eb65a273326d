#include "plugin/identification/diagnosis/noise.h"

#include "plugin/identification/diagnosis/likelihood/whitening.h"
#include "plugin/identification/diagnosis/model/random.h"
#include "plugin/identification/diagnosis/recorded/difference_scale.h"
#include "plugin/identification/diagnosis/recorded/dwell_intervals.h"
#include "plugin/identification/diagnosis/recorded/repeats.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

namespace supercircle::diagnosis {

namespace {

double markerNoiseOf(const RecordedData& data) {
    std::vector<double> d;
    for (const RecordedRun& run : data.runs)
        for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount); ++c)
            for (std::size_t l = 0; l < run.segments.size(); ++l) { // only in dwell intervals: shapes change elsewhere
                if (run.segments[l].phase != Phase::Hold)
                    continue;
                Eigen::Index from = 0, n = 0;
                for (Eigen::Index k = 0; k < run.markerTime.size(); ++k)
                    if (run.segmentOfMarkerRow[static_cast<std::size_t>(k)] == static_cast<int>(l)) {
                        from = n == 0 ? k : from;
                        ++n;
                    }
                const auto more = secondDifferences(run.markers, c * run.markerTime.size() + from, n);
                d.insert(d.end(), more.begin(), more.end());
            }
    const double measured = kMadToSigma * upperMedian(d) / std::sqrt(6.0), stated = data.statedMarkerNoise;
    double noise = d.size() < 30 && stated > 0.0 ? stated : measured > 0.0 ? measured : stated;
    std::vector<double> anywhere;
    double step = std::numeric_limits<double>::infinity(), apart = step;
    for (const RecordedRun& run : data.runs)
        for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount); ++c) {
            const auto track = run.markers.segment(c * run.markerTime.size(), run.markerTime.size());
            addFourthDifferences(track, anywhere);
            step = std::min(step, quantisationStep(track));
            apart = std::min(apart, smallestGap(track));
        }
    if (noise <= 0.0) // neither stated nor measured at rest: slow motions hardly affect fourth differences
        noise = std::max(whiteStdOf(std::move(anywhere)), quantisationNoise(apart));
    return std::max(noise, quantisationNoise(step));
}

/// Equally spaced quantiles of a posterior on a grid.
std::vector<Noise::PosteriorDraw> drawn(const std::vector<Noise::PosteriorDraw>& grid, const std::vector<double>& logs,
                                        double most) {
    constexpr int kDraws = 111;
    double total = 0.0;
    for (const double l : logs)
        total += math::exp(l - most);
    std::vector<Noise::PosteriorDraw> out;
    double before = 0.0;
    for (std::size_t k = 0; k < grid.size(); ++k) {
        before += math::exp(logs[k] - most) / total;
        while (static_cast<int>(out.size()) < kDraws && before > (static_cast<double>(out.size()) + 0.5) / kDraws)
            out.push_back(grid[k]);
    }
    return out;
}

/// Noise of free runs, which have no dwell intervals: white noise from fourth differences, the rest of the stated noise
/// is correlated.
Noise freeNoise(const RecordedData& data) {
    Noise out;
    out.marker = markerNoiseOf(data);
    out.correlationTime = data.usualCorrelationTime();
    const std::vector<DifferenceScale> scales = differenceScaleOf(data, DifferenceOrder::Fourth);
    out.white = whiteStdOf(scales);
    out.excessKurtosis = excessKurtosisOf(scales, DifferenceOrder::Fourth);
    if (scales.empty()) {
        std::vector<double> d;
        for (const RecordedRun& run : data.runs)
            addFourthDifferences(run.force, d);
        out.white = whiteStdOf(std::move(d));
    }
    if (out.white <= 0.0)
        out.white = 0.5 * data.statedForceNoise;
    out.white = std::max(out.white, quantisationForceNoise(data, out.white > 0.0 ? quantisationStep : smallestGap));
    const double stated = data.statedForceNoise;
    out.correlated = std::max(0.55 * out.white, std::sqrt(std::max(0.0, stated * stated - out.white * out.white)));
    out.source =
        "fourth differences of neighbouring rows, with the stated noise as an upper bound; free runs have no dwell "
        "intervals, and no repeats were recorded";
    return out;
}

/// Noise of tables: neighbouring rows are too far apart to show it, and without a clock none is correlated.
Noise tableNoise(const RecordedData& data) {
    Noise out;
    out.marker = markerNoiseOf(data);
    out.correlationTime = data.usualCorrelationTime();
    out.white = data.statedForceNoise;
    out.source = "as stated; the rows of a table do not show it";
    return out;
}

} // namespace

double Noise::total() const {
    return math::hypot(white, correlated);
}

Noise Noise::asWhite() const {
    Noise out = *this;
    out.white = total();
    out.correlated = 0.0;
    out.posterior.clear();
    for (Noise& n : out.further)
        n = n.asWhite();
    return out;
}

double Noise::stdOfMean(double span, double dt) const {
    if (span <= 0.0)
        return 0.0;
    const double x = span / correlationTime;
    const double slow = 2.0 / x * (1.0 - (1.0 - math::exp(-x)) / x); // variance of the mean of an AR(1), continuous
    const double phase = disturbancePeriod > 0.0 ? M_PI * span / disturbancePeriod : 1.0;
    const double swung = 0.5 * disturbance * disturbance * math::pow(math::sin(phase) / phase, 2);
    return std::sqrt(white * white * dt / span + correlated * correlated * slow + swung);
}

namespace {

/// The most probable noise and its likelihood.
struct NoiseEstimate {
    Noise noise;
    std::optional<RecordedData> still; ///< recordings without the disturbance
    double logLikelihood = -std::numeric_limits<double>::infinity();
    bool atGridEdge = false; ///< the maximum lies at the end of the grid
};

/// Among sizes within a factor of 2.5 around `anchor`.
/// @param usual correlation time, s
NoiseEstimate estimateAround(double anchor, const std::vector<DwellInterval>& dwells,
                             const std::vector<DifferenceScale>& scales, double stated, double usual,
                             const StopToken& stop) {
    constexpr int kSizes = 30;
    NoiseEstimate best;
    std::vector<Noise::PosteriorDraw> grid;
    std::vector<double> logs;
    for (const double times : {0.6, 1.0, 1.6})
        for (int i = -kSizes; i <= kSizes; ++i) {
            if (stop.interrupted())
                throw Stopped{};
            for (int j = -12; j <= 12; ++j) {
                const double correlationTime = times * usual;
                const double white = 0.9 * anchor * math::exp(0.03 * i);
                const double correlated = 0.55 * white * math::exp(0.08 * j);
                double l = 0.0;
                for (const DwellInterval& q : dwells)
                    l += restrictedLogLikelihood(q, white, correlated, correlationTime);
                for (const DifferenceScale& r : scales)
                    l += differenceScaleLogLikelihood(r, white, correlated, correlationTime);
                const double off = stated > 0.0 ? math::log(math::hypot(white, correlated) / stated) / 0.2 : 0.0;
                const double ratio = 0.08 * j / 0.5;
                const double remembers = math::log(times) / 0.3;
                l -= 0.5 * (off * off + ratio * ratio + remembers * remembers);
                grid.push_back({white, correlated, correlationTime});
                logs.push_back(l);
                if (l > best.logLikelihood) {
                    best.logLikelihood = l;
                    best.noise.white = white;
                    best.noise.correlated = correlated;
                    best.noise.correlationTime = correlationTime;
                    best.atGridEdge = std::abs(i) == kSizes;
                }
            }
        }
    best.noise.posterior = drawn(grid, logs, best.logLikelihood);
    best.noise.excessKurtosis = excessKurtosisOf(scales);
    return best;
}

/// Difference scales; pooled over all runs where nothing is stated and no run has enough rows.
std::vector<DifferenceScale> differenceScalesFor(const RecordedData& data, double stated) {
    std::vector<DifferenceScale> all = differenceScaleOf(data);
    if (all.empty() && stated <= 0.0)
        all.push_back(pooledDifferenceScale(data));
    return all;
}

/// @param stated N; 0: not stated or dropped; then the grid moves until the maximum lies inside
/// @param least smallest white noise, N
NoiseEstimate estimateSize(const std::vector<DwellInterval>& dwells, const std::vector<DifferenceScale>& scales,
                           double stated, double least, double usual, const StopToken& stop) {
    if (stated > 0.0)
        return estimateAround(stated, dwells, scales, stated, usual, stop);
    constexpr int kMoves = 40; // a factor of 2.5 each
    NoiseEstimate best;
    double anchor = scales.empty() ? 0.0 : scales.front().scale / std::sqrt(6.0);
    for (int moves = 0; moves < kMoves && anchor > 0.0; ++moves) {
        best = estimateAround(anchor, dwells, scales, stated, usual, stop);
        if (!best.atGridEdge || best.noise.white <= least)
            break;
        anchor = best.noise.white / 0.9;
    }
    return best;
}

/// The same with a periodic disturbance removed, where there is no doubt of one. Otherwise it counts as noise and hides
/// itself (decision 0071).
NoiseEstimate withoutDisturbance(const RecordedData& data, const std::vector<DwellInterval>& dwells, double stated,
                                 double least, NoiseEstimate plain, const StopToken& stop) {
    constexpr double kPeriods = 2.0; // periods in the dwell intervals of one run, at least
    const double price = disturbancePenalty(data);
    const double white = std::max(plain.noise.white, 1e-300);
    const PeriodicDisturbance disturbance =
        strongestDisturbance(data, dwells, {white, 0.55 * white, data.usualCorrelationTime()}, kPeriods);
    if (disturbance.explained < 2.0 * price)
        return plain;
    RecordedData still = disturbance.removedFrom(data);
    NoiseEstimate other = estimateSize(dwellIntervalsOf(still), differenceScalesFor(still, stated), stated, least,
                                       still.usualCorrelationTime(), stop);
    if (other.logLikelihood < plain.logLikelihood + price)
        return plain;
    other.noise.disturbancePeriod = disturbance.period;
    other.noise.disturbance = disturbance.amplitude();
    other.still = std::move(still);
    return other;
}

/// Whether fourth differences contradict the stated noise in the same direction. Second differences may only show the
/// curvature of the signal. A smaller noise than stated needs dwell intervals, because slow noise leaves nothing
/// between neighbours.
bool refutes(const RecordedData& data, const std::vector<DwellInterval>& dwells, const Noise& found) {
    constexpr double kFactor = 1.5;
    std::vector<double> d;
    for (const DwellInterval& q : dwells)
        addFourthDifferences(q.force, d);
    for (const RecordedRun& run : data.runs)
        if (dwells.empty())
            addFourthDifferences(run.force, d);
    const double white = whiteStdOf(std::move(d));
    return found.white > data.statedForceNoise ? white > kFactor * data.statedForceNoise
                                               : !dwells.empty() && white < data.statedForceNoise / kFactor;
}

/// Noise of the first channel.
Noise estimateChannel(const RecordedData& recorded, const PeriodicDisturbance& known, const StopToken& stop) {
    if (recorded.free)
        return freeNoise(recorded);
    if (recorded.table)
        return tableNoise(recorded);
    const RecordedData all = known.removedFrom(recorded), data = levelsApart(all);
    const std::vector<DwellInterval> dwells = dwellIntervalsOf(data);
    const double least = quantisationForceNoise(all, quantisationStep);
    const auto estimateWith = [&](double stated) {
        return withoutDisturbance(
            data, dwells, stated, least,
            estimateSize(dwells, differenceScalesFor(data, stated), stated, least, data.usualCorrelationTime(), stop),
            stop);
    };
    NoiseEstimate estimate = estimateWith(data.statedForceNoise);
    double stated = data.statedForceNoise;
    if (stated > 0.0 && estimate.atGridEdge && refutes(data, dwells, estimate.noise))
        if (NoiseEstimate other = estimateWith(0.0); other.noise.total() > 0.0) {
            estimate = std::move(other);
            stated = 0.0;
        }
    Noise best = estimate.noise;
    best.marker = markerNoiseOf(data);
    if (best.total() <= 0.0)
        return best;
    const bool inSteps = best.white < least;
    if (inSteps) {
        best.white = least;
        for (Noise::PosteriorDraw& p : best.posterior)
            p.white = std::max(p.white, least);
    }
    for (const DwellInterval& q : dwells)
        best.dwellSeconds += q.time[q.time.size() - 1] - q.time[0];
    scatterOfRepeats(estimate.still ? *estimate.still : all, best);
    char words[280];
    best.source.clear();
    if (!dwells.empty()) {
        std::snprintf(words, sizeof words, "%.1f s in %zu dwell intervals and ", best.dwellSeconds, dwells.size());
        best.source = words;
    }
    best.source += "neighbouring rows of all runs";
    best.source += stated > 0.0 ? ", with the stated noise as a prior; " : "; ";
    if (stated < data.statedForceNoise) {
        std::snprintf(words, sizeof words, "the stated noise of %.3g %s is contradicted by %.3g %s; ",
                      data.statedForceNoise, data.unit.c_str(), best.total(), data.unit.c_str());
        best.source += words;
    }
    if (best.repeats > 0 && best.runToRun > 0.0)
        std::snprintf(words, sizeof words, "%zu repeats scatter by a further %.3g N", best.repeats, best.runToRun);
    else if (best.repeats > 0)
        std::snprintf(words, sizeof words, "%zu repeats show no further scatter", best.repeats);
    else
        std::snprintf(words, sizeof words, "no repeats were recorded");
    best.source += words;
    if (inSteps) {
        std::snprintf(words, sizeof words, "; the quantisation step of %.3g %s bounds the noise from below",
                      least * std::sqrt(12.0), data.unit.c_str());
        best.source += words;
    }
    if (known.period > 0.0) {
        best.disturbance = known.amplitude();
        best.disturbancePeriod = known.period;
        best.disturbanceInResidual = true;
    }
    if (best.disturbance > 0.0) {
        std::snprintf(
            words, sizeof words, "; a periodic disturbance of %.3g N with a period of %.3g s, found in %s, is excluded",
            best.disturbance, best.disturbancePeriod, best.disturbanceInResidual ? "the residual" : "dwell intervals");
        best.source += words;
    }
    return best;
}

} // namespace

Noise estimateNoise(const RecordedData& recorded, const PeriodicDisturbance& known, const StopToken& stop) {
    Noise out = estimateChannel(recorded, known, stop);
    for (std::size_t c = 0; c < recorded.further.size(); ++c)
        out.further.push_back(estimateChannel(recorded.withChannel(c), {}, stop));
    return out;
}

double noiseChiSquaredBound(const RecordedData& data, const Noise& noise, std::uint64_t seed) {
    constexpr double kMore = 1.0 / 40.0;
    constexpr Eigen::Index kRows = 2000; // of a run; more add nothing
    if (noise.posterior.empty())
        return 1.0;
    std::vector<double> squares(noise.posterior.size(), 0.0);
    double expected = 0.0;
    Random random(seed);
    for (const RecordedRun& run : data.runs) {
        const Eigen::VectorXd time = run.time.head(std::min(kRows, run.time.size()));
        const Whitening whitening(time, noise.white, noise.correlated, noise.correlationTime);
        Eigen::VectorXd fast(time.size()), slow(time.size()); // common random numbers for all draws
        for (Eigen::Index k = 0; k < time.size(); ++k) {
            fast[k] = random.normal();
            slow[k] = random.normal();
        }
        const auto whitened = [&](const Noise::PosteriorDraw& p) {
            Eigen::VectorXd reading(time.size());
            double a = 0.0;
            for (Eigen::Index k = 0; k < time.size(); ++k) {
                const double keep = k > 0 ? math::exp(-(time[k] - time[k - 1]) / p.correlationTime) : 0.0;
                a = keep * a + p.correlated * std::sqrt(1.0 - keep * keep) * slow[k];
                reading[k] = a + p.white * fast[k];
            }
            return whitening.apply(reading).squaredNorm();
        };
        expected += whitened({noise.white, noise.correlated, noise.correlationTime});
        for (std::size_t i = 0; i < squares.size(); ++i)
            squares[i] += whitened(noise.posterior[i]);
    }
    return expected > 0.0 ? std::max(1.0, lowerQuantile(std::move(squares), 1.0 - kMore) / expected) : 1.0;
}

} // namespace supercircle::diagnosis
