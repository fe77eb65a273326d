#include "tests/blind_benchmark/conceal/truth.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace supercircle::oracle {

namespace {

constexpr double kSettle = 2.0; ///< s

std::vector<Vec2> alongTime(const Trace& trace, const std::vector<Vec2>& path, const std::vector<double>& times) {
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

/// Where the drive turns round, starts or stops, s.
std::vector<double> turnsOf(const Drive& drive) {
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

std::vector<std::pair<double, double>> besideJumps(const RunPlan& run, const Eigen::Ref<const Eigen::VectorXd>& force) {
    constexpr double kJump = 6.0;    // deviations from one reading to the next,
    constexpr double kSteeper = 4.0; // and so many times what the neighbours do
    constexpr double kTurn = 1.5;    // readings
    const std::vector<double> times = run.times(run.sampling), turns = turnsOf(run.drive);
    const double step = 1.0 / run.sampling;
    std::vector<std::pair<double, double>> beside;
    for (const double t : turns)
        beside.emplace_back(t - kTurn * step, t + kTurn * step);
    const auto change = [&](Eigen::Index i) {
        return i >= 0 && i + 1 < force.size() ? std::abs(force[i + 1] - force[i]) : 0.0;
    };
    for (Eigen::Index i = 0; i + 1 < force.size(); ++i) {
        if (change(i) < std::max(kJump, kSteeper * std::max(change(i - 2), change(i + 2))))
            continue;
        const double from = times[static_cast<std::size_t>(i)], to = times[static_cast<std::size_t>(i + 1)];
        const bool atTurn = std::any_of(turns.begin(), turns.end(),
                                        [&](double t) { return t > from - 0.5 * step && t < to + 0.5 * step; });
        if (!atTurn)
            beside.emplace_back(from - 0.1, to + 0.3);
    }
    return beside;
}

Resolution coarse(std::size_t rods) {
    Resolution r;
    r.edges = rods > 1 ? 40 : 60;
    r.travel = rods > 1 ? 1.2e-4 : 8e-5;
    return r;
}

Clean simulate(const Description& d, const Setup& truth, const Resolution& resolution) {
    Clean out;
    for (const RunPlan& run : d.runs) {
        const auto same = std::find_if(d.runs.begin(), d.runs.end(), [&](const RunPlan& other) {
            return &other == &run ||
                   (other.turned == run.turned && other.drive.time == run.drive.time &&
                    other.sampling == run.sampling && other.drive.displacement == run.drive.displacement &&
                    other.markersSampling == run.markersSampling);
        });
        if (&*same != &run) { // a repeat: every run begins with the specimen as it was made
            const auto i = static_cast<std::size_t>(same - d.runs.begin());
            out.force.push_back(std::vector<double>(out.force[i]));
            out.markers.push_back(std::vector<std::vector<Vec2>>(out.markers[i]));
            continue;
        }
        const std::vector<double> times = run.times(run.sampling);
        Setup mounted = truth;
        std::vector<Marker> markers = d.markers;
        if (run.turned) {
            mounted.effects = turnedEndForEnd(truth.effects);
            for (Marker& m : markers)
                m.arcFraction = 1.0 - m.arcFraction;
        }
        Simulation sim(mounted, resolution);
        if (!sim.settle(kSettle)) {
            out.failure = "does not come to rest";
            return out;
        }
        const Trace trace = sim.play(run.drive, times, markers);
        if (!trace.failure.empty()) {
            out.failure = trace.failure;
            return out;
        }
        std::vector<double> force = readings(trace, truth.effects, times);
        zeroAtStart(times, force);
        out.force.push_back(std::move(force));
        out.markers.emplace_back();
        for (const std::vector<Vec2>& path : trace.markers)
            out.markers.back().push_back(alongTime(trace, path, run.times(run.markersSampling)));
        out.largestChange = std::max(out.largestChange, trace.largestChange);
    }
    return out;
}

Absorber::Absorber(const Description& d, const Offsets& offsets, const Nuisance& noise)
    : d_(d), offsets_(offsets), noise_(noise) {
    const Clean base = simulate(d, trueSetup(d, offsets, {}), coarse(d.nominal.specimens.size()));
    failure_ = base.failure;
    if (!failure_.empty())
        return;
    base_ = stack(base);
    columns_.resize(base_.size(), std::size(kOffsets));
    for (std::size_t k = 0; k < std::size(kOffsets); ++k) {
        Offsets o = offsets;
        const double step = o.*kOffsets[k] > 0.0 ? -0.3 : 0.3;
        o.*kOffsets[k] += step;
        const Clean moved = simulate(d, trueSetup(d, o, {}), coarse(d.nominal.specimens.size()));
        if (!moved.failure.empty()) {
            failure_ = moved.failure;
            return;
        }
        columns_.col(static_cast<Eigen::Index>(k)) =
            (stack(moved) - base_) / step / std::sqrt(3.0); // uniform: as a normal prior of the same variance
    }
    addOwn();
    whitenedColumns_.resize(columns_.rows(), columns_.cols());
    for (Eigen::Index k = 0; k < columns_.cols(); ++k)
        whitenedColumns_.col(k) = whitened(columns_.col(k));
}

/// Of every run: a zero that is as uncertain as one reading, and a clock that is off by a tenth of a reading.
void Absorber::addOwn() {
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

/// Innovations of the true noise, white plus AR(1), in its own units (R. E. Kalman, J. Basic Eng. 82 (1960) 35).
/// Markers' noise is white.
Eigen::VectorXd Absorber::whitened(Eigen::VectorXd stack) const {
    const double all = noise_.total() * noise_.total(), step = noise_.step * noise_.step / 12.0;
    const double white = (noise_.white * noise_.white + step) / all, coloured = noise_.coloured * noise_.coloured / all;
    Eigen::Index at = 0;
    for (const RunPlan& run : d_.runs) {
        const std::vector<double> times = run.times(run.sampling);
        const auto n = static_cast<Eigen::Index>(times.size());
        double state = 0.0, variance = coloured;
        for (Eigen::Index i = 0; i < n; ++i) {
            if (i > 0) {
                const double keep = std::exp(-(times[i] - times[i - 1]) / noise_.memory);
                state *= keep;
                variance = keep * keep * variance + (1.0 - keep * keep) * coloured;
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

Eigen::VectorXd Absorber::stack(const Clean& c) const {
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

std::optional<Left> Absorber::left(const Effects& effects) const {
    const Clean with = simulate(d_, trueSetup(d_, offsets_, effects), coarse(d_.nominal.specimens.size()));
    if (!with.failure.empty())
        return std::nullopt;
    const Eigen::VectorXd signature = stack(with) - base_;
    return Left{beyondNominal(signature), detectable(base_ + signature, base_)};
}

Eigen::VectorXd Absorber::apartFromJumps(const Eigen::VectorXd& stack) const {
    Eigen::VectorXd counts = Eigen::VectorXd::Ones(stack.size());
    Eigen::Index at = 0;
    for (const RunPlan& run : d_.runs) {
        const std::vector<double> times = run.times(run.sampling), frames = run.times(run.markersSampling);
        const auto n = static_cast<Eigen::Index>(times.size()), m = static_cast<Eigen::Index>(frames.size());
        for (const auto& [from, to] : besideJumps(run, stack.segment(at, n))) {
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

double Absorber::detectable(const Eigen::VectorXd& with, const Eigen::VectorXd& without) const {
    // What shows in a handful of readings, up to hundreds of deviations in one, tells nobody anything: clocks and
    // simulators differ by as much there.
    constexpr double kMost = 8.0;
    const Eigen::VectorXd counts = apartFromJumps(with).cwiseProduct(apartFromJumps(without));
    const Eigen::VectorXd signature = (with - without).cwiseMax(-kMost).cwiseMin(kMost);
    const Eigen::VectorXd behind = whitened(counts.cwiseProduct(signature));
    Eigen::MatrixXd columns(columns_.rows(), columns_.cols());
    for (Eigen::Index k = 0; k < columns.cols(); ++k)
        columns.col(k) = whitened(counts.cwiseProduct(columns_.col(k)));
    Eigen::MatrixXd normal = columns.transpose() * columns;
    normal.diagonal().array() += 1.0;
    const Eigen::VectorXd moved = normal.ldlt().solve(columns.transpose() * behind);
    // Moving the parameters costs their prior: the statistic of generalised least squares.
    return std::sqrt(std::max(0.0, behind.squaredNorm() - behind.dot(columns * moved)));
}

/// Huber's estimate by reweighting (P. J. Huber, E. M. Ronchetti, "Robust Statistics", 2nd ed. (2009), 7.8), each time
/// by descent along one parameter after the other, which keeps them inside their intervals.
Eigen::VectorXd Absorber::beyondNominal(const Eigen::VectorXd& signature) const {
    constexpr double kJump = 8.0; // deviations; as in detectable()
    constexpr int kRounds = 40, kSweeps = 200;
    const Eigen::VectorXd behind = whitened(signature);
    // Zeros and clocks: a thousand readings of an effect would tear any normal prior along.
    Eigen::VectorXd most = Eigen::VectorXd::Constant(columns_.cols(), 2.0), least = -most;
    const auto intervals = static_cast<Eigen::Index>(std::size(kOffsets));
    for (Eigen::Index k = 0; k < intervals; ++k) { // uniform, and the truth lies off their middles
        const double middle = -(offsets_.*kOffsets[k]);
        least[k] = std::sqrt(3.0) * (middle - 1.0);
        most[k] = std::sqrt(3.0) * (middle + 1.0);
    }
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(columns_.cols());
    for (int round = 0; round < kRounds; ++round) {
        const Eigen::VectorXd weight = (behind - whitenedColumns_ * moved).unaryExpr([](double r) {
            return std::abs(r) > kJump ? kJump / std::abs(r) : 1.0;
        });
        Eigen::MatrixXd normal = whitenedColumns_.transpose() * weight.asDiagonal() * whitenedColumns_;
        const Eigen::VectorXd pull = whitenedColumns_.transpose() * weight.cwiseProduct(behind);
        normal.diagonal().tail(normal.cols() - intervals).array() += 1.0; // zeros and clocks
        const Eigen::VectorXd before = moved;
        for (int sweep = 0; sweep < kSweeps; ++sweep)
            for (Eigen::Index k = 0; k < moved.size(); ++k)
                if (normal(k, k) > 1e-12)
                    moved[k] =
                        std::clamp(moved[k] + (pull[k] - normal.row(k).dot(moved)) / normal(k, k), least[k], most[k]);
        if ((moved - before).cwiseAbs().maxCoeff() < 1e-4)
            break;
    }
    // Zeros and clocks are taken as they are: readings at rest do not disagree because a poor fit would shift them.
    return signature - columns_.leftCols(intervals) * moved.head(intervals);
}

namespace {

/// @param level of each reading, in deviations of one
void addWindows(const RunPlan& run, double sampling, const std::string& channel, const Eigen::VectorXd& level,
                std::vector<Window>& all) {
    const std::vector<double> times = run.times(sampling);
    const auto n = static_cast<long>(times.size());
    const std::size_t others = all.size();
    // A level of one noise unit over a quarter of a second is what an eye would mark.
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

std::vector<Window> Absorber::windows(const Eigen::VectorXd& left) const {
    std::vector<Window> all;
    Eigen::Index at = 0;
    for (const RunPlan& run : d_.runs) {
        const auto n = static_cast<Eigen::Index>(run.times(run.sampling).size());
        addWindows(run, run.sampling, "force", left.segment(at, n), all);
        at += n;
        const auto frames = static_cast<Eigen::Index>(run.times(run.markersSampling).size());
        for (std::size_t m = 0; m < d_.markers.size(); ++m, at += 2 * frames)
            for (const Eigen::Index axis : {0, 1}) {
                const std::string channel = "m" + std::to_string(m) + (axis == 0 ? "_x" : "_y");
                addWindows(run, run.markersSampling, channel, left(Eigen::seqN(at + axis, frames, Eigen::fix<2>)), all);
            }
    }
    return all;
}

} // namespace supercircle::oracle
