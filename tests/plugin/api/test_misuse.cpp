// Every call with null, stale, foreign and invented handles, and with numbers that are none: an error with a reason,
// and not a bit of the state changed.

#include "tests/plugin/api/play.h"

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
    GrabHandle grab;
    ForceHandle force;

    Everything() {
        host->addGround(1, 0.4, {0.0, -1.0});
        host->add(2, "puck", {0.0, 0.1}, 0.0, 0.01, 1e-5);
        shells = Shells(host);
        a = *shells.create(strip(0.1, {0.0, 0.0}));
        b = *shells.create(strip(0.1, {0.2, 0.0}));
        hold = *shells.clamp(a, 0.0);
        JointDef j;
        j.shell = a;
        j.body = 2;
        joint = *shells.join(j);
        j = {};
        j.kind = JointKind::Tether;
        j.shell = b;
        j.point = {0.2, 0.1};
        string = *shells.join(j);
        grab = *shells.grab(b, {});
        force = *shells.add_force(b, 0.5, {0.0, 1e-3});
        play(shells, host.get(), 0.01, 2);
    }
};

/// What must not change, in one line.
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
        for (const step::Grab& g : r.grabs)
            add(g.target.sum() + g.stiffness);
        for (const step::PointForce& f : r.forces)
            add(f.force.sum() + f.torque + f.s);
        add(r.mu + r.material + r.category + r.mask + r.group + r.model.definition().bendingModulus);
        add(r.island + r.rested);
    }
    for (const step::Link& l : w.links)
        add(l.length + l.goal + l.reel + l.target.point.sum() + l.target.path.to.sum() + (l.target.pending ? 1 : 0));
    for (const step::PairFriction& p : w.pairFriction)
        add(p.mu);
    add(static_cast<double>(w.links.size() + w.bodyMaterials.size() + w.nextPart + w.nextKey));
    add(w.ledger.added + w.ledger.work + w.machineVelocity.sum());
    add(shells.sleep_settings().drift + shells.sleep_settings().delay);
    return s;
}

template <class R>
void refusedWith(const char* what, const R& r) {
    INFO(what);
    CHECK_FALSE(r);
    CHECK(r.error().size() > 10);
}

using Numbers = std::vector<double>;

} // namespace

