// Readings that swing by themselves where rests are too short to tell: found in what a fit leaves of whole runs, and
// nowhere else.

#include "toy.h"

#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/recorded/swings.h"

#include <catch2/catch.hpp>
#include <functional>

using namespace supercircle::diagnosis;

namespace {

constexpr double kTurn = 2.0 * M_PI;

/// N, of time and place.
using Hidden = std::function<double(double, double)>;

Data with(std::uint64_t seed, const Hidden& hidden) {
    Data data = toy::recordings(seed);
    for (RecordedRun& run : data.runs)
        for (Eigen::Index k = 0; k < run.force.size(); ++k)
            run.force[k] += hidden(run.time[k], run.displacement[k]);
    return data;
}

/// What the true numbers leave.
Swing swingIn(const Data& data) {
    const toy::Spring spring(data);
    std::vector<Eigen::VectorXd> left;
    for (std::size_t r = 0; r < data.runs.size(); ++r)
        left.push_back(data.runs[r].force - spring.simulate(r, {{103.0, 0.08}, {}}, Fineness::Fine, nullptr).force);
    left.front().segment(40, 5).setConstant(std::numeric_limits<double>::quiet_NaN()); // where nothing is told
    return swingOfMisfit(data, left);
}

} // namespace

TEST_CASE("a disturbance slower than the rests is seen in whole runs, and is no noise", "[diagnosis]") {
    // Rests last 1, 2 and 1 s. Taken for noise, four deviations of a sine were "nothing missing".
    constexpr double kPeriod = 2.9, kSize = 0.04; // s, N
    const Data data = with(15, [](double t, double) { return kSize * std::sin(kTurn / kPeriod * t + 0.3); });
    REQUIRE(estimateNoise(data).swing == 0.0);
    const Swing found = swingIn(data);
    // Least squares know the frequency to sqrt(6) / (pi span) of noise over signal and root of the rows (Rife and
    // Boorstyn 1974), 1e-3 of it here; frequencies are looked at a fourth of 1 / span apart: 1.5 %.
    CHECK(found.period == Approx(kPeriod).epsilon(0.02));
    CHECK(found.amplitude() == Approx(kSize).epsilon(0.1));
    const toy::Spring spring(data);
    Store store;
    Evaluator evaluator(spring, data.runs.size(), {}, store);
    const Diagnosis d = diagnose(data, evaluator, toy::exact());
    CHECK(d.verdict == "unexplained");
    CHECK(d.unknown > 0.9);
    CHECK(d.noise.total() == Approx(std::hypot(toy::kWhite, toy::kColoured)).epsilon(0.25));
    CHECK_THAT(d.statement, Catch::Contains("Whatever the drive does") && Catch::Contains("with a period of 2.9"));
}

TEST_CASE("physics that is missing does not swing by itself", "[diagnosis]") {
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
    for (const auto& [name, hidden] : all)
        for (std::uint64_t seed = 501; seed < 506; ++seed) {
            CAPTURE(name, seed);
            CHECK(swingIn(with(seed, hidden)).period == 0.0);
        }
}
