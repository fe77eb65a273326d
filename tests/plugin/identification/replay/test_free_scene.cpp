// Free scenes as recorded experiments, from exported angles to the replay.

#include "tests/plugin/identification/replay/support.h"
#include "tests/support/folder.h"
#include "tests/support/json.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

using namespace replaytest;
using Catch::Contains;
using nlohmann::json;

namespace {

using test::Folder;

const std::string kScene = std::string(SC_SOURCE_DIR) + "/scenes/pendulum.json";

test::CommandResult start(const std::string& arguments) {
    return test::start(std::string(SC_PROGRAM) + " " + arguments);
}

/// Angles of a rod of 124 mm, an encoder of 0.09 degrees, held by hand for the first 0.2 s.
std::string encoderText(double release) {
    constexpr double kDegree = 3.14159265358979323846 / 180.0;
    const double w0 = 1.5 * 9.81 / 0.124;
    std::string text = "trigger_start_deg, sample_rate, duration_sec\n90, 1000, 2\n";
    double angle = release, spin = 0.0;
    for (int i = 0; i < 2000; ++i) {
        const double t = 1e-3 * i;
        if (t < 0.2) {
            angle = release * (1.0 - 0.5 * (t - 0.2) * (t - 0.2) / 0.04);
        } else { // leapfrog: error 1e-5 per oscillation at 1 ms
            spin -= 1e-3 * w0 * std::sin(angle);
            angle += 1e-3 * spin;
        }
        text += std::to_string(0.09 * std::round(angle / kDegree / 0.09)) + "\n";
    }
    return text;
}

std::string imported(const Folder& folder, const std::string& more = "") {
    const std::string swing = folder.write("swing.txt", encoderText(-1.0));
    const auto end = start("import " + swing + " --columns 'angle[deg]' --from-turning-point 1 --average 5 --scene " +
                           kScene + more + " --out " + folder.path + "/exp");
    INFO(end.text);
    REQUIRE(end.code == 0);
    CHECK_THAT(end.text, Contains("rows up to turning point 1") && Contains("ready: supercircle replay"));
    return folder.path + "/exp/experiment.json";
}

} // namespace

TEST_CASE("an oscillation may start at any turning point", "[replay][free]") {
    const Folder folder;
    const std::string swing = folder.write("swing.txt", encoderText(-1.0));
    const std::string words =
        "import " + swing + " --columns 'angle[deg]' --average 5 --scene " + kScene + " --from-turning-point ";
    // Without friction it turns at -1 and +1 rad.
    for (const int turn : {1, 2, 3}) {
        const std::string out = folder.path + "/from" + std::to_string(turn);
        const auto end = start(words + std::to_string(turn) + " --out " + out);
        INFO(end.text);
        REQUIRE(end.code == 0);
        const json released = test::jsonOf(out + "/experiment.json")["runs"][0]["parameters"]["release_angle"];
        CHECK(released["value"].get<double>() ==
              Approx(turn % 2 == 1 ? -1.0 : 1.0).margin(released["unc"].get<double>() + 1e-3));
    }
    const auto never = start(words + "1000 --out " + folder.path + "/never");
    CHECK(never.code == 0);
    CHECK_THAT(never.text, Contains("no rows are removed at its start"));
}

TEST_CASE("an encoder recording is imported, checked and replayed", "[replay][free]") {
    const Folder folder;
    const std::string experiment = imported(folder);
    const json description = test::jsonOf(experiment);
    CHECK(description["protocol"] == "free_scene");
    CHECK(description["observed"]["body"] == "rod");
    const json& released = description["runs"][0]["parameters"]["release_angle"];
    // The encoder leaves a tenth of a degree, and the first mean is 2 ms after the turning point.
    CHECK(released["value"].get<double>() == Approx(-1.0).margin(released["unc"].get<double>() + 1e-3));
    const auto check = start("check " + experiment);
    CHECK(check.code == 0);
    CHECK_THAT(check.text, Contains("release_angle_run1") && Contains("length of the rod"));
    const auto end = start("replay " + experiment + " --out " + folder.path + "/replay");
    INFO(end.text);
    REQUIRE(end.code == 0);
    const json out = test::jsonOf(folder.path + "/replay/replay.json");
    // Release known to half a degree and a few degrees a second: some degrees after three oscillations.
    CHECK(out["runs"][0]["rmse_deg"].get<double>() < 3.0);
    CHECK(out["runs"][0]["peak_recorded_deg"].get<double>() == Approx(57.3).epsilon(0.01));
    std::ifstream csv(folder.path + "/replay/run_1_replay.csv");
    std::string header;
    std::getline(csv, header);
    CHECK(header == "time_s,angle_recorded_deg,angle_simulated_deg,residual_deg");
    CHECK(start("replay " + experiment + " --effect bearing_friction:torque_N_m=1e-4 --out " + folder.path + "/dry")
              .code == 0);
    CHECK(test::jsonOf(folder.path + "/dry/replay.json")["effects"]["bearing_friction"]["torque_N_m"] == 1e-4);
}

