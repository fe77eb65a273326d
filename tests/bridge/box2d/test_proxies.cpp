// Proxies of shells for ray casts, queries and listeners of Box2D.

#include "bridge/box2d/include/supercircle/box2d_proxies.hpp"

#include "tests/bridge/box2d/coupled_world.h"

#include <memory>
#include <vector>

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

constexpr double kHostStep = 1.0 / 120.0;

/// A coarse version of Shells::draw for an open shell: both faces.
void draw(const CoupledWorld& p, DebugDraw& canvas) {
    for (const step::Rod& r : p.shells.rods) {
        std::vector<Point> points;
        for (const int side : {1, -1})
            for (int k = 0; k <= 60; ++k) {
                const double s = r.model.definition().length * (side > 0 ? k : 60 - k) / 60.0;
                const rod::MaterialPoint at = rod::locate(r.model, s);
                const double angle = r.kin.angle(at);
                const Vec2 q = r.kin.point(at) + 0.5 * kThick * side * Vec2(-std::sin(angle), std::cos(angle));
                points.push_back({q.x(), q.y()});
            }
        canvas.outline(points, {});
    }
}

void update(const CoupledWorld& p, bridge::ShellProxies& proxies) {
    proxies.begin();
    draw(p, proxies);
    REQUIRE(proxies.end());
}

struct Ray : b2RayCastCallback {
    float ReportFixture(b2Fixture* f, const b2Vec2& at, const b2Vec2&, float fraction) override {
        fixture = f;
        point = at;
        return fraction;
    }
    b2Fixture* fixture = nullptr;
    b2Vec2 point{0.0F, 0.0F};
};

struct ObservedFixtures : b2QueryCallback {
    explicit ObservedFixtures(const bridge::ShellProxies& p) : proxies(&p) {}
    bool ReportFixture(b2Fixture* f) override {
        outlines += proxies->outline_of(*f) == 0 ? 1 : 0;
        return true;
    }
    const bridge::ShellProxies* proxies;
    int outlines = 0;
};

struct Listener : b2ContactListener {
    void BeginContact(b2Contact* c) override {
        begun += proxy(c) ? 1 : 0;
        CHECK_FALSE(proxies->end()); // locked
    }
    void EndContact(b2Contact* c) override { ended += proxy(c) ? 1 : 0; }
    void PreSolve(b2Contact* c, const b2Manifold*) override { CHECK_FALSE(proxy(c)); } // they exert no force
    [[nodiscard]] bool proxy(b2Contact* c) const {
        return proxies->outline_of(*c->GetFixtureA()) == 0 || proxies->outline_of(*c->GetFixtureB()) == 0;
    }
    bridge::ShellProxies* proxies = nullptr;
    int begun = 0, ended = 0;
};

} // namespace

TEST_CASE("ray casts, queries and listeners of Box2D find shells by their proxies", "[bridge]") {
    CoupledWorld p;
    p.floor();
    p.dome(0.0);
    bridge::ShellProxies proxies(p.world, kScale);
    Ray none;
    p.world.RayCast(&none, host(0.0, 0.1), host(0.0, 0.01));
    CHECK(none.fixture == nullptr);
    update(p, proxies);
    Ray ray;
    p.world.RayCast(&ray, host(0.0, 0.1), host(0.0, 0.01));
    REQUIRE(ray.fixture != nullptr);
    CHECK(proxies.outline_of(*ray.fixture) == 0);
    CHECK(static_cast<double>(ray.point.y) / kScale ==
          Approx(kRadius + kThick).margin(0.05 * kThick)); // chords, floats
    ObservedFixtures seen(proxies);
    p.world.QueryAABB(&seen, {host(-0.001, 0.015), host(0.001, 0.025)});
    CHECK(seen.outlines > 0);

    Listener listener;
    listener.proxies = &proxies;
    p.world.SetContactListener(&listener);
    b2Body* crate = p.box(0.0, kRadius + kThick + 0.006, 0.01, 0.005, 0.005);
    CHECK(proxies.outline_of(*crate->GetFixtureList()) == bridge::ShellProxies::kNone);
    for (int i = 0; i < 60; ++i) {
        p.frame(kHostStep);
        update(p, proxies);
    }
    CHECK(listener.begun > 0);
    CHECK(std::abs(p.gap(crate)) < 0.01 * kThick);
    crate->SetTransform(host(0.3, 0.1), 0.0F);
    p.frame(kHostStep);
    CHECK(listener.ended == listener.begun);
    p.world.SetContactListener(nullptr);
}

TEST_CASE("proxies follow shells, disappear with them, and influence neither bodies nor shells", "[bridge]") {
    const auto run = [](bool with) {
        CoupledWorld p;
        p.floor();
        p.dome(0.0);
        b2Body* crate = p.box(0.0, kRadius + kThick + 0.006, 0.01, 0.005, 0.005);
        const int bodies = p.world.GetBodyCount();
        {
            bridge::ShellProxies proxies(p.world, kScale);
            for (int i = 0; i < 60; ++i) {
                if (with)
                    update(p, proxies);
                p.frame(kHostStep);
            }
            if (with) {
                CHECK(p.world.GetBodyCount() == bodies + 1);
                proxies.begin();
                CHECK(proxies.end()); // no shells any more
                CHECK(p.world.GetBodyCount() == bodies);
                update(p, proxies);
            }
        }
        CHECK(p.world.GetBodyCount() == bodies);
        return std::pair(p.shells.rods[0].q, crate->GetPosition());
    };
    const auto with = run(true), without = run(false);
    CHECK(with.first == without.first);
    CHECK((with.second == without.second));
}

TEST_CASE("released proxies may outlive their world", "[bridge]") {
    auto world = std::make_unique<b2World>(b2Vec2{0.0F, 0.0F});
    bridge::ShellProxies proxies(*world);
    const Point line[] = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}};
    proxies.begin();
    proxies.outline(line, {});
    REQUIRE(proxies.end());
    CHECK(world->GetBodyCount() == 1);
    proxies.release();
    CHECK(world->GetBodyCount() == 0);
    world.reset();
    proxies.release(); // like the destructor, it does not access a destroyed world (checked by the sanitizers)
}

TEST_CASE("outlines with invalid numbers do not move their proxies", "[bridge]") {
    CoupledWorld p(0.0);
    bridge::ShellProxies proxies(p.world, std::numeric_limits<double>::quiet_NaN());
    const Point good[] = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}};
    const Point bad[] = {{0.0, 0.0}, {std::numeric_limits<double>::quiet_NaN(), 0.0}};
    proxies.begin();
    proxies.outline(good, {});
    REQUIRE(proxies.end());
    proxies.begin();
    proxies.outline(bad, {});
    REQUIRE(proxies.end());
    Ray ray;
    p.world.RayCast(&ray, {0.5F, -1.0F}, {0.5F, 0.2F});
    REQUIRE(ray.fixture != nullptr);
    CHECK(std::abs(ray.point.y) < 1e-6F); // floats
    p.world.Step(0.01F, 8, 3);
}
