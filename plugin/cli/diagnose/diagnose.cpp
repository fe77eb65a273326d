#include "plugin/cli/diagnose/diagnose_ensembles.h"
#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/verbs.h"
#include "plugin/pages/diagnosis/diagnose_figures.h"
#include "plugin/pages/diagnosis/diagnose_page.h"

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/recording/experiment/load.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/rounded.h"
#include "plugin/scene/loader/problem.h"
#include "supercircle/effects/effect.h"
#include "supercircle/step/parallel.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

namespace supercircle::cli {

namespace {

namespace fs = std::filesystem;

std::optional<experiment::Experiment> loadLongEnough(const DiagnoseArguments& a) {
    auto loaded = loadExperiment(a.file, a.quiet);
    if (!loaded)
        return std::nullopt;
    for (const experiment::Run& run : loaded->runs)
        if (run.readings.time.size() < 20) {
            std::fprintf(stderr, "%s: %s has %zu rows; a diagnosis needs at least 20 readings of each run\n",
                         a.file.c_str(), run.file.c_str(), run.readings.time.size());
            return std::nullopt;
        }
    return loaded;
}

bool knownEffects(const std::vector<std::string>& labels) {
    std::vector<std::string> known;
    for (const effects::Effect& e : effects::catalog())
        known.push_back(e.name);
    for (const std::string& label : labels)
        if (effects::find(label) == nullptr) {
            const std::string near = effects::nearest(label, known);
            std::fprintf(stderr, "--without %s: there is no such effect%s\n", label.c_str(),
                         near.empty() ? "" : ("; did you mean \"" + near + "\"?").c_str());
            return false;
        }
    return true;
}

void print(const diagnosis::Diagnosis& d, const std::string& folder) {
    std::printf("%s: %s\n", d.verdict.c_str(), d.statement.c_str());
    for (std::size_t i = 0; i < d.effects.size() && i < 5; ++i) {
        const diagnosis::FoundEffect& e = d.effects[i];
        std::printf("  %-26s probability %.3f, gain on unseen runs %.1f +- %.1f, error there %.3g %s\n",
                    e.label.c_str(), e.probability, e.gain, e.gainError, e.heldOutRmse, d.unit.c_str());
    }
    const std::pair<const char*, double> others[] = {
        {"nothing", d.nothing}, {"too small to be seen here", d.unseen()}, {"none of these", d.unknown}};
    for (const auto& [what, probability] : others)
        std::printf("  %-26s probability %.3f\n", what, probability);
    std::printf("%zu simulated runs, %s; results: %s/diagnosis.json, pictures: %s/report.html\n", d.forwardRuns,
                record::duration(d.elapsed).c_str(), folder.c_str(), folder.c_str());
}

diagnosis::Ablation ablationOf(const std::vector<std::string>& parts) {
    const auto out = [&](const char* part) { return std::find(parts.begin(), parts.end(), part) != parts.end(); };
    return {out("whitening"), out("heldout"), out("probes"), out("unknown")};
}

/// Another catalogue keeps its runs beside those of the whole one.
std::string keptRuns(std::vector<std::string> without) {
    constexpr std::size_t kLongest = 150; // file systems end at 255
    std::sort(without.begin(), without.end());
    std::string name = "runs";
    for (const std::string& label : without)
        name += (name == "runs" ? "-without-" : "+") + label;
    return name.substr(0, kLongest) + ".cache";
}

diagnosis::Diagnosis work(const DiagnoseArguments& a, const experiment::Experiment& experiment, const Folder& folder,
                          std::string& error) {
    const diagnosis::ReplayModel model(experiment, a.without, &interrupted);
    if (interrupted) { // what is kept belongs to a whole model
        diagnosis::Diagnosis none;
        none.stopped = true;
        return none;
    }
    diagnosis::Store store;
    if (error = store.open(folder.path() + "/" + keptRuns(a.without), model.identity()); !error.empty())
        return {};
    diagnosis::Evaluator evaluator(model, experiment.runs.size(), step::threadLoop(a.jobs), store, &interrupted);
    diagnosis::Settings settings;
    settings.seed = static_cast<std::uint64_t>(a.seed);
    settings.ablation = ablationOf(a.ablate);
    settings.next = !a.noNext;
    ProgressLine line(a.quiet);
    settings.progress = [&](double fraction, const std::string& stage) { line.show(fraction, stage); };
    diagnosis::Diagnosis found = diagnosis::diagnose(diagnosis::dataOf(experiment), evaluator, settings);
    if (const std::string lost = store.failure(); !lost.empty())
        std::fprintf(stderr, "%s; runs simulated since then are not kept and would be simulated again\n", lost.c_str());
    return found;
}

} // namespace

int diagnose(const DiagnoseArguments& a) {
    if (const auto done = diagnoseEnsembleFile(a))
        return *done;
    const auto experiment = loadLongEnough(a);
    if (!experiment || !knownEffects(a.without))
        return kBadInput;
    Folder folder(resultsFolder(a.file, a.out, "diagnosis"));
    if (const std::string error = folder.prepare(); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    std::string error;
    const diagnosis::Diagnosis d = work(a, *experiment, folder, error);
    if (!error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    if (d.stopped) {
        std::fprintf(stderr, "interrupted; the same command goes on from what %s keeps\n", folder.path().c_str());
        return kInterrupted;
    }
    if (!d.failure.empty()) {
        std::fprintf(stderr,
                     "%s: %s; `supercircle replay %s` keeps what was simulated up to there; mend what the description "
                     "says of it, or leave the run out\n",
                     a.file.c_str(), d.failure.c_str(), a.file.c_str());
        return kCannotGoOn;
    }
    auto pictures = diagnosisPictures(d);
    std::vector<record::NamedText> files = std::move(pictures.value);
    files.emplace_back("diagnosis.json", diagnosisJson(d));
    files.emplace_back("report.html", diagnosisPage(d, *experiment));
    std::string why = record::writeAtomically(folder.path(), files);
    if (why.empty())
        why = pictures.error; // the result is written even if it could not be drawn
    if (!why.empty()) {
        std::fprintf(stderr, "%s\n", why.c_str());
        return kCannotWrite;
    }
    if (!a.quiet)
        print(d, folder.path());
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
