// Every changing call of Shells is in the log, and the log plays back to the same bits. What a changing call is, is
// read from the header itself: who adds one and forgets the log or this table gets a failing test.

#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/api/snapshot_log.h"
#include "tests/support/text.h"
#include "tests/support/tumble.h"

#include <catch2/catch.hpp>
#include <functional>
#include <regex>
#include <set>

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Declarations of the class that answer with an Outcome, a handle or a report and are not const, without blanks and
/// names of parameters: "drive(HoldHandle,DriveDef)".
std::set<std::string> changingCalls() {
    std::string text = contentOf(std::string(SC_SOURCE_DIR) + "/plugin/api/include/supercircle/shells.hpp");
    text = std::regex_replace(text, std::regex("//[^\n]*"), "");
    text = text.substr(text.find("\nclass Shells {"));
    static const std::regex call(
        R"((?:Outcome|Result<\w+Handle>|FrameReport|void)\s+(\w+)\(((?:[^;{]|\{\})*?)\)(\s*const)?\s*[;{])");
    std::set<std::string> found;
    for (std::sregex_iterator it(text.begin(), text.end(), call), end; it != end; ++it) {
        if ((*it)[3].matched)
            continue;
        std::string list = (*it)[2];
        list = std::regex_replace(list, std::regex(R"(\s*=[^,]*)"), "");        // defaults
        list = std::regex_replace(list, std::regex(R"(const\s+|&|std::)"), ""); // how they are passed
        list = std::regex_replace(list, std::regex(R"(\s+\w+\s*(,|$))"), "$1"); // names
        list = std::regex_replace(list, std::regex(R"(\s+)"), "");
        found.insert(std::string((*it)[1]) + "(" + list + ")");
    }
    return found;
}

/// How often each kind of record stands in a log; the layout is that of plugin/api/snapshot_log.h.
std::vector<int> recordsOf(const CallLog& log) {
    std::vector<int> count(static_cast<std::size_t>(Call::Count), 0);
    const std::vector<std::uint8_t>& b = log.bytes();
    constexpr std::size_t kHeader = 28 + 8; // of the file, and the seed
    for (std::size_t at = kHeader; at + 9 <= b.size();) {
        ++count.at(b[at]);
        std::uint64_t size = 0;
        for (std::size_t i = 0; i < 8; ++i)
            size |= static_cast<std::uint64_t>(b[at + 1 + i]) << (8 * i);
        at += 9 + size;
    }
    return count;
}

struct Stage {
    std::shared_ptr<FakeHost> host = tumbleHost();
    Shells shells{host};
    ShellHandle a, b, doomed;
    HoldHandle hold;
    JointHandle string, joint;
    GrabHandle grab;
    ForceHandle force;
    Snapshot saved;

    Stage() {
        const Outcome carried = shells.carry("plate");
        REQUIRE(carried);
    }
    ShellHandle make(Point at, double angle) {
        ShellDef d;
        d.radius = 0.014;
        d.elements = 6;
        d.position = at;
        d.angle = angle;
        const auto made = shells.create(d);
        INFO(made.error());
        REQUIRE(made);
        return *made;
    }
    void frames(int count) {
        for (int f = 0; f < count; ++f) {
            const FrameReport r = shells.pre_step(1e-3);
            REQUIRE(r.failure.empty());
            host->step(r.advanced);
            REQUIRE(shells.post_step());
        }
    }
};

struct Entry {
    std::string declaration;
    Call record; ///< what stands in the log; Restore: nothing that changes shells (the log itself)
    std::function<bool(Stage&)> make;
};

template <class R>
bool ok(const R& result) {
    UNSCOPED_INFO(result.error());
    return static_cast<bool>(result);
}
template <class H>
bool keep(const Result<H>& made, H& here) {
    if (made)
        here = *made;
    return ok(made);
}

JointDef tether(const Stage& s) {
    return {.kind = JointKind::Tether, .shell = s.b, .point = {0.03, 0.27}, .length = 0.2};
}

