// Cost and accuracy, six noise-free recordings of the reference simulator, one core.
//
// | fidelity | arcs | CPU per run | force against 121 arcs and finer steps, rms of 95 % of the rows over the peak |
// |---|---|---|---|
// | coarse | 11 | 0.01 to 0.05 s | 0.03 to 0.2 % |
// | fine | 21 | 0.04 to 0.14 s | 0.003 to 0.02 % |
// | finer | 41 | 0.1 to 0.4 s | 0.0005 to 0.02 % |
//
// Steps are limited by travel, so runs of different speed have equal steps. Linear interpolation of readings adds 1e-5
// of the peak outside jumps. Effects act in the world, the set-up (test_rig.cpp), the drive (drive.cpp), and between
// trace and readings.

#include "plugin/identification/replay/simulate.h"

#include "plugin/identification/replay/drive.h"
#include "plugin/identification/replay/free_scene.h"
#include "plugin/identification/replay/load_course.h"
#include "plugin/identification/replay/pulled_taut.h"
#include "plugin/identification/replay/scene_of_run.h"
#include "plugin/identification/replay/test_rig.h"
#include "plugin/identification/replay/trace.h"
#include "supercircle/effects/effect.h"
#include "supercircle/effects/sensor.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

namespace supercircle::replay {

namespace {

using experiment::Experiment;
using experiment::Run;
using rod::Vec2;

double cpuClock() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Rows and weights of linear interpolation at given times; times after the end are omitted.
struct Weights {
    std::vector<std::size_t> row; ///< interpolate between row and row + 1
    std::vector<double> share;

