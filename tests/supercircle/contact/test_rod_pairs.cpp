#include "shells.h"

#include "supercircle/contact/feature_id.h"

#include <catch2/catch.hpp>
#include <set>

using namespace contact_test;

namespace {

/// Tolerance of the smallest gap, m: minima shallower than 0.005 of the summed half thicknesses are left to the nodes,
/// and the nodes of both rods may lie half an element away.
constexpr double kShallow = 0.005 * 2.0 * kHalf;

std::vector<Candidate> detectFresh(const std::vector<RodCurve>& curves, double margin = 1e-4) {
    Detector detector;
    std::vector<Candidate> out;
    detector.detect(curves, {}, {margin}, out);
    return out;
}

double smallestGap(const std::vector<Candidate>& candidates, int rodA, int rodB) {
    double best = 1e300;
    for (const Candidate& c : candidates)
        if (std::min(c.a.rod, c.b.rod) == rodA && std::max(c.a.rod, c.b.rod) == rodB)
            best = std::min(best, c.gap);
    return best;
}

/// Tangent of a curve at a rod point.
Vec2 tangentAt(const RodCurve& curve, const RodPoint& p) {
    const auto e = static_cast<std::size_t>(p.element);
    return curve.arcs[e].tangentAt(p.s - curve.nodeS[e]);
}
Vec2 pointAt(const RodCurve& curve, const RodPoint& p) {
    const auto e = static_cast<std::size_t>(p.element);
    return curve.arcs[e].pointAt(p.s - curve.nodeS[e]);
}
bool isTip(const RodCurve& curve, const RodPoint& p) {
    return !curve.closed && (p.s == curve.nodeS.front() || p.s == curve.nodeS.back());
}

/// Invariants of every candidate between rods.
void checkFrames(const std::vector<RodCurve>& curves, const std::vector<Candidate>& candidates) {
    std::set<std::uint64_t> ids;
    for (const Candidate& c : candidates) {
        const RodCurve& a = curves[static_cast<std::size_t>(c.a.rod)];
        const RodCurve& b = curves[static_cast<std::size_t>(c.b.rod)];
        REQUIRE(ids.insert(c.id).second);
        REQUIRE(c.a.s >= a.nodeS[static_cast<std::size_t>(c.a.element)] - 1e-15);
        REQUIRE(c.a.s <= a.nodeS[static_cast<std::size_t>(c.a.element) + 1] + 1e-15);
        REQUIRE(std::abs(c.normal.norm() - 1.0) < 1e-12);
        const Vec2 pa = pointAt(a, c.a);
        const Vec2 pb = pointAt(b, c.b);
        // Arc lengths, points, normal and gap are consistent; 1e-13 m is a few hundred roundings of 0.1 m.
        REQUIRE((pa - a.halfThickness * c.normal - c.pointA).norm() < 1e-13);
        REQUIRE((pb + b.halfThickness * c.normal - c.pointB).norm() < 1e-13);
        REQUIRE(std::abs((c.pointA - c.pointB).dot(c.normal) - c.gap) < 1e-13);
        if (!isTip(b, c.b))
            REQUIRE(std::abs(c.normal.dot(tangentAt(b, c.b))) < 1e-10);
        const Feature kind = featureOf(c.id);
        if (kind == Feature::Interior)
            REQUIRE(std::abs(c.normal.dot(tangentAt(a, c.a))) < 1e-10);
        if (kind == Feature::TipTip)
            REQUIRE((isTip(a, c.a) && isTip(b, c.b)));
    }
}

bool cross(const Dense& a, const Dense& b, double clearance) {
    return denseDistance(a, b) < clearance;
}

} // namespace

