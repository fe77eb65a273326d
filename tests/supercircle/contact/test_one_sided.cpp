#include "supercircle/contact/one_sided.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::contact;

namespace {

Outline edge(const Vec2& a, const Vec2& b) {
    Outline o;
    o.kind = OutlineKind::OneSided;
    o.points = {a, b};
    return o;
}

} // namespace

TEST_CASE("the front of a one-sided edge is its left, round a ridge to its neighbour's left", "[contact][one_sided]") {
    const Outline alone = edge({-1.0, 0.0}, {1.0, 0.0});
    CHECK(isInFront({0.3, 0.1}, alone));
    CHECK(isInFront({0.3, 0.0}, alone));
    CHECK_FALSE(isInFront({0.3, -0.1}, alone));
    CHECK_FALSE(isInFront({1.3, -0.1}, alone));
    for (const bool ridge : {true, false}) { // of 90 degrees, or a valley of them, at x = 1
        Outline joined = alone;
        joined.joinedEnd = true;
        joined.neighbourEnd = {1.0, ridge ? -1.0 : 1.0};
        CHECK(isInFront({1.3, -0.1}, joined) == ridge); // beside the neighbour
        CHECK_FALSE(isInFront({0.9, -0.3}, joined));    // nearer to the neighbour, behind both
        CHECK_FALSE(isInFront({0.3, -0.1}, joined));
        CHECK(isInFront({0.9, 0.05}, joined));
        Outline mirrored = edge({-1.0, 0.0}, {1.0, 0.0});
        mirrored.joinedStart = true;
        mirrored.neighbourStart = {-1.0, ridge ? -1.0 : 1.0};
        CHECK(isInFront({-1.3, -0.1}, mirrored) == ridge);
        CHECK_FALSE(isInFront({-0.9, -0.3}, mirrored));
    }
    Outline bent = alone; // a ridge of 10 degrees: below both lines, beyond the end
    bent.joinedEnd = true;
    bent.neighbourEnd = {1.0 + std::cos(0.17), -std::sin(0.17)};
    CHECK(isInFront({1.3, -0.01}, bent));
    CHECK_FALSE(isInFront({1.3, -0.1}, bent));
}

TEST_CASE("an arc that bends round the end of an edge does not cross it", "[contact][one_sided]") {
    RodCurve dome; // half a circle of radius 1 above the origin, in one arc
    dome.arcs = {{Vec2(1.0, 0.0), 0.5 * M_PI, 1.0, M_PI}};
    dome.nodeS = {0.0, M_PI};
    for (const double gap : {0.2, 1e-3, -1e-3}) { // its chords would cross all of them
        const Outline post = edge({0.0, -1.0}, {0.0, 1.0 - gap});
        CHECK(reaches(dome, post, 0.0) == (gap < 0.0));
        CHECK(reaches(dome, post, 1.01 * std::abs(gap)));
        CHECK(reaches(dome, post, 0.99 * std::abs(gap)) == (gap < 0.0));
    }
    CHECK_FALSE(reaches(dome, edge({-2.0, 1.1}, {2.0, 1.1}), 0.09));
    CHECK(reaches(dome, edge({-2.0, 1.1}, {2.0, 1.1}), 0.11));
}
