#include "shells.h"

#include "supercircle/contact/feature_id.h"

#include <catch2/catch.hpp>

using namespace contact_test;

namespace {

std::vector<Candidate> detectFresh(const RodCurve& curve, const std::vector<Outline>& outlines, double margin = 1e-4) {
    Detector detector;
    std::vector<Candidate> out;
    detector.detect({curve}, outlines, {margin}, out);
    const auto own = [](const Candidate& c) { return c.b.rod >= 0; }; // a random shell may touch itself
    out.erase(std::remove_if(out.begin(), out.end(), own), out.end());
    for (const Candidate& c : out) {
        REQUIRE(c.a.rod == 0);
        REQUIRE(c.outline >= 0);
        REQUIRE(std::abs(c.normal.norm() - 1.0) < 1e-12);
        const auto e = static_cast<std::size_t>(c.a.element);
        const Vec2 p = curve.arcs[e].pointAt(c.a.s - curve.nodeS[e]);
        REQUIRE((p - curve.halfThickness * c.normal - c.pointA).norm() < 1e-13);
        REQUIRE(std::abs((c.pointA - c.pointB).dot(c.normal) - c.gap) < 1e-13);
        const bool middle = std::abs(c.a.s - 0.5 * (curve.nodeS[e] + curve.nodeS[e + 1])) < 1e-12;
        if ((featureOf(c.id) == Feature::InteriorOutline && !middle) || featureOf(c.id) == Feature::CornerRod)
            REQUIRE(std::abs(c.normal.dot(curve.arcs[e].tangentAt(c.a.s - curve.nodeS[e]))) < 1e-10);
    }
    return out;
}

const Candidate* lowest(const std::vector<Candidate>& found) {
    const Candidate* best = nullptr;
    for (const Candidate& c : found)
        if (best == nullptr || c.gap < best->gap)
            best = &c;
    return best;
}

int count(const std::vector<Candidate>& found, Feature kind) {
    return static_cast<int>(
        std::count_if(found.begin(), found.end(), [kind](const Candidate& c) { return featureOf(c.id) == kind; }));
}

Outline makeEdge(OutlineKind kind, const Vec2& p, const Vec2& q, std::uint32_t key = 0) {
    Outline edge;
    edge.kind = kind;
    edge.key = key;
    edge.points = {p, q};
    return edge;
}

Outline makeBox(const Vec2& low, const Vec2& high) {
    Outline box;
    box.kind = OutlineKind::Polygon;
    box.points = {low, Vec2(high.x(), low.y()), high, Vec2(low.x(), high.y())};
    return box;
}

Outline makeDisc(const Vec2& centre, double radius) {
    Outline disc;
    disc.kind = OutlineKind::Circle;
    disc.points = {centre};
    disc.radius = radius;
    return disc;
}

/// A horizontal strip of five elements of 6 mm with its left tip at p.
constexpr std::size_t kAlong =
    11; ///< six nodes of a strip that lies along a face, and the middles of its five elements

RodCurve makeStrip(const Vec2& p, double angle = 0.0, std::uint32_t key = 0) {
    return makeCurve(key, p, angle, std::vector<double>(5, 0.0), 0.006);
}

/// Chain edges through the given points, joined.
std::vector<Outline> makeChain(const std::vector<Vec2>& v) {
    std::vector<Outline> chain;
    for (std::size_t i = 0; i + 1 < v.size(); ++i) {
        Outline edge = makeEdge(OutlineKind::OneSided, v[i], v[i + 1], static_cast<std::uint32_t>(i));
        edge.joinedStart = i > 0;
        edge.joinedEnd = i + 2 < v.size();
        if (edge.joinedStart)
            edge.neighbourStart = v[i - 1];
        if (edge.joinedEnd)
            edge.neighbourEnd = v[i + 2];
        chain.push_back(edge);
    }
    return chain;
}

} // namespace

