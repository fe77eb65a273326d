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
    std::vector<double> markers{}; ///< Design::markers
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

std::vector<PlannedRun> plannedRuns(const experiment::Experiment& e) {
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
    const auto seconds = [](double t) {
        char text[40];
        std::snprintf(text, sizeof text, "%.2g s", t);
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

} // namespace

std::vector<CandidateRun> candidateRunsFor(const experiment::Experiment& e) {
    std::vector<CandidateRun> all;
    std::vector<double> further; // weights
    for (const experiment::FurtherChannel& c : experiment::furtherChannels(e))
        further.push_back(c.channel.weight);
    for (const PlannedRun& p : plannedRuns(e))
        all.push_back({p.description, 0, p.run.driveTime, p.run.driveDisplacement, p.run.samplingRate,
                       p.run.specimenReversed, p.markers, p.run.markersSamplingRate, replay::naturalUnits(e),
                       experiment::channel(e).weight, further, experiment::isTable(e), experiment::drivesLoad(e)});
    return all;
}

experiment::Experiment withCandidateRun(const experiment::Experiment& e, std::size_t index) {
    experiment::Experiment out = e;
    const PlannedRun plan = plannedRuns(e)[index];
    out.runs = {plan.run};
    for (std::size_t s = 0; s < e.specimens.size(); ++s)
        for (const double at : plan.markers)
            out.markers.push_back({"m" + std::to_string(out.markers.size()), s, at, {}, {}});
    return out;
}

} // namespace supercircle::diagnosis
