#include "plugin/cli/command_line.h"
#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/subcommands.h"

#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/visibility.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/identification/replay/scene_of_run.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"
#include "supercircle/step/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace supercircle::cli {

namespace {

/// Plays the first steps of each run. @return why one cannot be simulated, or nothing
std::string firstSteps(const experiment::Experiment& e, const replay::Parameters& values) {
    constexpr int kSteps = 20;
    const std::vector<std::string> names = experiment::runNames(e, true);
    for (std::size_t run = 0; run < e.runs.size(); ++run) {
        std::atomic<bool> enough{false};
        int steps = 0;
        const replay::Simulated played = replay::simulate(e, run, values, replay::Resolution::coarse(),
                                                          {&enough, [&](double) { enough = ++steps >= kSteps; }});
        if (!played.failure.empty())
            return names[run] + " cannot be simulated: " + played.failure;
    }
    return {};
}

/// Whether all runs are short enough for some fifty simulations of each: single presses take 1 to 13 s of one core.
bool shortEnough(const experiment::Experiment& e) {
    const std::uint64_t most = experiment::isMechanism(e) ? 100000 : 2000; // coarse steps of all runs
    std::uint64_t steps = 0, before = 0;
    std::atomic<bool> enough{false};
    for (std::size_t run = 0; run < e.runs.size() && !enough; ++run) {
        before += replay::simulate(e, run, replay::nominal(e), replay::Resolution::coarse(),
                                   {&enough, [&](double) { enough = ++steps > most; }})
                      .steps;
        steps = before; // a driven load tells its rows only
        enough = enough || steps > most;
    }
    return !enough;
}

/// Becomes true at a time that can be put off, while it lives.
class Deadline {
public:
    using Clock = std::chrono::steady_clock;
    explicit Deadline(Clock::time_point at) : at_(at), watch_([this] { watch(); }) {}
    ~Deadline() {
        set(Clock::time_point::max(), true);
        watch_.join();
    }
    Deadline(const Deadline&) = delete;
    Deadline& operator=(const Deadline&) = delete;
    void set(Clock::time_point at) { set(at, false); }
    std::atomic<bool> over{false};

private:
    void set(Clock::time_point at, bool ends) {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            at_ = at;
            ends_ = ends;
            over = false;
        }
        wake_.notify_one();
    }
    void watch() {
        std::unique_lock<std::mutex> lock(mutex_);
        while (!ends_) {
            if (over || at_ == Clock::time_point::max())
                wake_.wait(lock);
            else if (const Clock::time_point at = at_; Clock::now() >= at)
                over = true;
            else
                wake_.wait_until(lock, at);
        }
    }

    std::mutex mutex_;
    std::condition_variable wake_;
    Clock::time_point at_;
    bool ends_ = false;
    std::thread watch_; // the last member: it uses the others
};

void tellLongRuns() {
    std::printf("  long runs: `supercircle sensitivity` shows which numbers they see\n");
}

/// Prints which stated numbers and effects these runs could see.
void tellVisible(const experiment::Experiment& e) {
    const diagnosis::RecordedData data = diagnosis::recordedDataOf(e);
    const diagnosis::Noise noise = diagnosis::estimateNoise(data);
    if (noise.total() <= 0.0)
        return;
    if (!shortEnough(e))
        return tellLongRuns();
    // Steps do not bound it: an effect may take twenty times as many as the stated numbers. It gets four times as long.
    constexpr double kSlower = 4.0;
    using Clock = Deadline::Clock;
    const Clock::time_point begin = Clock::now(), end = begin + std::chrono::seconds(5);
    Deadline limit(end);
    const diagnosis::ReplayModel model(e, {}, &limit.over);
    const Clock::time_point modelled = Clock::now();
    diagnosis::SimulationCache cache;
    diagnosis::Evaluator evaluator(model, e.runs.size(), step::threadLoop(cores(8)), cache, &limit.over);
    std::size_t simulations = 0;
    evaluator.onRun = [&] { ++simulations; };
    std::optional<Clock::duration> slice; // of an effect
    const auto next = [&] {
        const Clock::time_point now = Clock::now();
        if (!slice) {
            const double points = static_cast<double>(simulations) / static_cast<double>(e.runs.size());
            slice = std::max<Clock::duration>(
                std::chrono::milliseconds(50),
                std::chrono::duration_cast<Clock::duration>(kSlower / std::max(points, 1.0) * (now - modelled)));
        }
        limit.set(std::min(end, now + *slice));
        return now < end;
    };
    diagnosis::Visibility found;
    try {
        found = diagnosis::visibilityOf(data, noise, evaluator, next);
    } catch (const diagnosis::Stopped&) {
        return tellLongRuns();
    }
    if (!found.failure.empty())
        return;
    std::printf("  with a noise of %.2g %s these runs could see:\n", noise.total(), data.unit.c_str());
    std::string unseen, like, weak, untried;
    const auto add = [](std::string& list, const std::string& what) { list += (list.empty() ? "" : ", ") + what; };
    for (const diagnosis::VisibleNumber& n : found.numbers)
        if (n.seen())
            std::printf("    %-20s to %.2g %s of +- %.2g\n", n.name.c_str(), n.left, n.unit.c_str(), n.halfWidth);
        else
            add(unseen, n.name);
    for (const diagnosis::VisibleEffect& effect : found.effects)
        if (effect.seen())
            std::printf("    %-20s a noticeable size changes them by %.3g standard deviations\n", effect.label.c_str(),
                        effect.own);
        else if (effect.imitated())
            add(like, effect.label + (effect.like.empty() ? "" : " (by " + effect.like + ")"));
        else
            add(weak, effect.label);
    for (const std::string& label : found.untried)
        add(untried, label);
    for (const auto& [words, list] : {std::pair{"numbers that stay within their intervals", &unseen},
                                      {"effects that stated numbers imitate", &like},
                                      {"effects that noise hides", &weak},
                                      {"effects that take too long here", &untried}})
        if (!list->empty())
            std::printf("    %s: %s\n", words, list->c_str());
}

} // namespace

