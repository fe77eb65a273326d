// Writes synthetic cases: DIR/<case>/ is what a diagnosis may see, DIR/answers/<case>.json what it may not.
// Existing cases are kept.

#include "tests/blind_benchmark/synthetic_cases/detectability.h"
#include "tests/blind_benchmark/synthetic_cases/make_case.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace {

namespace fs = std::filesystem;
using namespace supercircle::blind_benchmark;

int printAccuracy(const std::string& part, std::uint64_t seed, const std::string& name) {
    for (const CasePlan& p : casePlans(part, seed))
        if (p.name == name) {
            const Accuracy a = accuracyOf(p);
            if (!a.failure.empty())
                break;
            std::printf(
                "%s: error of the reference simulator %.3f noise standard deviations (rms), 99 %% of the rows below "
                "%.3f, markers %.3f; signal to the best possible test %.1f\n",
                name.c_str(), a.rms, a.percentile99, a.markers, a.detectable);
            return 0;
        }
    std::fprintf(stderr, "%s: no such case, or its simulation fails\n", name.c_str());
    return 3;
}

/// Prints the readings of a described experiment without noise, N: a list a run. Numbers of the description are true.
/// @param effects file with a list of labels and parameters, as in the answers
/// @param factor of the resolution of recordings; 0: the coarse one that sizes of effects are sought with
int printReadings(const std::string& experiment, const std::string& effects, double factor) {
    Description d = readDescription(experiment);
    for (const auto& effect : nlohmann::json::parse(std::ifstream(effects)))
        apply(d.nominal.effects, {effect.at("label"), effect.at("parameters")});
    const CleanReadings readings =
        simulate(d, d.nominal, factor > 0.0 ? finer(factor) : coarseResolution(d.nominal.specimens.size()));
    if (!readings.failure.empty()) {
        std::fprintf(stderr, "%s\n", readings.failure.c_str());
        return 3;
    }
    std::printf("%s\n", nlohmann::json(readings.force).dump().c_str());
    return 0;
}

int work(const std::string& part, std::uint64_t seed, const fs::path& folder, int jobs, int job, const char* only) {
    int failed = 0;
    fs::create_directories(folder / "answers");
    const std::vector<CasePlan> all = casePlans(part, seed);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const fs::path answer = folder / "answers" / (all[i].name + ".json");
        const bool mine = static_cast<int>(i) % jobs == job && (only == nullptr || all[i].name == only);
        if (!mine || (only == nullptr && fs::exists(answer)))
            continue;
        const SyntheticCase c = makeCase(all[i]);
        if (!c.failure.empty()) {
            std::fprintf(stderr, "%s: %s\n", all[i].name.c_str(), c.failure.c_str());
            ++failed;
            continue;
        }
        fs::create_directories(folder / all[i].name);
        for (const auto& [name, text] : c.files)
            writeAtomically(folder / all[i].name / name, text);
        writeAtomically(answer, c.answer);
        std::printf("%s (%zu of %zu)\n", all[i].name.c_str(), i + 1, all.size());
        std::fflush(stdout);
    }
    return failed;
}

} // namespace

int main(int argc, char** argv) {
    std::string part = "blind", out;
    std::uint64_t seed = 0;
    int jobs = 1, job = 0;
    const char* only = nullptr;
    const char* accuracy = nullptr;
    std::string readings, effects;
    double resolution = 1.0;
    for (int i = 1; i + 1 < argc; i += 2) {
        const std::string key = argv[i];
        if (key == "--part")
            part = argv[i + 1];
        else if (key == "--out")
            out = argv[i + 1];
        else if (key == "--seed")
            seed = std::strtoull(argv[i + 1], nullptr, 10);
        else if (key == "--accuracy")
            accuracy = argv[i + 1];
        else if (key == "--only")
            only = argv[i + 1];
        else if (key == "--readings")
            readings = argv[i + 1];
        else if (key == "--effects")
            effects = argv[i + 1];
        else if (key == "--resolution")
            resolution = std::strtod(argv[i + 1], nullptr);
        else if (key == "--shard")
            std::sscanf(argv[i + 1], "%d/%d", &job, &jobs);
        else
            out.clear();
    }
    if ((out.empty() && accuracy == nullptr && readings.empty()) || !isPart(part) || jobs < 1) {
        std::fprintf(stderr,
                     "synthetic_cases --part tuning|blind|limit --out DIR [--seed N] [--only CASE] [--shard "
                     "I/N] [--accuracy CASE]\n"
                     "synthetic_cases --readings EXPERIMENT.json --effects EFFECTS.json [--resolution FACTOR]\n");
        return 2;
    }
    if (seed == 0)
        seed = part == "tuning" ? 1 : 2026;
    try {
        if (!readings.empty())
            return printReadings(readings, effects, resolution);
        if (accuracy != nullptr)
            return printAccuracy(part, seed, accuracy);
        return work(part, seed, out, jobs, job, only) == 0 ? 0 : 3;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 4;
    }
}
