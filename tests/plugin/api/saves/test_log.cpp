// Every changing call of Shells is in the log, and a replay of the log is bitwise identical. The changing calls are
// read from the header: a new one that is missing in the log or in this table makes a test fail.

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

/// Declarations of the class that return a Status, a handle or a report and are not const, without blanks and names of
/// parameters: "set_target(HoldHandle,TargetDef)".
std::set<std::string> changingCalls() {
    std::string text = contentOf(std::string(SC_SOURCE_DIR) + "/plugin/api/include/supercircle/shells.hpp");
    text = std::regex_replace(text, std::regex("//[^\n]*"), "");
    text = text.substr(text.find("\nclass Shells "));
    static const std::regex call(
        R"((?:Status|Result<\w+Handle>|FrameReport|void)\s+(\w+)\(((?:[^;{]|\{\})*?)\)(\s*const)?\s*[;{])");
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

struct LoggedWorld {
    std::shared_ptr<FakeHost> host = tumbleHost();
    Shells shells{host};
    ShellHandle a, b, doomed;
    HoldHandle hold;
    JointHandle string, joint;
    MouseJointHandle mouseJoint;
    ForceHandle force;
    Snapshot saved;

    LoggedWorld() {
        const Status carried = shells.attach_to_crosshead("plate");
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
    Call record; ///< its kind in the log; Restore: a call that changes no shell
    std::function<bool(LoggedWorld&)> make;
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

JointDef tether(const LoggedWorld& s) {
    return {.kind = JointKind::Tether, .shell = s.b, .point = {0.03, 0.27}, .length = 0.2};
}

/// In an order in which each can be made.
std::vector<Entry> table() {
    const MaterialDef softer{.mu = 0.6, .young_modulus = 1e9, .density = 900.0, .natural_curvature = {{60.0}}};
    return {
        {"set_quality(Quality)", Call::SetQuality,
         [](LoggedWorld& s) { return ok(s.shells.set_quality(Quality::Game)); }},
        {"set_frame_budget(uint64_t)", Call::SetFrameBudget,
         [](LoggedWorld& s) { return ok(s.shells.set_frame_budget(30000)); }},
        {"set_crush_policy(CrushPolicy)", Call::SetCrushPolicy,
         [](LoggedWorld& s) { return ok(s.shells.set_crush_policy(CrushPolicy::Freeze)); }},
        {"create(ShellDef)", Call::Create,
         [](LoggedWorld& s) {
             s.a = s.make({-0.03, 0.05}, 0.3);
             s.b = s.make({0.03, 0.20}, 1.3);
             s.doomed = s.make({-0.04, 0.15}, 2.3);
             return true;
         }},
        {"create_hold(ShellHandle,double,HoldKind,HoldBase)", Call::CreateHold,
         [](LoggedWorld& s) { return ok(s.shells.create_hold(s.doomed, 1.0, HoldKind::Pin, HoldBase::Moving)); }},
        {"create_clamp(ShellHandle,double)", Call::CreateHold,
         [](LoggedWorld& s) { return keep(s.shells.create_clamp(s.a, 0.0), s.hold); }},
        {"create_pin(ShellHandle,double)", Call::CreateHold,
         [](LoggedWorld& s) { return ok(s.shells.create_pin(s.doomed, 0.0)); }},
        {"set_target(HoldHandle,TargetDef)", Call::SetHoldTarget,
         [](LoggedWorld& s) {
             TargetDef to = *s.shells.target(s.hold);
             to.position.x += 1e-4;
             return ok(s.shells.set_target(s.hold, to));
         }},
        {"create_joint(JointDef)", Call::CreateJoint,
         [](LoggedWorld& s) {
             JointDef toBody{.kind = JointKind::Weld, .shell = s.b, .arc_fraction = 0.3, .body = 4};
             return keep(s.shells.create_joint(tether(s)), s.string) && keep(s.shells.create_joint(toBody), s.joint);
         }},
        {"set_target(JointHandle,TargetDef)", Call::SetJointTarget,
         [](LoggedWorld& s) {
             return ok(s.shells.set_target(s.string, {{0.031, 0.271}, 0.0, {}, 0.0}));
         }},
        {"set_max_length(JointHandle,double,double)", Call::SetMaxLength,
         [](LoggedWorld& s) { return ok(s.shells.set_max_length(s.string, 0.15, 0.5)); }},
        {"set_max_force(HoldHandle,double)", Call::SetHoldMaxForce,
         [](LoggedWorld& s) { return ok(s.shells.set_max_force(s.hold, 1e3)); }},
        {"set_max_force(JointHandle,double)", Call::SetJointMaxForce,
         [](LoggedWorld& s) { return ok(s.shells.set_max_force(s.joint, 1e3)); }},
        {"create_mouse_joint(ShellHandle,MouseJointDef)", Call::CreateMouseJoint,
         [](LoggedWorld& s) {
             return keep(s.shells.create_mouse_joint(s.b, {0.9, {0.05, 0.25}, 8.0, 1.0, 0.0}), s.mouseJoint);
         }},
        {"set_target(MouseJointHandle,Point)", Call::SetMouseJointTarget,
         [](LoggedWorld& s) {
             return ok(s.shells.set_target(s.mouseJoint, {0.04, 0.26}));
         }},
        {"apply_force(ShellHandle,double,Point,double)", Call::ApplyForce,
         [](LoggedWorld& s) {
             return ok(s.shells.apply_force(s.a, 0.7, {0.01, 0.02}, 1e-5));
         }},
        {"apply_torque(ShellHandle,double,double)", Call::ApplyForce,
         [](LoggedWorld& s) { return ok(s.shells.apply_torque(s.a, 0.2, -1e-5)); }},
        {"apply_impulse(ShellHandle,double,Point,double)", Call::ApplyImpulse,
         [](LoggedWorld& s) {
             return ok(s.shells.apply_impulse(s.b, 0.1, {1e-5, 2e-5}, 1e-8));
         }},
        {"create_force(ShellHandle,double,Point,double)", Call::CreateForce,
         [](LoggedWorld& s) {
             return keep(s.shells.create_force(s.a, 1.0, {0.0, 0.004}), s.force);
         }},
        {"set_force(ForceHandle,Point,double)", Call::SetForce,
         [](LoggedWorld& s) {
             return ok(s.shells.set_force(s.force, {0.002, 0.0}, 1e-6));
         }},
        {"set_velocity(ShellHandle,Point,double)", Call::SetVelocity,
         [](LoggedWorld& s) {
             return ok(s.shells.set_velocity(s.a, {0.1, 0.2}, 3.0));
         }},
        {"set_material(ShellHandle,MaterialDef)", Call::SetMaterial,
         [softer](LoggedWorld& s) { return ok(s.shells.set_material(s.b, softer)); }},
        {"set_filter(ShellHandle,FilterDef)", Call::SetFilter,
         [](LoggedWorld& s) {
             return ok(s.shells.set_filter(s.b, {2, 0xfffd, 3}));
         }},
        {"set_friction(FrictionMaterial,FrictionMaterial,double)", Call::SetFriction,
         [](LoggedWorld& s) { return ok(s.shells.set_friction(3, 4, 0.1)) && ok(s.shells.set_friction(3, 5, 0.2)); }},
        {"reset_friction(FrictionMaterial,FrictionMaterial)", Call::ResetFriction,
         [](LoggedWorld& s) { return ok(s.shells.reset_friction(5, 3)); }},
        {"set_friction_material(ShellHandle,FrictionMaterial)", Call::SetShellFrictionMaterial,
         [](LoggedWorld& s) { return ok(s.shells.set_friction_material(s.a, 3)); }},
        {"set_friction_material(BodyId,FrictionMaterial)", Call::SetBodyFrictionMaterial,
         [](LoggedWorld& s) { return ok(s.shells.set_friction_material(*s.shells.body("ground"), 4)); }},
        {"set_effects(EffectTarget,string,vector<EffectValue>)", Call::SetEffect,
         [](LoggedWorld& s) {
             return ok(s.shells.set_effects(s.a, "plasticity", {{"hardening", "kinematic"}, {"H_over_B", 0.1}})) &&
                    ok(s.shells.set_effects(all_shells, "wear"));
         }},
        {"replace_effects(EffectTarget,vector<EffectDef>)", Call::ReplaceEffects,
         [](LoggedWorld& s) {
             return ok(
                 s.shells.replace_effects(s.b, {{"planar_drag", {{"f_N_m", 0.01}}}, {"viscoelastic_bending", {}}}));
         }},
        {"remove_effect(EffectTarget,string)", Call::RemoveEffect,
         [](LoggedWorld& s) { return ok(s.shells.remove_effect(all_shells, "wear")); }},
        {"set_surface_speed(BodyId,double,uint32_t)", Call::SetSurfaceSpeed,
         [](LoggedWorld& s) { return ok(s.shells.set_surface_speed(*s.shells.body("ground"), 0.1)); }},
        {"shift_origin(Point)", Call::ShiftOrigin,
         [](LoggedWorld& s) {
             return ok(s.shells.shift_origin({0.25, -0.5}));
         }},
        {"set_recovery(RecoverySettings)", Call::SetRecovery,
         [](LoggedWorld& s) {
             return ok(s.shells.set_recovery({Recovery::Release, 0.5}));
         }},
        {"set_sleep(SleepSettings)", Call::SetSleep,
         [](LoggedWorld& s) {
             return ok(s.shells.set_sleep({true, 0.2, 0.1}));
         }},
        {"attach_to_crosshead(string)", Call::AttachToCrosshead,
         [](LoggedWorld& s) { return ok(s.shells.attach_to_crosshead("left wall")); }},
        {"set_crosshead_velocity(Point)", Call::SetCrossheadVelocity,
         [](LoggedWorld& s) {
             return ok(s.shells.set_crosshead_velocity({0.01, -0.1}));
         }},
        {"pre_step(double,function<bool()>)", Call::PreStep,
         [](LoggedWorld& s) {
             const FrameReport r = s.shells.pre_step(2e-3, [] { return true; });
             s.host->step(r.advanced);
             return r.stopped;
         }},
        {"post_step()", Call::PostStep, [](LoggedWorld& s) { return ok(s.shells.post_step()); }},
        {"set_event_settings(EventSettings)", Call::SetEventSettings,
         [](LoggedWorld& s) {
             EventSettings e;
             e.snap_energy *= 2.0;
             return ok(s.shells.set_event_settings(e));
         }},
        {"set_name(ShellHandle,string)", Call::SetName,
         [](LoggedWorld& s) { return ok(s.shells.set_name(s.b, "bee")); }},
        {"set_user_data(ShellHandle,uint64_t)", Call::SetUserData,
         [](LoggedWorld& s) { return ok(s.shells.set_user_data(s.b, 1ull << 40)); }},
        {"restore(Snapshot)", Call::Restore, [](LoggedWorld& s) { return ok(s.shells.restore(s.shells.save())); }},
        {"destroy(MouseJointHandle)", Call::DestroyMouseJoint,
         [](LoggedWorld& s) { return ok(s.shells.destroy(s.mouseJoint)); }},
        {"destroy(ForceHandle)", Call::DestroyForce, [](LoggedWorld& s) { return ok(s.shells.destroy(s.force)); }},
        {"destroy(HoldHandle)", Call::DestroyHold, [](LoggedWorld& s) { return ok(s.shells.destroy(s.hold)); }},
        {"teleport(ShellHandle,Point,double)", Call::Teleport,
         [](LoggedWorld& s) {
             return ok(s.shells.teleport(s.a, {-0.03, 0.02}, 0.1));
         }},
        {"sleep(ShellHandle)", Call::Sleep, [](LoggedWorld& s) { return ok(s.shells.sleep(s.a)); }},
        {"wake(ShellHandle)", Call::Wake, [](LoggedWorld& s) { return ok(s.shells.wake(s.a)); }},
        {"destroy(JointHandle)", Call::DestroyJoint, [](LoggedWorld& s) { return ok(s.shells.destroy(s.string)); }},
        {"destroy(ShellHandle)", Call::Destroy, [](LoggedWorld& s) { return ok(s.shells.destroy(s.doomed)); }},
    };
}

} // namespace

TEST_CASE("every changing call of the header is in the table of the log", "[plugin][log]") {
    std::set<std::string> declared = changingCalls(),
                          listed{"set_threads(int)", // changes no result
                                 "start_log(uint64_t)", "stop_log()",
                                 "set_pair_filter(function<bool(PairQuery)>)", // cannot be written down
                                 "replay(CallLog,function<bool(double)>)"};
    CHECK(declared.size() > 40); // else the header was not understood
    for (const Entry& e : table())
        listed.insert(e.declaration);
    for (const std::string& d : declared) {
        INFO("no record in the log, or none in this test: " << d);
        CHECK(listed.count(d) == 1);
    }
    for (const std::string& l : listed) {
        INFO("not in the header: " << l);
        CHECK(declared.count(l) == 1);
    }
}

TEST_CASE("every changing call has its record, and the replay is bitwise identical", "[plugin][log]") {
    LoggedWorld s;
    const auto bodies = s.host->bodies;
    REQUIRE(s.shells.start_log(7));
    std::vector<int> before = recordsOf(s.shells.log());
    for (const Entry& e : table()) {
        INFO(e.declaration);
        REQUIRE(e.make(s));
        const std::vector<int> after = recordsOf(s.shells.log());
        CHECK(after[static_cast<std::size_t>(e.record)] > before[static_cast<std::size_t>(e.record)]);
        before = after;
        // Replayed after each call, so that a wrong record is found at its call.
        auto host = tumbleHost();
        host->bodies = bodies;
        Shells other(host);
        const Status played = other.replay(s.shells.log(), [&](double advanced) {
            host->step(advanced);
            return true;
        });
        INFO(played.error());
        REQUIRE(played);
        CHECK(other.hash() == s.shells.hash());
        CHECK((other.save().bytes() == s.shells.save().bytes())); // names, user data and counters too
        if (!s.shells.shells().empty() && e.record != Call::PreStep)
            s.frames(3);
    }
    for (std::size_t call = static_cast<std::size_t>(Call::Restore); call < before.size(); ++call) {
        INFO("kind of record " << call);
        CHECK(before[call] > 0);
    }
}

TEST_CASE("a restored state with joints to bodies continues bitwise identically", "[plugin][log]") {
    LoggedWorld s;
    s.a = s.make({-0.03, 0.05}, 0.3);
    s.b = s.make({0.03, 0.20}, 1.3);
    REQUIRE(s.shells.create_joint({.kind = JointKind::Pin, .shell = s.a, .arc_fraction = 0.8, .body = 4}));
    REQUIRE(s.shells.create_joint({.kind = JointKind::Weld, .shell = s.b, .arc_fraction = 0.1, .body = 5}));
    REQUIRE(s.shells.create_joint({.kind = JointKind::Tether, .shell = s.a, .other = s.b}));
    REQUIRE(s.shells.set_crosshead_velocity({0.0, -0.2}));
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

TEST_CASE("a log taken or ended by an observer has no unfinished frame", "[plugin][log]") {
    LoggedWorld s;
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

TEST_CASE("an observer that throws ends its frame regularly", "[plugin][log]") {
    LoggedWorld s;
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