/// In an order in which each can be made.
std::vector<Entry> table() {
    const MaterialDef softer{.mu = 0.6, .young_modulus = 1e9, .density = 900.0, .natural_curvature = {{60.0}}};
    return {
        {"set_quality(Quality)", Call::SetQuality, [](Stage& s) { return ok(s.shells.set_quality(Quality::Game)); }},
        {"set_frame_budget(uint64_t)", Call::SetFrameBudget,
         [](Stage& s) { return ok(s.shells.set_frame_budget(30000)); }},
        {"create(ShellDef)", Call::Create,
         [](Stage& s) {
             s.a = s.make({-0.03, 0.05}, 0.3);
             s.b = s.make({0.03, 0.20}, 1.3);
             s.doomed = s.make({-0.04, 0.15}, 2.3);
             return true;
         }},
        {"hold(ShellHandle,double,HoldKind,bool)", Call::Hold,
         [](Stage& s) { return ok(s.shells.hold(s.doomed, 1.0, HoldKind::Pin, true)); }},
        {"clamp(ShellHandle,double)", Call::Hold, [](Stage& s) { return keep(s.shells.clamp(s.a, 0.0), s.hold); }},
        {"pin(ShellHandle,double)", Call::Hold, [](Stage& s) { return ok(s.shells.pin(s.doomed, 0.0)); }},
        {"drive(HoldHandle,DriveDef)", Call::DriveHold,
         [](Stage& s) {
             DriveDef to = *s.shells.target(s.hold);
             to.position.x += 1e-4;
             return ok(s.shells.drive(s.hold, to));
         }},
        {"join(JointDef)", Call::Join,
         [](Stage& s) {
             JointDef toBody{.kind = JointKind::Weld, .shell = s.b, .arc_fraction = 0.3, .body = 4};
             return keep(s.shells.join(tether(s)), s.string) && keep(s.shells.join(toBody), s.joint);
         }},
        {"drive(JointHandle,DriveDef)", Call::DriveJoint,
         [](Stage& s) {
             return ok(s.shells.drive(s.string, {{0.031, 0.271}, 0.0, {}, 0.0}));
         }},
        {"reel(JointHandle,double,double)", Call::Reel,
         [](Stage& s) { return ok(s.shells.reel(s.string, 0.15, 0.5)); }},
        {"grab(ShellHandle,GrabDef)", Call::Grab,
         [](Stage& s) {
             return keep(s.shells.grab(s.b, {0.9, {0.05, 0.25}, 8.0, 1.0, 0.0}), s.grab);
         }},
        {"move(GrabHandle,Point)", Call::MoveGrab,
         [](Stage& s) {
             return ok(s.shells.move(s.grab, {0.04, 0.26}));
         }},
        {"apply_force(ShellHandle,double,Point,double)", Call::ApplyForce,
         [](Stage& s) {
             return ok(s.shells.apply_force(s.a, 0.7, {0.01, 0.02}, 1e-5));
         }},
        {"apply_torque(ShellHandle,double,double)", Call::ApplyForce,
         [](Stage& s) { return ok(s.shells.apply_torque(s.a, 0.2, -1e-5)); }},
        {"apply_impulse(ShellHandle,double,Point,double)", Call::ApplyImpulse,
         [](Stage& s) {
             return ok(s.shells.apply_impulse(s.b, 0.1, {1e-5, 2e-5}, 1e-8));
         }},
        {"add_force(ShellHandle,double,Point,double)", Call::AddForce,
         [](Stage& s) {
             return keep(s.shells.add_force(s.a, 1.0, {0.0, 0.004}), s.force);
         }},
        {"set_force(ForceHandle,Point,double)", Call::SetForce,
         [](Stage& s) {
             return ok(s.shells.set_force(s.force, {0.002, 0.0}, 1e-6));
         }},
        {"set_velocity(ShellHandle,Point,double)", Call::SetVelocity,
         [](Stage& s) {
             return ok(s.shells.set_velocity(s.a, {0.1, 0.2}, 3.0));
         }},
        {"set_material(ShellHandle,MaterialDef)", Call::SetMaterial,
         [softer](Stage& s) { return ok(s.shells.set_material(s.b, softer)); }},
        {"set_filter(ShellHandle,FilterDef)", Call::SetFilter,
         [](Stage& s) {
             return ok(s.shells.set_filter(s.b, {2, 0xfffd, 3}));
         }},
        {"set_friction(MaterialId,MaterialId,double)", Call::SetFriction,
         [](Stage& s) { return ok(s.shells.set_friction(3, 4, 0.1)) && ok(s.shells.set_friction(3, 5, 0.2)); }},
        {"reset_friction(MaterialId,MaterialId)", Call::ResetFriction,
         [](Stage& s) { return ok(s.shells.reset_friction(5, 3)); }},
        {"set_surface(ShellHandle,MaterialId)", Call::SetShellSurface,
         [](Stage& s) { return ok(s.shells.set_surface(s.a, 3)); }},
        {"set_surface(BodyId,MaterialId)", Call::SetBodySurface,
         [](Stage& s) { return ok(s.shells.set_surface(*s.shells.body("ground"), 4)); }},
        {"set_sleep(SleepSettings)", Call::SetSleep,
         [](Stage& s) {
             return ok(s.shells.set_sleep({true, 0.2, 0.1}));
         }},
        {"carry(string)", Call::Carry, [](Stage& s) { return ok(s.shells.carry("left wall")); }},
        {"set_machine_velocity(Point)", Call::MachineVelocity,
         [](Stage& s) {
             return ok(s.shells.set_machine_velocity({0.01, -0.1}));
         }},
        {"pre_step(double,function<bool()>)", Call::PreStep,
         [](Stage& s) {
             const FrameReport r = s.shells.pre_step(2e-3, [] { return true; });
             s.host->step(r.advanced);
             return r.stopped;
         }},
        {"post_step()", Call::PostStep, [](Stage& s) { return ok(s.shells.post_step()); }},
        {"set_event_settings(EventSettings)", Call::SetEventSettings,
         [](Stage& s) {
             EventSettings e;
             e.snap_energy *= 2.0;
             return ok(s.shells.set_event_settings(e));
         }},
        {"set_name(ShellHandle,string)", Call::SetName, [](Stage& s) { return ok(s.shells.set_name(s.b, "bee")); }},
        {"set_user_data(ShellHandle,uint64_t)", Call::SetUserData,
         [](Stage& s) { return ok(s.shells.set_user_data(s.b, 1ull << 40)); }},
        {"restore(Snapshot)", Call::Restore, [](Stage& s) { return ok(s.shells.restore(s.shells.save())); }},
        {"release(GrabHandle)", Call::ReleaseGrab, [](Stage& s) { return ok(s.shells.release(s.grab)); }},
        {"release(ForceHandle)", Call::ReleaseForce, [](Stage& s) { return ok(s.shells.release(s.force)); }},
        {"release(HoldHandle)", Call::ReleaseHold, [](Stage& s) { return ok(s.shells.release(s.hold)); }},
        {"teleport(ShellHandle,Point,double)", Call::Teleport,
         [](Stage& s) {
             return ok(s.shells.teleport(s.a, {-0.03, 0.02}, 0.1));
         }},
        {"sleep(ShellHandle)", Call::Sleep, [](Stage& s) { return ok(s.shells.sleep(s.a)); }},
        {"wake(ShellHandle)", Call::Wake, [](Stage& s) { return ok(s.shells.wake(s.a)); }},
        {"release(JointHandle)", Call::ReleaseJoint, [](Stage& s) { return ok(s.shells.release(s.string)); }},
        {"destroy(ShellHandle)", Call::Destroy, [](Stage& s) { return ok(s.shells.destroy(s.doomed)); }},
    };
}

} // namespace

