#include "plugin/cli/diagnose/diagnose_ensembles.h"
#include "plugin/cli/output.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/replay/experiment_input.h"
#include "plugin/cli/subcommands.h"
#include "plugin/pages/diagnosis/diagnose_figures.h"
#include "plugin/pages/diagnosis/diagnose_page.h"

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/own_law.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/stored_fits.h"
#include "plugin/recording/experiment/load.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/rounded.h"
#include "supercircle/effects/effect.h"
#include "supercircle/step/parallel.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
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
    const std::string why = diagnosis::tooFewReadings(*loaded);
    if (why.empty())
        return loaded;
    std::fprintf(stderr, "%s: %s\n", a.file.c_str(), why.c_str());
    return std::nullopt;
}

bool knownEffects(const std::vector<std::string>& labels) {
    std::vector<std::string> known;
    for (const effects::Effect& e : effects::catalog())
        known.push_back(e.name);
    for (const std::string& label : labels)
        if (effects::find(label) == nullptr) {
            std::fprintf(stderr, "--without %s: there is no such effect%s\n", label.c_str(),
                         didYouMean(label, known).c_str());
            return false;
        }
    return true;
}

/// Laws of the user; false after a message.
bool readLaws(std::vector<std::string> texts, std::vector<diagnosis::StartedLaw>& laws) {
    std::string why = diagnosis::takeOwnLaws(texts, laws);
    if (why.empty() && !texts.empty())
        why = texts.front() + ": expected a law of your own, NAME:FORMULA and NAME:PARAMETER=START; effects of the "
                              "catalogue compete anyway";
    if (!why.empty())
        std::fprintf(stderr, "--effect: %s\n", why.c_str());
    return why.empty();
}

void print(const diagnosis::Diagnosis& d, const std::string& folder) {
    std::printf("%s. %s\n", diagnosis::titleOf(d).c_str(), d.statement.c_str());
    for (std::size_t i = 0; i < d.effects.size() && i < 5; ++i) {
        const diagnosis::FittedEffect& e = d.effects[i];
        std::printf("  %-38s probability %.3f, held-out gain %.1f +- %.1f, held-out error %.3g %s\n",
                    diagnosis::plainWords(e.label).c_str(), e.probability, e.gain, e.gainError, e.heldOutRmse,
                    d.unit.c_str());
    }
    const std::pair<const char*, double> others[] = {{"no missing effect", d.adequate},
                                                     {"an effect too small to be detected", d.undetectable()},
                                                     {"an effect outside the catalogue", d.outsideCatalogue}};
    for (const auto& [what, probability] : others)
        std::printf("  %-38s probability %.3f\n", what, probability);
    for (const std::string& note : d.notes)
        std::printf("%s\n", note.c_str());
    std::printf("%zu simulated runs, %s (cpu_s %.1f); results: %s/diagnosis.json, pictures: %s/report.html\n",
                d.forwardRuns, graphics::readableDuration(d.elapsed).c_str(), d.cpuSeconds, folder.c_str(),
                folder.c_str());
}

diagnosis::Ablation ablationOf(const std::vector<std::string>& parts) {
    const auto out = [&](const char* part) { return std::find(parts.begin(), parts.end(), part) != parts.end(); };
    return {out("whitening"), out("cross_validation"), out("screening"), out("open_set")};
}

/// Name of the cache file; each catalogue has its own.
std::string cacheName(std::vector<std::string> without, const std::vector<diagnosis::StartedLaw>& laws) {
    constexpr std::size_t kLongest = 150; // file systems allow 255
    std::sort(without.begin(), without.end());
    std::string name = "runs";
    for (const std::string& label : without)
        name += (name == "runs" ? "-without-" : "+") + label;
    for (const diagnosis::StartedLaw& l : laws)
        name += "+" + l.law.name;
    return name.substr(0, kLongest) + ".cache";
}

/// Of the program, reading included, s.
double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

