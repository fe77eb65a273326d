#include "supercircle/contact/crossing.h"

#include "supercircle/contact/crossing_piece.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace supercircle::contact;
namespace witness = supercircle::contact::witness;

namespace {

constexpr double kThickness = 5e-4;

/// A rod of equal arcs with these curvatures, starting at `start` with tangent angle `angle`.
Curve chain(const Vec2& start, double angle, double length, const std::vector<double>& curvatures) {
    Curve c;
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

Curve uniform(const Vec2& start, double angle, double length, double curvature, std::size_t elements = 15) {
    return chain(start, angle, length, std::vector<double>(elements, curvature));
}

Curve moved(Curve c, const Vec2& shift, double turn = 0.0, const Vec2& about = Vec2::Zero()) {
    const Vec2 x(std::cos(turn), std::sin(turn));
    for (Arc& a : c.arcs) {
        a.start = about + (a.start - about).x() * x + (a.start - about).y() * supercircle::rod::perp(x) + shift;
        a.angle += turn;
    }
    return c;
}

std::vector<Crossing> find(const std::vector<Curve>& curves, const std::vector<Outline>& outlines = {}) {
    std::vector<Crossing> out;
    findCrossings(curves, outlines, out);
    return out;
}

std::vector<Crossing> sweep(const std::vector<Curve>& before, const std::vector<Curve>& after,
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

witness::Piece randomPiece(std::mt19937& random, double curvatureScale) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const double half = 0.6 + 0.4 * unit(random);
    const double k = std::clamp(curvatureScale * unit(random), -1.0 / half, 1.0 / half); // turns at most 2 rad
    return witness::makePiece(Vec2(unit(random), unit(random)), M_PI * unit(random), k, half);
}

/// Smallest distance of two pieces by dense sampling of both, refined around the best pair.
double sampledDistance(const witness::Piece& a, const witness::Piece& b) {
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
    std::array<witness::Meeting, 2> meetings;
    SECTION("two unit circles with centres one apart") { // at (1/2, sqrt(3)/2): closed form
        const auto a = witness::makePiece(Vec2(0.0, 1.0), M_PI, 1.0, 1.0);
        const auto b = witness::makePiece(Vec2(1.0, 1.0), M_PI, 1.0, 1.0);
        REQUIRE(witness::intersect(a, b, 0.0, meetings) == 1);
        CHECK((meetings[0].where - Vec2(0.5, std::sqrt(0.75))).norm() < 1e-15);
        CHECK(meetings[0].sA == Approx(-M_PI / 6.0).epsilon(1e-14)); // 30 degrees before its middle at the top
    }
    SECTION("a line cuts a circle twice") {
        const auto arc = witness::makePiece(Vec2(0.0, 1.0), M_PI, 1.0, 1.0);
        const auto line = witness::makePiece(Vec2(0.0, 0.8), 0.0, 0.0, 2.0);
        REQUIRE(witness::intersect(line, arc, 0.0, meetings) == 2);
        CHECK(std::abs(meetings[0].sA) == Approx(0.6).epsilon(1e-15));
        CHECK(meetings[0].sA == Approx(-meetings[1].sA).epsilon(1e-15));
        CHECK(witness::intersect(witness::makePiece(Vec2(0.0, 1.0 + 1e-9), 0.0, 0.0, 2.0), arc, 0.0, meetings) == 0);
        CHECK(witness::intersect(witness::makePiece(Vec2(0.0, 1.0 - 1e-9), 0.0, 0.0, 2.0), arc, 0.0, meetings) == 2);
    }
    SECTION("nearly straight ones meet as straight ones do") {
        for (const double k : {0.0, 1e-300, 1e-15, -1e-12, 1e-9, -1e-7}) {
            for (const double l : {0.0, -1e-14, 1e-10}) {
                const auto a = witness::makePiece(Vec2(0.1, 0.2), 0.3, k, 1.0);
                const auto b = witness::makePiece(Vec2(0.1, 0.2), 0.3 + 1e-3, l, 1.0);
                REQUIRE(witness::intersect(a, b, 0.0, meetings) == 1);
                CHECK((meetings[0].where - Vec2(0.1, 0.2)).norm() < 1e-12);
            }
        }
    }
    SECTION("overlapping pieces of one circle meet") {
        const auto a = witness::makePiece(Vec2(0.0, 1.0), M_PI, 1.0, 0.5);
        CHECK(witness::intersect(a, witness::makePiece(a.at(0.7), M_PI + 0.7, 1.0, 0.5), 0.0, meetings) == 1);
        CHECK(witness::intersect(a, witness::makePiece(a.at(1.1), M_PI + 1.1, 1.0, 0.5), 0.0, meetings) == 0);
    }
}

TEST_CASE("random arcs: intersections and distances agree with dense sampling", "[crossing]") {
    std::mt19937 random(7);
    std::array<witness::Meeting, 2> meetings;
    int crossed = 0;
    for (int i = 0; i < 400; ++i) {
        const double scale = i % 4 == 0 ? 1e-9 : 1.5;
        const auto a = randomPiece(random, scale);
        const auto b = randomPiece(random, i % 3 == 0 ? 1e-12 : 1.5);
        const int n = witness::intersect(a, b, 0.0, meetings);
        const double sampled = sampledDistance(a, b);
        INFO("pair " << i << ", sampled distance " << sampled);
        for (int m = 0; m < n; ++m) { // meetings lie on both
            const auto& meeting = meetings[static_cast<std::size_t>(m)];
            CHECK(std::abs(meeting.sA) <= a.half);
            CHECK((a.at(meeting.sA) - meeting.where).norm() < 1e-13);
            CHECK(witness::distance(meeting.where, b) < 1e-13);
        }
        crossed += n > 0 ? 1 : 0;
        // The refinement ends on a grid of 2 (2/160) (4/16)^5 < 3e-5 of the length.
        CHECK((n > 0) == (sampled < 1e-4));
        CHECK(witness::distance(a, b) == Approx(n > 0 ? 0.0 : sampled).margin(1e-4));
        CHECK(witness::distance(a, b) <= sampled + 1e-12); // sampling never finds anything nearer
        CHECK(witness::separation(a, b) <= sampled + 1e-12);
        CHECK(witness::distance(a, b) == Approx(witness::distance(b, a)).margin(1e-12));
    }
    CHECK(crossed > 50);
    CHECK(crossed < 350);
}

TEST_CASE("the distance of conformal arcs is the difference of their radii", "[crossing]") {
    const auto inner = witness::makePiece(Vec2(0.0, 0.0192), M_PI, 1.0 / 0.0192, 0.004);
    const auto outer = witness::makePiece(Vec2(0.0, 0.0197), M_PI, 1.0 / 0.0197, 0.004);
    CHECK(witness::distance(inner, outer) == Approx(0.0005).epsilon(1e-12));
}

TEST_CASE("crossing rods are found where they cross", "[crossing]") {
    const Curve a = uniform(Vec2(-0.02, 0.0), 0.0, 0.04, 0.0);
    const Curve b = uniform(Vec2(0.003, -0.02), 0.5 * M_PI, 0.04, 0.0, 7);
    const auto found = find({a, b});
    REQUIRE(found.size() == 1);
    CHECK(found[0].rodA == 0);
    CHECK(found[0].rodB == 1);
    CHECK(found[0].outline == -1);
    CHECK(found[0].sA == Approx(0.023).epsilon(1e-12));
    CHECK((found[0].where - Vec2(0.003, 0.0)).norm() < 1e-15);
    Curve ghost = b;
    ghost.mask = 0;
    CHECK(find({a, ghost}).empty());
}

TEST_CASE("a rod that crosses itself is found, one that only winds is not", "[crossing]") {
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

TEST_CASE("touching at the thickness is clean, nested shells are clean", "[crossing]") {
    const double r = 0.0192;
    std::vector<Curve> nest;
    for (int i = 0; i < 8; ++i) { // concentric domes one thickness apart, openings down
        const double radius = r + i * kThickness;
        const double opening = 0.75 * 2.0 * M_PI;
        const double first = 0.5 * M_PI - 0.5 * opening;
        nest.push_back(uniform(radius * Vec2(std::cos(first), std::sin(first)), first + 0.5 * M_PI, opening * radius,
                               1.0 / radius));
    }
    CHECK(find(nest).empty());
    CHECK(sweep(nest, nest).empty());
    std::vector<Curve> falling;
    for (const Curve& c : nest)
        falling.push_back(moved(c, Vec2(0.001, -0.01), 0.02));
    CHECK(sweep(nest, falling).empty()); // together, by twenty thicknesses
    std::vector<Curve> pressed = nest;   // one is pushed by 90 % of the gap
    pressed[3] = moved(pressed[3], Vec2(0.0, 0.9 * kThickness));
    CHECK(sweep(nest, pressed).empty());
    pressed[3] = moved(nest[3], Vec2(0.0, 1.1 * kThickness));
    CHECK_FALSE(sweep(nest, pressed).empty());

    const Curve flat = uniform(Vec2(-0.02, 0.0), 0.0, 0.04, 0.0);
    CHECK(find({flat, moved(flat, Vec2(0.0, kThickness))}).empty());
    CHECK(sweep({flat, moved(flat, Vec2(0.0, kThickness))}, {flat, moved(flat, Vec2(0.03, kThickness))}).empty());
}

TEST_CASE("what passes through within one step is seen", "[crossing]") {
    const Curve wall = uniform(Vec2(-0.02, 0.0), 0.0, 0.04, 0.0);
    SECTION("sideways, parallel: they meet at one instant only") {
        for (const double far : {0.0006, 0.003, 0.017, 0.1}) {
            const Curve above = moved(wall, Vec2(0.0, 0.0005));
            const auto found = sweep({wall, above}, {wall, moved(above, Vec2(0.0, -far))});
            REQUIRE(found.size() == 1);
            CHECK(found[0].rodA == 0);
            CHECK(found[0].rodB == 1);
            CHECK(find({wall, moved(above, Vec2(0.0, -far))}).empty()); // before and after are clean
        }
    }
    SECTION("a tip swings through") {
        const Curve rod = uniform(Vec2(0.0, 0.03), -0.7 * M_PI, 0.034, 0.0);
        const Curve swung = moved(rod, Vec2::Zero(), 0.4 * M_PI, Vec2(0.0, 0.03));
        CHECK(find({wall, rod}).empty());
        CHECK(find({wall, swung}).empty());
        CHECK(sweep({wall, rod}, {wall, swung}).size() == 1); // at the bottom its tip is 4 mm below the wall
        const Curve shorter = uniform(Vec2(0.0, 0.03), -0.7 * M_PI, 0.029, 0.0);
        CHECK(sweep({wall, shorter}, {wall, moved(shorter, Vec2::Zero(), 0.4 * M_PI, Vec2(0.0, 0.03))}).empty());
    }
    SECTION("a short rod flies through lengthwise") {
        const Curve dart = uniform(Vec2(0.001, 0.003), 0.5 * M_PI, 0.002, 0.0, 3);
        CHECK(sweep({wall, dart}, {wall, moved(dart, Vec2(0.0, -0.05))}).size() == 1);
        CHECK(sweep({wall, dart}, {wall, moved(dart, Vec2(0.5, 0.0))}).empty());
    }
    SECTION("both move, and only together do they pass") {
        const Curve above = moved(wall, Vec2(0.0, 0.001));
        CHECK(sweep({wall, above}, {moved(wall, Vec2(0.0, 0.0007)), moved(above, Vec2(0.0, -0.0007))}).size() == 1);
        CHECK(sweep({wall, above}, {moved(wall, Vec2(0.0, 0.0007)), moved(above, Vec2(0.0, 0.0007))}).empty());
    }
    SECTION("bending alone closes the way") {
        // Half circle whose curvature flips: it sweeps through a rod that lies across its chord's middle line.
        const Curve bow = uniform(Vec2(-0.01, 0.0), 0.5, 0.02, -50.0);
        const Curve flipped = uniform(Vec2(-0.01, 0.0), -0.5, 0.02, 50.0);
        const Curve between = uniform(Vec2(-0.002, 0.0), 0.0, 0.004, 0.0, 2);
        CHECK(find({bow, between}).empty());
        CHECK(find({flipped, between}).empty());
        CHECK(sweep({bow, between}, {flipped, between}).size() == 1);
    }
}

TEST_CASE("random fast motions agree with fine sampling of the way", "[crossing]") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    int met = 0;
    for (int i = 0; i < 200; ++i) {
        const Curve a =
            uniform(0.01 * Vec2(unit(random), unit(random)), M_PI * unit(random), 0.02, 60.0 * unit(random), 3);
        const Curve b =
            uniform(0.01 * Vec2(unit(random), unit(random)), M_PI * unit(random), 0.02, 60.0 * unit(random), 3);
        const Vec2 shift = 0.01 * Vec2(unit(random), unit(random));
        // Translation only: interpolation is then exact, and so must be the answer.
        bool sampled = false;
        const int n = 2000;
        for (int j = 0; j <= n && !sampled; ++j)
            sampled = !find({a, moved(b, shift * (static_cast<double>(j) / n))}).empty();
        const bool swept = !sweep({a, b}, {a, moved(b, shift)}).empty();
        INFO("motion " << i);
        // Samples 7 um apart can miss a graze, never the other way round but for the witness's own 0.5 um.
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
    const Curve rod = uniform(Vec2(-0.02, 0.001), 0.0, 0.04, 0.0);
    SECTION("two-sided segments") {
        CHECK(find({rod}, {segment({0.0, -0.01}, {0.0, 0.01})}).size() == 1);
        CHECK(find({rod}, {segment({-0.1, 0.0}, {0.1, 0.0})}).empty());
        const auto through = sweep({rod}, {moved(rod, Vec2(0.0, -0.01))}, {segment({-0.1, 0.0}, {0.1, 0.0})});
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
        CHECK(sweep({rod}, {rod}, {box}).empty());
        const auto wholly = find({moved(rod, Vec2(0.0, -0.01))}, {box});
        REQUIRE(wholly.size() == 1); // once, though every element lies inside
        CHECK(wholly[0].outline == 0);
        CHECK(find({moved(rod, Vec2(0.09, -0.01))}, {box}).size() == 1);       // half out
        CHECK(sweep({rod}, {moved(rod, Vec2(0.0, -0.1))}, {box}).size() == 1); // and out again on the far side
        Outline pin; // smaller than an element: no end or middle lies in it
        pin.kind = OutlineKind::Circle;
        pin.radius = 2e-4;
        pin.points = {{0.0009, 0.001}};
        CHECK(find({rod}, {pin}).size() == 1);
        pin.points = {{0.0009, 0.0013}};
        CHECK(find({rod}, {pin}).empty());
        CHECK(sweep({rod}, {moved(rod, Vec2(0.0, 0.01))}, {pin}).size() == 1);
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
        CHECK(find({moved(rod, Vec2(0.0, -0.01))}, {floor}).empty());       // lives in the cellar
        CHECK(sweep({rod}, {moved(rod, Vec2(0.0, -0.01))}, {floor}).size() == 1);
    }
}

TEST_CASE("the witness answers alike whatever the order of the rods", "[crossing]") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Curve> curves;
    for (int i = 0; i < 20; ++i)
        curves.push_back(
            uniform(0.03 * Vec2(unit(random), unit(random)), M_PI * unit(random), 0.04, 50.0 * unit(random)));
    const auto forward = find(curves);
    std::reverse(curves.begin(), curves.end());
    const auto backward = find(curves);
    CHECK(forward.size() > 10);
    CHECK(forward.size() == backward.size());
}