    Weights(const std::vector<double>& trace, const std::vector<double>& at) {
        std::size_t i = 0;
        for (const double t : at) {
            if (trace.size() < 2 || t > trace.back() + 1e-9)
                return;
            while (i + 2 < trace.size() && trace[i + 1] < t)
                ++i;
            row.push_back(i);
            share.push_back(std::clamp((t - trace[i]) / std::max(trace[i + 1] - trace[i], 1e-300), 0.0, 1.0));
        }
    }
    template <class Value>
    [[nodiscard]] double at(std::size_t k, Value&& value) const {
        return (1.0 - share[k]) * value(row[k]) + share[k] * value(row[k] + 1);
    }
};

std::vector<double> evenTimes(const Run& run, double rate) {
    std::vector<double> times;
    const double span = run.driveTime.back() - run.driveTime.front();
    for (std::size_t i = 0; rate > 0.0 && static_cast<double>(i) / rate < span - 1e-9; ++i)
        times.push_back(run.driveTime.front() + static_cast<double>(i) / rate);
    return times;
}

/// Removes impacts between rigid and inextensible parts: forces ten times those on either side, impulses over one step
/// that no load cell shows.
void withoutImpacts(std::vector<ForceSample>& readings) {
    constexpr std::ptrdiff_t kNear = 3, kFar = 8;
    constexpr double kShare = 10.0;
    std::vector<double> force, sizes;
    for (const ForceSample& r : readings) {
        force.push_back(r.force);
        sizes.push_back(std::abs(r.force));
    }
    const auto n = static_cast<std::ptrdiff_t>(force.size());
    const double scale = upperMedian(std::move(sizes));
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        double around = scale, before = 0.0, after = 0.0;
        for (std::ptrdiff_t k = kNear; k <= kFar; ++k) {
            const double b = force[static_cast<std::size_t>(std::max<std::ptrdiff_t>(i - k, 0))];
            const double a = force[static_cast<std::size_t>(std::min<std::ptrdiff_t>(i + k, n - 1))];
            around = std::max({around, std::abs(b), std::abs(a)});
            if (k == kNear) {
                before = b;
                after = a;
            }
        }
        if (std::abs(force[static_cast<std::size_t>(i)]) > kShare * around)
            readings[static_cast<std::size_t>(i)].force = 0.5 * (before + after);
    }
}

/// The compared channel of a scene where it is another one: of a shell, or the travel.
void readObserved(const Trace& trace, const Run& run, const effects::SensorModel& sensor, Simulated& out) {
    out.trace.time = trace.time;
    out.trace.displacement.clear();
    for (const double t : trace.time)
        out.trace.displacement.push_back(experiment::commanded(run, t));
    out.trace.force = trace.observed.value.empty() ? out.trace.displacement : trace.observed.value;
    out.readings.force.clear();
    const Weights at(trace.time, out.readings.time);
    for (std::size_t k = 0; k < at.row.size(); ++k)
        out.readings.force.push_back(trace.observed.value.empty()
                                         ? out.readings.displacement[k]
                                         : trace.observed.at(trace.time, at.row[k], out.readings.time[k]));
    for (std::vector<double>* column : {&out.readings.time, &out.readings.displacement})
        column->resize(out.readings.force.size());
    for (experiment::Readings* rows : {&out.readings, &out.trace}) {
        effects::SensorChain chain(sensor);
        for (std::size_t k = 0; k < rows->time.size() && sensor.on(); ++k)
            rows->force[k] = chain.read(rows->time[k], rows->force[k]);
    }
}

/// Channels beside the first one: of a shell, the machine's force (as a load cell reads it) or the travel.
void readFurther(const Trace& trace, const Experiment& e, const Run& run, const Parameters& p, Simulated& out) {
    const std::vector<double>& times = out.readings.time;
    const Weights shells(trace.time, times);
    std::vector<double> forceTimes;
    for (const ForceSample& reading : trace.forces)
        forceTimes.push_back(reading.time);
    const Weights forces(forceTimes, times);
    for (std::size_t k = 0; k < e.scene->further.size(); ++k) {
        const scene::Observation& o = e.scene->further[k].observation;
        std::vector<double> column;
        for (std::size_t i = 0; i < times.size(); ++i) {
            double v = std::numeric_limits<double>::quiet_NaN();
            if (o.of == scene::Observation::Of::Shell && i < shells.row.size())
                v = trace.further[k].at(trace.time, shells.row[i], times[i]);
            else if (o.quantity == scene::Observation::Quantity::Travel)
                v = experiment::commanded(run, times[i]);
            else if (o.of == scene::Observation::Of::Machine && i < forces.row.size())
                v = forces.at(i, [&](std::size_t row) { return trace.forces[row].force; });
            column.push_back(v);
        }
        readBy(effects::sensorOf(p.effects, e.scene->further[k].observe), times, p.furtherZero[k], column);
        out.readings.further.push_back(std::move(column));
    }
}

/// Gain and drift of a load cell, which act on a reading at once: at its own time, not between steps.
effects::SensorChain instantPart(effects::SensorModel sensor, const Run& run) {
    sensor.delay = sensor.lag = 0.0;
    effects::SensorChain chain(sensor);
    chain.read(run.driveTime.front(), 0.0); // the drift begins with the test
    return chain;
}

void read(const Trace& trace, const Experiment& e, const Run& run, const effects::SensorModel& sensor, Simulated& out) {
    const std::vector<double>& times = run.readings.time.empty() ? evenTimes(run, run.samplingRate) : run.readings.time;
    std::vector<double> forceTimes;
    for (const ForceSample& reading : trace.forces)
        forceTimes.push_back(reading.time);
    const Weights at(forceTimes, times);
    experiment::Readings& r = out.readings;
    double sum = 0.0;
    std::size_t count = 0;
    effects::SensorChain rows = instantPart(sensor, run), steps = rows;
    for (std::size_t k = 0; k < at.row.size(); ++k) {
        r.time.push_back(times[k]);
        r.displacement.push_back(experiment::commanded(run, times[k]));
        r.force.push_back(rows.read(times[k], at.at(k, [&](std::size_t i) { return trace.forces[i].force; })));
        if (times[k] < times.front() + e.sensors.forceZeroWindow) {
            sum += r.force.back();
            ++count;
        }
    }
    out.forceZero = count > 0 ? sum / static_cast<double>(count) : 0.0;
    for (double& f : r.force)
        f -= out.forceZero;
    for (const ForceSample& reading : trace.forces) {
        out.trace.time.push_back(reading.time);
        out.trace.displacement.push_back(experiment::commanded(run, reading.time));
        out.trace.force.push_back(steps.read(reading.time, reading.force) - out.forceZero);
    }
    const std::vector<double> markerTimes =
        run.markers.time.empty() ? evenTimes(run, run.markersSamplingRate) : run.markers.time;
    const Weights seen(trace.time, markerTimes);
    out.markers.time.assign(markerTimes.begin(), markerTimes.begin() + static_cast<std::ptrdiff_t>(seen.row.size()));
    for (const std::vector<Vec2>& marker : trace.markers) {
        out.markers.x.emplace_back();
        out.markers.y.emplace_back();
        for (std::size_t k = 0; k < seen.row.size(); ++k) {
            out.markers.x.back().push_back(seen.at(k, [&](std::size_t i) { return marker[i].x(); }));
            out.markers.y.back().push_back(seen.at(k, [&](std::size_t i) { return marker[i].y(); }));
        }
    }
}

} // namespace

