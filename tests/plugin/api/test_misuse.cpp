// Every call with null, stale, foreign and invented handles, and with numbers that are not finite: it fails with a
// reason and changes no bit of the state. So with finite numbers whose squares or quotients are not finite.

#include "tests/plugin/api/support.h"
#include "tests/support/tumble.h"

#include <functional>

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// A world with one of everything.
struct Everything {
    std::shared_ptr<FakeHost> host = emptyHost(kG);
    Shells shells{nullptr};
    ShellHandle a, b;
    HoldHandle hold;
    JointHandle joint, string;
    MouseJointHandle mouseJoint;
    ForceHandle force;

    Everything() {
        host->addGround(1, 0.4, {0.0, -1.0});
        host->add(2, "puck", {0.0, 0.1}, 0.0, 0.01, 1e-5);
        shells = Shells(host);
        a = *shells.create(strip(0.1, {0.0, 0.0}));
        b = *shells.create(strip(0.1, {0.2, 0.0}));
        hold = *shells.create_clamp(a, 0.0);
        JointDef j;
        j.shell = a;
        j.body = 2;
        joint = *shells.create_joint(j);
        j = {};
        j.kind = JointKind::Tether;
        j.shell = b;
        j.point = {0.2, 0.1};
        string = *shells.create_joint(j);
        mouseJoint = *shells.create_mouse_joint(b, {});
        force = *shells.create_force(b, 0.5, {0.0, 1e-3});
        advance(shells, host.get(), 0.01, 2);
    }
};

/// The state that must not change, as bytes.
std::string fingerprint(const Shells& shells) {
    std::string s;
    const auto add = [&](double x) { s.append(reinterpret_cast<const char*>(&x), sizeof x); };
    const step::World& w = shells.world();
    for (const step::Rod& r : w.rods) {
        for (Eigen::Index i = 0; i < r.q.size(); ++i) {
            add(r.q[i]);
            add(r.v[i]);
        }
        for (const Vec2& u : r.u)
            add(u.sum());
        for (const step::Hold& h : r.holds)
            add(h.target.point.sum() + h.target.path.to.sum() + h.target.path.toAngle + h.target.velocity.sum() +
                (h.target.pending ? 1 : 0));
        for (const step::MouseJoint& g : r.mouseJoints)
            add(g.target.sum() + g.stiffness);
        for (const step::AppliedForce& f : r.forces)
            add(f.force.sum() + f.torque + f.s);
        add(r.mu + r.material + r.category + r.mask + r.group + r.model.definition().bendingModulus);
        add(r.island + r.stillTime);
    }
    for (const step::Link& l : w.links)
        add(l.length + l.goal + l.reel + l.target.point.sum() + l.target.path.to.sum() + (l.target.pending ? 1 : 0));
    for (const step::PairFriction& p : w.pairFriction)
        add(p.mu);
    add(static_cast<double>(w.links.size() + w.bodyMaterials.size() + w.nextPart + w.nextKey));
    add(w.energyBalance.added + w.energyBalance.work + w.crossheadVelocity.sum());
    add(shells.sleep_settings().drift + shells.sleep_settings().delay);
    return s;
}

template <class R>
void failsWith(const char* what, const R& r) {
    INFO(what);
    CHECK_FALSE(r);
    CHECK(r.error().size() > 10);
}

using Numbers = std::vector<double>;

} // namespace

