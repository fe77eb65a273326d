#include "plugin/identification/diagnosis/likelihood/jumps.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

std::vector<double> listOf(const Eigen::VectorXd& v) {
    return {v.data(), v.data() + v.size()};
}

std::vector<replay::Landmark> whileMoving(const RecordedRun& run, const Eigen::VectorXd& force, double share) {
    std::vector<replay::Landmark> all = replay::findLandmarks(readingsOf(run, force), share);
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const replay::Landmark& jump) {
                                 return run.segments.empty() || run.segmentAt(jump.time).speed == 0.0;
                             }),
              all.end());
    return all;
}

/// Mean of up to three rows that count and are not masked, from `k` in steps of `way`; its time in `at`.
bool beside(const Eigen::Ref<Eigen::VectorXd>& d, const Eigen::VectorXd& time,
            const Eigen::Ref<const Eigen::VectorXd>& errors, const std::vector<bool>& masked, Index k, Index way,
            double& mean, double& at) {
    double n = mean = at = 0.0;
    for (; k >= 0 && k < d.size() && n < 3.0; k += way)
        if (!masked[static_cast<std::size_t>(k)] && std::isfinite(errors[k]) && std::isfinite(d[k])) {
            mean += d[k];
            at += time[k];
            n += 1.0;
        }
    mean /= std::max(1.0, n);
    at /= std::max(1.0, n);
    return n > 0.0;
}

} // namespace

experiment::Readings readingsOf(const RecordedRun& run, const Eigen::VectorXd& force) {
    return {listOf(run.time), listOf(run.displacement), listOf(force)};
}

bool atReversal(const RecordedRun& run, double time) {
    constexpr double kAfter = 0.1; // natural s
    const double dt = run.spacing();
    return std::any_of(run.strokes.begin(), run.strokes.end(), [&](const Stroke& stroke) {
        return time > stroke.from - 2.0 * dt && time < stroke.from + kAfter * run.units.time + 2.0 * dt;
    });
}

std::vector<replay::Landmark> recordedJumps(const RecordedRun& run, double share, double least) {
    std::vector<replay::Landmark> all = whileMoving(run, run.force, share);
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const replay::Landmark& jump) {
                                 return atReversal(run, jump.time) || std::abs(jump.after - jump.before) < least;
                             }),
              all.end());
    return all;
}

std::vector<replay::Landmark> simulatedJumps(const RecordedRun& run, const Response& simulated, double share) {
    std::vector<replay::Landmark> all = whileMoving(run, simulated.force, share);
    for (replay::Landmark& jump : all) {
        double nearest = 1.5 * run.spacing(), time = jump.time;
        for (const double t : simulated.jumps)
            if (std::abs(t - jump.time) < nearest) {
                nearest = std::abs(t - jump.time);
                time = t;
            }
        jump.time = time;
    }
    return all;
}

double jumpReachOf(const RecordedRun& run, double time, double share) {
    constexpr double kLeast = 0.5; // natural s, longer than the excluded interval around a jump
    const Stroke& stroke = run.strokeAt(time);
    return std::max(kLeast * run.units.time, share * (stroke.to - stroke.from));
}

std::vector<int> matchJumps(const RecordedRun& run, const std::vector<replay::Landmark>& a,
                            const std::vector<replay::Landmark>& b, double share) {
    // Alignment of two sequences by dynamic programming. A pair costs its distance, an unpaired jump half its reach, so
    // two jumps are paired within reach.
    const std::size_t n = a.size(), m = b.size();
    const auto alone = [&](const replay::Landmark& jump) { return 0.5 * jumpReachOf(run, jump.time, share); };
    const auto apart = [&](std::size_t i, std::size_t j) {
        const bool alike = (a[i].after > a[i].before) == (b[j].after > b[j].before);
        return alike && run.segmentAt(a[i].time).stroke == run.segmentAt(b[j].time).stroke
                   ? std::abs(a[i].time - b[j].time)
                   : std::numeric_limits<double>::infinity();
    };
    Eigen::MatrixXd cost(static_cast<Index>(n + 1), static_cast<Index>(m + 1)); // of the first i and j jumps
    cost.setZero();
    const auto at = [&](std::size_t i, std::size_t j) -> double& {
        return cost(static_cast<Index>(i), static_cast<Index>(j));
    };
    for (std::size_t i = 1; i <= n; ++i)
        at(i, 0) = at(i - 1, 0) + alone(a[i - 1]);
    for (std::size_t j = 1; j <= m; ++j)
        at(0, j) = at(0, j - 1) + alone(b[j - 1]);
    for (std::size_t i = 1; i <= n; ++i)
        for (std::size_t j = 1; j <= m; ++j)
            at(i, j) = std::min({at(i - 1, j) + alone(a[i - 1]), at(i, j - 1) + alone(b[j - 1]),
                                 at(i - 1, j - 1) + apart(i - 1, j - 1)});
    std::vector<int> partner(n, -1);
    for (std::size_t i = n, j = m; i > 0 && j > 0;) {
        if (at(i, j) == at(i - 1, j - 1) + apart(i - 1, j - 1)) {
            partner[i - 1] = static_cast<int>(j - 1);
            --i;
            --j;
        } else if (at(i, j) == at(i - 1, j) + alone(a[i - 1])) {
            --i;
        } else {
            --j;
        }
    }
    return partner;
}

std::vector<bool> rowsInside(const TimeRanges& stretches, const Eigen::VectorXd& time) {
    std::vector<bool> in(static_cast<std::size_t>(time.size()), false);
    for (const auto& [from, to] : stretches) {
        const auto first = std::upper_bound(time.begin(), time.end(), from) - time.begin();
        const auto end = std::upper_bound(time.begin(), time.end(), to) - time.begin();
        std::fill(in.begin() + first, in.begin() + std::max(first, end), true);
    }
    return in;
}

void interpolateMasked(Eigen::Ref<Eigen::VectorXd> difference, const Eigen::VectorXd& time,
                       const Eigen::Ref<const Eigen::VectorXd>& errors, const std::vector<bool>& masked) {
    for (Index first = 0, end = 0; first < difference.size(); first = end) {
        end = first + 1;
        if (!masked[static_cast<std::size_t>(first)])
            continue;
        while (end < difference.size() && masked[static_cast<std::size_t>(end)])
            ++end;
        double left = 0.0, right = 0.0, t0 = 0.0, t1 = 0.0;
        const bool before = beside(difference, time, errors, masked, first - 1, -1, left, t0);
        const bool behind = beside(difference, time, errors, masked, end, 1, right, t1);
        for (Index k = first; k < end && (before || behind); ++k)
            if (std::isfinite(errors[k])) {
                const double share = !before ? 1.0 : !behind ? 0.0 : (time[k] - t0) / (t1 - t0);
                difference[k] = left + share * (right - left);
            }
    }
}

} // namespace supercircle::diagnosis
