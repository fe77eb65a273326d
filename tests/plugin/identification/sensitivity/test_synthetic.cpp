// Derivatives of synthetic simulators with known ones.

#include "plugin/identification/sensitivity/noise.h"
#include "plugin/identification/sensitivity/sensitivity.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>

using namespace supercircle;
using sensitivity::Column;
using sensitivity::Model;
using sensitivity::Sensitivities;

namespace {

constexpr double kEnd = 20.0; ///< s
constexpr double kSpeed = 1e-3;

/// Loading and unloading at 1 mm/s, 25 Hz.
experiment::Experiment machine() {
    experiment::Experiment e;
    experiment::Run run;
    run.file = "run_1.csv";
    run.driveTime = {0.0, 0.5 * kEnd, kEnd};
    run.driveDisplacement = {0.0, 0.5 * kEnd * kSpeed, 0.0};
    run.samplingRate = 25.0;
    e.runs = {run};
    return e;
}

double way(double t) {
    return kSpeed * (t < 0.5 * kEnd ? t : kEnd - t);
}

/// Readings at 25 Hz and, as the trace, at 1 kHz.
template <class Force>
replay::Simulated play(Force&& force) {
    replay::Simulated s;
    const auto fill = [&](experiment::Readings& r, double rate) {
        for (int i = 0; i <= static_cast<int>(kEnd * rate); ++i) {
            const double t = i / rate;
            r.time.push_back(t);
            r.displacement.push_back(way(t));
            r.force.push_back(force(t));
        }
    };
    fill(s.readings, 25.0);
    fill(s.trace, 1000.0);
    return s;
}

Column column(const char* name, double value, double scale) {
    Column c;
    c.name = name;
    c.unit = "1";
    c.value = value;
    c.scale = scale;
    return c;
}

/// Deterministic noise in -1 .. 1 for equal arguments, like the last digits of a solver.
double disorder(double a, double b) {
    std::uint64_t x = 0, y = 0;
    std::memcpy(&x, &a, sizeof x);
    std::memcpy(&y, &b, sizeof y);
    x ^= y * 0x9E3779B97F4A7C15ULL;
    for (int i = 0; i < 3; ++i) {
        x ^= x >> 31;
        x *= 0xBF58476D1CE4E5B9ULL;
        x ^= x >> 29;
    }
    return 2.0 * static_cast<double>(x >> 11) / 9007199254740992.0 - 1.0;
}

/// F = a (sin(t / 3) + 1) + b^2 t / 10 with noise of a given half-width.
Model smooth(double noise) {
    Model m;
    m.runs = 1;
    m.columns = {column("a", 2.0, 0.1), column("b", 1.0, 0.05), column("c", 3.0, 0.1)};
    m.simulate = [noise](std::size_t, const std::vector<double>& v, const replay::Options&) {
        return play([&](double t) {
            return v[0] * (std::sin(t / 3.0) + 1.0) + v[1] * v[1] * t / 10.0 +
                   noise * disorder(v[0] + 10.0 * v[1] + 100.0 * v[2], t);
        });
    };
    return m;
}

} // namespace

TEST_CASE("the derivatives of a smooth simulator are exact", "[sensitivity]") {
    const experiment::Experiment e = machine();
    const Sensitivities s = sensitivity::differentiate(smooth(0.0), e, {});
    REQUIRE(s.failure.empty());
    const sensitivity::RunSensitivity& run = s.runs[0];
    REQUIRE(run.force.rows() == 501);
    for (Eigen::Index i = 0; i < run.force.rows(); ++i) { // quadratic in b: central differences are exact
        const double t = run.base.readings.time[static_cast<std::size_t>(i)];
        REQUIRE(run.force(i, 0) == Approx(std::sin(t / 3.0) + 1.0).margin(1e-9));
        REQUIRE(run.force(i, 1) == Approx(0.2 * t).margin(1e-9));
        REQUIRE(run.usable(i, 0));
    }
    CHECK(run.quality[2].belowNoise);
    CHECK_FALSE(run.isDetectable(2));
    CHECK(run.quality[0].twoStepError < 1e-9);
    CHECK(run.forceNoiseRms < 1e-8);
}

