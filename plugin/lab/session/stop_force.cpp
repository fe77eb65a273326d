// The end of a segment that stops at a force: the step that would pass it is made again, shorter.

#include "plugin/lab/session/session.h"

#include <algorithm>
#include <cmath>

namespace supercircle::lab {

namespace {

/// Of the stop force, by which the last step may pass it. Each tenfold less takes one more step.
constexpr double kOvershoot = 1e-3;
constexpr int kMostTrials = 64; ///< each takes at least a tenth of what is left

} // namespace

/// A frame that ends where the force reaches `limit` (N). False: the run is over.
bool Session::frameToForce(double dt, double limit, bool& reached) {
    if (!beginFrame())
        return false;
    double before = force(), passed = 0.0, last = shells_.time();
    const double most = limit + kOvershoot * std::abs(limit);
    const bool repeats = repeatable_ && before < limit && most > limit;
    const Snapshot start = repeats ? shells_.save() : Snapshot{};
    double span = 0.0; // of the step that passes the limit, s
    int steps = 0;
    const FrameReport r = shells_.pre_step(dt, [&] {
        const double now = force();
        if (repeats && now > most) {
            passed = now;
            span = shells_.time() - last;
            return true;
        }
        record();
        ++steps;
        before = now;
        last = shells_.time();
        reached = now >= limit;
        return reached || stopsAtOnce();
    });
    if (span <= 0.0)
        return endFrame(r);
    shells_.restore(start).or_fail();
    if (steps > 0 && !endFrame(shells_.pre_step(dt, [&] { return --steps == 0; }))) // the same steps again
        return false;
    return cutToForce(before, passed, span, limit, reached);
}

/// Steps to the limit from `low` (N), which a step of `span` s would pass and end at `high`.
bool Session::cutToForce(double low, double high, double span, double limit, bool& reached) {
    step::World& w = shells_.world();
    const double usualStep = w.dtNext, most = limit + kOvershoot * std::abs(limit);
    for (int trial = 0; trial < kMostTrials && !reached; ++trial) {
        const double share = (0.5 * (limit + most) - low) / (high - low);
        const double dt = span * std::clamp(share, 0.1, 0.9);
        const bool shortest = dt <= shells_.stepper().settings().dtMin || trial + 1 == kMostTrials;
        const Snapshot start = shells_.save();
        const double from = w.time;
        double passed = 0.0;
        const FrameReport r = shells_.pre_step(dt, [&] {
            const double now = force();
            if (!shortest && now > most) {
                passed = now;
                return true;
            }
            record();
            low = now;
            reached = now >= limit;
            return true;
        });
        const double taken = w.time - from;
        if (passed > 0.0) {
            shells_.restore(start).or_fail();
            high = passed;
            span = taken;
            continue;
        }
        span = std::max(span - taken, 0.0);
        if (!endFrame(r))
            return false;
        if (span <= shells_.stepper().settings().dtMin)
            break; // the limit is reached in a step of the usual size
    }
    w.dtNext = std::max(w.dtNext, usualStep);
    return true;
}

} // namespace supercircle::lab
