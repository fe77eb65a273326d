#include "plugin/bench/bench_welded_boxes.h"

#include "bridge/box2d/lab_world.h"
#include "plugin/cli/subcommands.h"
#include "plugin/recording/table/files.h"
#include "plugin/scene/player/dropper.h"
#include "supercircle/step/stepper.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>

namespace supercircle::cli {

namespace {

constexpr double kCylinderMass = 1e7; ///< kg, of the free cylinder: so heavy that its speed measures the force

std::string ourName(const char* scene, int arcs, Quality q) {
    return std::string("welded_boxes/") + scene + "/shells" + std::to_string(arcs) + "/" + nameOf(q);
}

std::string weldedName(const char* scene, const WeldedBoxSettings& s, int boxes) {
    return std::string("welded_boxes/") + scene + "/welded" + std::to_string(boxes) + (s.soft ? "/" : "_rigid/") +
           std::to_string(s.substeps);
}

} // namespace

GameRun weldedCylinder(const CylinderCase& which, const WeldedBoxSettings& settings, int boxes) {
    GameRun run;
    const ShellDef d = onCylinder(which, boxes, 0.01 * kGameRadius); // the corners of boxes protrude: start higher
    Shells posed(nullptr);
    WeldedShells welded(cylinderWorld(which.mu, kCylinderMass), settings);
    welded.add(d, *posed.pose(*posed.create(d)), true);
    std::unique_ptr<step::HostWorld> host;
    if (const std::string error = welded.build(host); !error.empty()) {
        run.failure = error;
        return run;
    }
    SustainedPeak peak(which.theory * bending_modulus(d) / (kGameRadius * kGameRadius));
    double before = 0.0;
    runFrames(run, travelOf(d) / kMachineSpeed, [&](double dt) {
        const double part = dt / settings.substeps;
        for (int i = 0; i < settings.substeps; ++i) {
            const step::BodyState s = host->stateOf(welded.heldBody());
            host->drive(welded.heldBody(), s.centre, s.angle, {0.0, -kMachineSpeed}, 0.0);
            host->step(part);
        }
        const double now = host->stateOf(1).velocity.y();
        peak.add((before - now) * kCylinderMass / dt);
        before = now;
        run.stretch = std::max(run.stretch, welded.stretch(*host));
        return dt;
    });
    run.peak = peak.highest();
    run.curves = welded.curves(*host);
    run.crossings = crossedPairs(run.curves, solids(*host, 1));
    return run;
}

GameRun weldedPile(const PileCase& pile, const WeldedBoxSettings& settings) {
    GameRun run;
    const scene::Drop drop = dropOf(pile);
    Shells posed(nullptr);
    player::Random random(pile.seed);
    std::vector<ShellHandle> made;
    player::dropBatch(posed, drop, pile.shells, random, made).or_fail();
    WeldedShells welded(boxWorld(pile), settings);
    for (const ShellHandle shell : made)
        welded.add(drop.shell, *posed.pose(shell), false);
    std::unique_ptr<step::HostWorld> host;
    if (const std::string error = welded.build(host); !error.empty()) {
        run.failure = error;
        return run;
    }
    runFrames(run, pile.seconds, [&](double dt) {
        for (int i = 0; i < settings.substeps; ++i)
            host->step(dt / settings.substeps);
        run.stretch = std::max(run.stretch, welded.stretch(*host));
        return dt;
    });
    run.curves = welded.curves(*host);
    run.crossings = crossedPairs(run.curves, solids(*host, 1));
    return run;
}

namespace {

constexpr int kSubsteps[] = {1, 16, 64, 256};

struct Job {
    std::string name;
    std::function<GameRun()> run;
};

std::vector<Job> jobs() {
    std::vector<Job> all;
    const auto add = [&all](std::string name, std::function<GameRun()> run) {
        all.push_back({std::move(name), std::move(run)});
    };
    for (const CylinderCase& c : kCylinders)
        for (const int arcs : {15, 31}) {
            for (const Quality q : {Quality::Game, Quality::Laboratory})
                add(ourName(c.name, arcs, q), [c, q, arcs] { return ourCylinder(c, q, arcs); });
            for (const int n : kSubsteps) {
                WeldedBoxSettings s;
                s.substeps = n;
                add(weldedName(c.name, s, arcs), [c, s, arcs] { return weldedCylinder(c, s, arcs); });
            }
        }
    for (const Quality q : {Quality::Game, Quality::Laboratory})
        add(ourName("pile", 15, q), [q] { return ourPile(PileCase{}, q); });
    for (const bool soft : {true, false})
        for (const int n : kSubsteps) {
            WeldedBoxSettings s;
            s.substeps = n;
            s.soft = soft;
            if (soft || n <= 16)
                add(weldedName("pile", s, 15), [s] { return weldedPile(PileCase{}, s); });
        }
    return all;
}

/// Markdown table, one row a run.
void printTable(const std::vector<GameRun>& runs) {
    std::printf("\n| | stretch | crossed pairs | peak / theory | CPU s per s |\n|---|---:|---:|---:|---:|\n");
    for (const GameRun& r : runs) {
        char peak[32] = "-";
        if (r.peak > 0.0)
            std::snprintf(peak, sizeof peak, "%.3f", r.peak);
        std::printf("| %s | %.1e | %d | %s | %.3f |\n", r.name.c_str() + std::string("welded_boxes/").size(), r.stretch,
                    r.crossings, peak, r.cpu);
    }
}

std::string writePicture(const std::vector<GameRun>& runs, const std::string& json) {
    const auto find = [&runs](const char* name) {
        return std::find_if(runs.begin(), runs.end(), [name](const GameRun& r) { return r.name == name; });
    };
    const auto ours = find("welded_boxes/pile/shells15/game"), boxes = find("welded_boxes/pile/welded15/1"),
               tuned = find("welded_boxes/pile/welded15/64");
    if (ours == runs.end() || boxes == runs.end() || tuned == runs.end())
        return {};
    std::string error;
    const std::string png = weldedBoxesPicture(*ours, *boxes, *tuned, error);
    if (!error.empty())
        return error;
    const std::filesystem::path folder = json.empty() ? "out" : std::filesystem::path(json).parent_path();
    std::printf("picture: %s\n", (folder / "welded_boxes.png").c_str());
    return record::writeAtomically(folder.string(), {{"welded_boxes.png", png}}).error();
}

} // namespace

void addWeldedBoxBenchmarks(std::vector<Benchmark>& all) {
    Benchmark b;
    b.prefix = "welded_boxes";
    for (const Job& job : jobs())
        b.names.push_back(job.name);
    const auto runs = std::make_shared<std::vector<GameRun>>();
    b.measure = [runs](const auto& wanted, const auto& done) {
        for (const Job& job : jobs()) {
            if (!wanted(job.name))
                continue;
            GameRun run = job.run();
            if (interrupted) // an incomplete run is not measured
                break;
            run.name = job.name;
            if (!run.failure.empty())
                return job.name + ": " + run.failure;
            Measurement m = summarise(run.name, run.frames);
            m.more = {{"cpu_s_per_s", run.cpu}, {"stretch", run.stretch}, {"crossed_pairs", run.crossings}};
            if (run.peak > 0.0)
                m.more.emplace_back("peak_over_theory", run.peak);
            runs->push_back(std::move(run));
            done(std::move(m));
        }
        return std::string();
    };
    b.finish = [runs](const std::vector<Measurement>&, const std::string& json) {
        if (runs->empty())
            return std::string();
        printTable(*runs);
        return writePicture(*runs, json);
    };
    all.push_back(std::move(b));
}

} // namespace supercircle::cli