TEST_CASE("solver noise is measured and kept out of the derivatives", "[sensitivity]") {
    const experiment::Experiment e = machine();
    const double half = 1e-3;
    const Sensitivities s = sensitivity::differentiate(smooth(half), e, {});
    const sensitivity::RunSensitivity& run = s.runs[0];
    // uniform noise: half / sqrt(3). 501 rows of four third differences: known to a few percent.
    CHECK(run.forceNoiseRms == Approx(half / std::sqrt(3.0)).epsilon(0.1));
    double error = 0.0;
    for (Eigen::Index i = 0; i < run.force.rows(); ++i)
        error +=
            std::pow(run.force(i, 0) - std::sin(run.base.readings.time[static_cast<std::size_t>(i)] / 3.0) - 1.0, 2);
    error = std::sqrt(error / static_cast<double>(run.force.rows()));
    CHECK_FALSE(run.quality[0].belowNoise);
    CHECK(run.quality[0].signal > 3.0);
    const double size = std::sqrt(1.5); // rms of sin + 1, roughly
    CHECK(error == Approx(run.quality[0].noiseError * size).epsilon(0.3));
    CHECK(run.quality[2].belowNoise);          // it only changes the noise
    CHECK(run.quality[2].step == Approx(0.1)); // with the whole scale
}

TEST_CASE("a failed simulation of the noise measurement leaves no gap", "[sensitivity]") {
    Model m = smooth(0.0);
    m.simulate = [whole = m.simulate](std::size_t run, const std::vector<double>& v, const replay::Options& options) {
        replay::Simulated s = whole(run, v, options);
        if (std::abs(v[0] - 2.01) < 1e-6) // the fifth of seven
            s.failure = "not here";
        return s;
    };
    const experiment::Experiment e = machine();
    const Sensitivities s = sensitivity::differentiate(m, e, {});
    REQUIRE(s.failure.empty());
    CHECK(s.runs[0].forceNoiseRms < 1e-8); // round-off; unequal spacing would make 1e-6 of b^2
}

TEST_CASE("computational noise of pure noise is its standard deviation, of a parabola zero", "[sensitivity]") {
    std::vector<double> noise, parabola;
    for (int i = 0; i < 4000; ++i) {
        noise.push_back(disorder(i, 0.5));
        parabola.push_back(1.0 + 0.3 * i + 0.01 * i * i);
    }
    CHECK(sensitivity::computationalNoise(noise) == Approx(1.0 / std::sqrt(3.0)).epsilon(0.05));
    CHECK(sensitivity::computationalNoise(parabola) < 1e-9);
    CHECK(sensitivity::computationalNoise({1.0, 2.0, 4.0}) == 0.0);
}

TEST_CASE("a moving jump is flagged, excluded and followed by its landmark", "[sensitivity]") {
    // Falls from 1 N to 0.2 N at 6 s + 2 s (a - 1) of loading: a shifts it by 0.5 s over its scale of 0.25.
    Model m;
    m.runs = 1;
    m.columns = {column("a", 1.0, 0.25), column("b", 1.0, 0.1)};
    m.simulate = [](std::size_t, const std::vector<double>& v, const replay::Options&) {
        const double jump = 6.0 + 2.0 * (v[0] - 1.0);
        return play([&](double t) { return v[1] * (t < jump ? 1.0 - 0.001 * t : 0.2); });
    };
    const experiment::Experiment e = machine();
    const Sensitivities s = sensitivity::differentiate(m, e, {});
    const sensitivity::RunSensitivity& run = s.runs[0];
    REQUIRE(run.landmarks.names.at(0) == "jump1_displacement");
    CHECK(run.landmarks.values[0] == Approx(6e-3).margin(1.1e-6)); // the trace has 1 um
    CHECK(run.landmarkJacobian(0, 0) == Approx(2e-3).epsilon(0.02));
    CHECK(std::abs(run.landmarkJacobian(0, 1)) < 1e-5);
    CHECK(run.landmarkJacobian(3, 1) == Approx(0.794).margin(0.005)); // drop in b
    CHECK(run.quality[0].changesJumps);
    CHECK(run.quality[0].jumpShift > 1.0);
    CHECK_FALSE(run.quality[1].changesJumps);
    for (Eigen::Index i = 0; i < run.force.rows(); ++i)
        if (run.usable(i, 0))
            REQUIRE(std::abs(run.force(i, 0)) < 1e-9);
    CHECK_FALSE(run.usable(150, 0)); // 6 s
    CHECK(run.usable(100, 0));
    CHECK(run.usable(400, 1));
}

