// Shipped scenes of mechanisms against closed forms, played as experiments describe them.

#include "plugin/identification/replay/multibody.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"

#include "tests/support/folder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;
using replay::Multibody;
using step::Vec2;

namespace {

/// An experiment with a shipped scene, one run without rows.
experiment::Experiment experimentWith(const std::string& scene, const std::string& observe, const std::string& column,
                                      const std::string& parameters, const std::string& run, double rate) {
    const test::Folder folder;
    folder.write("run.csv", "time_s," + column + "\n0,0\n0.01,1\n");
    const std::string file =
        folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene", "scene": ")" + scene +
                                            R"(", "scene_parameters": {)" + parameters +
                                            R"(}, "channels": [{"observe": ")" + observe + R"(", "column": ")" +
                                            column + R"("}], "runs": [{"file": "run.csv", )" + run + "}]}");
    auto loaded = experiment::load(file);
    INFO(loaded.error());
    REQUIRE(loaded);
    loaded->runs.front().readings = {};
    loaded->runs.front().samplingRate = rate;
    return *loaded;
}

replay::Simulated played(const experiment::Experiment& e) {
    auto out = replay::simulate(e, 0, replay::nominal(e), replay::Resolution::fine());
    REQUIRE(out.failure == "");
    return out;
}

/// Times at which a column passes zero upwards, by the line between two rows.
std::vector<double> upwards(const experiment::Readings& r) {
    std::vector<double> out;
    for (std::size_t i = 1; i < r.time.size(); ++i)
        if (r.force[i - 1] < 0.0 && r.force[i] >= 0.0)
            out.push_back(r.time[i - 1] - r.force[i - 1] * (r.time[i] - r.time[i - 1]) / (r.force[i] - r.force[i - 1]));
    return out;
}

double periodOf(const experiment::Readings& r) {
    const std::vector<double> at = upwards(r);
    REQUIRE(at.size() > 2);
    return (at.back() - at.front()) / static_cast<double>(at.size() - 1);
}

/// Period of x'' = -w^2 (x + c x^3) at amplitude a: the energy integral with x = a sin(u).
double periodOfCubic(double w, double c, double a) {
    constexpr int kPoints = 200; // the integrand is smooth and periodic
    double sum = 0.0;
    for (int i = 0; i < kPoints; ++i) {
        const double s = std::sin(0.5 * M_PI * (i + 0.5) / kPoints);
        sum += 1.0 / std::sqrt(1.0 + 0.5 * c * a * a * (1.0 + s * s));
    }
    return 4.0 / w * 0.5 * M_PI * sum / kPoints;
}

} // namespace

TEST_CASE("a mass on a linear or cubic spring has the period of the energy integral", "[replay][mechanism]") {
    // Rows of 1 ms: linear interpolation of a zero crossing errs by 1e-6 of a period, over ten periods.
    for (const double cubic : {0.0, 80.0, -80.0}) {
        const auto e = experimentWith("mass_on_spring", "position", "y_mm", "\"cubic\": " + std::to_string(cubic),
                                      R"("duration_s": 8)", 1000.0);
        CHECK(periodOf(played(e).readings) == Approx(periodOfCubic(2.0 * M_PI * 1.5, cubic, 0.05)).epsilon(2e-6));
    }
}

TEST_CASE("a mass on a spring loses energy by dry and viscous friction as the closed forms say",
          "[replay][mechanism]") {
    const auto turns = [](const experiment::Readings& r) {
        std::vector<double> out;
        for (std::size_t i = 1; i + 1 < r.force.size(); ++i)
            if (r.force[i] > r.force[i - 1] && r.force[i] >= r.force[i + 1])
                out.push_back(r.force[i]);
        return out;
    };
    const double k = 0.5 * std::pow(2.0 * M_PI * 1.5, 2), friction = 0.02; // N/m, N
    const auto dry = experimentWith("mass_on_spring", "position", "y_mm", R"("mu": 0.02, "normal_force": 1)",
                                    R"("duration_s": 6)", 2000.0);
    const std::vector<double> a = turns(played(dry).readings);
    REQUIRE(a.size() > 5);
    // A turning point lies within half a row of the highest row: 0.05 (w dt / 2)^2 / 2 = 1.4e-7 m.
    for (std::size_t i = 1; i < 5; ++i)
        CHECK(a[i - 1] - a[i] == Approx(4.0 * friction / k).margin(3e-7));
    const double zeta = 0.02;
    const auto viscous =
        experimentWith("mass_on_spring", "position", "y_mm", R"("damping_ratio": 0.02)", R"("duration_s": 6)", 2000.0);
    const std::vector<double> b = turns(played(viscous).readings);
    REQUIRE(b.size() > 5);
    for (std::size_t i = 1; i < 5; ++i)
        CHECK(std::log(b[i - 1] / b[i]) ==
              Approx(2.0 * M_PI * zeta / std::sqrt(1.0 - zeta * zeta)).margin(2e-5)); // 1.4e-7 of 0.03 m, twice
}

