// The same problem in other sizes: R from 1 mm to 100 m.
//
// With all lengths times a, and equal material (E, rho, mu) and speeds, time scales with a, gravity with 1/a, force
// with a^2 (E w h^3 / R^2) and energy with a^3: the dimensionless problem stays the same. Absolute lengths, times,
// speeds or forces in the numerics would break this.

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/stepper.h"
#include "tests/support/fake_host.h"

#include <catch2/catch.hpp>

using namespace supercircle;
using namespace supercircle::test;

namespace {

struct ForceCurve {
    std::vector<double> force;  ///< on the plate, in B / R^2
    std::vector<double> energy; ///< stored, in B / R
    std::size_t touches = 0, snaps = 0;
};

/// A plate comes down on a dome (or on a stack of two) at 0.1 m/s, at first fast, and goes back.
ForceCurve press(double R, int shellCount) {
    const double a = R / 0.02; // the settings' defaults are meant for shells of some centimetres
    auto host = std::make_shared<FakeHost>();
    host->g = {0.0, -9.81 / a};
    host->add(1, "ground", {0.0, -10.0 * R}).outlines.push_back(FakeHost::box(1, 50.0 * R, 10.0 * R, 0.35));
    const double top = shellCount == 1 ? 1.0 : 1.6;
    host->add(2, "plate", {0.0, (top + 1.05) * R}).outlines.push_back(FakeHost::box(2, 3.0 * R, R, 0.35));
    host->bodies[2].state.moving = true;
    Shells shells(host);
    step::Settings& s = shells.stepper().settings();
    s.dtMax *= a;
    s.dtMin *= a;
    REQUIRE(shells.attach_to_crosshead("plate"));
    for (int i = 0; i < shellCount; ++i) {
        ShellDef d;
        d.radius = R;
        d.thickness = R / 40.0;
        d.width = R / 2.0;
        d.phi_bar = 0.5;
        d.elements = 12;
        d.angle = M_PI;
        d.position = {0.0, (1.02 + 0.55 * i) * R};
        if (i > 0)
            d.radius = 1.4 * R; // a wider dome sits on the first one
        REQUIRE(shells.create(d));
    }
    ShellDef first;
    const double B = 2.2e9 * (R / 2.0) * std::pow(R / 40.0, 3) / 12.0;
    ForceCurve c;
    const int frames = 400;
    const double dt = 1e-3 * a, speed = 2.0 * 0.7 * R / (frames * dt); // 0.7 R down and up
    for (int f = 0; f < frames; ++f) {
        REQUIRE(shells.set_crosshead_velocity({0.0, f < frames / 2 ? -speed : speed}));
        const FrameReport r = shells.pre_step(dt);
        REQUIRE(r.failure.empty());
        host->step(r.advanced);
        REQUIRE(shells.post_step());
        c.force.push_back(shells.crosshead_force().y * R * R / B);
        c.energy.push_back(shells.energy_balance().bending * R / B);
        c.touches += shells.events().contact_begin.size();
        c.snaps += shells.events().snap_begin.size();
    }
    return c;
}

void compare(const ForceCurve& x, const ForceCurve& y, double share) {
    double top = 0.0, worst = 0.0, topEnergy = 0.0, worstEnergy = 0.0;
    for (std::size_t i = 0; i < x.force.size(); ++i) {
        top = std::max(top, std::abs(x.force[i]));
        worst = std::max(worst, std::abs(x.force[i] - y.force[i]));
        topEnergy = std::max(topEnergy, x.energy[i]);
        worstEnergy = std::max(worstEnergy, std::abs(x.energy[i] - y.energy[i]));
    }
    CHECK(top > 0.5); // the plate does press
    CAPTURE(worst / top, worstEnergy / topEnergy, share);
    CHECK(worst <= share * top);
    CHECK(worstEnergy <= share * topEnergy);
    CHECK(x.touches == y.touches);
    CHECK(x.snaps == y.snaps);
}

} // namespace

TEST_CASE("the dimensionless force curve is independent of the size of the shell", "[plugin][scale]") {
    const ForceCurve reference = press(0.05, 1);
    for (const double R : {0.001, 1.0, 100.0}) {
        INFO("R = " << R << " m");
        compare(reference, press(R, 1), 1e-9);
    }
}

TEST_CASE("sizes that differ by a power of two give equal curves", "[plugin][scale]") {
    // Multiplying by a power of two is exact: differences show absolute numbers in the numerics.
    const ForceCurve reference = press(0.02, 2), twice = press(0.04, 2);
    compare(reference, twice, 1e-6);
}
