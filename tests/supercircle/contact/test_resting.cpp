#include "shells.h"

#include "supercircle/contact/crossing.h"
#include "supercircle/contact/crossing/swept_motion.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <tuple>

using namespace contact_test;

namespace {

std::vector<Outline> floorAndPeg() {
    std::vector<Outline> out(2);
    out[0].key = 0;
    out[0].kind = OutlineKind::OneSided;
    out[0].points = {Vec2(-0.1, -0.04), Vec2(0.1, -0.04)};
    out[1].key = 1;
    out[1].kind = OutlineKind::Circle;
    out[1].points = {Vec2(0.01, 0.0)};
    out[1].radius = 0.01;
    return out;
}

/// An element that turns by a full circle lies on itself; the crossing check reports that of resting rods, too.
bool overturned(const RodCurve& curve) {
    return std::any_of(curve.arcs.begin(), curve.arcs.end(),
                       [](const Arc& arc) { return std::abs(arc.curvature) * arc.length >= 2.0 * M_PI; });
}

/// What detection should report: all candidates but those between two resting sides.
std::vector<Candidate> withoutResting(const std::vector<Candidate>& all, const std::vector<RodCurve>& curves) {
    std::vector<Candidate> out;
    for (const Candidate& c : all) {
        const bool a = curves[static_cast<std::size_t>(c.a.rod)].resting;
        const bool b = c.b.rod < 0 || curves[static_cast<std::size_t>(c.b.rod)].resting;
        if (!(a && b))
            out.push_back(c);
    }
    return out;
}

} // namespace

TEST_CASE("resting rods make candidates with moving rods only, and wake up as if they had never slept", "[resting]") {
    std::mt19937 rng(11);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    std::vector<RodCurve> curves;
    for (std::uint32_t i = 0; i < 14; ++i)
        curves.push_back(randomShell((i * 5) % 14, rng, 0.04));
    std::vector<Outline> outlines = floorAndPeg();
    Detector used;
    std::vector<Candidate> now, all;
    std::size_t left = 0;
    std::size_t found = 0;
    for (int step = 0; step < 120; ++step) {
        for (std::size_t i = 0; i < curves.size(); ++i) {
            RodCurve& curve = curves[i];
            if (step % 10 == 0)
                curve.resting = u(rng) > 0.0;
            curve.motion = curve.resting ? 0.0 : 2e-4;
            if (!curve.resting)
                move(curve, 2e-4 * Vec2(u(rng), u(rng)), 4e-3 * u(rng));
        }
        outlines[1].points[0].x() += 1e-5;
        used.detect(curves, outlines, {}, now);
        std::vector<RodCurve> awake = curves;
        for (RodCurve& curve : awake)
            curve.resting = false;
        Detector fresh;
        fresh.detect(awake, outlines, {}, all);
        INFO("step " << step);
        const std::vector<Candidate> expected = withoutResting(all, curves);
        REQUIRE(identical(now, expected));
        left += all.size() - now.size();
        found += now.size();
    }
    CHECK(left > 1000); // the case tests something
    CHECK(found > 1000);
}

