// Shipped scenes with shells against closed forms, playedRods as experiments describe them.

#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"
#include "supercircle/effects/effect.h"

#include "tests/support/folder.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;

namespace {

/// An experiment with a shipped scene and one run. `rows` are its file, `drive` is the key or the entry of the run that
/// says what is driven.
struct Described {
    std::string scene, observe, column, parameters, rows, drive, run;

    [[nodiscard]] experiment::Experiment loaded() const {
        const test::Folder folder;
        folder.write("run.csv", rows);
        const std::string file =
            folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene", "scene": ")" +
                                                scene + R"(", "scene_parameters": {)" + parameters + "}, " + drive +
                                                R"("channels": [{"observe": ")" + observe + R"(", "column": ")" +
                                                column + R"("}], "runs": [{"file": "run.csv")" + run + "}]}");
        auto out = experiment::load(file);
        INFO(out.error());
        REQUIRE(out);
        return *out;
    }
};

replay::Simulated playedRods(const experiment::Experiment& e) {
    auto out = replay::simulate(e, 0, replay::nominal(e), replay::Resolution::fine());
    REQUIRE(out.failure == "");
    return out;
}

/// The force at the end of a press by `travel` mm.
double forceAfter(const std::string& scene, const std::string& parameters, double travel,
                  const std::string& more = {}) {
    const std::string mm = std::to_string(travel);
    const Described d{scene,
                      "force",
                      "force_N",
                      parameters,
                      "time_s,force_N\n0,0\n5,1\n9.9,2\n10,3\n",
                      more,
                      R"(, "drive_time_s": [0, 10], "drive_displacement_mm": [0, )" + mm + "]"};
    return playedRods(d.loaded()).readings.force.back();
}

double modulus(double young, double width, double thickness) {
    return young * width * thickness * thickness * thickness / 12.0;
}

/// Complete elliptic integrals K(k) and E(k) by the arithmetic-geometric mean.
std::pair<double, double> elliptic(double k) {
    double a = 1.0, b = std::sqrt(1.0 - k * k), c = k, sum = 0.5 * k * k, power = 0.5;
    while (std::abs(c) > 1e-16) {
        const double next = 0.5 * (a + b);
        c = 0.5 * (a - b);
        b = std::sqrt(a * b);
        a = next;
        power *= 2.0;
        sum += power * c * c;
    }
    const double K = 0.5 * M_PI / a;
    return {K, K * (1.0 - sum)};
}

} // namespace

TEST_CASE("strips on rollers are as stiff as beams", "[replay][rods]") {
    // Thin rollers: where they touch moves by 3e-4 of the span, which counts three times. The strip bends by a 400th of
    // the span; second-order terms are 1e-4. Its weight, a hundredth of the usual one, lets it sag by 2e-3 of that.
    const std::string thin = R"("roller_radius": 1e-4, "nose_radius": 1e-4, "thickness": 5e-4, "nose_gap": 1e-8,
        "mu": 0.01)",
                      light = R"("gravity_m_s2": [0, -0.1], )";
    const double b = modulus(2.1e9, 0.012, 5e-4);
    const double span = 0.04, d = 1e-4;
    CHECK(forceAfter("three_point_bending", thin, 0.1, light) ==
          Approx(48.0 * b * d / std::pow(span, 3)).epsilon(2e-3));
    const double wide = 0.06, a = 0.02;
    CHECK(forceAfter("four_point_bending", thin, 0.1, light) ==
          Approx(12.0 * b * d / (a * a * (3.0 * wide - 4.0 * a))).epsilon(3e-3));
}

TEST_CASE("a ring between plates is as stiff as the closed form", "[replay][rods]") {
    // A two-hundredth of the radius; the stiffness changes by about that share, and 64 arcs bend 0.1 % too easily.
    const double b = modulus(2e9, 0.01, 5e-4), r = 0.02, d = 1e-4;
    CHECK(forceAfter("ring_between_plates", R"("plate_gap": 1e-8)", 0.1) ==
          Approx(b / (r * r * r) * d / r / 0.1488 * r).epsilon(8e-3));
}