TEST_CASE("no call takes a null, stale, foreign or invented handle", "[plugin]") {
    Everything e, foreign;
    Shells& s = e.shells;
    const ShellHandle stale = *s.create(strip(0.05, {1.0, 0.0}));
    const HoldHandle staleHold = *s.pin(stale, 0.5);
    const GrabHandle staleGrab = *s.grab(stale, {});
    const ForceHandle staleForce = *s.add_force(stale, 0.5, {});
    JointDef j;
    j.kind = JointKind::Tether;
    j.shell = stale;
    j.point = {1.0, 1.0};
    const JointHandle staleJoint = *s.join(j);
    REQUIRE(s.valid(staleHold));
    REQUIRE(s.valid(staleJoint));
    REQUIRE(s.destroy(stale)); // takes its parts with it
    const std::string before = fingerprint(s);
    for (const ShellHandle h : {ShellHandle{}, stale, foreign.a, ShellHandle{99, 1, e.a.world},
                                ShellHandle{e.a.index, 77, e.a.world}, ShellHandle{~0u, ~0u, ~0u}}) {
        CHECK_FALSE(s.valid(h));
        refusedWith("destroy", s.destroy(h));
        refusedWith("hold", s.hold(h, 0.5, HoldKind::Pin));
        refusedWith("grab", s.grab(h, {}));
        refusedWith("add_force", s.add_force(h, 0.5, {}));
        refusedWith("apply_force", s.apply_force(h, 0.5, {}));
        refusedWith("apply_torque", s.apply_torque(h, 0.5, 1.0));
        refusedWith("apply_impulse", s.apply_impulse(h, 0.5, {}));
        refusedWith("teleport", s.teleport(h, {}, 0.0));
        refusedWith("set_velocity", s.set_velocity(h, {}));
        refusedWith("set_material", s.set_material(h, {}));
        refusedWith("set_filter", s.set_filter(h, {}));
        refusedWith("filter", s.filter(h));
        refusedWith("set_surface", s.set_surface(h, 1));
        refusedWith("sleep", s.sleep(h));
        refusedWith("wake", s.wake(h));
        refusedWith("asleep", s.asleep(h));
        refusedWith("pose", s.pose(h));
        JointDef d;
        d.shell = h;
        d.body = 2;
        refusedWith("join", s.join(d));
        d.shell = e.a;
        d.body = 0;
        d.other = h;
        refusedWith("join other", s.join(d));
    }
    for (const HoldHandle h : {HoldHandle{}, staleHold, foreign.hold, HoldHandle{e.hold.index, 999, e.hold.world},
                               HoldHandle{999, e.hold.generation, e.hold.world},
                               HoldHandle{e.force.index, e.force.generation, e.force.world}}) {
        CHECK_FALSE(s.valid(h));
        refusedWith("drive", s.drive(h, {}));
        refusedWith("target", s.target(h));
        refusedWith("reaction", s.reaction(h));
        refusedWith("release", s.release(h));
    }
    for (const JointHandle h : {JointHandle{}, staleJoint, foreign.joint, JointHandle{0, 999, e.joint.world},
                                JointHandle{0, e.hold.generation, e.joint.world}}) {
        CHECK_FALSE(s.valid(h));
        refusedWith("drive", s.drive(h, {}));
        refusedWith("target", s.target(h));
        refusedWith("reel", s.reel(h, 1.0, 1.0));
        refusedWith("length", s.length(h));
        refusedWith("reaction", s.reaction(h));
        refusedWith("release", s.release(h));
    }
    for (const GrabHandle h : {GrabHandle{}, staleGrab, foreign.grab, GrabHandle{e.grab.index, 999, e.grab.world}}) {
        CHECK_FALSE(s.valid(h));
        refusedWith("move", s.move(h, {}));
        refusedWith("reaction", s.reaction(h));
        refusedWith("release", s.release(h));
    }
    for (const ForceHandle h : {ForceHandle{}, staleForce, foreign.force}) {
        CHECK_FALSE(s.valid(h));
        refusedWith("set_force", s.set_force(h, {}));
        refusedWith("release", s.release(h));
    }
    for (const BodyId id : {BodyId{0}, BodyId{999}}) {
        refusedWith("set_surface", s.set_surface(id, 1));
        JointDef d;
        d.shell = e.a;
        d.body = id;
        refusedWith("join body", s.join(d));
    }
    refusedWith("body", s.body("nobody"));
    refusedWith("carry", s.carry("nobody"));
    refusedWith("a shell and a body", [&] {
        JointDef d;
        d.shell = e.a;
        d.other = e.b;
        d.body = 2;
        return s.join(d);
    }());
    refusedWith("a point with itself", [&] {
        JointDef d;
        d.shell = d.other = e.a;
        return s.join(d);
    }());
    refusedWith("drive a weld", s.drive(e.joint, {}));
    refusedWith("target of a weld", s.target(e.joint));
    refusedWith("reel a weld", s.reel(e.joint, 1.0, 1.0));
    refusedWith("length of a weld", s.length(e.joint));
    CHECK(fingerprint(s) == before);
    const FrameReport r = s.pre_step(0.01);
    CHECK(r.failure.empty()); // and life goes on
}

