#include "supercircle/contact/crossing.h"

#include "supercircle/contact/circular_arc.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace supercircle::contact;
namespace crossing_check = supercircle::contact::crossing_check;

namespace {

constexpr double kThickness = 5e-4;

/// A rod of equal arcs with these curvatures, starting at `start` with tangent angle `angle`.
RodCurve chain(const Vec2& start, double angle, double length, const std::vector<double>& curvatures) {
    RodCurve c;
    c.halfThickness = 0.5 * kThickness;
    Arc arc{start, angle, 0.0, length / static_cast<double>(curvatures.size())};
    c.nodeS.push_back(0.0);
    for (const double k : curvatures) {
        arc.curvature = k;
        c.arcs.push_back(arc);
        c.nodeS.push_back(c.nodeS.back() + arc.length);
        arc.start = Vec2(arc.pointAt(arc.length));
        arc.angle = arc.angleAt(arc.length);
    }
    c.midS = 0.5 * length;
    return c;
}

RodCurve uniform(const Vec2& start, double angle, double length, double curvature, std::size_t elements = 15) {
    return chain(start, angle, length, std::vector<double>(elements, curvature));
}

RodCurve moved(RodCurve c, const Vec2& shift, double turn = 0.0, const Vec2& about = Vec2::Zero()) {
    const Vec2 x(std::cos(turn), std::sin(turn));
    for (Arc& a : c.arcs) {
        a.start = about + (a.start - about).x() * x + (a.start - about).y() * supercircle::rod::perp(x) + shift;
        a.angle += turn;
    }
    return c;
}

std::vector<Crossing> find(const std::vector<RodCurve>& curves, const std::vector<Outline>& outlines = {}) {
    std::vector<Crossing> out;
    findCrossings(curves, outlines, out);
    return out;
}

std::vector<Crossing> sweptCrossings(const std::vector<RodCurve>& before, const std::vector<RodCurve>& after,
                                     const std::vector<Outline>& outlines = {}) {
    std::vector<Crossing> out;
    findCrossingsSwept(before, after, outlines, outlines, out);
    return out;
}

Outline segment(const Vec2& a, const Vec2& b, OutlineKind kind = OutlineKind::Segment) {
    Outline o;
    o.kind = kind;
    o.points = {a, b};
    return o;
}

crossing_check::CircularArc randomArc(std::mt19937& random, double curvatureScale) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const double half = 0.6 + 0.4 * unit(random);
    const double k = std::clamp(curvatureScale * unit(random), -1.0 / half, 1.0 / half); // turns at most 2 rad
    return crossing_check::makeArc(Vec2(unit(random), unit(random)), M_PI * unit(random), k, half);
}

/// Smallest distance of two arcs by dense sampling of both, refined around the best pair.
double sampledDistance(const crossing_check::CircularArc& a, const crossing_check::CircularArc& b) {
    double low[2] = {-a.half, -b.half};
    double high[2] = {a.half, b.half};
    double best = INFINITY;
    for (int round = 0; round < 6; ++round) {
        const int n = round == 0 ? 160 : 16;
        double at[2] = {0.0, 0.0};
        double roundBest = INFINITY;
        for (int i = 0; i <= n; ++i) {
            const double sa = low[0] + (high[0] - low[0]) * i / n;
            const Vec2 p = a.at(sa);
            for (int j = 0; j <= n; ++j) {
                const double sb = low[1] + (high[1] - low[1]) * j / n;
                const double d = (p - b.at(sb)).norm();
                if (d < roundBest) {
                    roundBest = d;
                    at[0] = sa;
                    at[1] = sb;
                }
            }
        }
        best = std::min(best, roundBest);
        const double halves[2] = {a.half, b.half};
        for (int i = 0; i < 2; ++i) {
            const double width = 2.0 * (high[i] - low[i]) / n;
            low[i] = std::max(-halves[i], at[i] - width);
            high[i] = std::min(halves[i], at[i] + width);
        }
    }
    return best;
}

} // namespace

