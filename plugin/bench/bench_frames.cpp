// Worst cases of frames in Quality::Game, in milliseconds of this thread and in budgets.

#include "plugin/bench/bench.h"
#include "plugin/bench/bench_frames_scenes.h"
#include "plugin/cli/subcommands.h"
#include "supercircle/step/stepper.h"

#include <algorithm>

namespace supercircle::cli {

namespace {

constexpr double kBudget = 1e3 / 120.0; ///< ms, half a frame of 60 Hz

Measurement measure(const FrameScene& scene, std::string& failure) {
    FrameLevel level = scene.make();
    Shells& shells = *level.shells;
    std::vector<double> times;
    double longestSolve = 0.0, solving = 0.0, advanced = 0.0, exhausted = 0.0, quarantined = 0.0, crushed = 0.0,
           still = 0.0, most = 0.0;
    shells.stepper().watchStages([&](step::Stage stage) {
        if (stage == step::Stage::Solve)
            solving = threadCpuSeconds();
        else if (stage == step::Stage::Count && solving > 0.0) {
            longestSolve = std::max(longestSolve, 1e3 * (threadCpuSeconds() - solving));
            solving = 0.0;
        }
    });
    for (int i = 0; i < scene.frames && !interrupted && failure.empty(); ++i) {
        if (level.before)
            level.before(i);
        const double begin = threadCpuSeconds();
        const FrameReport report = shells.pre_step(scene.frame);
        times.push_back(1e3 * (threadCpuSeconds() - begin));
        if (report.advanced > 0.0)
            level.host->step(report.advanced);
        shells.post_step().or_fail();
        failure = report.failure;
        crushed += static_cast<double>(shells.events().crushed.size());
        most = std::max(most, report.work);
        advanced += report.advanced;
        exhausted += report.budget_exhausted ? 1.0 : 0.0;
        still += report.advanced > 0.0 ? 0.0 : 1.0;
        quarantined += static_cast<double>(shells.events().quarantined.size());
    }
    double sum = 0.0, worst = 0.0;
    for (const double t : times) {
        sum += t;
        worst = std::max(worst, t);
    }
    const double mean = sum / std::max<double>(1.0, static_cast<double>(times.size()));
    const double asked = scene.frame * static_cast<double>(times.size());
    Measurement m = summarise("frames/" + scene.name, times);
    m.more = {{"mean_ms", mean},
              {"worst_ms", worst},
              {"p95_budgets", m.p95 / kBudget},
              {"worst_budgets", worst / kBudget},
              {"longest_solve_ms", longestSolve},
              {"budget_exhausted_frames", exhausted},
              {"advanced_over_asked", advanced / std::max(asked, 1e-9)},
              {"still", still},
              {"most_work", most},
              {"crushed", crushed},
              {"quarantined", quarantined}};
    return m;
}

} // namespace

void addFrameBenchmarks(std::vector<Benchmark>& all) {
    Benchmark b;
    b.prefix = "frames";
    for (const FrameScene& scene : frameScenes())
        b.names.push_back("frames/" + scene.name);
    b.measure = [](const auto& wanted, const auto& done) {
        for (const FrameScene& scene : frameScenes()) {
            if (!wanted("frames/" + scene.name))
                continue;
            std::string failure;
            const Measurement m = measure(scene, failure);
            if (interrupted)
                break;
            done(m);
            if (!failure.empty())
                return scene.name + ": " + failure;
        }
        return std::string();
    };
    all.push_back(std::move(b));
}

} // namespace supercircle::cli
