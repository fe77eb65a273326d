#include "supercircle/contact/seams.h"

#include "shells.h"

#include <catch2/catch.hpp>

using namespace contact_test;

namespace {

constexpr double kThickShell = 0.02;             ///< m
constexpr double kTolerance = 0.1 * kThickShell; ///< m
constexpr double kFrame = 1.0 / 60.0;            ///< s

SeamPiece pieceOf(OutlineKind kind, std::initializer_list<Vec2> points, std::uint64_t body, std::uint32_t key = 0) {
    SeamPiece p;
    p.outline.kind = kind;
    p.outline.points = points;
    p.body = body;
    p.key = key;
    p.thickness = kThickShell;
    return p;
}

SeamPiece boxOf(double x0, double y0, double x1, double y1, std::uint64_t body) {
    return pieceOf(OutlineKind::Polygon, {Vec2(x0, y0), Vec2(x1, y0), Vec2(x1, y1), Vec2(x0, y1)}, body);
}

std::vector<Joined> joined(const std::vector<SeamPiece>& pieces) {
    SeamJoiner joiner;
    return joiner.join(pieces, kFrame);
}

bool same(const std::vector<Joined>& a, const std::vector<Joined>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Joined& x, const Joined& y) {
        return x.seams == y.seams && x.moved == y.moved && x.points == y.points;
    });
}

VertexRole roleOf(const Joined& j, std::size_t vertex) {
    return j.seams.vertices.empty() ? VertexRole::Alone : j.seams.vertices[vertex].role;
}

bool hides(const Joined& j, int face, double x) {
    return std::any_of(j.seams.hidden.begin(), j.seams.hidden.end(),
                       [&](const HiddenSpan& s) { return s.face == face && x > s.from && x < s.to; });
}

} // namespace

TEST_CASE("an outline that touches none stays as it is", "[contact][seams]") {
    for (const Joined& j : joined({boxOf(0, 0, 1, 1, 1), boxOf(1 + 1.2 * kTolerance, 0, 2, 1, 2)})) {
        CHECK(j.seams.empty());
        CHECK_FALSE(j.moved);
    }
}

TEST_CASE("boxes with equal tops have no corners and no sides between them", "[contact][seams]") {
    const std::vector<Joined> j = joined({boxOf(0, 0, 1, 1, 1), boxOf(1, 0, 2, 1, 2)});
    CHECK(roleOf(j[0], 2) == VertexRole::Hidden);
    CHECK(roleOf(j[0], 1) == VertexRole::Hidden);
    CHECK(roleOf(j[1], 3) == VertexRole::Hidden);
    CHECK(roleOf(j[0], 3) == VertexRole::Alone);
    CHECK(roleOf(j[1], 2) == VertexRole::Alone);
    CHECK(hides(j[0], 1, 0.5));
    CHECK(hides(j[1], 3, 0.5));
    CHECK_FALSE(hides(j[0], 2, 0.5));
    CHECK_FALSE(j[0].moved);
}

TEST_CASE("a small step becomes a slope, a large one stays", "[contact][seams]") {
    const std::vector<Joined> low = joined({boxOf(0, 0, 1, 1, 1), boxOf(1, 0, 2, 1 + kTolerance, 2)});
    CHECK(low[0].points[2].y() == Approx(1.0 + 0.5 * kTolerance));
    CHECK(low[1].points[3].y() == Approx(1.0 + 0.5 * kTolerance));
    CHECK(low[1].points[2].y() == 1.0 + kTolerance);
    const std::vector<Joined> high = joined({boxOf(0, 0, 1, 1, 1), boxOf(1, 0, 2, 1 + kThickShell, 2)});
    CHECK_FALSE(high[0].moved);
    CHECK_FALSE(high[1].moved);
    CHECK(roleOf(high[0], 2) == VertexRole::Alone); // in the valley at the foot of the step
    CHECK(roleOf(high[1], 3) == VertexRole::Alone);
    CHECK_FALSE(hides(high[1], 3, 0.5 * kThickShell));
    CHECK(hides(high[1], 3, 0.5));
}

