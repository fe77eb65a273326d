// Two simulators of different kinds on the same six experiments, without noise: the floor of disagreement.
//
// Where the last per mille come from (each was switched on or refined alone, 61 elements, steps of 10 um):
// - their contact force acts on the centre line (contactArm 0; with the force on the surface of a round end a sticking
//   tip rolls: markers off by up to 0.31 mm, slip-off 0.25 mm late, plateau of the strips 1 % too high);
// - their contacts give by 1e-5 m/N each and their strip stretches: 9 % at the steep rise of a strip pressed lengthwise
//   (1 N within 0.1 mm), 1.7 % with a series compliance of 1.55e-5 m/N (10 um/N contact + 5.5 um/N stretch);
// - their shells are polygons clamped at a corner-free segment: markers differ by 3 to 10 um before any contact and
//   first contact comes 5 um later, 0.2 % of the peak at the steepest place;
// - their contacts are nodes 1 mm apart: a tip that lies down (102) rolls on in one jump at 18.64 mm where ours starts
//   to roll at 17.85 mm; in between 2.3 % of the peak;
// - their friction is a spring of 2 um: reversals of sliding take 10 um longer, 3 % of the peak in one sample;
// - ours: 31 elements instead of 121 add 0.05 % where the shell slides and 0.5 % in the coiled shell of 102; the force
//   is first order in the step, 0.1 % at 20 um of travel.

#include "tests/plugin/identification/replay/support.h"

#include <cmath>

using namespace replaytest;

namespace {

/// What is asked of one case. Shares of the peak force, and metres.
struct Demand {
    int number;
    double rms, largest;
    double marker;         ///< largest distance outside the windows, m
    std::size_t landmarks; ///< jumps found in both curves
    double landmarkShift;  ///< m
};

/// What both give by, m/N (see above); without it the strips' steep rise says nothing about anything else.
double give(const experiment::Experiment& e) {
    switch (e.protocol) {
    case experiment::Protocol::StripOnRigidFloor:
        return 0.0; // see touch()
    case experiment::Protocol::ArchBetweenPlates:
        return 1e-5 + 0.5e-5; // the plate's contact, and two feet side by side
    case experiment::Protocol::ShellOnRigidCylinder:
    case experiment::Protocol::TwoShells:
    default: // not among the baselines
        break;
    }
    return 0.5e-5; // two contacts side by side
}

/// What a touch of a strip gives, m/N: the contact and the stretch of the strip.
double touch(const experiment::Experiment& e) {
    return replay::nominal(e).touchCompliance + (e.protocol == experiment::Protocol::StripOnRigidFloor ? 1e-5 : 0.0);
}

void check(const Demand& d, const replay::Resolution& resolution) {
    const experiment::Experiment e = baseline(d.number);
    replay::Parameters p = replay::nominal(e);
    p.seriesCompliance = give(e);
    p.touchCompliance = touch(e);
    const replay::Simulated s = simulated(e, p, resolution);
    const replay::Comparison c = replay::compare(e.runs[0], s);
    INFO("case " << d.number << ": rms " << 100.0 * c.rmse / c.peakRecorded << " %, largest "
                 << 100.0 * c.maxError / c.peakRecorded << " % at " << c.maxErrorAt << " s, left out "
                 << 100.0 * c.leftOut << " %, markers " << 1e3 * c.markerMax << " mm, cpu " << s.cpuSeconds << " s");
    CHECK(s.unconverged == 0);
    CHECK(c.rmse < d.rms * c.peakRecorded);
    CHECK(c.maxError < d.largest * c.peakRecorded);
    CHECK(c.markerMax < d.marker);
    CHECK(c.leftOut < 0.08);
    CHECK(c.matches.size() >= d.landmarks);
    for (const auto& [i, j] : c.matches)
        CHECK(std::abs(c.recorded[i].displacement - c.simulated[j].displacement) < d.landmarkShift);
}

} // namespace

TEST_CASE("baselines within one percent at the full resolution", "[replay]") {
    // rms: 1 % is the aim, what is left is explained above. Largest: 102 by the node that lies down late, 105 by the
    // chatter of their tip on the way back (0.03 N, a stick-slip of their friction springs). Slip-off of 105: the force
    // changes by 0.02 % per 30 um there, so the instant is not sharper than that.
    check({101, 0.01, 0.01, 2e-5, 1, 1e-5}, replay::Resolution::full());
    check({102, 0.01, 0.03, 1e-4, 0, 0.0}, replay::Resolution::full());
    check({103, 0.01, 0.01, 4e-5, 1, 1e-5}, replay::Resolution::full());
    check({104, 0.01, 0.02, 2e-4, 1, 1e-5}, replay::Resolution::full());
    check({105, 0.01, 0.03, 3e-4, 2, 5e-5}, replay::Resolution::full());
    check({106, 0.01, 0.01, 2e-5, 0, 0.0}, replay::Resolution::full());
}

TEST_CASE("the coarse resolution follows within a few percent", "[replay]") {
    for (const int number : {101, 103, 104, 105, 106})
        check({number, 0.015, 0.04, 4e-4, 0, 5e-5}, replay::Resolution::coarse());
    check({102, 0.03, 0.06, 2e-4, 0, 0.0}, replay::Resolution::coarse()); // coiled shell: 15 arcs are 2 % too stiff
}

TEST_CASE("baselines, finer", "[replay][slow]") {
    replay::Resolution fine = replay::Resolution::full();
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
