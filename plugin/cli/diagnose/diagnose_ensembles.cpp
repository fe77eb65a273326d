#include "plugin/cli/diagnose/diagnose_ensembles.h"

#include "plugin/cli/output.h"
#include "plugin/pages/diagnosis/ensemble_file.h"
#include "plugin/recording/table/files.h"

#include <cstdio>
#include <filesystem>

namespace supercircle::cli {

namespace fs = std::filesystem;
using diagnosis::EnsembleDiagnosis;

std::optional<int> diagnoseEnsembleFile(const DiagnoseArguments& a) {
    std::vector<scene::Problem> problems;
    const auto request = readEnsembles(a.file, problems);
    if (!request)
        return std::nullopt;
    for (const scene::Problem& p : problems)
        std::fprintf(stderr, "%s\n", p.toString().c_str());
    if (scene::anyError(problems))
        return kBadInput;
    if (!a.effects.empty()) {
        std::fprintf(stderr,
                     "--effect: stacks are compared as they are simulated; a law of your own needs an experiment\n");
        return kBadInput;
    }
    const auto seed = static_cast<std::uint64_t>(a.seed);
    const EnsembleDiagnosis d =
        diagnosis::diagnoseEnsembles(request->quantities, request->recorded, request->nominal, request->effects, seed);
    if (!d.failure.empty()) {
        std::fprintf(stderr, "%s: %s\n", a.file.c_str(), d.failure.c_str());
        return kBadInput;
    }
    OutputFolder folder(a.out.empty() ? "out/" + fs::path(a.file).stem().string() + "_diagnosis" : a.out);
    std::string why = folder.prepare();
    if (why.empty())
        why = record::writeAtomically(folder.path(), {{"diagnosis.json", ensembleJson(d, seed)}}).error();
    if (!why.empty()) {
        std::fprintf(stderr, "%s\n", why.c_str());
        return kCannotWrite;
    }
    if (!a.quiet) {
        std::printf("%s. %s\n", diagnosis::verdictTitle(d.verdict).c_str(), d.statement.c_str());
        for (const diagnosis::EnsembleShift& s : d.shifts)
            std::printf("  %-20s recorded %.4g, simulated %.4g, t %.1f, p %.3f\n", s.quantity.c_str(), s.recorded,
                        s.simulated, s.z, s.p);
        for (const diagnosis::FittedEffect& e : d.effects)
            std::printf("  %-38s probability %.3f\n", diagnosis::plainWords(e.label).c_str(), e.probability);
    }
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