TEST_CASE("arcs intersect where their circles do", "[crossing]") {
    std::array<crossing_check::Intersection, 2> intersections;
    SECTION("two unit circles with centres one apart") { // at (1/2, sqrt(3)/2): closed form
        const auto a = crossing_check::makeArc(Vec2(0.0, 1.0), M_PI, 1.0, 1.0);
        const auto b = crossing_check::makeArc(Vec2(1.0, 1.0), M_PI, 1.0, 1.0);
        REQUIRE(crossing_check::intersect(a, b, 0.0, intersections) == 1);
        CHECK((intersections[0].where - Vec2(0.5, std::sqrt(0.75))).norm() < 1e-15);
        CHECK(intersections[0].sA == Approx(-M_PI / 6.0).epsilon(1e-14)); // 30 degrees before its middle at the top
    }
    SECTION("a line cuts a circle twice") {
        const auto arc = crossing_check::makeArc(Vec2(0.0, 1.0), M_PI, 1.0, 1.0);
        const auto line = crossing_check::makeArc(Vec2(0.0, 0.8), 0.0, 0.0, 2.0);
        REQUIRE(crossing_check::intersect(line, arc, 0.0, intersections) == 2);
        CHECK(std::abs(intersections[0].sA) == Approx(0.6).epsilon(1e-15));
        CHECK(intersections[0].sA == Approx(-intersections[1].sA).epsilon(1e-15));
        CHECK(crossing_check::intersect(crossing_check::makeArc(Vec2(0.0, 1.0 + 1e-9), 0.0, 0.0, 2.0), arc, 0.0,
                                        intersections) == 0);
        CHECK(crossing_check::intersect(crossing_check::makeArc(Vec2(0.0, 1.0 - 1e-9), 0.0, 0.0, 2.0), arc, 0.0,
                                        intersections) == 2);
    }
    SECTION("nearly straight ones intersect as straight ones do") {
        for (const double k : {0.0, 1e-300, 1e-15, -1e-12, 1e-9, -1e-7}) {
            for (const double l : {0.0, -1e-14, 1e-10}) {
                const auto a = crossing_check::makeArc(Vec2(0.1, 0.2), 0.3, k, 1.0);
                const auto b = crossing_check::makeArc(Vec2(0.1, 0.2), 0.3 + 1e-3, l, 1.0);
                REQUIRE(crossing_check::intersect(a, b, 0.0, intersections) == 1);
                CHECK((intersections[0].where - Vec2(0.1, 0.2)).norm() < 1e-12);
            }
        }
    }
    SECTION("overlapping arcs of one circle intersect") {
        const auto a = crossing_check::makeArc(Vec2(0.0, 1.0), M_PI, 1.0, 0.5);
        CHECK(crossing_check::intersect(a, crossing_check::makeArc(a.at(0.7), M_PI + 0.7, 1.0, 0.5), 0.0,
                                        intersections) == 1);
        CHECK(crossing_check::intersect(a, crossing_check::makeArc(a.at(1.1), M_PI + 1.1, 1.0, 0.5), 0.0,
                                        intersections) == 0);
    }
}

TEST_CASE("random arcs: intersections and distances agree with dense sampling", "[crossing]") {
    std::mt19937 random(7);
    std::array<crossing_check::Intersection, 2> intersections;
    int crossed = 0;
    for (int i = 0; i < 400; ++i) {
        const double scale = i % 4 == 0 ? 1e-9 : 1.5;
        const auto a = randomArc(random, scale);
        const auto b = randomArc(random, i % 3 == 0 ? 1e-12 : 1.5);
        const int n = crossing_check::intersect(a, b, 0.0, intersections);
        const double sampled = sampledDistance(a, b);
        INFO("pair " << i << ", sampled distance " << sampled);
        for (int m = 0; m < n; ++m) { // intersections lie on both
            const auto& intersection = intersections[static_cast<std::size_t>(m)];
            CHECK(std::abs(intersection.sA) <= a.half);
            CHECK((a.at(intersection.sA) - intersection.where).norm() < 1e-13);
            CHECK(crossing_check::distance(intersection.where, b) < 1e-13);
        }
        crossed += n > 0 ? 1 : 0;
        // The refinement ends on a grid of 2 (2/160) (4/16)^5 < 3e-5 of the length.
        CHECK((n > 0) == (sampled < 1e-4));
        CHECK(crossing_check::distance(a, b) == Approx(n > 0 ? 0.0 : sampled).margin(1e-4));
        CHECK(crossing_check::distance(a, b) <= sampled + 1e-12); // no sample is nearer
        CHECK(crossing_check::separation(a, b) <= sampled + 1e-12);
        CHECK(crossing_check::distance(a, b) == Approx(crossing_check::distance(b, a)).margin(1e-12));
    }
    CHECK(crossed > 50);
    CHECK(crossed < 350);
}

