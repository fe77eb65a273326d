// What the host and its user may do around the step: pause, move the object, interpolate, veto pairs, run belts, shift
// the origin, hand over bad numbers.

#include "tests/plugin/api/support.h"

#include <algorithm>

using namespace supercircle;
using namespace supercircle::test;
using Catch::Contains;

namespace {

ShellDef droppedFrom(double height = 0.02) {
    ShellDef d = dome();
    d.position.y += height;
    return d;
}

struct Points : DebugDraw {
    std::vector<Point> all;
    void polyline(std::span<const Point> points, const Colour&) override {
        all.insert(all.end(), points.begin(), points.end());
    }
    void outline(std::span<const Point>, const Colour&) override {}
    void mark(const Point&, const Colour&) override {}
};

} // namespace

TEST_CASE("Shells that were moved from answer every call with an error", "[plugin]") {
    auto host = groundHost(0.5);
    Shells source(host);
    const ShellHandle shell = *source.create(droppedFrom());
    const HoldHandle hold = *source.create_clamp(shell, 0.5);
    Shells target(std::move(source));
    CHECK(target.valid(shell));
    for (int round = 0; round < 2; ++round) {
        Shells& s = source; // NOLINT(bugprone-use-after-move): what is tested
        CHECK_THAT(s.create(droppedFrom()).error(), Contains("moved from"));
        CHECK_FALSE(s.destroy(shell));
        CHECK_FALSE(s.destroy(hold));
        CHECK_FALSE(s.valid(shell));
        CHECK_FALSE(s.valid(hold));
        CHECK(s.size() == 0);
        CHECK_FALSE(s.set_quality(Quality::Game));
        CHECK(s.quality() == Quality::Laboratory);
        CHECK_FALSE(s.set_frame_budget(1));
        CHECK_FALSE(s.set_threads(1));
        CHECK_FALSE(s.create_hold(shell, 0.5, HoldKind::Pin));
        CHECK_FALSE(s.set_target(hold, TargetDef{}));
        CHECK_FALSE(s.target(hold));
        CHECK_FALSE(s.reaction(hold));
        CHECK_FALSE(s.create_joint({}));
        CHECK_FALSE(s.create_mouse_joint(shell, {}));
        CHECK_FALSE(s.apply_force(shell, 0.5, {1.0, 0.0}));
        CHECK_FALSE(s.apply_impulse(shell, 0.5, {1.0, 0.0}));
        CHECK_FALSE(s.create_force(shell, 0.5, {1.0, 0.0}));
        CHECK_FALSE(s.set_effects(all_shells, "wear"));
        CHECK_FALSE(s.remove_effect(all_shells, "wear"));
        CHECK_FALSE(s.effects(shell));
        CHECK_FALSE(s.set_surface_speed(1, 1.0));
        CHECK_FALSE(s.set_pair_filter({}));
        CHECK_FALSE(s.shift_origin({1.0, 0.0}));
        CHECK_FALSE(s.teleport(shell, {}, 0.0));
        CHECK_FALSE(s.set_velocity(shell, {}));
        CHECK_FALSE(s.set_material(shell, {}));
        CHECK_FALSE(s.set_filter(shell, {}));
        CHECK_FALSE(s.filter(shell));
        CHECK_FALSE(s.set_friction(1, 2, 0.5));
        CHECK_FALSE(s.reset_friction(1, 2));
        CHECK_FALSE(s.body("ground"));
        CHECK_FALSE(s.set_sleep({}));
        CHECK_FALSE(s.sleep(shell));
        CHECK_FALSE(s.wake(shell));
        CHECK_FALSE(s.asleep(shell));
        CHECK_FALSE(s.attach_to_crosshead("ground"));
        CHECK_FALSE(s.set_crosshead_velocity({}));
        CHECK_THAT(s.pre_step(kFrame).failure, Contains("moved from"));
        CHECK_THAT(s.pre_step(0.0).failure, Contains("moved from"));
        CHECK_FALSE(s.post_step());
        CHECK_FALSE(s.pose(shell));
        CHECK_FALSE(s.pose(shell, 0.5));
        CHECK(s.time() == 0.0);
        CHECK(s.energy_balance().kinetic == 0.0);
        CHECK(s.crosshead_force().x == 0.0);
        CHECK(s.events().contact_begin.empty());
        CHECK_FALSE(s.set_event_settings({}));
        CHECK(s.event_settings().impulse_threshold == EventSettings{}.impulse_threshold);
        CHECK(s.shells().empty());
        CHECK(s.find("a").null());
        CHECK_FALSE(s.name(shell));
        CHECK_FALSE(s.set_name(shell, "a"));
        CHECK_FALSE(s.user_data(shell));
        CHECK_FALSE(s.set_user_data(shell, 1));
        CHECK_THAT(s.ray_cast({0.0, 0.0}, {1.0, 0.0}).error(), Contains("moved from"));
        CHECK_FALSE(s.ray_cast_all({0.0, 0.0}, {1.0, 0.0}));
        CHECK_FALSE(s.overlap_point({}));
        CHECK_FALSE(s.overlap_box({}));
        CHECK_FALSE(s.overlap_circle({}, 1.0));
        CHECK_FALSE(s.closest_point(Point{}));
        CHECK_FALSE(s.closest_point(shell, Point{}));
        CHECK_FALSE(s.section(shell, 0.5));
        CHECK_FALSE(s.state(shell));
        Points canvas;
        CHECK_FALSE(s.draw(canvas));
        CHECK(s.save().empty());
        CHECK_FALSE(s.restore(target.save()));
        CHECK_FALSE(s.start_log());
        s.stop_log();
        CHECK(s.log().calls() == 0);
        CHECK_FALSE(s.replay(target.log()));
        CHECK(s.host() == nullptr);
        (void)s.hash();
        (void)s.id();
        source = Shells(nullptr); // it can be used again, and moved from again
        CHECK(source.create(droppedFrom()));
        Shells third(nullptr);
        third = std::move(source);
        CHECK(third.size() == 1);
    }
    advance(target, host.get(), kFrame, 2);
}