TEST_CASE("a shell on a floor touches at its lowest point", "[outlines]") {
    // The lowest point of a circle: inside an element, gap = height of the centre - radius - half thickness.
    const double gap = 2e-5;
    const Vec2 centre(0.003, kRadius + kHalf + gap);
    const RodCurve shell = makeShell(0, centre, kRadius, 4.4, -0.5 * kPi + 0.07);
    for (const double skin : {0.0, 1e-3}) {
        for (int kind = 0; kind < 4; ++kind) {
            Outline floor = makeEdge(OutlineKind::Segment, Vec2(0.2, -skin), Vec2(-0.2, -skin));
            if (kind == 1)
                std::swap(floor.points[0], floor.points[1]);
            if (kind == 2)
                floor.kind = OutlineKind::OneSided; // solid on the right of right-to-left: above
            if (kind == 2)
                std::swap(floor.points[0], floor.points[1]);
            if (kind == 3)
                floor = makeBox(Vec2(-0.2, -0.3), Vec2(0.2, -skin));
            floor.radius = skin;
            INFO("kind " << kind << ", skin " << skin);
            const auto found = detectFresh(shell, {floor});
            REQUIRE(count(found, Feature::InteriorOutline) == 1);
            const Candidate* c = lowest(found);
            CHECK(featureOf(c->id) == Feature::InteriorOutline);
            CHECK(c->gap == Approx(gap).margin(1e-14));
            CHECK((c->normal - Vec2(0.0, 1.0)).norm() < 1e-12);
            CHECK((c->pointB - Vec2(0.003, 0.0)).norm() < 1e-12);
            CHECK((c->pointA - Vec2(0.003, gap)).norm() < 1e-12);
        }
    }
}

TEST_CASE("a segment is touched from both sides and round its ends", "[outlines]") {
    const Outline wall = makeEdge(OutlineKind::Segment, Vec2(0.0, 0.0), Vec2(0.02, 0.0));
    for (const double side : {-1.0, 1.0}) {
        const auto found = detectFresh(makeStrip(Vec2(-0.004, side * 1.2 * kHalf)), {wall});
        // Nodes at 0.002, 0.008, 0.014, 0.020 (the end itself) and the mid at 0.011; both corners.
        CHECK(count(found, Feature::CornerRod) + count(found, Feature::SampleOutline) >= 6);
        for (const Candidate& c : found) {
            CHECK(c.gap == Approx(0.2 * kHalf).margin(1e-14));
            CHECK(c.normal.y() == Approx(side));
        }
    }
    // A strip standing above the end: its tip against the corner, diagonal.
    const auto found = detectFresh(makeStrip(Vec2(0.02 + 2.1e-4, 2.8e-4), 0.9), {wall}, 2e-4);
    REQUIRE(lowest(found) != nullptr);
    CHECK(lowest(found)->gap == Approx(3.5e-4 - kHalf).margin(1e-14));
    CHECK((lowest(found)->normal - Vec2(0.6, 0.8)).norm() < 1e-12);
    // Perpendicular post beside the end: the corner projected on the rod, inside an element.
    const auto post = detectFresh(makeStrip(Vec2(0.02 + 1.1 * kHalf, -0.0142), 0.5 * kPi), {wall});
    REQUIRE(post.size() == 1);
    CHECK(featureOf(post[0].id) == Feature::CornerRod);
    CHECK(post[0].gap == Approx(0.1 * kHalf).margin(1e-14));
    CHECK(post[0].normal.x() == Approx(1.0));
    CHECK(post[0].a.s == Approx(0.0142));
}

TEST_CASE("a chain edge has one side, and penetration a sign", "[outlines]") {
    const Outline edge = makeEdge(OutlineKind::OneSided, Vec2(-0.1, 0.0), Vec2(0.1, 0.0)); // left is up
    for (const double y : {2e-4, 1e-5, 0.0, -1e-4, -4.9e-4}) {
        const auto found = detectFresh(makeStrip(Vec2(0.0, y)), {edge});
        REQUIRE(found.size() == kAlong);
        for (const Candidate& c : found) {
            CHECK(c.gap == Approx(y - kHalf).margin(1e-14));
            CHECK((c.normal - Vec2(0.0, 1.0)).norm() < 1e-14);
        }
    }
    CHECK(detectFresh(makeStrip(Vec2(0.0, -5.1e-4)), {edge}).empty()); // more than a thickness behind: not reported
    // The lowest point of a shell that has sunk in keeps its sign too.
    const RodCurve shell = makeShell(0, Vec2(0.003, kRadius - 1e-4), kRadius, 4.4, -0.5 * kPi + 0.07);
    const auto found = detectFresh(shell, {edge});
    CHECK(lowest(found)->gap == Approx(-1e-4 - kHalf).margin(1e-14));
    CHECK(lowest(found)->normal.y() == Approx(1.0));
}