TEST_CASE("a strut follows the elastica after buckling", "[replay][rods]") {
    // Pinned at both ends: P / Pe = (2 K / pi)^2, shortening / L = 2 - 2 E / K. The bow of 2 mrad counts 1e-3 there.
    const double b = modulus(2e11, 0.02, 5e-4), length = 0.2, euler = M_PI * M_PI * b / (length * length);
    const auto [K, E] = elliptic(std::sin(0.5 * 0.9)); // ends turned by 0.9 rad
    const double shortening = length * (2.0 - 2.0 * E / K);
    CHECK(forceAfter("euler_strut", R"("bow": 0.002)", 1e3 * shortening) ==
          Approx(euler * std::pow(2.0 * K / M_PI, 2)).epsilon(3e-3));
}

TEST_CASE("weights at the end of a cantilever bend it as the elastica", "[replay][rods]") {
    // Deflections of P L^2 / B = 1, 2, 5, 10 (Bisshopp and Drucker, Q. Appl. Math. 3, 272, 1945); 48 arcs err by 2e-4.
    const double b = modulus(2e11, 0.02, 1e-3), length = 0.3;
    std::string rows = "time_s,weight_g,tip_mm\n";
    const std::vector<std::pair<double, double>> table = {
        {0.0, 0.0}, {1.0, 0.30172}, {2.0, 0.49346}, {5.0, 0.71379}, {10.0, 0.81061}, {2.0, 0.49346}, {0.0, 0.0}};
    for (std::size_t i = 0; i < table.size(); ++i)
        rows += std::to_string(10 * i) + "," + std::to_string(1e3 * table[i].first * b / (length * length) / 9.81) +
                "," + std::to_string(1e3 * table[i].second * length) + "\n";
    const Described d{"cantilever_weights",
                      "tip_y",
                      "tip_mm",
                      R"("gravity": 0)",
                      rows,
                      R"("drive": {"parameter": "weight", "column": "weight_g", "scale": 9.81e-3}, )",
                      ""};
    const auto e = d.loaded();
    const auto out = playedRods(e);
    REQUIRE(out.readings.force.size() == table.size());
    for (std::size_t i = 0; i < table.size(); ++i)
        CHECK(-out.readings.force[i] / length == Approx(table[i].second).epsilon(3e-4).margin(1e-4));
}

TEST_CASE("a cantilever with a natural curvature is clamped level", "[replay][rods]") {
    const double curvature = 0.5, length = 0.3;
    const Described d{"cantilever_weights",
                      "tip_y",
                      "tip_mm",
                      R"("gravity": 0, "natural_curvature": 0.5)",
                      "time_s,weight_g,tip_mm\n0,0,0\n5,0,1\n9,0,2\n10,1,3\n",
                      R"("drive": {"parameter": "weight", "column": "weight_g", "scale": 9.81e-3}, )",
                      ""};
    // Without a load it is an arc that leaves the clamp along x. It settles to 1e-6 of its length.
    CHECK(playedRods(d.loaded()).readings.force[1] ==
          Approx((1.0 - std::cos(curvature * length)) / curvature).margin(1e-6 * length));
}

TEST_CASE("a table needs no clock: the elastica at its weights, whatever time passes", "[replay][rods][tables]") {
    const double b = modulus(2e11, 0.02, 1e-3), length = 0.3;
    std::string rows = "weight_g,tip_mm\n";
    const std::vector<std::pair<double, double>> table = {
        {0.0, 0.0}, {1.0, 0.30172}, {2.0, 0.49346}, {5.0, 0.71379}, {10.0, 0.81061}, {2.0, 0.49346}, {0.0, 0.0}};
    for (const auto& [load, tip] : table)
        rows +=
            std::to_string(1e3 * load * b / (length * length) / 9.81) + "," + std::to_string(1e3 * tip * length) + "\n";
    auto e = Described{"cantilever_weights",
                       "tip_y",
                       "tip_mm",
                       R"("gravity": 0)",
                       rows,
                       R"("drive": {"parameter": "weight", "column": "weight_g", "scale": 9.81e-3}, )",
                       ""}
                 .loaded();
    const auto out = playedRods(e);
    REQUIRE(out.readings.force.size() == table.size());
    for (std::size_t i = 0; i < table.size(); ++i) // as with times
        CHECK(-out.readings.force[i] / length == Approx(table[i].second).epsilon(3e-4).margin(1e-4));
    for (const double factor : {0.5, 2.0}) {
        auto other = e;
        experiment::Run& run = other.runs.front();
        for (std::vector<double>* times : {&run.driveTime, &run.readings.time})
            for (double& t : *times)
                t *= factor;
        const auto again = playedRods(other);
        for (std::size_t i = 0; i < table.size(); ++i) // rest is rest: what is left of vibration
            CHECK(again.readings.force[i] == Approx(out.readings.force[i]).margin(1e-5 * length));
    }
}

