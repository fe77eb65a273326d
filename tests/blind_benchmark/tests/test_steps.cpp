// What the second simulator's long steps damp.

#include "tests/blind_benchmark/conceal/record.h"
#include "tests/blind_benchmark/conceal/truth.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <unistd.h>

using namespace supercircle::oracle;
namespace fs = std::filesystem;

TEST_CASE("no case is recorded in which short steps let a specimen stick and slip", "[oracle][slow]") {
    const Plan plan = plans("limit", 2047).at(1); // it was, with a friction that falls by a tenth
    REQUIRE(plan.families == std::vector<std::string>{"stribeck"});
    const Concealed made = conceal(plan);
    REQUIRE(made.failure.empty());
    CHECK(nlohmann::json::parse(made.answer).at("own_error").get<double>() <= kSureOfItself);

    const fs::path file = fs::temp_directory_path() / ("oracle_steps_" + std::to_string(::getpid()) + ".json");
    writeWhole(file, made.files.front().second);
    Description d = readDescription(file.string());
    fs::remove(file);
    d.runs = {d.runs.at(1)}; // the quick one
    const auto readings = [&](double strength, double shorter) {
        Effects effects;
        apply(effects, {"rate_dependent_friction", {{"law", 0.0}, {"speed_m_s", 0.0018}, {"strength", strength}}});
        Resolution r;
        r.travel /= shorter;
        r.longest /= shorter;
        const Clean clean = simulate(d, trueSetup(d, {}, effects), r);
        REQUIRE(clean.failure.empty());
        return clean.force.front();
    };
    const auto apart = [&](double strength, double shorter) { // noise units, rms
        const std::vector<double> usual = readings(strength, 1.0), other = readings(strength, shorter);
        REQUIRE(usual.size() == other.size());
        double squares = 0.0;
        for (std::size_t k = 0; k < usual.size(); ++k)
            squares += std::pow((usual[k] - other[k]) / d.noise, 2);
        return std::sqrt(squares / static_cast<double>(usual.size()));
    };
    CHECK(apart(-0.1, 0.5) < kSureOfItself); // damped either way
    CHECK(apart(-0.1, 16.0) > 0.5);          // 5 mN at 95 Hz
    CHECK(apart(0.1, 16.0) < kSureOfItself);
}
