// Tables of states of rest: files without times.

#include "tests/plugin/recording/experiment/support.h"

using namespace experimenttest;
using Catch::Matchers::Contains;

namespace {

const std::string kRows = "weight_g,tip_mm\n0,0\n50,3\n100,6\n150,9\n150,9\n100,6\n0,0\n";
const std::string kDrive = R"("drive": {"parameter": "weight", "column": "weight_g", "scale": 9.81e-3}, )";

/// A strip with weights at its end.
struct Table {
    std::string scene = "cantilever_weights", observe = "tip_y", drive = kDrive, run = R"("file": "run.csv")",
                rows = kRows, more, text;

    [[nodiscard]] Result<experiment::Experiment> load() const {
        const Folder folder;
        folder.write("run.csv", rows);
        folder.write("other.csv", more);
        folder.write("strip.json", text);
        return experiment::load(
            folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene", "scene": ")" +
                                                scene + R"(", )" + drive + R"("channels": [{"observe": ")" + observe +
                                                R"(", "column": "tip_mm", "sign": -1}], "runs": [{)" + run + "}]}"));
    }
    [[nodiscard]] std::string refused() const {
        const auto loaded = load();
        CHECK_FALSE(loaded);
        return loaded.error();
    }
};

} // namespace

TEST_CASE("a file without times is a table that drives through its rows", "[experiment][tables]") {
    const auto e = Table{}.load();
    INFO(e.error());
    REQUIRE(e);
    CHECK(experiment::isTable(*e));
    const experiment::Run& run = e->runs.front();
    REQUIRE(run.readings.time.size() == 7);
    CHECK(run.driveTime == run.readings.time);
    CHECK(run.driveDisplacement[3] == Approx(0.150 * 9.81));
    CHECK(run.driveDisplacement[4] == run.driveDisplacement[3]); // read twice
    CHECK(run.readings.force[1] == Approx(-0.003));
    for (std::size_t k = 1; k < 7; ++k)
        CHECK(run.readings.time[k] - run.readings.time[k - 1] == Approx(run.readings.time[1]));
    Table clocked;
    clocked.rows = "time_s,weight_g,tip_mm\n0,0,0\n1,50,3\n2,100,6\n3,150,9\n4,150,9\n5,100,6\n6,0,0\n";
    REQUIRE(clocked.load());
    CHECK_FALSE(experiment::isTable(*clocked.load()));
}

TEST_CASE("what is no table is refused with the reason", "[experiment][tables]") {
    Table t;
    t.rows = "weight_g,tip_mm\n0,0\n50,3\n100,6\n150,9\n200,12\n";
    CHECK_THAT(t.refused(), Contains("run.csv:1:1") && Contains("a table of 5 rows; expected at least 6"));
    t.rows = "Time_s,weight_g,tip_mm\n0,0,0\n1,50,3\n2,100,6\n3,150,9\n4,200,12\n5,250,15\n";
    CHECK_THAT(t.refused(), Contains("no column time_s") && Contains("did you mean \"Time_s\"?"));
    t.rows = "weight_g,tip_mm\n0,0\n50,3\n,6\n150,9\n150,9\n100,6\n0,0\n";
    CHECK_THAT(t.refused(), Contains("run.csv:4:1") && Contains("weight_g of row 3 is missing"));
    t.rows = "load_g,tip_mm\n0,0\n50,3\n100,6\n150,9\n150,9\n100,6\n0,0\n";
    CHECK_THAT(t.refused(), Contains("no column weight_g; expected what /drive names"));
    t.rows = kRows;
    t.run = R"("file": "run.csv", "ignore_s": [[1, 2]])";
    CHECK_THAT(t.refused(), Contains("no clock") && Contains("ignore_s"));
    t.run = R"("file": "run.csv"}, {"file": "other.csv")";
    t.more = "time_s,weight_g,tip_mm\n0,0,0\n1,50,3\n2,100,6\n";
    CHECK_THAT(t.refused(), Contains("other.csv") && Contains("tables are an experiment of their own"));
    Table swings;
    swings.scene = "sled";
    swings.observe = "position";
    swings.drive = R"("drive": {"column": "travel_mm"}, )";
    swings.rows = "travel_mm,tip_mm\n0,0\n50,3\n100,6\n150,9\n150,9\n100,6\n0,0\n";
    CHECK_THAT(swings.refused(), Contains("bodies on joints are simulated in motion"));
    Table undriven;
    undriven.drive = "";
    CHECK_THAT(undriven.refused(), Contains("no column time_s") && Contains("\"drive\" with a \"column\""));
}

TEST_CASE("a table of a scene that is refused is not judged as one of another kind", "[experiment][tables]") {
    // A strip beside a body that can be pushed: the scene is refused, its shell is none of bodies on joints.
    Table t;
    t.scene = "strip.json";
    t.text = R"({"schema": "supercircle-scene/1", "parameters": {"weight": {"value": 1}},
        "body": [{"name": "table", "type": 0}, {"name": "box", "type": 2, "massData-mass": 1, "massData-I": 1}],
        "shell": [{"name": "strip", "radius": "infinite", "length": 0.1, "thickness": 5e-4, "width": 0.01,
                   "young_modulus": 2e9, "density": 1270, "elements": 24}],
        "hold": [{"shell": "strip", "arc_fraction": 0}],
        "load": [{"shell": "strip", "arc_fraction": 1, "force_N": {"x": 0, "y": {"expr": "-weight"}}}],
        "observe": [{"name": "tip_y", "of": "shell", "shell": "strip", "arc_fraction": 1, "quantity": "y"}]})";
    CHECK_THAT(t.refused(), Contains("the body \"box\" can be pushed") && !Contains("time_s"));
    // Without the scene nothing is known about the columns.
    t.text = "{";
    CHECK_THAT(t.refused(), Contains("strip.json:1:2") && !Contains("run.csv"));
    t.text = "";
    t.scene = "cantilever_weights";
    t.observe = "tip_z";
    CHECK_THAT(t.refused(), Contains("observes no \"tip_z\"") && !Contains("run.csv"));
}
