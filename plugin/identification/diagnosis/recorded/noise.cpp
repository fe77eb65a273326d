#include "plugin/identification/diagnosis/noise.h"

#include "plugin/identification/diagnosis/likelihood/whitening.h"
#include "plugin/identification/diagnosis/model/random.h"
#include "plugin/identification/diagnosis/recorded/rests.h"
#include "plugin/identification/diagnosis/recorded/roughness.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

namespace supercircle::diagnosis {

namespace {

double markerNoiseOf(const Data& data) {
    std::vector<double> d;
    for (const RecordedRun& run : data.runs)
        for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount); ++c)
            for (std::size_t l = 0; l < run.legs.size(); ++l) { // only while the head rests: shapes bend elsewhere
                if (run.legs[l].phase != Phase::Hold)
                    continue;
                Eigen::Index from = 0, n = 0;
                for (Eigen::Index k = 0; k < run.markerTime.size(); ++k)
                    if (run.markerLeg[static_cast<std::size_t>(k)] == static_cast<int>(l)) {
                        from = n == 0 ? k : from;
                        ++n;
                    }
                const auto more = secondDifferences(run.markers, c * run.markerTime.size() + from, n);
                d.insert(d.end(), more.begin(), more.end());
            }
    const double measured = kMadToSigma * median(d) / std::sqrt(6.0), stated = data.statedMarkerNoise;
    double noise = d.size() < 30 && stated > 0.0 ? stated : measured > 0.0 ? measured : stated;
    std::vector<double> anywhere;
    double step = std::numeric_limits<double>::infinity(), apart = step;
    for (const RecordedRun& run : data.runs)
        for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount); ++c) {
            const auto track = run.markers.segment(c * run.markerTime.size(), run.markerTime.size());
            addFourthDifferences(track, anywhere);
            step = std::min(step, stepOf(track));
            apart = std::min(apart, smallestGap(track));
        }
    if (noise <= 0.0) // neither stated nor at rest: slow motions leave little in fourth differences
        noise = std::max(whiteOf(std::move(anywhere)), leastNoise(apart));
    return std::max(noise, leastNoise(step));
}

/// Whether what they read can be subtracted row by row.
bool repeats(const RecordedRun& a, const RecordedRun& b) {
    return sameDrive(a, b) && a.turned == b.turned && a.time.size() == b.time.size() && a.time.size() >= 20 &&
           (a.time - b.time).cwiseAbs().maxCoeff() < 1e-3;
}

/// Half the mean square of two runs' difference, its middle taken out. Without what lies beyond three deviations, at
/// least those of the sensor: snaps come a row earlier or later. (A median of absolute values alone says little of
/// readings in steps: it is a step, or the next one.)
double halfSquare(std::vector<double> difference, double sensor) {
    constexpr double kFar = 3.0, kInside = 0.9733; // mean square of a normal variable within three deviations
    const double middle = median(difference);
    std::vector<double> size;
    for (double& x : difference) {
        x -= middle;
        size.push_back(std::abs(x));
    }
    const double far = kFar * std::max(kMadToSigma * median(size), std::sqrt(2.0) * sensor);
    double sum = 0.0, rows = 0.0;
    for (const double x : difference)
        if (std::abs(x) <= far) {
            sum += x * x;
            rows += 1.0;
        }
    return rows > 0.0 ? 0.5 * sum / rows / kInside : 0.0;
}

/// Variance of halfSquare() of one pair times its rows, by the sensor's noise alone: that of a mean square, whose
/// memory makes fewer rows of it.
double varianceByRow(const Noise& n, double dt) {
    const double keep = std::exp(-2.0 * dt / n.memory), total = n.white * n.white + n.coloured * n.coloured;
    return 2.0 * (total * total + 2.0 * std::pow(n.coloured, 4) * keep / (1.0 - keep));
}

/// Of the noise's variance, by what the readings leave open of it.
double varianceOfSquare(const Noise& n) {
    double sum = 0.0, squares = 0.0;
    for (const Noise::Possible& p : n.possible) {
        const double v = p.white * p.white + p.coloured * p.coloured;
        sum += v;
        squares += v * v;
    }
    const double many = static_cast<double>(std::max<std::size_t>(1, n.possible.size()));
    return std::max(0.0, squares / many - sum * sum / (many * many));
}

