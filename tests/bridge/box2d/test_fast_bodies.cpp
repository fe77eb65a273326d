// Nothing passes a shell, however fast it is: bodies thrown at a clamped dome, bodies that the host or its user makes
// fast within one frame, shells thrown or dragged at walls. Poses from frame to frame are judged (passage_judge.h).

#include "tests/bridge/box2d/game_world.h"
#include "tests/bridge/box2d/passage_judge.h"
#include "tests/support/share.h"

#include <string>

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

constexpr double kWall = 1.04;     ///< half the width of the shaft, m; the ends of the dome are at 1 m
constexpr double kSunk = 0.05;     ///< m, deeper than the host's slop
constexpr double kTolerance = 0.1; ///< of the half thickness, that an outline may stand behind a centre line

/// A dome clamped across the mouth of a shaft whose walls are level at y = 0.
struct Shaft : GameWorld {
    Shaft(Quality quality, double scale, float gravity = 0.0F)
        : GameWorld(quality, {.scale = scale, .gravity = gravity, .density = 10.0F}) {
        for (const float side : {-1.0F, 1.0F})
            box(side * (static_cast<float>(kWall) + 2.0F), -1.5F, 2.0F, 1.5F);
        const ShellDef d = GameWorld::dome(1.0, {0.0, 1.0});
        length = 2.0 * M_PI * d.phi_bar * d.radius;
        thickness = d.thickness;
        dome = shells.create(d).value();
        REQUIRE(shells.create_clamp(dome, 0.0));
        REQUIRE(shells.create_clamp(dome, 1.0));
    }

    /// One frame; judges where its bodies then are.
    void frame(double dt) {
        const FrameReport r = shells.pre_step(dt);
        INFO(r.failure);
        REQUIRE(r.failure.empty());
        end(r).or_fail();
        const std::vector<Point> line = centreLine(shells.pose(dome).value(), length);
        for (const b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext())
            if (b->GetType() == b2_dynamicBody)
                judge(line, outlinePoints(*b, static_cast<double>(L)));
    }
    /// A body that the host has let into a wall may come out of it behind the dome.
    void judge(const std::vector<Point>& line, const std::vector<Point>& outline) {
        inWall = inWall || std::any_of(outline.begin(), outline.end(),
                                       [](const Point& p) { return std::abs(p.x) > kWall && p.y < -kSunk; });
        if (!inWall)
            deepest = std::max(deepest, depthBehind(line, 1.0, outline));
    }
    [[nodiscard]] bool passed() const { return deepest > kTolerance * 0.5 * thickness; }

    b2Body* circle(float x, float y, float radius, bool bullet) {
        b2CircleShape s;
        s.m_radius = L * radius;
        b2Body* b = fixture(body(b2_dynamicBody, x, y), s)->GetBody();
        b->SetBullet(bullet);
        return b;
    }

    ShellHandle dome;
    double length = 0.0, thickness = 0.0; ///< m
    bool inWall = false;                  ///< nothing is judged from then on
    double deepest = 0.0;                 ///< that a body stood behind the centre line, m
};

enum class Missile : std::uint8_t { SmallBall, Ball, LargeBall, Box, Chain, Bar };
constexpr Missile kMissiles[] = {Missile::SmallBall, Missile::Ball,  Missile::LargeBall,
                                 Missile::Box,       Missile::Chain, Missile::Bar};

const std::vector<Quality> kQualities{Quality::Game, Quality::Laboratory};

struct Shot {
    Missile missile = Missile::Ball;
    double speed = 1.0; ///< m/s, of the tips for bars; infinite: as fast as the host lets it
    double hz = 60.0;   ///< frames a second
    double phase = 0.0; ///< of the way in a frame
    double scale = 1.0; ///< units a metre
    Quality quality = Quality::Game;
    bool bullet = false;
};

/// A bar that turns about its middle above the dome. Half of its length reaches into the dome over 99 degrees, more
/// than it turns in a step.
void spinBar(Shaft& shaft, const Shot& shot) {
    const double turn = std::min(shot.speed / shot.hz, 0.5 * M_PI);
    b2Body* bar = shaft.box(0.1F, 1.3F, 1.0F, 0.05F, b2_dynamicBody);
    bar->SetBullet(shot.bullet);
    bar->SetTransform(bar->GetPosition(), static_cast<float>(0.55 - shot.phase * std::min(turn, 1.1)));
    bar->SetAngularVelocity(static_cast<float>(turn * shot.hz));
}