TEST_CASE("no call takes numbers that are none", "[plugin]") {
    Everything e;
    Shells& s = e.shells;
    const std::string before = fingerprint(s);
    for (const double bad : {kNan, kInf, -kInf}) {
        INFO("number " << bad);
        for (const Point p : {Point{bad, 0.0}, Point{0.0, bad}}) {
            refusedWith("drive", s.drive(e.hold, {p, 0.0, {}, 0.0}));
            refusedWith("drive", s.drive(e.hold, {{}, 0.0, p, 0.0}));
            refusedWith("drive", s.drive(e.string, {p, 0.0, {}, 0.0}));
            refusedWith("move", s.move(e.grab, p));
            refusedWith("add_force", s.add_force(e.a, 0.5, p));
            refusedWith("set_force", s.set_force(e.force, p));
            refusedWith("apply_force", s.apply_force(e.a, 0.5, p));
            refusedWith("apply_impulse", s.apply_impulse(e.a, 0.5, p));
            refusedWith("teleport", s.teleport(e.b, p, 0.0));
            refusedWith("set_velocity", s.set_velocity(e.b, p));
            refusedWith("machine", s.set_machine_velocity(p));
            GrabDef g;
            g.target = p;
            refusedWith("grab", s.grab(e.a, g));
            JointDef d;
            d.kind = JointKind::Tether;
            d.shell = e.a;
            d.point = p;
            refusedWith("join", s.join(d));
        }
        refusedWith("drive", s.drive(e.hold, {{}, bad, {}, 0.0}));
        refusedWith("drive", s.drive(e.hold, {{}, 0.0, {}, bad}));
        refusedWith("add_force", s.add_force(e.a, 0.5, {}, bad));
        refusedWith("set_force", s.set_force(e.force, {}, bad));
        refusedWith("apply_torque", s.apply_torque(e.a, 0.5, bad));
        refusedWith("apply_impulse", s.apply_impulse(e.a, 0.5, {}, bad));
        refusedWith("teleport", s.teleport(e.b, {}, bad));
        refusedWith("set_velocity", s.set_velocity(e.b, {}, bad));
        refusedWith("reel", s.reel(e.string, bad, 1.0));
        refusedWith("reel", s.reel(e.string, 1.0, bad));
        refusedWith("set_friction", s.set_friction(1, 2, bad));
        MaterialDef m;
        m.natural_curvature = {bad};
        refusedWith("natural_curvature", s.set_material(e.a, m));
    }
    for (const double bad : {-0.1, 1.1, kNan, kInf, -kInf}) { // fractions
        refusedWith("hold", s.hold(e.a, bad, HoldKind::Pin));
        refusedWith("add_force", s.add_force(e.a, bad, {}));
        refusedWith("apply_force", s.apply_force(e.a, bad, {}));
        refusedWith("apply_impulse", s.apply_impulse(e.a, bad, {}));
        GrabDef g;
        g.arc_fraction = bad;
        refusedWith("grab", s.grab(e.a, g));
        JointDef d;
        d.shell = e.a;
        d.body = 2;
        d.arc_fraction = bad;
        refusedWith("join", s.join(d));
    }
    for (const double bad : {0.0, -1.0, kNan, kInf}) { // positive ones
        MaterialDef m;
        m.young_modulus = bad;
        refusedWith("young_modulus", s.set_material(e.a, m));
        m = {};
        m.density = bad;
        refusedWith("density", s.set_material(e.a, m));
        GrabDef g;
        g.frequency = bad;
        refusedWith("frequency", s.grab(e.a, g));
        SleepSettings z;
        z.drift = bad;
        refusedWith("sleep", s.set_sleep(z));
        refusedWith("reel", s.reel(e.string, bad, 1.0));
        refusedWith("reel", s.reel(e.string, 1.0, bad));
    }
    for (const double bad : {-1.0, kNan, kInf}) { // not negative
        MaterialDef m;
        m.mu = bad;
        refusedWith("mu", s.set_material(e.a, m));
        GrabDef g;
        g.damping_ratio = bad;
        refusedWith("damping", s.grab(e.a, g));
        g = {};
        g.max_force = bad;
        refusedWith("max_force", s.grab(e.a, g));
        SleepSettings z;
        z.delay = bad;
        refusedWith("sleep", s.set_sleep(z));
        JointDef d;
        d.kind = JointKind::Tether;
        d.shell = e.a;
        d.length = bad;
        refusedWith("length", s.join(d));
        refusedWith("friction", s.set_friction(1, 2, bad));
    }
    MaterialDef m;
    m.natural_curvature = std::vector<double>(3, 1.0);
    refusedWith("too few curvatures", s.set_material(e.a, m));
    refusedWith("friction of nothing", s.set_friction(0, 1, 0.5));
    refusedWith("friction never set", s.reset_friction(5, 6));
    refusedWith("held", s.teleport(e.a, {}, 0.0));
    refusedWith("joined", s.teleport(e.b, {}, 0.0));
    refusedWith("short", [&] {
        JointDef d;
        d.kind = JointKind::Tether;
        d.shell = e.a;
        d.point = {5.0, 0.0};
        d.length = 1.0;
        return s.join(d);
    }());
    refusedWith("nothing at the other end", [&] {
        JointDef d;
        d.shell = e.a;
        return s.join(d);
    }());
    CHECK(fingerprint(s) == before);
}

