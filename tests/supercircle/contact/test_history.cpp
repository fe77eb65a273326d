#include "shells.h"

#include <catch2/catch.hpp>
#include <map>

using namespace contact_test;

namespace {

std::vector<Outline> makeWalls() {
    std::vector<Outline> walls(4);
    for (std::uint32_t i = 0; i < walls.size(); ++i)
        walls[i].key = 10 + i;
    walls[0].points = {Vec2(-0.06, -0.06), Vec2(0.06, -0.06)};
    walls[1].kind = OutlineKind::Circle;
    walls[1].points = {Vec2(0.02, 0.01)};
    walls[1].radius = 0.006;
    walls[2].kind = OutlineKind::Polygon;
    walls[2].points = {Vec2(-0.04, 0.0), Vec2(-0.02, 0.0), Vec2(-0.02, 0.02), Vec2(-0.04, 0.02)};
    walls[2].radius = 1e-4;
    walls[3].kind = OutlineKind::OneSided;
    walls[3].points = {Vec2(0.05, 0.05), Vec2(0.05, -0.06)};
    return walls;
}

} // namespace

TEST_CASE("a used detector finds bit for bit what a fresh one finds", "[history]") {
    std::mt19937 rng(5);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    std::vector<RodCurve> curves;
    for (std::uint32_t i = 0; i < 12; ++i)
        curves.push_back(randomShell((i * 7) % 12, rng, 0.05));
    auto walls = makeWalls();
    Detector used;
    std::vector<Candidate> now;
    std::vector<Candidate> reference;
    std::size_t total = 0;
    for (int step = 0; step < 300; ++step) {
        const double size = step % 50 < 25 ? 2e-6 : 3e-4; // calm and wild times
        for (RodCurve& curve : curves) {
            move(curve, size * Vec2(u(rng), u(rng)), size * 20.0 * u(rng));
            curve.motion = size;
            if (step % 40 == 7) { // shapes change as well
                std::vector<double> k;
                for (const Arc& arc : curve.arcs)
                    k.push_back(arc.curvature * (1.0 + 0.01 * u(rng)));
                RodCurve bent = makeCurve(curve.key, curve.arcs[0].start, curve.arcs[0].angle, k, curve.arcs[0].length);
                bent.motion = curve.motion;
                curve = bent;
            }
        }
        for (Vec2& p : walls[2].points)
            p += Vec2(1e-5, 2e-6);
        if (step == 100)
            curves.erase(curves.begin() + 3);
        if (step == 120)
            std::swap(curves[2], curves[5]);
        if (step == 140)
            curves[4].mask = 0;
        if (step == 160)
            curves[4].mask = 0xffffffffu;
        if (step == 180)
            curves.push_back(randomShell(77, rng, 0.05));
        if (step == 200)
            walls.erase(walls.begin());
        const DetectionOptions options{step < 220 ? 1e-4 : 3e-4};
        used.detect(curves, walls, options, now);
        Detector fresh;
        fresh.detect(curves, walls, options, reference);
        REQUIRE(identical(now, reference));
        total += now.size();
    }
    CHECK(total > 3000);
}

TEST_CASE("the order of the rods given does not matter", "[history]") {
    std::vector<RodCurve> curves = makePile(12);
    std::vector<RodCurve> reversed(curves.rbegin(), curves.rend());
    std::vector<Candidate> a;
    std::vector<Candidate> b;
    Detector detector;
    detector.detect(curves, makeWalls(), {}, a);
    detector.detect(reversed, makeWalls(), {}, b);
    REQUIRE(!a.empty());
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        b[i].a.rod = 11 - b[i].a.rod;
        if (b[i].b.rod >= 0)
            b[i].b.rod = 11 - b[i].b.rod;
        CHECK(identical(a[i], b[i]));
    }
}

TEST_CASE("updating a candidate at rest changes no bit", "[update]") {
    std::mt19937 rng(9);
    std::vector<RodCurve> curves;
    for (std::uint32_t i = 0; i < 14; ++i)
        curves.push_back(randomShell(i, rng, 0.05));
    curves.push_back(makeShell(20, Vec2(0.2, 0.0), kRadius, 2.0 * kPi - 2.2 * kHalf / kRadius, 0.3));
    const auto pile = makePile(8);
    for (RodCurve shell : pile) {
        shell.key += 100;
        move(shell, Vec2(0.5, 0.0));
        curves.push_back(shell);
    }
    const auto walls = makeWalls();
    Detector detector;
    std::vector<Candidate> found;
    detector.detect(curves, walls, {4e-4}, found);
    REQUIRE(found.size() > 150);
    for (const Candidate& c : found) {
        Candidate again = c;
        REQUIRE(updateCandidate(again, curves, walls));
        REQUIRE(identical(again, c));
    }
}

