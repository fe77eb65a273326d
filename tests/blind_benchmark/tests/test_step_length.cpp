// Vibrations that long steps of the reference simulator damp.

#include "tests/blind_benchmark/synthetic_cases/detectability.h"
#include "tests/blind_benchmark/synthetic_cases/make_case.h"
#include "tests/reference_simulator/json_text.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <unistd.h>

using namespace supercircle::blind_benchmark;
namespace fs = std::filesystem;

TEST_CASE("no case is made in which short steps let a specimen stick and slip", "[blind_benchmark][slow]") {
    const CasePlan plan =
        casePlans("limit", 2047).at(1); // the first draw has friction that falls by a tenth with speed
    REQUIRE(plan.families == std::vector<std::string>{"stribeck"});
    const SyntheticCase made = makeCase(plan);
    REQUIRE(made.failure.empty());
    CHECK(supercircle::reference_simulator::parseJson(made.answer).at("own_error").get<double>() <= kMaxOwnError);

    const fs::path file = fs::temp_directory_path() / ("blind_benchmark_steps_" + std::to_string(::getpid()) + ".json");
    writeAtomically(file, made.files.front().second);
    Description d = readDescription(file.string());
    fs::remove(file);
    d.runs = {d.runs.at(1)}; // the fast one
    const auto readings = [&](double strength, double factor) {
        Effects effects;
        apply(effects, {"rate_dependent_friction", {{"law", 0.0}, {"speed_m_s", 0.0018}, {"strength", strength}}});
        Resolution r;
        r.travel /= factor;
        r.longest /= factor;
        const CleanReadings clean = simulate(d, trueSetup(d, {}, effects), r);
        REQUIRE(clean.failure.empty());
        return clean.force.front();
    };
    const auto rmsDifference = [&](double strength, double factor) { // rms, in noise standard deviations
        const std::vector<double> usual = readings(strength, 1.0), other = readings(strength, factor);
        REQUIRE(usual.size() == other.size());
        double sum = 0.0;
        for (std::size_t k = 0; k < usual.size(); ++k)
            sum += std::pow((usual[k] - other[k]) / d.noise, 2);
        return std::sqrt(sum / static_cast<double>(usual.size()));
    };
    CHECK(rmsDifference(-0.1, 0.5) < kMaxOwnError); // damped with both
    CHECK(rmsDifference(-0.1, 16.0) > 0.5);         // 5 mN at 95 Hz
    CHECK(rmsDifference(0.1, 16.0) < kMaxOwnError);
}
