// Angle and spin at release, against oscillators whose motion is known.

#include "plugin/recording/import/release_state.h"
#include "tests/plugin/recording/import/support.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

using namespace importingtest;
using Catch::Matchers::Contains;
using importing::Quantity;
using importing::ReleaseState;
using importing::Signals;

namespace {

constexpr double kDegrees = 180.0 / M_PI;
constexpr double kEncoder = 0.15 / kDegrees; // rad, one step

struct Motion {
    std::function<double(double, double)> acceleration; ///< of angle and spin
    double angle = 0.0, spin = 0.0;                     ///< at time 0
};

/// A pendulum of 0.75 s at small angles, with viscous and quadratic losses.
Motion pendulum(double angle, double spin) {
    const double k = std::pow(2.0 * M_PI / 0.75, 2);
    return {[k](double a, double w) { return -k * std::sin(a) - 0.1 * w - 0.01 * w * std::abs(w); }, angle, spin};
}

/// Rows at `rate` Hz: angles in encoder steps, and spins of a gyroscope with `gyro` rad/s of noise (0: none).
Signals recorded(const Motion& m, double rate, int rows, double gyro = 0.0, double lag = 0.0) {
    Signals out;
    out.channels = {{Quantity::Time, {}, {}}, {Quantity::Angle, {}, {}}};
    if (gyro > 0.0)
        out.channels.push_back({Quantity::AngularVelocity, {}, {}});
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0.0, gyro > 0.0 ? gyro : 1.0);
    double a = m.angle, w = m.spin, now = 0.0;
    const auto advance = [&](double to) {
        const double h = (to - now) / 40.0;
        for (int i = 0; i < 40; ++i) { // leapfrog in small steps: 1e-6 of the amplitude
            const double half = w + 0.5 * h * m.acceleration(a, w);
            a += h * half;
            w = half + 0.5 * h * m.acceleration(a, half);
        }
        now = to;
    };
    for (int i = 0; i < rows; ++i) {
        advance(i / rate);
        out.channels[0].values.push_back(now);
        out.channels[1].values.push_back(kEncoder * std::round(a / kEncoder));
        if (gyro > 0.0)
            out.channels[2].values.push_back(w + noise(random));
        out.line.push_back(static_cast<std::size_t>(i) + 2);
    }
    if (lag != 0.0)
        for (double& v : out.channels[2].values)
            v += lag;
    return out;
}

} // namespace

TEST_CASE("few rows a swing: the release state is known to some degrees a second", "[importing]") {
    int outside = 0;
    for (int phase = 0; phase < 24; ++phase) {
        const double at = 2.0 * M_PI * phase / 24.0;
        const Motion m = pendulum(1.15 * std::cos(at), -9.0 * std::sin(at));
        const ReleaseState s = importing::releaseStateOf(recorded(m, 20.0, 200));
        INFO("phase " << phase << ": " << kDegrees * s.angle << " +- " << kDegrees * s.angleHalfWidth << " deg, "
                      << kDegrees * s.spin << " +- " << kDegrees * s.spinHalfWidth << " deg/s; true "
                      << kDegrees * m.angle << ", " << kDegrees * m.spin);
        CHECK(kDegrees * s.angleHalfWidth < 1.0);
        CHECK(kDegrees * s.spinHalfWidth < 25.0);
        outside += std::abs(s.angle - m.angle) > s.angleHalfWidth || std::abs(s.spin - m.spin) > s.spinHalfWidth;
    }
    CHECK(outside <= 1); // three standard deviations from twelve rows: 1 % of 24
}

TEST_CASE("a harmonic oscillator gives its release state exactly", "[importing]") {
    // A = 0.3 rad, 1.2 Hz: angle A cos, spin -A w sin, at 12 rows a period and without an encoder
    const double w = 2.0 * M_PI * 1.2, phase = 0.7;
    Signals s;
    s.channels = {{Quantity::Time, {}, {}}, {Quantity::Angle, {}, {}}};
    for (int i = 0; i < 120; ++i) {
        s.channels[0].values.push_back(i / (12.0 * 1.2));
        s.channels[1].values.push_back(0.05 + 0.3 * std::cos(w * s.channels[0].values.back() + phase));
        s.line.push_back(static_cast<std::size_t>(i) + 2);
    }
    const ReleaseState found = importing::releaseStateOf(s);
    CHECK(found.angle == Approx(0.05 + 0.3 * std::cos(phase)).margin(1e-4)); // of Runge-Kutta steps and wide priors
    CHECK(found.spin == Approx(-0.3 * w * std::sin(phase)).margin(1e-3));
}

