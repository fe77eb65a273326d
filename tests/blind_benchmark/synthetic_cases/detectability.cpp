#include "tests/blind_benchmark/synthetic_cases/detectability.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace supercircle::blind_benchmark {

namespace {

constexpr double kSettle = 2.0; ///< s

std::vector<Vec2> interpolated(const Trace& trace, const std::vector<Vec2>& path, const std::vector<double>& times) {
    std::vector<Vec2> out;
    for (const double t : times) {
        const auto after = std::upper_bound(trace.time.begin(), trace.time.end(), t);
        const auto i = static_cast<std::size_t>(
            std::clamp<long>(after - trace.time.begin(), 1, static_cast<long>(trace.time.size()) - 1));
        const double share = std::clamp((t - trace.time[i - 1]) / (trace.time[i] - trace.time[i - 1]), 0.0, 1.0);
        out.push_back((1.0 - share) * path[i - 1] + share * path[i]);
    }
    return out;
}

/// Times at which the drive turns, starts or stops, s.
std::vector<double> turningPoints(const Drive& drive) {
    const auto direction = [&](std::size_t i) {
        const double way = drive.displacement[i + 1] - drive.displacement[i];
        return (way > 0.0) - (way < 0.0);
    };
    std::vector<double> out;
    for (std::size_t i = 1; i + 1 < drive.time.size(); ++i)
        if (direction(i - 1) != direction(i))
            out.push_back(drive.time[i]);
    return out;
}

} // namespace

std::vector<std::pair<double, double>> excludedIntervals(const RunPlan& run,
                                                         const Eigen::Ref<const Eigen::VectorXd>& force) {
    constexpr double kJump = 6.0;            // noise standard deviations from one reading to the next,
    constexpr double kSteeper = 4.0;         // and this many times the change between its neighbours
    constexpr double kTurningReadings = 1.5; // readings
    const std::vector<double> times = run.times(run.sampling), turningTimes = turningPoints(run.drive);
    const double step = 1.0 / run.sampling;
    std::vector<std::pair<double, double>> excluded;
    for (const double t : turningTimes)
        excluded.emplace_back(t - kTurningReadings * step, t + kTurningReadings * step);
    const auto change = [&](Eigen::Index i) {
        return i >= 0 && i + 1 < force.size() ? std::abs(force[i + 1] - force[i]) : 0.0;
    };
    for (Eigen::Index i = 0; i + 1 < force.size(); ++i) {
        if (change(i) < std::max(kJump, kSteeper * std::max(change(i - 2), change(i + 2))))
            continue;
        const double from = times[static_cast<std::size_t>(i)], to = times[static_cast<std::size_t>(i + 1)];
        const bool atTurningPoint = std::any_of(turningTimes.begin(), turningTimes.end(),
                                                [&](double t) { return t > from - 0.5 * step && t < to + 0.5 * step; });
        if (!atTurningPoint)
            excluded.emplace_back(from - 0.1, to + 0.3);
    }
    return excluded;
}

Resolution coarseResolution(std::size_t rods) {
    Resolution r;
    r.edges = rods > 1 ? 40 : 60;
    r.travel = rods > 1 ? 1.2e-4 : 8e-5;
    return r;
}

Resolution finer(double factor) {
    Resolution r;
    r.edges = static_cast<int>(std::lround(factor * r.edges));
    r.travel /= factor;
    r.longest /= factor;
    r.contact.stiffness *= factor;
    r.contact.tangential *= factor;
    return r;
}

