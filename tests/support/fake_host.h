#pragma once
// A rigid world for tests, in double precision: static and kinematic bodies, and dynamic ones that feel gravity and the
// shells only (no contact among themselves). Its dynamic bodies move by semi-implicit Euler, as Box2D's do.

#include "supercircle/step/port.h"

#include <algorithm>
#include <map>

namespace supercircle::test {

using rod::Vec2;

class FakeHost : public step::HostWorld {
public:
    struct Body {
        std::string name;
        step::BodyState state;
        std::vector<step::BodyOutline> outlines;
        bool kinematic = false;
    };

    Vec2 g = Vec2::Zero(); ///< m/s^2
    std::map<step::BodyId, Body> bodies;

    /// Adds a body at `centre` and returns it; mass 0: static or kinematic.
    Body& add(step::BodyId id, const std::string& name, const Vec2& centre, double angle = 0.0, double mass = 0.0,
              double inertia = 0.0) {
        Body& b = bodies[id];
        b.name = name;
        b.state.centre = centre;
        b.state.angle = angle;
        b.state.mass = mass;
        b.state.inertia = inertia;
        b.state.moving = b.state.maySleep = mass > 0.0;
        return b;
    }
    static step::BodyOutline box(step::BodyId id, double halfWidth, double halfHeight, double friction,
                                 std::uint32_t key = 0) {
        step::BodyOutline o;
        o.local.kind = contact::OutlineKind::Polygon;
        o.local.points = {
            {-halfWidth, -halfHeight}, {halfWidth, -halfHeight}, {halfWidth, halfHeight}, {-halfWidth, halfHeight}};
        o.local.key = key;
        o.body = id;
        o.friction = friction;
        return o;
    }
    /// A big block whose upper face goes through `at`, turned by `angle`.
    void addGround(step::BodyId id, double friction, const Vec2& at = Vec2::Zero(), double angle = 0.0) {
        const Vec2 down(std::sin(angle), -std::cos(angle));
        add(id, "ground", at + 0.5 * down, angle).outlines.push_back(box(id, 50.0, 0.5, friction));
    }

    [[nodiscard]] Vec2 gravity() const override { return g; }
    [[nodiscard]] double unitsPerMetre() const override { return 1.0; }
    void query(const step::Box&, std::vector<step::BodyOutline>& out) const override { everything(out); }
    void queryAhead(std::span<const step::Box>, double, std::vector<step::BodyOutline>& out) const override {
        everything(out);
    }
    [[nodiscard]] bool state(step::BodyId id, step::BodyState& out) const override {
        const auto it = bodies.find(id);
        if (it == bodies.end())
            return false;
        out = it->second.state;
        return true;
    }
    void applyImpulse(step::BodyId id, const Vec2& impulse, double angularImpulse) override {
        step::BodyState& s = bodies.at(id).state;
        s.velocity += impulse / s.mass;
        if (s.inertia > 0.0)
            s.spin += angularImpulse / s.inertia;
        s.awake = true;
    }
    void setAwake(step::BodyId id, bool awake) override {
        step::BodyState& s = bodies.at(id).state;
        s.awake = awake;
        if (!awake) {
            s.velocity.setZero();
            s.spin = 0.0;
        }
    }
    void setVelocity(step::BodyId id, const Vec2& velocity, double spin) override {
        bodies.at(id).state.velocity = velocity;
        bodies.at(id).state.spin = spin;
    }
    void place(step::BodyId id, const Vec2& centre, double angle) override {
        bodies.at(id).state.centre = centre;
        bodies.at(id).state.angle = angle;
    }
    void drive(step::BodyId id, const Vec2& centre, double angle, const Vec2& velocity, double spin) override {
        step::BodyState& s = bodies.at(id).state;
        s.centre = centre;
        s.angle = angle;
        s.velocity = velocity;
        s.spin = spin;
    }
    [[nodiscard]] step::BodyId find(const std::string& name) const override {
        for (const auto& [id, b] : bodies)
            if (b.name == name)
                return id;
        return 0;
    }
    std::string shiftOrigin(const Vec2& by) override {
        for (auto& [id, b] : bodies)
            b.state.centre -= by;
        return {};
    }
    void step(double dt) override {
        for (auto& [id, b] : bodies) {
            if (!b.state.awake)
                continue;
            if (b.state.mass > 0.0)
                b.state.velocity += dt * b.state.gravityScale * g;
            b.state.centre += dt * b.state.velocity;
            b.state.angle += dt * b.state.spin;
        }
    }
    void everything(std::vector<step::BodyOutline>& out) const override {
        for (const auto& [id, b] : bodies)
            out.insert(out.end(), b.outlines.begin(), b.outlines.end());
    }
};

} // namespace supercircle::test
