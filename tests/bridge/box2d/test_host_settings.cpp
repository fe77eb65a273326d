// What a user of Box2D sets on bodies, fixtures and the world, as shells take it.

#include "tests/bridge/box2d/game_world.h"

#include <array>
#include <limits>
#include <map>

using namespace supercircle;
using namespace supercircle::bridge_test;
using Catch::Contains;

namespace {

const float kNan = std::numeric_limits<float>::quiet_NaN();

struct SettingsGame : GameWorld {
    explicit SettingsGame(double scale = 1.0, b2Vec2 origin = {0.0F, 0.0F})
        : GameWorld(Quality::Laboratory, {.scale = scale, .density = 10.0F, .friction = 0.5F}), at(origin) {}

    b2Body* box(float x, float y, float halfX, float halfY, b2BodyType type) {
        return GameWorld::box(at.x + x, at.y + y, halfX, halfY, type);
    }
    b2Body* floor(float restitution = 0.0F) {
        b2Body* b = box(0.0F, -0.5F, 20.0F, 0.5F, b2_staticBody);
        b->GetFixtureList()->SetRestitution(restitution);
        return b;
    }
    /// A game's shell of radius 0.5 m that opens downwards, above the floor.
    ShellHandle dome(double x, double height = 0.02) {
        ShellDef d = GameWorld::dome(0.5, {static_cast<double>(at.x) + x, static_cast<double>(at.y) + 0.5 + height});
        d.mu = 0.5;
        const auto made = shells.create(d);
        REQUIRE(made);
        return *made;
    }
    FrameReport frame(double dt = kFrame) {
        const FrameReport r = begin(dt);
        REQUIRE(end(r));
        return r;
    }
    void frames(int n) {
        for (int i = 0; i < n; ++i)
            frame();
    }
    [[nodiscard]] Point centre(ShellHandle s) const { return shells.state(s)->centre; }

    b2Vec2 at; ///< m, where the game is
};

/// A belt as Box2D's users make it.
struct Belt : b2ContactListener {
    b2Body* belt = nullptr;
    float speed = 0.0F;
    void PreSolve(b2Contact* c, const b2Manifold*) override {
        if (c->GetFixtureA()->GetBody() == belt)
            c->SetTangentSpeed(speed);
        else if (c->GetFixtureB()->GetBody() == belt)
            c->SetTangentSpeed(-speed);
    }
};

/// What a program can read and set of Box2D's bodies and contacts.
struct Saved {
    struct Body {
        b2Vec2 position, velocity;
        float angle = 0.0F, spin = 0.0F;
        bool awake = true;
    };
    std::map<b2Body*, Body> bodies;
    std::vector<std::pair<b2Contact*, b2Manifold>> contacts;

    explicit Saved(b2World& w) {
        for (b2Body* b = w.GetBodyList(); b != nullptr; b = b->GetNext())
            bodies[b] = {b->GetPosition(), b->GetLinearVelocity(), b->GetAngle(), b->GetAngularVelocity(),
                         b->IsAwake()};
        for (b2Contact* c = w.GetContactList(); c != nullptr; c = c->GetNext())
            contacts.emplace_back(c, *c->GetManifold());
    }
    /// False if the contacts are not the saved ones: their impulses cannot be given back then.
    bool restore(b2World& w) const {
        for (const auto& [b, s] : bodies) {
            b->SetTransform(s.position, s.angle);
            b->SetLinearVelocity(s.velocity);
            b->SetAngularVelocity(s.spin);
            b->SetAwake(s.awake);
        }
        std::size_t k = 0;
        for (b2Contact* c = w.GetContactList(); c != nullptr; c = c->GetNext(), ++k) {
            if (k >= contacts.size() || contacts[k].first != c)
                return false;
            *c->GetManifold() = contacts[k].second;
        }
        return k == contacts.size();
    }
};

} // namespace