TEST_CASE("every call fails with a null, stale, foreign or invented handle", "[plugin]") {
    Everything e, foreign;
    Shells& s = e.shells;
    const ShellHandle stale = *s.create(strip(0.05, {1.0, 0.0}));
    const HoldHandle staleHold = *s.create_pin(stale, 0.5);
    const MouseJointHandle staleMouseJoint = *s.create_mouse_joint(stale, {});
    const ForceHandle staleForce = *s.create_force(stale, 0.5, {});
    JointDef j;
    j.kind = JointKind::Tether;
    j.shell = stale;
    j.point = {1.0, 1.0};
    const JointHandle staleJoint = *s.create_joint(j);
    REQUIRE(s.valid(staleHold));
    REQUIRE(s.valid(staleJoint));
    REQUIRE(s.destroy(stale)); // with its constraints
    const std::string before = fingerprint(s);
    for (const ShellHandle h : {ShellHandle{}, stale, foreign.a, ShellHandle{99, 1, e.a.world},
                                ShellHandle{e.a.index, 77, e.a.world}, ShellHandle{~0u, ~0u, ~0u}}) {
        CHECK_FALSE(s.valid(h));
        failsWith("destroy", s.destroy(h));
        failsWith("create_hold", s.create_hold(h, 0.5, HoldKind::Pin));
        failsWith("create_mouse_joint", s.create_mouse_joint(h, {}));
        failsWith("create_force", s.create_force(h, 0.5, {}));
        failsWith("apply_force", s.apply_force(h, 0.5, {}));
        failsWith("apply_torque", s.apply_torque(h, 0.5, 1.0));
        failsWith("apply_impulse", s.apply_impulse(h, 0.5, {}));
        failsWith("teleport", s.teleport(h, {}, 0.0));
        failsWith("set_velocity", s.set_velocity(h, {}));
        failsWith("set_material", s.set_material(h, {}));
        failsWith("set_filter", s.set_filter(h, {}));
        failsWith("filter", s.filter(h));
        failsWith("set_friction_material", s.set_friction_material(h, 1));
        failsWith("sleep", s.sleep(h));
        failsWith("wake", s.wake(h));
        failsWith("asleep", s.asleep(h));
        failsWith("pose", s.pose(h));
        JointDef d;
        d.shell = h;
        d.body = 2;
        failsWith("create_joint", s.create_joint(d));
        d.shell = e.a;
        d.body = 0;
        d.other = h;
        failsWith("create_joint to a shell", s.create_joint(d));
    }
    for (const HoldHandle h : {HoldHandle{}, staleHold, foreign.hold, HoldHandle{e.hold.index, 999, e.hold.world},
                               HoldHandle{999, e.hold.generation, e.hold.world},
                               HoldHandle{e.force.index, e.force.generation, e.force.world}}) {
        CHECK_FALSE(s.valid(h));
        failsWith("set_target", s.set_target(h, {}));
        failsWith("target", s.target(h));
        failsWith("reaction", s.reaction(h));
        failsWith("destroy", s.destroy(h));
    }
    for (const JointHandle h : {JointHandle{}, staleJoint, foreign.joint, JointHandle{0, 999, e.joint.world},
                                JointHandle{0, e.hold.generation, e.joint.world}}) {
        CHECK_FALSE(s.valid(h));
        failsWith("set_target", s.set_target(h, {}));
        failsWith("target", s.target(h));
        failsWith("set_max_length", s.set_max_length(h, 1.0, 1.0));
        failsWith("length", s.length(h));
        failsWith("reaction", s.reaction(h));
        failsWith("destroy", s.destroy(h));
    }
    for (const MouseJointHandle h : {MouseJointHandle{}, staleMouseJoint, foreign.mouseJoint,
                                     MouseJointHandle{e.mouseJoint.index, 999, e.mouseJoint.world}}) {
        CHECK_FALSE(s.valid(h));
        failsWith("set_target", s.set_target(h, {}));
        failsWith("reaction", s.reaction(h));
        failsWith("destroy", s.destroy(h));
    }
    for (const ForceHandle h : {ForceHandle{}, staleForce, foreign.force}) {
        CHECK_FALSE(s.valid(h));
        failsWith("set_force", s.set_force(h, {}));
        failsWith("destroy", s.destroy(h));
    }
    for (const BodyId id : {BodyId{0}, BodyId{999}}) {
        failsWith("set_friction_material", s.set_friction_material(id, 1));
        JointDef d;
        d.shell = e.a;
        d.body = id;
        failsWith("create_joint to a body", s.create_joint(d));
    }
    failsWith("body", s.body("nobody"));
    failsWith("attach_to_crosshead", s.attach_to_crosshead("nobody"));
    failsWith("a shell and a body", [&] {
        JointDef d;
        d.shell = e.a;
        d.other = e.b;
        d.body = 2;
        return s.create_joint(d);
    }());
    failsWith("a point with itself", [&] {
        JointDef d;
        d.shell = d.other = e.a;
        return s.create_joint(d);
    }());
    failsWith("set_target of a weld", s.set_target(e.joint, {}));
    failsWith("target of a weld", s.target(e.joint));
    failsWith("set_max_length of a weld", s.set_max_length(e.joint, 1.0, 1.0));
    failsWith("length of a weld", s.length(e.joint));
    CHECK(fingerprint(s) == before);
    const FrameReport r = s.pre_step(0.01);
    CHECK(r.failure.empty()); // the world goes on
}