TEST_CASE("the distance of conformal arcs is the difference of their radii", "[crossing]") {
    const auto inner = crossing_check::makeArc(Vec2(0.0, 0.0192), M_PI, 1.0 / 0.0192, 0.004);
    const auto outer = crossing_check::makeArc(Vec2(0.0, 0.0197), M_PI, 1.0 / 0.0197, 0.004);
    CHECK(crossing_check::distance(inner, outer) == Approx(0.0005).epsilon(1e-12));
}

TEST_CASE("crossing rods are found where they cross", "[crossing]") {
    const RodCurve a = uniform(Vec2(-0.02, 0.0), 0.0, 0.04, 0.0);
    const RodCurve b = uniform(Vec2(0.003, -0.02), 0.5 * M_PI, 0.04, 0.0, 7);
    const auto found = find({a, b});
    REQUIRE(found.size() == 1);
    CHECK(found[0].rodA == 0);
    CHECK(found[0].rodB == 1);
    CHECK(found[0].outline == -1);
    CHECK(found[0].sA == Approx(0.023).epsilon(1e-12));
    CHECK((found[0].where - Vec2(0.003, 0.0)).norm() < 1e-15);
    RodCurve ghost = b;
    ghost.mask = 0;
    CHECK(find({a, ghost}).empty());
}

TEST_CASE("a rod that crosses itself is found, a spiral that does not is not", "[crossing]") {
    // One and a quarter turns of a closing spiral: crosses itself. With 5 elements the arcs are cut.
    for (const std::size_t n : {5U, 15U, 40U}) {
        INFO(n << " elements");
        std::vector<double> opening;
        for (std::size_t i = 0; i < n; ++i) // two and a half turns, ever wider
            opening.push_back(5.0 * M_PI / 0.2 /
                              (0.25 + 1.5 * (static_cast<double>(i) + 0.5) / static_cast<double>(n)) * 0.7);
        CHECK(find({chain(Vec2::Zero(), 0.0, 0.2, opening)}).empty());
        // A loop: straight legs that cross below a circle.
        std::vector<double> loop(n, 0.0);
        const double legs = 2.0 * std::floor(static_cast<double>(n) / 5.0);
        for (std::size_t i = static_cast<std::size_t>(legs / 2.0); i + static_cast<std::size_t>(legs / 2.0) < n; ++i)
            loop[i] = 1.7 * M_PI / (0.2 * (1.0 - legs / static_cast<double>(n)));
        const auto found = find({chain(Vec2::Zero(), 0.0, 0.2, loop)});
        REQUIRE(found.size() == 1);
        CHECK(found[0].rodA == 0);
        CHECK(found[0].rodB == 0);
    }
    CHECK(find({uniform(Vec2::Zero(), 0.0, 0.1, 0.9 * 2.0 * M_PI / 0.1, 1)}).empty());
    CHECK(find({uniform(Vec2::Zero(), 0.0, 0.1, 1.1 * 2.0 * M_PI / 0.1, 1)}).size() == 1);
}

