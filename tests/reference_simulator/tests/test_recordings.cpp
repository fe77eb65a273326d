// The second simulator against six noise-free recordings of a third one (tests/data/recordings/baseline).

#include "tests/reference_simulator/description.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>

using namespace supercircle::oracle;

namespace {

struct Agreement {
    double median = 0.0, most = 0.0; ///< of the peak force; `most`: exceeded by a tenth of the rows
};

/// With `finer`: against itself with twice the nodes and half the steps instead.
Agreement compare(const std::string& name, bool finer = false) {
    const std::string folder = std::string(SC_TEST_DATA) + "/recordings/baseline/" + name;
    const Description d = readDescription(folder + "/experiment.json");
    const RunPlan& run = d.runs.front();
    const std::vector<double> times = run.times(run.sampling);
    const auto play = [&](const Resolution& r) {
        Simulation sim(trueSetup(d, {}, {}), r);
        REQUIRE(sim.settle(3.0));
        const Trace t = sim.play(run.drive, times, {});
        REQUIRE(t.failure.empty());
        std::vector<double> force = readings(t, {}, times);
        zeroAtStart(times, force);
        return force;
    };
    const std::vector<double> force = play({});
    std::vector<double> other;
    if (finer) {
        Resolution fine;
        fine.edges *= 2;
        fine.travel *= 0.5;
        other = play(fine);
    } else {
        std::ifstream in(folder + "/" + run.file);
        std::string line;
        std::getline(in, line);
        double t = 0.0, x = 0.0, f = 0.0;
        while (std::getline(in, line) && std::sscanf(line.c_str(), "%lf,%lf,%lf", &t, &x, &f) == 3)
            other.push_back(f);
    }
    REQUIRE(other.size() == force.size());
    std::vector<double> apart;
    double peak = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) {
        apart.push_back(std::abs(force[i] - other[i]));
        peak = std::max(peak, std::abs(other[i]));
    }
    std::sort(apart.begin(), apart.end());
    return {apart[apart.size() / 2] / peak, apart[apart.size() * 9 / 10] / peak};
}

} // namespace

TEST_CASE("the second simulator plays recordings of a third", "[oracle]") {
    // Two nodal simulators of different contact stiffness and step; noise of the concealed cases is 0.4 - 1 % of the
    // peak.
    for (const char* name : {"case_101", "case_102", "case_104", "case_105", "case_106"}) {
        const Agreement a = compare(name);
        INFO(name << ": median " << a.median << ", 90 % below " << a.most);
        CHECK(a.median < 1.5e-3);
        CHECK(a.most < 3e-3);
    }
}

TEST_CASE("two shells of the second simulator too", "[oracle][slow]") {
    const Agreement a = compare("case_103");
    INFO("median " << a.median << ", 90 % below " << a.most);
    CHECK(a.median < 2e-3);
    CHECK(a.most < 4e-3);
}

TEST_CASE("its own error is far below the noise it adds", "[oracle]") {
    const Agreement a = compare("case_106", true);
    CHECK(a.median < 5e-4); // a tenth of the smallest noise
    CHECK(a.most < 1e-3);
}

TEST_CASE("its own error is far below the noise it adds, other protocols", "[oracle][slow]") {
    for (const char* name : {"case_101", "case_104"}) {
        const Agreement a = compare(name, true);
        INFO(name << ": median " << a.median << ", 90 % below " << a.most);
        CHECK(a.median < 5e-4);
        CHECK(a.most < 1e-3);
    }
}