TEST_CASE("every call fails with numbers that are not finite or out of range", "[plugin]") {
    Everything e;
    Shells& s = e.shells;
    const std::string before = fingerprint(s);
    for (const double bad : {kNan, kInf, -kInf}) {
        INFO("number " << bad);
        for (const Point p : {Point{bad, 0.0}, Point{0.0, bad}}) {
            failsWith("set_target", s.set_target(e.hold, {p, 0.0, {}, 0.0}));
            failsWith("set_target", s.set_target(e.hold, {{}, 0.0, p, 0.0}));
            failsWith("set_target", s.set_target(e.string, {p, 0.0, {}, 0.0}));
            failsWith("set_target", s.set_target(e.mouseJoint, p));
            failsWith("create_force", s.create_force(e.a, 0.5, p));
            failsWith("set_force", s.set_force(e.force, p));
            failsWith("apply_force", s.apply_force(e.a, 0.5, p));
            failsWith("apply_impulse", s.apply_impulse(e.a, 0.5, p));
            failsWith("teleport", s.teleport(e.b, p, 0.0));
            failsWith("set_velocity", s.set_velocity(e.b, p));
            failsWith("set_crosshead_velocity", s.set_crosshead_velocity(p));
            MouseJointDef g;
            g.target = p;
            failsWith("create_mouse_joint", s.create_mouse_joint(e.a, g));
            JointDef d;
            d.kind = JointKind::Tether;
            d.shell = e.a;
            d.point = p;
            failsWith("create_joint", s.create_joint(d));
        }
        failsWith("set_target", s.set_target(e.hold, {{}, bad, {}, 0.0}));
        failsWith("set_target", s.set_target(e.hold, {{}, 0.0, {}, bad}));
        failsWith("create_force", s.create_force(e.a, 0.5, {}, bad));
        failsWith("set_force", s.set_force(e.force, {}, bad));
        failsWith("apply_torque", s.apply_torque(e.a, 0.5, bad));
        failsWith("apply_impulse", s.apply_impulse(e.a, 0.5, {}, bad));
        failsWith("teleport", s.teleport(e.b, {}, bad));
        failsWith("set_velocity", s.set_velocity(e.b, {}, bad));
        failsWith("set_max_length", s.set_max_length(e.string, bad, 1.0));
        failsWith("set_max_length", s.set_max_length(e.string, 1.0, bad));
        failsWith("set_friction", s.set_friction(1, 2, bad));
        MaterialDef m;
        m.natural_curvature = {bad};
        failsWith("natural_curvature", s.set_material(e.a, m));
    }
    for (const double bad : {-0.1, 1.1, kNan, kInf, -kInf}) { // fractions
        failsWith("create_hold", s.create_hold(e.a, bad, HoldKind::Pin));
        failsWith("create_force", s.create_force(e.a, bad, {}));
        failsWith("apply_force", s.apply_force(e.a, bad, {}));
        failsWith("apply_impulse", s.apply_impulse(e.a, bad, {}));
        MouseJointDef g;
        g.arc_fraction = bad;
        failsWith("create_mouse_joint", s.create_mouse_joint(e.a, g));
        JointDef d;
        d.shell = e.a;
        d.body = 2;
        d.arc_fraction = bad;
        failsWith("create_joint", s.create_joint(d));
    }
    for (const double bad : {0.0, -1.0, kNan, kInf}) { // positive ones
        MaterialDef m;
        m.young_modulus = bad;
        failsWith("young_modulus", s.set_material(e.a, m));
        m = {};
        m.density = bad;
        failsWith("density", s.set_material(e.a, m));
        MouseJointDef g;
        g.frequency = bad;
        failsWith("frequency", s.create_mouse_joint(e.a, g));
        SleepSettings z;
        z.drift = bad;
        failsWith("sleep", s.set_sleep(z));
        failsWith("set_max_length", s.set_max_length(e.string, bad, 1.0));
        failsWith("set_max_length", s.set_max_length(e.string, 1.0, bad));
    }
    for (const double bad : {-1.0, kNan, kInf}) { // not negative
        MaterialDef m;
        m.mu = bad;
        failsWith("mu", s.set_material(e.a, m));
        MouseJointDef g;
        g.damping_ratio = bad;
        failsWith("damping", s.create_mouse_joint(e.a, g));
        g = {};
        g.max_force = bad;
        failsWith("max_force", s.create_mouse_joint(e.a, g));
        SleepSettings z;
        z.delay = bad;
        failsWith("sleep", s.set_sleep(z));
        JointDef d;
        d.kind = JointKind::Tether;
        d.shell = e.a;
        d.length = bad;
        failsWith("length", s.create_joint(d));
        failsWith("friction", s.set_friction(1, 2, bad));
    }
    MaterialDef m;
    m.natural_curvature = std::vector<double>(3, 1.0);
    failsWith("too few curvatures", s.set_material(e.a, m));
    failsWith("friction of nothing", s.set_friction(0, 1, 0.5));
    failsWith("friction never set", s.reset_friction(5, 6));
    failsWith("held", s.teleport(e.a, {}, 0.0));
    failsWith("joined", s.teleport(e.b, {}, 0.0));
    failsWith("short", [&] {
        JointDef d;
        d.kind = JointKind::Tether;
        d.shell = e.a;
        d.point = {5.0, 0.0};
        d.length = 1.0;
        return s.create_joint(d);
    }());
    failsWith("nothing at the other end", [&] {
        JointDef d;
        d.shell = e.a;
        return s.create_joint(d);
    }());
    CHECK(fingerprint(s) == before);
}

