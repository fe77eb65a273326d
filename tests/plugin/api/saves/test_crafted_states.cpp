// Saved states that no program would write: refused, or harmless.

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/contact/feature_id.h"
#include "supercircle/step/stepper.h"
#include "tests/plugin/api/support.h"
#include "tests/support/tumble.h"

#include <algorithm>
#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <limits>
#include <random>

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Corrects the checksum, FNV-1a over the content.
void seal(std::vector<std::uint8_t>& bytes) {
    constexpr std::size_t kHeader = 28;
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (std::size_t k = kHeader; k < bytes.size(); ++k)
        hash = (hash ^ bytes[k]) * 0x100000001b3u;
    for (std::size_t k = 0; k < 8; ++k)
        bytes[20 + k] = static_cast<std::uint8_t>(hash >> (8 * k));
}

} // namespace

TEST_CASE("damage with a valid checksum fails too, or is harmless", "[plugin]") {
    auto host = tumbleHost();
    Shells shells(host);
    addTumblers(shells, 3);
    for (int i = 0; i < 100; ++i)
        REQUIRE(tumbleFrame(shells, *host));
    const std::vector<std::uint8_t> good = shells.save().bytes();
    std::mt19937 random(11);
    int accepted = 0;
    for (int i = 0; i < 400; ++i) { // with a corrected checksum
        std::vector<std::uint8_t> bytes = good;
        constexpr std::size_t kHeader = 28;
        for (int k = 0; k < 3; ++k)
            bytes[kHeader + random() % (bytes.size() - kHeader)] = static_cast<std::uint8_t>(random());
        seal(bytes);
        const auto state = Snapshot::from_bytes(std::move(bytes));
        if (!state)
            continue;
        ++accepted;
        Shells victim(tumbleHost());
        if (!victim.restore(*state)) // nonsense is allowed, a crash is not
            continue;
        REQUIRE(victim.set_quality(Quality::Game)); // its budget ends frames in which a shell overlaps itself
        for (int f = 0; f < 2; ++f)
            victim.pre_step(1e-3);
    }
    CHECK(accepted > 0); // many bits are just other numbers
}

TEST_CASE("a crafted state with a time before zero is refused", "[plugin]") {
    Shells shells(nullptr);
    REQUIRE(shells.create(ShellDef{}));
    for (const double time : {-1e-300, -0.1, -1e6, kNan}) { // its bucket of energies would be a negative one
        shells.world().time = time;
        const auto crafted = Snapshot::from_bytes(shells.save().bytes());
        INFO("at " << time << " s");
        REQUIRE_FALSE(crafted);
        CHECK(crafted.error().find("SCSTATE: the time") != std::string::npos);
        CHECK_FALSE(Shells(nullptr).restore(shells.save()));
    }
    for (const double time : {-0.0, 0.0, 1e6}) {
        shells.world().time = time;
        Shells restored(nullptr);
        REQUIRE(restored.restore(*Snapshot::from_bytes(shells.save().bytes())));
        CHECK(restored.pre_step(1e-3).failure.empty());
    }
}

TEST_CASE("a crafted state whose next shell would take a key that is in use, or 0, is refused", "[plugin]") {
    Shells shells(nullptr);
    REQUIRE(shells.create(ShellDef{}));
    REQUIRE(shells.create(ShellDef{}));
    for (const std::uint32_t key : {0U, 1U, 2U, 0xffffffffU}) {
        shells.world().nextKey = key;
        const auto crafted = Snapshot::from_bytes(shells.save().bytes());
        INFO("next key " << key);
        REQUIRE_FALSE(crafted);
        CHECK(crafted.error().find("SCSTATE: the key of") != std::string::npos);
    }
    for (const std::uint32_t key : {3U, 1U << 20U}) { // the last: all keys were used, those that are free come again
        shells.world().nextKey = key;
        Shells restored(nullptr);
        REQUIRE(restored.restore(*Snapshot::from_bytes(shells.save().bytes())));
        CHECK(restored.create(ShellDef{}));
    }
    shells.world().rods[0].key = 0;
    CHECK_FALSE(Snapshot::from_bytes(shells.save().bytes()));
}