TEST_CASE("an observer reads but does not change", "[plugin]") {
    Everything e;
    Shells& s = e.shells;
    int calls = 0;
    const FrameReport r = s.pre_step(0.01, [&] {
        const std::string before = fingerprint(s);
        const auto refusedNow = [&](const auto& outcome) {
            CHECK_FALSE(outcome);
            CHECK(outcome.error() == kStepping);
        };
        refusedNow(s.create(ShellDef{}));
        refusedNow(s.destroy(e.a));
        refusedNow(s.hold(e.a, 0.5, HoldKind::Pin));
        refusedNow(s.drive(e.hold, {}));
        refusedNow(s.release(e.hold));
        refusedNow(s.join(JointDef{}));
        refusedNow(s.drive(e.string, {}));
        refusedNow(s.reel(e.string, 1.0, 1.0));
        refusedNow(s.release(e.joint));
        refusedNow(s.grab(e.a, {}));
        refusedNow(s.move(e.grab, {}));
        refusedNow(s.release(e.grab));
        refusedNow(s.apply_force(e.a, 0.5, {}));
        refusedNow(s.apply_torque(e.a, 0.5, 1.0));
        refusedNow(s.apply_impulse(e.a, 0.5, {}));
        refusedNow(s.add_force(e.a, 0.5, {}));
        refusedNow(s.set_force(e.force, {}));
        refusedNow(s.release(e.force));
        refusedNow(s.teleport(e.a, {}, 0.0));
        refusedNow(s.set_velocity(e.a, {}));
        refusedNow(s.set_material(e.a, {}));
        refusedNow(s.set_filter(e.a, {}));
        refusedNow(s.set_friction(1, 2, 0.5));
        refusedNow(s.reset_friction(1, 2));
        refusedNow(s.set_surface(e.a, 1));
        refusedNow(s.set_surface(BodyId{1}, 1));
        refusedNow(s.carry("puck"));
        refusedNow(s.set_machine_velocity({}));
        refusedNow(s.set_sleep({}));
        refusedNow(s.sleep(e.a));
        refusedNow(s.wake(e.a));
        refusedNow(s.post_step());
        CHECK(s.pre_step(0.01).failure == kStepping);
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

TEST_CASE("what a host throws comes back as a failure", "[plugin]") {
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
    REQUIRE(s.join(d));
    host->armed = true;
    const std::string before = fingerprint(s);
    CHECK_FALSE(s.pre_step(0.01).failure.empty());
    CHECK(s.time() == 0.0);
    CHECK_FALSE(s.join(d));
    CHECK_FALSE(s.set_surface(BodyId{1}, 2));
    CHECK(s.body("puck").error() == "no names today");
    CHECK(s.carry("puck").error() == "no names today");
    CHECK(fingerprint(s) == before);
    host->armed = false;
    CHECK(s.pre_step(0.01).failure.empty());
}