TEST_CASE("pre_step(0) is a pause: nothing advances, and no bit changes", "[plugin]") {
    auto host = groundHost(0.5), other = groundHost(0.5);
    Shells paused(host), straight(other);
    for (Shells* s : {&paused, &straight})
        REQUIRE(s->create(droppedFrom()));
    bool touched = false;
    for (int i = 0; i < 40; ++i) {
        advance(paused, host.get(), kFrame, 1);
        advance(straight, other.get(), kFrame, 1);
        touched = touched || !paused.events().contact_begin.empty();
        const std::uint64_t before = paused.hash();
        for (int k = 0; k < 1 + i % 5; ++k) {
            const FrameReport r = paused.pre_step(0.0);
            CHECK(r.failure.empty());
            CHECK(r.advanced == 0.0);
            CHECK(r.steps == 0);
            CHECK(paused.events().contact_begin.empty());
            CHECK(paused.events().impulses.empty());
            CHECK(paused.post_step());
        }
        REQUIRE(paused.hash() == before);
    }
    CHECK(touched);
    CHECK(paused.hash() == straight.hash());
    CHECK_FALSE(paused.pre_step(-0.0).failure.size());
    CHECK_FALSE(paused.pre_step(-kFrame).failure.empty());
    CHECK_FALSE(paused.pre_step(kNan).failure.empty());
}

TEST_CASE("a force applied before a pause acts in the frame after it", "[plugin]") {
    Shells paused(nullptr), straight(nullptr);
    for (Shells* s : {&paused, &straight}) {
        const ShellHandle shell = *s->create(droppedFrom());
        REQUIRE(s->apply_force(shell, 0.5, {0.01, 0.0}));
        if (s == &paused)
            CHECK(s->pre_step(0.0).failure.empty());
        advance(*s, nullptr, kFrame, 2);
    }
    CHECK(paused.hash() == straight.hash());
}

TEST_CASE("a pause is replayed from the log", "[plugin]") {
    auto host = groundHost(0.5), other = groundHost(0.5);
    Shells shells(host), replayed(other);
    REQUIRE(shells.start_log());
    REQUIRE(shells.create(droppedFrom()));
    advance(shells, host.get(), kFrame, 3);
    REQUIRE(shells.pre_step(0.0).failure.empty());
    REQUIRE(shells.post_step());
    advance(shells, host.get(), kFrame, 3);
    REQUIRE(replayed.replay(shells.log(), [&](double dt) {
        other->step(dt);
        return true;
    }));
    CHECK(replayed.hash() == shells.hash());
}

