// Runs that repeat each other although they end elsewhere or have other row times.

#include "plugin/identification/diagnosis/recorded/repeats.h"
#include "tests/plugin/identification/diagnosis/toy.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::diagnosis;

namespace {

struct Leg {
    double way = 0.0;   ///< mm, positive: loading; 0: a dwell
    double speed = 1.0; ///< mm/s, of a dwell its duration in s
};

/// A run along these legs, with rows at `rate` Hz from `first` s on.
RecordedRun along(const std::vector<Leg>& legs, double rate = 25.0, double first = 0.0) {
    RecordedRun run;
    std::vector<DriveSegment> segments;
    double now = 0.0;
    for (const Leg& leg : legs) {
        const double duration = leg.way == 0.0 ? leg.speed : std::abs(leg.way) / leg.speed;
        segments.push_back({leg.way > 0.0   ? Phase::Loading
                            : leg.way < 0.0 ? Phase::Unloading
                                            : Phase::Hold,
                            now, now + duration, 1e-3 * leg.way / duration});
        now += duration;
    }
    const auto rows = static_cast<Eigen::Index>(std::floor((now - first) * rate)) + 1;
    run.time.resize(rows);
    run.displacement.resize(rows);
    run.force.resize(rows);
    for (Eigen::Index k = 0; k < rows; ++k) {
        run.time[k] = first + static_cast<double>(k) / rate;
        double d = 0.0;
        for (const DriveSegment& s : segments)
            d += s.speed * std::clamp(run.time[k] - s.from, 0.0, s.to - s.from);
        run.displacement[k] = d;
        run.force[k] = 100.0 * d;
    }
    run.setDrive(std::move(segments));
    return run;
}

bool repeat(const std::vector<Leg>& a, const std::vector<Leg>& b) {
    CHECK(sameDrive(along(a), along(b)) == sameDrive(along(b), along(a)));
    return sameDrive(along(a), along(b));
}

} // namespace

TEST_CASE("runs repeat each other where order, direction and speed agree over half of the shorter", "[diagnosis]") {
    const std::vector<Leg> cycle = {{0.0, 2.0}, {10.0, 1.0}, {0.0, 3.0}, {-10.0, 1.0}};
    CHECK(repeat(cycle, cycle));
    CHECK(repeat(cycle, {{0.0, 0.5}, {10.0, 1.0}, {0.0, 3.0}, {-10.0, 1.0}})); // another wait before it
    CHECK(repeat(cycle, {{10.0, 1.0}}));                                       // it ends after loading
    CHECK(repeat(cycle, {{4.0, 1.0}}));
    CHECK(repeat(cycle, {{10.0, 1.0}, {0.0, 3.0}, {-6.0, 1.0}}));
    CHECK(repeat(cycle, {{10.1, 1.015}, {0.0, 3.05}, {-10.1, 0.985}})); // 1.5 % off
    // other speeds, dwells, orders
    CHECK_FALSE(repeat(cycle, {{10.0, 1.03}, {0.0, 3.0}, {-10.0, 1.0}}));
    CHECK_FALSE(repeat(cycle, {{10.0, 1.0}, {0.0, 3.0}, {-10.0, 1.03}}));
    CHECK_FALSE(repeat(cycle, {{5.0, 1.0}, {5.0, 2.0}, {0.0, 3.0}, {-10.0, 1.0}}));
    CHECK_FALSE(repeat(cycle, {{10.0, 1.0}, {0.0, 4.0}, {-10.0, 1.0}}));
    CHECK_FALSE(repeat(cycle, {{10.0, 1.0}, {-10.0, 1.0}}));
    CHECK_FALSE(repeat(cycle, {{-10.0, 1.0}, {0.0, 3.0}, {10.0, 1.0}}));
    // turning earlier they share what comes before: half of the shorter run, and less than half
    CHECK(repeat({{10.0, 1.0}, {-10.0, 1.0}}, {{4.0, 1.0}, {-4.0, 1.0}}));
    CHECK_FALSE(repeat({{10.0, 1.0}, {-10.0, 1.0}}, {{4.0, 1.0}, {-4.0, 1.0}, {4.0, 1.0}, {-4.0, 1.0}}));
    // nothing is shared where nothing moves
    CHECK_FALSE(repeat({{0.0, 5.0}}, cycle));
}

TEST_CASE("rows of repeats are compared at the same place of the motion", "[diagnosis]") {
    const RecordedRun a = along({{0.0, 2.0}, {10.0, 1.0}, {0.0, 3.0}, {-10.0, 1.0}});
    const RecordedRun b = along({{0.0, 0.7}, {10.0, 1.01}, {0.0, 3.0}, {-4.0, 0.99}}, 17.0, 0.013);
    const auto rows = sharedRows(a, b);
    REQUIRE(rows.size() > 400);
    for (const auto& [k, t] : rows) {
        double d = 0.0;
        for (const DriveSegment& s : b.segments)
            d += s.speed * std::clamp(t - s.from, 0.0, s.to - s.from);
        CHECK(d == Approx(a.displacement[k]).margin(1e-12));
        CHECK(a.displacement[k] >= (t > 13.0 + 0.7 ? 6e-3 - 1e-12 : 0.0)); // b ends after 4 mm of unloading
    }
    CHECK(a.time[rows.front().first] >= 2.0);
}

TEST_CASE("the scatter of repeats with other row times is that of equal rows", "[diagnosis]") {
    constexpr double kSine = 0.05; // N
    const auto scatter = [&](double rate, double first, double sine) {
        RecordedData data = toy::recordings(1);
        Random random(11);
        const std::vector<Leg> legs = {{0.0, 2.0}, {10.0, 1.0}, {0.0, 3.0}, {-10.0, 1.0}};
        data.runs = {along(legs), along(legs, rate, first), along(legs, 25.0, 0.0)};
        data.runs[2].specimen = "another";
        for (std::size_t r = 0; r < 3; ++r)
            toy::addNoise(data.runs[r], random);
        for (Eigen::Index k = 0; k < data.runs[1].time.size(); ++k)
            data.runs[1].force[k] += sine * std::sin(0.9 * data.runs[1].time[k]);
        Noise noise;
        noise.white = toy::kWhite;
        noise.correlated = toy::kColoured;
        noise.correlationTime = toy::kMemory;
        scatterOfRepeats(data, noise);
        CHECK(noise.repeats == 1);
        return noise.runToRun;
    };
    // Half the mean square of a sine in one of two runs: a quarter of its square.
    CHECK(scatter(25.0, 0.0, kSine) == Approx(0.5 * kSine).epsilon(0.1));
    CHECK(scatter(23.0, 0.011, kSine) == Approx(0.5 * kSine).epsilon(0.1));
    CHECK(scatter(25.0, 0.0, 0.0) == 0.0);
    CHECK(scatter(23.0, 0.011, 0.0) == 0.0);
}