TEST_CASE("rods in contact and nested shells do not cross", "[crossing]") {
    const double r = 0.0192;
    std::vector<RodCurve> nest;
    for (int i = 0; i < 8; ++i) { // concentric domes one thickness apart, openings down
        const double radius = r + i * kThickness;
        const double opening = 0.75 * 2.0 * M_PI;
        const double first = 0.5 * M_PI - 0.5 * opening;
        nest.push_back(uniform(radius * Vec2(std::cos(first), std::sin(first)), first + 0.5 * M_PI, opening * radius,
                               1.0 / radius));
    }
    CHECK(find(nest).empty());
    CHECK(sweptCrossings(nest, nest).empty());
    std::vector<RodCurve> falling;
    for (const RodCurve& c : nest)
        falling.push_back(moved(c, Vec2(0.001, -0.01), 0.02));
    CHECK(sweptCrossings(nest, falling).empty()); // together, by twenty thicknesses
    std::vector<RodCurve> pressed = nest;         // one is pushed by 90 % of the gap
    pressed[3] = moved(pressed[3], Vec2(0.0, 0.9 * kThickness));
    CHECK(sweptCrossings(nest, pressed).empty());
    pressed[3] = moved(nest[3], Vec2(0.0, 1.1 * kThickness));
    CHECK_FALSE(sweptCrossings(nest, pressed).empty());

    const RodCurve flat = uniform(Vec2(-0.02, 0.0), 0.0, 0.04, 0.0);
    CHECK(find({flat, moved(flat, Vec2(0.0, kThickness))}).empty());
    CHECK(sweptCrossings({flat, moved(flat, Vec2(0.0, kThickness))}, {flat, moved(flat, Vec2(0.03, kThickness))})
              .empty());
}

TEST_CASE("a rod that passes through within one step is found", "[crossing]") {
    const RodCurve wall = uniform(Vec2(-0.02, 0.0), 0.0, 0.04, 0.0);
    SECTION("sideways, parallel: they intersect at one instant only") {
        for (const double far : {0.0006, 0.003, 0.017, 0.1}) {
            const RodCurve above = moved(wall, Vec2(0.0, 0.0005));
            const auto found = sweptCrossings({wall, above}, {wall, moved(above, Vec2(0.0, -far))});
            REQUIRE(found.size() == 1);
            CHECK(found[0].rodA == 0);
            CHECK(found[0].rodB == 1);
            CHECK(find({wall, moved(above, Vec2(0.0, -far))}).empty()); // before and after are clean
        }
    }
    SECTION("a tip swings through") {
        const RodCurve rod = uniform(Vec2(0.0, 0.03), -0.7 * M_PI, 0.034, 0.0);
        const RodCurve swung = moved(rod, Vec2::Zero(), 0.4 * M_PI, Vec2(0.0, 0.03));
        CHECK(find({wall, rod}).empty());
        CHECK(find({wall, swung}).empty());
        CHECK(sweptCrossings({wall, rod}, {wall, swung}).size() == 1); // at the bottom its tip is 4 mm below the wall
        const RodCurve shorter = uniform(Vec2(0.0, 0.03), -0.7 * M_PI, 0.029, 0.0);
        CHECK(
            sweptCrossings({wall, shorter}, {wall, moved(shorter, Vec2::Zero(), 0.4 * M_PI, Vec2(0.0, 0.03))}).empty());
    }
    SECTION("a short rod flies through lengthwise") {
        const RodCurve dart = uniform(Vec2(0.001, 0.003), 0.5 * M_PI, 0.002, 0.0, 3);
        CHECK(sweptCrossings({wall, dart}, {wall, moved(dart, Vec2(0.0, -0.05))}).size() == 1);
        CHECK(sweptCrossings({wall, dart}, {wall, moved(dart, Vec2(0.5, 0.0))}).empty());
    }
    SECTION("both move, and only together do they pass") {
        const RodCurve above = moved(wall, Vec2(0.0, 0.001));
        CHECK(
            sweptCrossings({wall, above}, {moved(wall, Vec2(0.0, 0.0007)), moved(above, Vec2(0.0, -0.0007))}).size() ==
            1);
        CHECK(sweptCrossings({wall, above}, {moved(wall, Vec2(0.0, 0.0007)), moved(above, Vec2(0.0, 0.0007))}).empty());
    }
    SECTION("bending alone makes it cross") {
        // Half circle whose curvature flips: it sweeps through a rod that lies across its chord's middle line.
        const RodCurve bow = uniform(Vec2(-0.01, 0.0), 0.5, 0.02, -50.0);
        const RodCurve flipped = uniform(Vec2(-0.01, 0.0), -0.5, 0.02, 50.0);
        const RodCurve between = uniform(Vec2(-0.002, 0.0), 0.0, 0.004, 0.0, 2);
        CHECK(find({bow, between}).empty());
        CHECK(find({flipped, between}).empty());
        CHECK(sweptCrossings({bow, between}, {flipped, between}).size() == 1);
    }
}

