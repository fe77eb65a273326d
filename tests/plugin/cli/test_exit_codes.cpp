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
            {"diagnose", file, "--out", out}};
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
    for (const std::string& file : {bad, number, folder / "missing.json", folder.path(), std::string("/dev/zero")})
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
    for (const Words& words : {Words{"import", kExport}, Words{"replay", kCase, "--fidelity", "coarse"}}) {
        const Folder folder;
        Words all = words;
        all.insert(all.end(), {"--out", folder / "out", "--quiet"});
        const CommandResult ending = start(all, {.directory = folder.path(), .fileSizeLimit = 1024});
        INFO(line(all) << "\n" << ending.err);
        CHECK(ending.code == 4);
        CHECK_THAT(ending.err, Contains("cannot write"));
        CHECK(folder.entries().empty());
    }
}

TEST_CASE("an interrupted command is exit 130") {
    for (const Words& words : {Words{"sweep", kSweep}, Words{"replay", kCase, "--elements", "200"},
                               Words{"sensitivity", kCase}, Words{"diagnose", kCase},
                               Words{"calibrate", scene("two_shells"), "--smooth", "0.8333", "--abrupt", "0.8611"}}) {
        const Folder folder;
        Words all = words;
        all.insert(all.end(), {"--out", folder / "out"});
        const CommandResult ending = start(all, {.directory = folder.path(), .signal = SIGINT});
        INFO(line(all) << "\n" << ending.err);
        CHECK(ending.code == 130);
    }
}
