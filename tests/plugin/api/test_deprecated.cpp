// Names of version 0.1: each still works in 0.2 and does what its successor does.

#include "tests/plugin/api/support.h"
#include "tests/support/text.h"

#include <regex>
#include <set>
#include <type_traits>

#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

using namespace supercircle;
using namespace supercircle::test;

namespace {

static_assert(std::is_same_v<Outcome, Status>);
static_assert(std::is_same_v<PartHandle<struct HoldTag>, HoldHandle>);
static_assert(std::is_same_v<GrabHandle, MouseJointHandle>);
static_assert(std::is_same_v<GrabDef, MouseJointDef>);
static_assert(std::is_same_v<DriveDef, TargetDef>);
static_assert(std::is_same_v<MaterialId, FrictionMaterial>);
static_assert(std::is_same_v<NearestPoint, ClosestPoint>);
static_assert(std::is_same_v<ShellMeasures, ShellState>);
static_assert(std::is_same_v<Touch, ContactPoint>);
static_assert(std::is_same_v<EnergyBooks, EnergyBalance>);

/// Two strips over the ground, a body and a plate; the same world for old and new names.
struct Twice {
    std::shared_ptr<FakeHost> host = emptyHost(kG);
    Shells shells{nullptr};
    ShellHandle a, b;

    Twice() {
        host->addGround(1, 0.4, {0.0, -1.0});
        host->add(2, "puck", {0.0, 0.1}, 0.0, 0.01, 1e-5);
        host->add(3, "plate", {1.0, 1.0});
        shells = Shells(host);
        a = *shells.create(strip(0.1, {0.0, 0.0}));
        b = *shells.create(strip(0.1, {0.2, 0.0}));
    }
};

JointDef tether(ShellHandle shell) {
    return {.kind = JointKind::Tether, .shell = shell, .point = {0.2, 0.1}};
}

} // namespace

TEST_CASE("the free names of 0.1 are those of 0.2", "[plugin][deprecated]") {
    CHECK(std::string(kStepping) == kWorldLocked);
    const ShellDef old = scaledShell(0.5, 1.0, 0.6, 2.0), now = scaled_shell(0.5, 1.0, 0.6, 2.0);
    CHECK(old.thickness == now.thickness);
    CHECK(old.young_modulus == now.young_modulus);
    CHECK(bendingModulus(old) == bending_modulus(now));
    CHECK(strainColour(0.3, 1.0).green == strain_colour(0.3, 1.0).green);
}

TEST_CASE("the fields of 0.1 are those of 0.2", "[plugin][deprecated]") {
    FrameReport report;
    CHECK_FALSE(report.late);
    report.budget_exhausted = true;
    CHECK(report.late);
    EnergyBalance balance;
    CHECK(balance.push_out == 0.0);
    balance.position_correction = 2.0;
    const EnergyBalance copy = balance;
    CHECK(copy.push_out == 2.0);
}

