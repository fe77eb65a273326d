// Debug drawing: polylines within the tolerance of the arcs, colours of strain, exceptions.

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/stepper.h"
#include "tests/plugin/api/support.h"
#include "tests/support/tumble.h"

#include <catch2/catch.hpp>
#include <limits>
#include <stdexcept>

using namespace supercircle;
using namespace supercircle::test;

namespace {

struct DrawnLine {
    std::vector<Point> points;
    Colour colour;
};

class RecordingCanvas : public DebugDraw {
public:
    void polyline(std::span<const Point> points, const Colour& colour) override {
        lines.push_back({{points.begin(), points.end()}, colour});
    }
    void outline(std::span<const Point> points, const Colour& colour) override {
        outlines.push_back({{points.begin(), points.end()}, colour});
    }
    void mark(const Point& at, const Colour& colour) override { marks.push_back({{at}, colour}); }
    std::vector<DrawnLine> lines, outlines, marks;
};

class ThrowingCanvas : public RecordingCanvas {
public:
    void mark(const Point&, const Colour&) override { throw std::runtime_error("canvas failed"); }
};

} // namespace

TEST_CASE("polylines stay within the tolerance of the arcs and use few points", "[plugin][draw]") {
    Shells shells(nullptr);
    const double R = 0.05, h = 0.002;
    REQUIRE(shells.create(dome(R, h, 3)));
    for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
        RecordingCanvas canvas;
        DrawOptions options;
        options.tolerance = tolerance;
        options.strain = false;
        REQUIRE(shells.draw(canvas, options));
        REQUIRE(canvas.lines.size() == 1);
        const auto& points = canvas.lines[0].points;
        double worst = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            CHECK(std::hypot(points[i].x, points[i].y) == Approx(R).epsilon(1e-12));
            if (i > 0)
                worst = std::max(worst, R - std::hypot(0.5 * (points[i].x + points[i - 1].x),
                                                       0.5 * (points[i].y + points[i - 1].y)));
        }
        CHECK(worst <= tolerance * (1.0 + 1e-9));
        CHECK(worst > 0.2 * tolerance); // three arcs have whole numbers of chords
        // the outline encloses what the thick shell covers: half a ring and two half discs (its chords cut a bit off)
        REQUIRE(canvas.outlines.size() == 1);
        const auto& o = canvas.outlines[0].points;
        double area = 0.0, length = 0.0;
        for (std::size_t i = 0; i < o.size(); ++i) {
            const Point& a = o[i];
            const Point& b = o[(i + 1) % o.size()];
            area += 0.5 * (a.x * b.y - b.x * a.y);
            length += std::hypot(b.x - a.x, b.y - a.y);
        }
        CHECK(std::abs(area) == Approx(M_PI * R * h + M_PI * 0.25 * h * h).margin(tolerance * length));
        CHECK(length == Approx(2.0 * M_PI * R + M_PI * h).epsilon(2.0 * tolerance / h));
    }
}

TEST_CASE("colours show strain, element by element", "[plugin][draw]") {
    Shells shells(nullptr);
    ShellDef d = dome(0.05, 0.002, 3);
    d.curvature = {20.0, 25.0, 40.0}; // natural 20: strains 0, 0.5 %, 2 %
    REQUIRE(shells.create(d));
    RecordingCanvas canvas;
    DrawOptions options;
    options.full_strain = 0.02;
    REQUIRE(shells.draw(canvas, options));
    REQUIRE(canvas.lines.size() == 3);
    CHECK(canvas.lines[0].colour.blue > canvas.lines[0].colour.red);
    CHECK(canvas.lines[2].colour.red > canvas.lines[2].colour.blue);
    for (std::size_t i = 1; i < 3; ++i) { // joined end to end
        CHECK(canvas.lines[i].points.front().x == canvas.lines[i - 1].points.back().x);
        CHECK(canvas.lines[i].points.front().y == canvas.lines[i - 1].points.back().y);
    }
    const Colour cold = strain_colour(0.0, 1.0), warm = strain_colour(1.0, 1.0), beyond = strain_colour(7.0, 1.0);
    CHECK(cold.blue > 0.8F);
    CHECK(warm.red > 0.9F);
    CHECK(beyond.red == warm.red);
    for (int i = 0; i <= 100; ++i) {
        const Colour c = strain_colour(0.01 * i, 1.0);
        for (const float x : {c.red, c.green, c.blue, c.alpha}) {
            CHECK(x >= 0.0F);
            CHECK(x <= 1.0F);
        }
    }
}

TEST_CASE("contacts, forces, holds and rings are drawn", "[plugin][draw]") {
    auto host = std::make_shared<FakeHost>();
    host->g = {0.0, -9.81};
    host->addGround(1, 0.35);
    Shells shells(host);
    ShellDef d = dome(0.02, 0.001, 8);
    d.position = {0.0, 0.0005};
    d.angle = 0.0;
    const ShellHandle shell = *shells.create(d);
    ShellDef ring;
    ring.closed = true;
    ring.phi_bar = 1.0;
    ring.position = {0.2, 0.1};
    REQUIRE(shells.create_hold(*shells.create(ring), 0.25, HoldKind::Pin));
    for (int i = 0; i < 400; ++i) {
        REQUIRE(shells.pre_step(4e-3).failure.empty());
        REQUIRE(shells.post_step());
    }
    RecordingCanvas canvas;
    DrawOptions options;
    options.metres_per_newton = 2.0;
    options.centre_lines = false;
    REQUIRE(shells.draw(canvas, options));
    CHECK(canvas.outlines.size() == 3); // the ring has two
    CHECK(canvas.marks.size() == 1 + canvas.lines.size());
    double up = 0.0;
    for (const DrawnLine& force : canvas.lines) {
        REQUIRE(force.points.size() == 2);
        CHECK(force.points[0].y == Approx(0.0).margin(1e-6));
        up += (force.points[1].y - force.points[0].y) / options.metres_per_newton;
    }
    CHECK(up == Approx(shells.state(shell)->mass * 9.81).epsilon(1e-2)); // rocking fades
    ThrowingCanvas throwing;
    const auto result = shells.draw(throwing);
    REQUIRE_FALSE(result);
    CHECK(result.error() == "canvas failed");
    options.tolerance = 0.0;
    CHECK_FALSE(shells.draw(canvas, options));
    options.tolerance = std::numeric_limits<double>::quiet_NaN();
    CHECK_FALSE(shells.draw(canvas, options));
}