TEST_CASE("an accelerometer reads minus the squared frequency times the position", "[replay][mechanism]") {
    const std::string run = R"("duration_s": 2)";
    const auto x = played(experimentWith("mass_on_spring", "position", "y_mm", "", run, 500.0)).readings.force;
    const auto a = played(experimentWith("mass_on_spring", "acceleration", "a_m_s2", "", run, 500.0)).readings.force;
    const double w = 2.0 * M_PI * 1.5;
    REQUIRE(x.size() == a.size());
    for (std::size_t i = 0; i < x.size(); ++i)
        REQUIRE(a[i] == Approx(-w * w * x[i]).margin(w * w * 0.05 * 1e-4)); // parabolas between the steps
}

TEST_CASE("a torsional pendulum has its frequency", "[replay][mechanism]") {
    const auto e = experimentWith("torsional_pendulum", "angle", "angle_deg", "", R"("duration_s": 8)", 1000.0);
    CHECK(periodOf(played(e).readings) == Approx(1.0 / 0.8).epsilon(2e-6));
}

TEST_CASE("a sled breaks away at the static friction and falls below the sliding one", "[replay][mechanism]") {
    // Pulled slowly by an undamped spring. The first drop of the force ends at (2 mu_k - mu_s) N.
    const auto e = experimentWith("sled", "force", "force_N", R"("static_ratio": 1.4, "viscosity": 0)",
                                  R"("drive_time_s": [0, 20], "drive_displacement_mm": [0, 4])", 2000.0);
    const std::vector<double> f = played(e).readings.force;
    const double sliding = 0.3 * 1.96, sticking = 1.4 * sliding;
    const auto top = std::max_element(f.begin(), f.end());
    // A row of 0.5 ms after the break the force is 0.02 N lower: (w dt)^2 / 2 of the drop.
    CHECK(*top == Approx(sticking).epsilon(1e-3));
    const auto first = std::find_if(f.begin(), f.end(), [&](double v) { return v > 0.998 * sticking; });
    // The slip takes half a period (63 ms), in which the machine moves by 0.013 mm: 0.006 N.
    CHECK(*std::min_element(first, std::min(f.end(), first + 200)) == Approx(2.0 * sliding - sticking).margin(0.008));
}

TEST_CASE("a block on a belt is dragged by the friction of its law", "[replay][mechanism]") {
    const auto e = experimentWith("block_on_belt", "force", "force_N", "",
                                  R"("drive_time_s": [0, 2, 4], "drive_displacement_mm": [0, 2, 22])", 100.0);
    const auto at = [](const experiment::Readings& r, double t) {
        return r.force[static_cast<std::size_t>(std::lround(t * 100.0))];
    };
    CHECK(at(played(e).readings, 1.5) == Approx(4.0).epsilon(1e-9)); // mu N, steady after 1 s
    replay::Parameters p = replay::nominal(e);
    for (const char* setting : {"law=logarithmic", "strength=0.03", "speed_m_s=1e-3"})
        REQUIRE(effects::add(p.effects, std::string("rate_dependent_friction:") + setting) == "");
    const auto law = replay::simulate(e, 0, p, replay::Resolution::fine());
    REQUIRE(law.failure == "");
    const double v1 = 1e-3, v2 = 1e-2;
    CHECK(at(law.readings, 1.5) == Approx(4.0 * (1.0 + 0.03 * std::log1p(v1 / 1e-3))).epsilon(1e-6));
    CHECK(at(law.readings, 3.5) == Approx(4.0 * (1.0 + 0.03 * std::log1p(v2 / 1e-3))).epsilon(1e-6));
}

TEST_CASE("a block on a belt shows the direct effect, the age of its contacts and their healing at rest",
          "[replay][mechanism]") {
    // 1 mm/s, rests of 2 and 20 s, then 10 mm/s; 4 N in steady sliding at 1 mm/s, a = 0.02, b = 0.03, Dc 20 um.
    const auto e = experimentWith(
        "block_on_belt", "force", "force_N", "",
        R"("drive_time_s": [0, 2, 4, 6, 26, 28, 30], "drive_displacement_mm": [0, 2, 2, 4, 4, 6, 26])", 2000.0);
    replay::Parameters p = replay::nominal(e);
    for (const char* setting : {"a_over_mu=0.02", "b_over_mu=0.03", "Dc_m=2e-5", "V0_m_s=1e-3", "creep_m_s=1e-6"})
        REQUIRE(effects::add(p.effects, std::string("rate_and_state_friction:") + setting) == "");
    const auto out = replay::simulate(e, 0, p, replay::Resolution::fine());
    REQUIRE(out.failure == "");
    const auto at = [&](double t) { return out.readings.force[static_cast<std::size_t>(std::lround(2000.0 * t))]; };
    const auto largest = [&](double from, double to) {
        double most = 0.0;
        for (double t = from; t < to; t += 5e-4)
            most = std::max(most, at(t));
        return most;
    };
    // Steady after 25 and more Dc; the creep speed changes it by 2e-5 at 1 mm/s.
    for (const double t : {1.9, 5.9, 27.9})
        CHECK(at(t) == Approx(4.0 * (1.0 + 0.02 * std::log1p(1e-3))).epsilon(1e-6));
    CHECK(at(29.9) == Approx(4.0 * (1.0 - 0.01 * std::log(10.0) + 0.02 * std::log1p(1e-4))).epsilon(1e-6));
    // The peaks after both rests differ by b ln of the ratio of their ages: 2 and 20 s longer than Dc / V0 = 20 ms.
    // What slips before the peak renews more of the older contacts: 2 % of the difference, by backward Euler elsewhere.
    const double peaks = largest(26.01, 27.0) - largest(4.01, 5.0);
    CHECK(peaks == Approx(4.0 * 0.03 * std::log(20.0 / 2.0)).epsilon(0.03));
    // A jump to 10 mm/s: the direct effect, less what 0.2 mm/s of the load cell's give and the renewal take of it.
    CHECK(largest(28.0, 28.1) > at(27.9) + 0.6 * 4.0 * 0.02 * std::log(10.0));
    CHECK(largest(28.0, 28.1) < at(27.9) + 4.0 * 0.02 * std::log(10.0));
}

