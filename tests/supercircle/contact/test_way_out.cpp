// Ways out of an overlap, against figures whose ways are known.

#include "supercircle/contact/way_out.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::contact;

namespace {

constexpr double kRound = 1e-9; ///< m, of bodies of the size of 1 m: bisection to 1e-12 of an element

/// A rod of equal arcs.
RodCurve rodFrom(const Vec2& start, double angle, double length, double curvature = 0.0, bool closed = false) {
    constexpr int kElements = 16;
    RodCurve c;
    c.halfThickness = 0.005;
    c.closed = closed;
    Arc arc{start, angle, curvature, length / kElements};
    c.nodeS.push_back(0.0);
    for (int i = 0; i < kElements; ++i) {
        c.arcs.push_back(arc);
        c.nodeS.push_back(c.nodeS.back() + arc.length);
        arc.start = Vec2(arc.pointAt(arc.length));
        arc.angle = arc.angleAt(arc.length);
    }
    c.midS = 0.5 * length;
    return c;
}

Outline outline(OutlineKind kind, std::vector<Vec2> points, double radius = 0.0) {
    Outline o;
    o.kind = kind;
    o.radius = radius;
    for (const Vec2& p : points)
        o.points.push_back(p);
    return o;
}

Outline box(double x0, double y0, double x1, double y1) {
    return outline(OutlineKind::Polygon, {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
}

WayOut shortest(const std::vector<WayOut>& ways) {
    REQUIRE_FALSE(ways.empty());
    return *std::min_element(ways.begin(), ways.end(),
                             [](const WayOut& a, const WayOut& b) { return a.distance < b.distance; });
}

WayOut of(WayKind kind, const std::vector<WayOut>& ways) {
    const auto it = std::find_if(ways.begin(), ways.end(), [kind](const WayOut& w) { return w.kind == kind; });
    REQUIRE(it != ways.end());
    return *it;
}

} // namespace

TEST_CASE("two straight rods part over the nearest of their four ends", "[contact][wayout]") {
    const RodCurve a = rodFrom({-0.3, 0.0}, 0.0, 1.0); // crosses x = 0 at s = 0.3
    for (const double below : {0.1, 0.45, 0.9}) {
        const RodCurve b = rodFrom({0.0, -below}, M_PI / 2.0, 1.0); // crosses y = 0 at s = below
        const std::vector<WayOut> ways = waysOut(a, b);
        CHECK(of(WayKind::StartOfA, ways).distance == Approx(0.3).margin(kRound));
        CHECK(of(WayKind::EndOfA, ways).distance == Approx(0.7).margin(kRound));
        CHECK(of(WayKind::StartOfB, ways).distance == Approx(below).margin(kRound));
        CHECK(of(WayKind::EndOfB, ways).distance == Approx(1.0 - below).margin(kRound));
        const WayOut way = shortest(ways);
        CHECK(way.distance == Approx(std::min({0.3, below, 1.0 - below})).margin(kRound));
        REQUIRE(way.pushes.size() == 1);
        CHECK(way.pushes[0].sA == Approx(0.3).margin(kRound));
        CHECK(way.pushes[0].sB == Approx(below).margin(kRound));
        // A goes to the right over its start, up over the end of B, down over its start.
        const Vec2 expected = below == 0.45 ? Vec2(1.0, 0.0) : below == 0.1 ? Vec2(0.0, -1.0) : Vec2(0.0, 1.0);
        CHECK((way.pushes[0].direction - expected).norm() < kRound);
    }
    CHECK(waysOut(a, rodFrom({0.0, 0.01}, M_PI / 2.0, 1.0)).empty());
}

TEST_CASE("a shallow bulge goes back, and rings have no other way", "[contact][wayout]") {
    const RodCurve flat = rodFrom({-1.0, 0.0}, 0.0, 2.0);
    const double R = 1.0, deep = 0.02;
    const RodCurve bulge = rodFrom({-R, R - deep}, -M_PI / 2.0, M_PI * R, 1.0 / R); // its lowest point is at y = -deep
    const WayOut way = shortest(waysOut(bulge, flat));
    CHECK(way.kind == WayKind::Back);
    CHECK(way.distance == Approx(deep).margin(kRound));
    REQUIRE(way.pushes.size() == 1);
    CHECK((way.pushes[0].direction - Vec2(0.0, 1.0)).norm() < 1e-6);

    const RodCurve left = rodFrom({-0.6, -1.0}, 0.0, 2.0 * M_PI, 1.0, true),
                   right = rodFrom({0.9, -1.0}, 0.0, 2.0 * M_PI, 1.0, true);
    const std::vector<WayOut> ways = waysOut(left, right);
    REQUIRE(ways.size() == 1);
    CHECK(ways[0].kind == WayKind::Back);
    CHECK(ways[0].distance == Approx(0.5).margin(1e-6)); // 2 R less the distance of the centres
    CHECK((ways[0].pushes[0].direction - Vec2(-1.0, 0.0)).norm() < 1e-6);
}

TEST_CASE("a rod that crosses itself opens over the end that is nearer to the crossing", "[contact][wayout]") {
    // A straight piece of 0.5 m, a loop of 300 degrees of radius 0.2 m and a straight piece of 0.5 m.
    RodCurve c;
    c.halfThickness = 0.005;
    Arc arc{{0.0, 0.0}, 0.0, 0.0, 0.1};
    c.nodeS.push_back(0.0);
    const auto add = [&](int n, double curvature, double length) {
        for (int i = 0; i < n; ++i) {
            arc.curvature = curvature;
            arc.length = length;
            c.arcs.push_back(arc);
            c.nodeS.push_back(c.nodeS.back() + length);
            arc.start = Vec2(arc.pointAt(length));
            arc.angle = arc.angleAt(length);
        }
    };
    add(5, 0.0, 0.1);
    add(10, 5.0, 0.2 * M_PI / 6.0);
    add(5, 0.0, 0.12);
    const double tangent = 0.2 * std::tan(M_PI / 6.0); // from the crossing to where the loop begins
    const std::vector<WayOut> ways = waysOut(c, c);
    const WayOut way = shortest(ways);
    CHECK(way.kind == WayKind::StartOfA);
    CHECK(way.distance == Approx(0.5 - tangent).margin(1e-6));
    REQUIRE(way.pushes.size() == 1);
    CHECK(way.pushes[0].sB == Approx(0.5 + 0.2 * 10.0 * M_PI / 6.0 + tangent).margin(1e-6));
}

TEST_CASE("a rod leaves a solid by its nearest face, where contacts lead there", "[contact][wayout]") {
    // Tips of a hoop 0.01 m inside the floor: up, by contacts.
    const RodCurve hoop = rodFrom({1.0, -0.01}, M_PI / 2.0, M_PI, 1.0);
    const WayOut up = shortest(waysOut(hoop, box(-5.0, -1.0, 5.0, 0.0)));
    CHECK(up.distance == Approx(0.01).margin(kRound));
    CHECK(up.contactLeads);
    for (const Push& p : up.pushes)
        CHECK((p.direction - Vec2(0.0, 1.0)).norm() < kRound);

    // Straight through a thin wall near its top: over the top, which is nearer than the ends, without contacts.
    const RodCurve through = rodFrom({-0.7, 0.0}, 0.0, 1.4);
    const WayOut over = shortest(waysOut(through, box(-0.05, -2.0, 0.05, 0.3)));
    CHECK(over.distance == Approx(0.3).margin(kRound));
    CHECK_FALSE(over.contactLeads);
    CHECK((over.pushes[0].direction - Vec2(0.0, 1.0)).norm() < kRound);

    // Through a high one: off the nearer end, to the last point inside (a sample a 1/128 of the rod before the face).
    const WayOut off = shortest(waysOut(rodFrom({-0.5, 0.0}, 0.0, 1.4), box(-0.05, -2.0, 0.05, 2.0)));
    CHECK(off.kind == WayKind::StartOfA);
    CHECK(off.distance == Approx(0.55).margin(1.4 / 128.0));
    CHECK((off.pushes[0].direction - Vec2(1.0, 0.0)).norm() < kRound);

    // A chord of a disc goes sideways out of it.
    const WayOut side = shortest(waysOut(through, outline(OutlineKind::Circle, {{0.0, -0.2}}, 0.3)));
    CHECK(side.distance == Approx(0.1).margin(1e-3)); // the sample nearest to the middle is 5 mm beside it
    CHECK(side.pushes[0].direction.y() == Approx(1.0).margin(1e-3));
    CHECK(waysOut(through, box(-0.05, 0.1, 0.05, 0.3)).empty());
}

TEST_CASE("a rod leaves a segment over the nearest end and a one-sided edge to its front", "[contact][wayout]") {
    const RodCurve through = rodFrom({-0.7, 0.0}, 0.0, 1.4);
    const Outline post = outline(OutlineKind::Segment, {{0.0, -2.0}, {0.0, 0.2}});
    CHECK(of(WayKind::EndOfB, waysOut(through, post)).distance == Approx(0.2).margin(kRound));
    CHECK(of(WayKind::StartOfB, waysOut(through, post)).distance == Approx(2.0).margin(kRound));
    const WayOut up = shortest(waysOut(through, post));
    CHECK((up.pushes[0].direction - Vec2(0.0, 1.0)).norm() < kRound);

    const Outline ledge = outline(OutlineKind::OneSided, {{-1.0, 0.0}, {1.0, 0.0}}); // front above
    const WayOut front = shortest(waysOut(rodFrom({0.0, -0.4}, M_PI / 2.0, 1.0), ledge));
    CHECK((front.pushes[0].direction - Vec2(0.0, 1.0)).norm() < kRound);
    CHECK_FALSE(front.contactLeads); // they reach one thickness
    CHECK(shortest(waysOut(rodFrom({0.0, -0.004}, M_PI / 2.0, 1.0), ledge)).contactLeads);
}