CleanReadings simulate(const Description& d, const Setup& truth, const Resolution& resolution) {
    CleanReadings out;
    for (const RunPlan& run : d.runs) {
        const auto same = std::find_if(d.runs.begin(), d.runs.end(), [&](const RunPlan& other) {
            return &other == &run ||
                   (other.specimenReversed == run.specimenReversed && other.drive.time == run.drive.time &&
                    other.sampling == run.sampling && other.drive.displacement == run.drive.displacement &&
                    other.markersSampling == run.markersSampling);
        });
        if (&*same != &run) { // a repeat: every run starts with a new specimen
            const auto i = static_cast<std::size_t>(same - d.runs.begin());
            out.force.push_back(std::vector<double>(out.force[i]));
            out.markers.push_back(std::vector<std::vector<Vec2>>(out.markers[i]));
            continue;
        }
        const std::vector<double> times = run.times(run.sampling);
        Setup mounted = truth;
        std::vector<Marker> markers = d.markers;
        if (run.specimenReversed) {
            mounted.effects = reversed(truth.effects);
            for (Marker& m : markers)
                m.arcFraction = 1.0 - m.arcFraction;
        }
        Simulation sim(mounted, resolution);
        if (!sim.settle(kSettle)) {
            out.failure = "the specimen does not come to rest before the run";
            return out;
        }
        const Trace trace = sim.run(run.drive, times, markers);
        if (!trace.failure.empty()) {
            out.failure = trace.failure;
            return out;
        }
        std::vector<double> force = readings(trace, truth.effects, times);
        zeroAtStart(times, force);
        out.force.push_back(std::move(force));
        out.markers.emplace_back();
        for (const std::vector<Vec2>& path : trace.markers)
            out.markers.back().push_back(interpolated(trace, path, run.times(run.markersSampling)));
        out.maxCurvatureChange = std::max(out.maxCurvatureChange, trace.maxCurvatureChange);
    }
    return out;
}

BaselineModel::BaselineModel(const Description& d, const Offsets& offsets, const SensorNoise& noise)
    : d_(d), offsets_(offsets), noise_(noise) {
    const CleanReadings base = simulate(d, trueSetup(d, offsets, {}), coarseResolution(d.nominal.specimens.size()));
    failure_ = base.failure;
    if (!failure_.empty())
        return;
    base_ = stack(base);
    columns_.resize(base_.size(), std::size(kOffsets));
    for (std::size_t k = 0; k < std::size(kOffsets); ++k) {
        Offsets o = offsets;
        const double step = o.*kOffsets[k] > 0.0 ? -0.3 : 0.3;
        o.*kOffsets[k] += step;
        const CleanReadings shifted = simulate(d, trueSetup(d, o, {}), coarseResolution(d.nominal.specimens.size()));
        if (!shifted.failure.empty()) {
            failure_ = shifted.failure;
            return;
        }
        columns_.col(static_cast<Eigen::Index>(k)) =
            (stack(shifted) - base_) / step /
            std::sqrt(3.0); // a uniform interval as a normal prior of the same variance
    }
    addRunNuisances();
    whitenedColumns_.resize(columns_.rows(), columns_.cols());
    for (Eigen::Index k = 0; k < columns_.cols(); ++k)
        whitenedColumns_.col(k) = whitened(columns_.col(k));
}

/// Adds the zero of each run, as uncertain as one reading, and its clock, uncertain by a tenth of a reading.
void BaselineModel::addRunNuisances() {
    const auto first = columns_.cols();
    columns_.conservativeResize(Eigen::NoChange, first + 2 * static_cast<Eigen::Index>(d_.runs.size()));
    columns_.rightCols(columns_.cols() - first).setZero();
    Eigen::Index at = 0, column = first;
    for (const RunPlan& run : d_.runs) {
        const auto n = static_cast<Eigen::Index>(run.times(run.sampling).size());
        columns_.col(column++).segment(at, n).setOnes();
        columns_.col(column++).segment(at + 1, n - 2) =
            0.05 * (base_.segment(at + 2, n - 2) - base_.segment(at, n - 2));
        at += n + 2 * static_cast<Eigen::Index>(d_.markers.size() * run.times(run.markersSampling).size());
    }
}

/// Innovations of the true noise (white plus AR(1)) in its own units (R. E. Kalman, J. Basic Eng. 82 (1960) 35).
/// The noise of markers is white.
Eigen::VectorXd BaselineModel::whitened(Eigen::VectorXd stack) const {
    const double all = noise_.total() * noise_.total(), step = noise_.quantum * noise_.quantum / 12.0;
    const double white = (noise_.white * noise_.white + step) / all,
                 correlated = noise_.correlated * noise_.correlated / all;
    Eigen::Index at = 0;
    for (const RunPlan& run : d_.runs) {
        const std::vector<double> times = run.times(run.sampling);
        const auto n = static_cast<Eigen::Index>(times.size());
        double state = 0.0, variance = correlated;
        for (Eigen::Index i = 0; i < n; ++i) {
            if (i > 0) {
                const double keep = std::exp(-(times[i] - times[i - 1]) / noise_.correlationTime);
                state *= keep;
                variance = keep * keep * variance + (1.0 - keep * keep) * correlated;
            }
            const double sum = variance + white, innovation = stack[at + i] - state;
            state += variance / sum * innovation;
            variance -= variance * variance / sum;
            stack[at + i] = innovation / std::sqrt(sum);
        }
        at += n + 2 * static_cast<Eigen::Index>(d_.markers.size() * run.times(run.markersSampling).size());
    }
    return stack;
}

