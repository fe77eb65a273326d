#include "plugin/bench/bench_scaling.h"

#include "plugin/bench/bench_scene_run.h"
#include "plugin/cli/subcommands.h"
#include "plugin/recording/table/files.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>

namespace supercircle::cli {

namespace {

namespace fs = std::filesystem;

/// Box width and force grow with the square root of the number of shells, as in a scaled experiment.
struct StackSize {
    int shells;
    double width; ///< m
    int batchSize;
    double force; ///< N
};
constexpr std::array kSizes{StackSize{10, 0.115, 1, 2.89}, StackSize{30, 0.2, 3, 5.0}, StackSize{100, 0.365, 10, 9.13},
                            StackSize{300, 0.632, 20, 15.8}, StackSize{1000, 1.155, 40, 28.9}};

std::string rowName(int shells) {
    return "scaling/" + number("%04.0f", shells);
}

double sum(const VirtualThreads::Costs& costs) {
    double all = 0.0;
    for (const VirtualThreads::Cost& cost : costs)
        all += cost.total;
    return all;
}

/// Counters and CPU time of one solve.
struct SolveSample {
    double contacts, activeContacts, pivots, factorisations, iterations, ms, solverMs;
    bool solved;
};

FullLoad fullLoad(const std::vector<SolveSample>& solves) {
    FullLoad out;
    double most = 0.0;
    for (const SolveSample& s : solves)
        most = std::max(most, s.activeContacts);
    for (const SolveSample& s : solves) {
        if (s.activeContacts < 0.9 * most)
            continue;
        out.solves += 1.0;
        out.contacts += s.contacts;
        out.activeContacts += s.activeContacts;
        out.pivots += s.pivots;
        out.mostPivots = std::max(out.mostPivots, s.pivots);
        out.factorisations += s.factorisations;
        out.iterations += s.iterations;
        out.ms += s.ms;
        out.solverMs += s.solverMs;
        out.pathOnly += s.iterations > 0.0 ? 0.0 : 1.0;
        out.unsolved += s.solved ? 0.0 : 1.0;
    }
    const double n = std::max(1.0, out.solves);
    for (double* mean : {&out.contacts, &out.activeContacts, &out.pivots, &out.factorisations, &out.iterations, &out.ms,
                         &out.solverMs, &out.pathOnly, &out.unsolved})
        *mean /= n;
    return out;
}

/// Collects the costs of a run.
class RunObserver {
public:
    lab::RunOptions options() {
        lab::RunOptions o;
        o.loop = threads_.loop();
        o.interrupt = &interrupted;
        o.onStage = [this](step::Stage stage) { threads_.enter(stage); };
        o.progress = [this](const lab::RunProgress& p) { progress(p); };
        o.onSolve = [this](const coulomb::Problem& problem, const coulomb::SolveReport& report) {
            solved(problem, report);
        };
        return o;
    }

    void report(ScalingRow& row) {
        row.reached = reached_;
        row.costs = threads_.costs();
        (inCycle_ ? row.cycleCpu : row.dropCpu) = sum(row.costs);
        if (inCycle_)
            row.dropCpu = dropCpu_;
        row.solves = static_cast<double>(solves_.size());
        for (const SolveSample& s : solves_)
            row.contacts = std::max(row.contacts, s.contacts);
        row.full = fullLoad(solves_);
    }

private:
    void progress(const lab::RunProgress& p) {
        reached_ = p.phase + ", " + number("%.3g N", p.force);
        if (inCycle_ || p.phase.rfind("load", 0) != 0)
            return;
        inCycle_ = true;
        dropCpu_ = sum(threads_.costs());
        threads_.reset();
        solves_.clear();
        before_ = beforeSolver_ = 0.0;
    }

    void solved(const coulomb::Problem& problem, const coulomb::SolveReport& report) {
        const VirtualThreads::Costs& costs = threads_.costs();
        const double now = sum(costs), solver = costs[static_cast<std::size_t>(step::Stage::Solve)].total;
        solves_.push_back({static_cast<double>(problem.contacts.size()), static_cast<double>(report.activeContacts),
                           static_cast<double>(report.pivots), static_cast<double>(report.factorisations),
                           static_cast<double>(report.gaussSeidelIterations), 1e3 * (now - before_),
                           1e3 * (solver - beforeSolver_), report.converged});
        before_ = now;
        beforeSolver_ = solver;
    }

    VirtualThreads threads_;
    std::vector<SolveSample> solves_;
    std::string reached_ = "nothing";
    bool inCycle_ = false;
    double dropCpu_ = 0.0, before_ = 0.0, beforeSolver_ = 0.0;
};

std::string runSize(const StackSize& size, ScalingRow& row) {
    RunObserver observer;
    lab::RunResult out;
    const std::string error =
        runBenchmarkScene("stack30",
                          {"shells=" + std::to_string(size.shells), "width=" + number("%g", size.width),
                           "batch_size=" + std::to_string(size.batchSize), "max_force=" + number("%g", size.force)},
                          observer.options(), out);
    if (!error.empty())
        return error;
    row.shells = size.shells;
    row.complete = out.status == lab::RunStatus::Done;
    observer.report(row);
    for (const auto& [name, value] : out.recording.summary)
        if (const auto* steps = std::get_if<std::int64_t>(&value);
            steps != nullptr && name == (row.cycleCpu > 0.0 ? "protocol_steps" : "steps"))
            row.steps = static_cast<double>(*steps);
    row.memory = peakMemory();
    return saveScaling(row);
}

/// The rows of this benchmark run.
std::vector<ScalingRow>& measured() {
    static std::vector<ScalingRow> rows;
    return rows;
}

Measurement measurementOf(const ScalingRow& row) {
    Measurement m = summarise(rowName(row.shells), {1e3 * (row.dropCpu + row.cycleCpu)});
    m.more = {
        {"complete", row.complete ? 1.0 : 0.0}, {"contacts", row.contacts},    {"drop_cpu_s", row.dropCpu},
        {"cycle_cpu_s", row.cycleCpu},          {"full_load_ms", row.full.ms}, {"full_load_pivots", row.full.pivots}};
    return m;
}

std::string finish(const std::vector<Measurement>&, const std::string& json) {
    const std::vector<ScalingRow>& rows = measured();
    if (rows.empty())
        return {};
    std::printf("\n%s\n", scalingTables(rows).c_str());
    if (json.empty())
        return {};
    std::string error;
    const std::string png = scalingPicture(rows, error);
    if (!error.empty())
        return error;
    const fs::path file = fs::path(json).replace_extension(".png");
    return record::writeAtomically(file.parent_path().string(), {{file.filename().string(), png}}).error();
}

} // namespace

double ScalingRow::speedUp(std::size_t i) const {
    VirtualThreads::Cost all;
    for (const VirtualThreads::Cost& cost : costs)
        all += cost;
    return all.total > 0.0 ? all.total / all.time(i) : 0.0;
}

void addScalingBenchmarks(std::vector<Benchmark>& all) {
    Benchmark b;
    for (const StackSize& size : kSizes)
        b.names.push_back(rowName(size.shells));
    b.prefix = "scaling";
    b.measure = [](const auto& wanted, const auto& done) {
        for (const StackSize& size : kSizes) {
            if (!wanted(rowName(size.shells)))
                continue;
            ScalingRow row;
            if (!loadScaling(size.shells, row))
                if (std::string error = runSize(size, row); !error.empty())
                    return error;
            measured().push_back(row);
            done(measurementOf(row));
        }
        return std::string();
    };
    b.finish = finish;
    all.push_back(std::move(b));
}

} // namespace supercircle::cli
