// Periodic disturbances with short dwell intervals: found in the residual of whole runs.

#include "toy.h"

#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/recorded/periodic_disturbance.h"

#include <catch2/catch.hpp>
#include <functional>

using namespace supercircle::diagnosis;

namespace {

constexpr double kTurn = 2.0 * M_PI;

/// N, of time and place.
using Hidden = std::function<double(double, double)>;

RecordedData with(std::uint64_t seed, const Hidden& masked) {
    RecordedData data = toy::recordings(seed);
    for (RecordedRun& run : data.runs)
        for (Eigen::Index k = 0; k < run.force.size(); ++k)
            run.force[k] += masked(run.time[k], run.displacement[k]);
    return data;
}

/// Residual of the true parameters.
PeriodicDisturbance swingIn(const RecordedData& data) {
    const toy::Spring spring(data);
    std::vector<Eigen::VectorXd> left;
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        left.push_back(data.runs[r].force - spring.simulate(r, {{103.0, 0.08}, {}}, Fidelity::Fine, nullptr).force);
    left.front().segment(40, 5).setConstant(std::numeric_limits<double>::quiet_NaN()); // rows that do not count
    return findDisturbanceInResidual(data, left);
}

} // namespace

TEST_CASE("a disturbance slower than the dwell intervals is found in whole runs", "[diagnosis]") {
    // Dwell intervals of 1, 2 and 1 s.
    constexpr double kPeriod = 2.9, kSize = 0.04; // s, N
    const RecordedData data = with(15, [](double t, double) { return kSize * std::sin(kTurn / kPeriod * t + 0.3); });
    REQUIRE(estimateNoise(data).disturbance == 0.0);
    const PeriodicDisturbance found = swingIn(data);
    // Least squares determine the frequency to sqrt(6) / (pi span) of noise over signal and root of the rows (Rife and
    // Boorstyn 1974), here 1e-3. The grid has a fourth of 1 / span: 1.5 %.
    CHECK(found.period == Approx(kPeriod).epsilon(0.02));
    CHECK(found.amplitude() == Approx(kSize).epsilon(0.1));
    const toy::Spring spring(data);
    SimulationCache cache;
    Evaluator evaluator(spring, data.runs.size(), {}, cache);
    const Diagnosis d = diagnose(data, evaluator, toy::exact());
    CHECK(d.verdict == "outside_catalogue");
    CHECK(d.outsideCatalogue > 0.9);
    CHECK(d.noise.total() == Approx(std::hypot(toy::kWhite, toy::kColoured)).epsilon(0.25));
    CHECK_THAT(d.statement,
               Catch::Contains("All runs contain a periodic disturbance") && Catch::Contains("a period of 2.9"));
}

TEST_CASE("missing physics is not taken for a periodic disturbance", "[diagnosis]") {
    const std::vector<std::pair<std::string, Hidden>> all = {
        {"nothing", [](double, double) { return 0.0; }},
        {"a cubic", [](double, double x) { return 4e5 * x * x * x; }},
        {"a drift", [](double t, double) { return 0.01 * t; }},
        {"a drift that settles", [](double t, double) { return 0.3 * (1.0 - std::exp(-t / 3.0)); }},
        {"a place", [](double, double x) { return 0.1 * std::exp(-std::pow((x - 4e-3) / 7e-4, 2)); }},
        {"a step of the way", [](double, double x) { return x > 6e-3 ? 0.1 : 0.0; }},
        // 2.9 s in the slow run, .6 and 1.5 s in the others
        {"waves along the way", [](double, double x) { return 0.06 * std::sin(kTurn / 2.9e-3 * x); }},
        {"one hump a stroke", [](double, double x) { return 0.3 * std::sin(M_PI / 1e-2 * x); }},
    };
    for (const auto& [name, masked] : all)
        for (std::uint64_t seed = 501; seed < 506; ++seed) {
            CAPTURE(name, seed);
            CHECK(swingIn(with(seed, masked)).period == 0.0);
        }
}