/// Puts the missile above the dome, less than a frame and 0.03 m away from its top, on its way down.
void shoot(Shaft& shaft, const Shot& shot) {
    if (shot.missile == Missile::Bar)
        return spinBar(shaft, shot);
    const double way = std::min(shot.speed / shot.hz, 2.0 / shot.scale);
    const auto low = static_cast<float>(1.0 + 0.5 * shaft.thickness + 0.03 + shot.phase * way);
    const auto v = static_cast<float>(-way * shot.hz) * shaft.L;
    const auto release = [&](b2Body* b) {
        b->SetBullet(shot.bullet);
        b->SetLinearVelocity({0.0F, v});
    };
    if (shot.missile == Missile::Box) {
        b2Body* box = shaft.box(-0.13F, low + 0.34F, 0.25F, 0.25F, b2_dynamicBody);
        box->SetTransform(box->GetPosition(), 0.3F);
        return release(box);
    }
    if (shot.missile != Missile::Chain) {
        const float radius = shot.missile == Missile::SmallBall ? 0.05F : shot.missile == Missile::Ball ? 0.25F : 1.0F;
        return release(shaft.circle(0.13F, low + radius, radius, shot.bullet));
    }
    b2Body* before = nullptr;
    for (int i = 0; i < 5; ++i) { // up and to the right
        const auto k = static_cast<float>(i);
        b2Body* link = shaft.circle(-0.1F + 0.12F * k, low + 0.1F + 0.16F * k, 0.1F, shot.bullet);
        release(link);
        if (before != nullptr) {
            b2RevoluteJointDef joint;
            joint.Initialize(before, link, 0.5F * (before->GetPosition() + link->GetPosition()));
            shaft.world.CreateJoint(&joint);
        }
        before = link;
    }
}

std::string describe(const Shot& s) {
    return "missile " + std::to_string(static_cast<int>(s.missile)) + ", " + std::to_string(s.speed) + " m/s, " +
           std::to_string(s.hz) + " Hz, phase " + std::to_string(s.phase) + ", " + std::to_string(s.scale) +
           " units a metre, quality " + std::to_string(static_cast<int>(s.quality)) + (s.bullet ? ", bullet" : "");
}

/// Whether the missile gets through.
bool passes(const Shot& shot) {
    INFO(describe(shot));
    Shaft shaft(shot.quality, shot.scale);
    shoot(shaft, shot);
    const double way = std::min(shot.speed / shot.hz, 2.0 / shot.scale);
    const int frames = std::clamp(static_cast<int>(std::ceil(0.6 / way)) + 3, 6, 30);
    for (int i = 0; i < frames && !shaft.passed(); ++i)
        shaft.frame(1.0 / shot.hz);
    return shaft.passed();
}

void shootAll(test::Share share, const std::vector<Missile>& missiles, const std::vector<Quality>& qualities) {
    int shots = 0, crossings = 0;
    std::string first;
    for (const Missile missile : missiles)
        for (const Quality quality : qualities)
            for (const double scale : {1.0, 50.0})
                for (const bool bullet : {false, true})
                    for (const double hz : {30.0, 60.0, 240.0})
                        for (const double speed : {1.0, 5.0, 20.0, 60.0, 1e6})
                            for (int phase = 0; phase < 20; ++phase) {
                                if (!share.next())
                                    continue;
                                const Shot shot{missile, speed, hz, phase / 20.0, scale, quality, bullet};
                                ++shots;
                                if (!passes(shot))
                                    continue;
                                ++crossings;
                                first = first.empty() ? describe(shot) : first;
                            }
    CAPTURE(shots, first);
    CHECK(crossings == 0);
}

} // namespace

TEST_CASE("no body passes a shell, at any speed, phase and size", "[box2d][fast]") {
    const std::vector<Missile> all(std::begin(kMissiles), std::end(kMissiles));
    shootAll(test::Share(37), all, {Quality::Game});
    shootAll(test::Share(1801), all, {Quality::Laboratory});
}

