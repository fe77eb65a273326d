#pragma once
// Levels whose shells and bodies fall asleep, for the tests of sleep.

#include "tests/bridge/box2d/game_world.h"

#include <algorithm>
#include <functional>

namespace supercircle::bridge_test {

inline constexpr int kSecond = 60; ///< frames

struct Level : GameWorld {
    explicit Level(Quality quality = Quality::Game, double scale = 1.0, bool sleeps = true)
        : GameWorld(quality, {.scale = scale, .density = 20.0F, .friction = 0.5F}) {
        ground = floor();
        SleepSettings s;
        s.automatic = sleeps;
        shells.set_sleep(s).or_fail();
    }
    /// Half a circle of radius 0.5 m that stands on the floor.
    ShellHandle dome(double x) {
        ShellDef d = GameWorld::dome(0.5, {x, 0.53});
        d.mu = 0.5;
        return shells.create(d).value();
    }
    /// 0.6 m wide, 0.4 m high.
    b2Body* crate(float x, float y) { return box(x, y, 0.3F, 0.2F, b2_dynamicBody); }
    b2Body* ball(float x, float y, float radius, float speed = 0.0F) {
        b2CircleShape s;
        s.m_radius = L * radius;
        b2Body* b = fixture(body(b2_dynamicBody, x, y), s)->GetBody();
        b->SetLinearVelocity({0.0F, -L * speed});
        return b;
    }
    [[nodiscard]] bool asleep(ShellHandle s) const { return *shells.asleep(s); }
    [[nodiscard]] b2Vec2 at(const b2Body* b) const { return (1.0F / L) * b->GetPosition(); }
    [[nodiscard]] double thickness() const { return shells.world().rods.front().model.definition().thickness; }
    void frames(int n, const std::function<void()>& each = {}) {
        for (int i = 0; i < n; ++i) {
            frame();
            if (each)
                each();
        }
    }
    /// Until all shells sleep, at most `seconds`.
    void rest(int seconds = 5) {
        const auto sleeps = [&] {
            const auto& rods = shells.world().rods;
            return std::all_of(rods.begin(), rods.end(), [](const step::Rod& r) { return r.asleep(); });
        };
        for (int i = 0; i < seconds * kSecond && !sleeps(); ++i)
            frame();
        REQUIRE(sleeps());
    }

    b2Body* ground = nullptr;
};

/// A dome with a crate on it, at rest.
struct Couple : Level {
    explicit Couple(Quality quality = Quality::Game, double scale = 1.0, bool sleeps = true)
        : Level(quality, scale, sleeps), shell(dome(0.0)), box(crate(0.0F, 0.76F)) {
        if (sleeps)
            rest();
        else
            frames(5 * kSecond);
    }
    [[nodiscard]] bool sleeps() const {
        CHECK(asleep(shell) == !box->IsAwake());
        return asleep(shell);
    }

    ShellHandle shell;
    b2Body* box;
};

inline double distance(const b2Vec2& a, const b2Vec2& b) {
    return static_cast<double>((a - b).Length());
}

} // namespace supercircle::bridge_test
