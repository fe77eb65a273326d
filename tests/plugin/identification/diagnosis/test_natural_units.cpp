// The same recordings in other units have the same diagnosis: no constant is sized for one specimen.

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/model/random.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"
#include "supercircle/effects/effect.h"
#include "tests/plugin/identification/diagnosis/belt.h"
#include "tests/plugin/identification/replay/scaled.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;
using namespace supercircle::diagnosis;

namespace {

/// An arch that creeps while it is pressed, slowly and fast, with noise.
experiment::Experiment creepingArch() {
    auto loaded = experiment::load(std::string(SC_TEST_DATA) + "/recordings/baseline/case_106/experiment.json");
    REQUIRE(loaded);
    experiment::Experiment e = *loaded;
    e.specimens.front().bendingModulus.halfWidth = 0.05 * e.specimens.front().bendingModulus.value;
    e.friction.halfWidth = 0.05;
    e.initialGapHalfWidth = 3e-5;
    e.sensors.forceNoise = 2e-3;
    e.sensors.forceZeroWindow = 0.5;
    e.markers.clear();
    experiment::Run slow = e.runs.front();
    slow.readings = {};
    slow.markers = {};
    slow.markersFile.clear();
    slow.samplingRate = 20.0;
    experiment::Run fast = slow;
    fast.file = "fast.csv";
    for (double& t : fast.driveTime)
        t *= 0.3;
    fast.samplingRate = 60.0;
    e.runs = {slow, fast};
    replay::Parameters truth = replay::nominal(e);
    REQUIRE(effects::add(truth.effects, "viscoelastic_bending:eta_over_B_s=0.06").empty());
    truth.specimens.front().bendingModulus *= 1.02;
    Random random(7);
    for (std::size_t r = 0; r < e.runs.size(); ++r) {
        const replay::Simulated s = replay::simulate(e, r, truth, replay::Resolution::fine());
        REQUIRE(s.failure.empty());
        e.runs[r].readings = s.readings;
        double slowly = 0.0;
        const double keep = std::exp(-1.0 / e.runs[r].samplingRate / 0.25);
        for (double& force : e.runs[r].readings.force) {
            slowly = keep * slowly + std::sqrt(1.0 - keep * keep) * random.normal();
            force += 2e-3 * (0.87 * random.normal() + 0.48 * slowly);
        }
    }
    return e;
}

Diagnosis diagnosed(const experiment::Experiment& e, const std::vector<std::string>& only) {
    return shortDiagnosis(ReplayModel(e, only.empty() ? std::vector<std::string>{} : catalogueWithout(only)), e);
}

void check(const experiment::Experiment& e, const std::vector<std::string>& only,
           const std::vector<replaytest::Factors>& all) {
    const Diagnosis one = diagnosed(e, only);
    INFO(one.statement);
    REQUIRE(one.failure.empty());
    REQUIRE(!one.effects.empty());
    for (const replaytest::Factors& f : all) {
        const Diagnosis d = diagnosed(replaytest::scaled(e, f), only);
        INFO(replaytest::words(f) << ": " << d.verdict << ", " << one.verdict << " before; " << d.statement);
        CHECK(d.failure.empty());
        CHECK(d.verdict == one.verdict);
        REQUIRE(!d.effects.empty());
        CHECK(d.effects.front().label == one.effects.front().label);
        CHECK(d.effects.front().probability == Approx(one.effects.front().probability).margin(0.02));
        CHECK(d.baselineChiSquaredPerReading == Approx(one.baselineChiSquaredPerReading).epsilon(1e-3));
        CHECK(static_cast<double>(d.forwardRuns) <= 1.3 * static_cast<double>(one.forwardRuns));
    }
}

} // namespace

TEST_CASE("a small diagnosis in other units is the same", "[diagnosis][slow][units]") {
    check(creepingArch(), {"viscoelastic_bending", "machine_compliance"}, {{10.0, 0.01, 1000.0}});
}

TEST_CASE("a diagnosis with the whole catalogue in other units is the same", "[diagnosis][units][slow]") {
    check(creepingArch(), {}, {std::begin(replaytest::kFactors), std::end(replaytest::kFactors)});
}
