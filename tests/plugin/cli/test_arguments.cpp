// The command line: help, exit codes, messages, and that a failed command leaves no files.

#include "tests/plugin/cli/program.h"

#include <catch2/catch.hpp>
#include <csignal>

using namespace supercircle::test;
using Catch::Contains;

namespace {

/// The fastest scene, a few milliseconds.
std::vector<std::string> quick(const Folder& folder, std::vector<std::string> more = {}) {
    std::vector<std::string> all{"run", scene("shell_on_cylinder"), "--out", folder / "out"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

} // namespace

TEST_CASE("help and version") {
    for (const char* subcommand : {"run", "check", "bench"}) {
        const CommandResult ending = start({subcommand, "--help"});
        CHECK(ending.code == 0);
        CHECK_THAT(ending.out, Contains("Usage:") && Contains("--help"));
        CHECK_THAT(start({"--help"}).out, Contains(subcommand));
    }
    for (const char* option : {"--param", "--seed", "--out", "--threads", "--fixed-dt", "--no-report", "--quiet"})
        CHECK_THAT(start({"run", "--help"}).out, Contains(option));
    CHECK(start({"--version"}).code == 0);
}

TEST_CASE("wrong arguments are exit 2 and leave nothing behind") {
    const Folder folder;
    const auto refused = [&](const std::vector<std::string>& arguments, const std::string& said) {
        INFO(said);
        const CommandResult ending = start(arguments, {.directory = folder.path()});
        CHECK(ending.code == 2);
        CHECK_THAT(ending.err, Contains(said));
        CHECK(ending.out.empty());
        CHECK(folder.entries().empty());
    };
    const std::string valid = scene("shell_on_cylinder");
    refused({}, "subcommand");
    refused({"fly"}, "there is no subcommand \"fly\"");
    refused({"chek", "file"}, "did you mean \"check\"");
    refused({"run"}, "scene");
    refused({"run", valid, "--wings"}, "--wings");
    refused({"run", valid, "--seed", "-1"}, "--seed: -1 is not a whole number");
    refused({"run", valid, "--seed", "1.5"}, "1.5 is not a whole number");
    refused({"run", valid, "--threads", "0"}, "--threads");
    refused({"run", valid, "--fixed-dt", "0"}, "--fixed-dt: 0 is not a positive number");
    refused({"run", valid, "--fixed-dt", "nan"}, "--fixed-dt: nan is not a positive number");
    refused({"run", valid, "--param", "mu"}, "NAME=VALUE");
    refused({"run", valid, "--param", "mu="}, "NAME=VALUE");
    refused({"run", valid, "--param", "=1"}, "NAME=VALUE");
    refused({"run", valid, "--param", "mu=much"}, "NAME=VALUE");
    refused({"run", valid, "--param", "mu=nan"}, "finite number");
    refused({"run", valid, "--param", "mu=inf"}, "finite number");
    refused({"run", valid, "--param", "nu=0.3"}, "did you mean \"mu\"");
    refused({"run", valid, "--param", "mu=-0.1"}, "out of range");
    refused({"run", valid, "--param", "elements=2.5"}, "elements");
    refused({"run", "nowhere.json"}, "nowhere.json: there is no such file");
    refused({"run", "/"}, "directory");
    refused({"check", "nowhere.json"}, "nowhere.json: there is no such file");
}

TEST_CASE("an option in front of the scene takes one value") {
    const Folder folder;
    const CommandResult ending = start({"run", "--param", "mu=0.3", "--param", "phi_bar=0.7",
                                        scene("shell_on_cylinder"), "--out", folder / "out", "--quiet", "--no-report"});
    CHECK(ending.code == 0);
    CHECK_THAT(contentOf(folder / "out/summary.json"), Contains("\"mu\": 0.3") && Contains("\"phi_bar\": 0.7"));
}

TEST_CASE("a file that is no valid scene is exit 2 with its place, and nothing is left behind") {
    const Folder folder;
    const Folder results;
    const auto refused = [&](const std::string& text, const std::string& said) {
        const std::string file = folder.write("bad.json", text);
        for (const char* subcommand : {"check", "run"}) {
            const CommandResult ending = start({subcommand, file}, {.directory = results.path()});
            CHECK(ending.code == 2);
            CHECK_THAT(ending.err, Contains(said));
            CHECK(ending.out.empty());
        }
        CHECK(results.entries().empty());
    };
    refused("{\n  \"shell\": [\n", "bad.json:3:1:");
    refused("", "bad.json:1:1:");
    refused("[]", "bad.json:1:1:");
    refused("{ \"shel\": [] }", "/shel: ");
    refused("{ \"shel\": [] }", "did you mean \"shell\"");
    refused("{ \"shell\": [ { \"radius\": -1 } ], \"duration\": 1 }", "bad.json:1:26: /shell/0/radius");
    refused("{ \"shell\": [ { \"radius\": NaN } ], \"duration\": 1 }", "bad.json:1:26:");
    refused("{ \"shell\": [ { \"radius\": 1e999 } ], \"duration\": 1 }", "bad.json:1:26:");
    refused("{ \"duration\": 1, \"shell\": [ {}, { \"position\": { \"x\": 0.001, \"y\": 0 } } ] }", "at the start");
    refused("{ \"schema\": \"supercircle-scene/99\" }", "/schema");
}

TEST_CASE("experiments and sweeps are recognised and refused by name") {
    const Folder folder;
    const auto refused = [&](const std::string& text, const std::string& kind,
                             const std::vector<std::string>& subcommands = {"check", "run"}) {
        const std::string file = folder.write("other.json", text);
        for (const std::string& subcommand : subcommands) {
            const CommandResult ending = start({subcommand, file}, {.directory = folder.path()});
            CHECK(ending.code == 2);
            CHECK_THAT(ending.err, Contains(kind) && Contains("not a scene"));
        }
    };
    refused("{ \"schema\": \"rod-recordings/1\", \"runs\": [] }", "this is an experiment", {"run"});
    CHECK_THAT(start({"check", folder.write("other.json", "{ \"schema\": \"rod-recordings/1\", \"runs\": [] }")}).err,
               Contains("\"protocol\" is missing")); // check reads experiments, and reports what this one lacks
    refused("{ \"specimens\": [], \"runs\": [] }", "this is an experiment");
    refused("{ \"schema\": \"supercircle-sweep/1\" }", "this is a sweep", {"run"});
    CHECK_THAT(start({"check", folder.write("other.json", "{ \"schema\": \"supercircle-sweep/1\" }")}).err,
               Contains("\"scene\" is missing"));
    refused("{ \"scene\": \"stack30.json\", \"parameters\": { \"mu\": [ 0.1, 0.2 ] } }", "this is a sweep");
}

TEST_CASE("every scene of the project passes the check") {
    for (const char* name :
         {"stack30", "shell_on_cylinder", "two_shells", "cantilever", "squeeze", "pinning", "ramp"}) {
        const CommandResult ending = start({"check", scene(name)});
        INFO(name << ": " << ending.err);
        CHECK(ending.code == 0);
        CHECK_THAT(ending.out, Contains("valid scene") && Contains("elements"));
    }
}

TEST_CASE("output that cannot be written is exit 4, and nothing is half-written") {
    const Folder folder;
    const std::string file = folder.write("file", "mine");
    for (const std::string& out : {file, file + "/below", std::string("/proc/none"), std::string("/proc")}) {
        const CommandResult ending = start({"run", scene("shell_on_cylinder"), "--out", out});
        INFO(ending.err);
        CHECK(ending.code == 4);
        CHECK_THAT(ending.err, Contains(out) && Contains("--out"));
    }
    CHECK(contentOf(file) == "mine");
    SECTION("a disk that fills up leaves no file at all") {
        const CommandResult ending = start(quick(folder), {.fileSizeLimit = 4096});
        CHECK(ending.code == 4);
        CHECK_THAT(ending.err, Contains("cannot write") && Contains("too large"));
        CHECK(folder.entries() == std::vector<std::string>{"file"});
    }
    SECTION("or the old ones whole") {
        REQUIRE(start(quick(folder, {"--no-report", "--quiet"})).code == 0);
        const std::string before = contentOf(folder / "out/summary.json");
        CHECK(start(quick(folder, {"--quiet"}), {.fileSizeLimit = 4096}).code == 4);
        CHECK(contentOf(folder / "out/summary.json") == before);
        CHECK(folder.entries() ==
              std::vector<std::string>{"file", "out", "out/series.csv", "out/summary.json", "out/trajectory.json"});
    }
    SECTION("a standard output that takes nothing") {
        CHECK(start(quick(folder), {.standardOutput = "/dev/full"}).code == 4);
        CHECK(start({"check", scene("ramp")}, {.standardOutput = "/dev/full"}).code == 4);
    }
    SECTION("a folder for contact problems that takes none") {
        CHECK(start(quick(folder, {"--dump", file})).code == 4);
        CHECK(start(quick(folder, {"--dump", folder / "fcp"}), {.fileSizeLimit = 256}).code == 4);
        CHECK(folder.entries() == std::vector<std::string>{"file"});
    }
}

TEST_CASE("quiet runs print nothing, others end with the place of the results") {
    const Folder folder;
    const CommandResult silent = start(quick(folder, {"--quiet"}));
    CHECK(silent.code == 0);
    CHECK((silent.out + silent.err).empty());
    const CommandResult spoken = start(quick(folder));
    CHECK(spoken.code == 0);
    CHECK_THAT(spoken.out, Contains(folder / "out/report.html"));
    CHECK_FALSE(std::filesystem::exists(folder / "report.html"));
}

TEST_CASE("without --out the results are in out/ and the scene's name") {
    const Folder folder;
    REQUIRE(start({"run", scene("shell_on_cylinder"), "--quiet", "--no-report"}, {.directory = folder.path()}).code ==
            0);
    CHECK(std::filesystem::exists(folder / "out/shell_on_cylinder/summary.json"));
}

TEST_CASE("an interrupted run keeps what is done") {
    // 300 shells take minutes: the run is not finished when the signal comes.
    for (const int signal : {SIGINT, SIGTERM}) {
        const Folder folder;
        const CommandResult ending = start({"run", scene("stack30"), "--param", "shells=300", "--out", folder / "out"},
                                           {.signal = signal, .signalAfter = 0.5});
        INFO(ending.err);
        CHECK(ending.code == 130);
        CHECK_THAT(ending.err, Contains("interrupted; what is done is in"));
        CHECK_THAT(contentOf(folder / "out/summary.json"), Contains("\"status\": \"interrupted\""));
        CHECK_THAT(contentOf(folder / "out/series.csv"), Catch::StartsWith("time_s,displacement_m,force_N"));
        CHECK_THAT(contentOf(folder / "out/report.html"), Contains("</html>"));
    }
}

TEST_CASE("progress stays on one line of a terminal, with the time left") {
    const Folder folder;
    const CommandResult ending =
        start({"run", scene("stack30"), "--param", "shells=300", "--out", folder / "out", "--no-report"},
              {.terminal = true, .signal = SIGINT, .signalAfter = 1.5});
    CHECK(ending.code == 130);
    REQUIRE_THAT(ending.err, Contains("\r\033[K") && Contains("drop") && Contains("%"));
    std::size_t from = 0;
    while ((from = ending.err.find("\r\033[K", from)) != std::string::npos) { // 60 columns: none may wrap
        from += 4;
        const std::size_t end = ending.err.find_first_of("\r\n", from);
        const std::string line = ending.err.substr(from, end - from);
        if (line.find('%') != std::string::npos)
            CHECK(line.size() < 60);
    }
}

TEST_CASE("a simulation that cannot go on is exit 3, says what and when, and keeps the last valid state") {
    const Folder folder;
    // Turns by thousands of circles in the smallest step: the shell is quarantined, which ends an experiment.
    const std::string file = folder.write("fast.json", "{ \"shell\": [ { \"spin\": 1e12 } ], \"duration\": 0.1 }");
    const CommandResult ending = start({"run", file, "--out", folder / "out", "--quiet"});
    CHECK(ending.code == 3);
    CHECK_THAT(ending.err, Contains("could not go on") && Contains("at t =") && Contains(folder / "out"));
    CHECK_THAT(contentOf(folder / "out/summary.json"), Contains("\"status\": \"failed\""));
}
