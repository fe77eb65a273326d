// Saved, restored, hashed: the future is bitwise identical.

#include "plugin/api/include/supercircle/shells.hpp"
#include "tests/plugin/api/support.h"
#include "tests/support/tumble.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <optional>
#include <random>

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Saves at `saves` random frames out of `frames`, goes on `more` frames from each in the same and in fresh Shells.
void saveAndReplay(int frames, int saves, int more, unsigned seed) {
    auto host = tumbleHost();
    Shells shells(host);
    addTumblers(shells);
    struct Saved {
        int frame;
        Snapshot state;
        std::map<step::BodyId, FakeHost::Body> bodies;
    };
    std::vector<int> wanted;
    std::mt19937 random(seed);
    for (int i = 0; i < saves; ++i)
        wanted.push_back(static_cast<int>(random() % static_cast<unsigned>(frames - more)));
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    std::vector<Saved> saved;
    std::vector<std::uint64_t> hash;
    std::size_t snaps = 0, touches = 0;
    for (int f = 0; f <= frames; ++f) {
        hash.push_back(shells.hash());
        if (std::binary_search(wanted.begin(), wanted.end(), f))
            saved.push_back({f, shells.save(), host->bodies});
        REQUIRE(tumbleFrame(shells, *host));
        snaps += shells.events().snap_begin.size();
        touches += shells.events().contact_begin.size();
    }
    CHECK(touches > 10); // otherwise the scene tests nothing
    CHECK(snaps > 0);
    auto otherHost = tumbleHost();
    for (const Saved& s : saved) {
        INFO("saved at frame " << s.frame);
        Shells fresh(otherHost);
        REQUIRE(shells.restore(s.state));
        REQUIRE(fresh.restore(s.state));
        CHECK(fresh.hash() == hash[static_cast<std::size_t>(s.frame)]);
        host->bodies = otherHost->bodies = s.bodies;
        for (int f = 1; f <= more; ++f) {
            tumbleFrame(shells, *host);
            tumbleFrame(fresh, *otherHost);
        }
        const auto end = static_cast<std::size_t>(s.frame + more);
        CHECK(shells.hash() == hash[end]);
        CHECK(fresh.hash() == hash[end]);
        CHECK(fresh.save().bytes().size() == shells.save().bytes().size());
    }
}

} // namespace

TEST_CASE("restored in the same and in new Shells, the future is bitwise identical", "[plugin]") {
    saveAndReplay(900, 8, 200, 1);
}

TEST_CASE("a hundred states restored, two hundred frames each", "[plugin][slow]") {
    saveAndReplay(1500, 100, 200, 2);
}

TEST_CASE("bytes of a snapshot can be read, and damaged or foreign ones fail", "[plugin]") {
    auto host = tumbleHost();
    Shells shells(host);
    addTumblers(shells);
    for (int i = 0; i < 150; ++i)
        REQUIRE(tumbleFrame(shells, *host));
    const Snapshot state = shells.save();
    const auto read = Snapshot::from_bytes(state.bytes());
    REQUIRE(read);
    CHECK(*read == state);
    Shells fresh(tumbleHost());
    REQUIRE(fresh.restore(*read));
    CHECK(fresh.hash() == shells.hash());
    CHECK((fresh.save().bytes() == shells.save().bytes())); // not printed

    const std::uint64_t before = fresh.hash();
    const auto refused = [&](std::vector<std::uint8_t> bytes, const char* word) {
        const auto bad = Snapshot::from_bytes(std::move(bytes));
        REQUIRE_FALSE(bad);
        INFO(bad.error());
        CHECK(bad.error().find(word) != std::string::npos);
    };
    refused({}, "not an SCSTATE");
    refused({'n', 'o', 't', ' ', 'o', 'u', 'r', 's', '!', '!'}, "not an SCSTATE");
    std::mt19937 random(7);
    for (int i = 0; i < 200; ++i) { // one flipped bit anywhere
        std::vector<std::uint8_t> bytes = state.bytes();
        bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1u << (random() % 8));
        CHECK_FALSE(Snapshot::from_bytes(std::move(bytes)));
    }
    for (const std::size_t cut : {std::size_t{5}, std::size_t{20}, std::size_t{28}, state.bytes().size() - 1})
        CHECK_FALSE(Snapshot::from_bytes({state.bytes().begin(), state.bytes().begin() + static_cast<long>(cut)}));
    std::vector<std::uint8_t> longer = state.bytes();
    longer.push_back(0);
    refused(longer, "after its end");
    std::vector<std::uint8_t> newer = state.bytes();
    newer[8] = 99;
    refused(newer, "version 99");
    CHECK_FALSE(CallLog::from_bytes(state.bytes()));
    const auto empty = fresh.restore(Snapshot{});
    REQUIRE_FALSE(empty);
    CHECK_FALSE(empty.error().empty());
    CHECK(fresh.hash() == before); // refusals changed nothing
}