TEST_CASE("effects that do not fit a scene are rejected", "[replay][free]") {
    const Folder folder;
    const std::string experiment = imported(folder), out = " --out " + folder.path + "/x";
    CHECK_THAT(start("replay " + experiment + " --effect plasticity:My_over_B_1_m=3" + out).text,
               Contains("in this scene of rigid bodies"));
    CHECK_THAT(start("replay " + baselinePath(106) + " --effect air_drag:linear_N_s_m2=1" + out).text,
               Contains("which this experiment is not"));
    json wrong = test::jsonOf(experiment);
    wrong["observed"]["body"] = "rood";
    folder.write("exp/wrong.json", test::jsonText(wrong));
    CHECK_THAT(start("check " + folder.path + "/exp/wrong.json").text, Contains("did you mean \"rod\"?"));
    wrong["observed"]["body"] = "rod";
    wrong["scene_parameters"]["lenght"] = 0.1;
    folder.write("exp/wrong.json", test::jsonText(wrong));
    CHECK_THAT(start("check " + folder.path + "/exp/wrong.json").text, Contains("did you mean \"length\"?"));
    wrong["scene_parameters"].erase("lenght");
    wrong["observed"] = {{"body", "rod"}, {"quantity", "x"}};
    wrong.erase("sensors");
    folder.write("exp/wrong.json", test::jsonText(wrong));
    CHECK_THAT(start("check " + folder.path + "/exp/wrong.json").text, Contains("there is no column x_mm"));
}

TEST_CASE("markers on bodies are recorded beside the angle at both fidelities", "[replay][free]") {
    const Folder folder;
    json description = test::jsonOf(imported(folder));
    description["markers"] = json::array({{{"name", "tip"}, {"body", "rod"}, {"local_point_m", {0.0, -0.124}}}});
    description["runs"][0]["markers_sampling_hz"] = 50;
    std::vector<scene::Problem> problems;
    const auto e = experiment::load(folder.write("exp/tip.json", test::jsonText(description)), problems);
    REQUIRE(e);
    const replay::Parameters p = replay::nominal(*e);
    const replay::Simulated fine = replay::simulate(*e, 0, p, replay::Resolution::fine()),
                            coarse = replay::simulate(*e, 0, p, replay::Resolution::coarse());
    REQUIRE(fine.failure.empty());
    REQUIRE(fine.markers.time.size() > 80);
    for (std::size_t k = 0; k < fine.markers.time.size(); ++k)
        CHECK(std::hypot(fine.markers.x[0][k], fine.markers.y[0][k]) ==
              Approx(0.124).epsilon(1e-6)); // cubic interpolation
    for (std::size_t k = 0; k < fine.readings.time.size(); ++k)
        CHECK(coarse.readings.force[k] == Approx(fine.readings.force[k]).margin(2e-5)); // rad: a thousandth of a degree
}

TEST_CASE("sensitivities of a pendulum agree with its time scale", "[replay][free]") {
    const Folder folder;
    const std::string experiment = imported(folder);
    const auto e = experiment::load(experiment);
    REQUIRE(e);
    // The angle depends on length and gravity through g / L alone: L d/dL = - g d/dg.
    replay::Parameters p = replay::nominal(e.value());
    const auto derivative = [&](const char* name, double value, double step) {
        replay::Parameters a = p, b = p;
        REQUIRE(replay::set(a, e.value(), name, value + step).empty());
        REQUIRE(replay::set(b, e.value(), name, value - step).empty());
        const auto hi = replay::simulate(e.value(), 0, a, replay::Resolution::fine()).readings.force;
        const auto lo = replay::simulate(e.value(), 0, b, replay::Resolution::fine()).readings.force;
        return (hi.back() - lo.back()) / (2.0 * step);
    };
    CHECK(0.124 * derivative("length", 0.124, 1e-5) ==
          Approx(9.81 * derivative("gravity_y", -9.81, 1e-3)).epsilon(1e-3)); // gravity_y is - g
    const auto end = start("sensitivity " + experiment + " --effects --jobs 1 --out " + folder.path + "/s");
    INFO(end.text);
    CHECK(end.code == 0);
    std::ifstream csv(folder.path + "/s/run_1_sensitivity.csv");
    std::string header;
    std::getline(csv, header);
    CHECK_THAT(header, Contains("dangle_dlength") && Contains("air_drag:quadratic_N_s2_m3"));
}