TEST_CASE("one-sided derivatives replace failed sides", "[sensitivity]") {
    Model m;
    m.runs = 1;
    m.columns = {column("bounded", 0.0, 1.0), column("fails", 1.0, 0.2), column("hopeless", 1.0, 0.2)};
    m.columns[0].lower = 0.0;
    m.simulate = [](std::size_t, const std::vector<double>& v, const replay::Options&) {
        replay::Simulated s = play([&](double t) { return std::exp(0.1 * v[0]) * t + v[1] * t * t; });
        if (v[0] < 0.0 || v[1] < 1.0)
            s.failure = "out of range";
        if (v[2] != 1.0)
            s.failure = "never works";
        return s;
    };
    const experiment::Experiment e = machine();
    sensitivity::SensitivitySettings settings;
    const Sensitivities s = sensitivity::differentiate(m, e, settings);
    const sensitivity::RunSensitivity& run = s.runs[0];
    CHECK(run.quality[0].oneSided);
    CHECK(run.force(500, 0) == Approx(2.0).epsilon(0.02)); // first order: half of the step, 0.1 / 8
    CHECK(run.quality[1].oneSided);
    CHECK(run.force(500, 1) == Approx(400.0).epsilon(1e-6));
    CHECK(run.quality[2].failure == "never works");
    CHECK_FALSE(run.usable.col(2).any());
    CHECK(run.force.col(2).isZero());
}

TEST_CASE("results do not depend on the number of jobs", "[sensitivity]") {
    const experiment::Experiment e = machine();
    sensitivity::SensitivitySettings one, three;
    three.jobs = 3;
    const Sensitivities a = sensitivity::differentiate(smooth(1e-3), e, one);
    const Sensitivities b = sensitivity::differentiate(smooth(1e-3), e, three);
    CHECK(a.simulations == b.simulations);
    CHECK((a.runs[0].force.array() == b.runs[0].force.array()).all());
    CHECK((a.runs[0].forceNoise.array() == b.runs[0].forceNoise.array()).all());
    for (std::size_t c = 0; c < 3; ++c)
        CHECK(a.runs[0].quality[c].step == b.runs[0].quality[c].step);
}

TEST_CASE("a failure at the centre is reported", "[sensitivity]") {
    Model m = smooth(0.0);
    m.simulate = [](std::size_t, const std::vector<double>&, const replay::Options&) {
        replay::Simulated s;
        s.failure = "no equilibrium";
        return s;
    };
    CHECK(sensitivity::differentiate(m, machine(), {}).failure == "run 1: no equilibrium");
}

TEST_CASE("similar columns are recognised", "[sensitivity]") {
    Model m;
    m.runs = 1;
    m.columns = {column("a", 1.0, 0.1), column("b", 1.0, 0.1), column("c", 1.0, 0.1)};
    m.simulate = [](std::size_t, const std::vector<double>& v, const replay::Options&) {
        const double pi = std::acos(-1.0);
        return play([&](double t) {
            return v[0] * std::sin(pi * t / 10.0) - 2.0 * v[1] * std::sin(pi * t / 10.0) +
                   v[2] * std::cos(pi * t / 10.0);
        });
    };
    const experiment::Experiment e = machine();
    const Eigen::MatrixXd cosines = sensitivity::similarity(sensitivity::differentiate(m, e, {}));
    CHECK(cosines(0, 0) == Approx(1.0));
    CHECK(cosines(0, 1) == Approx(-1.0));
    CHECK(std::abs(cosines(0, 2)) < 0.01); // a whole period
}
