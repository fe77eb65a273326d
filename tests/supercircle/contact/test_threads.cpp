// Chunks of pairs on several threads: the same candidates and crossings, in the same order, as one after the other.

#include "shells.h"

#include "supercircle/contact/crossing.h"
#include "tests/support/loops.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <stdexcept>

using namespace contact_test;
using namespace supercircle;

namespace {

bool same(const std::vector<Candidate>& a, const std::vector<Candidate>& b) {
    return a.size() == b.size() &&
           std::equal(a.begin(), a.end(), b.begin(), [](const Candidate& x, const Candidate& y) {
               return x.id == y.id && x.gap == y.gap && x.normal == y.normal && x.pointA == y.pointA &&
                      x.pointB == y.pointB && x.a.s == y.a.s && x.b.s == y.b.s && x.a.rod == y.a.rod &&
                      x.b.rod == y.b.rod && x.outline == y.outline;
           });
}

bool same(const std::vector<Crossing>& a, const std::vector<Crossing>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Crossing& x, const Crossing& y) {
               return x.rodA == y.rodA && x.rodB == y.rodB && x.outline == y.outline && x.sA == y.sA &&
                      x.where == y.where;
           });
}

std::vector<Outline> floorOnly() {
    std::vector<Outline> out(1);
    out[0].kind = OutlineKind::OneSided;
    out[0].points = {Vec2(-1.0, -0.25), Vec2(1.0, -0.25)};
    return out;
}

} // namespace

TEST_CASE("detection and crossing check find the same on any number of threads", "[threads]") {
    std::mt19937 rng(5);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    std::vector<RodCurve> curves;
    for (std::uint32_t i = 0; i < 200; ++i)
        curves.push_back(randomShell((i * 7) % 200, rng, 0.25));
    const std::vector<Outline> outlines = floorOnly();
    const std::vector<parallel::For> loops = {{}, test::backwards(), test::threads(2), test::threads(3)};
    std::vector<Detector> detectors(loops.size());
    std::size_t found = 0, crossed = 0;
    for (int step = 0; step < 12; ++step) {
        const std::vector<RodCurve> before = curves;
        for (RodCurve& curve : curves) {
            curve.motion = 1e-4;
            curve.resting = step % 4 == 3 && u(rng) > 0.0;
            if (!curve.resting)
                move(curve, 1e-4 * Vec2(u(rng), u(rng)), 1e-3 * u(rng));
        }
        std::vector<Candidate> first;
        std::vector<Crossing> firstCrossings;
        for (std::size_t k = 0; k < loops.size(); ++k) {
            std::vector<Candidate> candidates;
            detectors[k].detect(curves, outlines, {1e-4}, candidates, loops[k]);
            std::vector<Crossing> crossings;
            findCrossingsSwept(before, curves, outlines, outlines, crossings, loops[k]);
            if (k == 0) {
                first = candidates;
                firstCrossings = crossings;
            }
            CAPTURE(step, k);
            CHECK(same(candidates, first));
            CHECK(same(crossings, firstCrossings));
        }
        found += first.size();
        crossed += firstCrossings.size();
    }
    CHECK(found > 1000);
    CHECK(crossed > 1000); // random shells lie across each other
}

TEST_CASE("of several invalid rods the first is named on any number of threads", "[threads]") {
    std::mt19937 rng(6);
    std::vector<RodCurve> curves;
    for (std::uint32_t i = 0; i < 100; ++i)
        curves.push_back(randomShell(i, rng, 0.5));
    curves[70].nodeS.clear();
    curves[41].nodeS.clear();
    const auto message = [&](const parallel::For& loop) {
        std::vector<Candidate> out;
        try {
            Detector().detect(curves, {}, {1e-4}, out, loop);
        } catch (const std::invalid_argument& e) {
            return std::string(e.what());
        }
        return std::string("nothing");
    };
    CHECK(message({}).find("key 41") != std::string::npos);
    for (const parallel::For& loop : {test::backwards(), test::threads(3)})
        CHECK(message(loop) == message({}));
}
