// Normal and log-normal priors of stated numbers: what two numbers that the runs cannot tell apart share.

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/replay/simulate.h"

#include "tests/plugin/identification/diagnosis/belt.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;
using namespace supercircle::diagnosis;
using Catch::Contains;

namespace {

constexpr const char* kSteady = R"("drive_time_s": [0, 4], "drive_displacement_mm": [0, 4])";

experiment::Experiment rubbing(const std::string& mu, const std::string& normal) {
    return belt("\"mu\": " + mu + ", \"normal_force\": " + normal, kSteady);
}

/// Baseline fit to a recorded force of 4.4 N, a tenth more than stated: coefficient and normal force.
std::pair<double, double> fitted(experiment::Experiment e) {
    replay::Parameters truth = replay::nominal(e);
    REQUIRE(replay::set(truth, e, "mu", 0.44).empty());
    e.runs.front().readings = replay::simulate(e, 0, truth, replay::Resolution::fine()).readings;
    std::uint64_t seed = 11;
    for (double& f : e.runs.front().readings.force) { // even noise of 3 mN
        seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
        f += 0.003 * std::sqrt(12.0) * (static_cast<double>(seed >> 11) / 9007199254740992.0 - 0.5);
    }
    ReplayModel model(e, catalogueWithout({}));
    const Diagnosis d = shortDiagnosis(model, e);
    INFO(d.statement);
    REQUIRE(d.failure.empty());
    REQUIRE(d.nominal.size() >= 2);
    std::pair<double, double> out;
    for (const NominalResult& n : d.nominal) {
        if (n.name == "mu")
            out.first = n.fitted;
        if (n.name == "normal_force")
            out.second = n.fitted;
    }
    return out;
}

} // namespace

TEST_CASE("numbers that only their product is known of share a deviation as their priors say", "[diagnosis][priors]") {
    // Of ln 1.1 each takes the share of its variance: 4 to 36. The readings add 1e-3 of noise.
    const auto [mu, normal] =
        fitted(rubbing(R"({"value": 0.4, "std_log": 0.02})", R"({"value": 10, "std_log": 0.06})"));
    CHECK(mu * normal == Approx(4.4).epsilon(1e-3));
    CHECK(mu == Approx(0.4 * std::pow(1.1, 0.1)).epsilon(2e-3));
    CHECK(normal == Approx(10.0 * std::pow(1.1, 0.9)).epsilon(2e-3));
    // Normal: the least of a^2 + b^2 with (1 + 0.05 a) (1 + 0.05 b) = 1.1 is a = b.
    const auto [same, force] = fitted(rubbing(R"({"value": 0.4, "std": 0.02})", R"({"value": 10, "std": 0.5})"));
    CHECK(same == Approx(0.4 * std::sqrt(1.1)).epsilon(2e-3));
    CHECK(force == Approx(10.0 * std::sqrt(1.1)).epsilon(2e-3));
}

TEST_CASE("a normal prior is read as three standard deviations, and only one thing is said", "[diagnosis][priors]") {
    const experiment::Experiment e = rubbing(R"({"value": 0.4, "std": 0.02})", R"({"value": 10, "std_log": 0.06})");
    const ReplayModel model(e);
    REQUIRE(model.nominal().size() == 2);
    const Scalar &mu = model.nominal()[0], &normal = model.nominal()[1];
    CHECK(mu.step == Approx(0.06));
    CHECK(mu.upper == Approx(0.48));
    CHECK(mu.precision == 9.0);
    CHECK(toPhysical(normal.scale, normal.value) == Approx(10.0));
    CHECK(toPhysical(normal.scale, normal.upper) == Approx(10.0 * std::exp(0.24)));
    const auto why = [](const std::string& entry) { return beltOf("\"mu\": " + entry, kSteady).error(); };
    CHECK_THAT(why(R"({"value": 0.4, "unc": 0.1, "std": 0.02})"), Contains("two things are said"));
    CHECK_THAT(why(R"({"value": -1, "std_log": 0.02})"), Contains("logarithm"));
}
