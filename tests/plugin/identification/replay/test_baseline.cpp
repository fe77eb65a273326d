// Comparison with the reference simulator on six experiments without noise: the level of disagreement between two kinds
// of simulators (decision 0153).

#include "tests/plugin/identification/replay/support.h"

#include <cmath>

using namespace replaytest;

namespace {

/// Required agreement of one case: shares of the peak force, and metres.
struct Demand {
    int number;
    double rms, largest;
    double marker;         ///< m, largest distance, without excluded rows
    std::size_t landmarks; ///< number of jumps in both curves
    double landmarkShift;  ///< m
};

/// Compliance of both simulators, m/N (decision 0153).
double seriesCompliance(const experiment::Experiment& e) {
    switch (e.protocol) {
    case experiment::Protocol::StripOnRigidFloor:
        return 0.0; // see contactCompliance()
    case experiment::Protocol::ArchBetweenPlates:
        return 1e-5 + 0.5e-5; // contact of the plate, and two feet in parallel
    case experiment::Protocol::ShellOnRigidCylinder:
    case experiment::Protocol::TwoShells:
    default: // no baseline
        break;
    }
    return 0.5e-5; // two contacts in parallel
}

/// Compliance of the contact of a strip, m/N: contact and axial stretch.
double contactCompliance(const experiment::Experiment& e) {
    return replay::nominal(e).touchCompliance + (e.protocol == experiment::Protocol::StripOnRigidFloor ? 1e-5 : 0.0);
}

void check(const Demand& d, const replay::Resolution& resolution) {
    const experiment::Experiment e = baseline(d.number);
    replay::Parameters p = replay::nominal(e);
    p.seriesCompliance = seriesCompliance(e);
    p.touchCompliance = contactCompliance(e);
    const replay::Simulated s = simulated(e, p, resolution);
    const replay::Comparison c = replay::compare(e.runs[0], s);
    INFO("case " << d.number << ": rms " << 100.0 * c.rmse / c.peakRecorded << " %, largest "
                 << 100.0 * c.maxError / c.peakRecorded << " % at " << c.maxErrorAt << " s, left out "
                 << 100.0 * c.excludedFraction << " %, markers " << 1e3 * c.markerMax << " mm, cpu " << s.cpuSeconds
                 << " s");
    CHECK(s.unconverged == 0);
    CHECK(c.rmse < d.rms * c.peakRecorded);
    CHECK(c.maxError < d.largest * c.peakRecorded);
    CHECK(c.markerMax < d.marker);
    CHECK(c.excludedFraction < 0.08);
    CHECK(c.matches.size() >= d.landmarks);
    for (const auto& [i, j] : c.matches)
        CHECK(std::abs(c.recorded[i].displacement - c.simulated[j].displacement) < d.landmarkShift);
}

} // namespace

TEST_CASE("baselines within one percent at fine fidelity", "[replay]") {
    // Tolerance of rms: 1 %. Larger maximum errors: 102 by contact nodes 1 mm apart, 105 by stick-slip of the friction
    // springs (0.03 N). The force at the slip-off of 105 changes by 0.02 % per 30 um, so its time is not sharper.
    check({101, 0.01, 0.01, 2e-5, 1, 1e-5}, replay::Resolution::fine());
    check({102, 0.01, 0.03, 1e-4, 0, 0.0}, replay::Resolution::fine());
    check({103, 0.01, 0.01, 4e-5, 1, 1e-5}, replay::Resolution::fine());
    check({104, 0.01, 0.02, 2e-4, 1, 1e-5}, replay::Resolution::fine());
    check({105, 0.01, 0.03, 3e-4, 2, 5e-5}, replay::Resolution::fine());
    check({106, 0.01, 0.01, 2e-5, 0, 0.0}, replay::Resolution::fine());
}

TEST_CASE("baselines within a few percent at coarse fidelity", "[replay]") {
    for (const int number : {101, 103, 104, 105, 106})
        check({number, 0.015, 0.04, 4e-4, 0, 5e-5}, replay::Resolution::coarse());
    check({102, 0.03, 0.06, 2e-4, 0, 0.0}, replay::Resolution::coarse()); // coiled shell: 15 arcs are 2 % too stiff
}

TEST_CASE("baselines at finer resolution", "[replay][slow]") {
    replay::Resolution fine = replay::Resolution::fine();
    fine.elements = 61;
    fine.travelMax = 1e-5;
    fine.positionTolerance = 5e-8;
    check({101, 0.002, 0.005, 1.5e-5, 1, 1e-5}, fine);
    check({102, 0.004, 0.02, 1e-4, 0, 0.0}, fine);
    check({103, 0.0025, 0.006, 3e-5, 1, 1e-5}, fine);
    check({104, 0.0025, 0.01, 2e-4, 1, 1e-5}, fine);
    check({105, 0.004, 0.03, 3e-4, 2, 5e-5}, fine);
    check({106, 0.0015, 0.01, 1.5e-5, 0, 0.0}, fine);
}
