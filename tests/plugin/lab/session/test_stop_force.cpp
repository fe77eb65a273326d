// Segments that stop at a force end there, not at the end of the step that passes it.

#include "tests/plugin/lab/session/simulation.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Largest force of the series over `limit`, minus 1, and the same at the turning point.
std::pair<double, double> overshoot(const record::Recording& r, double limit) {
    const std::vector<double>& d = *r.series.find("displacement_m");
    const std::vector<double>& f = *r.series.find("force_N");
    const auto turn = static_cast<std::size_t>(std::max_element(d.begin(), d.end()) - d.begin());
    return {*std::max_element(f.begin(), f.begin() + static_cast<std::ptrdiff_t>(turn) + 1) / limit - 1.0,
            f[turn] / limit - 1.0};
}

} // namespace

TEST_CASE("a stack is squeezed to the stop force and no further", "[lab]") {
    for (const double limit : {0.4, 1.0, 2.5}) {
        INFO("limit " << limit);
        const lab::RunResult out = simulate(loadScene("stack30", {{"shells", 6}, {"max_force", limit}}));
        const auto [peak, end] = overshoot(out.recording, limit);
        CHECK(end >= 0.0);
        CHECK(peak <= 1e-3); // what is promised
        CHECK(peak == end);
        CHECK(std::abs(number(out.recording, "peak_force_N") / limit - 1.0) <= 1e-3);
        checkInvariants(out.recording);
    }
}

TEST_CASE("the cut to the stop force raises no vibration, whatever the steps", "[lab]") {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        INFO("seed " << seed);
        scene::Scene s = loadScene("stack30", {{"shells", 8}, {"max_force", 1.5}});
        s.numerics.dt_max = 0.03; // R / 128 of travel: steps that pass the limit by far
        lab::RunOptions options;
        options.seed = seed;
        const lab::RunResult out = simulate(s, options);
        const std::vector<double>& f = *out.recording.series.find("force_N");
        CHECK(*std::max_element(f.begin(), f.end()) <= 1.5 * 1.001);
        CHECK(overshoot(out.recording, 1.5).second >= 0.0);
    }
}

TEST_CASE("two shells are pushed to the stop force and no further", "[lab]") {
    for (const double limit : {0.02, 0.1}) {
        INFO("limit " << limit);
        scene::Scene s = loadScene("two_shells", {{"phi_bar", 0.87}, {"mu", 0.5}});
        REQUIRE(s.protocol);
        s.protocol->segments.front().stop_when.force = limit;
        const lab::RunResult out = simulate(s);
        const auto [peak, end] = overshoot(out.recording, limit);
        CHECK(end >= 0.0);
        CHECK(peak <= 1e-3);
        checkInvariants(out.recording);
    }
}

TEST_CASE("a fixed step is cut to the stop force too", "[lab]") {
    lab::RunOptions options;
    options.fixedDt = 2e-3;
    const lab::RunResult out = simulate(loadScene("stack30", {{"shells", 3}, {"max_force", 0.3}}), options);
    const auto [peak, end] = overshoot(out.recording, 0.3);
    CHECK(end >= 0.0);
    CHECK(peak <= 1e-3);
}

TEST_CASE("a run goes on and ends where the force leaps past the stop force", "[lab]") {
    // At 4.95 N a shell snaps: no step ends at 5 N. The run once went back to a kept state there, for ever.
    lab::RunOptions options;
    options.seed = 69;
    const lab::RunResult out =
        simulate(loadScene("stack30", {{"shells", 5}, {"width", 0.08}, {"phi_bar", 0.9}}), options);
    const std::vector<double>& t = *out.recording.series.find("time_s");
    CHECK(std::is_sorted(t.begin(), t.end()));
    CHECK(overshoot(out.recording, 5.0).second >= 0.0);
    checkInvariants(out.recording);
}