int checkExperiment(const std::string& file, const std::vector<std::string>& parameters) {
    endOnSignal(); // it writes no file
    std::vector<scene::Problem> problems;
    const auto loaded =
        experiment::load(file, problems, allowOutside ? experiment::Outside::Allowed : experiment::Outside::Refused);
    for (const scene::Problem& p : problems)
        std::fprintf(stderr, "%s\n", p.toString().c_str());
    if (!loaded)
        return kBadInput;
    replay::Parameters values = replay::nominal(*loaded);
    std::vector<scene::Override> overrides;
    if (!readOverrides(parameters, overrides))
        return kBadInput;
    for (const scene::Override& o : overrides)
        if (const std::string why = replay::set(values, *loaded, o.name, o.value); !why.empty()) {
            std::fprintf(stderr, "--param %s=%.10g: %s\n", o.name.c_str(), o.value, why.c_str());
            return kBadInput;
        }
    if (const std::string why = firstSteps(*loaded, values); !why.empty()) {
        std::fprintf(stderr, "%s: it is valid, but %s\n", file.c_str(), why.c_str());
        return kBadInput;
    }
    std::printf("%s: valid experiment (%s, %zu specimens, %zu runs, %zu markers)\n", file.c_str(),
                experiment::name(loaded->protocol),
                loaded->scene ? loaded->scene->specimens.size() : loaded->specimens.size(), loaded->runs.size(),
                loaded->markers.size());
    const bool free = experiment::isFree(*loaded);
    std::string unknown;
    const auto scene = loaded->scene ? replay::sceneOf(*loaded, 0, values, unknown) : std::nullopt;
    const bool vibrates = scene && !scene->numerics.quasi_static.value_or(true);
    std::printf("  simulated as %s\n",
                experiment::isMechanism(*loaded)
                    ? (free ? "bodies on joints that move freely" : "bodies on joints, one moved by the machine")
                    : (free       ? "rods that move freely"
                       : vibrates ? "rods that are moved and vibrate"
                                  : "rods that are moved slowly, their vibration damped"));
    if (!experiment::furtherChannels(*loaded).empty()) {
        const auto tell = [](const experiment::Channel& c, double noise) {
            std::printf("  compared: %s, column %s, noise of about %.3g %s, weight %g\n", c.name.c_str(),
                        c.column.c_str(), c.perUnit * noise, c.unit.c_str(), c.weight);
        };
        tell(experiment::channel(*loaded), loaded->sensors.forceNoise);
        for (const experiment::FurtherChannel& c : experiment::furtherChannels(*loaded))
            tell(c.channel, c.noise);
    }
    if (experiment::isTable(*loaded))
        std::printf("  tables of states of rest, without times: effects that need a clock are not tried\n");
    for (const experiment::Run& run : loaded->runs) {
        std::printf("  %-16s %zu %s", run.file.c_str(), run.readings.time.size(),
                    experiment::isTable(*loaded) ? "rows" : "samples");
        if (!experiment::isTable(*loaded))
            std::printf(", %g s%s", run.driveTime.back() - run.driveTime.front(),
                        run.markers.time.empty() ? "" : ", with markers");
        if (run.specimen >= 0)
            std::printf(", specimen %s", loaded->scene->specimens[static_cast<std::size_t>(run.specimen)].id.c_str());
        std::printf("\n");
    }
    for (const replay::ParameterInfo& p : replay::parameterList(*loaded))
        std::printf("  %-20s %-12.6g +- %-10.3g %-6s %s\n", p.name.c_str(),
                    replay::get(values, *loaded, p.name).value_or(0.0), p.stated.halfWidth, p.unit.c_str(),
                    p.about.c_str());
    if (loaded->scene)
        for (const experiment::BatchParameter& b : loaded->scene->batch)
            if (b.scale > 0.0)
                std::printf("  batch: %s differs between specimens, by a standard deviation of the order of %g\n",
                            b.name.c_str(), b.scale);
    if (const std::string why = diagnosis::tooFewReadings(*loaded); !why.empty())
        std::printf("  no diagnosis: %s\n", why.c_str());
    if (parameters.empty()) {
        std::fflush(stdout);
        std::fprintf(stderr, "the file is valid; simulating what its runs could see (Ctrl-C ends this)\n");
        tellVisible(*loaded);
    }
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
