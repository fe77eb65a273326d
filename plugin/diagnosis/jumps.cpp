#include "plugin/diagnosis/jumps.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

std::vector<double> listOf(const Eigen::VectorXd& v) {
    return {v.data(), v.data() + v.size()};
}

double spacing(const RecordedRun& run) {
    return run.time.size() > 1
               ? (run.time[run.time.size() - 1] - run.time[0]) / static_cast<double>(run.time.size() - 1)
               : 1.0;
}

/// Mean of up to three rows that count, going from `k` in steps of `way`; its time in `at`.
bool beside(const Eigen::Ref<Eigen::VectorXd>& d, const Eigen::VectorXd& time,
            const Eigen::Ref<const Eigen::VectorXd>& errors, Index k, Index way, double& mean, double& at) {
    double n = mean = at = 0.0;
    for (; k >= 0 && k < d.size() && n < 3.0; k += way)
        if (std::isfinite(errors[k]) && std::isfinite(d[k])) {
            mean += d[k];
            at += time[k];
            n += 1.0;
        }
    mean /= std::max(1.0, n);
    at /= std::max(1.0, n);
    return n > 0.0;
}

} // namespace

int legOf(const RecordedRun& run, double time) {
    const auto at = std::find_if(run.legs.begin(), run.legs.end(), [&](const Leg& l) { return time < l.to; });
    return at != run.legs.end() ? static_cast<int>(at - run.legs.begin()) : -1;
}

bool atTurningPoint(const RecordedRun& run, double time) {
    const double dt = spacing(run);
    return std::any_of(run.legs.begin(), run.legs.end(),
                       [&](const Leg& leg) { return time > leg.from - 2.0 * dt && time < leg.from + 0.1 + 2.0 * dt; });
}

std::vector<replay::Landmark> jumpsOf(const RecordedRun& run, const Eigen::VectorXd& force, double share) {
    std::vector<replay::Landmark> all =
        replay::findLandmarks({listOf(run.time), listOf(run.displacement), listOf(force)}, share);
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const replay::Landmark& jump) {
                                 const int leg = legOf(run, jump.time);
                                 return leg < 0 || run.legs[static_cast<std::size_t>(leg)].speed == 0.0 ||
                                        atTurningPoint(run, jump.time);
                             }),
              all.end());
    return all;
}

std::vector<replay::Landmark> jumpsOf(const RecordedRun& run, const Response& simulated, double share) {
    std::vector<replay::Landmark> all = jumpsOf(run, simulated.force, share);
    const double dt = spacing(run);
    for (replay::Landmark& jump : all) {
        double nearest = 1.5 * dt, time = jump.time;
        for (const double t : simulated.jumps)
            if (std::abs(t - jump.time) < nearest) {
                nearest = std::abs(t - jump.time);
                time = t;
            }
        jump.time = time;
    }
    return all;
}

std::vector<std::pair<std::size_t, std::size_t>> sameJumps(const RecordedRun& run,
                                                           const std::vector<replay::Landmark>& a,
                                                           const std::vector<replay::Landmark>& b, double farthest) {
    auto pairs = replay::matchLandmarks(a, b, std::numeric_limits<double>::infinity());
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(),
                               [&](const auto& pair) {
                                   const double s = a[pair.first].time, t = b[pair.second].time;
                                   const int leg = legOf(run, s);
                                   if (leg < 0 || leg != legOf(run, t))
                                       return true;
                                   const Leg& l = run.legs[static_cast<std::size_t>(leg)];
                                   return std::abs(s - t) > farthest * (l.to - l.from);
                               }),
                pairs.end());
    return pairs;
}

void bridge(Eigen::Ref<Eigen::VectorXd> difference, const Eigen::VectorXd& time,
            const Eigen::Ref<const Eigen::VectorXd>& errors, double from, double to) {
    const auto rowAfter = [&](double t) {
        return static_cast<Index>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
    };
    const Index first = rowAfter(from), end = std::max(first, rowAfter(to));
    double left = 0.0, right = 0.0, t0 = 0.0, t1 = 0.0;
    const bool before = beside(difference, time, errors, first - 1, -1, left, t0);
    const bool behind = beside(difference, time, errors, end, 1, right, t1);
    if (!before && !behind)
        return;
    for (Index k = first; k < end; ++k)
        if (std::isfinite(errors[k])) {
            const double share = !before ? 1.0 : !behind ? 0.0 : (time[k] - t0) / (t1 - t0);
            difference[k] = left + share * (right - left);
        }
}

} // namespace supercircle::diagnosis
