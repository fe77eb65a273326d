#pragma once
// Floors cut in pieces, with shells on them.

#include "tests/bridge/box2d/game_world.h"

#include <limits>
#include <string>

namespace supercircle::seam_test {

class CutWorld : public bridge_test::GameWorld {
public:
    CutWorld(Quality quality, double friction, double unitsPerMetre = 1.0)
        : GameWorld(quality, {.scale = unitsPerMetre, .density = 100.0F, .friction = static_cast<float>(friction)}),
          units(unitsPerMetre), mu(friction) {
        world.SetGravity(at(0.0, -9.81 * units)); // rounded once
    }

    b2Body* body(b2BodyType type = b2_staticBody) { return GameWorld::body(type, 0.0F, 0.0F); }
    void polygon(const std::vector<b2Vec2>& points, b2Body* on = nullptr) {
        b2PolygonShape shape;
        shape.Set(points.data(), static_cast<int>(points.size()));
        fixture(on != nullptr ? on : body(), shape);
    }
    void box(double x0, double y0, double x1, double y1, b2Body* on = nullptr) {
        const double u = units;
        polygon({at(u * x0, u * y0), at(u * x1, u * y0), at(u * x1, u * y1), at(u * x0, u * y1)}, on);
    }
    void edge(const b2Vec2& a, const b2Vec2& b) {
        b2EdgeShape shape;
        shape.SetTwoSided(a, b);
        fixture(body(), shape);
    }
    /// From left to right; the solid is below.
    void chain(std::vector<b2Vec2> points) {
        std::reverse(points.begin(), points.end()); // Box2D keeps bodies on the right
        b2ChainShape shape;
        const b2Vec2 before = points.front() + (points.front() - points[1]);
        const b2Vec2 beyond = points.back() + (points.back() - points[points.size() - 2]);
        shape.CreateChain(points.data(), static_cast<int>(points.size()), before, beyond);
        fixture(body(), shape);
    }
    static b2Vec2 at(double x, double y) { return {static_cast<float>(x), static_cast<float>(y)}; }

    /// A straight strip with its underside at p along `angle`.
    ShellHandle strip(Point p, double angle, double speed, double length = 1.0, double h = 0.02) {
        ShellDef d;
        d.radius = std::numeric_limits<double>::infinity();
        d.length = length;
        d.thickness = h;
        d.width = 1.0;
        d.density = 1.0 / h;
        d.young_modulus = 12.0 * 5.0 / (h * h * h); // bending stiffness 5 N m^2
        d.elements = 15;
        d.mu = mu;
        const double up = 0.5 * h + 1e-4;
        d.position = {p.x - up * std::sin(angle), p.y + up * std::cos(angle)};
        d.angle = angle;
        d.velocity = {speed * std::cos(angle), speed * std::sin(angle)};
        return made(d);
    }
    ShellHandle made(const ShellDef& d) {
        const auto shell = shells.create(d);
        REQUIRE(shell);
        return *shell;
    }
    void run(double seconds) {
        const int frames = static_cast<int>(std::lround(seconds * 60.0));
        for (int i = 0; i < frames; ++i) {
            const FrameReport r = begin();
            REQUIRE(end(r));
        }
    }
    [[nodiscard]] Point velocity(ShellHandle shell) const {
        const ShellState s = *shells.state(shell);
        return {s.momentum.x / s.mass, s.momentum.y / s.mass};
    }
    [[nodiscard]] double speed(ShellHandle shell) const { return std::hypot(velocity(shell).x, velocity(shell).y); }
    [[nodiscard]] Point centre(ShellHandle shell) const { return shells.state(shell)->centre; }

    double units; ///< a metre

private:
    double mu;
};

enum class Cut { Chain, Boxes, OneBody, Edges, Bricks, Overlapping, BesideChain };

/// A floor of n pieces from x = 0 to 30 m, turned by `angle` about the origin. Every other piece is higher by `step`.
inline void makeFloor(CutWorld& w, Cut cut, int n, double step, double angle = 0.0) {
    const double d = 30.0 / n;
    const auto turned = [&](double x, double y) {
        return CutWorld::at(x * std::cos(angle) - y * std::sin(angle), x * std::sin(angle) + y * std::cos(angle));
    };
    const auto piece = [&](double x0, double x1, double low, double high, b2Body* on = nullptr) {
        w.polygon({turned(x0, low), turned(x1, low), turned(x1, high), turned(x0, high)}, on);
    };
    const auto chain = [&](int count) {
        std::vector<b2Vec2> points;
        for (int i = 0; i <= count; ++i)
            points.push_back(turned(d * i, 0.0));
        w.chain(points);
    };
    if (cut == Cut::Chain)
        return chain(n);
    if (cut == Cut::BesideChain)
        chain(n / 2);
    b2Body* one = cut == Cut::OneBody ? w.body() : nullptr;
    for (int i = cut == Cut::BesideChain ? n / 2 : 0; i < n; ++i) {
        const double top = i % 2 * step, x0 = d * i, x1 = d * (i + 1);
        if (cut == Cut::Edges)
            w.edge(turned(x0, top), turned(x1, top));
        else if (cut == Cut::Bricks)
            piece(x0, x1, -0.2, top);
        else
            piece(cut == Cut::Overlapping ? x0 - 0.2 * d : x0, x1, -1.0, top, one);
        if (cut == Cut::Bricks) // half a brick farther, so that joints end on faces
            piece(x0 + 0.5 * d, x1 + 0.5 * d, -0.4, -0.2);
    }
}

} // namespace supercircle::seam_test