TEST_CASE("a body is found by its id until it is destroyed", "[bridge]") {
    SettingsGame g;
    b2Body* floor = g.floor();
    b2Body* crate = g.box(0.0F, 3.0F, 0.2F, 0.2F, b2_dynamicBody);
    const std::uint64_t id = g.port.body_id(*crate);
    CHECK(g.port.body(id) == crate);
    CHECK(g.port.body(g.port.body_id(*floor)) == floor);
    CHECK(g.port.body(0) == nullptr);
    CHECK(g.port.body(999) == nullptr);
    b2CircleShape s;
    s.m_radius = 0.1F;
    b2Fixture* second = crate->CreateFixture(&s, 1.0F);
    CHECK(g.port.fixture_number(*second) == 1);
    CHECK(g.port.fixture(id, 1) == second);
    CHECK(g.port.fixture(id, 0) != second);
    CHECK(g.port.fixture(id, 2) == nullptr);
    g.world.DestroyBody(crate);
    CHECK(g.port.body(id) == nullptr);
    CHECK(g.port.fixture(id, 0) == nullptr);
}

TEST_CASE("set_surface_speed carries a shell as SetTangentSpeed carries a crate", "[bridge]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        SettingsGame g;
        REQUIRE(g.shells.set_quality(quality));
        Belt listener;
        listener.belt = g.floor();
        listener.speed = 1.0F;
        g.world.SetContactListener(&listener);
        const ShellHandle shell = g.dome(0.0, 0.0131);
        b2Body* crate = g.box(3.0F, 0.25F, 0.25F, 0.25F, b2_dynamicBody);
        REQUIRE(g.shells.set_surface_speed(g.port.body_id(*listener.belt), 1.0));
        g.frames(180);
        const double crateWay = static_cast<double>(crate->GetPosition().x) - 3.0;
        CHECK(crateWay > 2.8);
        CHECK(g.centre(shell).x == Approx(crateWay).margin(0.03));
    }
}

TEST_CASE("a pair filter sees the fixture, and shells still obey b2Filter", "[bridge]") {
    SettingsGame g;
    b2Body* level = g.floor();
    b2PolygonShape shelf;
    shelf.SetAsBox(2.0F, 0.05F, {0.0F, 2.0F}, 0.0F); // in the floor's frame
    b2Fixture* thin = level->CreateFixture(&shelf, 0.0F);
    std::array<int, 2> asked{};
    REQUIRE(g.shells.set_pair_filter([&](const PairQuery& q) {
        CHECK(g.port.body(q.body) == level);
        ++asked.at(q.fixture);
        return g.port.fixture(q.body, q.fixture) != thin;
    }));
    const ShellHandle shell = g.dome(0.0, 1.4);
    g.frames(120);
    CHECK(asked[0] > 0);
    CHECK(asked[1] > 0);
    CHECK(g.centre(shell).y < 0.6); // through the shelf, onto the floor
    CHECK(g.centre(shell).y > 0.0);
    b2Filter none;
    none.maskBits = 0;
    for (b2Fixture* f = level->GetFixtureList(); f != nullptr; f = f->GetNext())
        f->SetFilterData(none);
    g.frames(60);
    CHECK(g.centre(shell).y < -1.0);
}

