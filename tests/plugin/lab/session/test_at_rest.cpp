// Scenes that start at rest under loads.

#include "supercircle/effects/effect.h"
#include "tests/plugin/lab/session/simulation.h"

#include <algorithm>
#include <cmath>

using namespace supercircle;
using namespace supercircle::test;

TEST_CASE("a released cantilever starts with the energy of its load", "[lab]") {
    const double pull = 0.05, length = 0.3, b = 2e11 * 0.02 * 1e-9 / 12.0;
    const lab::RunResult out = simulate(loadScene("experiments/cantilever_vibration", {{"pull", pull}}));
    const record::Series& s = out.recording.series;
    const std::vector<double>&time = *s.find("time_s"), &elastic = *s.find("elastic_J"),
          &kinetic = *s.find("kinetic_J"), &work = *s.find("work_in_J");
    REQUIRE(time.size() > 10);
    CHECK(time.front() < 0.02); // the rest before is not recorded
    const double bent = pull * pull * length * length * length / (6.0 * b);
    // 48 arcs are stiffer by 4e-4; 1 % of the energy is in modes that a game-sized step does not resolve.
    CHECK(elastic.front() + kinetic.front() == Approx(bent).epsilon(2e-3));
    CHECK(elastic.back() + kinetic.back() == Approx(bent).epsilon(0.03));
    CHECK(work.back() == 0.0); // the load is gone
}

TEST_CASE("a viscoelastic strip at rest has crept before time 0", "[lab]") {
    // A relaxation time of a hundred times the longest rest that is simulated.
    scene::Scene scene = loadScene("experiments/cantilever_vibration", {{"pull", 0.0}, {"gravity", 1.0}});
    for (const char* word : {"law=standard_linear_solid", "branch_over_B=1", "tau_s=1000"})
        REQUIRE(effects::add(scene.effects, std::string("viscoelastic_bending:") + word).empty());
    const record::Recording r = simulate(scene).recording;
    const std::vector<double>&elastic = *r.series.find("elastic_J"), &kinetic = *r.series.find("kinetic_J");
    const double b = 2e11 * 0.02 * 1e-9 / 12.0, weight = 7800.0 * 0.02 * 1e-3, length = 0.3; // N m^2, N/m, m
    const double bent = weight * weight * std::pow(length, 5) / (40.0 * b);
    REQUIRE(elastic.size() > 10);
    CHECK(elastic.front() == Approx(bent).epsilon(5e-3));
    CHECK(elastic.back() == Approx(bent).epsilon(5e-3));
    CHECK(*std::max_element(kinetic.begin(), kinetic.end()) < 1e-4 * bent);
}

TEST_CASE("a weight at rest bends a cantilever as the elastica", "[lab]") {
    // P L^2 / B = 2 gives 0.49346 of the length (Bisshopp and Drucker, Q. Appl. Math. 3, 272, 1945).
    const double length = 0.3, b = 2e11 * 0.02 * 1e-9 / 12.0;
    const lab::RunResult out = simulate(
        loadScene("experiments/cantilever_weights", {{"weight", 2.0 * b / (length * length)}, {"gravity", 0.0}}));
    const record::ShellPose& pose = out.recording.frames.back().shells.front();
    double angle = pose.angle, y = pose.start[1];
    const double arc = length / static_cast<double>(pose.curvature.size());
    for (const float curvature : pose.curvature) {
        const double turn = static_cast<double>(curvature) * arc, half = 0.5 * turn;
        y += arc * (std::abs(half) > 1e-12 ? std::sin(half) / half : 1.0) * std::sin(angle + half);
        angle += turn;
    }
    CHECK(-y / length == Approx(0.49346).epsilon(1e-3)); // 48 arcs, positions in single precision
}

TEST_CASE("a run states the damping ratio of its time scheme", "[lab]") {
    // What the energy loses without any damping, over 2 omega_1 times energy and time.
    const double length = 0.3, b = 2e11 * 0.02 * 1e-9 / 12.0, line = 7800.0 * 0.02 * 1e-3;
    const double omega = std::pow(1.8751040687 / length, 2) * std::sqrt(b / line);
    const record::Recording r = simulate(loadScene("experiments/cantilever_vibration", {{"time", 2.0}})).recording;
    const std::vector<double>&elastic = *r.series.find("elastic_J"), &kinetic = *r.series.find("kinetic_J"),
          &time = *r.series.find("time_s");
    const double first = elastic.front() + kinetic.front(), last = elastic.back() + kinetic.back();
    const double expected = std::log(first / last) / (2.0 * omega * (time.back() - time.front()));
    CAPTURE(first, last);
    CHECK(expected > 0.0);
    CHECK(number(r, "numerical_damping_ratio") == Approx(expected).epsilon(0.1)); // 3 % of the energy vibrates higher
}