TEST_CASE("the smallest gap of random shells equals the densely sampled distance", "[rod pairs]") {
    std::mt19937 rng(1);
    int tested = 0;
    int near = 0;
    while (tested < 60) {
        // Pushed together until they nearly touch: random pairs at rest are rarely within the margin.
        std::vector<RodCurve> curves{randomShell(3, rng, 0.0), randomShell(1, rng, 0.03)};
        const Dense a = sampleDensely(curves[0], 700);
        if (cross(a, sampleDensely(curves[1], 700), 3.0 * kHalf))
            continue;
        ++tested;
        const Vec2 direction = (curves[0].arcs[7].start - curves[1].arcs[7].start).normalized();
        for (int i = 0; i < 40; ++i) {
            const double d = denseDistance(sampleDensely(curves[1], 150), a);
            if (d < 2.0 * kHalf + 1.0e-4)
                break;
            move(curves[1], std::min(0.5 * (d - 2.0 * kHalf), 1e-3) * direction);
        }
        const double dense = denseDistance(sampleDensely(curves[1], 1500), sampleDensely(curves[0], 1500));
        const double gap = dense - 2.0 * kHalf;
        const auto found = detectFresh(curves, 3e-4);
        checkFrames(curves, found);
        if (gap > 3e-4) {
            // Nothing nearer than there is; sampling errs by spacing^2 k/8 = 3e-8 m and by 1e-7 m along the normal.
            CHECK(found.empty());
            continue;
        }
        ++near;
        const double smallest = smallestGap(found, 0, 1);
        CHECK(smallest > gap - 2e-7);
        CHECK(smallest < gap + kShallow + 2e-7);
    }
    CHECK(near > 20);
}

TEST_CASE("no well-conditioned local minimum is missed", "[rod pairs]") {
    std::mt19937 rng(7);
    const int n = 400;
    int minima = 0;
    for (int trial = 0; trial < 2000 && minima < 120; ++trial) {
        const std::vector<RodCurve> curves{randomShell(0, rng, 0.0), randomShell(1, rng, 0.035)};
        const Dense a = sampleDensely(curves[0], n);
        const Dense b = sampleDensely(curves[1], n);
        if (cross(a, b, 2.0 * kHalf))
            continue;
        const double range = 4e-3; // a wide margin finds the minima of random pairs
        const auto found = detectFresh(curves, range - 2.0 * kHalf);
        checkFrames(curves, found);
        const auto d = [&](int i, int j) {
            if (i < 0 || j < 0 || i > n || j > n)
                return 1e300;
            return (a.p[static_cast<std::size_t>(i)] - b.p[static_cast<std::size_t>(j)]).norm();
        };
        for (int i = 0; i <= n; ++i) {
            for (int j = 0; j <= n; ++j) {
                const double here = d(i, j);
                if (here > range - 2e-4)
                    continue;
                bool lowest = true;
                // A window wider than the ridge along the diagonal is needed to tell minima from grid noise.
                for (int u = -8; u <= 8 && lowest; ++u)
                    for (int v = -8; v <= 8 && lowest; ++v)
                        lowest = d(i + u, j + v) >= here;
                if (!lowest)
                    continue;
                ++minima;
                double best = 1e300;
                for (const Candidate& c : found) {
                    const bool straight = c.a.rod == 0;
                    const double sA = straight ? c.a.s : c.b.s;
                    const double sB = straight ? c.b.s : c.a.s;
                    // Within an element of it on both rods.
                    if (std::abs(sA - a.s[static_cast<std::size_t>(i)]) < 6.5e-3 &&
                        std::abs(sB - b.s[static_cast<std::size_t>(j)]) < 6.5e-3)
                        best = std::min(best, c.gap + 2.0 * kHalf);
                }
                // The grid overestimates by up to spacing^2/(8 d) = 8e-6 m at 1 mm, on a 0.2 mm grid.
                CHECK(best <= here + kShallow + 1e-7);
            }
        }
    }
    CHECK(minima >= 100);
}

TEST_CASE("two convex shells touch on the line of centres", "[rod pairs]") {
    // Closed form: distance of centres minus radii; the contact lies inside elements on both.
    const Vec2 centre(0.0386 * std::cos(0.3), 0.0386 * std::sin(0.3));
    std::vector<RodCurve> curves{makeShell(5, Vec2::Zero(), 0.0192, 4.5, 0.37),
                                 makeShell(2, centre, 0.0190, 4.2, 0.29 + kPi)};
    const auto found = detectFresh(curves);
    const double gap = 0.0386 - 0.0382 - 2.0 * kHalf;
    int interior = 0;
    for (const Candidate& c : found) {
        if (featureOf(c.id) != Feature::Interior)
            continue;
        ++interior;
        CHECK(c.a.rod == 1); // the smaller key is side A
        CHECK(c.gap == Approx(gap).margin(1e-15));
        CHECK((c.normal - Vec2(std::cos(0.3), std::sin(0.3))).norm() < 1e-12);
    }
    CHECK(interior == 1);
    CHECK(smallestGap(found, 0, 1) == Approx(gap).margin(1e-15));
    for (const double k : {0.0, 1e-13, -1e-9, 1e-5, -1e-3}) { // against straight and nearly straight strips
        const double r = 0.0192;
        RodCurve strip = makeCurve(1, Vec2(-0.0331, -r - 2.1 * kHalf), 0.0, std::vector<double>(11, k), 0.006);
        const auto hits = detectFresh({strip, makeShell(0, Vec2::Zero(), r, 3.0, -0.5 * kPi)});
        checkFrames({strip, makeShell(0, Vec2::Zero(), r, 3.0, -0.5 * kPi)}, hits);
        // The strip bends by k x^2/2 = 6e-7 m at most over its half length; for the closed form the tiny ones.
        CHECK(smallestGap(hits, 0, 1) == Approx(0.1 * kHalf).margin(1e-12 + std::abs(k) * 6e-4));
    }
}

