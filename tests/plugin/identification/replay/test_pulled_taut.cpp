// Strips that do not stretch between supports that part: distances by hand.

#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"
#include "plugin/scene/loader/problem.h"

#include "tests/support/folder.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;
using Catch::Matchers::Contains;

namespace {

/// A strip of 0.1 m along x, held where `holds` say; a machine moves along x, or nothing does.
struct HeldStrip {
    std::string holds, shape = R"("radius": "infinite")", observe = R"("of": "shell", "shell": "strip",
        "arc_fraction": 0.5, "quantity": "y")",
                       column = "y_mm", more, drive;
    bool machine = true;

    /// Why its only run cannot be simulated.
    [[nodiscard]] std::string failure() const {
        const test::Folder folder;
        const std::string protocol = R"("protocol": {"direction": {"x": 1, "y": 0},
            "segments": [{"speed_m_s": 1e-3, "stop_when": {"displacement": 1e-3}}]}, )";
        folder.write("strip.json", R"({"schema": "supercircle-scene/1", "lengthScale": 10, "gravity": 0,
            "shell": [{"name": "strip", "position": {"x": 0.05, "y": 0}, "length": 0.1, "thickness": 5e-4,
                       "width": 0.01, "young_modulus": 2e9, "density": 1270, "elements": 24, )" +
                                       shape + R"(}], "hold": [)" + holds + "], " + more +
                                       (machine ? protocol : R"("numerics": {"quasi_static": true}, )") +
                                       R"("observe": [{"name": "seen", )" + observe + "}]}");
        std::string rows = "time_s," + column + "\n";
        for (int i = 0; i <= 30; ++i)
            rows += std::to_string(0.1 * i) + "," + std::to_string(0.01 * i) + "\n";
        folder.write("run.csv", rows);
        const auto e = experiment::load(folder.write("experiment.json", R"({"schema": "rod-recordings/1",
            "protocol": "scene", "scene": "strip.json", "channels": [{"observe": "seen", "column": ")" +
                                                                            column + R"("}],
            "runs": [{"file": "run.csv")" + drive + "}]}"));
        INFO(e.error());
        REQUIRE(e);
        return replay::simulate(*e, 0, replay::nominal(*e), replay::Resolution::coarse()).failure;
    }
};

const std::string kEnds =
    R"({"shell": "strip", "arc_fraction": 0}, {"shell": "strip", "arc_fraction": 1, "base": "moving"})";

std::string travels(const std::string& mm) {
    return R"(, "drive_time_s": [0, 1, 3], "drive_displacement_mm": [0, )" + mm + "]";
}

} // namespace

TEST_CASE("a drive that parts the supports of a strip is refused where the strip becomes straight", "[replay][taut]") {
    HeldStrip s;
    s.holds = kEnds;
    s.shape = R"("natural_curvature": 0.1)"; // the chord is 0.1 mm 0.01^2 / 24 shorter: 0.000417 mm
    s.drive = travels("-1, 3");
    // Straight after 1.000417 mm of 4 mm in 2 s.
    CHECK_THAT(s.failure(), Contains("the shell \"strip\"") && Contains("arc fractions 0 and 1") &&
                                Contains("100 mm long") && Contains("t = 1.50021 s") && Contains("102.999583 mm") &&
                                Contains("do not stretch"));
    s.drive = travels("-1, -0.2"); // it bends all the time
    CHECK(s.failure() == "");
    s.drive = travels("-1, 0.0005"); // a zero that is a little off: 7e4 N where it was simulated
    CHECK_THAT(s.failure(), Contains("100.000083 mm"));
    s.drive = travels("0.5, 0");
    CHECK_THAT(s.failure(), Contains("100.499583 mm"));
}

TEST_CASE("a straight strip is refused as it is placed: pressed lengthwise it would choose no side", "[replay][taut]") {
    HeldStrip s;
    s.holds = kEnds;
    s.drive = travels("-1, -2");
    CHECK_THAT(s.failure(), Contains("t = 0 s, a displacement of 0 mm.") && Contains("natural_curvature"));
}

TEST_CASE("a bent strip has as much slack as its chord says", "[replay][taut]") {
    HeldStrip s;
    s.holds = kEnds;
    s.shape = R"("natural_curvature": 10)"; // an arc of 1 rad: a chord of 2 sin(0.5) / 10
    const double slack = 1e3 * (0.1 - 0.2 * std::sin(0.5));
    REQUIRE(slack == Approx(4.1149).epsilon(1e-4));
    s.drive = travels("0, 4");
    CHECK(s.failure() == "");
    s.drive = travels("0, 5");
    CHECK_THAT(s.failure(), Contains("a displacement of 4.11489 mm") && Contains("100.885108 mm"));
}

TEST_CASE("a straight strip between supports that do not move cannot bend", "[replay][taut]") {
    HeldStrip s;
    s.machine = false;
    s.holds = R"({"shell": "strip", "arc_fraction": 0}, {"shell": "strip", "arc_fraction": 1, "kind": "pin"})";
    CHECK_THAT(s.failure(), Contains("arc fractions 0 and 1") && Contains("cannot bend") && Contains("roller"));
    // A part of it that is loaded, and one where nothing is read: a clamp of a finite length.
    s.holds = R"({"shell": "strip", "arc_fraction": 0}, {"shell": "strip", "arc_fraction": 0.2})";
    CHECK(s.failure() == "");
    s.more = R"("load": [{"shell": "strip", "arc_fraction": 0.1, "force_N": {"x": 0, "y": 1e-4}}], )";
    CHECK_THAT(s.failure(), Contains("arc fractions 0 and 0.2") && Contains("20 mm long"));
    s.more = "";
    s.observe = R"("of": "shell", "shell": "strip", "arc_fraction": 0.1, "quantity": "y")";
    CHECK_THAT(s.failure(), Contains("cannot bend"));
}