TEST_CASE("a pose between two frames is interpolated and keeps its length", "[plugin]") {
    Shells shells(nullptr);
    ShellDef d = droppedFrom();
    d.velocity = {1.0, 0.5};
    d.spin = 3.0;
    const ShellHandle shell = *shells.create(d);
    CHECK(shells.pose(shell, 0.0)->start.x == shells.pose(shell)->start.x); // just created
    advance(shells, nullptr, kFrame, 1);
    const ShellPose start = *shells.pose(shell);
    advance(shells, nullptr, kFrame, 1);
    const ShellPose end = *shells.pose(shell);
    const auto same = [](const ShellPose& a, const ShellPose& b) {
        return std::hypot(a.start.x - b.start.x, a.start.y - b.start.y) < 1e-14 && std::abs(a.angle - b.angle) < 1e-14;
    };
    CHECK(same(*shells.pose(shell, 0.0), start));
    CHECK(same(*shells.pose(shell, -3.0), start));
    CHECK(same(*shells.pose(shell, 1.0), end));
    CHECK(same(*shells.pose(shell, kInf), end));
    CHECK_FALSE(shells.pose(shell, kNan));
    CHECK_FALSE(shells.pose(ShellHandle{}, 0.5));
    const ShellPose half = *shells.pose(shell, 0.5);
    CHECK(half.angle == Approx(0.5 * (start.angle + end.angle)));
    CHECK(half.curvature.size() == end.curvature.size());
    CHECK(half.curvature[2] == Approx(0.5 * (start.curvature[2] + end.curvature[2])));

    Points at, between;
    REQUIRE(shells.draw(at, {.outlines = false, .holds = false, .strain = false}));
    REQUIRE(shells.draw(between, {.outlines = false, .holds = false, .strain = false, .alpha = 0.0}));
    CHECK(std::hypot(between.all.front().x - start.start.x, between.all.front().y - start.start.y) < 1e-14);
    CHECK(std::hypot(at.all.front().x - end.start.x, at.all.front().y - end.start.y) < 1e-14);
    const std::uint64_t before = shells.hash();
    REQUIRE(shells.pre_step(0.0).failure.empty()); // a pause shows the same pictures
    CHECK(same(*shells.pose(shell, 0.0), start));
    CHECK(shells.hash() == before);
}

TEST_CASE("no pose smears over a creation, a teleport or a restored state", "[plugin]") {
    Shells shells(nullptr);
    ShellDef d = droppedFrom();
    d.velocity = {1.0, 0.0};
    const ShellHandle shell = *shells.create(d);
    advance(shells, nullptr, kFrame, 2);
    const Snapshot saved = shells.save();
    REQUIRE(shells.teleport(shell, {5.0, 5.0}, 1.0));
    CHECK(shells.pose(shell, 0.0)->start.x == shells.pose(shell)->start.x);
    advance(shells, nullptr, kFrame, 1);
    CHECK(shells.pose(shell, 0.0)->start.x != shells.pose(shell)->start.x);
    const ShellHandle late = *shells.create(d);
    CHECK(shells.pose(late, 0.0)->start.x == shells.pose(late)->start.x);
    REQUIRE(shells.restore(saved));
    CHECK(shells.pose(shell, 0.0)->start.x == shells.pose(shell)->start.x);
    advance(shells, nullptr, kFrame, 1);
    CHECK(shells.pose(shell, 0.0)->start.x != shells.pose(shell)->start.x);
}

TEST_CASE("a pair filter keeps a shell and a body apart while it says so", "[plugin]") {
    auto host = groundHost(0.5);
    Shells shells(host);
    const ShellHandle shell = *shells.create(droppedFrom());
    bool veto = true;
    int asked = 0;
    REQUIRE(shells.set_pair_filter([&](const PairQuery& q) {
        ++asked;
        CHECK(q.shell == shell);
        CHECK(q.body == 1);
        CHECK(q.fixture == 0);
        CHECK_FALSE(shells.set_velocity(q.shell, {})); // read only
        CHECK(shells.state(q.shell));
        return !veto;
    }));
    advance(shells, host.get(), kFrame, 30);
    CHECK(asked > 20);
    CHECK(centreOf(shells, 0).y() < -0.5); // it fell through the ground
    REQUIRE(shells.teleport(shell, {0.0, 0.1}, M_PI));
    REQUIRE(shells.set_velocity(shell, {}));
    veto = false;
    advance(shells, host.get(), kFrame, 60);
    CHECK(centreOf(shells, 0).y() > 0.0);
    veto = true;
    advance(shells, host.get(), kFrame, 20);
    CHECK(centreOf(shells, 0).y() < 0.0);
    CHECK(shells.events().quarantined.empty());
}