TEST_CASE("every changing call of the header is in the table of the log", "[plugin][log]") {
    std::set<std::string> declared = changingCalls(),
                          listed{"set_threads(int)", // changes no result
                                 "start_log(uint64_t)", "stop_log()", "replay(CallLog,function<bool(double)>)"};
    CHECK(declared.size() > 40); // else the header was not understood
    for (const Entry& e : table())
        listed.insert(e.declaration);
    for (const std::string& d : declared) {
        INFO("no record in the log, or none in this test: " << d);
        CHECK(listed.count(d) == 1);
    }
    for (const std::string& l : listed) {
        INFO("not in the header any more: " << l);
        CHECK(declared.count(l) == 1);
    }
}

TEST_CASE("every changing call leaves its record, and the log plays back to the same bits", "[plugin][log]") {
    Stage s;
    const auto bodies = s.host->bodies;
    REQUIRE(s.shells.start_log(7));
    std::vector<int> before = recordsOf(s.shells.log());
    for (const Entry& e : table()) {
        INFO(e.declaration);
        REQUIRE(e.make(s));
        const std::vector<int> after = recordsOf(s.shells.log());
        CHECK(after[static_cast<std::size_t>(e.record)] > before[static_cast<std::size_t>(e.record)]);
        before = after;
        // Each is played back on its own: a wrong record is found at its call.
        auto host = tumbleHost();
        host->bodies = bodies;
        Shells other(host);
        const Outcome played = other.replay(s.shells.log(), [&](double advanced) {
            host->step(advanced);
            return true;
        });
        INFO(played.error());
        REQUIRE(played);
        CHECK(other.hash() == s.shells.hash());
        CHECK((other.save().bytes() == s.shells.save().bytes())); // names, user data and counters too
        if (!s.shells.list().empty() && e.record != Call::PreStep)
            s.frames(3);
    }
    for (std::size_t call = static_cast<std::size_t>(Call::Restore); call < before.size(); ++call) {
        INFO("kind of record " << call);
        CHECK(before[call] > 0);
    }
}

