// Shell on a rigid cylinder (experiment E1) against the solved curves T2 (zero thickness, inextensible).

#include "tests/plugin/lab/session/simulation.h"

#include <algorithm>
#include <cstdio>

using namespace supercircle;
using namespace supercircle::test;

namespace {

lab::RunResult press(double phiBar, double mu, double thickness, double elements, double speed) {
    scene::Scene s = loadScene(
        "shell_on_cylinder",
        {{"phi_bar", phiBar}, {"mu", mu}, {"thickness", thickness}, {"elements", elements}, {"speed", speed}});
    keepFrequencies(s, thickness);
    return simulate(s);
}

std::string file(const char* branch, double phiBar, double mu) {
    char name[64];
    std::snprintf(name, sizeof name, "T2_%s_Phi%.2f_mu%.2f.csv", branch, phiBar, mu);
    return name;
}

} // namespace

TEST_CASE("a thin shell on a cylinder follows the solved curves", "[lab]") {
    for (const double phiBar : {0.65, 0.75})
        for (const double mu : {0.0, 0.2}) {
            INFO("phi_bar " << phiBar << ", mu " << mu);
            const lab::RunResult out = press(phiBar, mu, 5e-5, 31, 0.005);
            const auto [load, pull] = loadingAndUnloading(out.recording);
            const ForceCurve up = reference(file("load", phiBar, mu)), down = reference(file("pull", phiBar, mu));
            const double peak = up.top(), off = down.bottom();
            CAPTURE(load.top() / peak, pull.bottom() / off);
            const double seated = -2.0 * std::cos(M_PI * phiBar);
            // 31 arcs: 0.9 % at the peak; friction acts h/2 beside the centre line, h/R = 0.26 %
            const std::vector<double> points{0.1 * seated, 0.2 * seated, 0.4 * seated, 0.6 * seated, 0.9 * seated};
            const double loadError = deviation(load, up, points, peak), pullError = deviation(pull, down, points, -off);
            CAPTURE(loadError, pullError);
            CHECK(loadError < 0.02);
            CHECK(pullError < 0.02);
            CHECK(load.top() / peak == Approx(1.0).epsilon(0.02));
            CHECK(pull.bottom() / off == Approx(1.0).epsilon(0.02));
            CHECK(textOf(out.recording, "snap_type") == "I");
            checkInvariants(out.recording);
            if (mu > 0.0) { // relative to friction
                CHECK(std::abs(number(out.recording, "numerical_over_friction")) < 0.02);
                CHECK(std::abs(number(out.recording, "position_correction_over_friction")) < 1e-3);
            }
        }
}

TEST_CASE("a deep rough shell sticks, coils and unfolds abruptly", "[lab]") {
    // Rolling branch of the reference: the contact slips at f = 5.816 for mu 0.35 (5.280 at 0.3, 6.371 at 0.4), crown
    // at 1.2978 R. Then the shell snaps and the force rings by several B / R^2 within a tenth of a millisecond. The
    // unfolding force is the maximum before the force first falls by a tenth (decision 0175).
    const double exact = 5.816, drop = 1.0 - 2.0 * std::cos(0.9 * M_PI) - 1.2978;
    for (const double elements : {15.0, 31.0}) {
        INFO("elements " << elements);
        scene::Scene s = loadScene(
            "shell_on_cylinder",
            {{"phi_bar", 0.9}, {"mu", 0.35}, {"thickness", 5e-5}, {"elements", elements}, {"travel_over_R", 1.7}});
        keepFrequencies(s, 5e-5);
        const lab::RunResult out = simulate(s);
        const auto [load, pull] = loadingAndUnloading(out.recording);
        CHECK(textOf(out.recording, "snap_type") == "II");
        std::size_t top = 0;
        for (std::size_t i = 0; i < load.f.size(); ++i) {
            if (load.f[i] > load.f[top])
                top = i;
            if (load.f[top] > 1.0 && load.f[i] < 0.9 * load.f[top])
                break;
        }
        // Static elements alone (tests/supercircle/rod/test_unfolding.cpp): force within 3.3 and 0.8 %, place 4 and 0.7
        // % early.
        CHECK(load.f[top] == Approx(exact).epsilon(elements < 20 ? 0.04 : 0.01));
        CHECK(load.d[top] == Approx(drop).epsilon(elements < 20 ? 0.05 : 0.01));
        // The event and the picture of the peak are before the unfolding, not in the ringing after it.
        const double unit = number(out.recording, "peak_force_N") / number(out.recording, "peak_force_R2_over_B");
        const auto mark = std::find_if(out.recording.events.begin(), out.recording.events.end(),
                                       [](const record::Event& e) { return e.kind == "peak"; });
        REQUIRE(mark != out.recording.events.end());
        CHECK(mark->force / unit == Approx(load.f[top]).epsilon(0.02)); // averaged over 5 ms
        const record::Frame& shown = out.recording.frames.at(static_cast<std::size_t>(out.recording.keyFrames[1]));
        CHECK(shown.force / unit == Approx(load.f[top]).epsilon(0.05)); // pictures are 0.02 R apart or less
        checkInvariants(out.recording);
    }
}

TEST_CASE("the boundary between smooth and abrupt snap-fit lies where theory puts it", "[lab]") {
    // mu* = 0.363 at phi_bar 0.85 (linear), 0.351 (no re-stick); a strip below it still ends abrupt
    CHECK(textOf(press(0.85, 0.30, 5e-5, 15, 0.01).recording, "snap_type") == "I");
    CHECK(textOf(press(0.85, 0.40, 5e-5, 15, 0.01).recording, "snap_type") == "II");
}