TEST_CASE("an observer reads but does not change", "[plugin]") {
    Everything e;
    Shells& s = e.shells;
    int calls = 0;
    const FrameReport r = s.pre_step(0.01, [&] {
        const std::string before = fingerprint(s);
        const auto failsNow = [&](const auto& outcome) {
            CHECK_FALSE(outcome);
            CHECK(outcome.error() == kWorldLocked);
        };
        failsNow(s.create(ShellDef{}));
        failsNow(s.destroy(e.a));
        failsNow(s.create_hold(e.a, 0.5, HoldKind::Pin));
        failsNow(s.set_target(e.hold, {}));
        failsNow(s.destroy(e.hold));
        failsNow(s.create_joint(JointDef{}));
        failsNow(s.set_target(e.string, {}));
        failsNow(s.set_max_length(e.string, 1.0, 1.0));
        failsNow(s.destroy(e.joint));
        failsNow(s.create_mouse_joint(e.a, {}));
        failsNow(s.set_target(e.mouseJoint, {}));
        failsNow(s.destroy(e.mouseJoint));
        failsNow(s.apply_force(e.a, 0.5, {}));
        failsNow(s.apply_torque(e.a, 0.5, 1.0));
        failsNow(s.apply_impulse(e.a, 0.5, {}));
        failsNow(s.create_force(e.a, 0.5, {}));
        failsNow(s.set_force(e.force, {}));
        failsNow(s.destroy(e.force));
        failsNow(s.teleport(e.a, {}, 0.0));
        failsNow(s.set_velocity(e.a, {}));
        failsNow(s.set_material(e.a, {}));
        failsNow(s.set_filter(e.a, {}));
        failsNow(s.set_friction(1, 2, 0.5));
        failsNow(s.reset_friction(1, 2));
        failsNow(s.set_friction_material(e.a, 1));
        failsNow(s.set_friction_material(BodyId{1}, 1));
        failsNow(s.attach_to_crosshead("puck"));
        failsNow(s.set_crosshead_velocity({}));
        failsNow(s.set_sleep({}));
        failsNow(s.sleep(e.a));
        failsNow(s.wake(e.a));
        failsNow(s.post_step());
        CHECK(s.pre_step(0.01).failure == kWorldLocked);
        CHECK(s.valid(e.a)); // reading goes on
        CHECK(s.pose(e.a));
        CHECK(s.reaction(e.hold));
        CHECK(s.target(e.hold));
        CHECK(s.filter(e.a));
        CHECK(s.body("puck"));
        CHECK(fingerprint(s) == before);
        return ++calls == 2;
    });
    CHECK(r.stopped);
    CHECK(calls == 2);
    CHECK(s.create(strip(0.1, {3.0, 0.0}))); // afterwards everything is allowed again
}

