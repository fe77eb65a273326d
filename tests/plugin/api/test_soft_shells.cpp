// Ropes, scarves and whips: strips so soft that they move faster than waves of their material would allow. No guard
// knows such a speed.

#include "tests/plugin/api/support.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Of 0.1 kg/m and a bending modulus of 1e-3 N m^2, whatever its thickness.
ShellDef soft(double length, Point middle, double angle, double thickness, int elements) {
    constexpr double kLine = 0.1, kModulus = 1e-3;
    ShellDef d = strip(length, middle, angle, 1.0, elements);
    d.thickness = thickness;
    d.width = 1.0;
    d.density = kLine / thickness;
    d.young_modulus = 12.0 * kModulus / (thickness * thickness * thickness);
    return d;
}

} // namespace

TEST_CASE("a rope that swings down and cracks like a whip is no runaway, however thick", "[plugin][soft]") {
    const Quality quality = GENERATE(Quality::Laboratory, Quality::Game);
    const double thickness = GENERATE(0.02, 0.005, 0.001);
    CAPTURE(static_cast<int>(quality), thickness);
    auto host = emptyHost(kG);
    Shells shells(host);
    REQUIRE(shells.set_quality(quality));
    const ShellHandle rope = *shells.create(soft(3.0, {1.5, 0.0}, 0.0, thickness, 30));
    REQUIRE(shells.create_pin(rope, 0.0));
    double lowest = 0.0;
    for (int i = 0; i < 90; ++i) {
        advance(shells, host.get(), kFrame, 1);
        CHECK(shells.events().quarantined.empty());
        lowest = std::min(lowest, pointAt(shells, 0, 1.0).y());
    }
    CHECK(lowest < -2.7); // it hangs on 3 m
    CHECK(lowest > -3.0 - 1e-6);
}

TEST_CASE("a thrown strip moves on straight at any speed", "[plugin][soft]") {
    const Quality quality = GENERATE(Quality::Laboratory, Quality::Game);
    const double speed = GENERATE(20.0, 1000.0, 1e5);
    CAPTURE(static_cast<int>(quality), speed);
    auto host = emptyHost();
    Shells shells(host);
    REQUIRE(shells.set_quality(quality));
    ShellDef d = soft(1.0, {0.0, 0.0}, 0.3, 0.02, 10);
    d.velocity = {speed, 0.0};
    REQUIRE(shells.create(d));
    advance(shells, host.get(), kFrame, 60);
    CHECK(shells.events().quarantined.empty());
    CHECK(centreOf(shells, 0).x() == Approx(speed * shells.time()).epsilon(1e-12));
    CHECK(angleAt(shells, 0, 0.5) == Approx(0.3).margin(1e-9));
}

TEST_CASE("a scarf on a character that turns round follows it, however thick", "[plugin][soft]") {
    const Quality quality = GENERATE(Quality::Laboratory, Quality::Game);
    const double thickness = GENERATE(0.02, 0.005, 0.001), speed = GENERATE(3.0, 10.0);
    CAPTURE(static_cast<int>(quality), thickness, speed);
    auto host = emptyHost(kG);
    FakeHost::Body& character = host->add(1, "character", {0.0, 5.0});
    character.kinematic = character.state.moving = true;
    Shells shells(host);
    REQUIRE(shells.set_quality(quality));
    const ShellHandle scarf = *shells.create(soft(1.2, {-0.95, 5.0}, M_PI, thickness, 12));
    JointDef j;
    j.kind = JointKind::Pin;
    j.shell = scarf;
    j.arc_fraction = 0.0;
    j.body = 1;
    REQUIRE(shells.create_joint(j));
    double lag = 0.0;
    for (int i = 0; i < 120; ++i) {
        host->bodies.at(1).state.velocity.x() = (i / 30) % 2 == 0 ? speed : -speed;
        advance(shells, host.get(), kFrame, 1);
        CHECK(shells.events().quarantined.empty());
        lag = std::max(lag, (pointAt(shells, 0, 0.0) - host->bodies.at(1).state.centre - Vec2(-0.35, 0.0)).norm());
    }
    CHECK(lag < 0.02 * thickness);
}

TEST_CASE("a shell whose elements turn more than once is a runaway", "[plugin][soft]") {
    // A torque that winds each of three arcs up by 1.2 turns.
    Shells shells(nullptr);
    REQUIRE(shells.set_quality(Quality::Game));
    ShellDef d = soft(1.0, {0.5, 0.0}, 0.0, 0.001, 3);
    d.mask = 0; // it does not touch itself
    const ShellHandle a = *shells.create(d);
    REQUIRE(shells.create_clamp(a, 0.0));
    REQUIRE(shells.create_force(a, 1.0, {}, 1e-3 * 3.0 * 1.2 * 2.0 * M_PI));
    bool out = false;
    for (int i = 0; i < 600 && !out; ++i) {
        const FrameReport r = shells.pre_step(kFrame);
        REQUIRE(shells.post_step());
        out = !r.quarantined.empty();
        if (out)
            CHECK(r.quarantined.front().reason == QuarantineReason::Runaway);
    }
    CHECK(out);
}
