#pragma once
#include "plugin/identification/replay/compare.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"

#include <catch2/catch.hpp>
#include <string>

namespace replaytest {

using namespace supercircle;

inline std::string baselinePath(int number) {
    return std::string(SC_TEST_DATA) + "/recordings/baseline/case_" + std::to_string(number) + "/experiment.json";
}

inline experiment::Experiment baseline(int number) {
    auto loaded = experiment::load(baselinePath(number));
    INFO(loaded.error());
    REQUIRE(loaded);
    return *loaded;
}

inline replay::Simulated simulated(const experiment::Experiment& e, const replay::Parameters& p,
                                   const replay::Resolution& r = replay::Resolution::coarse()) {
    replay::Simulated s = replay::simulate(e, 0, p, r);
    INFO(s.failure);
    REQUIRE(s.failure.empty());
    return s;
}

/// Force at a time, interpolated.
inline double forceAt(const replay::Simulated& s, double time) {
    const std::vector<double>& t = s.readings.time;
    std::size_t i = 1;
    while (i + 1 < t.size() && t[i] < time)
        ++i;
    const double share = (time - t[i - 1]) / (t[i] - t[i - 1]);
    return (1.0 - share) * s.readings.force[i - 1] + share * s.readings.force[i];
}

} // namespace replaytest
