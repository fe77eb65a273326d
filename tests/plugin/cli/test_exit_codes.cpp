// One table of exit codes: every subcommand against every way in which its files fail.

#include "tests/plugin/cli/program.h"

#include <catch2/catch.hpp>
#include <csignal>

using namespace supercircle::test;
using Catch::Contains;

namespace {

using Words = std::vector<std::string>;

const std::string kCase = std::string(SC_TEST_DATA) + "/recordings/training/case_01/experiment.json";
const std::string kExport = std::string(SC_SOURCE_DIR) + "/examples/import/shell_on_cylinder.csv";
const std::string kSweep = std::string(SC_SOURCE_DIR) + "/scenes/sweeps/fixed_travel.json";

/// Subcommands that read `file` and write into `out`.
std::vector<Words> readers(const std::string& file, const std::string& out) {
    return {{"run", file, "--out", out},
            {"check", file},
            {"sweep", file, "--out", out},
            {"design", file, "--results", out, "--target", "dissipation_ratio=7"},
            {"import", file, "--out", out},
            {"import", kExport, "--specimen", file, "--out", out},
            {"replay", file, "--out", out},
            {"sensitivity", file, "--out", out},
            {"calibrate", file, "--smooth", "0.8", "--abrupt", "0.9", "--out", out},
            {"diagnose", file, "--out", out},
            {"view", file}};
}

/// Subcommands with sound input.
std::vector<Words> writers(const std::string& out) {
    return {{"run", scene("shell_on_cylinder"), "--out", out},
            {"sweep", kSweep, "--out", out},
            {"import", kExport, "--out", out},
            {"replay", kCase, "--fidelity", "coarse", "--out", out},
            {"sensitivity", kCase, "--fidelity", "coarse", "--out", out},
            {"calibrate", scene("two_shells"), "--smooth", "0.8333", "--abrupt", "0.8611", "--out", out},
            {"diagnose", kCase, "--out", out},
            {"validate", "--quick", "--out", out}};
}

/// The folder of a small sweep's results, for design.
std::string sweepResults(const Folder& folder, std::string& file) {
    file = folder.write("sweep.json", R"({"schema": "supercircle-sweep/1", "scene": ")" + scene("shell_on_cylinder") +
                                          R"(", "grid": {"phi_bar": [0.65, 0.75], "mu": [0.1, 0.35]},
        "fixed": {"elements": 8, "speed": 0.02}, "seeds": {"last": 2}})");
    REQUIRE(start({"sweep", file, "--out", folder / "results", "--quiet"}).code == 0);
    return folder / "results";
}

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

std::string line(const Words& words) {
    std::string text;
    for (const std::string& w : words)
        text += " " + w;
    return text;
}

} // namespace

TEST_CASE("input that cannot be used is exit 2, says which, and leaves nothing behind") {
    const Folder folder;
    const Folder results;
    const std::string bad = folder.write("bad.json", "{\"schema\": [1e400"),
                      number = folder.write("number.json", "[1e400]");
    // a directory and the memory of a process cannot be read by root either
    for (const std::string& file :
         {bad, number, folder / "missing.json", folder.path(), std::string("/dev/zero"), std::string("/proc/self/mem")})
        for (const Words& words : readers(file, results / "out")) {
            const CommandResult ending = start(words, {.directory = results.path()});
            INFO(line(words) << "\n" << ending.err);
            CHECK(ending.code == 2);
            CHECK_THAT(ending.err, Contains(file));
            CHECK(results.entries().empty());
        }
}

TEST_CASE("output that cannot be written is noticed before the work, exit 4") {
    const Folder folder;
    const std::string file = folder.write("file", "mine");
    for (const std::string& out : {file, file + "/below", std::string("/proc/none")})
        for (const Words& words : writers(out)) {
            const CommandResult ending = start(words, {.directory = folder.path()});
            INFO(line(words) << "\n" << ending.err);
            CHECK(ending.code == 4);
            CHECK_THAT(ending.err, Contains(out) && Contains("--out")); // the message of the check at the start
            CHECK(folder.entries() == Words{"file"});
        }
}

TEST_CASE("a disk that fills up is exit 4 and leaves no half file") {
    struct Full {
        Words words;
        long bytes = 1024;
        Words kept{}; ///< what a later start goes on from
    };
    const Full all[] = {
        {{"run", scene("shell_on_cylinder"), "--param", "elements=8"}},
        {{"sweep", kSweep}, 1024, {"out", "out/.lock", "out/results.sqlite"}},
        {{"import", kExport}},
        {{"replay", kCase, "--fidelity", "coarse"}},
        {{"sensitivity", kCase, "--fidelity", "coarse"}},
        {{"calibrate", scene("two_shells"), "--smooth", "0.8333", "--abrupt", "0.8611", "--param", "elements=8"}, 64},
        {{"diagnose", kCase}, 1024, {"out", "out/runs.cache"}},
        {{"validate", "--filter", "gravity_sag", "--quick"}}};
    for (const Full& full : all) {
        const Folder folder;
        Words words = with(full.words, {"--out", folder / "out"});
        if (words[0] != "validate")
            words.emplace_back("--quiet");
        const CommandResult ending = start(words, {.directory = folder.path(), .fileSizeLimit = full.bytes});
        INFO(line(words) << "\n" << ending.err);
        CHECK(ending.code == 4);
        CHECK_THAT(ending.err, Contains("cannot") || Contains("disk I/O error"));
        CHECK_THAT(ending.err, Contains(folder / "out")); // which file
        CHECK(folder.entries() == full.kept);
    }
}