TEST_CASE("chains: joined corners give one contact, convex ones round, concave ones from both faces", "[outlines]") {
    // Solid on the right: a clockwise path round a solid block has convex corners.
    const auto block = makeChain({Vec2(-0.05, 0.0), Vec2(0.0, 0.0), Vec2(0.0, -0.05)}); // top, then right side
    SECTION("a tip diagonally off the corner") {
        const auto found = detectFresh(makeStrip(Vec2(2.1e-4, 2.8e-4), 0.9), block, 2e-4);
        REQUIRE(!found.empty());
        CHECK(count(found, Feature::SampleOutline) == 1);
        CHECK(lowest(found)->gap == Approx(3.5e-4 - kHalf).margin(1e-14));
        CHECK((lowest(found)->normal - Vec2(0.6, 0.8)).norm() < 1e-12);
    }
    SECTION("a strip across the corner: the corner on the strip") {
        const Vec2 n = Vec2(1.0, 1.0).normalized();
        const Vec2 t(n.y(), -n.x());
        for (const double d : {1.1 * kHalf, 0.5 * kHalf, -0.5 * kHalf}) { // outside, overlapping, centre line inside
            const auto found = detectFresh(makeStrip(d * n - 0.0137 * t, -0.25 * kPi), block);
            REQUIRE(count(found, Feature::CornerRod) == 1);
            for (const Candidate& c : found) {
                if (featureOf(c.id) != Feature::CornerRod)
                    continue;
                CHECK(c.gap == Approx(d - kHalf).margin(1e-14));
                CHECK((c.normal - n).norm() < 1e-12);
                CHECK(c.a.s == Approx(0.0137));
            }
        }
    }
    SECTION("inside near the corner only the nearer face answers") {
        const auto found = detectFresh(makeStrip(Vec2(-3e-4, -1e-4), 0.9), block);
        int tips = 0;
        for (const Candidate& c : found) {
            if (featureOf(c.id) != Feature::SampleOutline || c.a.s != 0.0)
                continue;
            ++tips;
            CHECK(c.normal.y() == Approx(1.0));
            CHECK(c.gap == Approx(-1e-4 - kHalf).margin(1e-14));
        }
        CHECK(tips == 1);
    }
    SECTION("a node sliding over a joint of a straight chain is answered exactly once") {
        const auto flat = makeChain({Vec2(-0.1, 0.0), Vec2(0.0, 0.0), Vec2(0.1, 0.0)});
        for (const double x : {-1e-4, -1e-12, 0.0, 1e-12, 1e-4}) {
            const auto found = detectFresh(makeStrip(Vec2(x - 0.006, 1.1 * kHalf)), flat);
            CHECK(found.size() >= kAlong);
            CHECK(found.size() <= kAlong + 1); // exactly at the joint both faces may answer
            for (const Candidate& c : found)
                CHECK(c.gap == Approx(0.1 * kHalf).margin(1e-14));
        }
    }
    SECTION("a concave corner holds a tip by both faces") {
        const auto groove = makeChain({Vec2(-0.05, 0.05), Vec2(0.0, 0.0), Vec2(0.05, 0.05)});
        const auto found = detectFresh(makeStrip(Vec2(0.0, 1.1 * kHalf * std::sqrt(2.0)), 0.5 * kPi), groove);
        int tips = 0;
        for (const Candidate& c : found) {
            if (c.a.s != 0.0)
                continue;
            ++tips;
            CHECK(c.gap == Approx(0.1 * kHalf).margin(1e-14));
            CHECK(std::abs(c.normal.x()) == Approx(std::sqrt(0.5)));
        }
        CHECK(tips == 2);
        // Sunk into the wedge behind the corner, which neither face covers: still pushed out.
        const auto sunk = detectFresh(makeStrip(Vec2(0.0, -1e-4), 0.5 * kPi), groove);
        REQUIRE(lowest(sunk) != nullptr);
        CHECK(lowest(sunk)->gap == Approx(-1e-4 - kHalf).margin(1e-14));
        CHECK(lowest(sunk)->normal.y() == Approx(1.0));
    }
}