TEST_CASE("nested shells have candidates along their whole contact, and the set is steady", "[rod pairs]") {
    for (const double offset : {0.0, 2e-6, 1e-5, 4e-5}) {
        const double outer = kRadius + 2.0 * kHalf + 2e-5;
        std::vector<RodCurve> curves{makeShell(0, Vec2(0.0, -offset), outer, 4.7, 0.5 * kPi),
                                     makeShell(1, Vec2::Zero(), kRadius, 4.5, 0.5 * kPi + 0.04)};
        // Off the exact symmetry, where the minimum falls on the mid-rod sample to round-off and is merged with it.
        move(curves[1], Vec2(6e-7, -2e-7), 2e-5);
        const auto found = detectFresh(curves, 2e-4);
        checkFrames(curves, found);
        // Along the inner rod, tips included, no two neighbouring candidates are further apart than an element.
        std::vector<double> s{0.0, curves[1].nodeS.back()};
        for (const Candidate& c : found)
            s.push_back(c.a.rod == 1 ? c.a.s : c.b.s);
        std::sort(s.begin(), s.end());
        for (std::size_t i = 1; i < s.size(); ++i)
            CHECK(s[i] - s[i - 1] <= curves[1].arcs[0].length * 1.001);
        CHECK(found.size() < 55); // 17 samples both ways and a few minima
        std::mt19937 rng(11);
        std::uniform_real_distribution<double> u(-1.0, 1.0);
        int changed = 0;
        int total = 0;
        for (int i = 0; i < 50; ++i) {
            auto moved = curves;
            move(moved[1], 1e-7 * Vec2(u(rng), u(rng)), 5e-6 * u(rng));
            const auto after = detectFresh(moved, 2e-4);
            std::set<std::uint64_t> ids;
            for (const Candidate& c : found)
                ids.insert(c.id);
            for (const Candidate& c : after)
                changed += ids.count(c.id) == 0 ? 1 : 0;
            total += static_cast<int>(after.size());
        }
        INFO("offset " << offset << ": " << changed << " of " << total);
        CHECK(changed * 50 < total); // less than 2 %
    }
}

TEST_CASE("ids stay the same while a rod slides from element to element", "[rod pairs]") {
    // The inner shell turns about its centre by three elements: every node keeps its id, joints neither double nor
    // drop.
    const double outer = kRadius + 2.0 * kHalf + 2e-5;
    const RodCurve still = makeShell(0, Vec2::Zero(), outer, 4.7, 0.5 * kPi);
    std::set<std::uint64_t> first;
    for (int i = 0; i <= 300; ++i) {
        const double turn = -0.4631 + 0.9257 * i / 300.0; // no node ever faces a node: those count once
        const auto found = detectFresh({still, makeShell(1, Vec2::Zero(), kRadius, 3.7, 0.5 * kPi + turn)});
        std::set<std::uint64_t> ids;
        for (const Candidate& c : found)
            if (c.a.rod == 1 && featureOf(c.id) == Feature::SampleRod)
                ids.insert(c.id);
        CHECK(ids.size() == 17);
        if (i == 0)
            first = ids;
        CHECK(ids == first);
    }
}