TEST_CASE("an exception of the host becomes a failure", "[plugin]") {
    class Thrower : public FakeHost {
    public:
        bool armed = false;
        [[nodiscard]] bool state(step::BodyId id, step::BodyState& out) const override {
            if (armed)
                throw 42;
            return FakeHost::state(id, out);
        }
        [[nodiscard]] step::BodyId find(const std::string& name) const override {
            if (armed)
                throw std::runtime_error("no names today");
            return FakeHost::find(name);
        }
    };
    auto host = std::make_shared<Thrower>();
    host->add(1, "puck", {0.0, 0.1}, 0.0, 0.01, 1e-5);
    Shells s(host);
    const ShellHandle a = *s.create(strip(0.1, {0.0, 0.0}));
    JointDef d;
    d.shell = a;
    d.body = 1;
    REQUIRE(s.create_joint(d));
    host->armed = true;
    const std::string before = fingerprint(s);
    CHECK_FALSE(s.pre_step(0.01).failure.empty());
    CHECK(s.time() == 0.0);
    CHECK_FALSE(s.create_joint(d));
    CHECK_FALSE(s.set_friction_material(BodyId{1}, 2));
    CHECK(s.body("puck").error() == "no names today");
    CHECK(s.attach_to_crosshead("puck").error() == "no names today");
    CHECK(fingerprint(s) == before);
    host->armed = false;
    CHECK(s.pre_step(0.01).failure.empty());
}

TEST_CASE("finite numbers with infinite energies make every call fail", "[plugin][limits]") {
    auto host = tumbleHost();
    Shells shells(host);
    addTumblers(shells, 2);
    const ShellHandle a = shells.shells().front();
    const ForceHandle force = *shells.create_force(a, 0.5, {0.001, 0.0});
    const MouseJointHandle joint = *shells.create_mouse_joint(a, {});
    const std::uint64_t before = shells.hash();
    for (const double x : {1e300, -1e300}) {
        CHECK_FALSE(shells.apply_impulse(a, 0.5, {x, 0.0}));
        CHECK_FALSE(shells.apply_impulse(a, 0.5, {0.0, 0.0}, x));
        CHECK_FALSE(shells.apply_force(a, 0.5, {0.0, x}));
        CHECK_FALSE(shells.apply_torque(a, 0.5, x));
        CHECK_FALSE(shells.create_force(a, 0.5, {x, x}));
        CHECK_FALSE(shells.set_force(force, {x, 0.0}));
        CHECK_FALSE(shells.set_velocity(a, {x, 0.0}));
        CHECK_FALSE(shells.set_velocity(a, {0.0, 0.0}, x));
        CHECK_FALSE(shells.teleport(a, {x, 0.0}, 0.0));
        CHECK_FALSE(shells.teleport(a, {0.0, 0.0}, x));
        CHECK_FALSE(shells.set_target(joint, {x, 0.0}));
        CHECK_FALSE(shells.set_material(a, {.mu = {}, .young_modulus = {}, .density = {}, .natural_curvature = {{x}}}));
    }
    for (const double x : {1e300, 5e-324}) {
        CHECK_FALSE(shells.set_material(a, {.mu = {}, .young_modulus = x, .density = {}, .natural_curvature = {}}));
        CHECK_FALSE(shells.set_material(a, {.mu = {}, .young_modulus = {}, .density = x, .natural_curvature = {}}));
        ShellDef d;
        d.density = x; // a denormal mass: its centre would be 0 / 0
        CHECK_FALSE(shells.create(d));
        d = {};
        d.young_modulus = x;
        CHECK_FALSE(shells.create(d));
        d = {};
        d.width = x;
        CHECK_FALSE(shells.create(d));
    }
    CHECK_FALSE(shells.set_friction(1, 2, 1e300)); // the mean of two such is the root of infinity
    CHECK(shells.hash() == before);
    CHECK(shells.pre_step(1e-3).failure.empty());
    CHECK(std::isfinite(shells.energy_balance().kinetic));
}

TEST_CASE("the strongest calls that are allowed keep all numbers finite", "[plugin][limits]") {
    Shells shells(nullptr);
    const ShellHandle a = *shells.create(ShellDef{});
    ShellDef far;
    far.position = {1.0, 0.0};
    const ShellHandle b = *shells.create(far);
    REQUIRE(shells.apply_impulse(a, 0.1, {1e9, 0.0}));
    for (int f = 0; f < 5; ++f)
        (void)shells.pre_step(0.01); // a is quarantined, or fails with a reason
    CHECK(std::isfinite(shells.energy_balance().kinetic));
    for (const ShellHandle h : {a, b}) {
        const auto m = shells.state(h);
        REQUIRE(m);
        CHECK(std::isfinite(m->centre.x));
    }
}