TEST_CASE("a strip that yields remembers its weights, not how it swung between them", "[replay][rods][tables]") {
    const double length = 0.3;
    auto e = Described{"cantilever_weights",
                       "tip_y",
                       "tip_mm",
                       R"("gravity": 0)",
                       "weight_g,tip_mm\n0,0\n1000,90\n1900,150\n3800,210\n1900,160\n0,30\n",
                       R"("drive": {"parameter": "weight", "column": "weight_g", "scale": 9.81e-3}, )",
                       ""}
                 .loaded();
    replay::Parameters p = replay::nominal(e);
    REQUIRE(effects::add(p.effects, "plasticity:My_over_B_1_m=5").empty());
    const auto out = replay::simulate(e, 0, p, replay::Resolution::fine());
    REQUIRE(out.failure == "");
    CHECK(std::abs(out.readings.force.back()) > 0.05 * length); // a permanent set
    auto slowly = e;
    for (std::vector<double>* times : {&slowly.runs.front().driveTime, &slowly.runs.front().readings.time})
        for (double& t : *times)
            t *= 64.0; // nothing swings any more
    const auto rested = replay::simulate(slowly, 0, p, replay::Resolution::fine());
    REQUIRE(rested.failure == "");
    // What a swing beyond rest yields: 1.3e-4 of the length on the way up where swings are followed to the last.
    for (std::size_t i = 0; i < out.readings.force.size(); ++i)
        CHECK(std::abs(out.readings.force[i] - rested.readings.force[i]) < 1e-4 * length);
}

TEST_CASE("effects that need a clock are refused for tables", "[replay][tables]") {
    const auto e = Described{"cantilever_weights",
                             "tip_y",
                             "tip_mm",
                             "",
                             "weight_g,tip_mm\n0,0\n50,3\n100,6\n150,9\n200,12\n250,15\n",
                             R"("drive": {"parameter": "weight", "column": "weight_g", "scale": 9.81e-3}, )",
                             ""}
                       .loaded();
    const auto why = [&](const std::string& text) {
        replay::Parameters p = replay::nominal(e);
        REQUIRE(effects::add(p.effects, text).empty());
        return replay::checkEffects(p, e);
    };
    CHECK_THAT(why("viscoelastic_bending:eta_over_B_s=0.1"), Catch::Matchers::Contains("needs the times of the rows"));
    CHECK_THAT(why("sensor_delay:delay_s=0.1"), Catch::Matchers::Contains("needs the times of the rows"));
    CHECK_THAT(why("air_drag:linear_N_s_m2=1"), Catch::Matchers::Contains("move freely")); // these rest
    CHECK(why("nonlinear_elasticity:uc_1_m=10").empty());
    CHECK(why("sensor_gain:error=0.1").empty());
}