TEST_CASE("a crafted state with an index, a number or a choice that fits nothing is refused", "[plugin]") {
    auto host = tumbleHost();
    Shells shells(host);
    ShellDef d;
    const ShellHandle a = *shells.create(d);
    d.position.x = 0.2;
    const ShellHandle b = *shells.create(d);
    REQUIRE(shells.create_joint({.kind = JointKind::Weld, .shell = a, .other = b}));
    REQUIRE(shells.create_pin(a, 0.3));
    REQUIRE(shells.set_effects(all_shells, "nonlinear_elasticity", {{"uc_1_m", 123.456}}));
    const Snapshot good = shells.save();
    REQUIRE(Snapshot::from_bytes(good.bytes()));
    const auto refused = [&](const char* what, const auto& spoil) {
        REQUIRE(shells.restore(good));
        spoil(shells.world(), shells.stepper().settings());
        INFO(what);
        CHECK_FALSE(Snapshot::from_bytes(shells.save().bytes()));
    };
    using W = step::World;
    using S = step::Settings;
    const auto between = [](std::int32_t rod, std::int32_t outline, contact::Feature kind, double s = 0.0) {
        return [=](W& w, S&) { // a contact of both shells
            contact::Candidate c;
            c.a = {0, 0, 0.0};
            c.b = {rod, 0, s};
            c.outline = outline;
            c.id = contact::makeId(w.rods[0].key, w.rods[1].key, kind, 0);
            w.candidates.assign(1, c);
        };
    };
    REQUIRE(shells.restore(good));
    between(1, -1, contact::Feature::SampleRod)(shells.world(), shells.stepper().settings());
    CHECK(Snapshot::from_bytes(shells.save().bytes()));
    refused("outline of two shells", between(1, 7, contact::Feature::SampleRod));
    refused("outline feature of two shells", between(1, -1, contact::Feature::CornerRod));
    refused("place off its shell", between(1, -1, contact::Feature::SampleRod, 1.0));
    refused("place that is no number", between(1, -1, contact::Feature::SampleRod, kNan));
    refused("joint of a missing shell", [](W& w, S&) { w.links[0].rodA = 77; });
    refused("joint to a missing shell", [](W& w, S&) { w.links[0].rodB = 77; });
    refused("joint off its shell", [](W& w, S&) { w.links[0].sA = 1.0; });
    refused("joint at no place", [](W& w, S&) { w.links[0].sB = kNan; });
    refused("joint of no kind", [](W& w, S&) { w.links[0].kind = static_cast<step::LinkKind>(9); });
    refused("joint to nothing", [](W& w, S&) { w.links[0].end = static_cast<step::LinkEnd>(9); });
    refused("next part 0", [](W& w, S&) { w.nextPart = 0; });
    refused("next part is the joint", [](W& w, S&) { w.nextPart = w.links[0].key; });
    refused("next part is the hold", [](W& w, S&) { w.nextPart = w.rods[0].holds[0].key; });
    refused("next island awake", [](W& w, S&) { w.nextIsland = 0; });
    refused("next island taken", [](W& w, S&) { w.rods[0].island = w.nextIsland; });
    refused("host row of no kind", [](W& w, S&) {
        w.constraints.rows.emplace_back();
        w.constraints.rows[0].kind = static_cast<step::HostRowKind>(9);
    });
    refused("host row beyond its strength", [](W& w, S&) {
        w.constraints.rows.emplace_back();
        w.constraints.rows[0].saturated = 2;
    });
    refused("negative cuts", [](W& w, S&) { w.rods[1].cuts = -1; });
    refused("cuts at the end of int", [](W& w, S&) { w.rods[1].cuts = std::numeric_limits<int>::max(); });
    refused("steps at the end", [](W& w, S&) { w.counters.steps = std::numeric_limits<std::uint64_t>::max(); });
    refused("unconverged at the end",
            [](W& w, S&) { w.counters.unconverged = std::numeric_limits<std::uint64_t>::max(); });
    refused("air that pushes", [](W& w, S&) { w.rods[0].effects.air.model.linear = -1.0; });
    refused("no linearisation", [](W&, S& s) { s.maxIterations = 0; });
    refused("negative pivots", [](W&, S& s) { s.contact.maxPivots = -1; });
    refused("pivots at the end of int", [](W&, S& s) { s.contact.maxPivots = std::numeric_limits<int>::max(); });
    refused("no method", [](W&, S& s) { s.contact.method = static_cast<coulomb::Method>(99); });
    refused("outlines out of order", [](W& w, S&) {
        w.bodies.assign(2, step::Body{});
        w.outlines.assign(2, step::BodyOutline{});
        for (std::size_t i = 0; i < 2; ++i) {
            w.bodies[i].id = 1 + i;
            w.outlines[i].body = 2 - i;
            w.outlines[i].local.points = {{0.0, 0.0}, {1.0, 0.0}};
        }
    });

    // What only the bytes hold. The handles stand first: their number, then generation, key, name and user data.
    const auto word = [&](std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value) {
        for (std::size_t k = 0; k < 4; ++k)
            bytes[at + k] = static_cast<std::uint8_t>(value >> (8 * k));
        seal(bytes);
    };
    constexpr std::size_t kFirst = 28 + 8, kSecond = kFirst + 24;
    std::vector<std::uint8_t> twice = good.bytes();
    word(twice, kSecond + 4, 1); // both are of the first shell
    CHECK_FALSE(Snapshot::from_bytes(twice));
    std::vector<std::uint8_t> last = good.bytes();
    word(last, kFirst, 0xffffffffU); // the next generation would be 0, that of no handle
    CHECK_FALSE(Snapshot::from_bytes(last));
    // The laws of shells made later stand last: choice of the law, then its curvature.
    const auto curvature = std::bit_cast<std::array<std::uint8_t, 8>>(123.456);
    for (const double law : {-1.0, 0.5, 5.0, 1e15, kNan}) {
        std::vector<std::uint8_t> bytes = good.bytes();
        const auto at = std::find_end(bytes.begin(), bytes.end(), curvature.begin(), curvature.end());
        REQUIRE(at - bytes.begin() > 8);
        const auto number = std::bit_cast<std::array<std::uint8_t, 8>>(law);
        std::copy(number.begin(), number.end(), at - 8);
        seal(bytes);
        INFO("law " << law);
        CHECK_FALSE(Snapshot::from_bytes(bytes));
    }
}
