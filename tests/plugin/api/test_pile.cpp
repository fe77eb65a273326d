// Shells at the scale of a game: R = 1 m, frames of 1/60 s, all else by default.

#include "tests/plugin/api/support.h"

#include <cstdio>
#include <ctime>
#include <random>

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// A shell as a game would have it: R = 1 m, R/20 thick, one metre wide, as heavy as wood, stiff enough not to sag.
ShellDef gameShell(double x, double y, double angle) {
    ShellDef d;
    d.radius = 1.0;
    d.thickness = 0.05;
    d.width = 1.0;
    d.density = 500.0;
    d.young_modulus = 2e8;
    d.phi_bar = 0.6;
    d.mu = 0.5;
    d.position = {x, y};
    d.angle = angle;
    return d;
}

/// A box of 10 m x 20 m, open at its top.
std::shared_ptr<FakeHost> box() {
    auto host = groundHost(0.5);
    host->add(2, "left", {-5.5, 10.0}).outlines.push_back(FakeHost::box(2, 0.5, 10.0, 0.5));
    host->add(3, "right", {5.5, 10.0}).outlines.push_back(FakeHost::box(3, 0.5, 10.0, 0.5));
    return host;
}

/// Layers of three, turned at random (the same every time).
void drop(Shells& shells, int count) {
    std::minstd_rand random(7);
    for (int i = 0; i < count; ++i) {
        const double turn = 2.0 * M_PI * static_cast<double>(random() % 1000) / 1000.0;
        const double x = 3.2 * (i % 3 - 1), y = 2.0 + 2.3 * (i / 3);
        // `position` is the middle of the arc, its centre a radius to the left of the tangent
        REQUIRE(shells.create(gameShell(x + std::sin(turn), y - std::cos(turn), turn)));
    }
}

double lengthError(const Shells& shells) {
    double worst = 0.0;
    for (const step::Rod& r : shells.world().rods) {
        double length = 0.0;
        for (int i = 0; i < r.model.elements(); ++i) { // from chord and turn of each arc
            const rod::Arc& a = r.kin.arcs()[static_cast<std::size_t>(i)];
            const double half = 0.5 * a.curvature * a.length;
            const double chord = (r.kin.node(i + 1) - r.kin.node(i)).norm();
            length += std::abs(half) > 1e-6 ? chord * half / std::sin(half) : chord;
        }
        worst = std::max(worst, std::abs(length / r.model.definition().length - 1.0));
    }
    return worst;
}

} // namespace

namespace {

void fall(int count, double seconds, double stillMoves) {
    auto host = box();
    Shells shells(host);
    drop(shells, count);
    const double weight = count * 500.0 * 0.05 * 2.0 * M_PI * 0.6 * kG, scale = weight * 10.0; // N, and J of what falls
    double last = shells.energy_balance().added, grown = 0.0, length = 0.0;
    const std::clock_t start = std::clock();
    const int frames = static_cast<int>(60.0 * seconds);
    for (int i = 0; i < frames; ++i) {
        advance(shells, host.get(), 1.0 / 60.0, 1);
        const EnergyBalance b = shells.energy_balance();
        const double energy = b.kinetic + b.bending + b.gravity;
        grown = std::max(grown, energy - last);
        last = energy;
        length = std::max(length, lengthError(shells));
    }
    const double used = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    const step::Counters& c = shells.world().counters;
    const EnergyBalance b = shells.energy_balance();
    std::printf("game scene: %.3f s of processor time a simulated second, %llu steps, %llu rejected, %llu unconverged, "
                "penetration %.4f h, kinetic %.2e of %.0f J, energy grew by at most %.2e J a frame\n",
                used / seconds, static_cast<unsigned long long>(c.steps), static_cast<unsigned long long>(c.rejected),
                static_cast<unsigned long long>(c.unconverged), c.penetrationMax / 0.05, b.kinetic, scale, grown);
    // Energy never grows, not from one frame to the next, but for the accuracy of the gaps: h / 1000 under the weight
    // of the pile, which is a 200 000th of what there is.
    CHECK(grown < weight * 1e-3 * 0.05);
    CHECK(length < 1e-6);
    CHECK(c.penetrationMax < 0.05 * 0.05);
    CHECK(b.kinetic < stillMoves * scale);
    CHECK(b.work == 0.0); // walls do no work
    CHECK(std::abs(b.residual) < 1e-9 * scale);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
        CHECK(std::abs(centreOf(shells, i).x()) < 5.0); // all in the box
}

} // namespace

TEST_CASE("eighteen shells of a game fall into a box", "[plugin]") {
    fall(18, 2.5, 0.05);
}

TEST_CASE("thirty shells of a game come to rest in a box", "[plugin][slow]") {
    fall(30, 20.0, 1e-4); // nothing but friction damps: the pile rocks on at some cm/s
}
