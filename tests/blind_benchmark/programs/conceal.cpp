// conceal --part tuning|blind|limit --seed N --out DIR: writes DIR/<case>/ (what a diagnosis may see),
// DIR/answers/<case>.json (what it may not) and DIR/SHA256SUMS (of the answers; with the system's sha256sum). Cases
// that are there are kept.

#include "tests/blind_benchmark/conceal/record.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace {

namespace fs = std::filesystem;
using namespace supercircle::oracle;

int check(const std::string& part, std::uint64_t seed, const std::string& name) {
    for (const Plan& p : plans(part, seed))
        if (p.name == name) {
            const Accuracy a = accuracyOf(p);
            if (!a.failure.empty())
                break;
            std::printf(
                "%s: own error %.3f noise units (rms), 99 %% of the rows below %.3f, markers %.3f; the best test "
                "sees %.1f deviations of it\n",
                name.c_str(), a.rms, a.most, a.markers, a.detectable);
            return 0;
        }
    std::fprintf(stderr, "%s: no such case, or it fails\n", name.c_str());
    return 3;
}

int work(const std::string& part, std::uint64_t seed, const fs::path& folder, int jobs, int job, const char* only) {
    int failed = 0;
    fs::create_directories(folder / "answers");
    const std::vector<Plan> all = plans(part, seed);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const fs::path answer = folder / "answers" / (all[i].name + ".json");
        const bool mine = static_cast<int>(i) % jobs == job && (only == nullptr || all[i].name == only);
        if (!mine || (only == nullptr && fs::exists(answer)))
            continue;
        const Concealed c = conceal(all[i]);
        if (!c.failure.empty()) {
            std::fprintf(stderr, "%s: %s\n", all[i].name.c_str(), c.failure.c_str());
            ++failed;
            continue;
        }
        fs::create_directories(folder / all[i].name);
        for (const auto& [name, text] : c.files)
            writeWhole(folder / all[i].name / name, text);
        writeWhole(answer, c.answer);
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
        else if (key == "--shard")
            std::sscanf(argv[i + 1], "%d/%d", &job, &jobs);
        else
            out.clear();
    }
    if ((out.empty() && accuracy == nullptr) || !isPart(part) || jobs < 1) {
        std::fprintf(
            stderr,
            "conceal --part tuning|blind|limit --out DIR [--seed N] [--only CASE] [--shard I/N] [--accuracy CASE]\n");
        return 2;
    }
    if (seed == 0)
        seed = part == "tuning" ? 1 : 2026;
    try {
        if (accuracy != nullptr)
            return check(part, seed, accuracy);
        return work(part, seed, out, jobs, job, only) == 0 ? 0 : 3;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 4;
    }
}