Eigen::VectorXd BaselineModel::stack(const CleanReadings& c) const {
    std::vector<double> rows;
    for (std::size_t r = 0; r < c.force.size(); ++r) {
        for (const double f : c.force[r])
            rows.push_back(f / noise_.total());
        for (const std::vector<Vec2>& path : c.markers[r])
            for (const Vec2& p : path) {
                rows.push_back(p.x() / noise_.marker);
                rows.push_back(p.y() / noise_.marker);
            }
    }
    return Eigen::Map<Eigen::VectorXd>(rows.data(), static_cast<Eigen::Index>(rows.size()));
}

std::optional<Unexplained> BaselineModel::unexplained(const Effects& effects) const {
    const CleanReadings with =
        simulate(d_, trueSetup(d_, offsets_, effects), coarseResolution(d_.nominal.specimens.size()));
    if (!with.failure.empty())
        return std::nullopt;
    const Eigen::VectorXd signature = stack(with) - base_;
    return Unexplained{beyondNominal(signature), detectable(base_ + signature, base_)};
}

Eigen::VectorXd BaselineModel::includedReadings(const Eigen::VectorXd& stack) const {
    Eigen::VectorXd counts = Eigen::VectorXd::Ones(stack.size());
    Eigen::Index at = 0;
    for (const RunPlan& run : d_.runs) {
        const std::vector<double> times = run.times(run.sampling), frames = run.times(run.markersSampling);
        const auto n = static_cast<Eigen::Index>(times.size()), m = static_cast<Eigen::Index>(frames.size());
        for (const auto& [from, to] : excludedIntervals(run, stack.segment(at, n))) {
            for (Eigen::Index k = 0; k < n; ++k)
                if (times[static_cast<std::size_t>(k)] > from && times[static_cast<std::size_t>(k)] < to)
                    counts[at + k] = 0.0;
            for (Eigen::Index k = 0; k < m; ++k)
                if (frames[static_cast<std::size_t>(k)] > from && frames[static_cast<std::size_t>(k)] < to)
                    for (std::size_t marker = 0; marker < d_.markers.size(); ++marker)
                        counts.segment(at + n + 2 * (static_cast<Eigen::Index>(marker) * m + k), 2).setZero();
        }
        at += n + 2 * m * static_cast<Eigen::Index>(d_.markers.size());
    }
    return counts;
}

double BaselineModel::detectable(const Eigen::VectorXd& with, const Eigen::VectorXd& without) const {
    // Hundreds of standard deviations in a handful of readings are no information: clocks and simulators differ as
    // much.
    constexpr double kMaxDeviation = 8.0;
    const Eigen::VectorXd counts = includedReadings(with).cwiseProduct(includedReadings(without));
    const Eigen::VectorXd signature = (with - without).cwiseMax(-kMaxDeviation).cwiseMin(kMaxDeviation);
    const Eigen::VectorXd whitenedSignature = whitened(counts.cwiseProduct(signature));
    Eigen::MatrixXd columns(columns_.rows(), columns_.cols());
    for (Eigen::Index k = 0; k < columns.cols(); ++k)
        columns.col(k) = whitened(counts.cwiseProduct(columns_.col(k)));
    Eigen::MatrixXd normal = columns.transpose() * columns;
    normal.diagonal().array() += 1.0;
    const Eigen::VectorXd shift = normal.ldlt().solve(columns.transpose() * whitenedSignature);
    // The statistic of generalised least squares; a shift of the parameters costs their prior.
    return std::sqrt(std::max(0.0, whitenedSignature.squaredNorm() - whitenedSignature.dot(columns * shift)));
}