/// Sets runToRun and repeats.
void fromRepeats(const Data& data, Noise& noise) {
    constexpr double kBeyond = 3.0; // deviations of what noise alone may seem to scatter by
    double sum = 0.0, rows = 0.0;   // over all pairs
    double open = 0.0, free = 0.0;  // over the runs that repeat another one: pairs of one drive have runs in common
    for (std::size_t b = 1; b < data.runs.size(); ++b) {
        double own = 0.0; // rows
        for (std::size_t a = 0; a < b; ++a) {
            if (!repeats(data.runs[a], data.runs[b]))
                continue;
            std::vector<double> d;
            for (Eigen::Index k = 0; k < data.runs[a].force.size(); ++k)
                if (const double x = data.runs[a].force[k] - data.runs[b].force[k]; std::isfinite(x))
                    d.push_back(x);
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

/// Equally spaced quantiles of a posterior on a grid.
std::vector<Noise::Possible> drawn(const std::vector<Noise::Possible>& grid, const std::vector<double>& logs,
                                   double most) {
    constexpr int kDraws = 111;
    double total = 0.0;
    for (const double l : logs)
        total += std::exp(l - most);
    std::vector<Noise::Possible> out;
    double before = 0.0;
    for (std::size_t k = 0; k < grid.size(); ++k) {
        before += std::exp(logs[k] - most) / total;
        while (static_cast<int>(out.size()) < kDraws && before > (static_cast<double>(out.size()) + 0.5) / kDraws)
            out.push_back(grid[k]);
    }
    return out;
}

/// Of poses nothing rests: white noise from fourth differences, the rest of what is stated remembers.
Noise freeNoise(const Data& data) {
    Noise out;
    out.marker = markerNoiseOf(data);
    std::vector<double> d;
    for (const RecordedRun& run : data.runs)
        addFourthDifferences(run.force, d);
    out.white = whiteOf(std::move(d));
    if (out.white <= 0.0)
        out.white = 0.5 * data.statedForceNoise;
    out.white = std::max(out.white, leastForceNoise(data, out.white > 0.0 ? stepOf : smallestGap));
    const double stated = data.statedForceNoise;
    out.coloured = std::max(0.55 * out.white, std::sqrt(std::max(0.0, stated * stated - out.white * out.white)));
    out.source = "fourth differences of neighbouring rows, and what is stated beyond them; nothing rests here and no "
                 "repeats were recorded";
    return out;
}

} // namespace

double Noise::total() const {
    return std::hypot(white, coloured);
}

Noise Noise::asWhite() const {
    Noise out = *this;
    out.white = total();
    out.coloured = 0.0;
    out.possible.clear();
    return out;
}

double Noise::ofMean(double span, double dt) const {
    if (span <= 0.0)
        return 0.0;
    const double x = span / memory;
    const double slow = 2.0 / x * (1.0 - (1.0 - std::exp(-x)) / x); // variance of the mean of an AR(1), continuous
    const double phase = swingPeriod > 0.0 ? M_PI * span / swingPeriod : 1.0;
    const double swung = 0.5 * swing * swing * std::pow(std::sin(phase) / phase, 2);
    return std::sqrt(white * white * dt / span + coloured * coloured * slow + swung);
}

namespace {

/// The most probable size, and how probable it is.
struct Sized {
    Noise noise;
    std::optional<Data> still; ///< without what swings
    double logLikelihood = -std::numeric_limits<double>::infinity();
    bool atEdge = false; ///< of the sizes that were looked at: the most probable one is another
};

/// Among sizes within a factor of 2.5 around `anchor`.
Sized sizeAround(double anchor, const std::vector<Rest>& rests, const std::vector<Roughness>& rough, double stated) {
    constexpr int kSizes = 30;
    Sized best;
    std::vector<Noise::Possible> grid;
    std::vector<double> logs;
    for (const double memory : {0.15, 0.25, 0.4})
        for (int i = -kSizes; i <= kSizes; ++i)
            for (int j = -12; j <= 12; ++j) {
                const double white = 0.9 * anchor * std::exp(0.03 * i);
                const double coloured = 0.55 * white * std::exp(0.08 * j);
                double l = 0.0;
                for (const Rest& q : rests)
                    l += restrictedLogLikelihood(q, white, coloured, memory);
                for (const Roughness& r : rough)
                    l += roughnessLogLikelihood(r, white, coloured, memory);
                const double off = stated > 0.0 ? std::log(std::hypot(white, coloured) / stated) / 0.2 : 0.0;
                const double ratio = 0.08 * j / 0.5;
                const double remembers = std::log(memory / 0.25) / 0.3;
                l -= 0.5 * (off * off + ratio * ratio + remembers * remembers);
                grid.push_back({white, coloured, memory});
                logs.push_back(l);
                if (l > best.logLikelihood) {
                    best.logLikelihood = l;
                    best.noise.white = white;
                    best.noise.coloured = coloured;
                    best.noise.memory = memory;
                    best.atEdge = std::abs(i) == kSizes;
                }
            }
    best.noise.possible = drawn(grid, logs, best.logLikelihood);
    best.noise.tails = tailsOf(rough);
    return best;
}

/// Where nothing is stated there must be something else to go by.
std::vector<Roughness> roughnessFor(const Data& data, double stated) {
    std::vector<Roughness> all = roughnessOf(data);
    if (all.empty() && stated <= 0.0)
        all.push_back(pooledRoughness(data));
    return all;
}

/// @param stated 0: not stated, or not believed; then sizes are looked at until the most probable one is among them
/// @param least smallest size
Sized sizeOf(const std::vector<Rest>& rests, const std::vector<Roughness>& rough, double stated, double least) {
    if (stated > 0.0)
        return sizeAround(stated, rests, rough, stated);
    constexpr int kMoves = 40; // a factor of 2.5 each: further than any sensor is from another
    Sized best;
    double anchor = rough.empty() ? 0.0 : rough.front().scale / std::sqrt(6.0);
    for (int moves = 0; moves < kMoves && anchor > 0.0; ++moves) {
        best = sizeAround(anchor, rests, rough, stated);
        if (!best.atEdge || best.noise.white <= least)
            break;
        anchor = best.noise.white / 0.9;
    }
    return best;
}

/// The same with a sine taken out, where the readings leave no doubt that there is one. Taken for noise, a disturbance
/// of 9 mN made noise of 2.3 mN four, and a strong effect, plain to the eye, was "nothing missing".
Sized withoutSwing(const Data& data, const std::vector<Rest>& rests, double stated, double least, Sized plain) {
    constexpr double kPeriods = 2.0; // that a run rests for
    const double price = priceOfSwing(data);
    const double white = std::max(plain.noise.white, 1e-300);
    const Swing swing = largestSwing(data, rests, {white, 0.55 * white, 0.25}, kPeriods);
    if (swing.explained < 2.0 * price)
        return plain;
    Data still = swing.takenOut(data);
    Sized other = sizeOf(restsOf(still), roughnessFor(still, stated), stated, least);
    if (other.logLikelihood < plain.logLikelihood + price)
        return plain;
    other.noise.swingPeriod = swing.period;
    other.noise.swing = swing.amplitude();
    other.still = std::move(still);
    return other;
}

/// Whether fourth differences lie to the same side of what is stated. Second differences alone are no witness: a sensor
/// may be so quiet that bends of the curve are all they show. That it is quieter than stated only rests tell: slow
/// noise leaves nothing between neighbours.
bool refutes(const Data& data, const std::vector<Rest>& rests, const Noise& found) {
    constexpr double kFactor = 1.5;
    std::vector<double> d;
    for (const Rest& q : rests)
        addFourthDifferences(q.force, d);
    for (const RecordedRun& run : data.runs)
        if (rests.empty())
            addFourthDifferences(run.force, d);
    const double white = whiteOf(std::move(d));
    return found.white > data.statedForceNoise ? white > kFactor * data.statedForceNoise
                                               : !rests.empty() && white < data.statedForceNoise / kFactor;
}

} // namespace

Noise estimateNoise(const Data& recorded, const Swing& seen) {
    if (recorded.free)
        return freeNoise(recorded);
    const Data data = seen.takenOut(recorded);
    const std::vector<Rest> rests = restsOf(data);
    const double least = leastForceNoise(data, stepOf);
    const auto sizedBy = [&](double stated) {
        return withoutSwing(data, rests, stated, least, sizeOf(rests, roughnessFor(data, stated), stated, least));
    };
    Sized sized = sizedBy(data.statedForceNoise);
    double stated = data.statedForceNoise;
    if (stated > 0.0 && sized.atEdge && refutes(data, rests, sized.noise))
        if (Sized other = sizedBy(0.0); other.noise.total() > 0.0) {
            sized = std::move(other);
            stated = 0.0;
        }
    Noise best = sized.noise;
    best.marker = markerNoiseOf(data);
    if (best.total() <= 0.0)
        return best;
    const bool inSteps = best.white < least;
    if (inSteps) {
        best.white = least;
        for (Noise::Possible& p : best.possible)
            p.white = std::max(p.white, least);
    }
    for (const Rest& q : rests)
        best.quietSeconds += q.time[q.time.size() - 1] - q.time[0];
    fromRepeats(sized.still ? *sized.still : data, best);
    char words[280];
    best.source.clear();
    if (!rests.empty()) {
        std::snprintf(words, sizeof words, "%.1f s of rest in %zu stretches and ", best.quietSeconds, rests.size());
        best.source = words;
    }
    best.source += "neighbouring rows of all runs";
    best.source += stated > 0.0 ? ", with the stated size as a prior; " : "; ";
    if (stated < data.statedForceNoise) {
        std::snprintf(words, sizeof words, "the stated noise of %.3g %s was found to be %.3g %s; ",
                      data.statedForceNoise, data.unit.c_str(), best.total(), data.unit.c_str());
        best.source += words;
    }
    if (best.repeats > 0 && best.runToRun > 0.0)
        std::snprintf(words, sizeof words, "%zu repeats scatter by %.3g N beyond it", best.repeats, best.runToRun);
    else if (best.repeats > 0)
        std::snprintf(words, sizeof words, "%zu repeats scatter by no more than it", best.repeats);
    else
        std::snprintf(words, sizeof words, "no repeats were recorded");
    best.source += words;
    if (inSteps) {
        std::snprintf(words, sizeof words, "; readings come in steps of %.3g %s, no smaller noise is believed",
                      least * std::sqrt(12.0), data.unit.c_str());
        best.source += words;
    }
    if (seen.period > 0.0) {
        best.swing = seen.amplitude();
        best.swingPeriod = seen.period;
        best.swingInMisfit = true;
    }
    if (best.swing > 0.0) {
        std::snprintf(words, sizeof words, "; a swing of %.3g N with a period of %.3g s, which %s, is none of it",
                      best.swing, best.swingPeriod, best.swingInMisfit ? "the misfit shows" : "rests show");
        best.source += words;
    }
    return best;
}

double mostSquares(const Data& data, const Noise& noise, std::uint64_t seed) {
    constexpr double kMore = 1.0 / 40.0;
    constexpr Eigen::Index kRows = 2000; // of a run; more say nothing new
    if (noise.possible.empty())
        return 1.0;
    std::vector<double> squares(noise.possible.size(), 0.0);
    double expected = 0.0;
    Random random(seed);
    for (const RecordedRun& run : data.runs) {
        const Eigen::VectorXd time = run.time.head(std::min(kRows, run.time.size()));
        const Whitening whitening(time, noise.white, noise.coloured, noise.memory);
        Eigen::VectorXd fast(time.size()), slow(time.size()); // the same numbers for all: what differs is their size
        for (Eigen::Index k = 0; k < time.size(); ++k) {
            fast[k] = random.normal();
            slow[k] = random.normal();
        }
        const auto whitened = [&](const Noise::Possible& p) {
            Eigen::VectorXd reading(time.size());
            double a = 0.0;
            for (Eigen::Index k = 0; k < time.size(); ++k) {
                const double keep = k > 0 ? std::exp(-(time[k] - time[k - 1]) / p.memory) : 0.0;
                a = keep * a + p.coloured * std::sqrt(1.0 - keep * keep) * slow[k];
                reading[k] = a + p.white * fast[k];
            }
            return whitening.apply(reading).squaredNorm();
        };
        expected += whitened({noise.white, noise.coloured, noise.memory});
        for (std::size_t i = 0; i < squares.size(); ++i)
            squares[i] += whitened(noise.possible[i]);
    }
    std::sort(squares.begin(), squares.end());
    const auto at = static_cast<std::size_t>((1.0 - kMore) * static_cast<double>(squares.size() - 1));
    return expected > 0.0 ? std::max(1.0, squares[at] / expected) : 1.0;
}

} // namespace supercircle::diagnosis
