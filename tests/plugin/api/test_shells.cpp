// Class Shells: misused handles, reasons of failures, failed calls change nothing.

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/stepper.h"
#include "tests/plugin/api/support.h"
#include "tests/support/fake_host.h"

#include <catch2/catch.hpp>
#include <limits>
#include <stdexcept>

using namespace supercircle;
using namespace supercircle::test;

namespace {

std::shared_ptr<FakeHost> hostWithPlate() {
    auto host = groundHost();
    host->add(2, "plate", {0.0, 1.0}).outlines.push_back(FakeHost::box(2, 0.1, 0.01, 0.35));
    return host;
}

ShellDef above(double x, double y) {
    ShellDef d;
    d.position = {x, y};
    return d;
}

/// A host that throws in every query of a body.
class Broken : public FakeHost {
public:
    [[nodiscard]] bool state(step::BodyId, step::BodyState&) const override {
        throw std::runtime_error("host is broken");
    }
};

} // namespace

TEST_CASE("a shell has the dimensions of its definition", "[plugin]") {
    Shells shells(nullptr);
    const auto made = shells.create(ShellDef{});
    REQUIRE(made);
    const rod::RodDefinition& d = shells.world().rods[0].model.definition();
    CHECK(d.length == Approx(2.0 * M_PI * 0.75 * 0.0192).epsilon(1e-14));
    CHECK(d.bendingModulus == Approx(2.2e9 * 0.01 * std::pow(5e-4, 3) / 12.0).epsilon(1e-14));
    CHECK(d.linearMass * d.length == Approx(1270.0 * 0.01 * 5e-4 * d.length).epsilon(1e-14));
    const auto pose = shells.pose(*made);
    REQUIRE(pose);
    CHECK(pose->curvature.size() == 15);
    CHECK(pose->bending_energy == 0.0);
    // from its start, the circle's other end is a chord 2 R sin(phi) away, symmetric about the middle
    CHECK(pose->start.x == Approx(-0.0192 * std::sin(0.75 * M_PI)).margin(1e-12));
    CHECK(pose->start.y == Approx(0.0192 * (1.0 - std::cos(0.75 * M_PI))).epsilon(1e-12));
}

TEST_CASE("bad definitions fail with a reason and change nothing", "[plugin]") {
    Shells shells(hostWithPlate());
    REQUIRE(shells.create(above(0.0, 0.1)));
    const auto refused = [&](const char* what, const auto& spoil) {
        ShellDef d = above(0.5, 0.1);
        spoil(d);
        const EnergyBalance before = shells.energy_balance();
        const auto made = shells.create(d);
        INFO(what);
        CHECK_FALSE(made);
        CHECK(made.error().size() > 10);
        CHECK(shells.size() == 1);
        CHECK(shells.energy_balance().added == before.added);
    };
    for (const double bad : {kNan, kInf, -kInf, -1.0, 0.0}) {
        refused("thickness", [&](ShellDef& d) { d.thickness = bad; });
        refused("width", [&](ShellDef& d) { d.width = bad; });
        refused("density", [&](ShellDef& d) { d.density = bad; });
        refused("young_modulus", [&](ShellDef& d) { d.young_modulus = bad; });
        refused("phi_bar", [&](ShellDef& d) { d.phi_bar = bad; });
    }
    // Finite but impossible: elements that turn many times, energies that are not finite.
    refused("tight radius", [&](ShellDef& d) { d.radius = 1e-9, d.length = 0.1; });
    refused("tight curl", [&](ShellDef& d) { d.curvature.assign(static_cast<std::size_t>(d.elements), 1e9); });
    for (const double turns : {-2.0, -0.4, 0.0, 0.4, 1.82, 2.0}) // its ends never meet, or only across itself
        refused("turns once", [&](ShellDef& d) {
            d.closed = true;
            d.length = 0.1;
            d.curvature.assign(static_cast<std::size_t>(d.elements), turns * 2.0 * M_PI / d.length);
        });
    refused("speed", [&](ShellDef& d) { d.velocity.x = 1e200; });
    refused("place", [&](ShellDef& d) { d.position.y = -1e300; });
    for (const double bad : {kNan, kInf, -kInf, -1.0})
        refused("length", [&](ShellDef& d) { d.length = bad; });
    for (const double bad : {kNan, kInf, -1.0})
        refused("mu", [&](ShellDef& d) { d.mu = bad; });
    for (const double bad : {kNan, 0.0, -kInf, kInf})
        refused("radius", [&](ShellDef& d) { d.radius = bad; }); // infinite: only with a length
    for (const double bad : {kNan, kInf, -kInf}) {
        refused("position.x", [&](ShellDef& d) { d.position.x = bad; });
        refused("position.y", [&](ShellDef& d) { d.position.y = bad; });
        refused("angle", [&](ShellDef& d) { d.angle = bad; });
        refused("velocity", [&](ShellDef& d) { d.velocity.y = bad; });
        refused("spin", [&](ShellDef& d) { d.spin = bad; });
        refused("curvature", [&](ShellDef& d) { d.curvature.assign(15, bad); });
        refused("natural_curvature", [&](ShellDef& d) { d.natural_curvature.assign(15, bad); });
    }
    for (const int bad : {2, 1, 0, -1, 1025})
        refused("elements", [&](ShellDef& d) { d.elements = bad; });
    refused("too few curvatures", [](ShellDef& d) { d.curvature.assign(14, 0.0); });
    refused("too many natural curvatures", [](ShellDef& d) { d.natural_curvature.assign(16, 0.0); });
    refused("phi_bar beyond a circle", [](ShellDef& d) { d.phi_bar = 1.5; });
}

