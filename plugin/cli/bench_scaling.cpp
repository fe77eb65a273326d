// Speed-up is worked out, not measured: a benchmark machine has a few shared cores, and on those a measured speed-up
// says more about the neighbours. One thread does everything; each loop that several threads could share is timed turn
// by turn and dealt out to 1 .. 64 imagined ones. Uneven turns, loops of too few turns and everything outside of loops
// count in full, and every loop costs kWake for waking and waiting. Shared caches and memory bandwidth are left out.

#include "plugin/cli/bench_scaling.h"

#include "plugin/cli/bench_run.h"
#include "plugin/cli/verbs.h"
#include "plugin/record/files.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sys/resource.h>

namespace supercircle::cli {

namespace {

namespace fs = std::filesystem;

constexpr double kWake = 5e-6; ///< s a loop; an empty one of TBB on two threads takes 0.6 us, because its caller does all

/// Box and force grow with the square root of the shells, as in a scaled copy of the experiment.
struct Size {
    int shells;
    double width; ///< m
    int together;
    double force; ///< N
};
constexpr std::array kSizes{Size{10, 0.115, 1, 2.89}, Size{30, 0.2, 3, 5.0}, Size{100, 0.365, 10, 9.13},
                            Size{300, 0.632, 20, 15.8}, Size{1000, 1.155, 40, 28.9}};

std::string number(const char* format, double value) {
    char text[48];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string rowName(int shells) {
    return "scaling/" + number("%04.0f", shells);
}

double cpuTime() {
    timespec t{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double figure(const record::Recording& recording, const std::string& key) {
    for (const auto& [name, value] : recording.summary)
        if (name == key) {
            if (const auto* d = std::get_if<double>(&value))
                return *d;
            if (const auto* i = std::get_if<std::int64_t>(&value))
                return static_cast<double>(*i);
        }
    return 0.0;
}

std::string runSize(const Size& size, ScalingRow& row) {
    VirtualThreads machine;
    bool inCycle = false;
    double inside = 0.0;
    std::array<double, VirtualThreads::kThreads.size()> before{};
    std::size_t loops = 0;
    lab::Options options;
    options.loop = machine.loop();
    options.progress = [&](const lab::Progress& p) {
        if (inCycle || p.phase.rfind("load", 0) != 0)
            return;
        inCycle = true;
        inside = machine.inside();
        loops = machine.loops();
        for (std::size_t i = 0; i < before.size(); ++i)
            before[i] = machine.makespan(i);
    };
    lab::Outcome out;
    const std::string error =
        runScene("stack30",
                 {"shells=" + std::to_string(size.shells), "width=" + number("%g", size.width),
                  "together=" + std::to_string(size.together), "max_force=" + number("%g", size.force)},
                 options, out);
    if (!error.empty())
        return error;
    row.shells = size.shells;
    row.complete = out.end == lab::End::Done;
    row.contacts = figure(out.recording, "contacts_max");
    row.loaded = figure(out.recording, "loaded_contacts_max");
    row.cycleCpu = figure(out.recording, "protocol_cpu_s");
    row.dropCpu = figure(out.recording, "cpu_s") - row.cycleCpu;
    row.steps = figure(out.recording, "protocol_steps");
    row.solves = figure(out.recording, "protocol_solves");
    row.pivots = figure(out.recording, "protocol_pivots");
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    row.memory = static_cast<double>(usage.ru_maxrss) / 1024.0;
    const double serial = std::max(0.0, row.cycleCpu - (machine.inside() - inside));
    for (std::size_t i = 0; inCycle && i < before.size(); ++i) {
        const double waking = i == 0 ? 0.0 : kWake * static_cast<double>(machine.loops() - loops);
        row.speedUp[i] = row.cycleCpu / (serial + machine.makespan(i) - before[i] + waking);
    }
    return {};
}

/// Hours of work are kept: a size whose figures lie in out/scaling is read from there.
std::string keptFile(int shells) {
    return "out/" + rowName(shells) + ".json";
}

std::string keep(const ScalingRow& row) {
    const nlohmann::json json = {{"shells", row.shells},
                                 {"complete", row.complete},
                                 {"contacts", row.contacts},
                                 {"loaded", row.loaded},
                                 {"drop_cpu_s", row.dropCpu},
                                 {"cycle_cpu_s", row.cycleCpu},
                                 {"steps", row.steps},
                                 {"solves", row.solves},
                                 {"pivots", row.pivots},
                                 {"memory_MB", row.memory},
                                 {"threads", VirtualThreads::kThreads},
                                 {"speed_up", row.speedUp}};
    const fs::path path(keptFile(row.shells));
    std::error_code ignored;
    fs::create_directories(path.parent_path(), ignored);
    return record::writeAtomically(path.parent_path().string(), {{path.filename().string(), json.dump(2) + "\n"}});
}

bool recall(int shells, ScalingRow& row) {
    std::ifstream file(keptFile(shells));
    const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
    if (!json.is_object() || json.value("threads", std::vector<int>{}) !=
                                 std::vector<int>(VirtualThreads::kThreads.begin(), VirtualThreads::kThreads.end()))
        return false;
    row.shells = json.value("shells", 0);
    row.complete = json.value("complete", false);
    row.contacts = json.value("contacts", 0.0);
    row.loaded = json.value("loaded", 0.0);
    row.dropCpu = json.value("drop_cpu_s", 0.0);
    row.cycleCpu = json.value("cycle_cpu_s", 0.0);
    row.steps = json.value("steps", 0.0);
    row.solves = json.value("solves", 0.0);
    row.pivots = json.value("pivots", 0.0);
    row.memory = json.value("memory_MB", 0.0);
    row.speedUp = json.value("speed_up", row.speedUp);
    return row.shells == shells;
}

/// The rows of this run, for the table below them.
std::vector<ScalingRow>& measured() {
    static std::vector<ScalingRow> rows;
    return rows;
}

Measurement measurementOf(const ScalingRow& row) {
    Measurement m = summarise(rowName(row.shells), {1e3 * (row.dropCpu + row.cycleCpu)});
    m.more = {{"complete", row.complete ? 1.0 : 0.0},
              {"contacts", row.contacts},
              {"loaded", row.loaded},
              {"drop_cpu_s", row.dropCpu},
              {"cycle_cpu_s", row.cycleCpu},
              {"solves", row.solves}};
    return m;
}

std::string finish(const std::vector<Measurement>&, const std::string& json) {
    const std::vector<ScalingRow>& rows = measured();
    if (rows.empty())
        return {};
    std::printf("\n%s\n", scalingTable(rows).c_str());
    if (json.empty())
        return {};
    std::string error;
    const std::string png = scalingPicture(rows, error);
    if (!error.empty())
        return error;
    const fs::path file = fs::path(json).replace_extension(".png");
    return record::writeAtomically(file.parent_path().string(), {{file.filename().string(), png}});
}

} // namespace

parallel::For VirtualThreads::loop() {
    return [this](std::size_t count, const std::function<void(std::size_t)>& body) {
        turns_.clear();
        for (std::size_t i = 0; i < count; ++i) {
            const double start = cpuTime();
            body(i);
            turns_.push_back(cpuTime() - start);
        }
        deal();
    };
}

void VirtualThreads::deal() {
    ++loops_;
    for (const double turn : turns_)
        inside_ += turn;
    for (std::size_t i = 0; i < kThreads.size(); ++i) {
        load_.assign(static_cast<std::size_t>(kThreads[i]), 0.0);
        for (const double turn : turns_)
            *std::min_element(load_.begin(), load_.end()) += turn;
        makespan_[i] += *std::max_element(load_.begin(), load_.end());
    }
}

std::string scalingTable(const std::vector<ScalingRow>& rows) {
    std::string out =
        "| shells | contacts | loaded | drop, CPU s | cycle, CPU s | solves | ms a solve | pivots a solve | "
        "memory, MB |";
    std::string rule = "\n|---:|---:|---:|---:|---:|---:|---:|---:|---:|";
    for (const int threads : VirtualThreads::kThreads)
        if (threads > 1) {
            out += " x" + std::to_string(threads) + " |";
            rule += "---:|";
        }
    out += rule;
    for (const ScalingRow& row : rows) {
        const double solves = std::max(1.0, row.solves);
        out += "\n| " + std::to_string(row.shells) + (row.complete ? "" : " (stopped)");
        for (const auto& [format, value] :
             {std::pair{"%.0f", row.contacts}, std::pair{"%.0f", row.loaded}, std::pair{"%.3g", row.dropCpu},
              std::pair{"%.4g", row.cycleCpu}, std::pair{"%.0f", row.solves},
              std::pair{"%.3g", 1e3 * row.cycleCpu / solves}, std::pair{"%.3g", row.pivots / solves},
              std::pair{"%.0f", row.memory}})
            out += " | " + number(format, value);
        for (std::size_t i = 1; i < row.speedUp.size(); ++i)
            out += " | " + (row.speedUp[i] > 0.0 ? number("%.2f", row.speedUp[i]) : std::string("-"));
        out += " |";
    }
    return out + "\n";
}

void addScalingBenchmarks(std::vector<Benchmark>& all) {
    Benchmark b;
    for (const Size& size : kSizes)
        b.names.push_back(rowName(size.shells));
    b.prefix = "scaling";
    b.measure = [](const auto& wanted, const auto& done) {
        for (const Size& size : kSizes) {
            if (!wanted(rowName(size.shells)))
                continue;
            ScalingRow row;
            if (!recall(size.shells, row)) {
                if (std::string error = runSize(size, row); !error.empty())
                    return error;
                if (std::string error = keep(row); !error.empty())
                    return error;
            }
            measured().push_back(row);
            done(measurementOf(row));
        }
        return std::string();
    };
    b.finish = finish;
    all.push_back(std::move(b));
}

} // namespace supercircle::cli