TEST_CASE("tips meet tips and nodes round their caps", "[rod pairs]") {
    const std::vector<double> straight(5, 0.0);
    // End to end, 0.1 mm apart: one candidate of the two tips, side A the smaller key.
    std::vector<RodCurve> curves{makeCurve(8, Vec2(0.0, 0.0), 0.0, straight, 0.006),
                                 makeCurve(4, Vec2(0.03 + 2.2 * kHalf, 0.0), 0.0, straight, 0.006)};
    auto found = detectFresh(curves);
    REQUIRE(found.size() == 1);
    CHECK(featureOf(found[0].id) == Feature::TipTip);
    CHECK(found[0].a.rod == 1);
    CHECK(found[0].gap == Approx(0.2 * kHalf).margin(1e-15));
    CHECK(found[0].normal.x() == Approx(1.0));
    CHECK(found[0].pointA.x() == Approx(0.03 + 1.2 * kHalf));
    // Diagonal: the round caps.
    curves[1] = makeCurve(4, Vec2(0.03 + 3e-4, 4e-4), 0.0, straight, 0.006);
    found = detectFresh(curves);
    REQUIRE(found.size() == 1);
    CHECK(found[0].gap == Approx(5e-4 - 2.0 * kHalf).margin(1e-15));
    CHECK((found[0].normal - Vec2(0.6, 0.8)).norm() < 1e-12);
    // A tip standing upright on the middle of an element: its projection only.
    curves[1] = makeCurve(4, Vec2(0.0137, 2.1 * kHalf), 0.5 * kPi, straight, 0.006);
    found = detectFresh(curves);
    REQUIRE(found.size() == 1);
    CHECK(found[0].a.rod == 1);
    CHECK(found[0].a.s == 0.0);
    CHECK(found[0].b.s == Approx(0.0137));
    CHECK(found[0].normal.y() == Approx(1.0));
}

TEST_CASE("filters, margins and motion decide what is reported", "[rod pairs]") {
    const std::vector<double> straight(5, 0.0);
    std::vector<RodCurve> curves{makeCurve(0, Vec2(0.0, 0.0), 0.0, straight, 0.006),
                                 makeCurve(1, Vec2(0.001, 2.0 * kHalf + 3e-4), 0.0, straight, 0.006)};
    CHECK(detectFresh(curves, 2.9e-4).empty());
    const auto all = detectFresh(curves, 3.1e-4);
    CHECK(all.size() == 12); // 6 nodes each way, minus the tips beyond the other rod, plus two mids
    for (const Candidate& c : all)
        CHECK(c.gap == Approx(3e-4).margin(1e-15));
    curves[0].motion = 1e-4;
    curves[1].motion = 1.2e-4;
    CHECK(detectFresh(curves, 1e-4).size() == 12);
    CHECK(detectFresh(curves, 0.7e-4).empty());
    curves[0].category = 2;
    curves[1].mask = 5;
    CHECK(detectFresh(curves, 1e-3).empty());
    curves[1].mask = 7;
    CHECK(!detectFresh(curves, 1e-3).empty());
    curves[0].mask = 2;
    CHECK(detectFresh(curves, 1e-3).empty());
}