TEST_CASE("random fast motions agree with fine sampling of the motion", "[crossing]") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    int met = 0;
    for (int i = 0; i < 200; ++i) {
        const RodCurve a =
            uniform(0.01 * Vec2(unit(random), unit(random)), M_PI * unit(random), 0.02, 60.0 * unit(random), 3);
        const RodCurve b =
            uniform(0.01 * Vec2(unit(random), unit(random)), M_PI * unit(random), 0.02, 60.0 * unit(random), 3);
        const Vec2 shift = 0.01 * Vec2(unit(random), unit(random));
        // Translation only: interpolation is then exact, and so must be the result.
        bool sampled = false;
        const int n = 2000;
        for (int j = 0; j <= n && !sampled; ++j)
            sampled = !find({a, moved(b, shift * (static_cast<double>(j) / n))}).empty();
        const bool swept = !sweptCrossings({a, b}, {a, moved(b, shift)}).empty();
        INFO("motion " << i);
        // Samples 7 um apart can miss a graze. The crossing check misses nothing that is deeper than 0.5 um.
        if (sampled)
            CHECK(swept);
        if (swept && !sampled) {
            bool graze = false;
            for (int j = 0; j <= n && !graze; ++j)
                graze = !find({a, moved(b, shift * (static_cast<double>(j) / n) + Vec2(0.0, 2e-5))}).empty() ||
                        !find({a, moved(b, shift * (static_cast<double>(j) / n) - Vec2(0.0, 2e-5))}).empty() ||
                        !find({a, moved(b, shift * (static_cast<double>(j) / n) + Vec2(2e-5, 0.0))}).empty() ||
                        !find({a, moved(b, shift * (static_cast<double>(j) / n) - Vec2(2e-5, 0.0))}).empty();
            CHECK(graze);
        }
        met += swept ? 1 : 0;
    }
    CHECK(met > 20);
    CHECK(met < 190);
}