TEST_CASE("the origin of shells and world shifts in one call", "[bridge]") {
    for (const double scale : {1.0, 52.1}) {
        SettingsGame shifted(scale, {32.0F, 16.0F}), plain(scale, {0.0F, 0.0F});
        std::vector<b2Body*> crates;
        std::vector<ShellHandle> domes;
        for (SettingsGame* g : {&shifted, &plain}) {
            const double x = static_cast<double>(g->at.x), y = static_cast<double>(g->at.y);
            g->floor();
            domes.push_back(g->dome(-1.0));
            domes.push_back(g->dome(1.5));
            REQUIRE(g->shells.create_hold(domes.back(), 0.5, HoldKind::Pin));
            crates.push_back(g->box(-1.0F, 0.9F, 0.3F, 0.2F, b2_dynamicBody));
            crates.push_back(g->box(0.5F, 0.2F, 0.2F, 0.2F, b2_dynamicBody));
            ShellDef rope;
            rope.radius = std::numeric_limits<double>::infinity();
            rope.length = 1.0;
            rope.thickness = 0.02;
            rope.young_modulus = 1e6;
            rope.position = {x - 2.5, y + 2.0};
            domes.push_back(*g->shells.create(rope));
            REQUIRE(g->shells.create_joint(
                {.kind = JointKind::Tether, .shell = domes.back(), .point = {x - 2.5, y + 2.2}, .length = 0.4}));
            REQUIRE(g->shells.create_mouse_joint(domes.back(), {.arc_fraction = 1.0, .target = {x - 2.0, y + 1.5}}));
            g->frames(40);
        }
        REQUIRE(shifted.shells.shift_origin({32.0, 16.0}));
        CHECK(std::abs(crates[0]->GetPosition().x - crates[2]->GetPosition().x) < 1e-3F * shifted.L);
        for (int i = 0; i < 60; ++i) {
            shifted.frame();
            plain.frame();
            REQUIRE(shifted.shells.events().quarantined.empty());
        }
        for (std::size_t i = 0; i < 3; ++i) {
            INFO("shell " << i << ", scale " << scale);
            const Point a = shifted.centre(domes[i]), b = plain.centre(domes[3 + i]);
            CHECK(std::hypot(a.x - b.x, a.y - b.y) < 2e-3);
        }
        for (std::size_t i = 0; i < 2; ++i)
            CHECK((crates[i]->GetPosition() - crates[2 + i]->GetPosition()).Length() < 2e-3F * shifted.L);
    }
}

TEST_CASE("the origin is not shifted inside the host's own step", "[bridge]") {
    struct Shifter : b2ContactListener {
        Shells* shells = nullptr;
        int refused = 0;
        void BeginContact(b2Contact*) override { refused += shells->shift_origin({1.0, 0.0}) ? 0 : 1; }
    } listener;
    SettingsGame g;
    g.floor();
    g.box(0.0F, 0.21F, 0.2F, 0.2F, b2_dynamicBody);
    const ShellHandle shell = g.dome(3.0);
    listener.shells = &g.shells;
    g.world.SetContactListener(&listener);
    g.frames(10);
    CHECK(listener.refused == 1);
    CHECK(g.centre(shell).x == Approx(3.0).margin(1e-3));
}

TEST_CASE("numbers that are not finite in a Box2D body are refused for that frame", "[bridge]") {
    for (int what = 0; what < 5; ++what) {
        CAPTURE(what);
        SettingsGame spoilt, plain;
        std::vector<b2Body*> loose;
        std::vector<ShellHandle> shells;
        for (SettingsGame* g : {&spoilt, &plain}) {
            g->floor();
            for (int i = 0; i < 6; ++i) // so that Box2D's tree has depth
                g->box(2.0F + static_cast<float>(i), 0.25F, 0.25F, 0.25F, b2_staticBody);
            loose.push_back(g->box(-3.0F, 3.0F, 0.2F, 0.2F, b2_dynamicBody));
            shells.push_back(g->dome(0.0, 0.3));
            g->frames(5);
        }
        b2Body* b = loose[0];
        const b2Vec2 position = b->GetPosition(), velocity = b->GetLinearVelocity(),
                     gravity = spoilt.world.GetGravity();
        b2MassData mass;
        b->GetMassData(&mass);
        const std::uint64_t id = spoilt.port.body_id(*b);
        for (int round = 0; round < 30; ++round) {
            b2MassData bad = mass;
            switch (what) {
            case 0:
                b->SetTransform({kNan, 1.0F}, 0.0F);
                break;
            case 1:
                b->SetLinearVelocity({0.0F, std::numeric_limits<float>::infinity()});
                break;
            case 2:
                b->SetTransform(position, kNan);
                break;
            case 3:
                bad.mass = kNan;
                bad.I = 0.0F; // Box2D asserts on the sum of the two
                b->SetMassData(&bad);
                break;
            default:
                spoilt.world.SetGravity({kNan, 0.0F});
                break;
            }
            const FrameReport r = spoilt.shells.pre_step(kFrame);
            CHECK(r.failure.empty());
            if (what == 4)
                CHECK_THAT(r.refused, Contains("gravity"));
            b->SetMassData(&mass); // the user notices before Box2D steps
            b->SetTransform(position, 0.0F);
            b->SetLinearVelocity(velocity);
            spoilt.world.SetGravity(gravity);
            REQUIRE(spoilt.end(r));
            plain.frame();
        }
        CHECK(spoilt.port.body_id(*b) == id);
        const ShellPose x = *spoilt.shells.pose(shells[0]), y = *plain.shells.pose(shells[1]);
        CHECK(x.start.x == y.start.x);
        CHECK(x.start.y == y.start.y);
        CHECK(x.curvature == y.curvature);
        CHECK(spoilt.centre(shells[0]).y > 0.2); // the floor was never lost
    }
}

