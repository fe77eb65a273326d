// Held points against walls of a Box2D world: they stop at first contact and say so.

#include "supercircle/step/stepper.h"
#include "tests/bridge/box2d/game_world.h"

#include <algorithm>

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

struct HoldLevel : GameWorld {
    HoldLevel(Quality quality, double scale) : GameWorld(quality, {.scale = scale, .density = 30.0F}) {}
    b2Body* made(const b2Shape& shape, float x = 0.0F, float y = 0.0F) {
        return fixture(body(b2_staticBody, x, y), shape)->GetBody();
    }
    b2Body* edge(float x0, float x1, float y) {
        b2EdgeShape s;
        s.SetTwoSided({L * x0, L * y}, {L * x1, L * y});
        return made(s);
    }
    b2Body* chain(float x0, float x1, float y) { // carries from above
        const b2Vec2 v[] = {{L * x1, L * y}, {0.5F * L * (x0 + x1), L * y}, {L * x0, L * y}};
        b2ChainShape s;
        s.CreateChain(v, 3, {L * (x1 + 1.0F), L * y}, {L * (x0 - 1.0F), L * y});
        return made(s);
    }
    b2Body* disc(float x, float y, float radius) {
        b2CircleShape s;
        s.m_radius = L * radius;
        return made(s, x, y);
    }
    void frame(double dt = kFrame) {
        GameWorld::frame(dt);
        for (const HoldBlockedEvent& e : shells.events().hold_blocked)
            blocked.push_back(e);
        quarantined += shells.events().quarantined.size();
    }
    [[nodiscard]] double thickness(ShellHandle h) const {
        return shells.world().rods[static_cast<std::size_t>(index(h))].model.definition().thickness;
    }
    [[nodiscard]] int index(ShellHandle h) const {
        const std::vector<ShellHandle> all = shells.shells();
        return static_cast<int>(std::find(all.begin(), all.end(), h) - all.begin());
    }
    [[nodiscard]] std::uint64_t crossings() const {
        return shells.world().counters.rejectedFor[static_cast<std::size_t>(step::Reason::Crossing)] +
               shells.world().counters.crossings;
    }

    std::vector<HoldBlockedEvent> blocked;
    std::size_t quarantined = 0;
};

/// The target of the hold moved by `way` within the coming frame, and at rest then.
void put(HoldLevel& level, HoldHandle hold, const Point& way) {
    TargetDef to = level.shells.target(hold).value();
    to.position.x += way.x;
    to.position.y += way.y;
    to.velocity = {};
    level.shells.set_target(hold, to).or_fail();
}

} // namespace

TEST_CASE("a held point driven into a wall stops at first contact", "[box2d][holds]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    const int wall = GENERATE(0, 1, 2, 3);
    const int pace = GENERATE(0, 1, 2); // in one frame; in sixty; fast and on
    const HoldKind kind = GENERATE(HoldKind::Clamp, HoldKind::Pin);
    CAPTURE(static_cast<int>(quality), scale, wall, pace, static_cast<int>(kind));
    HoldLevel level(quality, scale);
    b2Body* body = wall == 0   ? level.box(0.0F, -0.5F, 20.0F, 0.5F)
                   : wall == 1 ? level.edge(-20.0F, 20.0F, 0.0F)
                   : wall == 2 ? level.chain(-20.0F, 20.0F, 0.0F)
                               : level.disc(0.0F, -2.0F, 2.0F);
    const ShellHandle shell = level.strip(0.0, 1.0);
    const HoldHandle hold = level.shells.create_hold(shell, 0.5, kind).value();
    const double h = level.thickness(shell);
    level.frame();
    if (pace == 0)
        put(level, hold, {0.0, -5.0});
    for (int i = 0; i < 70; ++i) {
        if (pace == 1)
            put(level, hold, {0.0, -5.0 / 60.0});
        if (pace == 2 && i == 0) {
            TargetDef to = level.shells.target(hold).value();
            to.position.y -= 0.1;
            to.velocity = {0.0, -8.0};
            level.shells.set_target(hold, to).or_fail();
        }
        level.frame();
    }
    const TargetDef end = level.shells.target(hold).value();
    // It rests a thousandth of the thickness outside; Box2D's single precision adds 1e-7 of 20 m.
    CHECK(std::abs(end.position.y - 0.501 * h) < 1e-4 * h + 2e-6);
    CHECK((end.velocity.x == 0.0 && end.velocity.y == 0.0));
    REQUIRE(level.blocked.size() == 1);
    CHECK(level.blocked[0].shell == shell);
    CHECK(level.blocked[0].hold == hold);
    CHECK(level.blocked[0].body == level.port.body_id(*body));
    CHECK(level.blocked[0].stopped);
    CHECK(level.quarantined == 0);
    CHECK(level.shells.section(shell, 0.5).value().position.y > 0.5 * h);
    put(level, hold, {0.3, 0.2}); // away again
    level.frame();
    CHECK(level.shells.target(hold).value().position.y == Approx(end.position.y + 0.2).margin(1e-12));
}

