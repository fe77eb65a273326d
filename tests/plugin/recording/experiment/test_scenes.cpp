// Experiments that name a scene: channels, units, starts, parts that are left out.

#include "tests/plugin/recording/experiment/support.h"

#include <cmath>

using namespace experimenttest;
using Catch::Matchers::Contains;

namespace {

/// An experiment of a weight on a spring with a file of four rows; what is asked for replaces a part of it.
struct Example {
    Folder folder;
    std::string scene, channel, run;
    Example() { reset(); }

    void reset() {
        scene = "mass_on_spring";
        channel = R"("observe": "position", "column": "distance_mm")";
        run = R"("file": "run.csv")";
    }
    [[nodiscard]] Result<experiment::Experiment> load(std::string* problems = nullptr) const {
        folder.write("run.csv", "time_s,distance_mm\n1,50\n1.1,20\n1.2,-30\n1.3,-50\n1.4,0\n");
        const std::string file = folder.write(
            "experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene", "scene": ")" + scene +
                                   R"(", "channels": [{)" + channel + R"(}], "runs": [{)" + run + "}]}");
        std::vector<scene::Problem> found;
        auto loaded = experiment::load(file, found);
        for (const scene::Problem& p : found)
            if (problems != nullptr)
                *problems += p.toString() + "\n";
        return loaded;
    }
    [[nodiscard]] std::string refused() const {
        std::string problems;
        CHECK_FALSE(load(&problems));
        return problems;
    }
};

} // namespace

TEST_CASE("a column takes its unit from its name, its sign and zero from the channel", "[experiment][scenes]") {
    Example e;
    e.run = R"("file": "run.csv", "start_s": 1.1, "ignore_s": [[1.15, 1.25]])";
    e.channel += R"(, "sign": -1, "noise_std": 0.4, "zero": {"value": 3, "unc": 2})";
    const auto loaded = e.load();
    REQUIRE(loaded);
    const experiment::Run& run = loaded->runs.front();
    REQUIRE(run.readings.time.size() == 4);
    CHECK(run.readings.time.front() == Approx(0.0).margin(1e-12));
    CHECK(run.readings.time.back() == Approx(0.3));
    CHECK(run.readings.force.front() == Approx(-0.02));
    CHECK(std::isnan(run.readings.force[1]));
    CHECK(run.samplingRate == Approx(10.0));
    CHECK(run.driveTime.back() == Approx(0.3));
    CHECK(loaded->scene->zero.value == Approx(-0.003));
    CHECK(loaded->scene->zero.halfWidth == Approx(0.002));
    CHECK(loaded->sensors.forceNoise == Approx(4e-4));
    CHECK(loaded->gravity.y == 0.0); // of the scene
    CHECK(experiment::isFree(*loaded));
    CHECK(experiment::channel(*loaded).name == "position");
}

TEST_CASE("scenes, observations, units and drives that do not fit are refused with the remedy",
          "[experiment][scenes]") {
    Example e;
    e.scene = "mass_on_sprong";
    CHECK_THAT(e.refused(), Contains("no scene \"mass_on_sprong\"") && Contains("mass_on_spring"));
    e.reset();
    e.channel = R"("observe": "positon", "column": "distance_mm")";
    CHECK_THAT(e.refused(), Contains("observes no \"positon\"") && Contains("did you mean \"position\""));
    e.channel = R"("observe": "position", "column": "distance")";
    CHECK_THAT(e.refused(), Contains("names no unit") && Contains("m, mm, um"));
    e.channel = R"("observe": "position", "column": "distance_mm", "unit": "inch")";
    CHECK_THAT(e.refused(), Contains("\"inch\" is no unit"));
    e.reset();
    e.run = R"("file": "run.csv", "drive_time_s": [0, 1], "drive_displacement_mm": [0, 1])";
    CHECK_THAT(e.refused(), Contains("no machine"));
    e.reset();
    e.scene = "sled";
    e.channel = R"("observe": "force", "column": "distance_mm", "unit": "N")";
    CHECK_THAT(e.refused(), Contains("the run no drive"));
    e.run = R"("file": "run.csv", "drive_time_s": [1, 1.4], "drive_displacement_mm": [0, 1])";
    CHECK(e.load());
    e.reset();
    e.run = R"("file": "run.csv", "ignore_s": [[2, 1]])";
    CHECK_THAT(e.refused(), Contains("/runs/0/ignore_s/0"));
}
