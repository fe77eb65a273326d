// Quarantine: the reason, the report, and the ways back.

#include "tests/plugin/api/support.h"

#include <catch2/catch.hpp>

using namespace supercircle;
using namespace supercircle::test;

namespace {

struct Sick {
    std::shared_ptr<FakeHost> host = std::make_shared<FakeHost>();
    Shells shells{host};
    ShellHandle good, bad;

    Sick() {
        host->g = Vec2(0.0, -kG);
        host->addGround(1, 0.5);
        good = shells.create(dome()).value();
        ShellDef d = dome();
        d.position.x = 0.3;
        bad = shells.create(d).value();
        frame();
        shells.world().rods[1].v[0] = kNan;
    }
    FrameReport frame() {
        const FrameReport r = shells.pre_step(0.01);
        REQUIRE(r.failure.empty());
        host->step(r.advanced);
        REQUIRE(shells.post_step());
        return r;
    }
};

} // namespace

TEST_CASE("a report names quarantined shells with the reason until they are back", "[plugin][quarantine]") {
    Sick s;
    const double then = s.shells.time();
    for (int i = 0; i < 3; ++i) {
        const FrameReport r = s.frame();
        REQUIRE(r.quarantined.size() == 1);
        CHECK(r.quarantined[0].shell == s.bad);
        CHECK(r.quarantined[0].reason == QuarantineReason::NotFinite);
        CHECK(r.quarantined[0].time == Approx(then));
        CHECK(std::string(message(r.quarantined[0].reason)) == "its numbers were not finite");
        CHECK(s.shells.events().quarantined.size() == (i == 0 ? 1U : 0U));
    }
    CHECK(s.shells.recovery().policy == Recovery::Stay);
    REQUIRE(s.shells.teleport(s.bad, {0.3, 0.1}, M_PI));
    CHECK(s.frame().quarantined.empty());
}

TEST_CASE("a quarantined shell is released after the time its user sets", "[plugin][quarantine]") {
    Sick s;
    REQUIRE(s.shells.set_recovery({Recovery::Release, 0.095}));
    CHECK(s.shells.recovery().policy == Recovery::Release);
    CHECK(s.shells.recovery().after == 0.095);
    int frozen = 0;
    while (!s.frame().quarantined.empty() && frozen < 100)
        ++frozen;
    CHECK(frozen == 10);
    CHECK_FALSE(s.shells.state(s.bad)->quarantined);
    for (int i = 0; i < 50; ++i)
        CHECK(s.frame().quarantined.empty());
    CHECK(s.shells.state(s.bad)->box.lower.y > -1e-4); // it stands on the floor again
    CHECK_FALSE(s.shells.set_recovery({Recovery::Release, kNan}));
    CHECK_FALSE(s.shells.set_recovery({Recovery::Release, -1.0}));
    CHECK(s.shells.recovery().after == 0.095);
}

TEST_CASE("recovery is part of a saved state, of the log and of every quality", "[plugin][quarantine]") {
    Sick s;
    const std::uint64_t before = s.shells.hash();
    REQUIRE(s.shells.start_log());
    REQUIRE(s.shells.set_recovery({Recovery::Release, 0.05}));
    CHECK(s.shells.hash() != before);
    REQUIRE(s.shells.set_quality(Quality::Game));
    CHECK(s.shells.recovery().after == 0.05);
    const Snapshot saved = Snapshot::from_bytes(s.shells.save().bytes()).value();
    REQUIRE(s.shells.set_recovery({}));
    REQUIRE(s.shells.restore(saved));
    CHECK(s.shells.recovery().after == 0.05);
    Shells other{std::make_shared<FakeHost>()};
    REQUIRE(other.replay(s.shells.log()));
    CHECK(other.recovery().after == 0.05);
}

TEST_CASE("shells that overlap do not fall asleep", "[plugin][quarantine]") {
    Shells shells{nullptr};
    const ShellHandle a = shells.create(strip(0.2, {0.0, 0.0})).value();
    const ShellHandle b = shells.create(strip(0.2, {0.0, 0.02}, M_PI / 2.0)).value();
    REQUIRE(shells.set_sleep({true, 0.1, 0.1}));
    advance(shells, nullptr, 0.01, 1);
    REQUIRE(shells.events().overlapping.size() == 1);
    CHECK(shells.events().overlapping[0].a == a);
    CHECK(shells.events().overlapping[0].b == b);
    int frames = 0; // they rest against the push of 20 thicknesses a second, and creep apart
    while (!shells.world().overlaps.empty() && ++frames < 5000) {
        advance(shells, nullptr, 0.01, 1);
        if (!shells.world().overlaps.empty())
            CHECK_FALSE(shells.asleep(b).value());
    }
    CHECK(shells.world().overlaps.empty());
    REQUIRE(shells.set_velocity(a, {}));
    REQUIRE(shells.set_velocity(b, {}));
    advance(shells, nullptr, 0.01, 50);
    CHECK(shells.asleep(b).value());
}
