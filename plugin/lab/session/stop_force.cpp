// The end of a segment that stops at a force: the step that would pass it is made again, shorter. A state is kept only
// now and then; from it the frames up to that step are made again.

#include "plugin/lab/session/session.h"

#include <algorithm>
#include <cmath>

namespace supercircle::lab {

namespace {

/// Of the stop force, by which the last step may pass it.
constexpr double kOvershoot = 1e-3;
constexpr int kMostTrials = 40, kSecants = 8; ///< bisections follow
/// Frames after which the state is saved anew. Saved at each it takes 6.4 % of a cycle of thirty shells. Half of the
/// number costs 0.4 %; twice as many save 0.2 % and may cost sixteen more frames at the end of a segment.
constexpr std::size_t kFramesOfState = 16;
constexpr double kShortest = 1e-4; ///< of a step: where a tenth of a per mille of it decides, the force leaps

} // namespace

/// A state for the coming frame, if the last one is too far back.
void Session::keepFramesToRepeat() {
    if (toRepeat_.kept && toRepeat_.frames.size() < kFramesOfState)
        return;
    toRepeat_ = {true, shells_.save(), movingBodies(), {}};
}

/// Back to the state before the present frame, of which `steps` are made again. False: the run is over.
bool Session::repeatFrames(int steps) {
    for (const auto& [id, state] : toRepeat_.moving)
        host_->put(id, state);
    shells_.restore(toRepeat_.state).or_fail();
    for (const double dt : toRepeat_.frames)
        if (!endFrame(shells_.pre_step(dt, [] { return false; })))
            return false;
    return steps == 0 || endFrame(shells_.pre_step(toRepeat_.present, [&] { return --steps == 0; }));
}

/// A frame that ends where the force reaches `limit` (N). False: the run is over.
bool Session::frameToForce(double dt, double limit, bool& reached) {
    if (!beginFrame())
        return false;
    double before = force(), passed = 0.0, last = shells_.time();
    const double most = limit + kOvershoot * std::abs(limit);
    const bool repeats = repeatable_ && before < limit && most > limit;
    if (repeats)
        keepFramesToRepeat();
    else
        toRepeat_ = {};
    toRepeat_.present = dt;
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
    if (span <= 0.0) {
        toRepeat_.frames.push_back(dt);
        return endFrame(r);
    }
    const bool goesOn = repeatFrames(steps) && cutToForce(before, passed, span, limit, reached);
    toRepeat_ = {}; // where the force leaps past the limit the run goes on, and these frames do not lead here
    return goesOn;
}

/// Finds the step from here that ends at the limit. One of `span` s passes it and ends at `high` (N), from `low`.
/// Trials that miss are undone: a row of ever shorter steps would excite vibrations, in which the force leaps.
bool Session::cutToForce(double low, double high, double span, double limit, bool& reached) {
    step::World& w = shells_.world();
    const double usualStep = w.dtNext, most = limit + kOvershoot * std::abs(limit);
    const Snapshot start = shells_.save();
    const double from = w.time;
    double shorter = 0.0, longer = span; // s, steps that end below and above the limit
    for (int trial = 0; trial < kMostTrials && !reached; ++trial) {
        const bool last = trial + 1 == kMostTrials || longer - shorter < kShortest * span;
        const double share = trial < kSecants ? std::clamp((0.5 * (limit + most) - low) / (high - low), 0.1, 0.9) : 0.5;
        const double dt = last ? (shorter > 0.0 ? shorter : span) : shorter + share * (longer - shorter);
        double end = 0.0, taken = 0.0;
        const FrameReport r = shells_.pre_step(dt, [&] {
            end = force();
            taken = w.time - from;
            reached = end >= limit && (end <= most || last);
            if (reached || last)
                record();
            return true;
        });
        if (reached || last || !r.failure.empty()) {
            w.dtNext = std::max(w.dtNext, usualStep);
            return endFrame(r);
        }
        shells_.restore(start).or_fail();
        (end < limit ? shorter : longer) = taken;
        (end < limit ? low : high) = end;
    }
    return true;
}

} // namespace supercircle::lab