TEST_CASE("centre lines across walls and inside solids are found", "[crossing]") {
    const RodCurve rod = uniform(Vec2(-0.02, 0.001), 0.0, 0.04, 0.0);
    SECTION("two-sided segments") {
        CHECK(find({rod}, {segment({0.0, -0.01}, {0.0, 0.01})}).size() == 1);
        CHECK(find({rod}, {segment({-0.1, 0.0}, {0.1, 0.0})}).empty());
        const auto through = sweptCrossings({rod}, {moved(rod, Vec2(0.0, -0.01))}, {segment({-0.1, 0.0}, {0.1, 0.0})});
        REQUIRE(through.size() == 1);
        CHECK(through[0].rodA == 0);
        CHECK(through[0].rodB == -1);
        CHECK(through[0].outline == 0);
    }
    SECTION("polygons and discs") {
        Outline box;
        box.kind = OutlineKind::Polygon;
        box.points = {{-0.1, -0.05}, {0.1, -0.05}, {0.1, 0.0}, {-0.1, 0.0}};
        CHECK(find({rod}, {box}).empty());
        CHECK(sweptCrossings({rod}, {rod}, {box}).empty());
        const auto wholly = find({moved(rod, Vec2(0.0, -0.01))}, {box});
        REQUIRE(wholly.size() == 1); // once, though every element lies inside
        CHECK(wholly[0].outline == 0);
        CHECK(find({moved(rod, Vec2(0.09, -0.01))}, {box}).size() == 1);                // half out
        CHECK(sweptCrossings({rod}, {moved(rod, Vec2(0.0, -0.1))}, {box}).size() == 1); // and out again on the far side
        Outline pin; // smaller than an element: no end or middle lies in it
        pin.kind = OutlineKind::Circle;
        pin.radius = 2e-4;
        pin.points = {{0.0009, 0.001}};
        CHECK(find({rod}, {pin}).size() == 1);
        pin.points = {{0.0009, 0.0013}};
        CHECK(find({rod}, {pin}).empty());
        CHECK(sweptCrossings({rod}, {moved(rod, Vec2(0.0, 0.01))}, {pin}).size() == 1);
        std::vector<Crossing> out;
        Outline past = pin;
        past.points[0].y() = -0.01;
        findCrossingsSwept({rod}, {rod}, {pin}, {past}, out); // the disc moves
        CHECK(out.size() == 1);
    }
    SECTION("one-sided edges") {
        const Outline floor = segment({-0.1, 0.0}, {0.1, 0.0}, OutlineKind::OneSided); // solid below
        CHECK(find({rod}, {floor}).empty());
        CHECK(find({moved(rod, Vec2(0.0, -0.0012))}, {floor}).size() == 1); // 0.2 mm behind
        CHECK(find({moved(rod, Vec2(0.0, -0.01))}, {floor}).empty());       // well behind the floor
        CHECK(sweptCrossings({rod}, {moved(rod, Vec2(0.0, -0.01))}, {floor}).size() == 1);
    }
    SECTION("only passage from front to back counts at one-sided edges") {
        const Outline floor = segment({-0.1, 0.0}, {0.1, 0.0}, OutlineKind::OneSided);
        const RodCurve under = moved(rod, Vec2(0.0, -0.01)), close = moved(rod, Vec2(0.0, -0.0012));
        CHECK(sweptCrossings({under}, {rod}, {floor}).empty()); // from behind
        CHECK(sweptCrossings({close}, {rod}, {floor}).empty());
        CHECK(sweptCrossings({close}, {close}, {floor}).empty()); // it stays behind
        CHECK(sweptCrossings({under}, {close}, {floor}).empty());
        CHECK(sweptCrossings({rod}, {close}, {floor}).size() == 1);
        // What crosses at the start counts: who calls knows whether it was on its way or put there.
        const RodCurve upright = uniform({0.0, -0.005}, 0.5 * M_PI, 0.01, 0.0);
        CHECK(sweptCrossings({upright}, {moved(upright, Vec2(0.0, 0.02))}, {floor}).size() == 1);
    }
}

TEST_CASE("a rod bent round the free end of a one-sided edge does not sink into it", "[crossing]") {
    // An arc of one element whose tip is above the edge, and whose middle hangs below its line beyond its end.
    const Outline ledge = segment({-0.1, 0.0}, {0.1, 0.0}, OutlineKind::OneSided);
    const RodCurve round = uniform({0.098, 1e-7}, 0.5, 0.03, -100.0, 1); // closer than what counts as touching
    CHECK(sweptCrossings({round}, {moved(round, Vec2(0.0, -1e-4))}, {ledge}).size() == 1);
    CHECK(sweptCrossings({round}, {moved(round, Vec2(0.0, 1e-4))}, {ledge}).empty());
}

TEST_CASE("a rod comes sideways over the free end of a one-sided edge from below, not from above", "[crossing]") {
    const Outline ledge = segment({0.0, 0.0}, {0.1, 0.0}, OutlineKind::OneSided);
    for (const double lean : {0.2, -0.2}) { // its nearest point to the end is below the edge's line, or above
        const RodCurve rod = moved(uniform({0.0, -0.04}, 0.5 * M_PI, 0.1, 0.0, 2), Vec2(-1e-3, 0.0), lean);
        CHECK(sweptCrossings({rod}, {moved(rod, Vec2(2e-3, -1e-4))}, {ledge}).size() == (lean > 0.0 ? 0 : 1));
    }
}

