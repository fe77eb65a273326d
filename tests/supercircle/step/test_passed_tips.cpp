// Nodes that pass the tip of another rod within a step: supercircle/step/contacts/passed_tips.h.

#include "supercircle/contact/feature_id.h"
#include "supercircle/step/contacts/passed_tips.h"
#include "tests/supercircle/contact/shells.h"

#include <catch2/catch.hpp>

using namespace supercircle;
using namespace contact_test;

namespace {

/// A strip with nodes at every 10 mm of x, 0.51 mm above another one that ends at x = 20 mm, both along x.
std::vector<RodCurve> strips(double shift) {
    return {makeCurve(1, Vec2(shift, 0.51e-3), 0.0, std::vector<double>(4, 0.0), 10e-3),
            makeCurve(2, Vec2(-40e-3, 0.0), 0.0, std::vector<double>(6, 0.0), 10e-3)};
}

/// What is left of the candidates after half a step of `way` m of the upper strip, found at its start.
std::vector<Candidate> left(double start, double way) {
    std::vector<Candidate> found;
    Detector().detect(strips(start), {}, {1e-3}, found);
    const std::vector<RodCurve> middle = strips(start + 0.5 * way);
    std::vector<Candidate> framed = found;
    std::vector<double> gaps;
    for (Candidate& c : framed) {
        REQUIRE(updateCandidate(c, middle, {}));
        gaps.push_back(static_cast<double>(gaps.size()));
    }
    step::leaveOutPassedTips(found, middle, framed, gaps);
    REQUIRE(gaps.size() == framed.size());
    for (std::size_t i = 0; i < framed.size(); ++i) // each keeps its own gap
        CHECK(found[static_cast<std::size_t>(gaps[i])].id == framed[i].id);
    return framed;
}

bool holdsNodeAt(const std::vector<Candidate>& list, double s) {
    return std::any_of(list.begin(), list.end(), [&](const Candidate& c) {
        return featureOf(c.id) == Feature::SampleRod && c.a.rod == 0 && std::abs(c.a.s - s) < 1e-9;
    });
}

bool holdsTip(const std::vector<Candidate>& list) {
    return std::any_of(list.begin(), list.end(), [](const Candidate& c) { return c.a.rod == 1 && c.a.s > 59e-3; });
}

} // namespace

TEST_CASE("a node that passes a tip within the step is left to the tip", "[step]") {
    // The second node, at s = 10 mm, is 0.1 mm before the tip of the lower strip.
    const double before = 9.9e-3;
    CHECK(holdsNodeAt(left(before, 0.0), 10e-3));
    CHECK(holdsNodeAt(left(before, 0.09e-3), 10e-3));
    CHECK_FALSE(holdsNodeAt(left(before, 0.11e-3), 10e-3)); // in mid-step it is still before the tip
    CHECK_FALSE(holdsNodeAt(left(before, 0.5e-3), 10e-3));  // in mid-step it is beyond
    CHECK(holdsNodeAt(left(before, -0.5e-3), 10e-3));
    for (const double way : {0.09e-3, 0.11e-3, 0.5e-3}) {
        const std::vector<Candidate> all = left(before, way);
        CHECK(holdsTip(all));         // it bears what the node did
        CHECK(holdsNodeAt(all, 0.0)); // a tip is no node: no other candidate stands for it
        CHECK(holdsNodeAt(all, 10e-3) == (way < 0.1e-3));
    }
}