TEST_CASE("a released cantilever vibrates with its own frequency and damping", "[replay][rods]") {
    const double b = modulus(2e11, 0.02, 1e-3), line = 7800.0 * 0.02 * 1e-3, length = 0.3;
    const double w = std::pow(1.8751040687 / length, 2) * std::sqrt(b / line);
    const auto tops = [&](const std::string& parameters, double duration) {
        const Described d{"cantilever_vibration",
                          "tip_y",
                          "tip_mm",
                          parameters,
                          "time_s,tip_mm\n0,0\n0.001,1\n",
                          "",
                          R"(, "duration_s": )" + std::to_string(duration)};
        auto e = d.loaded();
        e.runs.front().readings = {};
        e.runs.front().samplingRate = 4000.0;
        const experiment::Readings r = playedRods(e).readings;
        std::vector<std::pair<double, double>> out; // of upward zero crossings: time, largest elongation since
        for (std::size_t i = 1; i < r.time.size(); ++i) {
            if (r.force[i - 1] < 0.0 && r.force[i] >= 0.0)
                out.emplace_back(
                    r.time[i - 1] - r.force[i - 1] * (r.time[i] - r.time[i - 1]) / (r.force[i] - r.force[i - 1]), 0.0);
            if (!out.empty())
                out.back().second = std::max(out.back().second, r.force[i]);
        }
        return out;
    };
    // 97 % of the deflection is in the first mode, the rest shifts single crossings by less than 1e-3 of eight periods;
    // 12 arcs change the frequency by 1e-4. The second mode adds or takes 2.5 %.
    const auto free = tops(R"("pull": 0.005)", 1.0);
    REQUIRE(free.size() > 8);
    const double period = (free[8].first - free[0].first) / 8.0;
    CHECK(2.0 * M_PI / period == Approx(w).epsilon(1e-3));
    CHECK(free[7].second == Approx(0.9707 * 0.005 * std::pow(length, 3) / (3.0 * b)).epsilon(0.03));
    // A body as heavy as the strip at its end: the root of the characteristic equation falls to 1.24792.
    const auto heavy = tops(R"("pull": 0.005, "tip_mass": 0.0468)", 1.6);
    REQUIRE(heavy.size() > 4);
    CHECK(2.0 * M_PI * 4.0 / (heavy[4].first - heavy[0].first) ==
          Approx(std::pow(1.24792 / length, 2) * std::sqrt(b / line)).epsilon(1e-3));
    const double ratio = 0.05;
    const auto damped = tops(R"("pull": 0.005, "damping_ratio": 0.05)", 0.6);
    REQUIRE(damped.size() > 4);
    CHECK(std::log(damped[1].second / damped[4].second) / 3.0 ==
          Approx(2.0 * M_PI * ratio / std::sqrt(1.0 - ratio * ratio)).epsilon(0.02));
}

TEST_CASE("air round a released cantilever takes what the closed form says", "[replay][rods]") {
    const double line = 7800.0 * 0.02 * 1e-3, length = 0.3;
    const double w = std::pow(1.8751040687 / length, 2) * std::sqrt(modulus(2e11, 0.02, 1e-3) / line);
    auto e =
        Described{"cantilever_vibration",  "tip_y", "tip_mm", R"("pull": 0.005)", "time_s,tip_mm\n0,0\n0.001,1\n", "",
                  R"(, "duration_s": 1.3)"}
            .loaded();
    e.runs.front().readings = {};
    e.runs.front().samplingRate = 4000.0;
    const double ratio = 0.03;
    replay::Parameters p = replay::nominal(e);
    REQUIRE(effects::add(p.effects, "air_drag:linear_N_s_m2=" + std::to_string(2.0 * ratio * w * line)).empty());
    REQUIRE(replay::checkEffects(p, e).empty());
    const auto played = replay::simulate(e, 0, p, replay::Resolution::fine());
    REQUIRE(played.failure == "");
    const auto mostIn = [&](double from, double to) {
        double most = 0.0;
        for (std::size_t i = 0; i < played.readings.time.size(); ++i)
            if (played.readings.time[i] >= from && played.readings.time[i] < to)
                most = std::max(most, played.readings.force[i]);
        return most;
    };
    const double period = 2.0 * M_PI / w;
    // Ten periods; the second mode, 3 % of the deflection, loses at the same rate and shifts both peaks.
    CHECK(std::log(mostIn(0.0, period) / mostIn(10.0 * period, 11.0 * period)) ==
          Approx(10.0 * 2.0 * M_PI * ratio).epsilon(0.03));
}

TEST_CASE("a load acts on a scene in motion that starts as it is placed", "[replay][rods]") {
    // Free fall in reverse: a strip without gravity, pushed at its middle by F, moves by F t^2 / (2 m) as a whole.
    const test::Folder folder;
    folder.write("run.csv", "time_s,y_mm\n0,0\n0.2,1\n");
    folder.write("scene.json", R"({"schema": "supercircle-scene/1", "duration": 1, "gravity": 0,
        "shell": [{"name": "s", "radius": "infinite", "length": 0.1, "thickness": 0.002, "elements": 8}],
        "load": [{"shell": "s", "force_N": {"x": 1e-4, "y": 0}}],
        "observe": [{"name": "x", "of": "shell", "shell": "s", "arc_fraction": 0.5, "quantity": "x"}]})");
    const std::string file = folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene",
        "scene": "scene.json", "channels": [{"observe": "x", "column": "y_mm"}], "runs": [{"file": "run.csv"}]})");
    const auto e = experiment::load(file);
    INFO(e.error());
    REQUIRE(e);
    const double mass = 1270.0 * 0.01 * 0.002 * 0.1;
    CHECK(playedRods(*e).readings.force.back() ==
          Approx(0.5 * 1e-4 / mass * 0.04).epsilon(1e-6)); // along the strip: rigid
}