TEST_CASE("handles after a restore: those of that time are valid, later ones are not", "[plugin]") {
    Shells shells(nullptr);
    ShellDef d;
    d.name = "a";
    const ShellHandle a = *shells.create(d);
    const Snapshot then = shells.save();
    CHECK(shells.destroy(a));
    d.name = "b";
    const ShellHandle b = *shells.create(d); // in a's place
    REQUIRE(shells.restore(then));
    CHECK(shells.valid(a));
    CHECK_FALSE(shells.valid(b));
    CHECK(shells.find("a") == a);
    CHECK(shells.destroy(a));
    const ShellHandle c = *shells.create(d);
    CHECK_FALSE(c == b);
    CHECK_FALSE(shells.valid(b));
    Shells fresh(nullptr);
    const ShellHandle own = *fresh.create(d);
    REQUIRE(fresh.restore(then));
    CHECK_FALSE(fresh.valid(own));
    CHECK_FALSE(fresh.valid(a));
    CHECK(fresh.valid(ShellHandle{a.index, a.generation, fresh.id()}));
    CHECK(fresh.find("a") == ShellHandle{a.index, a.generation, fresh.id()});
    CHECK(fresh.shells().size() == 1);
}

TEST_CASE("handles of constraints made after the snapshot stay stale", "[plugin]") {
    Shells shells(nullptr);
    const ShellHandle a = *shells.create(ShellDef{});
    const HoldHandle kept = *shells.create_pin(a, 0.0);
    const Snapshot then = shells.save();
    const HoldHandle lost = *shells.create_pin(a, 1.0);
    REQUIRE(shells.restore(then));
    CHECK(shells.valid(kept));
    CHECK_FALSE(shells.valid(lost));
    const HoldHandle other = *shells.create_pin(a, 0.7); // where the lost one would have been
    CHECK_FALSE(shells.valid(lost));
    CHECK(shells.valid(other));
    Shells fresh(nullptr);
    REQUIRE(fresh.restore(*Snapshot::from_bytes(then.bytes())));
    CHECK_FALSE(fresh.valid(kept));
    CHECK(fresh.valid(HoldHandle{kept.index, kept.generation, fresh.id()}));
}

TEST_CASE("failed calls and queries keep the hash, successful calls change it", "[plugin]") {
    auto host = tumbleHost();
    Shells shells(host);
    addTumblers(shells);
    for (int i = 0; i < 120; ++i)
        REQUIRE(tumbleFrame(shells, *host));
    const std::uint64_t before = shells.hash();
    const ShellHandle some = shells.shells().front();
    ShellHandle stale = some;
    stale.generation += 7;
    ShellDef bad;
    bad.thickness = kNan;
    EventSettings badEvents;
    badEvents.snap_time = -1.0;
    CHECK_FALSE(shells.create(bad));
    CHECK_FALSE(shells.destroy(stale));
    CHECK_FALSE(shells.create_hold(stale, 0.5, HoldKind::Pin));
    CHECK_FALSE(shells.create_hold(some, kNan, HoldKind::Pin));
    CHECK_FALSE(shells.attach_to_crosshead("nobody"));
    CHECK_FALSE(shells.set_event_settings(badEvents));
    CHECK_FALSE(shells.set_name(stale, "x"));
    CHECK_FALSE(shells.set_crosshead_velocity({kNan, 0.0}));
    for (const double dt : {-1.0, kNan, std::numeric_limits<double>::infinity()})
        CHECK_FALSE(shells.pre_step(dt).failure.empty());
    CHECK_FALSE(shells.restore(Snapshot{}));
    CHECK_FALSE(shells.replay(CallLog{}));
    (void)shells.ray_cast({-1.0, 0.02}, {1.0, 0.02});
    (void)shells.closest_point({0.0, 0.0});
    (void)shells.section(some, 0.3);
    (void)shells.state(some);
    (void)shells.save();
    CHECK(shells.hash() == before);
    CHECK(shells.set_name(some, "other name")); // not part of what decides the future
    CHECK(shells.hash() == before);
    const Snapshot then = shells.save();
    CHECK(shells.create_hold(some, 0.5, HoldKind::Pin));
    CHECK(shells.hash() != before);
    REQUIRE(shells.restore(then));
    CHECK(shells.hash() == before);
    REQUIRE(tumbleFrame(shells, *host));
    CHECK(shells.hash() != before);
}

