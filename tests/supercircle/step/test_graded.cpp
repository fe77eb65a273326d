// Rods with elements of unequal length move, touch and keep their energy balance like any other.

#include "tests/supercircle/step/setup.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

rod::RodDefinition graded(rod::RodDefinition d, double tipRefinement) {
    d.elementLength = rod::gradedLengths(d.length, static_cast<int>(d.naturalCurvature.size()), tipRefinement);
    return d;
}

} // namespace

TEST_CASE("detection sees a graded rod where it is", "[step]") {
    for (const int elements : {15, 16}) {
        step::World w;
        put(w, graded(paperShell(0.75, elements), 3.0), {0.01, 0.02}, 0.4, 0.35);
        const step::Rod& r = w.rods[0];
        contact::RodCurve curve;
        step::toCurve(r, r.kin, curve);
        CHECK(curve.nodeS.front() == 0.0);
        for (std::size_t i = 0; i < curve.arcs.size(); ++i) {
            const contact::Arc& arc = curve.arcs[i];
            CHECK(curve.nodeS[i + 1] - curve.nodeS[i] == Approx(arc.length).epsilon(1e-12));
            // The natural shape is one circle whatever the lengths.
            const Vec2 middle = arc.pointAt(0.5 * arc.length);
            const Vec2 centreOfCircle = Vec2(0.01, 0.02) + kR * rod::perp(Vec2(std::cos(0.4), std::sin(0.4)));
            CHECK((middle - centreOfCircle).norm() == Approx(kR).epsilon(1e-12));
        }
    }
}

TEST_CASE("graded shells dropped on the floor never gain energy", "[step]") {
    for (const double refinement : {3.0, 0.4}) {
        INFO("refinement " << refinement);
        FakeHost host;
        host.g = {0.0, -kG};
        host.addGround(1, 0.35);
        step::World w;
        w.gravity = host.g;
        put(w, graded(paperShell(), refinement), {0.0, 0.06}, 0.6, 0.35, {0.2, 0.0}, 5.0);
        put(w, graded(paperShell(0.6, 16), refinement), {0.01, 0.12}, 2.5, 0.35);
        step::Stepper s({});
        double last = w.energyBalance.stored(), gain = 0.0;
        const double scale = w.rods[0].model.mass() * kG * 0.06;
        for (int i = 0; i < 125; ++i)
            frame(s, w, host, 4e-3, [&](const step::World& now) {
                gain = std::max(gain, now.energyBalance.stored() - last);
                last = now.energyBalance.stored();
                return false;
            });
        // The bounds of equal arcs (test_invariants.cpp).
        CAPTURE(gain / scale);
        CHECK(gain < 1e-4 * scale); // two shells
        CHECK(std::abs(w.energyBalance.residual()) < 1e-9 * scale);
        CHECK(w.energyBalance.friction >= 0.0);
        CHECK(w.counters.penetrationMax < 0.04 * 5e-4);
        CHECK(w.counters.unconverged == 0);
    }
}

TEST_CASE("free graded shells and rings keep their momentum when they collide", "[step]") {
    step::World w;
    put(w, graded(paperShell(), 3.0), {0.0, 0.0}, 0.0, 0.35, {0.3, 0.1});
    put(w, graded(ring(0.015, 1.0, 16), 3.0), {0.06, 0.005}, 1.0, 0.35, {-0.2, 0.0}, 2.0);
    const Vec2 before = momentum(w);
    step::Stepper s({});
    double touched = 0.0;
    for (int i = 0; i < 100; ++i) {
        REQUIRE(s.advance(w, 4e-3, nullptr, {}).failure.empty());
        for (const step::ContactImpulse& c : w.impulses)
            touched = std::max(touched, c.normal);
    }
    CHECK(touched > 0.0);
    CHECK((momentum(w) - before).norm() < 1e-9 * before.norm()); // contact forces cancel to round-off
    const step::Rod& closed = w.rods[1];
    CHECK((closed.kin.node(16) - closed.kin.node(0)).norm() < 1e-6 * closed.model.definition().length);
}