TEST_CASE("scenes with shells that experiments cannot simulate are refused with the reason", "[replay][rods]") {
    const test::Folder folder;
    folder.write("run.csv", "time_s,y_mm\n0,0\n1,1\n");
    const auto refused = [&](const std::string& scene) {
        folder.write("scene.json", R"({"schema": "supercircle-scene/1", "duration": 1, "observe": [{"name": "y",
            "of": "shell", "shell": "s", "quantity": "y"}], )" +
                                       scene + "}");
        const std::string file = folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene",
            "scene": "scene.json", "channels": [{"observe": "y", "column": "y_mm"}], "runs": [{"file": "run.csv"}]})");
        return experiment::load(file).error();
    };
    using Catch::Matchers::Contains;
    CHECK_THAT(refused(R"("shell": [{"name": "s"}], "body": [{"name": "crate", "type": 2}])"),
               Contains("the body \"crate\" can be pushed") && Contains("bodies at rest or moved by the machine"));
    CHECK_THAT(refused(R"("shell": [{"name": "s"}], "body": [{"name": "belt", "type": 1}])"),
               Contains("the body \"belt\" moves, but not with the machine"));
    CHECK_THAT(refused(R"("shell": [{"name": "s"}, {}])"), Contains("a shell has no name"));
    CHECK_THAT(refused(R"("shell": [{"name": "s"}], "effects": [{"key": "machine_compliance", "k_N_m": 500}])"),
               Contains("the effect \"machine_compliance\" of the scene does not act in an experiment") &&
                   Contains("--effect machine_compliance"));
}

TEST_CASE("what would change nothing in an experiment is refused", "[replay][rods]") {
    using Catch::Matchers::Contains;
    const test::Folder folder;
    const auto load = [&](const std::string& scene, const std::string& observe, const std::string& more = "") {
        folder.write("run.csv", "time_s,y_mm,load\n0,0,0\n1,1,1\n");
        folder.write("scene.json", R"({"schema": "supercircle-scene/1", "duration": 1, "parameters": {"p": {"value": 0,
            "unit": "N"}}, "observe": [{"name": "y", )" +
                                       observe + "}], " + scene + "}");
        return experiment::load(folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene",
            "scene": "scene.json", "channels": [{"observe": "y", "column": "y_mm"}], )" +
                                                                    more + R"("runs": [{"file": "run.csv"}]})"));
    };
    const std::string strip = R"("shell": [{"name": "s", "radius": "infinite", "length": 0.1, "elements": 8}])";
    const std::string ofStrip = R"("of": "shell", "shell": "s", "quantity": )";
    CHECK_THAT(load(strip, ofStrip + "\"ay\"").error(),
               Contains("only its place and direction are observed") && Contains("\"angle\""));

    const std::string ball = R"("body": [{"name": "floor", "fixture": [{"circle": {"radius": 0.1}}]},
        {"name": "ball", "type": 2, "fixture": [{"density": 1, "circle": {"radius": 0.1}}]}])";
    CHECK_THAT(load(ball, R"("of": "body", "body": "ball", "quantity": "y")").error(),
               Contains("the body \"ball\" hangs on no joint") && Contains("prismatic"));

    const std::string drive = R"("drive": {"parameter": "p", "column": "load"}, )";
    const std::string pull = R"(, "load": [{"shell": "s", "force_N": {"x": {"param": "p"}, "y": 0}}])";
    const auto thick = load(R"("shell": [{"name": "s", "radius": "infinite", "length": 0.1, "elements": 8,
        "density": {"expr": "1000+p"}}])" +
                                pull,
                            ofStrip + "\"y\"", drive);
    INFO(thick.error());
    REQUIRE(thick);
    CHECK_THAT(replay::simulate(*thick, 0, replay::nominal(*thick), replay::Resolution::coarse()).failure,
               Contains("changes the section, material or masses of the shell \"s\""));
}