TEST_CASE("a crate on a shell survives a frame with bad numbers", "[bridge]") {
    SettingsGame g;
    g.floor();
    const ShellHandle shell = g.dome(0.0);
    b2Body* crate = g.box(0.0F, 0.85F, 0.3F, 0.2F, b2_dynamicBody);
    g.frames(30);
    const b2Vec2 position = crate->GetPosition();
    crate->SetLinearVelocity({kNan, kNan});
    const FrameReport r = g.shells.pre_step(kFrame);
    CHECK(r.failure.empty());
    CHECK_THAT(r.refused, Contains("body") && Contains("not finite"));
    crate->SetLinearVelocity({0.0F, 0.0F});
    REQUIRE(g.end(r));
    g.frames(60);
    CHECK((crate->GetPosition() - position).Length() < 0.3F);
    CHECK(g.shells.state(shell));
    CHECK(g.shells.events().quarantined.empty());
}

TEST_CASE("restitution of a fixture is refused aloud, once a world", "[bridge]") {
    SettingsGame g;
    g.floor(1.0F);
    g.dome(0.0, 0.5);
    int notes = 0;
    for (int i = 0; i < 30; ++i) {
        const std::string note = g.frame().note;
        if (!note.empty())
            CHECK_THAT(note, Contains("restitution") && Contains("ignored by shells"));
        notes += note.empty() ? 0 : 1;
    }
    CHECK(notes == 1);
    SettingsGame silent;
    silent.floor();
    silent.dome(0.0, 0.5);
    CHECK(silent.frame().note.empty());
}

TEST_CASE("save, eight frames, restore, eight frames give equal bits with bodies", "[bridge]") {
    for (const Quality quality : {Quality::Laboratory, Quality::Game}) {
        SettingsGame g;
        REQUIRE(g.shells.set_quality(quality));
        g.world.SetAllowSleeping(false); // sleep timers cannot be restored
        g.floor();
        const ShellHandle left = g.dome(-1.0);
        const ShellHandle right = g.dome(1.0, 0.2); // still falls
        b2Body* onShell = g.box(-1.0F, 0.9F, 0.3F, 0.2F, b2_dynamicBody);
        b2Body* onFloor = g.box(3.0F, 0.2F, 0.2F, 0.2F, b2_dynamicBody);
        g.frames(12);
        for (int round = 0; round < 4; ++round) {
            const Snapshot state = g.shells.save();
            const Saved bodies(g.world);
            const auto end = [&] {
                g.frames(8);
                std::vector<double> bits;
                for (const ShellHandle s : {left, right}) {
                    const ShellPose p = *g.shells.pose(s);
                    bits.insert(bits.end(), {p.start.x, p.start.y, p.angle});
                    bits.insert(bits.end(), p.curvature.begin(), p.curvature.end());
                }
                for (const b2Body* b : {onShell, onFloor})
                    for (const float v : {b->GetPosition().x, b->GetPosition().y, b->GetAngle(),
                                          b->GetLinearVelocity().x, b->GetLinearVelocity().y, b->GetAngularVelocity()})
                        bits.push_back(static_cast<double>(v));
                return bits;
            };
            const std::vector<double> first = end();
            const std::uint64_t hash = g.shells.hash();
            REQUIRE(g.shells.restore(state));
            REQUIRE(bodies.restore(g.world));
            CHECK(end() == first);
            CHECK(g.shells.hash() == hash);
        }
    }
}