/// Huber's estimate by iterative reweighting (P. J. Huber, E. M. Ronchetti, "Robust Statistics", 2nd ed. (2009), 7.8).
/// Each round descends along one parameter after the other, which keeps them inside their intervals.
Eigen::VectorXd BaselineModel::beyondNominal(const Eigen::VectorXd& signature) const {
    constexpr double kHuberBound = 8.0; // noise standard deviations; as in detectable()
    constexpr int kRounds = 40, kPasses = 200;
    const Eigen::VectorXd whitenedSignature = whitened(signature);
    // Zeros and clocks have intervals too, because a thousand readings of an effect overrule any normal prior.
    Eigen::VectorXd upper = Eigen::VectorXd::Constant(columns_.cols(), 2.0), lower = -upper;
    const auto intervals = static_cast<Eigen::Index>(std::size(kOffsets));
    for (Eigen::Index k = 0; k < intervals; ++k) { // uniform; the true parameters do not lie in the middle
        const double middle = -(offsets_.*kOffsets[k]);
        lower[k] = std::sqrt(3.0) * (middle - 1.0);
        upper[k] = std::sqrt(3.0) * (middle + 1.0);
    }
    Eigen::VectorXd shift = Eigen::VectorXd::Zero(columns_.cols());
    for (int round = 0; round < kRounds; ++round) {
        const Eigen::VectorXd weight = (whitenedSignature - whitenedColumns_ * shift).unaryExpr([](double r) {
            return std::abs(r) > kHuberBound ? kHuberBound / std::abs(r) : 1.0;
        });
        Eigen::MatrixXd normal = whitenedColumns_.transpose() * weight.asDiagonal() * whitenedColumns_;
        const Eigen::VectorXd rightHandSide = whitenedColumns_.transpose() * weight.cwiseProduct(whitenedSignature);
        normal.diagonal().tail(normal.cols() - intervals).array() += 1.0; // zeros and clocks
        const Eigen::VectorXd before = shift;
        for (int pass = 0; pass < kPasses; ++pass)
            for (Eigen::Index k = 0; k < shift.size(); ++k)
                if (normal(k, k) > 1e-12)
                    shift[k] = std::clamp(shift[k] + (rightHandSide[k] - normal.row(k).dot(shift)) / normal(k, k),
                                          lower[k], upper[k]);
        if ((shift - before).cwiseAbs().maxCoeff() < 1e-4)
            break;
    }
    // Zeros and clocks are not subtracted, because readings before contact would seem to disagree.
    return signature - columns_.leftCols(intervals) * shift.head(intervals);
}

namespace {

/// @param level of each reading, in noise standard deviations
void addVisibleIntervals(const RunPlan& run, double sampling, const std::string& channel, const Eigen::VectorXd& level,
                         std::vector<VisibleInterval>& all) {
    const std::vector<double> times = run.times(sampling);
    const auto n = static_cast<long>(times.size());
    const std::size_t others = all.size();
    // Marks a mean of 0.7 standard deviations over a quarter of a second.
    const long reach = std::max(1L, std::lround(0.125 * sampling));
    for (long i = 0; i < n; ++i) {
        const long a = std::max(0L, i - reach), b = std::min(n - 1, i + reach);
        if (std::abs(level.segment(a, b - a + 1).mean()) < 0.7)
            continue;
        const double from = times[static_cast<std::size_t>(a)], to = times[static_cast<std::size_t>(b)];
        if (all.size() > others && from <= all.back().to + 0.3)
            all.back().to = to;
        else
            all.push_back({run.file, from, to, channel});
    }
}

} // namespace

std::vector<VisibleInterval> BaselineModel::visibleIntervals(const Eigen::VectorXd& unexplained) const {
    std::vector<VisibleInterval> all;
    Eigen::Index at = 0;
    for (const RunPlan& run : d_.runs) {
        const auto n = static_cast<Eigen::Index>(run.times(run.sampling).size());
        addVisibleIntervals(run, run.sampling, "force", unexplained.segment(at, n), all);
        at += n;
        const auto frames = static_cast<Eigen::Index>(run.times(run.markersSampling).size());
        for (std::size_t m = 0; m < d_.markers.size(); ++m, at += 2 * frames)
            for (const Eigen::Index axis : {0, 1}) {
                const std::string channel = "m" + std::to_string(m) + (axis == 0 ? "_x" : "_y");
                addVisibleIntervals(run, run.markersSampling, channel,
                                    unexplained(Eigen::seqN(at + axis, frames, Eigen::fix<2>)), all);
            }
    }
    return all;
}

} // namespace supercircle::blind_benchmark
