#include "plugin/identification/sensitivity/batch.h"

#include "plugin/identification/replay/free_scales.h"

#include <algorithm>
#include <limits>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace supercircle::sensitivity {

namespace {

using replay::Simulated;

void put(Eigen::VectorXd& to, std::size_t at, const std::vector<double>& from, std::size_t rows) {
    for (std::size_t k = 0; k < rows; ++k)
        to[static_cast<Eigen::Index>(at + k)] = k < from.size() ? from[k] : kNone;
}

} // namespace

SimulatedValues numbersOf(const Simulated& simulated, const Simulated& like) {
    SimulatedValues o;
    o.failure = simulated.failure;
    const std::size_t rows = like.readings.time.size(), seen = like.markers.time.size();
    o.force.resize(static_cast<Eigen::Index>(rows));
    put(o.force, 0, simulated.readings.force, rows);
    const std::size_t markers = seen > 0 ? like.markers.x.size() : 0;
    o.markers.resize(static_cast<Eigen::Index>(2 * markers * seen));
    for (std::size_t m = 0; m < markers; ++m) {
        put(o.markers, 2 * m * seen, m < simulated.markers.x.size() ? simulated.markers.x[m] : std::vector<double>{},
            seen);
        put(o.markers, (2 * m + 1) * seen,
            m < simulated.markers.y.size() ? simulated.markers.y[m] : std::vector<double>{}, seen);
    }
    return o;
}

Batch::Batch(const Model& model, const experiment::Experiment& experiment, const SensitivitySettings& settings)
    : model_(model), experiment_(experiment), settings_(settings) {}

bool Batch::stopped() const {
    return settings_.interrupt != nullptr && settings_.interrupt->load();
}

Simulated Batch::simulate(const SimulationJob& job) {
    replay::Options options;
    options.interrupt = settings_.interrupt;
    Simulated s = model_.simulate(job.run, job.values, options);
    const std::lock_guard<std::mutex> lock(callbackMutex_);
    ++done_;
    if (settings_.progress)
        settings_.progress(std::min(1.0, static_cast<double>(done_) / static_cast<double>(std::max(expected_, done_))));
    return s;
}

/// The scheduler assigns jobs; each result has its own place, so results do not depend on it.
void Batch::forEach(std::size_t count, const std::function<void(std::size_t)>& work) {
    const int jobs = std::max(1, settings_.jobs);
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(jobs));
    tbb::task_arena arena(jobs);
    arena.execute([&] {
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, 1),
            [&](const tbb::blocked_range<std::size_t>& range) {
                for (std::size_t i = range.begin(); i != range.end(); ++i)
                    work(i);
            },
            tbb::simple_partitioner());
    });
}

void Batch::runBases(Sensitivities& out) {
    std::vector<double> values;
    for (const Column& c : model_.columns)
        values.push_back(c.value);
    out.runs.resize(model_.runs);
    forEach(model_.runs, [&](std::size_t i) {
        if (stopped())
            return;
        RunSensitivity& run = out.runs[i];
        run.base = simulate({i, values});
        run.landmarks = measure(experiment_.runs[i], run.base.readings, &run.base.trace);
    });
    for (const RunSensitivity& run : out.runs) {
        ++out.simulations;
        out.cpuSeconds += run.base.cpuSeconds;
    }
    bases_ = &out;
}

std::vector<SimulatedValues> Batch::run(const std::vector<SimulationJob>& jobs, Sensitivities& out) {
    std::vector<SimulatedValues> results(jobs.size());
    std::vector<double> cost(jobs.size(), 0.0);
    forEach(jobs.size(), [&](std::size_t i) {
        if (stopped()) {
            results[i].failure = "interrupted";
            return;
        }
        const RunSensitivity& base = bases_->runs[jobs[i].run];
        const Simulated s = simulate(jobs[i]);
        results[i] = numbersOf(s, base.base);
        results[i].landmarks = measureLike(base.landmarks, experiment_.runs[jobs[i].run], s.readings, &s.trace,
                                           replay::naturalUnits(experiment_).time);
        cost[i] = s.cpuSeconds;
    });
    out.simulations += jobs.size();
    for (const double c : cost)
        out.cpuSeconds += c;
    return results;
}

} // namespace supercircle::sensitivity
