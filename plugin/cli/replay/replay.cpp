#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/replay/experiment_input.h"
#include "plugin/cli/replay/taken_fit.h"
#include "plugin/cli/subcommands.h"
#include "plugin/identification/diagnosis/own_law.h"
#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/replay/free_scales.h"
#include "plugin/pages/replay/replay_page.h"

#include "plugin/recording/experiment/load.h"
#include "plugin/recording/table/csv.h"

#include <cmath>
#include <cstdio>

namespace supercircle::cli {

namespace {

using record::NamedText;

/// Sets resolution, parameters and effects; false after a message.
bool prepare(const ReplayArguments& a, Replay& out) {
    out.parameters = replay::nominal(out.experiment);
    out.resolution = a.coarse ? replay::Resolution::coarse() : replay::Resolution::fine();
    if (a.elements > 0)
        out.resolution.elements = a.elements;
    if (!takeFit(a, out))
        return false;
    std::vector<scene::Override> overrides;
    if (!readOverrides(a.parameters, overrides))
        return false;
    for (const scene::Override& o : overrides)
        if (const std::string why = replay::set(out.parameters, out.experiment, o.name, o.value); !why.empty()) {
            std::fprintf(stderr, "--param %s=%.10g: %s\n", o.name.c_str(), o.value, why.c_str());
            return false;
        }
    if (const std::string why = diagnosis::addEffects(a.effects, out.experiment, out.parameters, &interrupted);
        !why.empty()) {
        std::fprintf(stderr, "--effect: %s\n", why.c_str());
        return false;
    }
    return true;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
    for (double& v : values)
        v *= factor;
    return values;
}

/// Adds NAME_replay.csv, and NAME_replay_markers.csv where markers were tracked.
std::string addTables(const experiment::Experiment& e, const experiment::Run& run, const ReplayedRun& done,
                      std::vector<NamedText>& files) {
    const auto put = [&](const std::string& name, const record::Series& series) {
        auto text = record::csvText(series);
        if (text)
            files.emplace_back(name, *std::move(text));
        return text.error();
    };
    std::vector<double> simulated = done.simulated.readings.force;
    simulated.resize(run.readings.time.size(), std::numeric_limits<double>::quiet_NaN());
    record::Series force;
    const experiment::Channel& c = experiment::channel(e);
    const std::string name = c.name, unit = std::string("_") + c.unit;
    const auto add = [&](const std::string& column, std::vector<double> values) {
        force.names.push_back(column);
        force.columns.push_back(std::move(values));
    };
    if (!experiment::isTable(e)) // its clock is made up
        add("time_s", run.readings.time);
    if (!experiment::isFree(e)) {
        const experiment::DriveAxis drive = experiment::driveAxis(e);
        add(drive.column(), scaled(run.readings.displacement, drive.perUnit));
    }
    add(name + "_recorded" + unit, scaled(run.readings.force, c.perUnit));
    add(name + "_simulated" + unit, scaled(simulated, c.perUnit));
    add("residual" + unit, scaled(done.comparison.residual, c.perUnit));
    for (std::size_t i = 0; i < run.readings.further.size(); ++i) {
        const experiment::Channel& own = experiment::furtherChannels(e)[i].channel;
        std::vector<double> there =
            i < done.simulated.readings.further.size() ? done.simulated.readings.further[i] : std::vector<double>{};
        there.resize(run.readings.time.size(), std::numeric_limits<double>::quiet_NaN());
        for (const auto& [word, column] :
             {std::pair<const char*, const std::vector<double>*>{"_recorded_", &run.readings.further[i]},
              {"_simulated_", &there},
              {"_residual_", &done.comparison.further[i].residual}}) {
            add(own.name + word + own.unit, scaled(*column, own.perUnit));
        }
    }
    if (const std::string why = put(done.name + "_replay.csv", force); !why.empty())
        return why;
    if (done.simulated.markers.x.empty() || done.simulated.markers.time.empty())
        return {};
    record::Series tracks;
    tracks.names = {"time_s"};
    tracks.columns = {done.simulated.markers.time};
    for (std::size_t m = 0; m < e.markers.size(); ++m) {
        tracks.names.insert(tracks.names.end(), {e.markers[m].name + "_x_mm", e.markers[m].name + "_y_mm"});
        tracks.columns.push_back(scaled(done.simulated.markers.x[m], 1e3));
        tracks.columns.push_back(scaled(done.simulated.markers.y[m], 1e3));
    }
    return put(done.name + "_replay_markers.csv", tracks);
}

void simulateRuns(Replay& replay, bool quiet) {
    ProgressLine line(quiet);
    const std::size_t count = replay.experiment.runs.size();
    const std::vector<std::string> names = experiment::runNames(replay.experiment, false);
    for (std::size_t k = 0; k < count && !interrupted; ++k) {
        const experiment::Run& run = replay.experiment.runs[k];
        replay::Options options;
        options.interrupt = &interrupted;
        options.progress = [&](double fraction) {
            line.show((static_cast<double>(k) + fraction) / static_cast<double>(count),
                      "run " + std::to_string(k + 1) + " of " + std::to_string(count));
        };
        ReplayedRun done{names[k], {}, {}};
        done.simulated = replay::simulate(replay.experiment, k, replay.parameters, replay.resolution, options);
        done.comparison =
            replay::compare(run, done.simulated, replay::ExclusionWindow{}.in(replay::naturalUnits(replay.experiment)),
                            !experiment::isFree(replay.experiment));
        replay.runs.push_back(std::move(done));
    }
    line.clear();
}

std::string writeAll(const Replay& replay, const std::string& folder) {
    std::vector<NamedText> files = {{"replay.json", replayJson(replay)}};
    for (std::size_t k = 0; k < replay.runs.size(); ++k)
        if (const std::string why = addTables(replay.experiment, replay.experiment.runs[k], replay.runs[k], files);
            !why.empty())
            return why;
    auto pages = replayPages(replay);
    if (!pages)
        return pages.error();
    std::move(pages->begin(), pages->end(), std::back_inserter(files));
    return record::writeAtomically(folder, files).error();
}

void print(const Replay& replay, const std::string& folder) {
    const double k = experiment::channel(replay.experiment).perUnit;
    const char* const unit = experiment::channel(replay.experiment).unit.c_str();
    for (const ReplayedRun& run : replay.runs) {
        const replay::Comparison& c = run.comparison;
        std::printf("%s: peak %.4g %s recorded, %.4g %s simulated; rms error %.3g %s (%.2f %%), largest %.3g %s",
                    run.name.c_str(), k * c.peakRecorded, unit, k * c.peakSimulated, unit, k * c.rmse, unit,
                    100.0 * c.rmse / std::max(c.peakRecorded, 1e-300), k * c.maxError, unit);
        for (std::size_t i = 0; i < c.further.size(); ++i) {
            const experiment::Channel& own = experiment::furtherChannels(replay.experiment)[i].channel;
            std::printf("; %s: rms error %.3g %s (%.2f %%)", own.name.c_str(), own.perUnit * c.further[i].rmse,
                        own.unit.c_str(), 100.0 * c.further[i].rmse / std::max(c.further[i].peakRecorded, 1e-300));
        }
        for (const auto& [i, j] : c.matches)
            std::printf("; jump at %.3f mm recorded, %.3f mm simulated", 1e3 * c.recorded[i].displacement,
                        1e3 * c.simulated[j].displacement);
        std::printf("\n");
    }
    if (replay.taken && replay.taken->carried) {
        const TakenFit& t = *replay.taken;
        const std::string label = diagnosis::plainWords(t.label);
        for (const std::string& note : t.notes)
            std::printf("%s\n", note.c_str());
        if (t.score)
            std::printf(
                "%s, carried: with the stated numbers fitted, the held-out error is %.3g %s without the law and "
                "%.3g %s with it (gain %.1f +- %.1f)\n",
                label.c_str(), t.score->heldOutWithout, unit, t.score->heldOutWith, unit, t.score->gain,
                t.score->gainError);
        else
            std::printf("%s, carried: no score, %s\n", label.c_str(), t.failure.c_str());
    }
    std::printf("results: %s/replay.json, run files; pictures: %s/replay.html\n", folder.c_str(), folder.c_str());
}

} // namespace

int replay(const ReplayArguments& a) {
    auto loaded = loadExperiment(a.file, a.quiet);
    Replay replay;
    if (!loaded)
        return kBadInput;
    replay.experiment = std::move(*loaded);
    if (!prepare(a, replay))
        return kBadInput;
    OutputFolder folder(resultsFolder(a.file, a.out, "replay"));
    if (const std::string error = folder.prepare(); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    simulateRuns(replay, a.quiet);
    scoreCarriedLaw(replay, a.quiet);
    if (const std::string error = writeAll(replay, folder.path()); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    if (!a.quiet)
        print(replay, folder.path());
    const bool arrived = printed();
    if (interrupted) {
        std::fprintf(stderr, "interrupted; what is done is in %s\n", folder.path().c_str());
        return kInterrupted;
    }
    for (const ReplayedRun& run : replay.runs)
        if (!run.simulated.failure.empty()) {
            std::fprintf(stderr, "%s could not go on: %s; what is done is in %s\n", run.name.c_str(),
                         run.simulated.failure.c_str(), folder.path().c_str());
            return kCannotGoOn;
        }
    return arrived ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
