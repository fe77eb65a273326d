// Errors and landmarks on synthetic curves.

#include "tests/plugin/identification/replay/support.h"

#include <cmath>

using namespace replaytest;

namespace {

/// A ramp that falls from 1 N to 0.2 N within a sample at `jump` (s), 50 Hz, 10 s, 1 mm/s.
experiment::Readings ramp(double jump, double offset = 0.0) {
    experiment::Readings r;
    for (int i = 0; i <= 500; ++i) {
        const double t = 0.02 * i;
        r.time.push_back(t);
        r.displacement.push_back(1e-3 * t);
        r.force.push_back(offset + (t < jump ? t / jump : 0.2 + 0.01 * (t - jump)));
    }
    return r;
}

} // namespace

TEST_CASE("a jump is found where the force passes its middle", "[replay]") {
    const auto marks = replay::findLandmarks(ramp(6.01));
    REQUIRE(marks.size() == 1);
    CHECK(marks[0].time == Approx(6.01).margin(0.011)); // half a sample
    CHECK(marks[0].displacement == Approx(1e-3 * marks[0].time).epsilon(1e-12));
    CHECK(marks[0].before > 0.98);
    CHECK(marks[0].after < 0.25);
}

TEST_CASE("smooth curves have no landmarks", "[replay]") {
    experiment::Readings r = ramp(20.0);
    CHECK(replay::findLandmarks(r).empty());
    for (std::size_t i = 0; i < r.force.size(); ++i)
        r.force[i] = std::sin(3.0 * r.time[i]);
    CHECK(replay::findLandmarks(r).empty());
}

TEST_CASE("a simulated jump has the time of a step, not of a reading", "[replay]") {
    replay::Simulated s;
    s.readings = ramp(6.013); // every 20 ms
    for (int i = 0; i <= 10000; ++i) {
        const double t = 1e-3 * i;
        s.trace.time.push_back(t);
        s.trace.displacement.push_back(1e-3 * t);
        s.trace.force.push_back(t < 6.0125 ? t / 6.013 : 0.2);
    }
    const std::vector<double> times = replay::jumpTimes(s);
    REQUIRE(times.size() == 1);
    CHECK(times[0] == Approx(6.0125).margin(5e-4)); // half a step
    s.trace = {};
    CHECK(replay::jumpTimes(s) == std::vector<double>{replay::findLandmarks(s.readings)[0].time});
}

TEST_CASE("errors exclude intervals around matched jumps", "[replay]") {
    experiment::Run run;
    run.readings = ramp(6.01);
    replay::Simulated s;
    s.readings = ramp(6.05, 0.003);
    const replay::Comparison c = replay::compare(run, s);
    REQUIRE(c.matches.size() == 1);
    CHECK(c.simulated[0].displacement - c.recorded[0].displacement == Approx(4e-5).margin(2.1e-5));
    // not excluded: the offset, and slopes that differ by 0.7 %
    CHECK(c.rmse < 0.01);
    CHECK(c.maxError < 0.01);
    CHECK(c.rmseAll > 0.03);
    CHECK(c.excludedFraction == Approx(0.44 / 10.0).margin(0.006));
    CHECK(c.residual.size() == 501);
    CHECK(c.peakRecorded == Approx(1.0).epsilon(0.01));
}

TEST_CASE("an incomplete run is compared up to its end", "[replay]") {
    experiment::Run run;
    run.readings = ramp(20.0);
    replay::Simulated s;
    s.readings = ramp(20.0, 0.1);
    for (auto* column : {&s.readings.time, &s.readings.displacement, &s.readings.force})
        column->resize(100);
    const replay::Comparison c = replay::compare(run, s);
    CHECK(c.rmse == Approx(0.1).epsilon(1e-9));
    CHECK(c.residualMean == Approx(0.1).epsilon(1e-9));
    CHECK(c.rmseAboutMean == Approx(0.0).margin(1e-8)); // root of a small difference of numbers near 0.01
    CHECK(std::isnan(c.residual[100]));
}