diagnosis::Diagnosis work(const DiagnoseArguments& a, const std::vector<diagnosis::StartedLaw>& laws,
                          const experiment::Experiment& experiment, const OutputFolder& folder,
                          diagnosis::StoredFits& fits, std::string& wrongLaw, std::string& error) {
    const auto begin = std::chrono::steady_clock::now();
    diagnosis::ReplayModel model(experiment, a.without, &interrupted);
    if (interrupted) { // the model is incomplete
        diagnosis::Diagnosis none;
        none.stopped = true;
        return none;
    }
    for (const diagnosis::StartedLaw& law : laws)
        if (const std::string why = model.add(law); !why.empty()) {
            wrongLaw = why;
            return {};
        }
    diagnosis::SimulationCache cache;
    if (error = cache.open(folder.path() + "/" + cacheName(a.without, laws), model.identity()); !error.empty())
        return {};
    const auto end = begin + std::chrono::duration<double>(60.0 * a.timeLimit);
    const bool limited = a.timeLimit > 0.0;
    const double cpuLimit = 60.0 * a.cpuLimit;
    diagnosis::Evaluator evaluator(model, experiment.runs.size(), step::threadLoop(a.jobs), cache, &interrupted, [=] {
        return (limited && std::chrono::steady_clock::now() >= end) || (cpuLimit > 0.0 && cpuSeconds() >= cpuLimit);
    });
    diagnosis::DiagnosisSettings settings;
    settings.seed = static_cast<std::uint64_t>(a.seed);
    settings.ablation = ablationOf(a.ablate);
    settings.nextExperiment = !a.skipNextExperiment;
    ProgressLine line(a.quiet);
    settings.progress = [&](double fraction, const std::string& stage) { line.show(fraction, stage); };
    diagnosis::Diagnosis found = diagnosis::diagnose(diagnosis::recordedDataOf(experiment), evaluator, settings);
    found.elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    found.cpuSeconds = cpuSeconds();
    if (!found.stopped && found.failure.empty())
        fits = diagnosis::storedFitsOf(model, experiment, found);
    if (const std::string lost = cache.failure(); !lost.empty())
        std::fprintf(stderr, "%s; later simulations are not cached and would be repeated by the next diagnosis\n",
                     lost.c_str());
    return found;
}

} // namespace

int diagnose(const DiagnoseArguments& a) {
    if (const auto done = diagnoseEnsembleFile(a))
        return *done;
    const auto experiment = loadLongEnough(a);
    if (!experiment || !knownEffects(a.without))
        return kBadInput;
    std::vector<diagnosis::StartedLaw> laws;
    if (!readLaws(a.effects, laws))
        return kBadInput;
    OutputFolder folder(resultsFolder(a.file, a.out, "diagnosis"));
    if (const std::string error = folder.prepare(); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    std::string wrongLaw, error;
    diagnosis::StoredFits fits;
    const diagnosis::Diagnosis d = work(a, laws, *experiment, folder, fits, wrongLaw, error);
    if (!wrongLaw.empty()) {
        std::fprintf(stderr, "--effect: %s\n", wrongLaw.c_str());
        return kBadInput;
    }
    if (!error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    if (d.stopped) {
        std::fprintf(stderr, "interrupted; the same command continues with the simulations kept in %s\n",
                     folder.path().c_str());
        return kInterrupted;
    }
    if (!d.failure.empty()) {
        std::fprintf(
            stderr,
            "%s: %s; `supercircle replay %s` shows the simulation up to that point; correct the description of this "
            "run, or leave it out\n",
            a.file.c_str(), d.failure.c_str(), a.file.c_str());
        return kCannotGoOn;
    }
    auto pictures = diagnosisPictures(d);
    const std::string pictureError = pictures.error();
    std::vector<record::NamedText> files = pictures ? *std::move(pictures) : std::vector<record::NamedText>{};
    files.emplace_back("diagnosis.json", diagnosisJson(d, fits));
    files.emplace_back("report.html", diagnosisPage(d, *experiment));
    std::string why = record::writeAtomically(folder.path(), files).error();
    if (why.empty())
        why = pictureError; // the result is written even if a picture fails
    if (!why.empty()) {
        std::fprintf(stderr, "%s\n", why.c_str());
        return kCannotWrite;
    }
    if (!a.quiet)
        print(d, folder.path());
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