TEST_CASE("a held point and a wall that come to each other meet once and say so", "[box2d][holds]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const bool holdMoves = GENERATE(true, false);
    CAPTURE(static_cast<int>(quality), holdMoves);
    HoldLevel level(quality, 1.0);
    b2Body* wall = level.box(0.0F, -0.5F, 2.0F, 0.5F, b2_kinematicBody); // its face is y = 0
    const ShellHandle shell = level.strip(0.0, 0.2);
    const HoldHandle hold = level.shells.create_clamp(shell, 0.5).value();
    const double h = level.thickness(shell);
    wall->SetLinearVelocity({0.0F, 1.0F});
    double meets = (0.2 - 0.5 * h) / 1.0; // s
    if (holdMoves) {
        meets = (0.2 - 0.5 * h) / 2.0;
        TargetDef to = level.shells.target(hold).value();
        to.position.y -= 1.0 * kFrame;
        to.velocity = {0.0, -1.0};
        level.shells.set_target(hold, to).or_fail();
    }
    while (level.shells.time() < meets + 0.5 * kFrame && level.blocked.empty())
        level.frame();
    REQUIRE(level.blocked.size() == 1);
    CHECK(level.blocked[0].time == Approx(meets).margin(1e-5));
    CHECK(level.blocked[0].stopped == holdMoves);
    CHECK(level.blocked[0].body == level.port.body_id(*wall));
    wall->SetLinearVelocity({0.0F, 0.0F});
    const double stays = level.shells.target(hold).value().position.y;
    for (int i = 0; i < 20; ++i)
        level.frame();
    CHECK(level.shells.target(hold).value().position.y == stays);
    CHECK(level.blocked.size() == 1);
}

TEST_CASE("a held point slides along what it touches and leaves it", "[box2d][holds]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const int wall = GENERATE(0, 1, 2);
    const double press = GENERATE(0.0, -0.005); // thicknesses in a frame
    CAPTURE(static_cast<int>(quality), wall, press);
    HoldLevel level(quality, 1.0);
    wall == 0   ? level.box(0.0F, -0.5F, 20.0F, 0.5F)
    : wall == 1 ? level.edge(-20.0F, 20.0F, 0.0F)
                : level.chain(-20.0F, 20.0F, 0.0F);
    ShellHandle shell = level.strip(0.0, 1.0);
    const double h = level.thickness(shell);
    level.shells.teleport(shell, {0.0, 0.5 * h}, 0.0).or_fail();
    const HoldHandle hold = level.shells.create_clamp(shell, 0.5).value();
    for (int i = 1; i <= 60; ++i) {
        put(level, hold, {0.02, i == 30 ? press * h : 0.0});
        level.frame();
        REQUIRE(level.shells.target(hold).value().position.x == Approx(0.02 * i).margin(1e-9));
    }
    CHECK(level.blocked.empty());
    put(level, hold, {0.0, 0.3});
    level.frame();
    CHECK(level.shells.target(hold).value().position.y == Approx((0.5 + press) * h + 0.3).margin(1e-9));
}

TEST_CASE("a held point passes what its shell does not touch", "[box2d][holds]") {
    const int why = GENERATE(0, 1, 2, 3); // mask, veto, tether (it does touch), from below
    CAPTURE(why);
    HoldLevel level(Quality::Game, 1.0);
    b2Body* wall = why == 3 ? level.chain(-20.0F, 20.0F, 0.0F) : level.box(0.0F, 0.0F, 20.0F, 0.05F);
    const double side = why == 3 ? -1.0 : 1.0;
    const ShellHandle shell = level.strip(0.0, 0.51 * side); // so that no frame ends with it right on the edge
    if (why == 0)
        level.shells.set_filter(shell, {1, 0, 0}).or_fail();
    if (why == 1)
        level.shells.set_pair_filter([](const PairQuery&) { return false; }).or_fail();
    if (why == 2)
        level.join(shell, 0.5, *wall, JointKind::Tether, 5.0).or_fail();
    const HoldHandle hold = level.shells.create_clamp(shell, 0.5).value();
    for (int i = 0; i < 20; ++i) {
        put(level, hold, {0.0, -0.05 * side});
        level.frame();
    }
    const double end = level.shells.target(hold).value().position.y;
    CHECK(end == Approx(why == 2 ? 0.05 + 0.501 * level.thickness(shell) : -0.49 * side).margin(1e-5));
    CHECK(level.blocked.size() == (why == 2 ? 1U : 0U));
    CHECK(level.quarantined == 0);
    CHECK(level.crossings() == 0);
}