TEST_CASE("results that want room to be read are no bad input on a full disk") {
    const Folder folder;
    std::string sweep;
    const std::string stored = sweepResults(folder, sweep);
    const CommandResult ending = start({"design", sweep, "--results", stored, "--target", "peak_force_R2_over_B=0.06"},
                                       {.directory = folder.path(), .fileSizeLimit = 1024});
    INFO(ending.err);
    CHECK(ending.code == 4);
    CHECK_THAT(ending.err, Contains("results.sqlite"));
    CHECK_FALSE(std::filesystem::exists(stored + "/design"));
}

TEST_CASE("a standard output that takes nothing is exit 4") {
    const Folder folder;
    std::string sweep;
    const std::string stored = sweepResults(folder, sweep);
    for (const Words& words : {Words{"run", scene("shell_on_cylinder"), "--param", "elements=8", "--out", folder / "a"},
                               Words{"check", scene("ramp")}, Words{"check", kCase}, Words{"effects"},
                               Words{"design", sweep, "--results", stored, "--target", "peak_force_R2_over_B=0.06"},
                               Words{"import", kExport, "--out", folder / "b"},
                               Words{"replay", kCase, "--fidelity", "coarse", "--out", folder / "c"},
                               Words{"validate", "--filter", "gravity_sag", "--quick", "--out", folder / "d"}}) {
        const CommandResult ending = start(words, {.directory = folder.path(), .standardOutput = "/dev/full"});
        INFO(line(words) << "\n" << ending.err);
        CHECK(ending.code == 4);
        CHECK_THAT(ending.err, Contains("standard output"));
    }
}

TEST_CASE("an interrupted command is exit 130 and leaves no half file") {
    // a million rows: reading them takes longer than the signal
    const Folder large;
    std::string rows = "time_s,displacement_mm,force_N\n";
    for (int i = 0; i < 1000000; ++i)
        rows += std::to_string(0.001 * i) + "," + std::to_string(1e-5 * i) + "," + std::to_string(1e-4 * i) + "\n";
    const std::string exported = large.write("large.csv", rows);
    // check, effects and design end at once; of view and the benchmarks tests of their own see to it
    for (const Words& words :
         {Words{"run", scene("stack30"), "--param", "shells=300", "--no-report"}, Words{"sweep", kSweep},
          Words{"import", exported}, Words{"validate"}, Words{"replay", kCase, "--elements", "200"},
          Words{"sensitivity", kCase}, Words{"diagnose", kCase},
          Words{"calibrate", scene("two_shells"), "--smooth", "0.8333", "--abrupt", "0.8611"}}) {
        const Folder folder;
        const Words all = with(words, {"--out", folder / "out"});
        const CommandResult ending =
            start(all, {.directory = folder.path(), .signal = SIGINT, .signalAfter = words[0] == "import" ? 0.1 : 0.3});
        INFO(line(all) << "\n" << ending.err);
        CHECK(ending.code == 130);
        for (const std::string& name : folder.entries()) // files are renamed when they are whole
            for (const char* half : {".csv.", ".json.", ".html.", ".png.", ".txt."})
                CHECK_THAT(name, !Contains(half));
    }
}

TEST_CASE("check of an experiment hears a signal while it simulates", "[cli]") {
    for (const int signal : {SIGINT, SIGTERM}) {
        const CommandResult ending = start({"check", kCase}, {.signal = signal}); // once it printed that it is valid
        INFO(ending.err);
        CHECK(ending.code == 130);
        CHECK_THAT(ending.out, Contains("valid experiment"));
    }
}

TEST_CASE("a limit of time or of processor time ends a diagnosis with a verdict") {
    for (const char* option : {"--time-limit", "--cpu-limit"}) {
        const Folder folder;
        const CommandResult ending = start({"diagnose", kCase, option, "1e-4", "--quiet", "--out", folder / "out"});
        INFO(option << "\n" << ending.err);
        CHECK(ending.code == 0);
        const std::string text = contentOf(folder / "out/diagnosis.json");
        CHECK_THAT(text, Contains("The time limit ended the diagnosis"));
    }
}
