// Game quality: cost of a frame, and deviation from laboratory quality.

#include "plugin/bench/bench_game_scenes.h"
#include "plugin/cli/subcommands.h"

#include <cmath>
#include <cstdio>
#include <memory>

namespace supercircle::cli {

namespace {

struct Job {
    std::string name;
    std::function<std::vector<GameRun>()> run; ///< the same scene with several seeds
};

std::vector<GameRun> piles(PileCase pile, Quality quality, int seeds) {
    std::vector<GameRun> runs;
    for (int i = 1; i <= seeds && !interrupted; ++i) {
        pile.seed = static_cast<std::uint64_t>(i);
        runs.push_back(ourPile(pile, quality));
    }
    return runs;
}

/// Shells fall into a box in batches of seventeen and come to rest.
PileCase manyShells(int shells, int threads) {
    PileCase pile;
    pile.shells = shells;
    pile.batchSize = 17;
    pile.width = 40.0;
    pile.seconds = 0.7 * std::ceil(shells / 17.0) + 5.0;
    pile.threads = threads;
    return pile;
}

std::vector<Job> jobs() {
    std::vector<Job> all;
    for (const Quality q : {Quality::Game, Quality::Laboratory})
        for (const CylinderCase& c : kCylinders)
            for (const int arcs : {15, 31, 61})
                all.push_back({std::string("game/") + c.name + std::to_string(arcs) + "/" + nameOf(q),
                               [=] { return std::vector<GameRun>{ourCylinder(c, q, arcs)}; }});
    for (const Quality q : {Quality::Game, Quality::Laboratory})
        all.push_back({std::string("game/pile30/") + nameOf(q), [q] { return piles(PileCase{}, q, 8); }});
    for (const int shells : {100, 200, 500})
        for (const int threads : {1, 2})
            all.push_back({"game/pile" + std::to_string(shells) + "/game/" + std::to_string(threads) + "threads",
                           [=] { return std::vector<GameRun>{ourPile(manyShells(shells, threads), Quality::Game)}; }});
    return all;
}

struct Mean {
    double value = 0.0, error = 0.0; ///< of the mean
};
Mean meanOf(const std::vector<GameRun>& runs, double GameRun::*field) {
    Mean m;
    for (const GameRun& r : runs)
        m.value += r.*field / static_cast<double>(runs.size());
    double square = 0.0;
    for (const GameRun& r : runs)
        square += std::pow(r.*field - m.value, 2);
    if (runs.size() > 1)
        m.error = std::sqrt(square / static_cast<double>(runs.size() * (runs.size() - 1)));
    return m;
}

Measurement measurementOf(const std::string& name, const std::vector<GameRun>& runs) {
    std::vector<double> frames;
    double crossings = 0.0, budgetExhausted = 0.0, slow = 0.0, stretch = 0.0;
    for (const GameRun& r : runs) {
        frames.insert(frames.end(), r.frames.begin(), r.frames.end());
        crossings += r.crossings;
        budgetExhausted += r.budgetExhausted;
        stretch = std::max(stretch, r.stretch);
    }
    for (const double ms : frames)
        slow += ms > 1e3 * kGameFrame ? 1.0 : 0.0;
    double wall = 0.0;
    for (const double ms : frames)
        wall += ms;
    Measurement m = summarise(name, frames);
    m.more = {{"cpu_s_per_s", meanOf(runs, &GameRun::cpu).value},
              {"frames_per_s", 1e3 * static_cast<double>(frames.size()) / std::max(wall, 1e-9)},
              {"slow_frames", slow},
              {"budget_exhausted_frames", budgetExhausted},
              {"crossed_pairs", crossings},
              {"stretch", stretch}};
    if (runs.front().peak > 0.0)
        m.more.emplace_back("peak_over_theory", runs.front().peak);
    if (runs.size() > 1) {
        const Mean height = meanOf(runs, &GameRun::height), stored = meanOf(runs, &GameRun::stored);
        m.more.emplace_back("height_m", height.value);
        m.more.emplace_back("height_error_m", height.error);
        m.more.emplace_back("stored_J", stored.value);
        m.more.emplace_back("stored_error_J", stored.error);
    }
    return m;
}

/// Root mean square difference of two force curves over the peak of the second, up to its peak. The dynamics after a
/// snap are not comparable.
double curveError(const std::vector<double>& game, const std::vector<double>& laboratory) {
    std::size_t top = 0;
    for (std::size_t i = 0; i < laboratory.size(); ++i)
        if (laboratory[i] > laboratory[top])
            top = i;
    double square = 0.0;
    const std::size_t count = std::min(top, game.size());
    for (std::size_t i = 0; i < count; ++i)
        square += std::pow(game[i] - laboratory[i], 2);
    return count == 0 ? 0.0 : std::sqrt(square / static_cast<double>(count)) / laboratory[top];
}

} // namespace

void addGameBenchmarks(std::vector<Benchmark>& all) {
    Benchmark b;
    b.prefix = "game";
    for (const Job& job : jobs())
        b.names.push_back(job.name);
    const auto curves = std::make_shared<std::vector<std::pair<std::string, std::vector<double>>>>();
    b.measure = [curves](const auto& wanted, const auto& done) {
        for (const Job& job : jobs()) {
            if (!wanted(job.name))
                continue;
            const std::vector<GameRun> runs = job.run();
            if (interrupted) // an incomplete run is not measured
                break;
            for (const GameRun& r : runs)
                if (!r.failure.empty())
                    return job.name + ": " + r.failure;
            if (runs.empty())
                break;
            curves->emplace_back(job.name, runs.front().force);
            done(measurementOf(job.name, runs));
        }
        return std::string();
    };
    b.finish = [curves](const std::vector<Measurement>&, const std::string&) {
        for (const auto& [name, force] : *curves)
            for (const auto& [other, reference] : *curves) {
                const std::string scene = name.substr(0, name.rfind('/'));
                if (!force.empty() && name == scene + "/game" && other == scene + "/laboratory")
                    std::printf(
                        "%s: force curve up to the peak deviates from laboratory quality by %.2f %% rms of the peak\n",
                        scene.c_str(), 1e2 * curveError(force, reference));
            }
        return std::string();
    };
    all.push_back(std::move(b));
}

} // namespace supercircle::cli
