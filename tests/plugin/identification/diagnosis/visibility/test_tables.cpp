// Tables of states of rest in the diagnosis.

#include "plugin/identification/diagnosis/likelihood.h"
#include "plugin/identification/diagnosis/next_experiment/candidate_runs.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/recording/experiment/load.h"
#include "tests/support/folder.h"

#include <catch2/catch.hpp>
#include <set>

using namespace supercircle;
using namespace supercircle::diagnosis;

namespace {

experiment::Experiment table(const std::string& noise = R"(, "noise_std": 0.2)", int rows = 12) {
    const test::Folder folder;
    std::string text = "weight_g,tip_mm\n";
    for (int k = 0; k < rows; ++k)
        text += std::to_string(20 * k) + "," + std::to_string(2.6 * k + 0.1 * (k % 3)) + "\n";
    folder.write("table.csv", text);
    auto out = experiment::load(folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene",
        "scene": "cantilever_weights", "scene_parameters": {"young_modulus": {"value": 2e11, "unc": 1e10},
        "length": {"value": 0.3, "unc": 0.001}},
        "drive": {"parameter": "weight", "column": "weight_g", "scale": 9.81e-3},
        "channels": [{"observe": "tip_y", "column": "tip_mm", "sign": -1)" +
                                                                    noise +
                                                                    R"(, "zero": {"value": 0, "unc": 0.5}}],
        "runs": [{"file": "table.csv"}]})"));
    INFO(out.error());
    REQUIRE(out);
    return *out;
}

} // namespace

TEST_CASE("a table needs five rows more than free numbers", "[diagnosis][tables]") {
    using Catch::Matchers::Contains;
    CHECK(tooFewReadings(table()).empty());
    CHECK(tooFewReadings(table(R"(, "noise_std": 0.2)", 8)).empty());
    CHECK_THAT(tooFewReadings(table(R"(, "noise_std": 0.2)", 7)),
               Contains("7 rows of tables are too few for 3 numbers") && Contains("a diagnosis needs 8"));
    CHECK_THAT(tooFewReadings(table("")), Contains("a table does not show its noise"));
}

TEST_CASE("rows of a table are read at rest, with the stated noise", "[diagnosis][tables]") {
    const experiment::Experiment e = table();
    const RecordedData data = recordedDataOf(e);
    REQUIRE(data.table);
    const Noise noise = estimateNoise(data);
    CHECK(noise.total() == 0.2); // mm
    CHECK(noise.correlated == 0.0);
    const ReplayModel model(e);
    ParameterPoint stated;
    for (const Scalar& s : model.nominal())
        stated.nominal.push_back(s.value);
    const std::vector<Response> there = {model.simulate(0, stated, Fidelity::Coarse, nullptr)};
    REQUIRE(there.front().failure == "");
    const Likelihood likelihood(data, noise, there, there);
    CHECK(likelihood.countedRows() == 12); // none is excluded
    CHECK(likelihood.jumps(0).empty());
}

TEST_CASE("nothing that needs a clock is tried on a table", "[diagnosis][tables]") {
    const experiment::Experiment e = table();
    std::set<std::string> labels;
    for (const CandidateEffect& c : candidateEffectsFor(e).candidates)
        labels.insert(c.label);
    for (const char* label : {"viscoelastic_bending", "softening_over_time", "static_friction_excess",
                              "rate_dependent_friction", "sensor_drift", "sensor_delay", "learned_drift"})
        CHECK(labels.count(label) == 0);
    for (const char* label : {"nonlinear_elasticity", "plasticity", "sensor_gain", "gravity", "learned_moment"})
        CHECK(labels.count(label) == 1);
    const std::vector<CandidateRun> runs = candidateRunsFor(e);
    REQUIRE(runs.size() == 3); // none was unloaded
    for (const CandidateRun& run : runs) {
        CHECK(run.table);
        CHECK(run.drivesLoad);
        CHECK(run.displacement.back() == 0.0);
        CHECK(run.time[1] == Approx(1.0 / run.rate));
    }
    CHECK(runs[1].displacement[12] == Approx(1.5 * 0.22 * 9.81));
}

TEST_CASE("a short run with a clock is enough where its noise is stated", "[diagnosis][tables]") {
    using Catch::Matchers::Contains;
    const test::Folder folder;
    const auto pulled = [&](int rows, const std::string& noise) {
        std::string text = "time_s,displacement_mm,force_N\n";
        for (int k = 0; k < rows; ++k)
            text += std::to_string(0.1 * k) + "," + std::to_string(0.2 * k) + "," +
                    std::to_string(std::min(0.1 * k, 0.588)) + "\n";
        folder.write("pulled.csv", text);
        auto out =
            experiment::load(folder.write("pulled.json", R"({"schema": "rod-recordings/1", "protocol": "scene",
            "scene": "sled", "scene_parameters": {"mu": {"value": 0.3, "unc": 0.1}}, "drive": {"column": "displacement_mm"},
            "channels": [{"observe": "force", "column": "force_N")" +
                                                             noise + R"(}], "runs": [{"file": "pulled.csv"}]})"));
        INFO(out.error());
        REQUIRE(out);
        return tooFewReadings(*out);
    };
    CHECK(pulled(20, "").empty());
    CHECK(pulled(8, R"(, "noise_std": 0.005)").empty());
    CHECK_THAT(pulled(8, ""), Contains("at least 20 readings of each run, or the noise"));
    CHECK_THAT(pulled(5, R"(, "noise_std": 0.005)"), Contains("at least 6 readings"));
}