TEST_CASE("updated candidates follow the motion as a new detection does", "[update]") {
    std::mt19937 rng(10);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    int compared = 0;
    for (int trial = 0; trial < 40; ++trial) {
        std::vector<RodCurve> curves;
        for (std::uint32_t i = 0; i < 8; ++i)
            curves.push_back(randomShell(i, rng, 0.04));
        auto walls = makeWalls();
        Detector detector;
        std::vector<Candidate> before;
        std::vector<Candidate> after;
        detector.detect(curves, walls, {4e-4}, before);
        for (RodCurve& curve : curves)
            move(curve, 2e-5 * Vec2(u(rng), u(rng)), 1e-3 * u(rng));
        detector.detect(curves, walls, {4e-4}, after);
        std::map<std::uint64_t, Candidate> byId;
        for (const Candidate& c : after)
            byId[c.id] = c;
        for (Candidate c : before) {
            const auto it = byId.find(c.id);
            if (!updateCandidate(c, curves, walls) || it == byId.end())
                continue;
            // Same feature, possibly another of several minima (rank) or a face changed: nearly all are identical.
            if (c.a.element != it->second.a.element || std::abs(c.b.s - it->second.b.s) > 1e-3)
                continue;
            CHECK(identical(c, it->second));
            ++compared;
        }
    }
    CHECK(compared > 800);
}

TEST_CASE("an updated sample keeps its side through a crossing", "[update]") {
    const std::vector<double> straight(3, 0.0);
    std::vector<RodCurve> curves{makeCurve(0, Vec2::Zero(), 0.0, straight, 0.006),
                                 makeCurve(1, Vec2(0.001, 1e-4), 0.0, straight, 0.006)};
    Detector detector;
    std::vector<Candidate> found;
    detector.detect(curves, {}, {}, found);
    REQUIRE(!found.empty());
    move(curves[1], Vec2(0.0, -3e-4));
    int samples = 0;
    for (Candidate c : found) {
        if (std::abs(c.normal.x()) > 1e-6)
            continue; // round caps turn
        const double side = c.normal.y();
        REQUIRE(updateCandidate(c, curves, {}));
        if (std::abs(c.normal.x()) > 1e-6)
            continue;
        CHECK(c.normal.y() == Approx(side));
        CHECK(c.gap == Approx(-2e-4 - 2.0 * kHalf).margin(1e-15));
        ++samples;
    }
    CHECK(samples >= 5);
}

TEST_CASE("malformed rods and outlines are named", "[contact input]") {
    std::vector<RodCurve> curves = makePile(9);
    std::vector<Candidate> out;
    Detector detector;
    SECTION("equal keys") {
        curves[1].key = curves[0].key;
        CHECK_THROWS_WITH(detector.detect(curves, {}, {}, out), Catch::Contains("have key 0"));
    }
    SECTION("large key") {
        curves[1].key = 1U << 20U;
        CHECK_THROWS_WITH(detector.detect(curves, {}, {}, out), Catch::Contains("2^20"));
    }
    SECTION("not a number") {
        curves[1].arcs[2].start.x() = std::nan("");
        CHECK_THROWS_WITH(detector.detect(curves, {}, {}, out), Catch::Contains("key 1: arc 2 is not finite"));
        curves = makePile(9);
        CHECK_NOTHROW(detector.detect(curves, {}, {}, out)); // and the detector remains usable
        CHECK(!out.empty());
    }
    SECTION("clockwise polygon") {
        Outline polygon;
        polygon.kind = OutlineKind::Polygon;
        polygon.key = 4;
        polygon.points = {Vec2(0.0, 0.0), Vec2(0.0, 1.0), Vec2(1.0, 0.0)};
        CHECK_THROWS_WITH(detector.detect(curves, {polygon}, {}, out), Catch::Contains("key 4"));
    }
}
