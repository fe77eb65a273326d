// Creep of a cantilever that nothing drives, against the closed form of the standard linear solid.

#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"
#include "supercircle/effects/effect.h"

#include "tests/support/folder.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;

namespace {

constexpr double kStripLength = 0.1, kStripGravity = 1.0, kStripLine = 1270.0 * 0.01 * 5e-4; // m, m/s^2, kg/m
constexpr double kStripModulus = 2e9 * 0.01 * 5e-4 * 5e-4 * 5e-4 / 12.0;                     // N m^2
constexpr double kPull = 5e-4;                                                               // N

/// A strip clamped level that bends by less than a 250th of its length, read for five seconds.
struct Cantilever {
    std::string start = "as_placed", load, numerics = R"("quasi_static": true)";
    double gravity = kStripGravity;

    /// Deflections of the tip at 0, 0.1, ... s, downwards, m.
    [[nodiscard]] std::vector<double> played(const std::vector<std::string>& effect) const {
        const test::Folder folder;
        folder.write("strip.json", R"({"schema": "supercircle-scene/1", "lengthScale": 10, "gravity": {"x": 0, "y": )" +
                                       std::to_string(-gravity) + R"(},
            "shell": [{"name": "strip", "position": {"x": 0.05, "y": 0}, "radius": "infinite", "length": 0.1,
                       "thickness": 5e-4, "width": 0.01, "young_modulus": 2e9, "density": 1270, "elements": 24}],
            "hold": [{"shell": "strip", "arc_fraction": 0, "kind": "clamp"}], "start": ")" +
                                       start + R"(", "load": [)" + load + R"(], "numerics": {)" + numerics + R"(},
            "observe": [{"name": "tip", "of": "shell", "shell": "strip", "arc_fraction": 1, "quantity": "y"}]})");
        std::string rows = "time_s,tip_mm\n";
        for (int i = 0; i <= 50; ++i)
            rows += std::to_string(0.1 * i) + "," + std::to_string(-0.3 - 1e-3 * i) + "\n";
        folder.write("run.csv", rows);
        const auto e = experiment::load(folder.write("experiment.json", R"({"schema": "rod-recordings/1",
            "protocol": "scene", "scene": "strip.json", "channels": [{"observe": "tip", "column": "tip_mm", "sign": -1}],
            "runs": [{"file": "run.csv"}]})"));
        INFO(e.error());
        REQUIRE(e);
        replay::Parameters p = replay::nominal(*e);
        for (const std::string& word : effect)
            REQUIRE(effects::add(p.effects, "viscoelastic_bending:" + word).empty());
        const auto out = replay::simulate(*e, 0, p, replay::Resolution::fine());
        REQUIRE(out.failure == "");
        REQUIRE(out.readings.force.size() == 51);
        std::vector<double> down;
        for (const double y : out.readings.force)
            down.push_back(-y);
        return down;
    }
};

const double kOfWeight = kStripLine * kStripGravity * std::pow(kStripLength, 4) / (8.0 * kStripModulus); // m
const double kOfPull = kPull * std::pow(kStripLength, 3) / (3.0 * kStripModulus);
const std::string kPulled = R"({"shell": "strip", "arc_fraction": 1, "force_N": {"x": 0, "y": -5e-4}})";
constexpr double kBranch = 0.6, kTau = 0.5; // of a branch beside the spring; it creeps with kTau (1 + kBranch)
const std::vector<std::string> kElastic, kSolid = {"law=standard_linear_solid", "branch_over_B=0.6", "tau_s=0.5"};

double notYet(double t) {
    return std::exp(-t / (kTau * (1.0 + kBranch)));
}

} // namespace

TEST_CASE("the weight of a strip as placed acts from time 0: it creeps from the elastic deflection",
          "[replay][rods][creep]") {
    const double elastic = Cantilever{}.played(kElastic).front();
    CHECK(elastic == Approx(kOfWeight).epsilon(2e-3));
    const auto down = Cantilever{}.played(kSolid);
    for (std::size_t i = 0; i < down.size(); ++i) {
        const double t = 0.1 * static_cast<double>(i);
        INFO(t);
        CHECK(down[i] / elastic == Approx(1.0 - kBranch / (1.0 + kBranch) * notYet(t)).margin(2e-3));
    }
    // A dashpot beside the spring lets nothing happen at once. Backward Euler errs by half a step, of some 20 ms.
    const auto slowly = Cantilever{}.played({"eta_over_B_s=0.7"});
    for (std::size_t i = 0; i < slowly.size(); ++i)
        CHECK(slowly[i] / elastic == Approx(1.0 - std::exp(-0.1 * static_cast<double>(i) / 0.7)).margin(0.01));
}

TEST_CASE("a constant load creeps as the weight does", "[replay][rods][creep]") {
    Cantilever c;
    c.gravity = 0.0;
    c.load = kPulled;
    const double elastic = c.played(kElastic).front();
    CHECK(elastic == Approx(kOfPull).epsilon(2e-3));
    const auto down = c.played(kSolid);
    for (std::size_t i = 0; i < down.size(); i += 5)
        CHECK(down[i] / elastic ==
              Approx(1.0 - kBranch / (1.0 + kBranch) * notYet(0.1 * static_cast<double>(i))).margin(2e-3));
}

TEST_CASE("a strip at rest has crept before time 0", "[replay][rods][creep]") {
    for (const std::string numerics : {R"("quasi_static": true)", R"("quasi_static": false)"}) {
        Cantilever c;
        c.start = "at_rest";
        c.numerics = numerics;
        for (const double y : c.played(kSolid)) // and it does not swing either
            CHECK(y == Approx(kOfWeight).epsilon(3e-3));
    }
}

TEST_CASE("a strip whose load is released springs back at once, and creeps back the rest", "[replay][rods][creep]") {
    Cantilever c;
    c.gravity = 0.0;
    c.start = "at_rest";
    c.load = kPulled.substr(0, kPulled.size() - 1) + R"(, "released": true})";
    const auto elastic = c.played(kElastic);
    CHECK(elastic.front() == Approx(0.0).margin(2e-3 * kOfPull));
    const auto down = c.played(kSolid);
    for (std::size_t i = 0; i < down.size(); ++i)
        CHECK(down[i] / kOfPull ==
              Approx(kBranch / (1.0 + kBranch) * notYet(0.1 * static_cast<double>(i))).margin(3e-3));
}