TEST_CASE("a restored state with joints to bodies goes on as if nothing had happened", "[plugin][log]") {
    Stage s;
    s.a = s.make({-0.03, 0.05}, 0.3);
    s.b = s.make({0.03, 0.20}, 1.3);
    REQUIRE(s.shells.join({.kind = JointKind::Pin, .shell = s.a, .arc_fraction = 0.8, .body = 4}));
    REQUIRE(s.shells.join({.kind = JointKind::Weld, .shell = s.b, .arc_fraction = 0.1, .body = 5}));
    REQUIRE(s.shells.join({.kind = JointKind::Tether, .shell = s.a, .other = s.b}));
    REQUIRE(s.shells.set_machine_velocity({0.0, -0.2}));
    s.frames(60);
    const Snapshot then = s.shells.save();
    const auto bodies = s.host->bodies;
    s.frames(150);
    const std::uint64_t end = s.shells.hash();
    REQUIRE(s.shells.restore(then));
    s.host->bodies = bodies;
    s.frames(150);
    CHECK(s.shells.hash() == end);
    auto host = tumbleHost();
    host->bodies = bodies;
    Shells fresh(host);
    REQUIRE(fresh.restore(*Snapshot::from_bytes(then.bytes())));
    for (int f = 0; f < 150; ++f) {
        host->step(fresh.pre_step(1e-3).advanced);
        REQUIRE(fresh.post_step());
    }
    CHECK(fresh.hash() == end);
}

TEST_CASE("a log taken or ended by an observer has no frame without an end", "[plugin][log]") {
    Stage s;
    s.a = s.make({-0.03, 0.05}, 0.3);
    const auto bodies = s.host->bodies;
    REQUIRE(s.shells.start_log());
    s.frames(2);
    const std::uint64_t before = s.shells.hash();
    CallLog taken;
    REQUIRE(s.shells
                .pre_step(1e-3,
                          [&] {
                              taken = s.shells.log();
                              s.shells.stop_log();
                              return false;
                          })
                .failure.empty());
    CHECK(taken.frames() == 2);
    CHECK(s.shells.log().frames() == 2);
    auto host = tumbleHost();
    host->bodies = bodies;
    Shells other(host);
    REQUIRE(other.replay(taken, [&](double advanced) {
        host->step(advanced);
        return true;
    }));
    CHECK(other.hash() == before);
}

TEST_CASE("an observer that throws stops its frame in order", "[plugin][log]") {
    Stage s;
    s.a = s.make({-0.03, 0.05}, 0.3);
    const auto bodies = s.host->bodies;
    REQUIRE(s.shells.start_log());
    REQUIRE(s.shells.apply_force(s.a, 0.5, {0.01, 0.0}));
    const FrameReport r = s.shells.pre_step(0.02, []() -> bool { throw std::runtime_error("enough"); });
    CHECK(r.failure == "enough");
    CHECK(r.stopped);
    CHECK(r.advanced > 0.0);
    s.host->step(r.advanced);
    REQUIRE(s.shells.post_step());
    auto host = tumbleHost();
    host->bodies = bodies;
    Shells other(host);
    REQUIRE(other.replay(s.shells.log(), [&](double advanced) {
        host->step(advanced);
        return true;
    }));
    CHECK(other.hash() == s.shells.hash());
}
