// Shells drawn by a b2Draw.

#include "bridge/box2d/debug_draw.h"

#include <box2d/box2d.h>
#include <catch2/catch.hpp>
#include <limits>

using namespace supercircle;

namespace {

class Renderer : public b2Draw {
public:
    void DrawPolygon(const b2Vec2*, int32, const b2Color&) override {}
    void DrawSolidPolygon(const b2Vec2*, int32, const b2Color&) override {}
    void DrawCircle(const b2Vec2&, float, const b2Color&) override {}
    void DrawSolidCircle(const b2Vec2&, float, const b2Vec2&, const b2Color&) override {}
    void DrawSegment(const b2Vec2& a, const b2Vec2& b, const b2Color& c) override {
        segments.emplace_back(a, b);
        colour = c;
    }
    void DrawTransform(const b2Transform&) override {}
    void DrawPoint(const b2Vec2& p, float, const b2Color&) override { points.push_back(p); }
    std::vector<std::pair<b2Vec2, b2Vec2>> segments;
    std::vector<b2Vec2> points;
    b2Color colour;
};

} // namespace

TEST_CASE("lines, outlines and marks reach b2Draw in its units", "[bridge]") {
    Renderer renderer;
    bridge::DrawAdapter adapter(renderer, 50.0);
    const Point square[] = {{0.0, 0.0}, {0.1, 0.0}, {0.1, 0.1}, {0.0, 0.1}};
    adapter.polyline(square, {0.1F, 0.2F, 0.3F, 0.4F});
    CHECK(renderer.segments.size() == 3);
    CHECK(renderer.segments[1].second == b2Vec2(5.0F, 5.0F));
    CHECK(renderer.colour.b == 0.3F);
    CHECK(renderer.colour.a == 0.4F);
    adapter.outline(square, {});
    CHECK(renderer.segments.size() == 7);
    CHECK(renderer.segments[6].second == b2Vec2(0.0F, 0.0F));
    adapter.mark({-0.02, 0.0}, {});
    REQUIRE(renderer.points.size() == 1);
    CHECK(renderer.points[0] == b2Vec2(-1.0F, 0.0F));
    adapter.polyline({}, {});
    adapter.outline({}, {});
    CHECK(renderer.segments.size() == 7);
    bridge::DrawAdapter unscaled(renderer, std::numeric_limits<double>::quiet_NaN());
    unscaled.mark({3.0, 4.0}, {});
    CHECK(renderer.points.back() == b2Vec2(3.0F, 4.0F));
}