TEST_CASE("the swept crossing check treats every pair as if it were alone", "[resting]") {
    std::mt19937 rng(23);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    using Name = std::tuple<std::int32_t, std::int32_t, std::int32_t>;
    std::size_t crossings = 0;
    std::size_t asleep = 0;
    for (int round = 0; round < 60; ++round) {
        std::vector<RodCurve> before, after;
        for (std::uint32_t i = 0; i < 8; ++i) {
            // From a few long arcs (divided by the crossing check) to many short ones.
            before.push_back(randomShell(i, rng, 0.04, 1 + static_cast<int>(7.0 * (1.0 + u(rng)))));
            before.back().resting = u(rng) > 0.3;
            after.push_back(before.back());
            if (!before.back().resting || u(rng) > 0.8) // some that are marked as resting move
                move(after.back(), 0.01 * Vec2(u(rng), u(rng)), 0.2 * u(rng));
        }
        std::vector<Outline> from = floorAndPeg();
        std::vector<Outline> to = from;
        to[1].points[0] += Vec2(1e-3, 0.0);
        std::vector<Crossing> out;
        findCrossingsSwept(before, after, from, to, out);
        std::set<Name> together, alone;
        for (const Crossing& c : out)
            together.insert({c.rodA, c.rodB, c.outline});
        for (std::size_t i = 0; i < before.size(); ++i) {
            const auto rest = [&](std::size_t r) {
                return before[r].resting && before[r].arcs[0].start == after[r].arcs[0].start;
            };
            for (std::size_t j = i; j < before.size(); ++j) {
                // No rod rests in a pair alone; pairs of two resting rods are not tested.
                std::vector<RodCurve> b{before[i], before[j]}, a{after[i], after[j]};
                b[0].resting = b[1].resting = false;
                if (i == j) {
                    b.pop_back();
                    a.pop_back();
                }
                findCrossingsSwept(b, a, {}, {}, out);
                for (const Crossing& c : out) {
                    if ((i == j) != (c.rodA == c.rodB))
                        continue; // a rod with itself has its own turn
                    if (rest(i) && rest(j) && !(i == j && overturned(after[i])))
                        ++asleep;
                    else
                        alone.insert({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), -1});
                }
            }
            for (std::size_t o = 0; o < from.size(); ++o) {
                std::vector<RodCurve> b{before[i]};
                b[0].resting = false;
                findCrossingsSwept(b, {after[i]}, {from[o]}, {to[o]}, out);
                for (const Crossing& c : out)
                    if (c.outline >= 0 && !(rest(i) && o == 0)) // the floor does not move
                        alone.insert({static_cast<std::int32_t>(i), -1, static_cast<std::int32_t>(o)});
            }
        }
        INFO("round " << round);
        CHECK(together == alone);
        crossings += together.size();
    }
    CHECK(crossings > 300);
    CHECK(asleep > 20); // the case tests something
}

TEST_CASE("the boxes of the crossing check contain every point of an element during its motion", "[resting]") {
    std::mt19937 rng(31);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    crossing_check::SweptMotion motion;
    crossing_check::MovingArcs arcs;
    for (int round = 0; round < 300; ++round) {
        const double size = std::pow(10.0, -3.0 + 3.0 * u(rng)); // from micrometres to metres
        std::vector<RodCurve> before, after;
        for (std::uint32_t i = 0; i < 3; ++i) {
            RodCurve from = randomShell(i, rng, 0.1, 1 + static_cast<int>(7.0 * (1.0 + u(rng))));
            if (i == 2)
                for (Arc& arc : from.arcs)
                    arc.curvature *= 1e-6; // nearly straight
            std::vector<double> k;
            for (const Arc& arc : from.arcs)
                k.push_back(arc.curvature + 10.0 * size * u(rng) / kRadius);
            const Arc first = from.arcs.front();
            from = makeCurve(i, first.start, first.angle, k, first.length);
            for (double& x : k)
                x += 10.0 * size * u(rng) / kRadius;
            RodCurve to = makeCurve(i, first.start, first.angle, k, first.length);
            move(to, size * Vec2(u(rng), u(rng)), 3.0 * std::min(size, 1.0) * u(rng));
            before.push_back(from);
            after.push_back(to);
        }
        motion.prepare(before, after, {}, {}, {});
        arcs.begin(motion);
        for (std::size_t r = 0; r < before.size(); ++r)
            for (std::size_t e = 0; e < before[r].arcs.size(); ++e) {
                const std::size_t box = motion.rods[r].first + e;
                const crossing_check::MovingArcs::ArcRange range = arcs.arcsOf(r, e);
                double out = -1.0; // how far a point is outside
                for (std::size_t i = range.first; i < range.first + range.count; ++i)
                    for (int a = 0; a <= 10; ++a) {
                        const crossing_check::CircularArc arc = arcs.completed(i).at(0.1 * a);
                        for (int b = -4; b <= 4; ++b) {
                            const Vec2 p = arc.at(0.25 * b * arc.half);
                            out = std::max({out, motion.boxes.lowX[box] - p.x(), p.x() - motion.boxes.highX[box],
                                            motion.boxes.lowY[box] - p.y(), p.y() - motion.boxes.highY[box]});
                        }
                    }
                INFO("round " << round << ", rod " << r << ", element " << e);
                CHECK(out <= 0.0);
            }
    }
}