TEST_CASE("stale, foreign and invented handles give errors, never crashes", "[plugin]") {
    Shells shells(nullptr);
    const ShellHandle a = *shells.create(ShellDef{});
    const ShellHandle b = *shells.create(above(1.0, 0.0));
    CHECK_FALSE(a == b);
    CHECK(shells.valid(a));
    CHECK(shells.destroy(a));
    CHECK_FALSE(shells.valid(a));
    CHECK_FALSE(shells.destroy(a));
    const ShellHandle c = *shells.create(above(2.0, 0.0)); // takes the free slot
    CHECK(c.index == a.index);
    CHECK_FALSE(c == a);
    for (const ShellHandle bad : {a, ShellHandle{}, ShellHandle{77, 1}, ShellHandle{b.index, b.generation + 1},
                                  ShellHandle{0xffffffffu, 0xffffffffu}}) {
        CHECK_FALSE(shells.valid(bad));
        CHECK_FALSE(shells.destroy(bad));
        const auto pose = shells.pose(bad);
        CHECK_FALSE(pose);
        CHECK_FALSE(pose.error().empty());
        const auto hold = shells.create_hold(bad, 0.5, HoldKind::Clamp);
        CHECK_FALSE(hold);
        CHECK_FALSE(hold.error().empty());
    }
    CHECK(shells.size() == 2);
    REQUIRE(shells.pose(b));
    CHECK(shells.pose(b)->start.x > 0.9); // the survivor is still itself
}

TEST_CASE("a handle of another world is refused", "[plugin]") {
    Shells here(nullptr), there(nullptr);
    const ShellHandle foreign = *there.create(ShellDef{});
    REQUIRE(here.create(ShellDef{}));
    CHECK_FALSE(here.valid(foreign));
}

TEST_CASE("bad holds are refused", "[plugin]") {
    Shells shells(nullptr);
    const ShellHandle a = *shells.create(ShellDef{});
    for (const double bad : {-0.01, 1.01, kNan, kInf}) {
        const auto hold = shells.create_hold(a, bad, HoldKind::Pin);
        CHECK_FALSE(hold);
        CHECK_FALSE(hold.error().empty());
    }
    CHECK(shells.world().rods[0].holds.empty());
    const HoldHandle pin = *shells.create_hold(a, 0.0, HoldKind::Pin);
    const HoldHandle clamp = *shells.create_hold(a, 1.0, HoldKind::Clamp);
    CHECK_FALSE(pin == clamp);
    CHECK(shells.world().rods[0].holds.size() == 2);
}

TEST_CASE("only bodies of the host can be attached to the crosshead", "[plugin]") {
    Shells shells(hostWithPlate());
    CHECK(shells.attach_to_crosshead("plate"));
    CHECK_FALSE(shells.attach_to_crosshead("nobody"));
    CHECK_FALSE(Shells(nullptr).attach_to_crosshead("plate"));
    CHECK(shells.world().crossheadBodies.size() == 1);
}

