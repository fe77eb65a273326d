// Vibration: how damping and steps that change act on it, and a strip that is let go.

#include "tests/supercircle/step/vibrating.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Damping ratio that the loss of energy shows.
double ratioSeen(Vibrating& v, const step::Settings& settings) {
    constexpr double kPeriods = 5.0;
    return -std::log(watch(v, 8.0, kPeriods, settings).energy) / (4.0 * M_PI * kPeriods);
}

/// int_0^x sin(pi y^2 / 2) dy.
double fresnel(double x) {
    double sum = 0.0;
    const int steps = 4000; // Simpson: 1e-10
    const auto f = [](double y) { return std::sin(0.5 * M_PI * y * y); };
    const double h = x / steps;
    for (int i = 0; i < steps; ++i)
        sum += h / 6.0 * (f(i * h) + 4.0 * f((i + 0.5) * h) + f((i + 1.0) * h));
    return sum;
}

} // namespace

TEST_CASE("games damp the first mode by a twentieth and the laboratory by nothing, unless told", "[step][vibration]") {
    Vibrating game = vibrating(vibratingBeam(), true, 0), laboratory = vibrating(vibratingBeam(), true, 0);
    bendTo(game, 0.005);
    bendTo(laboratory, 0.005);
    CHECK(ratioSeen(game, step::gameSettings()) == Approx(0.05).epsilon(0.1));
    CHECK(ratioSeen(laboratory, step::Settings{}) < 1e-4); // 1 % of the energy in ten periods is 8e-5
}

TEST_CASE("the damping ratio of a mode grows with its frequency", "[step][vibration]") {
    // Kelvin-Voigt: zeta_n = zeta_1 omega_n / omega_1; 6.27 for the second mode of a clamped strip.
    const double first = vibrating(vibratingBeam(), true, 0).frequency;
    for (const bool game : {false, true}) {
        Vibrating v = vibrating(vibratingBeam(), true, 1);
        v.rod().dampingRatio = 0.01;
        bendTo(v, 0.001);
        CAPTURE(game);
        CHECK(v.frequency / first == Approx(6.267).epsilon(0.01));
        CHECK(ratioSeen(v, undampedSettings(game)) == Approx(0.01 * v.frequency / first).epsilon(game ? 0.1 : 0.02));
    }
}

TEST_CASE("frames that jump by sixteen keep the energy of a vibration", "[step][vibration]") {
    for (const bool game : {false, true}) {
        Vibrating v = vibrating(vibratingBeam(), true, 0);
        bendTo(v, 0.005);
        step::Stepper stepper(undampedSettings(game));
        const double period = 2.0 * M_PI / v.frequency, before = v.energy();
        double most = 0.0;
        for (int i = 0; v.world.time < 10.0 * period; ++i) {
            REQUIRE(stepper.advance(v.world, period / (i % 2 == 0 ? 6.0 : 96.0), nullptr, {}).failure.empty());
            most = std::max(most, v.energy());
        }
        CAPTURE(game);
        CHECK(v.energy() > (game ? 0.9 : 0.99) * before);
        CHECK(most < before * (1.0 + 1e-9));
    }
}

TEST_CASE("a bent strip that is let go bends further by 1.43", "[step][vibration]") {
    // Audoly and Neukirch, Fragmentation of rods by cascading cracks, Phys. Rev. Lett. 95, 095505 (2005): a strip of
    // uniform curvature k0 whose end is let go has k = 2 k0 S(s / sqrt(2 pi c t)), with the Fresnel integral S and
    // c = sqrt(B / lambda); its greatest curvature is 1.428 k0, at s = 2 sqrt(pi c t) from the free end.
    constexpr int kArcs = 120;
    constexpr double kLength = 0.6, kBent = 0.05; // m, 1/m
    for (const bool game : {false, true}) {
        step::World w;
        put(w, vibratingBeam(kArcs), Vec2::Zero(), 0.0, 0.3);
        step::Rod& r = w.rods[0];
        r.q.head(kArcs).setConstant(kBent);
        step::refreshRod(r);
        const rod::MaterialPoint root = rod::locate(r.model, 0, 0.0);
        step::Hold hold;
        hold.s = 0.0;
        hold.target.point = r.kin.point(root);
        hold.target.angle = r.kin.angle(root);
        r.holds.push_back(hold);
        const double c = std::sqrt(r.model.definition().bendingModulus / r.model.definition().linearMass);
        step::Stepper stepper(undampedSettings(game));
        for (const double part : {0.1, 0.12}) { // of the length, where the greatest curvature is
            const double time = part * part * kLength * kLength / (4.0 * M_PI * c);
            REQUIRE(stepper.advance(w, time - w.time, nullptr, {}).failure.empty());
            double most = 0.0, off = 0.0;
            for (int i = 0; i < kArcs; ++i) {
                const double s = kLength * (kArcs - i - 0.5) / kArcs, x = s / std::sqrt(2.0 * M_PI * c * w.time);
                most = std::max(most, r.q[i] / kBent);
                if (x > 0.5 && x < 2.0) // waves of an arc's length are back from the clamp, and ripple at the tip
                    off = std::max(off, std::abs(r.q[i] / kBent - 2.0 * fresnel(x)));
            }
            CAPTURE(game, part, most, off);
            CHECK(most == Approx(1.428).epsilon(0.01)); // 10 to 15 arcs from the end, and a hundredth of the clamp's
            CHECK(off < (game ? 0.15 : 0.04));          // 8 and 12 arcs long is the greatest wave
        }
    }
}