TEST_CASE("the calls of 0.1 that change shells leave the state of those of 0.2", "[plugin][deprecated]") {
    Twice old, now;
    Shells &o = old.shells, &n = now.shells;
    const auto same = [&](const char* what, bool oldDone, bool newDone) {
        INFO(what);
        CHECK(oldDone);
        CHECK(newDone);
        CHECK(o.hash() == n.hash());
    };
    const auto done = [](const auto& result) { return static_cast<bool>(result); };
    const auto clampO = o.clamp(old.a, 0.0), clampN = n.create_clamp(now.a, 0.0);
    same("clamp", done(clampO), done(clampN));
    const auto pinO = o.pin(old.a, 1.0), pinN = n.create_pin(now.a, 1.0);
    same("pin", done(pinO), done(pinN));
    same("hold", done(o.hold(old.b, 1.0, HoldKind::Pin, true)),
         done(n.create_hold(now.b, 1.0, HoldKind::Pin, HoldBase::Moving)));
    same("hold on the ground", done(o.hold(old.b, 0.9, HoldKind::Pin)),
         done(n.create_hold(now.b, 0.9, HoldKind::Pin, HoldBase::Fixed)));
    DriveDef target = *o.target(*clampO);
    target.position.x += 1e-3;
    same("drive a hold", done(o.drive(*clampO, target)), done(n.set_target(*clampN, target)));
    const auto stringO = o.join(tether(old.b)), stringN = n.create_joint(tether(now.b));
    same("join", done(stringO), done(stringN));
    const DriveDef moved{{0.2, 0.11}, 0.0, {}, 0.0};
    same("drive a joint", done(o.drive(*stringO, moved)), done(n.set_target(*stringN, moved)));
    same("reel", done(o.reel(*stringO, 0.08, 0.5)), done(n.set_max_length(*stringN, 0.08, 0.5)));
    const auto grabO = o.grab(old.b, {.arc_fraction = 0.2}), grabN = n.create_mouse_joint(now.b, {.arc_fraction = 0.2});
    same("grab", done(grabO), done(grabN));
    same("move", done(o.move(*grabO, {0.1, 0.1})), done(n.set_target(*grabN, {0.1, 0.1})));
    const auto forceO = o.add_force(old.a, 0.5, {0.0, 0.01}, 1e-5),
               forceN = n.create_force(now.a, 0.5, {0.0, 0.01}, 1e-5);
    same("add_force", done(forceO), done(forceN));
    same("set_surface of a shell", done(o.set_surface(old.a, 3)), done(n.set_friction_material(now.a, 3)));
    same("set_surface of a body", done(o.set_surface(BodyId{2}, 4)), done(n.set_friction_material(BodyId{2}, 4)));
    same("carry", done(o.carry("plate")), done(n.attach_to_crosshead("plate")));
    same("set_machine_velocity", done(o.set_machine_velocity({0.0, -0.1})),
         done(n.set_crosshead_velocity({0.0, -0.1})));
    advance(o, old.host.get(), 0.01, 5);
    advance(n, now.host.get(), 0.01, 5);
    CHECK(o.hash() == n.hash());
    CHECK(o.machine_force().y == n.crosshead_force().y);
    same("release a hold", done(o.release(*pinO)), done(n.destroy(*pinN)));
    same("release a joint", done(o.release(*stringO)), done(n.destroy(*stringN)));
    same("release a grab", done(o.release(*grabO)), done(n.destroy(*grabN)));
    same("release a force", done(o.release(*forceO)), done(n.destroy(*forceN)));
}

TEST_CASE("the queries of 0.1 answer as those of 0.2", "[plugin][deprecated]") {
    Twice world;
    Shells& s = world.shells;
    CHECK(s.list() == s.shells());
    CHECK(s.measure(world.a)->mass == s.state(world.a)->mass);
    CHECK(s.books().gravity == s.energy_balance().gravity);
    CHECK(s.nearest(world.a, {0.0, 0.3})->distance == s.closest_point(world.a, {0.0, 0.3})->distance);
    CHECK(s.nearest({0.0, 0.3})->distance == s.closest_point({0.0, 0.3})->distance);
    CHECK_FALSE(s.nearest({0.0, 0.3}, 0.1));
    CHECK_FALSE(s.closest_point({0.0, 0.3}, 0.1));
}

TEST_CASE("this test uses every deprecated name of the public headers", "[plugin][deprecated]") {
    const std::string folder = std::string(SC_SOURCE_DIR) + "/plugin/api/include/supercircle/";
    const std::string here = contentOf(std::string(SC_SOURCE_DIR) + "/tests/plugin/api/test_deprecated.cpp");
    std::set<std::string> names;
    for (const char* file : {"shells.hpp", "deprecated.hpp"}) {
        const std::string text = contentOf(folder + file);
        static const std::regex alias(R"((\w+) \[\[deprecated\([^\]]*\]\] =)");
        static const std::regex declaration(R"(deprecated\("[^"]*"\)\]\]([^;({=]|\{\})*?(\w+)\s*[\(;=])");
        for (std::sregex_iterator it(text.begin(), text.end(), alias), end; it != end; ++it)
            names.insert((*it)[1]);
        for (std::sregex_iterator it(text.begin(), text.end(), declaration), end; it != end; ++it)
            names.insert((*it)[2]);
    }
    CHECK(names.size() > 30); // otherwise the headers were not understood
    for (const std::string& name : names) {
        INFO(name);
        CHECK(std::regex_search(here, std::regex("\\b" + name + "\\b")));
    }
}
