// The reference simulator against six noise-free recordings of a third simulator (tests/data/recordings/baseline).

#include "tests/reference_simulator/description.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>

using namespace supercircle::reference_simulator;

namespace {

struct Agreement {
    double median = 0.0, percentile90 = 0.0; ///< shares of the peak force, over rows
};

/// @param finer compares with twice the nodes and half the steps instead of the recording
Agreement compare(const std::string& name, bool finer = false) {
    const std::string folder = std::string(SC_TEST_DATA) + "/recordings/baseline/" + name;
    const Description d = readDescription(folder + "/experiment.json");
    const RunPlan& run = d.runs.front();
    const std::vector<double> times = run.times(run.sampling);
    const auto simulate = [&](const Resolution& r) {
        Simulation sim(trueSetup(d, {}, {}), r);
        REQUIRE(sim.settle(3.0));
        const Trace t = sim.run(run.drive, times, {});
        REQUIRE(t.failure.empty());
        std::vector<double> force = readings(t, {}, times);
        zeroAtStart(times, force);
        return force;
    };
    const std::vector<double> force = simulate({});
    std::vector<double> other;
    if (finer) {
        Resolution fine;
        fine.edges *= 2;
        fine.travel *= 0.5;
        other = simulate(fine);
    } else {
        std::ifstream in(folder + "/" + run.file);
        std::string line;
        std::getline(in, line);
        double t = 0.0, x = 0.0, f = 0.0;
        while (std::getline(in, line) && std::sscanf(line.c_str(), "%lf,%lf,%lf", &t, &x, &f) == 3)
            other.push_back(f);
    }
    REQUIRE(other.size() == force.size());
    std::vector<double> difference;
    double peak = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) {
        difference.push_back(std::abs(force[i] - other[i]));
        peak = std::max(peak, std::abs(other[i]));
    }
    std::sort(difference.begin(), difference.end());
    return {difference[difference.size() / 2] / peak, difference[difference.size() * 9 / 10] / peak};
}

} // namespace

TEST_CASE("the reference simulator reproduces recordings of a third simulator", "[reference_simulator]") {
    // The simulators differ in contact stiffness and steps. Noise of the training cases is 0.4 to 1 % of the peak.
    for (const char* name : {"case_101", "case_102", "case_104", "case_105", "case_106"}) {
        const Agreement a = compare(name);
        INFO(name << ": median " << a.median << ", 90 % below " << a.percentile90);
        CHECK(a.median < 1.5e-3);
        CHECK(a.percentile90 < 3e-3);
    }
}

TEST_CASE("the reference simulator reproduces two shells", "[reference_simulator][slow]") {
    const Agreement a = compare("case_103");
    INFO("median " << a.median << ", 90 % below " << a.percentile90);
    CHECK(a.median < 2e-3);
    CHECK(a.percentile90 < 4e-3);
}

TEST_CASE("the discretisation error is far below the noise of the cases", "[reference_simulator]") {
    const Agreement a = compare("case_106", true);
    CHECK(a.median < 5e-4); // a tenth of the smallest noise
    CHECK(a.percentile90 < 1e-3);
}

TEST_CASE("the discretisation error is far below the noise of the cases, other protocols",
          "[reference_simulator][slow]") {
    for (const char* name : {"case_101", "case_104"}) {
        const Agreement a = compare(name, true);
        INFO(name << ": median " << a.median << ", 90 % below " << a.percentile90);
        CHECK(a.median < 5e-4);
        CHECK(a.percentile90 < 1e-3);
    }
}
