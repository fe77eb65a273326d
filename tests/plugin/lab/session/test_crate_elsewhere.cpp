// What lies elsewhere does not change how a shell moves, though a run solves everything as one problem.

#include "tests/plugin/lab/session/simulation.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Height that the first point of a ring of radius 0.5 m reaches after its drop from 0.5 m; with or without a crate
/// beside it.
double heightAfter(bool crate) {
    const std::string box =
        R"(, {"name": "crate", "type": 2, "position": {"x": 1.1, "y": 0.3}, "fixture": [{"name": "b", "density": 50,)"
        R"("friction": 0.3, "polygon": {"vertices": {"x": [-0.3, 0.3, 0.3, -0.3], "y": [-0.3, -0.3, 0.3, 0.3]}}}]})";
    const std::string text =
        R"({"gravity": {"x": 0, "y": -9.81}, "duration": 0.8, "body": [{"name": "floor", "type": 0, "fixture": [{)"
        R"("name": "f", "friction": 0.3, "chain": {"vertices": {"x": [8, -8], "y": [0, 0]}}}]})" +
        (crate ? box : std::string()) +
        R"(], "shell": [{"name": "ring", "position": {"x": 0, "y": 1.01}, "closed": true, "radius": 0.5,)"
        R"("thickness": 0.02, "width": 1, "density": 50, "young_modulus": 3.26e7, "mu": 0.3}]})";
    std::vector<scene::Problem> problems;
    const auto scene = scene::loadText(text, "ring.json", {}, problems);
    for (const scene::Problem& p : problems)
        UNSCOPED_INFO(p.toString());
    REQUIRE(scene);
    const lab::RunResult out = simulate(*scene);
    double highest = 0.0;
    for (const record::Frame& f : out.recording.frames)
        if (f.time > 0.45) // it meets the floor at 0.32 s
            highest = std::max(highest, f.shells[0].start[1]);
    return highest;
}

} // namespace

TEST_CASE("a crate that stands beside a ring does not change its rebound", "[lab]") {
    // The crate's own contacts with the floor take part in each step: with steps of first order it is 1.365.
    const double alone = heightAfter(false);
    CHECK(alone > 1.37);
    CHECK(heightAfter(true) == Approx(alone).epsilon(1e-3)); // steps of another length: 0.1 % of a rebound
}
