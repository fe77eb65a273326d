// Recordings whose set-up is a scene: those of a machine, and tables of weights and deflections.

#include "tests/plugin/recording/import/support.h"
#include "tests/support/json.h"

#include "plugin/recording/experiment/load.h"

#include <algorithm>
#include <nlohmann/json.hpp>

using namespace importingtest;
using Catch::Contains;

namespace {

using test::CommandResult;

CommandResult imports(const std::string& arguments) {
    return test::start(std::string(SC_PROGRAM) + " " + arguments);
}

/// Largest difference between recording and replay of the first run, in the unit of its channel.
double largestError(const std::string& folder, const char* key) {
    const CommandResult end = imports("replay " + folder + "/experiment.json --out " + folder + "/replay");
    INFO(end.text);
    REQUIRE(end.code == 0);
    return test::jsonOf(folder + "/replay/replay.json")["runs"][0][key].get<double>();
}

constexpr double kStandardGravity = 9.80665; // m/s^2

/// Weights at the end of a strip of 0.3 x 0.02 x 0.001 m of steel, read by a dial that shows 0.41 mm without any:
/// F L^3 / (3 B).
std::string weightTable(int points, const char* head = "Mass,Displacement\n", double sign = 1.0, bool clock = false) {
    const double B = 2e11 * 0.02 * 1e-9 / 12.0;
    std::string text = head;
    for (int i = 0; i < points; ++i) {
        const double kg = 0.002 * i, mm = 1e3 * kg * kStandardGravity * 0.027 / (3.0 * B);
        text += (clock ? printed(2.0 * i, 3) + "," : "") + printed(kg, 6) + "," + printed(0.41 + sign * mm, 6) + "\n";
    }
    return text;
}

const char* const weightless =
    R"({"scene_parameters": {"gravity": 0, "young_modulus": {"value": 2e11, "std_log": 0.1}}})";

} // namespace

TEST_CASE("a table of weights and deflections becomes an experiment that replays", "[importing][scenes]") {
    const Folder folder;
    for (const double sign : {1.0, -1.0}) { // the dial may count either way
        CAPTURE(sign);
        const std::string out = folder.path + (sign > 0.0 ? "/down" : "/up");
        const CommandResult end =
            imports("import " + folder.write("beam.dat", weightTable(11, "Mass,Displacement\n", sign)) +
                    " --columns 'force[kgf],displacement[mm]' --scene cantilever_weights --specimen " +
                    folder.write("own.json", weightless) + " --out " + out);
        INFO(end.text);
        REQUIRE(end.code == 0);
        CHECK_THAT(end.text, Contains("11 points read at rest") && Contains("ready: supercircle replay") &&
                                 Contains("the scene's own values, exact, of length, thickness, width"));
        CHECK(contentOf(out + "/run_1.csv").rfind("displacement_mm,force_N\n0.41", 0) == 0);
        const auto json = nlohmann::ordered_json::parse(contentOf(out + "/experiment.json"));
        CHECK(json["drive"]["parameter"] == "weight");
        CHECK(json["scene_parameters"].count("weight") == 0);               // driven
        CHECK(json["scene_parameters"]["young_modulus"].count("unc") == 0); // the user's own width alone
        CHECK(json["channels"][0]["sign"] == -sign);                        // the scene counts upwards
        CHECK(json["channels"][0]["zero"]["value"] == Approx(0.41));
        // arcs are stiffer by 1/(4 n^2) = 1e-3 with 16 of them, and the closed form is that of small angles: 2e-4
        const double most = 1e3 * 0.02 * kStandardGravity * 0.027 / (3.0 * 2e11 * 0.02 * 1e-9 / 12.0);
        CHECK(largestError(out, "max_error_mm") < 1.5e-3 * most);
    }
}