TEST_CASE("bad frames fail and change nothing", "[plugin]") {
    auto host = hostWithPlate();
    Shells shells(host);
    const ShellHandle a = *shells.create(above(0.0, 0.1));
    for (const double dt : {-0.1, 5e-324, 1e-15, kNan, kInf}) {
        const FrameReport r = shells.pre_step(dt);
        CHECK_FALSE(r.failure.empty());
        CHECK(r.advanced == 0.0);
        CHECK(shells.time() == 0.0);
        CHECK(shells.pose(a)->start.y > 0.1);
        REQUIRE(shells.post_step());
    }
    CHECK(shells.pre_step(0.01).failure.empty());
    CHECK(shells.time() == Approx(0.01));
}

TEST_CASE("exceptions of host and observer are reported", "[plugin]") {
    auto broken = std::make_shared<Broken>();
    broken->addGround(1, 0.35);
    Shells shells(broken);
    REQUIRE(shells.create(above(0.0, 0.1)));
    CHECK(shells.pre_step(0.01).failure == "host is broken");
    Shells other(hostWithPlate());
    REQUIRE(other.create(above(0.0, 0.1)));
    const FrameReport r = other.pre_step(0.01, []() -> bool { throw std::runtime_error("observer is broken"); });
    CHECK(r.failure == "observer is broken");
    CHECK(other.pre_step(0.01).failure.empty()); // the world goes on
}

TEST_CASE("an observer ends the frame early", "[plugin]") {
    Shells shells(hostWithPlate());
    REQUIRE(shells.create(above(0.0, 0.1)));
    int seen = 0;
    const FrameReport r = shells.pre_step(0.05, [&] { return ++seen == 3; });
    CHECK(r.stopped);
    CHECK(r.steps == 3);
    CHECK(r.advanced == shells.time());
    CHECK(r.advanced < 0.05);
}

TEST_CASE("hundreds of shells are created and destroyed", "[plugin]") {
    auto host = hostWithPlate();
    Shells shells(host);
    std::vector<ShellHandle> alive, dead;
    for (int round = 0; round < 60; ++round) {
        for (int i = 0; i < 5; ++i) {
            const auto made = shells.create(above(0.06 * (i - 2), 0.05 + 0.01 * (round % 3)));
            REQUIRE(made);
            alive.push_back(*made);
        }
        const FrameReport r = shells.pre_step(1e-3);
        INFO(r.failure);
        REQUIRE(r.failure.empty());
        host->step(r.advanced);
        REQUIRE(shells.post_step());
        while (!alive.empty()) { // last in, first out, then the other way round
            const std::size_t k = round % 2 == 0 ? alive.size() - 1 : 0;
            CHECK(shells.destroy(alive[k]));
            dead.push_back(alive[k]);
            alive.erase(alive.begin() + static_cast<std::ptrdiff_t>(k));
        }
    }
    CHECK(shells.size() == 0);
    for (const ShellHandle& h : dead)
        CHECK_FALSE(shells.valid(h));
    const EnergyBalance b = shells.energy_balance();   // nothing is left
    const double turned = 60 * 5 * 6e-4 * 9.81 * 0.06; // the energy that went through, J
    CHECK(std::abs(b.kinetic) + std::abs(b.bending) + std::abs(b.gravity) < 1e-9 * turned);
    CHECK(std::abs(b.residual) < 1e-9 * turned);
    CHECK(shells.pre_step(1e-3).failure.empty()); // an empty world advances too
}

TEST_CASE("a shell dropped while others rest leaves them at rest", "[plugin]") {
    auto host = hostWithPlate();
    Shells shells(host);
    const auto advance = [&](int frames) {
        for (int i = 0; i < frames; ++i) {
            const FrameReport r = shells.pre_step(4e-3);
            REQUIRE(r.failure.empty());
            host->step(r.advanced);
            REQUIRE(shells.post_step());
        }
    };
    ShellDef d = above(0.0, 0.0192 + 0.0003);
    d.phi_bar = 0.5;
    d.angle = M_PI;
    const ShellHandle a = *shells.create(d);
    advance(150);
    const ShellPose before = *shells.pose(a);
    const ShellHandle b = *shells.create(above(0.5, 0.1)); // far away
    advance(25);
    CHECK(shells.destroy(b));
    advance(25);
    const ShellPose after = *shells.pose(a);
    CHECK(std::hypot(after.start.x - before.start.x, after.start.y - before.start.y) < 1e-9); // rest: no creep
}
