// A published drop: a folded chain of which one end is let go.

#include "tests/supercircle/step/setup.h"

using namespace supercircle;
using namespace supercircle::test;

TEST_CASE("the free end of a folded chain falls faster than freely", "[step][vibration]") {
    // M. G. Calkin, R. H. March, Am. J. Phys. 57, 154 (1989): both ends of a chain hang side by side, and one is let
    // go. Its energy stays in the arm that falls, so that the end is at the bottom after 0.847 of the time of a free
    // fall, int_0^1 sqrt((1 - s) / (s (2 - s))) ds / sqrt(2), in the experiment and in theory. Frames are 0.9 % of
    // that.
    const bool game = GENERATE(false, true);
    constexpr int kArcs = 51, kBend = 3; // the half turn between the arms: radius 1.9 % of the length
    rod::RodDefinition d;
    d.length = 1.0;
    d.thickness = 2e-3;
    d.linearMass = 0.1;
    d.bendingModulus = 1e-7; // of a chain: ten times as much takes 0.2 %
    d.naturalCurvature.assign(kArcs, 0.0);
    for (int i = (kArcs - kBend) / 2; i < (kArcs + kBend) / 2; ++i)
        d.naturalCurvature[static_cast<std::size_t>(i)] = M_PI * kArcs / (kBend * d.length);
    step::World w;
    w.gravity = {0.0, -kG};
    put(w, d, Vec2::Zero(), 0.0, 0.3);
    step::Hold hold;
    hold.clamped = false;
    hold.target.point = w.rods[0].kin.node(0);
    w.rods[0].holds.push_back(hold);
    step::Settings s = game ? step::gameSettings() : step::Settings{};
    s.dampingRatio = 0.0;
    step::Stepper stepper(s);
    const double top = hold.target.point.y(), fall = std::sqrt(2.0 * d.length / kG);
    double lowest = top, when = 0.0;
    while (w.time < fall) {
        REQUIRE(stepper.advance(w, 1.0 / 240.0, nullptr, {}).failure.empty());
        const double y = w.rods[0].kin.node(kArcs).y();
        when = y < lowest ? w.time : when;
        lowest = std::min(lowest, y);
    }
    CHECK(when / fall == Approx(0.847).epsilon(0.01));
    CHECK(top - lowest == Approx(d.length).epsilon(0.02)); // straight but for what the bend still holds
    CHECK(std::abs(w.energyBalance.residual()) < 1e-9 * d.linearMass * d.length * d.length * kG);
}