TEST_CASE("no small ball passes a shell, at every speed and phase", "[box2d][fast][slow]") {
    shootAll(test::Share(1), {Missile::SmallBall}, kQualities);
}

TEST_CASE("no ball passes a shell, at every speed and phase", "[box2d][fast][slow]") {
    shootAll(test::Share(1), {Missile::Ball}, kQualities);
}

TEST_CASE("no large ball passes a shell, at every speed and phase", "[box2d][fast][slow]") {
    shootAll(test::Share(1), {Missile::LargeBall}, kQualities);
}

TEST_CASE("no box passes a shell, at every speed and phase", "[box2d][fast][slow]") {
    shootAll(test::Share(1), {Missile::Box}, kQualities);
}

TEST_CASE("no chain passes a shell, at every speed and phase", "[box2d][fast][slow]") {
    shootAll(test::Share(1), {Missile::Chain}, kQualities);
}

TEST_CASE("no spinning bar passes a shell, at every spin and phase", "[box2d][fast][slow]") {
    shootAll(test::Share(1), {Missile::Bar}, kQualities);
}

namespace {

/// A ball at rest on the level beside the dome, `gap` m away, that is made fast within the host's own step.
struct RestingBall : Shaft {
    RestingBall(Quality quality, double scale, float radius, float gap, bool bullet)
        : Shaft(quality, scale, -9.81F), startX(-1.0F - 0.5F * static_cast<float>(thickness) - gap - radius) {
        ball = circle(startX, radius, radius, bullet);
        for (int i = 0; i < 10; ++i)
            frame(kFrame);
        REQUIRE(!passed());
    }
    [[nodiscard]] double way() const { return static_cast<double>(ball->GetPosition().x / L - startX); }

    float startX; ///< m
    b2Body* ball = nullptr;
};

/// Whether a ball at rest gets through that a kinematic bat hits at 30 m/s within the frame. The bat stops then, before
/// it comes to the shell: a bat that rams the foot of the dome tears it from its clamp.
bool batPasses(Quality quality, double scale, double hz, float radius, double phase, bool bullet) {
    RestingBall g(quality, scale, radius, 0.3F, bullet);
    const double way = std::min(30.0 / hz, 2.0 / scale);
    const double nearest = std::max(0.001, way - 2.0 * static_cast<double>(radius) - 0.25);
    const float start = g.startX - radius - 0.05F - static_cast<float>(nearest + phase * (way - nearest));
    b2Body* bat = g.box(start, 0.36F, 0.05F, 0.3F, b2_kinematicBody);
    bat->SetLinearVelocity({g.L * 30.0F, 0.0F});
    for (int i = 0; i < 20 && !g.passed(); ++i) {
        g.frame(1.0 / hz);
        if (g.way() > 0.01)
            bat->SetLinearVelocity(b2Vec2_zero);
    }
    return g.passed();
}

void batAll(test::Share share) {
    int blows = 0, crossings = 0;
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const double scale : {1.0, 50.0})
            for (const bool bullet : {false, true})
                for (const float radius : {0.1F, 0.25F})
                    for (const double hz : {30.0, 60.0, 240.0})
                        for (int phase = 0; phase < 20; ++phase)
                            if (share.next()) {
                                ++blows;
                                crossings += batPasses(quality, scale, hz, radius, phase / 20.0, bullet) ? 1 : 0;
                            }
    CAPTURE(blows);
    CHECK(crossings == 0);
}

} // namespace

TEST_CASE("a ball at rest that a bat hits does not pass a shell in the same frame", "[box2d][fast]") {
    batAll(test::Share(31));
}

TEST_CASE("a ball at rest that a bat hits never passes a shell in the same frame", "[box2d][fast][slow]") {
    batAll(test::Share(1));
}