TEST_CASE("a rod touches itself where it closes, and only there", "[self contact]") {
    SECTION("open shells and gentle waves never do") {
        for (const double opening : {1.0, 4.7, 6.0}) {
            CHECK(detectFresh({makeShell(0, Vec2::Zero(), kRadius, opening, 0.0)}, 1e-3).empty());
            CHECK(detectFresh({makeShell(0, Vec2::Zero(), kRadius, opening, 0.0, 200)}, 1e-3).empty());
        }
        std::vector<double> wave;
        for (int i = 0; i < 60; ++i)
            wave.push_back(300.0 * std::cos(0.4 * i));
        CHECK(detectFresh({makeCurve(0, Vec2::Zero(), 0.0, wave, 5e-4)}, 2e-4).empty());
    }
    SECTION("a shell that closes: tip to tip") {
        const double opening = 2.0 * kPi - 2.2 * kHalf / kRadius;
        const auto found = detectFresh({makeShell(0, Vec2::Zero(), kRadius, opening, 0.3)});
        REQUIRE(found.size() == 1);
        CHECK(featureOf(found[0].id) == Feature::TipTip);
        CHECK(found[0].gap == Approx(2.0 * kRadius * std::sin(1.1 * kHalf / kRadius) - 2.0 * kHalf).margin(1e-14));
        CHECK(found[0].a.s < found[0].b.s);
    }
    SECTION("a spiral touches the turn inside it") {
        for (const int elements : {12, 40, 150}) {
            std::vector<double> k;
            for (int i = 0; i < elements; ++i)
                k.push_back(1.0 / (0.010 + 0.0035 * i / elements));
            const double length = 0.15;
            const std::vector<RodCurve> curves{makeCurve(0, Vec2::Zero(), 0.0, k, length / elements)};
            const auto found = detectFresh(curves, 2e-3);
            REQUIRE(!found.empty());
            checkFrames(curves, found);
            // Reference: dense pairs more than half a turn apart.
            const Dense dense = sampleDensely(curves[0], 3000);
            double best = 1e300;
            for (std::size_t i = 0; i < dense.p.size(); ++i)
                for (std::size_t j = i + 600; j < dense.p.size(); ++j)
                    best = std::min(best, (dense.p[i] - dense.p[j]).norm());
            // Spacing 50 um at distances of a millimetre: h^2/(8 d) = 3e-7 m.
            CHECK(smallestGap(found, 0, 0) == Approx(best - 2.0 * kHalf).margin(5e-7 + kShallow));
            for (const Candidate& c : found)
                CHECK(std::abs(c.a.s - c.b.s) > 0.02);
        }
    }
    SECTION("a closed ring does not touch itself at the weld") {
        RodCurve ring = makeShell(0, Vec2::Zero(), kRadius, 2.0 * kPi, 0.3);
        ring.closed = true;
        CHECK(detectFresh({ring}, 1e-3).empty());
        // Seen from outside, no tips: a strip's node above the weld is projected once.
        const double first = 0.3 - kPi;
        const Vec2 out(std::cos(first), std::sin(first));
        for (const double x : {-1e-9, -1e-16, 0.0, 1e-16, 1e-9}) {
            const RodCurve post =
                makeCurve(1, (kRadius + 2.1 * kHalf) * out + x * supercircle::rod::perp(out), first, {0.0, 0.0}, 0.01);
            const auto found = detectFresh({ring, post});
            // The post's tip on the ring, the ring's node on the tip; one where they coincide.
            REQUIRE(found.size() == (std::abs(x) < 1e-12 ? 1 : 2));
        }
    }
    SECTION("the filter applies to a rod and itself") {
        RodCurve shell = makeShell(0, Vec2::Zero(), kRadius, 2.0 * kPi - 2.2 * kHalf / kRadius, 0.3);
        shell.mask = 2;
        CHECK(detectFresh({shell}).empty());
    }
}

TEST_CASE("a strip flattened to a hairpin touches itself", "[self contact]") {
    // 10 mm straight, a half turn of 0.3 mm radius, 10 mm back: walls 0.6 mm apart.
    std::vector<double> k(20, 0.0);
    const double element = kPi * 3e-4 / 2.0;
    k.insert(k.end(), 2, 1.0 / 3e-4);
    k.insert(k.end(), 20, 0.0);
    const std::vector<RodCurve> curves{makeCurve(0, Vec2::Zero(), 0.0, k, element)};
    const auto found = detectFresh(curves, 1.5e-4);
    checkFrames(curves, found);
    // Nodes face nodes: 20 pairs of nodes (tips included), less those within three thicknesses of arc length.
    CHECK(found.size() >= 18);
    CHECK(found.size() <= 22);
    for (const Candidate& c : found) {
        CHECK(c.gap == Approx(1e-4).margin(1e-12));
        CHECK(std::abs(c.b.s - c.a.s) > 3.0 * 2.0 * kHalf);
    }
}

TEST_CASE("elements that rotate by more than a quarter turn are divided, and no candidate is missed", "[rod pairs]") {
    // A ring of two elements, each turning by 170 degrees.
    const double r = 0.01;
    const RodCurve ring = makeShell(0, Vec2::Zero(), r, 340.0 / 180.0 * kPi, 0.5 * kPi, 2);
    for (int i = 0; i < 36; ++i) {
        const double angle = -0.5 * kPi + (20.0 + 320.0 * i / 35.0) / 180.0 * kPi;
        const Vec2 out(std::cos(angle), std::sin(angle));
        for (const double side : {-1.0, 1.0}) {
            const RodCurve post =
                makeCurve(1, (r + side * 2.1 * kHalf) * out, side > 0.0 ? angle : angle + kPi, {0.0}, 0.004);
            const auto found = detectFresh({ring, post});
            REQUIRE(!found.empty());
            CHECK(smallestGap(found, 0, 1) == Approx(0.1 * kHalf).margin(1e-14));
        }
    }
}