TEST_CASE("a gyroscope narrows the release state", "[importing]") {
    const Motion m = pendulum(-0.8, 2.0);
    for (const double rate : {20.0, 1000.0}) {
        const ReleaseState angles = importing::releaseStateOf(recorded(m, rate, static_cast<int>(10 * rate)));
        const ReleaseState both = importing::releaseStateOf(recorded(m, rate, static_cast<int>(10 * rate), 0.02));
        INFO(rate << " Hz: " << kDegrees * angles.spinHalfWidth << " and " << kDegrees * both.spinHalfWidth);
        CHECK_FALSE(angles.bySpin);
        CHECK(both.bySpin);
        CHECK(both.spinHalfWidth < 0.7 * angles.spinHalfWidth);
        CHECK(std::abs(both.spin - m.spin) < both.spinHalfWidth);
        CHECK(std::abs(both.angle - m.angle) < both.angleHalfWidth);
    }
}

TEST_CASE("angular velocities that contradict the angles are not used", "[importing]") {
    const Motion m = pendulum(-0.8, 2.0);
    const Signals s = recorded(m, 20.0, 200, 0.02, 3.0);
    const ReleaseState found = importing::releaseStateOf(s);
    CHECK_FALSE(found.bySpin);
    CHECK(std::abs(found.spinApart) > 1.0);
    CHECK(std::abs(found.spin - m.spin) < found.spinHalfWidth);
}

TEST_CASE("differences of neighbouring angles are no measurement", "[importing]") {
    const Motion m = pendulum(-1.1, 0.0);
    const Signals gyro = recorded(m, 20.0, 100, 0.02);
    const std::vector<double>&t = gyro.channels[0].values, &a = gyro.channels[1].values;
    for (const int kind : {0, 1, 2}) {
        Signals s = gyro;
        for (std::size_t i = 1; i + 1 < a.size(); ++i) {
            const std::size_t from = kind == 1 ? i : i - 1, to = kind == 0 ? i : i + 1;
            s.channels[2].values[i] = (a[to] - a[from]) / (t[to] - t[from]);
        }
        std::vector<importing::Remark> remarks;
        importing::dropDifferences(s, remarks);
        CHECK(s.find(Quantity::AngularVelocity) == nullptr);
        CHECK(remarks.size() == 1);
    }
    Signals kept = gyro;
    std::vector<importing::Remark> remarks;
    importing::dropDifferences(kept, remarks);
    CHECK(kept.find(Quantity::AngularVelocity) != nullptr);
    CHECK(remarks.empty());
}

TEST_CASE("a column of angular velocities is imported beside the angles", "[importing]") {
    const Signals s = recorded(pendulum(-0.8, 2.0), 20.0, 100, 0.02);
    const auto written = [&](const std::string& head, double perRadian) {
        std::string text = head + "\n";
        for (std::size_t i = 0; i < s.rows(); ++i)
            text += printed(s.channels[0].values[i], 3) + "," + printed(s.channels[1].values[i], 6) + "," +
                    printed(perRadian * s.channels[2].values[i], 6) + "\n";
        return text;
    };
    for (const auto& [head, perRadian] : std::initializer_list<std::pair<const char*, double>>{
             {"Time/s,Angle/rad,AngVel/rad/s", 1.0}, {"t (s),angle (rad),gyro z (deg/s)", kDegrees}}) {
        const auto all = read(written(head, perRadian));
        INFO(head << all.error());
        REQUIRE(all);
        REQUIRE(all->runs[0].signals.find(Quantity::AngularVelocity) != nullptr);
        CHECK(all->runs[0].signals.find(Quantity::AngularVelocity)->at(3) ==
              Approx(s.channels[2].values[3]).margin(1e-6));
        CHECK_THAT(importing::runFiles(*all).value().front().second, Contains("angle_deg,spin_deg_s"));
        CHECK_THAT(importing::account(*all), Contains("is angular velocity ["));
    }
    // beside a force it is not needed
    const auto pressed = read("time_s,displacement_mm,force_N,angvel (rad/s)\n" + [] {
        std::string text;
        for (int i = 0; i < rows; ++i)
            text += printed(timeOf(i), 3) + "," + printed(wayOf(timeOf(i)), 4) + "," +
                    printed(forceOf(wayOf(timeOf(i))), 4) + ",0.1\n";
        return text;
    }());
    INFO(pressed.error());
    REQUIRE(pressed);
    CHECK_THAT(importing::account(*pressed), Contains("not needed here"));
}