TEST_CASE("a held point of a shell half way through a one-sided edge goes either way", "[box2d][holds]") {
    const double turn = GENERATE(0.1, -0.1); // where the held middle turns round, in front of the edge or behind it, m
    CAPTURE(turn);
    HoldLevel level(Quality::Game, 1.0);
    level.chain(-20.0F, 20.0F, 0.0F);
    const ShellHandle shell = level.strip(0.03, -0.8);
    level.shells.teleport(shell, {0.03, -0.8}, 0.5 * M_PI).or_fail(); // upright
    const HoldHandle hold = level.shells.create_clamp(shell, 0.5).value();
    const int frames = static_cast<int>(std::lround((turn + 0.8) / 0.02));
    for (const double way : {0.02, -0.02})
        for (int i = 0; i < frames; ++i) {
            put(level, hold, {0.0, way});
            level.frame();
        }
    CHECK(level.blocked.empty());
    CHECK(level.shells.target(hold).value().position.y == Approx(-0.8).margin(1e-9));
    CHECK(level.crossings() == 0);
    CHECK(level.quarantined == 0);
}

namespace {

/// An open ring of 1 kg on pins or clamps at its ends, under gravity, as it would be hung up.
struct HungRing {
    HungRing(Quality quality, HoldKind kind) : level(quality, 1.0) {
        ShellDef d = scaled_shell(0.5, 1.0, 0.75);
        d.position = {0.0, 5.0};
        ring = level.shells.create(d).value();
        first = level.shells.create_hold(ring, 0.0, kind).value();
        last = level.shells.create_hold(ring, 1.0, kind).value();
        arc = d.phi_bar * 2.0 * M_PI * d.radius;
        stiffness = bending_modulus(d) / (arc * arc); // N
    }
    /// Moves both ends apart by `way` m (together if negative), as far as a frame allows.
    void draw(double way) {
        const Point a = level.shells.target(first).value().position, b = level.shells.target(last).value().position;
        const double chord = std::hypot(b.x - a.x, b.y - a.y);
        const Point along{(b.x - a.x) / chord, (b.y - a.y) / chord};
        put(level, first, {-0.5 * way * along.x, -0.5 * way * along.y});
        put(level, last, {0.5 * way * along.x, 0.5 * way * along.y});
        frame();
    }
    void frame() {
        level.frame();
        largest = std::max(largest, std::hypot(level.shells.reaction(first).value().force.x,
                                               level.shells.reaction(first).value().force.y));
    }
    [[nodiscard]] double chord() const {
        const Point a = level.shells.target(first).value().position, b = level.shells.target(last).value().position;
        return std::hypot(b.x - a.x, b.y - a.y);
    }
    HoldLevel level;
    ShellHandle ring;
    HoldHandle first, last;
    double arc = 0.0, stiffness = 0.0, largest = 0.0;
};

} // namespace

TEST_CASE("holds that draw a shell straight stop, and go on when they are led back", "[box2d][holds]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const HoldKind kind = GENERATE(HoldKind::Pin, HoldKind::Clamp);
    CAPTURE(static_cast<int>(quality), static_cast<int>(kind));
    HungRing hung(quality, kind);
    for (int i = 0; i < 90; ++i)
        hung.draw(0.03);
    INFO("largest force " << hung.largest << " N, B / L^2 " << hung.stiffness << " N");
    CHECK(hung.chord() < 0.996 * hung.arc);
    CHECK(hung.chord() > (kind == HoldKind::Pin ? 0.99 : 0.85) * hung.arc); // elements of clamps stay turned
    CHECK(hung.largest < 5e3 * hung.stiffness); // 2e3 where clamps stand across, (0.2 / 0.005)^2
    REQUIRE(hung.level.blocked.size() == 2);    // one a hold
    CHECK(hung.level.blocked[0].body == 0);
    CHECK(hung.level.blocked[0].stopped);
    CHECK(hung.level.quarantined == 0);
    const double stopped = hung.chord();
    for (int i = 0; i < 10; ++i) { // both aside
        put(hung.level, hung.first, {0.0, 0.01});
        put(hung.level, hung.last, {0.0, 0.01});
        hung.frame();
    }
    CHECK(hung.level.shells.target(hung.first).value().position.y > 5.05);
    for (int i = 0; i < 10; ++i)
        hung.draw(-0.03);
    CHECK(hung.chord() == Approx(stopped - 0.3).margin(1e-9));
}

TEST_CASE("holds that bring the ends of a shell together stop before they meet", "[box2d][holds]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    CAPTURE(static_cast<int>(quality));
    HungRing hung(quality, HoldKind::Pin);
    const double h = hung.level.thickness(hung.ring);
    for (int i = 0; i < 70; ++i)
        hung.draw(-std::min(0.015, hung.chord()));
    CHECK(hung.chord() >= 1.049 * h);
    CHECK(hung.chord() < 2.0 * h);
    CHECK(hung.level.quarantined == 0);
    CHECK(hung.largest < 5e3 * hung.stiffness); // 2e3 where clamps stand across, (0.2 / 0.005)^2
}
