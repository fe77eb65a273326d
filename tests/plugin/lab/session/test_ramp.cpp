// A shell on an incline: rest without creep, slip with the acceleration of a block.

#include "tests/plugin/lab/session/simulation.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

void rest(double time) {
    for (const double angle : {0.0, 0.3}) {
        INFO("angle " << angle);
        const lab::RunResult out = simulate(loadScene("ramp", {{"time", time}, {"angle", angle}}));
        const double creep = number(out.recording, "creep_speed_m_s");
        CAPTURE(creep);
        CHECK(creep < 1e-9); // 60 nm in a minute, a ten-thousandth of the thickness
        checkInvariants(out.recording);
    }
}

} // namespace

TEST_CASE("a resting shell does not creep", "[lab]") {
    rest(5.0);
}
TEST_CASE("a resting shell does not creep in a minute", "[lab][slow]") {
    rest(60.0);
}

TEST_CASE("a shell slides down an incline with g (sin - mu cos)", "[lab]") {
    const double angle = 0.3;
    for (const double mu : {0.1, 0.2}) {
        INFO("mu " << mu);
        const double time = 0.8;
        const lab::RunResult out = simulate(loadScene("ramp", {{"time", time}, {"angle", angle}, {"mu", mu}}));
        const record::Frame &first = out.recording.frames.front(), &last = out.recording.frames.back();
        const double x = std::hypot(last.shells[0].start[0] - first.shells[0].start[0],
                                    last.shells[0].start[1] - first.shells[0].start[1]);
        const double a = 9.81 * (std::sin(angle) - mu * std::cos(angle)), t = last.time - first.time;
        CAPTURE(x / (0.5 * a * t * t));
        CHECK(x / (0.5 * a * t * t) ==
              Approx(1.0).epsilon(0.01)); // implicit Euler: dt / t, and the compliance of the shell
        checkInvariants(out.recording);
    }
}