TEST_CASE("a vertex on a face and a vertex inside are no corners", "[contact][seams]") {
    const std::vector<Joined> stack = joined({boxOf(0, 0, 4, 1, 1), boxOf(1, 1, 2, 2, 2)});
    CHECK(roleOf(stack[1], 0) == VertexRole::Alone); // in a valley
    CHECK(roleOf(stack[1], 2) == VertexRole::Alone);
    CHECK(hides(stack[0], 2, 2.5));
    CHECK_FALSE(hides(stack[0], 2, 1.5));
    const std::vector<Joined> sunk = joined({boxOf(0, 0, 4, 1, 1), boxOf(1, 0.5, 2, 2, 2)});
    CHECK(roleOf(sunk[1], 0) == VertexRole::Hidden);
    CHECK(hides(sunk[1], 3, 1.2));
    CHECK_FALSE(hides(sunk[1], 3, 0.8));
}

TEST_CASE("a convex joint answers once, between the two faces", "[contact][seams]") {
    const Vec2 a(0, 0), b(1, 0), c(2, -0.2);
    const std::vector<Joined> j =
        joined({pieceOf(OutlineKind::Segment, {a, b}, 1), pieceOf(OutlineKind::Segment, {b, c}, 2)});
    REQUIRE(roleOf(j[0], 1) == VertexRole::Cone);
    CHECK(roleOf(j[1], 0) == VertexRole::Hidden);
    CHECK(roleOf(j[0], 0) == VertexRole::Alone);
    const VertexSeam& cone = j[0].seams.vertices[1];
    const auto answers = [&](double angle) {
        const Vec2 w(std::sin(angle), std::cos(angle));
        return w.dot(cone.c1) >= 0.0 && w.dot(cone.c2) >= 0.0;
    };
    CHECK(answers(0.1));
    CHECK_FALSE(answers(-0.01));
    CHECK_FALSE(answers(0.21));
}

TEST_CASE("outlines that move against each other or are filtered differently are not joined", "[contact][seams]") {
    std::vector<SeamPiece> pieces{boxOf(0, 0, 1, 1, 1), boxOf(1, 0, 2, 1, 2)};
    pieces[1].velocity = Vec2(2.0 * kTolerance / kFrame, 0.0);
    CHECK(joined(pieces)[0].seams.empty());
    pieces[1].velocity = Vec2(0.5 * kTolerance / kFrame, 0.0);
    CHECK_FALSE(joined(pieces)[0].seams.empty());
    pieces[0].velocity = pieces[1].velocity = Vec2(100.0, 0.0);
    CHECK_FALSE(joined(pieces)[0].seams.empty());
    pieces[1].outline.category = 2;
    CHECK(joined(pieces)[0].seams.empty());
}

TEST_CASE("joining again near what has changed gives what joining all anew gives", "[contact][seams]") {
    std::vector<SeamPiece> pieces;
    for (int i = 0; i < 40; ++i)
        pieces.push_back(boxOf(0.5 * i - 0.1, 0, 0.5 * i + 0.5, 1 + 0.0015 * (i % 3), static_cast<std::uint64_t>(i)));
    SeamJoiner joiner;
    REQUIRE(same(joiner.join(pieces, kFrame), joined(pieces)));
    for (SeamPiece& p : pieces)
        p.changed = false;
    CHECK(same(joiner.join(pieces, kFrame), joined(pieces)));
    for (const int moved : {20, 5, 39}) {
        SeamPiece& p = pieces[static_cast<std::size_t>(moved)];
        for (Vec2& v : p.outline.points)
            v.y() += 0.001;
        p.changed = true;
        std::vector<SeamPiece> all = pieces;
        for (SeamPiece& a : all)
            a.changed = true;
        CHECK(same(joiner.join(pieces, kFrame), joined(all)));
        p.changed = false;
    }
    pieces.erase(pieces.begin() + 10, pieces.begin() + 12);
    CHECK(same(joiner.join(pieces, kFrame), joined(pieces)));
}