TEST_CASE("names, user data and the list of shells", "[plugin]") {
    Shells shells(nullptr);
    ShellDef d;
    std::vector<ShellHandle> made;
    for (int i = 0; i < 4; ++i) {
        d.name = i == 3 ? "double" : i == 1 ? "double" : "shell " + std::to_string(i);
        d.user_data = static_cast<std::uint64_t>(i) << 40;
        d.position.x = 0.2 * i;
        made.push_back(*shells.create(d));
    }
    CHECK(shells.shells() == made);
    CHECK(shells.find("double") == made[1]);
    CHECK(shells.find("nobody").null());
    CHECK(*shells.user_data(made[2]) == std::uint64_t{2} << 40);
    CHECK(*shells.name(made[2]) == "shell 2");
    CHECK(shells.destroy(made[1]));
    CHECK(shells.find("double") == made[3]);
    CHECK_FALSE(shells.name(made[1]));
    CHECK_FALSE(shells.user_data(made[1]));
    d.name = "young";
    const ShellHandle young = *shells.create(d); // takes the free place but stands last
    CHECK(shells.shells() == std::vector<ShellHandle>{made[0], made[2], made[3], young});
    CHECK(shells.set_user_data(young, 9));
    CHECK(*shells.user_data(young) == 9);
}

TEST_CASE("a log of calls replays to the same state, without failed calls", "[plugin]") {
    auto host = tumbleHost();
    Shells shells(host);
    addTumblers(shells, 2);
    const ShellHandle early = shells.shells().back();
    REQUIRE(tumbleFrame(shells, *host)); // a log may begin in the middle
    const auto bodies = host->bodies;
    REQUIRE(shells.start_log(42));
    ShellDef d;
    d.position = {0.04, 0.24};
    const ShellHandle high = *shells.create(d);
    std::optional<ShellHandle> late;
    std::optional<HoldHandle> hold;
    std::optional<MouseJointHandle> mouseJoint;
    std::optional<ForceHandle> push;
    int stopped = 0;
    for (int f = 0; f < 120; ++f) {
        CHECK(shells.set_crosshead_velocity({0.0, f < 50 ? -0.1 : 0.05}));
        if (f == 20)
            mouseJoint = *shells.create_mouse_joint(early, {0.2, {0.0, 0.1}, 8.0, 1.0, 0.0});
        if (f == 30)
            CHECK(shells.destroy(shells.shells().front()));
        if (f == 40) {
            d.position = {-0.04, 0.24};
            d.radius = 0.01;
            d.name = "late";
            late = *shells.create(d);
            push = *shells.create_force(*late, 1.0, {0.002, 0.0});
        }
        if (f > 45 && f < 55)
            CHECK(shells.apply_force(high, 0.3, {0.0, 0.005}));
        if (f == 50) {
            CHECK(shells.set_target(*mouseJoint, {0.01, 0.12}));
            CHECK(shells.set_material(*late, {.mu = 0.6, .young_modulus = {}, .density = {}, .natural_curvature = {}}));
            CHECK(shells.set_friction_material(*late, 3));
            CHECK(shells.set_friction_material(*shells.body("crate"), 4));
            CHECK(shells.set_friction(3, 4, 0.1));
        }
        if (f == 60)
            hold = *shells.create_hold(*late, 0.5, HoldKind::Clamp);
        if (f > 60 && f < 80) {
            TargetDef to = *shells.target(*hold);
            to.position.y -= 1e-5;
            CHECK(shells.set_target(*hold, to));
        }
        if (f == 80) {
            CHECK(shells.destroy(*hold));
            CHECK(shells.destroy(*mouseJoint));
            CHECK(shells.destroy(*push));
            CHECK(shells.apply_impulse(*late, 0.5, {1e-5, 2e-5}));
            CHECK(shells.create_joint(
                {.kind = JointKind::Tether, .shell = *late, .point = {-0.04, 0.27}, .length = 0.08}));
        }
        int steps = 0;
        const FrameReport r = shells.pre_step(2e-3, [&] { // frames of several steps
            ++steps;
            CHECK_FALSE(shells.set_name(early, "not now")); // refused within a step, and not logged
            CHECK_FALSE(shells.restore(Snapshot{}));
            if (f == 30)
                CHECK_FALSE(shells.destroy(high));
            return f % 7 == 3 && steps == 1;
        });
        REQUIRE(r.failure.empty());
        stopped += r.stopped ? 1 : 0;
        host->step(r.advanced);
        REQUIRE(shells.post_step());
    }
    CHECK(stopped > 0);
    const auto log = CallLog::from_bytes(shells.log().bytes());
    REQUIRE(log);
    CHECK(log->seed() == 42);
    CHECK(log->frames() == 120);
    auto again = tumbleHost();
    again->bodies = bodies;
    Shells other(again);
    const auto done = other.replay(*log, [&](double advanced) {
        again->step(advanced);
        return true;
    });
    INFO(done.error());
    REQUIRE(done);
    CHECK(other.hash() == shells.hash());
    CHECK(other.shells().size() == shells.shells().size());
    CHECK_FALSE(Shells(nullptr).replay(*log)); // without the crate
}
