// Writes synthetic cases: DIR/<case>/ is what a diagnosis may see, DIR/answers/<case>.json what it may not.
// Existing cases are kept.

#include "tests/blind_benchmark/synthetic_cases/make_case.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

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

/// Writes one arch: what ./prove.sh asks for.
/// @param what kind, strength and families, such as single:strong:relaxation or pair:strong:drift+machine
int writeArch(const std::string& what, std::uint64_t seed, const std::string& name, const fs::path& folder) {
    CasePlan plan;
    std::istringstream in(what);
    std::string families;
    std::getline(in, plan.kind, ':');
    std::getline(in, plan.strength, ':');
    std::getline(in, families, ':');
    std::istringstream list(families);
    for (std::string one; std::getline(list, one, '+');)
        plan.families.push_back(family(one).name);
    plan.name = name;
    plan.part = "proof";
    plan.seed = seed;
    plan.protocol = Protocol::Arch;
    const SyntheticCase c = makeCase(plan);
    if (!c.failure.empty()) {
        std::fprintf(stderr, "%s: %s\n", name.c_str(), c.failure.c_str());
        return 3;
    }
    fs::create_directories(folder);
    for (const auto& [file, text] : c.files)
        writeAtomically(folder / file, text);
    writeAtomically(folder / "answer.json", c.answer);
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
    std::string arch, name = "arch";
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
        else if (key == "--arch")
            arch = argv[i + 1];
        else if (key == "--name")
            name = argv[i + 1];
        else if (key == "--shard")
            std::sscanf(argv[i + 1], "%d/%d", &job, &jobs);
        else
            out.clear();
    }
    if ((out.empty() && accuracy == nullptr) || !isPart(part) || jobs < 1) {
        std::fprintf(stderr, "synthetic_cases --part tuning|blind|limit --out DIR [--seed N] [--only CASE] [--shard "
                             "I/N] [--accuracy CASE]\n"
                             "synthetic_cases --arch KIND:STRENGTH:FAMILIES --name NAME --seed N --out DIR\n");
        return 2;
    }
    if (seed == 0)
        seed = part == "tuning" ? 1 : 2026;
    try {
        if (!arch.empty())
            return writeArch(arch, seed, name, out);
        if (accuracy != nullptr)
            return printAccuracy(part, seed, accuracy);
        return work(part, seed, out, jobs, job, only) == 0 ? 0 : 3;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 4;
    }
}