namespace {

/// Ten thousand times its weight for one frame.
void pushAll(test::Share share) {
    int pushes = 0, crossings = 0;
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const double scale : {1.0, 50.0})
            for (const bool bullet : {false, true})
                for (const float gap : {0.02F, 0.3F, 0.8F})
                    for (const double hz : {30.0, 60.0, 240.0}) {
                        if (!share.next())
                            continue;
                        RestingBall g(quality, scale, 0.1F, gap, bullet);
                        const float force = 1e4F * 9.81F * g.L * g.ball->GetMass();
                        g.ball->ApplyForceToCenter({force, 0.0F}, true);
                        for (int i = 0; i < 10 && !g.passed(); ++i)
                            g.frame(1.0 / hz);
                        ++pushes;
                        crossings += g.passed() ? 1 : 0;
                        CHECK(g.way() > 0.01); // the push was taken
                    }
    CAPTURE(pushes);
    CHECK(crossings == 0);
}

} // namespace

TEST_CASE("a ball at rest that its user pushes does not pass a shell in the "
          "same frame",
          "[box2d][fast]") {
    pushAll(test::Share(5));
}

TEST_CASE("a ball at rest that its user pushes never passes a shell in the "
          "same frame",
          "[box2d][fast][slow]") {
    pushAll(test::Share(1));
}

namespace {

/// A free shell, and whether its centre line comes through the top face of something.
struct FreeShell : GameWorld {
    explicit FreeShell(Quality quality, float gravity = -9.81F) : GameWorld(quality, {.gravity = gravity}) {
        def = scaled_shell(1.0, 2.0);
        length = 2.0 * M_PI * def.phi_bar * def.radius;
    }
    void put(Point middle, double angle) {
        def.position = middle;
        def.angle = angle;
        shell = shells.create(def).value();
    }
    /// The face of `moving` that is judged is level; its middle is at `top` from the body's origin.
    void frame(double dt, const b2Body* moving, Point top, double halfWidth) {
        const auto seen = [&] {
            std::vector<Point> line = centreLine(shells.pose(shell).value(), length);
            for (Point& p : line) {
                p.x -= top.x + static_cast<double>(moving->GetPosition().x);
                p.y -= top.y + static_cast<double>(moving->GetPosition().y);
            }
            return line;
        };
        if (before.empty())
            before = seen();
        const FrameReport r = shells.pre_step(dt);
        INFO(r.failure);
        REQUIRE(r.failure.empty());
        end(r).or_fail();
        const std::vector<Point> after = seen();
        for (std::size_t i = 0; i < after.size(); ++i)
            passed = passed || cameThrough(before[i], after[i], halfWidth, kTolerance * 0.5 * def.thickness);
        before = after;
        quarantined += shells.events().quarantined.size();
    }

    ShellDef def;
    ShellHandle shell;
    double length = 0.0;       ///< m
    std::vector<Point> before; ///< centre line as seen from the face, of the last frame, m
    bool passed = false;
    std::size_t quarantined = 0;
};

/// A wall of 100 m with its face at y = 0: a box, or an edge.
b2Body* longWall(FreeShell& g, bool edge) {
    b2EdgeShape line;
    line.SetTwoSided({-50.0F, 0.0F}, {50.0F, 0.0F});
    b2PolygonShape box;
    box.SetAsBox(50.0F, 0.5F, {0.0F, -0.5F}, 0.0F);
    b2Body* b = g.body(b2_staticBody, 0.0F, 0.0F);
    g.fixture(b, edge ? static_cast<const b2Shape&>(line) : box);
    return b;
}

void throwAll(test::Share share) {
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const bool edge : {false, true})
            for (const double speed : {10.0, 50.0, 100.0, 300.0, 1e3, 3e3, 1e4, 1e5}) {
                if (!share.next())
                    continue;
                FreeShell g(quality);
                const b2Body* floor = longWall(g, edge);
                g.put({0.0, 3.0}, 0.3);
                REQUIRE(g.shells.set_velocity(g.shell, {0.0, -speed}));
                for (int i = 0; i < 12; ++i)
                    g.frame(kFrame, floor, {0.0, 0.0}, 49.0);
                CAPTURE(static_cast<int>(quality), edge, speed);
                CHECK(!g.passed);
                CHECK(g.quarantined == 0);
            }
}

