// Pictures: polylines stay as near to the arcs as asked, colours tell strain, exceptions stay inside.

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/stepper.h"
#include "tests/plugin/api/play.h"
#include "tests/support/tumble.h"

#include <catch2/catch.hpp>
#include <limits>
#include <stdexcept>

using namespace supercircle;
using namespace supercircle::test;

namespace {

struct Line {
    std::vector<Point> points;
    Colour colour;
};

class Paper : public DebugDraw {
public:
    void polyline(std::span<const Point> points, const Colour& colour) override {
        lines.push_back({{points.begin(), points.end()}, colour});
    }
    void outline(std::span<const Point> points, const Colour& colour) override {
        outlines.push_back({{points.begin(), points.end()}, colour});
    }
    void mark(const Point& at, const Colour& colour) override { marks.push_back({{at}, colour}); }
    std::vector<Line> lines, outlines, marks;
};

class Torn : public Paper {
public:
    void mark(const Point&, const Colour&) override { throw std::runtime_error("torn paper"); }
};

} // namespace

TEST_CASE("polylines stay within the tolerance of the arcs and use few points", "[plugin][draw]") {
    Shells shells(nullptr);
    const double R = 0.05, h = 0.002;
    REQUIRE(shells.create(dome(R, h, 3)));
    for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
        Paper paper;
        DrawOptions options;
        options.tolerance = tolerance;
        options.strain = false;
        REQUIRE(shells.draw(paper, options));
        REQUIRE(paper.lines.size() == 1);
        const auto& points = paper.lines[0].points;
        double worst = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            CHECK(std::hypot(points[i].x, points[i].y) == Approx(R).epsilon(1e-12));
            if (i > 0)
                worst = std::max(worst, R - std::hypot(0.5 * (points[i].x + points[i - 1].x),
                                                       0.5 * (points[i].y + points[i - 1].y)));
        }
        CHECK(worst <= tolerance * (1.0 + 1e-9));
        CHECK(worst > 0.2 * tolerance); // not wasteful: three arcs of whole numbers of chords
        // the outline encloses what the thick shell covers: half a ring and two half discs (its chords cut a bit off)
        REQUIRE(paper.outlines.size() == 1);
        const auto& o = paper.outlines[0].points;
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

TEST_CASE("colours tell strain, element by element", "[plugin][draw]") {
    Shells shells(nullptr);
    ShellDef d = dome(0.05, 0.002, 3);
    d.curvature = {20.0, 25.0, 40.0}; // natural 20: strains 0, 0.5 %, 2 %
    REQUIRE(shells.create(d));
    Paper paper;
    DrawOptions options;
    options.full_strain = 0.02;
    REQUIRE(shells.draw(paper, options));
    REQUIRE(paper.lines.size() == 3);
    CHECK(paper.lines[0].colour.blue > paper.lines[0].colour.red);
    CHECK(paper.lines[2].colour.red > paper.lines[2].colour.blue);
    for (std::size_t i = 1; i < 3; ++i) { // joined end to end
        CHECK(paper.lines[i].points.front().x == paper.lines[i - 1].points.back().x);
        CHECK(paper.lines[i].points.front().y == paper.lines[i - 1].points.back().y);
    }
    const Colour cold = strainColour(0.0, 1.0), warm = strainColour(1.0, 1.0), beyond = strainColour(7.0, 1.0);
    CHECK(cold.blue > 0.8F);
    CHECK(warm.red > 0.9F);
    CHECK(beyond.red == warm.red);
    for (int i = 0; i <= 100; ++i) {
        const Colour c = strainColour(0.01 * i, 1.0);
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
    REQUIRE(shells.hold(*shells.create(ring), 0.25, HoldKind::Pin));
    for (int i = 0; i < 400; ++i) {
        REQUIRE(shells.pre_step(4e-3).failure.empty());
        shells.post_step();
    }
    Paper paper;
    DrawOptions options;
    options.metres_per_newton = 2.0;
    options.centre_lines = false;
    REQUIRE(shells.draw(paper, options));
    CHECK(paper.outlines.size() == 3); // the ring has two
    CHECK(paper.marks.size() == 1 + paper.lines.size());
    double up = 0.0;
    for (const Line& force : paper.lines) {
        REQUIRE(force.points.size() == 2);
        CHECK(force.points[0].y == Approx(0.0).margin(1e-6));
        up += (force.points[1].y - force.points[0].y) / options.metres_per_newton;
    }
    CHECK(up == Approx(shells.measure(shell)->mass * 9.81).epsilon(1e-2)); // rocking fades
    Torn torn;
    const auto result = shells.draw(torn);
    REQUIRE_FALSE(result);
    CHECK(result.error() == "torn paper");
    options.tolerance = 0.0;
    CHECK_FALSE(shells.draw(paper, options));
    options.tolerance = std::numeric_limits<double>::quiet_NaN();
    CHECK_FALSE(shells.draw(paper, options));
}
