// Experiments with several recorded channels.

#include "tests/plugin/recording/experiment/support.h"

#include <cmath>

using namespace experimenttest;
using Catch::Matchers::Contains;

namespace {

/// A weight on a spring with a distance sensor and an accelerometer.
std::string described(const std::string& second, const std::string& run = R"("file": "run.csv")") {
    return R"({"schema": "rod-recordings/1", "protocol": "scene", "scene": "mass_on_spring", "channels": [
        {"observe": "position", "column": "distance_mm", "noise_std": 0.4}, {)" +
           second + R"(}], "runs": [{)" + run + "}]}";
}

Result<experiment::Experiment> load(const std::string& text, std::string* problems = nullptr) {
    const Folder folder;
    folder.write("run.csv", "time_s,distance_mm,ay_g\n1,50,-1\n1.1,20,-0.5\n1.2,-30,0.5\n1.3,-50,1\n1.4,0,\n");
    std::vector<scene::Problem> found;
    auto loaded = experiment::load(folder.write("experiment.json", text), found);
    for (const scene::Problem& p : found)
        if (problems != nullptr)
            *problems += p.toString() + "\n";
    return loaded;
}

std::string refused(const std::string& text) {
    std::string problems;
    CHECK_FALSE(load(text, &problems));
    return problems;
}

} // namespace

TEST_CASE("each channel has its own column, unit, sign, zero, noise and weight", "[experiment][scenes]") {
    const auto loaded =
        load(described(R"("observe": "acceleration", "column": "ay_g", "sign": -1, "noise_std": 0.01, "weight": 0.25,
                          "zero": {"value": 1, "unc": 0.1})",
                       R"("file": "run.csv", "start_s": 1.1, "ignore_s": [[1.15, 1.25]])"));
    INFO(loaded.error());
    REQUIRE(loaded);
    constexpr double kG = 9.80665;
    REQUIRE(experiment::furtherChannels(*loaded).size() == 1);
    const experiment::FurtherChannel& c = experiment::furtherChannels(*loaded).front();
    CHECK(c.channel.name == "acceleration");
    CHECK(c.channel.weight == 0.25);
    CHECK(c.noise == Approx(0.01 * kG));
    CHECK(c.zero.value == Approx(-kG));
    CHECK(c.zero.halfWidth == Approx(0.1 * kG));
    const experiment::Readings& r = loaded->runs.front().readings;
    REQUIRE(r.further.size() == 1);
    REQUIRE(r.further.front().size() == r.time.size());
    CHECK(r.further.front()[0] == Approx(0.5 * kG));
    CHECK(std::isnan(r.further.front()[1])); // ignored
    CHECK(r.further.front()[2] == Approx(-kG));
    CHECK(std::isnan(r.further.front()[3])); // missing
    CHECK(std::isfinite(r.force[3]));
}

TEST_CASE("channels that do not fit are refused with their place", "[experiment][scenes]") {
    CHECK_THAT(refused(described(R"("observe": "acc", "column": "ay_g")")),
               Contains("/channels/1/observe") && Contains("observes no \"acc\""));
    CHECK_THAT(refused(described(R"("observe": "position", "column": "ay_g", "unit": "mm")")),
               Contains("/channels/1/observe") && Contains("compared twice"));
    CHECK_THAT(refused(described(R"("observe": "acceleration", "column": "ay")")),
               Contains("/channels/1") && Contains("names no unit"));
    CHECK_THAT(refused(described(R"("observe": "acceleration", "column": "az_g")")),
               Contains("there is no column az_g") && Contains("/channels/1"));
    CHECK_THAT(refused(described(R"("observe": "acceleration", "column": "ay_g", "weight": -1)")),
               Contains("/channels/1/weight"));
    std::string first = described(R"("observe": "acceleration", "column": "ay_g")");
    first.replace(first.find("\"noise_std\": 0.4"), 16, "\"weight\": 0");
    CHECK_THAT(refused(first), Contains("/channels/0/weight") && Contains("has no weight"));
}
