// `supercircle replay` and `supercircle check`, started as programs.

#include "tests/plugin/identification/replay/support.h"
#include "tests/support/folder.h"
#include "tests/support/json.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

using namespace replaytest;
using Catch::Contains;

namespace {

namespace fs = std::filesystem;

using test::CommandResult;
using test::Folder;

CommandResult startProgram(const std::string& arguments) {
    return test::start(std::string(SC_PROGRAM) + " " + arguments);
}

} // namespace

TEST_CASE("replay writes tables, summary, picture and page", "[replay]") {
    const Folder folder;
    const CommandResult end =
        startProgram("replay " + baselinePath(106) + " --fidelity coarse --param friction=0.31 --out " + folder.path);
    INFO(end.text);
    REQUIRE(end.code == 0);
    for (const char* name : {"run_1_replay.csv", "run_1_replay_markers.csv", "run_1_replay.png", "replay.html"})
        CHECK(fs::file_size(folder.path + "/" + name) > 1000);
    const nlohmann::json replayed = test::jsonOf(folder.path + "/replay.json");
    CHECK(replayed["parameters"]["friction"] == 0.31);
    CHECK(replayed["elements"] == replay::Resolution::coarse().elements);
    REQUIRE(replayed["runs"].size() == 1);
    CHECK(replayed["runs"][0]["failure"].is_null());
    CHECK(replayed["runs"][0]["rmse_N"].get<double>() < 0.05 * replayed["runs"][0]["peak_recorded_N"].get<double>());
    std::ifstream csv(folder.path + "/run_1_replay.csv");
    std::string header;
    std::getline(csv, header);
    CHECK(header == "time_s,displacement_mm,force_recorded_N,force_simulated_N,residual_N");
}

TEST_CASE("replay rejects bad input with exit code 2", "[replay]") {
    const Folder folder;
    const std::string out = " --out " + folder.path + "/x";
    const CommandResult name = startProgram("replay " + baselinePath(106) + " --param frction=0.3" + out);
    CHECK(name.code == 2);
    CHECK_THAT(name.text, Contains("did you mean \"friction\"?"));
    CHECK(startProgram("replay " + baselinePath(106) + " --param friction=much" + out).code == 2);
    CHECK(startProgram("replay /nowhere/experiment.json" + out).code == 2);
    CHECK(startProgram("replay " + baselinePath(106) + " --elements 0" + out).code == 2);
    CHECK_FALSE(fs::exists(folder.path + "/x"));
}

TEST_CASE("check accepts an experiment and lists its parameters", "[replay]") {
    const CommandResult good = startProgram("check " + baselinePath(103));
    CHECK(good.code == 0);
    CHECK_THAT(good.text, Contains("valid experiment (two_shells, 2 specimens, 1 runs, 8 markers)"));
    CHECK_THAT(good.text, Contains("bending_modulus.B"));
    const Folder folder;
    std::ofstream(folder.path + "/e.json") << R"({"schema": "rod-recordings/1", "protokol": "two_shells"})";
    const CommandResult bad = startProgram("check " + folder.path + "/e.json");
    CHECK(bad.code == 2);
    CHECK_THAT(bad.text, Contains("e.json:1:32: /protokol: unknown key \"protokol\"; did you mean \"protocol\"?"));
}
