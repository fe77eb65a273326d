// Sensors of channels beside the first one.

#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"

#include "tests/support/folder.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;

namespace {

experiment::Experiment oscillator() {
    const test::Folder folder;
    std::string rows = "time_s,y_mm,a_m_s2\n";
    for (int k = 0; k < 100; ++k)
        rows += std::to_string(0.01 * k) + "," + std::to_string(k % 7) + "," + std::to_string(k % 5) + "\n";
    folder.write("run.csv", rows);
    auto out = experiment::load(folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene",
        "scene": "mass_on_spring", "channels": [{"observe": "position", "column": "y_mm", "zero": {"value": 3}},
        {"observe": "acceleration", "column": "a_m_s2", "zero": {"value": 0.3}}], "runs": [{"file": "run.csv"}]})"));
    INFO(out.error());
    REQUIRE(out);
    return *out;
}

replay::Simulated playedWith(const experiment::Experiment& e, const std::vector<std::string>& effects) {
    replay::Parameters p = replay::nominal(e);
    for (const std::string& text : effects)
        REQUIRE(effects::add(p.effects, text).empty());
    REQUIRE(replay::checkEffects(p, e) == "");
    auto out = replay::simulate(e, 0, p, replay::Resolution::fine());
    REQUIRE(out.failure == "");
    return out;
}

} // namespace

TEST_CASE("a sensor effect acts on the channel that it names", "[replay][mechanism]") {
    const auto e = oscillator();
    const double w = 2.0 * M_PI * 1.5;
    const auto plain = playedWith(e, {});
    const auto gain = playedWith(e, {"sensor_gain:channel=acceleration", "sensor_gain:error=0.06"});
    const auto late = playedWith(e, {"sensor_delay:channel=acceleration", "sensor_delay:delay_s=0.02"});
    const auto first = playedWith(e, {"sensor_gain:error=0.06"});
    CHECK(gain.readings.force == plain.readings.force);
    CHECK(late.readings.force == plain.readings.force);
    CHECK(first.readings.further == plain.readings.further);
    for (std::size_t k = 0; k < plain.readings.time.size(); ++k) {
        const double t = plain.readings.time[k];
        CHECK(gain.readings.further[0][k] == Approx(0.3 - 1.06 * w * w * 0.05 * std::cos(w * t)).margin(2e-4));
        // between rows a delay reads the straight line: w^4 0.05 dt^2 / 8 at most, and here it ends on rows
        if (k > 2)
            CHECK(late.readings.further[0][k] == Approx(0.3 - w * w * 0.05 * std::cos(w * (t - 0.02))).margin(2e-4));
        CHECK(first.readings.force[k] == Approx(0.003 + 1.06 * 0.05 * std::cos(w * t)).margin(2e-6));
    }
}

TEST_CASE("a sensor effect on no channel is refused with the nearest name", "[replay]") {
    const auto e = oscillator();
    const auto why = [&](const std::string& name) {
        replay::Parameters p = replay::nominal(e);
        REQUIRE(effects::add(p.effects, "sensor_gain:channel=" + name).empty());
        REQUIRE(effects::add(p.effects, "sensor_gain:error=0.1").empty());
        return replay::checkEffects(p, e);
    };
    using Catch::Matchers::Contains;
    CHECK_THAT(why("aceleration"), Contains("did you mean \"acceleration\"?"));
    CHECK_THAT(why("position"), Contains("first channel, position, without \"channel\""));
    std::vector<effects::Setting> both;
    for (const char* name : {"", "acceleration"}) {
        both.push_back(effects::off(*effects::find("sensor_gain")));
        both.back().channel = name;
        both.back().values.front() = 0.1;
    }
    CHECK(effects::validate(both).empty());
    both.back().channel.clear();
    CHECK_THAT(effects::validate(both), Contains("given twice"));
    CHECK_THAT(effects::add(both, "plasticity:channel=force"), Contains("no parameter \"channel\""));
}

TEST_CASE("another channel can be the first one", "[replay]") {
    const auto e = oscillator();
    const auto swapped = experiment::withFirstChannel(e, "acceleration");
    REQUIRE(swapped);
    const auto a = playedWith(e, {}), b = playedWith(*swapped, {});
    CHECK(b.readings.force == a.readings.further[0]);
    CHECK(b.readings.further[0] == a.readings.force);
    CHECK(experiment::channel(*swapped).unit == "m_s2");
    CHECK_THAT(experiment::withFirstChannel(e, "speed").error(),
               Catch::Matchers::Contains("expected one of position, acceleration"));
}