TEST_CASE("a pair filter makes a one-way platform in both qualities", "[plugin]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        auto host = emptyHost(kG);
        host->add(7, "platform", {0.0, 1.0}, 0.0).outlines.push_back(FakeHost::box(7, 1.0, 0.01, 0.5));
        Shells shells(host);
        REQUIRE(shells.set_quality(quality));
        ShellDef d = dome();
        d.position = {0.0, 0.5};
        d.velocity = {0.0, 5.0};
        const ShellHandle shell = *shells.create(d);
        REQUIRE(shells.set_pair_filter(
            [&](const PairQuery& q) { return shells.state(q.shell)->box.lower.y > 1.0095; })); // above
        double highest = 0.0;
        for (int i = 0; i < 180; ++i) {
            advance(shells, host.get(), kFrame, 1);
            highest = std::max(highest, shells.state(shell)->box.lower.y);
            REQUIRE(shells.events().quarantined.empty());
        }
        CHECK(highest > 1.1);                                                 // through from below
        CHECK(shells.state(shell)->box.lower.y == Approx(1.01).margin(1e-3)); // and back onto it
    }
}

TEST_CASE("a pair filter that throws ends the frame with its message", "[plugin]") {
    auto host = groundHost(0.5);
    Shells shells(host);
    REQUIRE(shells.create(droppedFrom()));
    REQUIRE(shells.set_pair_filter([](const PairQuery&) -> bool { throw std::runtime_error("my filter"); }));
    CHECK_THAT(shells.pre_step(kFrame).failure, Contains("my filter"));
    REQUIRE(shells.set_pair_filter({}));
    advance(shells, host.get(), kFrame, 5);
}

TEST_CASE("a sleeping shell wakes when its pair filter changes its mind", "[plugin]") {
    auto host = groundHost(0.5);
    Shells shells(host);
    const ShellHandle shell = *shells.create(droppedFrom());
    bool veto = false;
    REQUIRE(shells.set_pair_filter([&](const PairQuery&) { return !veto; }));
    settle(shells, host.get());
    REQUIRE(shells.sleep(shell));
    advance(shells, host.get(), kFrame, 2);
    CHECK(*shells.asleep(shell));
    veto = true;
    advance(shells, host.get(), kFrame, 10);
    CHECK(centreOf(shells, 0).y() < 0.0);
}

TEST_CASE("a belt carries a shell at its speed, is saved and ends", "[plugin]") {
    auto host = groundHost(0.5), other = groundHost(0.5);
    Shells shells(host), fresh(other);
    const ShellHandle shell = *shells.create(droppedFrom(0.002));
    settle(shells, host.get());
    CHECK_FALSE(shells.set_surface_speed(99, 1.0));
    CHECK_FALSE(shells.set_surface_speed(1, kNan));
    REQUIRE(shells.set_surface_speed(1, 0.3));
    advance(shells, host.get(), kFrame, 60);
    const double momentumX = momentum(shells).x(), mass = shells.world().rods[0].model.mass();
    CHECK(momentumX / mass == Approx(0.3).epsilon(0.02)); // to the right, as b2Contact::SetTangentSpeed on top
    CHECK(shells.energy_balance().work > 0.0);
    CHECK(std::abs(shells.energy_balance().residual) < 1e-6);
    const Snapshot saved = shells.save();
    REQUIRE(fresh.restore(saved));
    other->bodies = host->bodies;
    advance(shells, host.get(), kFrame, 20);
    advance(fresh, other.get(), kFrame, 20);
    CHECK(fresh.hash() == shells.hash());
    REQUIRE(shells.set_surface_speed(1, 0.0));
    advance(shells, host.get(), kFrame, 120);
    CHECK(std::abs(momentum(shells).x() / mass) < 1e-3);
    (void)shell;
}

TEST_CASE("a belt of one fixture leaves the rest of its body at rest", "[plugin]") {
    auto host = emptyHost(kG);
    auto& body = host->add(1, "level", {0.0, -0.5}, 0.0);
    for (std::uint32_t i = 0; i < 2; ++i) {
        step::BodyOutline half = FakeHost::box(1, 2.0, 0.5, 0.5, i);
        for (Vec2& p : half.local.points)
            p.x() += i == 0 ? -2.0 : 2.0;
        half.fixture = i;
        body.outlines.push_back(half);
    }
    Shells shells(host);
    for (const double x : {-1.0, 1.0}) {
        ShellDef d = droppedFrom(0.002);
        d.position.x = x;
        REQUIRE(shells.create(d));
    }
    settle(shells, host.get());
    const Vec2 left = centreOf(shells, 0), right = centreOf(shells, 1);
    REQUIRE(shells.set_surface_speed(1, -0.2, 1));
    advance(shells, host.get(), kFrame, 30);
    CHECK((centreOf(shells, 0) - left).norm() < 1e-4);
    CHECK((centreOf(shells, 1) - right).x() < -0.05);
}