TEST_CASE("weights that were hung on by a clock drive the scene too", "[importing][scenes]") {
    const Folder folder;
    const std::string out = folder.path + "/out";
    const CommandResult end = imports(
        "import " + folder.write("beam.csv", weightTable(30, "time [s],force [kgf],displacement [mm]\n", 1.0, true)) +
        " --scene cantilever_weights --force-zero none --specimen " + folder.write("own.json", weightless) + " --out " +
        out);
    INFO(end.text);
    REQUIRE(end.code == 0);
    CHECK_THAT(end.text, Contains("ready: supercircle replay"));
    std::vector<scene::Problem> problems;
    const auto loaded = experiment::load(out + "/experiment.json", problems);
    INFO(loaded.error());
    REQUIRE(loaded);
    CHECK(experiment::drivesLoad(*loaded));
    CHECK_FALSE(experiment::isTable(*loaded));
}

TEST_CASE("a recording of a machine becomes an experiment with the machine of a scene", "[importing][scenes]") {
    const Folder folder;
    const std::string out = folder.path + "/out";
    std::string text = "Time (s),Load (N),Displacement (mm)\n";
    for (int i = 0; i <= 80;
         ++i) { // 500 N/m up to a friction of 0.588 N, pulled at 2 mm/s; noise: no sensor at its end
        const double t = 0.025 * i, mm = 2.0 * t, noise = 5e-4 * (i * 7 % 5 - 2);
        text += printed(t, 4) + "," + printed(std::min(0.5 * mm, 0.588) + noise, 5) + "," + printed(mm, 5) + "\n";
    }
    const CommandResult end = imports("import " + folder.write("sled.csv", text) + " --scene sled --out " + out);
    INFO(end.text);
    REQUIRE(end.code == 0);
    const auto json = nlohmann::ordered_json::parse(contentOf(out + "/experiment.json"));
    CHECK(json["protocol"] == "scene");
    CHECK(json["channels"][0]["observe"] == "force");
    CHECK(json["runs"][0]["drive_displacement_mm"].size() == 2);
    CHECK(std::filesystem::exists(out + "/sled.json"));
    // A sled that breaks away overshoots by v sqrt(m k) = 0.02 N; the damper of the spring carries 0.002 N, noise 0.001
    // N.
    CHECK(largestError(out, "max_error_N") < 0.023);
}

TEST_CASE("a gauge at its end is seen in a table", "[importing][scenes]") {
    const Folder folder;
    std::string text = weightTable(9);
    const std::string stuck = text.substr(text.rfind(',', text.size() - 2) + 1); // the last reading, twice more
    for (int i = 9; i < 11; ++i)
        text += printed(0.002 * i, 6) + "," + stuck;
    for (const bool kept : {false, true}) {
        const std::string out = folder.path + (kept ? "/kept" : "/out");
        const CommandResult end = imports("import " + folder.write("beam.dat", text) +
                                          " --columns 'force[kgf],displacement[mm]' --scene cantilever_weights" +
                                          (kept ? " --keep saturation" : "") + " --out " + out);
        INFO(end.text);
        REQUIRE(end.code == 0);
        CHECK_THAT(end.text, Contains("in 3 rows of different loads: the gauge is at its end"));
        const std::string rows = contentOf(out + "/run_1.csv");
        CHECK((rows.find("nan") == std::string::npos) == kept); // missing
        CHECK_THAT(end.text, Contains("ready: supercircle replay"));
    }
}

TEST_CASE("what no scene can take is said with what would do", "[importing][scenes]") {
    const Folder folder;
    const auto refused = [&](const std::string& arguments, const std::string& why) {
        const CommandResult end = imports("import " + arguments + " --out " + folder.path + "/out");
        INFO(end.text);
        CHECK(end.code == 2);
        CHECK_THAT(end.text, Contains(why));
    };
    const std::string pressed = folder.write("pressed.csv", exported()),
                      columns = " --columns 'force[kgf],displacement[mm]'";
    refused(pressed + " --scene pendulum", "neither a machine nor a load");
    refused(pressed + " --scene sled --protocol two_shells", "expected one of the two");
    refused(pressed + " --protocol scene", "give its file or its name with --scene");
    refused(pressed + " --scene sleds", "sled");
    refused(folder.write("few.dat", weightTable(5)) + columns + " --scene cantilever_weights",
            "a table of points read at rest needs 6");
    refused(folder.write("beam.dat", weightTable(11)), "--scene cantilever_weights"); // the way out is named
}