TEST_CASE("discs: line of centres, tips, and a shell that hugs the disc", "[outlines]") {
    SECTION("outside, and inside a wide shell") {
        for (const double side : {-1.0, 1.0}) {
            const double radius = 0.004;
            const double d = kRadius + side * (kHalf + radius + 3e-5);
            const Vec2 direction(std::cos(0.21), std::sin(0.21));
            const auto found =
                detectFresh(makeShell(0, Vec2::Zero(), kRadius, 4.4, 0.2), {makeDisc(d * direction, radius)});
            REQUIRE(count(found, Feature::InteriorOutline) == 1);
            CHECK(lowest(found)->gap == Approx(3e-5).margin(1e-14));
            CHECK((lowest(found)->normal + side * direction).norm() < 1e-11);
        }
    }
    SECTION("conformal: every sample and every middle, no arbitrary minimum") {
        const RodCurve shell = makeShell(0, Vec2::Zero(), kRadius, 4.71, 0.5 * kPi);
        const auto found = detectFresh(shell, {makeDisc(Vec2(1e-7, 2e-7), kRadius - kHalf)});
        CHECK(count(found, Feature::SampleOutline) == 17);
        CHECK(count(found, Feature::InteriorOutline) == 14); // of 15 elements; one middle is the sample there
        for (const Candidate& c : found) {
            CHECK(std::abs(c.gap) < 3e-7);
            const auto e = static_cast<std::size_t>(c.a.element);
            if (featureOf(c.id) == Feature::InteriorOutline) // at a material place, wherever the disc is by 0.1 um
                CHECK(c.a.s == Approx(0.5 * (shell.nodeS[e] + shell.nodeS[e + 1])).epsilon(1e-12));
        }
    }
    SECTION("a tip") {
        const auto found = detectFresh(makeStrip(Vec2(0.01 + 1.1 * kHalf, 0.0)), {makeDisc(Vec2::Zero(), 0.01)});
        REQUIRE(found.size() == 1);
        CHECK(found[0].gap == Approx(0.1 * kHalf).margin(1e-14));
        CHECK(found[0].normal.x() == Approx(1.0));
    }
}

TEST_CASE("polygons: faces, corners, skin and the inside", "[outlines]") {
    Outline box = makeBox(Vec2(-0.01, -0.01), Vec2(0.01, 0.01));
    SECTION("against a dense sampling from all sides") {
        box.radius = 2e-4;
        std::mt19937 rng(3);
        std::uniform_real_distribution<double> u(-1.0, 1.0);
        int near = 0;
        for (int trial = 0; trial < 3000 && near < 120; ++trial) {
            const RodCurve shell = randomShell(0, rng, 0.05);
            const Dense dense = sampleDensely(shell, 1000);
            double gap = 1e300;
            bool inside = false;
            for (const Vec2& p : dense.p) {
                const Vec2 q = (p.cwiseAbs() - Vec2(0.01, 0.01)).cwiseMax(0.0);
                inside = inside || q.isZero();
                gap = std::min(gap, q.norm() - kHalf - box.radius);
            }
            if (inside || gap > 2e-3 || gap < -2e-4)
                continue;
            ++near;
            const auto found = detectFresh(shell, {box}, 2.1e-3);
            REQUIRE(lowest(found) != nullptr);
            // Spacing 0.09 mm: error h^2 k/8 = 5e-8 m, or h^2/(8 d) = 5e-6 m near a corner at distance 0.2 mm.
            CHECK(lowest(found)->gap < gap + 0.005 * kHalf + 1e-7);
            CHECK(lowest(found)->gap > gap - 6e-6);
        }
        CHECK(near >= 100);
    }
    SECTION("inside, the least deep face answers") {
        const auto found = detectFresh(makeStrip(Vec2(0.0097, 0.004), 0.0), {box});
        bool seen = false;
        for (const Candidate& c : found) {
            if (c.a.s != 0.0)
                continue;
            seen = true;
            CHECK(c.normal.x() == Approx(1.0));
            CHECK(c.gap == Approx(-3e-4 - kHalf).margin(1e-14));
        }
        CHECK(seen);
    }
    SECTION("a flat strip overhanging a corner keeps the corner while it rocks") {
        for (const double tilt : {-1e-3, -1e-9, 0.0, 1e-9, 1e-3}) {
            RodCurve strip = makeStrip(Vec2::Zero());
            move(strip, Vec2(-0.017, 0.0));
            move(strip, Vec2(0.01, 0.01 + 1.1 * kHalf), tilt);
            const auto found = detectFresh(strip, {box});
            CHECK(count(found, Feature::CornerRod) >= 1);
        }
    }
}

TEST_CASE("filters, margins and motion hold for outlines", "[outlines]") {
    Outline wall = makeEdge(OutlineKind::Segment, Vec2(-0.1, 0.0), Vec2(0.1, 0.0));
    RodCurve strip = makeStrip(Vec2(0.0, kHalf + 3e-4));
    CHECK(detectFresh(strip, {wall}, 2.9e-4).empty());
    CHECK(detectFresh(strip, {wall}, 3.1e-4).size() == kAlong);
    strip.motion = 1e-4;
    wall.motion = 1.5e-4;
    CHECK(detectFresh(strip, {wall}, 1e-4).size() == kAlong);
    wall.category = 4;
    strip.mask = 3;
    CHECK(detectFresh(strip, {wall}, 1e-3).empty());
    strip.mask = 4;
    CHECK(detectFresh(strip, {wall}, 1e-3).size() == kAlong);
    wall.mask = 2;
    CHECK(detectFresh(strip, {wall}, 1e-3).empty());
}
