// The subcommands `calibrate` and `design`.

#include "tests/plugin/cli/program.h"
#include "tests/support/json.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace supercircle::test;
using Catch::Contains;
using nlohmann::json;

TEST_CASE("a switch observed on a cylinder gives the interval between two closed forms") {
    const Folder folder;
    const CommandResult ending = start({"calibrate", scene("shell_on_cylinder"), "--smooth", "0.75,0.8", "--abrupt",
                                        "0.9,0.85", "--param", "elements=16", "--out", folder / "out"});
    INFO(ending.err);
    REQUIRE(ending.code == 0);
    CHECK_THAT(ending.out, Contains("friction coefficient:"));
    const json result = jsonOf(folder / "out/calibration.json");
    // mu* of the theory, .3632 and .687, is where tips begin to stick; in a strip 2 to 4 % wide below it they slip a
    // little, stick again and unfold abruptly all the same, and sixteen elements add 1 %.
    CHECK(result["friction"]["low"].get<double>() == Approx(0.3632).epsilon(0.06));
    CHECK(result["friction"]["high"].get<double>() == Approx(0.687).epsilon(0.06));
    CHECK(result["friction"]["low"].get<double>() < 0.3632);
    CHECK(result["from_smooth"]["phi_bar"] == 0.8);
    CHECK(result["from_abrupt"]["phi_bar"] == 0.85);
}

TEST_CASE("calibrate refuses what it cannot use") {
    const auto refused = [](std::vector<std::string> arguments, const std::string& what) {
        arguments.insert(arguments.begin(), "calibrate");
        const CommandResult ending = start(arguments);
        CHECK(ending.code == 2);
        CHECK_THAT(ending.err, Contains(what));
    };
    refused({scene("two_shells")}, "--smooth");
    refused({scene("two_shells"), "--smooth", "0.75,x"}, "--smooth");
    refused({scene("two_shells"), "--smooth", "0.9", "--abrupt", "0.8"}, "contradict");
    refused({"nowhere.json", "--smooth", "0.8"}, "nowhere.json");
    const CommandResult ramp = start({"calibrate", scene("ramp"), "--smooth", "0.8"}); // has no snap
    CHECK(ramp.code != 0);
    CHECK_THAT(ramp.err, Contains("snap_type"));
}

TEST_CASE("friction fitted to recorded curves is that of the recording", "[slow]") {
    const Folder folder;
    const std::string data = std::string(SC_TEST_DATA) + "/recordings/baseline/case_101/";
    const CommandResult ending = start({"calibrate", data + "experiment.json", "--out", folder / "out", "--quiet"});
    INFO(ending.err);
    REQUIRE(ending.code == 0);
    const json result = jsonOf(folder / "out/calibration.json");
    const double truth = jsonOf(data + "parameters.json")["true_parameters"]["friction"].get<double>();
    // The recording is of another simulator; the two agree in force to a few thousandths.
    CHECK(result["friction"]["value"].get<double>() == Approx(truth).epsilon(0.01));
    CHECK(result["friction"]["low"].get<double>() < result["friction"]["value"].get<double>());
    CHECK(result["friction"]["high"].get<double>() > result["friction"]["value"].get<double>());
}

TEST_CASE("design finds the pairs in the range of a sweep, and says what is out of reach") {
    const Folder folder;
    const std::string file =
        folder.write("sweep.json", R"({"schema": "supercircle-sweep/1", "scene": ")" + scene("shell_on_cylinder") +
                                       R"(", "grid": {"phi_bar": [0.65, 0.75], "mu": [0.1, 0.2, 0.4]},
        "fixed": {"elements": 8, "speed": 0.02}, "seeds": {"last": 2}})");
    REQUIRE(start({"sweep", file, "--out", folder / "out", "--quiet"}).code == 0);
    // The force grows with angle and friction (physics: .0550 to .1056 at .75 for mu 0 to .35): one pair per row.
    const CommandResult ending =
        start({"design", file, "--results", folder / "out", "--target", "peak_force_R2_over_B=0.06"});
    INFO(ending.err);
    REQUIRE(ending.code == 0);
    CHECK_THAT(ending.out, Contains("mu = 0.1") && Contains("phi_bar = 0."));
    CHECK_THAT(contentOf(folder / "out/design/design.html"), Contains("<svg") && Contains("</html>"));
    CHECK_THAT(contentOf(folder / "out/design/design_peak_force_R2_over_B.csv"), Contains("mu,phi_bar,phi_bar_error"));
    const CommandResult former =
        start({"design", file, "--results", folder / "out", "--want", "peak_force_R2_over_B=0.06"});
    CHECK(former.code == 0);
    CHECK(former.out == ending.out);
    CHECK_THAT(former.err, Contains("--want is called --target"));
    CHECK_THAT(start({"design", file, "--results", folder / "out"}).err, Contains("--target is required"));
    const CommandResult far =
        start({"design", file, "--results", folder / "out", "--target", "peak_force_R2_over_B=7"});
    CHECK(far.code == 2);
    CHECK_THAT(far.out, Contains("no pair gives this"));
    CHECK_THAT(start({"design", file, "--results", folder / "out", "--target", "peak_farce_R2_over_B=7"}).err,
               Contains("did you mean \"peak_force_R2_over_B\""));
    CHECK(start({"design", file, "--results", folder / "nowhere", "--target", "dissipation_ratio=7"}).code == 2);
}