bool comparesForce(const Experiment& e) {
    return !e.scene || e.scene->observation.quantity == scene::Observation::Quantity::Force;
}

Resolution Resolution::fine() {
    return {};
}

Resolution Resolution::coarse() {
    return {11, 1e-6, 5e-5, 0.5, 5e-3};
}

Resolution Resolution::in(const experiment::NaturalUnits& units) const {
    Resolution r = *this;
    r.positionTolerance *= units.length;
    r.travelMax *= units.length;
    r.dtMax *= units.settling;
    r.freeStep *= units.time;
    return r;
}

Resolution Resolution::finer() {
    Resolution r = fine();
    r.elements = 41;
    r.freeStep *= 0.5;
    return r;
}

Simulated simulate(const Experiment& e, std::size_t run, const Parameters& parameters, const Resolution& resolution,
                   const Options& options) {
    Simulated out;
    const double begin = cpuClock();
    if (run >= e.runs.size()) {
        out.failure = "there is no run " + std::to_string(run + 1);
        return out;
    }
    if (experiment::isMechanism(e)) {
        out = simulateFree(e, run, parameters, resolution, options);
        out.cpuSeconds = cpuClock() - begin;
        return out;
    }
    std::optional<LoadCourse> loads;
    if (experiment::drivesLoad(e)) {
        loads.emplace(e, run, parameters);
        if (out.failure = loads->failure(); !out.failure.empty())
            return out;
    }
    Parameters first = parameters; // a driven load starts with the first value of the drive
    if (loads)
        first.scene.push_back({e.scene->driveParameter, -1, e.runs[run].driveDisplacement.front()});
    const std::optional<scene::Scene> scene = e.scene ? sceneOf(e, run, first, out.failure) : std::nullopt;
    if (scene && out.failure.empty())
        out.failure = pulledTaut(e, run, *scene, parameters.effects);
    if (!out.failure.empty())
        return out;
    TestRig rig = scene ? TestRig(e, *scene, parameters, loads ? LoadCourse::forRest(resolution) : resolution)
                        : TestRig(e, parameters, resolution, e.runs[run].specimenReversed);
    if (rig.failure().empty()) {
        const effects::Model common = effects::modelFor(parameters.effects, "all");
        Driven driven = drive(rig, e, e.runs[run], parameters.seriesCompliance, common.apparatus, options,
                              loads ? &*loads : nullptr);
        Trace& trace = driven.trace;
        out.stopped = driven.stopped;
        out.largestCurvatureChange = driven.largestCurvatureChange;
        trace.forces = despiked(trace.forces);
        withoutImpacts(trace.forces);
        const effects::SensorModel cell = comparesForce(e) ? common.sensor : effects::SensorModel{};
        effects::SensorModel remembers = cell; // delay and low pass
        remembers.gain = remembers.drift = remembers.driftRate = 0.0;
        effects::SensorChain sensor(remembers);
        for (ForceSample& reading : trace.forces)
            reading.force = sensor.read(reading.time, reading.force);
        read(trace, e, e.runs[run], cell, out);
        if (!comparesForce(e))
            readObserved(trace, e.runs[run], common.sensor, out);
        for (experiment::Readings* rows : {&out.readings, &out.trace})
            for (double& v : rows->force)
                v += parameters.readingZero;
        if (!experiment::furtherChannels(e).empty())
            readFurther(trace, e, e.runs[run], parameters, out);
    }
    out.failure = rig.failure();
    out.steps = rig.counters().steps;
    out.rejected = rig.counters().rejected;
    out.unconverged = rig.counters().unconverged;
    out.cpuSeconds = cpuClock() - begin;
    return out;
}

} // namespace supercircle::replay
