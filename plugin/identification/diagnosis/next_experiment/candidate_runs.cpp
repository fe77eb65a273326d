#include "plugin/identification/diagnosis/next_experiment/candidate_runs.h"

#include "plugin/identification/replay/free_scales.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace supercircle::diagnosis {

namespace {

using experiment::Run;

/// Properties of the recorded runs that further runs take over.
struct RunProperties {
    double travel = 0.0, slowest = 0.0, fastest = 0.0; ///< m, m/s
    double rate = 0.0;                                 ///< Hz, the highest
    double second = 1.0;                               ///< s, natural unit of time
    double dwell = 1.0;                                ///< s, longest dwell before a stroke, one to ten natural ones
    double longest = 0.0;                              ///< s, run
    bool unloads = false;                              ///< some run unloads by half of its displacement
};

RunProperties runPropertiesOf(const experiment::Experiment& e) {
    RunProperties h;
    h.second = h.dwell = replay::naturalUnits(e).time;
    for (const Run& run : e.runs) {
        h.rate = std::max(h.rate, run.samplingRate);
        h.longest =
            run.driveTime.empty() ? h.longest : std::max(h.longest, run.driveTime.back() - run.driveTime.front());
        for (std::size_t i = 1; i < run.driveTime.size(); ++i) {
            h.travel = std::max(h.travel, run.driveDisplacement[i]);
            if (run.driveDisplacement[i - 1] == 0.0 && run.driveDisplacement[i] == 0.0)
                h.dwell = std::clamp(run.driveTime[i] - run.driveTime[i - 1], h.dwell, 10.0 * h.second);
            h.unloads = h.unloads || run.driveDisplacement[i] < 0.5 * run.driveDisplacement[i - 1];
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

/// A run through these displacements after a natural second of rest, with a dwell before each new loading: a released
/// specimen oscillates, and its next contact depends on the damping.
Run runThrough(const RunProperties& h, const std::vector<double>& displacements, double speed, double hold = 0.0) {
    Run run;
    run.file = "design";
    run.driveTime = {0.0, h.second};
    run.driveDisplacement = {0.0, 0.0};
    const auto go = [&](double to, double time) {
        run.driveTime.push_back(run.driveTime.back() + time);
        run.driveDisplacement.push_back(to);
    };
    for (std::size_t i = 0; i < displacements.size(); ++i) {
        go(displacements[i], std::abs(displacements[i] - run.driveDisplacement.back()) / speed);
        const double stay = i == 0 ? hold : displacements[i] == 0.0 && i + 1 < displacements.size() ? h.dwell : 0.0;
        if (stay > 0.0)
            go(displacements[i], stay);
    }
    run.samplingRate = std::min(h.rate, std::clamp(2000.0 / run.driveTime.back(), 5.0 / h.second, 1000.0 / h.second));
    return run;
}

struct PlannedRun {
    std::string description;
    Run run;
    std::vector<double> markers{}; ///< CandidateRun::markers
    std::size_t of = 0;            ///< index of the recorded run that it varies
    std::vector<ChangedParameter> changed{};
};

/// Marker positions that determine most: near the ends, and between them and the clamp.
std::vector<double> markerPositions(const experiment::Experiment& e) {
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

/// Frame rate of the camera of the recorded runs, Hz; 0: there was none.
double frameRateOf(const experiment::Experiment& e) {
    double rate = 0.0;
    for (const Run& run : e.runs) {
        const double step = experiment::medianStep(run.markers.time);
        if (!e.markers.empty() && (step > 0.0 || !run.markersFile.empty()))
            rate = std::max({rate, run.markersSamplingRate, step > 0.0 ? 1.0 / step : 0.0});
    }
    return rate;
}

constexpr double kUsualFrames = 4.0;           // per natural second, of a camera
constexpr double kHold = 100.0, kOfRuns = 1.5; // natural s, of the longest run: the longer of both is held

/// Tables of loads or displacements in even steps, as many in a direction as the longest recorded one has rows.
std::vector<PlannedRun> plannedTables(const experiment::Experiment& e, const RunProperties& h) {
    constexpr std::size_t kFewest = 8; // rows in a direction
    std::size_t rows = kFewest;
    for (const Run& run : e.runs)
        rows = std::max(rows, run.readings.time.size());
    const auto through = [&](const std::vector<double>& turns) {
        Run run;
        run.file = "design";
        double from = 0.0;
        run.driveTime = {0.0};
        run.driveDisplacement = {0.0};
        for (const double to : turns) {
            for (std::size_t k = 1; k <= rows; ++k) {
                run.driveTime.push_back(run.driveTime.back() + 1.0 / h.rate);
                run.driveDisplacement.push_back(from +
                                                (to - from) * static_cast<double>(k) / static_cast<double>(rows));
            }
            from = to;
        }
        run.samplingRate = h.rate;
        return run;
    };
    const std::string what = experiment::drivesLoad(e) ? "load" : "displacement";
    std::vector<PlannedRun> planned;
    if (!h.unloads)
        planned.push_back({"a table with the way back, " + std::to_string(rows) + " rows in each direction",
                           through({h.travel, 0.0})});
    planned.push_back({"a table to a " + what + " larger by half, and back", through({1.5 * h.travel, 0.0})});
    planned.push_back({"a table to half of the " + what + " and back, then to all of it and back",
                       through({0.5 * h.travel, 0.0, h.travel, 0.0})});
    return planned;
}

std::string seconds(double t) {
    char text[40];
    std::snprintf(text, sizeof text, t < 100.0 ? "%.2g s" : "%.0f s", t);
    return text;
}

/// A parameter that a run states for itself: release, load, added mass.
struct OwnValue {
    std::size_t run = 0;
    const experiment::SceneParameter* parameter = nullptr;
};
/// The largest one of each name that is not 0.
std::vector<OwnValue> largestOwnValues(const experiment::Experiment& e) {
    std::vector<OwnValue> out;
    for (std::size_t r = 0; r < e.runs.size(); ++r)
        for (const experiment::SceneParameter& p : e.runs[r].parameters) {
            const auto known =
                std::find_if(out.begin(), out.end(), [&](const OwnValue& o) { return o.parameter->name == p.name; });
            if (known == out.end())
                out.push_back({r, &p});
            else if (std::abs(p.stated.value) > std::abs(known->parameter->stated.value))
                *known = {r, &p};
        }
    std::erase_if(out, [](const OwnValue& o) { return o.parameter->stated.value == 0.0; });
    return out;
}

/// A recorded run once more, without its readings.
Run again(const Run& recorded) {
    Run run;
    run.file = "design";
    run.driveTime = recorded.driveTime;
    run.driveDisplacement = recorded.driveDisplacement;
    const double step = experiment::medianStep(recorded.readings.time);
    run.samplingRate = recorded.samplingRate > 0.0 || step <= 0.0 ? recorded.samplingRate : 1.0 / step;
    const double frames = experiment::medianStep(recorded.markers.time);
    run.markersSamplingRate =
        recorded.markersSamplingRate > 0.0 || frames <= 0.0 ? recorded.markersSamplingRate : 1.0 / frames;
    run.parameters = recorded.parameters;
    return run;
}

/// Recorded runs of a scene once more: longer where nothing is driven, and with other values of what they state for
/// themselves.
std::vector<PlannedRun> variedRuns(const experiment::Experiment& e) {
    // With a half more, what grows with the square of an amplitude is told from what is proportional to it; three times
    // as much is farther than most fixtures allow, but a scene knows its bounds.
    constexpr double kFactors[] = {0.5, 1.5, 3.0};
    // With half of the first a run adds half of itself to what was recorded; with twice as much its simulations take
    // twice as long, and so do they with twice the rows. Half of the rows leaves out long runs of fast cameras.
    constexpr double kLonger = 3.0, kMostRows = 6000.0, kWorthIt = 1.5;
    std::vector<PlannedRun> planned;
    const std::vector<OwnValue> own = largestOwnValues(e);
    const std::vector<std::string> names = experiment::runNames(e, true);
    std::vector<std::size_t> longer;
    for (const OwnValue& o : own)
        longer.push_back(o.run);
    if (longer.empty())
        longer.push_back(0);
    std::sort(longer.begin(), longer.end());
    longer.erase(std::unique(longer.begin(), longer.end()), longer.end());
    for (const std::size_t r : longer) {
        Run run = again(e.runs[r]);
        const double span = run.driveTime.back();
        const double factor = std::min(kLonger, kMostRows / std::max(1.0, span * run.samplingRate));
        if (!experiment::isFree(e) || experiment::isTable(e) || factor < kWorthIt)
            continue;
        run.driveTime.back() *= factor;
        planned.push_back({"the run " + names[r] + " again, recorded for " + seconds(run.driveTime.back()) +
                               " instead of " + seconds(span),
                           run,
                           {},
                           r});
    }
    for (const OwnValue& o : own)
        for (const double factor : kFactors) {
            const experiment::SceneParameter& p = *o.parameter;
            const ChangedParameter changed{p.name, p.unit, p.stated.value, factor * p.stated.value};
            char text[120];
            std::snprintf(text, sizeof text, "%.3g instead of %.3g%s", changed.to, changed.from,
                          p.unit.empty() || p.unit == "1" ? "" : (" " + p.unit).c_str());
            planned.push_back({"the run " + names[o.run] + " again, with " + p.name + " " + text,
                               again(e.runs[o.run]),
                               {},
                               o.run,
                               {changed}});
        }
    return planned;
}

std::vector<PlannedRun> drivenRuns(const experiment::Experiment& e) {
    const RunProperties h = runPropertiesOf(e);
    if (h.travel <= 0.0 || h.fastest <= 0.0)
        return {};
    if (experiment::isTable(e))
        return plannedTables(e, h);
    const bool load = experiment::drivesLoad(e);
    const std::string largest = load ? "largest load" : "largest displacement";
    const auto speed = [&](double v) {
        char text[40];
        std::snprintf(text, sizeof text, load ? "%.3g per s" : "%.3g mm/s", load ? v : 1e3 * v);
        return std::string(text);
    };
    const double d = h.travel, hold = std::max(kHold * h.second, kOfRuns * h.longest);
    std::vector<PlannedRun> planned;
    if (!h.unloads) // dissipation appears in unloading first
        planned.push_back({"the same loading followed by unloading", runThrough(h, {d, 0.0}, h.fastest)});
    const std::vector<PlannedRun> usual = {
        {"a run ten times slower, at " + speed(0.1 * h.slowest), runThrough(h, {d, 0.0}, 0.1 * h.slowest)},
        {"a hold of " + seconds(hold) + " at the " + largest, runThrough(h, {d, 0.0}, h.fastest, hold)},
        {"five small cycles between 60 % and 50 % of the " + largest,
         runThrough(h, {0.6 * d, 0.5 * d, 0.6 * d, 0.5 * d, 0.6 * d, 0.5 * d, 0.6 * d, 0.5 * d, 0.6 * d, 0.5 * d, 0.0},
                    h.slowest)},
        {std::string(load ? "a load" : "a displacement") + " larger by a tenth",
         runThrough(h, {1.1 * d, 0.0}, h.fastest)},
        {std::string("two cycles, the first to half of the ") + (load ? "load" : "displacement"),
         runThrough(h, {0.5 * d, 0.0, d, 0.0}, h.fastest)},
        {"six cycles at " + speed(h.fastest),
         runThrough(h, {d, 0.0, d, 0.0, d, 0.0, d, 0.0, d, 0.0, d, 0.0}, h.fastest)}};
    planned.insert(planned.end(), usual.begin(), usual.end());
    if (e.scene && e.scene->rubs && !load) // friction that grows with the time at rest shows at the next start
        planned.push_back({"half of the displacement, a hold of " + seconds(hold) + ", and the other half",
                           runThrough(h, {0.5 * d, d, 0.0}, h.fastest, hold)});
    const double frames = frameRateOf(e);
    if (frames == 0.0 && !e.scene) { // markers described but never tracked are used again
        const std::vector<double> displacements = e.markers.empty() ? markerPositions(e) : std::vector<double>{};
        const std::string where = e.specimens.size() > 1 ? "each specimen" : "the specimen";
        planned.push_back({"a filmed run with " + (displacements.empty()
                                                       ? std::string("its markers")
                                                       : std::to_string(displacements.size()) + " markers on " + where),
                           runThrough(h, {d, 0.0}, h.fastest), displacements});
        planned.back().run.markersSamplingRate = kUsualFrames / h.second;
    }
    // Defects of the specimen move to the other side, those of the set-up do not. A ring has no ends.
    if (e.protocol != experiment::Protocol::RingBetweenPlates && !e.scene) {
        planned.push_back({std::string("a run with ") + (e.specimens.size() > 1 ? "both specimens" : "the specimen") +
                               " mounted end for end",
                           runThrough(h, {d, 0.0}, h.fastest)});
        planned.back().run.specimenReversed = true;
    }
    constexpr double kMost = 400.0; // frames
    for (PlannedRun& p : planned)
        p.run.markersSamplingRate =
            std::min(std::max(frames, p.run.markersSamplingRate), kMost / p.run.driveTime.back());
    return planned;
}

std::vector<PlannedRun> plannedRuns(const experiment::Experiment& e) {
    std::vector<PlannedRun> planned = experiment::isFree(e) ? std::vector<PlannedRun>{} : drivenRuns(e);
    if (e.scene && !e.runs.empty())
        for (PlannedRun& p : variedRuns(e))
            planned.push_back(std::move(p));
    for (PlannedRun& p : planned) {
        p.run.specimen = e.runs[p.of].specimen;
        for (const ChangedParameter& c : p.changed)
            for (experiment::SceneParameter& own : p.run.parameters)
                own.stated.value += own.name == c.name ? c.to - c.from : 0.0;
    }
    return planned;
}

} // namespace

std::vector<CandidateRun> candidateRunsFor(const experiment::Experiment& e) {
    std::vector<CandidateRun> all;
    std::vector<double> further; // weights
    for (const experiment::FurtherChannel& c : experiment::furtherChannels(e))
        further.push_back(c.channel.weight);
    const bool free = experiment::isFree(e);
    for (const PlannedRun& p : plannedRuns(e))
        all.push_back({p.description, p.of, free ? std::vector<double>{} : p.run.driveTime,
                       free ? std::vector<double>{} : p.run.driveDisplacement, p.run.samplingRate,
                       p.run.specimenReversed, p.markers, p.run.markersSamplingRate, replay::naturalUnits(e),
                       experiment::channel(e).weight, further, experiment::isTable(e), experiment::drivesLoad(e),
                       p.changed, free ? p.run.driveTime.back() : 0.0});
    return all;
}

experiment::Experiment withCandidateRun(const experiment::Experiment& e, std::size_t index, replay::Parameters& p) {
    experiment::Experiment out = e;
    const PlannedRun plan = plannedRuns(e)[index];
    out.runs = {plan.run};
    const auto ofAnother = [&](const replay::SceneValue& v) {
        return v.run >= 0 && static_cast<std::size_t>(v.run) != plan.of;
    };
    std::erase_if(p.scene, ofAnother);
    for (replay::SceneValue& v : p.scene)
        if (v.run >= 0) {
            v.run = 0;
            for (const ChangedParameter& c : plan.changed) // with the deviation that was found
                v.value += v.name == c.name ? c.to - c.from : 0.0;
        }
    for (std::size_t s = 0; s < e.specimens.size(); ++s)
        for (const double at : plan.markers)
            out.markers.push_back({"m" + std::to_string(out.markers.size()), s, at, {}, {}});
    return out;
}

} // namespace supercircle::diagnosis