void dragAll(test::Share share) {
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const double frequency : {5.0, 20.0, 100.0})
            for (const double force : {2e3, 1e4, 2e4, 5e4, 1e5}) {
                if (!share.next())
                    continue;
                FreeShell g(quality);
                const b2Body* floor = longWall(g, false);
                g.put({0.0, 2.0}, 0.3);
                MouseJointDef hand;
                hand.arc_fraction = 0.0;
                hand.target = {0.0, -20.0};
                hand.frequency = frequency;
                hand.damping_ratio = 1.0;
                hand.max_force = force;
                REQUIRE(g.shells.create_mouse_joint(g.shell, hand));
                for (int i = 0; i < 20; ++i)
                    g.frame(kFrame, floor, {0.0, 0.0}, 49.0);
                CAPTURE(static_cast<int>(quality), frequency, force);
                CHECK(!g.passed);
                CHECK(g.quarantined == 0);
            }
}

} // namespace

TEST_CASE("a shell thrown at a wall does not get through", "[box2d][fast]") {
    throwAll(test::Share(7));
}

TEST_CASE("a shell thrown at a wall at any speed does not get through", "[box2d][fast][slow]") {
    throwAll(test::Share(1));
}

TEST_CASE("a hand does not drag a shell through a floor", "[box2d][fast]") {
    dragAll(test::Share(4));
}

TEST_CASE("a hand of any force does not drag a shell through a floor", "[box2d][fast][slow]") {
    dragAll(test::Share(1));
}

TEST_CASE("a kinematic bar does not get through a shell", "[box2d][fast]") {
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const double speed : {1.0, 10.0, 100.0, 1000.0}) {
            FreeShell g(quality, 0.0F);
            b2Body* bar = g.box(0.0F, -0.5F, 5.0F, 0.1F, b2_kinematicBody);
            g.put({0.0, 0.03}, 0.0);
            bar->SetLinearVelocity({0.0F, static_cast<float>(speed)});
            for (int i = 0; i < 30; ++i)
                g.frame(kFrame, bar, {0.0, 0.1}, 4.9);
            CAPTURE(static_cast<int>(quality), speed);
            CHECK(!g.passed);
            CHECK(g.quarantined == 0);
        }
}

TEST_CASE("a bar put forward every frame moves with its way over the frame", "[box2d][fast]") {
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const double speed : {1.0, 10.0, 100.0, 1000.0}) {
            const double way = speed * kFrame;
            const auto half = static_cast<float>(0.55 * way + 0.1); // its size is more than its way
            FreeShell g(quality, 0.0F);
            b2Body* bar = g.box(0.0F, -0.2F - half, 5.0F, half,
                                b2_kinematicBody); // near enough to be read
            g.put({0.0, 0.03}, 0.0);
            const BodyId id = g.port.body_id(*bar);
            const auto known = [&]() -> const step::Body* { return step::findBody(g.shells.world().bodies, id); };
            int seen = 0;
            for (int i = 0; i < 12; ++i) {
                const bool before = known() != nullptr;
                bar->SetTransform(bar->GetPosition() + b2Vec2(0.0F, i > 0 ? static_cast<float>(way) : 0.0F), 0.0F);
                g.frame(kFrame, bar, {0.0, static_cast<double>(half)}, 4.9);
                if (i == 0 || !before || known() == nullptr)
                    continue;
                ++seen;
                CHECK(known()->state.velocity.y() == Approx(speed).epsilon(0.01));
            }
            CAPTURE(static_cast<int>(quality), speed);
            CHECK(seen > 2);
            CHECK(!g.passed);
        }
}

TEST_CASE("a bar that jumps across a free shell gives it no momentum", "[box2d][fast]") {
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const float half : {0.2F, 1.0F}) {
            FreeShell g(quality, 0.0F);
            g.def = GameWorld::dome(0.25 * static_cast<double>(half), {0.0, 0.0});
            g.put({0.0, 0.0}, 0.0);
            const float size = 2.0F * std::sqrt(2.0F) * half;
            b2Body* bar = g.box(0.0F, -0.55F * 2.1F * size, half, half, b2_kinematicBody);
            for (int i = 0; i < 3; ++i)
                g.GameWorld::frame();
            bar->SetTransform(bar->GetPosition() + b2Vec2(0.0F, 2.1F * size), 0.0F);
            for (int i = 0; i < 5; ++i)
                g.GameWorld::frame();
            const ShellState s = g.shells.state(g.shell).value();
            CHECK(std::hypot(s.momentum.x, s.momentum.y) < 1e-9 * s.mass);
        }
}