TEST_CASE("what is beside one flank of a ridge is not behind the other one", "[crossing]") {
    Outline left = segment({-0.1, -0.4}, {0.0, 0.0}, OutlineKind::OneSided); // solid between the flanks
    Outline right = segment({0.0, 0.0}, {0.1, -0.4}, OutlineKind::OneSided);
    left.joinedEnd = right.joinedStart = true;
    left.neighbourEnd = right.points[1];
    right.neighbourStart = left.points[0];
    const Vec2 out = Vec2(0.4, 0.1).normalized(); // of the right flank
    const RodCurve rod = uniform(Vec2(0.0, 0.0) + 2e-3 * out, std::atan2(-0.4, 0.1), 0.02, 0.0, 2);
    CHECK(sweptCrossings({rod}, {moved(rod, -1.9e-3 * out)}, {left, right}).empty()); // less behind the left than h
    CHECK_FALSE(sweptCrossings({rod}, {moved(rod, -2.1e-3 * out)}, {left, right}).empty());
}

TEST_CASE("a rod comes out of a valley of one-sided edges from behind", "[crossing]") {
    Outline floor = segment({-0.1, 0.0}, {0.0, 0.0}, OutlineKind::OneSided);
    Outline wall = segment({0.0, 0.0}, {0.0, 0.1}, OutlineKind::OneSided); // its front is on the left
    floor.joinedEnd = wall.joinedStart = true;
    floor.neighbourEnd = wall.points[1];
    wall.neighbourStart = floor.points[0];
    for (const double y : {2e-4, -5e-3}) { // beside the wall, or half below the line of the floor
        const RodCurve rod = uniform({2e-3, y}, 0.5 * M_PI, 0.01, 0.0);
        CHECK(sweptCrossings({rod}, {moved(rod, Vec2(-4e-3, 0.0))}, {floor, wall}).empty());
    }
}

TEST_CASE("the crossing check does not depend on the order of the rods", "[crossing]") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<RodCurve> curves;
    for (int i = 0; i < 20; ++i)
        curves.push_back(
            uniform(0.03 * Vec2(unit(random), unit(random)), M_PI * unit(random), 0.04, 50.0 * unit(random)));
    const auto forward = find(curves);
    std::reverse(curves.begin(), curves.end());
    const auto backward = find(curves);
    CHECK(forward.size() > 10);
    CHECK(forward.size() == backward.size());
}

TEST_CASE("ways that bend too much are left out, and judged after a cut", "[contact][crossing]") {
    // A strip that rolls up beside another one in one step: the ends of its interpolated arcs are known to 3 mm only.
    // Walked in steps of a thousandth of the thickness, such pairs cost tens of thousands of samples.
    const std::size_t n = 4;
    const RodCurve strip = uniform({0.0, 0.0}, 0.0, 0.1, 0.0, n);
    const RodCurve rolled = uniform({0.0, 0.0}, 0.0, 0.1, 60.0, n);
    const RodCurve other = uniform({0.0, 0.03}, 0.0, 0.1, 0.0, n);
    const auto check = [&](double share) { // of the step
        const RodCurve end = uniform({0.0, 0.0}, 0.0, 0.1, 60.0 * share, n);
        CheckEffort effort{.bounded = true};
        std::vector<Crossing> out;
        findCrossingsSwept({strip, other}, {end, other}, {}, {}, out, {}, &effort);
        CHECK(effort.samples <= 400.0 * effort.pairs);
        return effort.unjudged.size();
    };
    CHECK(check(1.0) > 0);
    CHECK(check(1.0 / 16.0) == 0);
    CHECK_FALSE(sweptCrossings({strip, other}, {rolled, other}).empty()); // unbounded: it is walked to its end
    // Work beyond the limit ends the check.
    CheckEffort little{.maxWork = 1.0};
    std::vector<Crossing> out;
    findCrossingsSwept({strip, other}, {moved(strip, {0.0, 0.06}), other}, {}, {}, out, {}, &little);
    CHECK(little.unfinished());
}
