#include "plugin/identification/diagnosis/next_experiment/designs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace supercircle::diagnosis {

namespace {

using experiment::Run;

/// What the recorded runs do, as far as new ones need it.
struct Habits {
    double travel = 0.0, slowest = 0.0, fastest = 0.0; ///< m, m/s
    double rate = 0.0;                                 ///< Hz, the highest
    double rest = 1.0;                                 ///< s, the longest where strokes begin, one to ten
    bool back = false;                                 ///< some run goes back by half of its way
};

Habits habitsOf(const experiment::Experiment& e) {
    Habits h;
    for (const Run& run : e.runs) {
        h.rate = std::max(h.rate, run.samplingRate);
        for (std::size_t i = 1; i < run.driveTime.size(); ++i) {
            h.travel = std::max(h.travel, run.driveDisplacement[i]);
            if (run.driveDisplacement[i - 1] == 0.0 && run.driveDisplacement[i] == 0.0)
                h.rest = std::clamp(run.driveTime[i] - run.driveTime[i - 1], h.rest, 10.0);
            h.back = h.back || run.driveDisplacement[i] < 0.5 * run.driveDisplacement[i - 1];
            const double speed = std::abs(run.driveDisplacement[i] - run.driveDisplacement[i - 1]) /
                                 (run.driveTime[i] - run.driveTime[i - 1]);
            if (speed > 0.0) {
                h.fastest = std::max(h.fastest, speed);
                h.slowest = h.slowest > 0.0 ? std::min(h.slowest, speed) : speed;
            }
        }
    }
    return h;
}

/// A second of rest, then the way through these places, with a rest wherever it begins anew: a specimen that was let go
/// swings, and where it lands next depends on how that is damped.
Run through(const Habits& h, const std::vector<double>& places, double speed, double hold = 0.0) {
    Run run;
    run.file = "design";
    run.driveTime = {0.0, 1.0};
    run.driveDisplacement = {0.0, 0.0};
    const auto go = [&](double to, double time) {
        run.driveTime.push_back(run.driveTime.back() + time);
        run.driveDisplacement.push_back(to);
    };
    for (std::size_t i = 0; i < places.size(); ++i) {
        go(places[i], std::abs(places[i] - run.driveDisplacement.back()) / speed);
        const double stay = i == 0 ? hold : places[i] == 0.0 && i + 1 < places.size() ? h.rest : 0.0;
        if (stay > 0.0)
            go(places[i], stay);
    }
    run.samplingRate = std::min(h.rate, std::clamp(2000.0 / run.driveTime.back(), 5.0, 1000.0));
    return run;
}

struct Plan {
    std::string what;
    Run run;
    std::vector<double> markers{}; ///< Design::markers
};

/// Where markers say most: near the ends, and between them and the clamp, which is where it was put.
std::vector<double> placesOfMarkers(const experiment::Experiment& e) {
    switch (e.specimens.front().clamp.where) {
    case experiment::ClampPlace::Middle:
        return {0.02, 0.18, 0.34, 0.66, 0.82, 0.98};
    case experiment::ClampPlace::FirstEnd:
        return {0.25, 0.5, 0.75, 0.98};
    case experiment::ClampPlace::None:
        break;
    }
    return {0.02, 0.25, 0.5, 0.75, 0.98};
}

/// Frames of the recorded runs' camera, Hz; 0: there was none.
double framesOf(const experiment::Experiment& e) {
    double rate = 0.0;
    for (const Run& run : e.runs) {
        const double step = experiment::medianStep(run.markers.time);
        if (!e.markers.empty() && (step > 0.0 || !run.markersFile.empty()))
            rate = std::max({rate, run.markersSamplingRate, step > 0.0 ? 1.0 / step : 0.0});
    }
    return rate;
}

constexpr double kUsualFrames = 4.0; // Hz, of a camera

std::vector<Plan> plansFor(const experiment::Experiment& e) {
    const Habits h = habitsOf(e);
    if (h.travel <= 0.0 || h.fastest <= 0.0)
        return {};
    const auto speed = [](double v) {
        char text[40];
        std::snprintf(text, sizeof text, "%.3g mm/s", 1e3 * v);
        return std::string(text);
    };
    const double d = h.travel;
    std::vector<Plan> plans;
    if (!h.back) // what is lost shows on the way back first of all
        plans.push_back({"the same way and back again (an unloading leg)", through(h, {d, 0.0}, h.fastest)});
    const std::vector<Plan> usual = {
        {"a run ten times slower, at " + speed(0.1 * h.slowest), through(h, {d, 0.0}, 0.1 * h.slowest)},
        {"a hold of 100 s at the largest displacement", through(h, {d, 0.0}, h.fastest, 100.0)},
        {"five small cycles between 60 % and 50 % of the largest displacement",
         through(h, {0.6 * d, 0.5 * d, 0.6 * d, 0.5 * d, 0.6 * d, 0.5 * d, 0.6 * d, 0.5 * d, 0.6 * d, 0.5 * d, 0.0},
                 h.slowest)},
        {"a displacement larger by a tenth", through(h, {1.1 * d, 0.0}, h.fastest)},
        {"two cycles, the first to half of the displacement", through(h, {0.5 * d, 0.0, d, 0.0}, h.fastest)},
        {"six cycles at " + speed(h.fastest), through(h, {d, 0.0, d, 0.0, d, 0.0, d, 0.0, d, 0.0, d, 0.0}, h.fastest)}};
    plans.insert(plans.end(), usual.begin(), usual.end());
    const double frames = framesOf(e);
    if (frames == 0.0) { // markers that are described and were never tracked are no others
        const std::vector<double> places = e.markers.empty() ? placesOfMarkers(e) : std::vector<double>{};
        const std::string where = e.specimens.size() > 1 ? "each specimen" : "the specimen";
        plans.push_back(
            {"a run that is filmed, with " +
                 (places.empty() ? std::string("its markers") : std::to_string(places.size()) + " markers on " + where),
             through(h, {d, 0.0}, h.fastest), places});
        plans.back().run.markersSamplingRate = kUsualFrames;
    }
    // What sits in the specimen goes to the other side, what sits in the set-up does not. A ring has no ends.
    if (e.protocol != experiment::Protocol::RingBetweenPlates) {
        plans.push_back({std::string("a run with ") + (e.specimens.size() > 1 ? "both specimens" : "the specimen") +
                             " turned end for end",
                         through(h, {d, 0.0}, h.fastest)});
        plans.back().run.turned = true;
    }
    constexpr double kMost = 400.0; // frames
    for (Plan& p : plans)
        p.run.markersSamplingRate =
            std::min(std::max(frames, p.run.markersSamplingRate), kMost / p.run.driveTime.back());
    return plans;
}

} // namespace

std::vector<Design> designsFor(const experiment::Experiment& e) {
    std::vector<Design> all;
    for (const Plan& p : plansFor(e))
        all.push_back({p.what, 0, p.run.driveTime, p.run.driveDisplacement, p.run.samplingRate, p.run.turned, p.markers,
                       p.run.markersSamplingRate});
    return all;
}

experiment::Experiment designed(const experiment::Experiment& e, std::size_t index) {
    experiment::Experiment out = e;
    const Plan plan = plansFor(e)[index];
    out.runs = {plan.run};
    for (std::size_t s = 0; s < e.specimens.size(); ++s)
        for (const double at : plan.markers)
            out.markers.push_back({"m" + std::to_string(out.markers.size()), s, at, {}, {}});
    return out;
}

} // namespace supercircle::diagnosis