TEST_CASE("bad numbers of a host body or of gravity are refused for that frame", "[plugin]") {
    for (int what = 0; what < 6; ++what) {
        CAPTURE(what);
        auto host = groundHost(0.5), other = groundHost(0.5);
        host->add(2, "crate", {3.0, 3.0}, 0.0).outlines.push_back(FakeHost::box(2, 0.1, 0.1, 0.5));
        host->bodies.at(2).state.mass = 1.0;
        host->bodies.at(2).state.inertia = 1.0;
        Shells shells(host), plain(other);
        for (Shells* s : {&shells, &plain})
            REQUIRE(s->create(droppedFrom()));
        advance(shells, host.get(), kFrame, 10);
        advance(plain, other.get(), kFrame, 10);
        const step::BodyState good = host->bodies.at(2).state;
        const Vec2 g = host->g;
        step::BodyState& s = host->bodies.at(2).state;
        switch (what) {
        case 0:
            s.centre.x() = kNan;
            break;
        case 1:
            s.velocity.y() = kInf;
            break;
        case 2:
            s.mass = kNan;
            break;
        case 3:
            s.angle = kNan;
            break;
        case 4:
            s.spin = -kInf;
            break;
        default:
            host->g.y() = kNan;
            break;
        }
        const FrameReport r = shells.pre_step(kFrame);
        CHECK(r.failure.empty());
        CHECK_THAT(r.refused, Contains(what < 5 ? "body 2" : "gravity") && Contains("not finite"));
        host->bodies.at(2).state = good;
        host->g = g;
        host->step(r.advanced);
        REQUIRE(shells.post_step());
        advance(plain, other.get(), kFrame, 1);
        CHECK(shells.world().rods[0].q == plain.world().rods[0].q); // nothing else is disturbed
        advance(shells, host.get(), kFrame, 20);
        advance(plain, other.get(), kFrame, 20);
        CHECK(shells.world().rods[0].q == plain.world().rods[0].q);
        CHECK(shells.pre_step(kFrame).refused.empty());
    }
}

TEST_CASE("a joint outlives a frame in which its body has bad numbers", "[plugin]") {
    auto host = groundHost(0.5);
    host->add(2, "hook", {0.0, 1.0}, 0.0);
    host->bodies.at(2).state.mass = 1e6;
    host->bodies.at(2).state.gravityScale = 0.0;
    Shells shells(host);
    const ShellHandle shell = *shells.create(strip(0.5, {0.25, 1.0}));
    const JointHandle pin =
        *shells.create_joint({.kind = JointKind::Pin, .shell = shell, .arc_fraction = 0.0, .body = 2});
    advance(shells, host.get(), kFrame, 5);
    const step::BodyState good = host->bodies.at(2).state;
    host->bodies.at(2).state.centre.x() = kNan;
    const FrameReport r = shells.pre_step(kFrame);
    CHECK(r.failure.empty());
    CHECK_THAT(r.refused, Contains("body 2"));
    host->bodies.at(2).state = good;
    host->step(r.advanced);
    REQUIRE(shells.post_step());
    CHECK(shells.valid(pin));
    advance(shells, host.get(), kFrame, 20);
    CHECK((pointAt(shells, 0, 0.0) - Vec2(0.0, 1.0)).norm() < 1e-4);
}

TEST_CASE("the origin is shifted for shells without a host, and refused by a host that cannot", "[plugin]") {
    Shells shells(nullptr), plain(nullptr);
    ShellDef d = droppedFrom();
    d.spin = 2.0;
    for (Shells* s : {&shells, &plain}) {
        const ShellHandle shell = *s->create(d);
        REQUIRE(s->create_pin(shell, 0.0));
        REQUIRE(s->create_mouse_joint(shell, {.arc_fraction = 1.0, .target = {0.1, 0.2}}));
        advance(*s, nullptr, kFrame, 10);
    }
    REQUIRE(shells.shift_origin({128.0, -64.0}));
    advance(shells, nullptr, kFrame, 30);
    advance(plain, nullptr, kFrame, 30);
    CHECK((centreOf(shells, 0) + Vec2(128.0, -64.0) - centreOf(plain, 0)).norm() < 1e-9);
    CHECK_FALSE(shells.shift_origin({kNan, 0.0}));
    struct Fixed : FakeHost {
        std::string shiftOrigin(const Vec2& by) override { return Port::shiftOrigin(by); }
    };
    Shells unable(std::make_shared<Fixed>());
    CHECK_THAT(unable.shift_origin({1.0, 0.0}).error(), Contains("cannot shift"));
}