TEST_CASE("a bead on a turning rod moves as the hyperbolic cosine", "[replay][mechanism]") {
    step::RigidWorldDefinition w;
    w.gravity = Vec2::Zero();
    w.bodies.resize(2);
    w.bodies[0].type = step::BodyType::Kinematic;
    w.bodies[0].angularVelocity = 3.0;
    w.bodies[1].type = step::BodyType::Dynamic;
    w.bodies[1].position = {0.1, 0.0};
    w.bodies[1].linearVelocity = {0.0, 0.3};
    w.bodies[1].angularVelocity = 3.0;
    w.bodies[1].massData = step::MassData{0.2, Vec2::Zero(), 1e-3};
    step::JointDefinition j;
    j.kind = step::JointKind::Prismatic;
    j.bodyA = 0;
    j.bodyB = 1;
    w.joints = {j};
    Multibody m(w, {});
    REQUIRE(m.failure() == "");
    while (m.time() < 1.0 - 1e-12)
        m.advance(std::min(2e-3, 1.0 - m.time()));
    CHECK(m.pose(1).origin.norm() == Approx(0.1 * std::cosh(3.0)).epsilon(1e-9));
    CHECK(m.jointGap() < 1e-12);
}

TEST_CASE("free bodies on a slide with a spring keep momentum and energy", "[replay][mechanism]") {
    step::RigidWorldDefinition w;
    w.gravity = Vec2::Zero();
    w.bodies.resize(3);
    for (int i = 0; i < 3; ++i) {
        step::BodyDefinition& b = w.bodies[static_cast<std::size_t>(i)];
        b.type = step::BodyType::Dynamic;
        b.position = {0.3 * i, 0.0};
        b.massData = step::MassData{0.2 + 0.1 * i, Vec2(0.01 * i, 0.02), 4e-3};
    }
    w.bodies[0].linearVelocity = {0.1, 0.5};
    w.bodies[0].angularVelocity = 2.0;
    step::JointDefinition slide;
    slide.kind = step::JointKind::Prismatic;
    slide.bodyA = 0;
    slide.bodyB = 1;
    slide.localAxisA = Vec2(0.8, 0.6);
    slide.anchorA = {0.3, 0.0};
    slide.spring.stiffness = 40.0;
    slide.spring.cubic = 20.0;
    slide.spring.rest = 0.05;
    step::JointDefinition spring;
    spring.kind = step::JointKind::Distance;
    spring.bodyA = 1;
    spring.bodyB = 2;
    spring.spring.stiffness = 30.0;
    spring.spring.rest = 0.25;
    w.joints = {slide, spring};
    Multibody m(w, {});
    REQUIRE(m.failure() == "");
    const auto momentum = [&] {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (int i = 0; i < 3; ++i) {
            const Multibody::Pose p = m.pose(i);
            const double mass = 0.2 + 0.1 * i, inertia = 4e-3 - mass * Vec2(0.01 * i, 0.02).squaredNorm();
            const Eigen::Rotation2Dd turn(p.angle);
            const Vec2 r = turn * Vec2(0.01 * i, 0.02), at = p.origin + r,
                       v = p.velocity + p.spin * Vec2(-r.y(), r.x());
            sum += Eigen::Vector3d(mass * v.x(), mass * v.y(),
                                   mass * (at.x() * v.y() - at.y() * v.x()) + inertia * p.spin);
        }
        return sum;
    };
    const double energy = m.energy();
    const Eigen::Vector3d before = momentum();
    while (m.time() < 2.0 - 1e-12)
        m.advance(std::min({2e-3, 0.05 * m.shortestTime(), 2.0 - m.time()}));
    CHECK(m.energy() == Approx(energy).epsilon(1e-7)); // of the classical Runge-Kutta method
    CHECK((momentum() - before).norm() < 1e-9 * before.norm());
}
