// A jump-through ledge in a run: it bars only the way from its front.

#include "tests/plugin/lab/session/simulation.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Where the shell's first end is after 2 s, m. `right`: the chain runs to the right, so that it is solid below.
double heightAfter(bool right, double y, double velocity) {
    const std::string ends = right ? "[-5, 5]" : "[5, -5]";
    const std::string text =
        R"({"gravity": {"x": 0, "y": -10}, "duration": 2, "body": [{"name": "ledge", "type": 0, "fixture": [{"name": "c",)"
        R"("friction": 0.3, "chain": {"vertices": {"x": )" +
        ends + R"(, "y": [0, 0]}}}]}], "shell": [{"name": "s", "position": {"x": 0, "y": )" + std::to_string(y) +
        R"(}, "angle": {"expr": "pi"}, "velocity": {"x": 0, "y": )" + std::to_string(velocity) +
        R"(}, "radius": 1.0, "thickness": 0.026, "width": 1.0, "density": 20, "young_modulus": 1800000.0, "mu": 0.4}]})";
    std::vector<scene::Problem> problems;
    const auto scene = scene::loadText(text, "ledge.json", {}, problems);
    for (const scene::Problem& p : problems)
        UNSCOPED_INFO(p.toString());
    REQUIRE(scene);
    const lab::RunResult out = simulate(*scene);
    return out.recording.frames.back().shells[0].start[1];
}

} // namespace

TEST_CASE("a run lets a shell through a one-sided edge from behind", "[lab]") {
    // Thrown up through a ledge that is solid above, it falls back onto it: its ends stand on the edge, half a
    // thickness above, or lie at most a shell's size higher.
    const double above = heightAfter(false, -1.5, 9.0);
    CHECK(above > 0.0);
    CHECK(above < 2.5);
    // Dropped onto the empty side it falls freely: 2 s from at most 3 m.
    CHECK(heightAfter(true, 3.0, 0.0) < -10.0);
}
