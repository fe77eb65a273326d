// Vibration: frequencies, energy kept and energy taken, against closed forms.

#include "tests/supercircle/step/vibrating.h"

#include <array>
#include <cstdio>
#include <utility>

using namespace supercircle;
using namespace supercircle::test;

TEST_CASE("a clamped strip in its first mode keeps energy and frequency for ten periods", "[step][vibration]") {
    for (const bool game : {false, true})
        for (const double frames : {6.0, 7.3, 12.0, 24.0})
            for (const double amplitude : {1e-5, 1e-3, 0.03}) { // m, of 0.6: below 3 % the strip is linear to 0.02 %
                Vibrating v = vibrating(vibratingBeam(), true, 0);
                bendTo(v, amplitude);
                INFO("game " << game << ", frames a period " << frames << ", amplitude " << amplitude);
                const Seen seen = watch(v, frames, 10.0, undampedSettings(game));
                CHECK(seen.energy > (game ? 0.9 : 0.99));
                CHECK(seen.energy < 1.0 + 1e-9);
                CHECK(seen.tip > (game ? 0.9 : 0.99));
                CHECK(seen.frequency == Approx(v.frequency).epsilon(game ? 0.02 : 0.002));
            }
}

TEST_CASE("a clamped strip let go from a load at its tip keeps its energy for ten periods", "[step][vibration]") {
    for (const bool game : {false, true})
        for (const double frames : {6.0, 7.3, 12.0, 24.0}) {
            Vibrating v = vibrating(vibratingBeam(), true, 0, true);
            bendTo(v, 0.01);
            INFO("game " << game << ", frames a period " << frames);
            const Seen seen = watch(v, frames, 10.0, undampedSettings(game));
            CHECK(seen.energy > (game ? 0.9 : 0.98)); // 2.9 % of it is in higher modes at first
            CHECK(seen.frequency == Approx(v.frequency).epsilon(game ? 0.02 : 0.002));
        }
}

TEST_CASE("modes that no step resolves lose a third of their energy a step", "[step][vibration]") {
    // A given step is taken as it is, so none of these modes is resolved; the scheme is L-stable.
    for (const bool game : {false, true})
        for (const int mode : {0, 2, 6})
            for (const double turn : {4.0, 8.0, 100.0}) { // omega dt
                Vibrating v = vibrating(vibratingBeam(), true, mode);
                bendTo(v, 1e-5);
                step::Settings s = undampedSettings(game);
                s.fixedDt = turn / v.frequency;
                step::Stepper stepper(s);
                const double before = v.energy();
                REQUIRE(stepper.advance(v.world, s.fixedDt, nullptr, {}).failure.empty());
                CAPTURE(game, mode, turn);
                CHECK(v.energy() < 0.7 * before);
            }
}

TEST_CASE("rings and open shells swing with the frequencies of the closed forms", "[step][vibration]") {
    // Inextensible ring: omega^2 = B / (lambda R^4) n^2 (n^2 - 1)^2 / (n^2 + 1), each n twice. The open arc of 3/4 of a
    // circle and the straight strip: roots of their characteristic equations, omega R^2 sqrt(lambda / B) = 0.759979294,
    // 2.00047734 and omega L^2 sqrt(lambda / B) = 22.3732854, 61.6728229. These many arcs are within 0.3 % of them.
    struct Case {
        const char* name;
        rod::RodDefinition definition;
        int mode;
        double factor, length;
    };
    const double R = 0.05;
    const rod::RodDefinition shell = paperShell(0.75, 31), round = ring(R, 1.0, 48), straight = vibratingBeam(31);
    const Case cases[] = {
        {"shell", shell, 0, 0.759979294, kR},        {"shell", shell, 1, 2.00047734, kR},
        {"ring", round, 0, 6.0 / std::sqrt(5.0), R}, {"ring", ring(R, 1.0, 72), 2, 24.0 / std::sqrt(10.0), R},
        {"strip", straight, 0, 22.3732854, 0.6},     {"strip", straight, 1, 61.6728229, 0.6}};
    for (const Case& c : cases)
        for (const bool game : {false, true}) {
            INFO(c.name << ", mode " << c.mode << ", game " << game);
            Vibrating v = vibrating(c.definition, false, c.mode);
            const double expected =
                c.factor * std::sqrt(c.definition.bendingModulus / c.definition.linearMass) / (c.length * c.length);
            CHECK(v.frequency == Approx(expected).epsilon(0.003));
            bendTo(v, 0.002 * c.length);
            const Seen seen = watch(v, 8.0, 10.0, undampedSettings(game));
            CHECK(seen.frequency == Approx(expected).epsilon(game ? 0.03 : 0.005));
            CHECK(seen.energy > (game ? 0.9 : 0.99));
        }
}

TEST_CASE("a damping ratio gives its logarithmic decrement", "[step][vibration]") {
    for (const bool clamped : {true, false})
        for (const bool game : {false, true})
            for (const double ratio : {0.01, 0.05, 0.2}) {
                INFO("clamped " << clamped << ", game " << game << ", ratio " << ratio);
                Vibrating v = vibrating(vibratingBeam(), clamped, 0);
                v.rod().dampingRatio = ratio;
                bendTo(v, 0.005);
                const double periods = ratio > 0.1 ? 2.0 : 5.0;
                const Seen seen = watch(v, 8.0, periods, undampedSettings(game));
                // Energy falls by exp(-4 pi zeta / sqrt(1 - zeta^2)) a period of the damped motion, which is longer.
                const double decrement = -std::log(seen.energy) / (2.0 * 2.0 * M_PI * periods);
                CHECK(decrement == Approx(ratio).epsilon(game ? 0.1 : 0.02));
                CHECK(std::abs(v.world.energyBalance.residual()) < 1e-12 * v.world.energyBalance.added);
                CHECK(v.world.energyBalance.damping > 0.0);
            }
}

TEST_CASE("bending viscosity as an effect gives the decrement of the same damping ratio", "[step][vibration]") {
    const double ratio = 0.03;
    Vibrating v = vibrating(vibratingBeam(), true, 0);
    effects::Model model;
    model.material.viscosity = 2.0 * ratio / v.frequency; // eta / B
    effects::Profile stiffer;                             // and with a stiffness that changes the frequency
    stiffer.shape = effects::Profile::Shape::Flat;
    stiffer.width = 10.0;
    stiffer.stiffness = 0.21;
    model.material.profiles.push_back(stiffer);
    step::setEffects(v.world, 0, model);
    bendTo(v, 0.005);
    const double stored = 1.21 * v.energy();
    v.frequency *= 1.1; // the square root of the stiffness
    const double periods = 5.0;
    const Seen seen = watch(v, 8.0, periods, undampedSettings(false));
    CHECK(seen.frequency == Approx(v.frequency).epsilon(0.002));
    // The viscosity stays while the stiffness grows, so the ratio falls with the frequency.
    const double bent = rod::bendingEnergy(v.rod().model, v.rod().q), left = v.energy() + 0.21 * bent;
    CHECK(-std::log(left / stored) / (4.0 * M_PI * periods) == Approx(ratio / 1.1).epsilon(0.02));
    const auto& book = v.rod().effects.energies[static_cast<std::size_t>(effects::Key::ViscoelasticBending)];
    CHECK(book.dissipated == Approx(stored - left).epsilon(0.01)); // the scheme takes less than a per cent of it
    CHECK(v.world.energyBalance.damping == 0.0);
}

/// Share of its energy that a mode of unit frequency keeps for `time` with a Maxwell branch on its spring, from rest
/// bent and relaxed: x'' + x + E z = 0, z' = x' - z / relaxation, by the classical Runge-Kutta method.
double keptBesideBranch(double E, double relaxation, double time) {
    using State = std::array<double, 3>;
    const auto rate = [&](const State& y) { return State{y[1], -y[0] - E * y[2], y[1] - y[2] / relaxation}; };
    const auto ahead = [](const State& y, const State& d, double h) {
        return State{y[0] + h * d[0], y[1] + h * d[1], y[2] + h * d[2]};
    };
    State y{1.0, 0.0, 0.0};
    const int steps = 20000;
    const double h = time / steps;
    for (int i = 0; i < steps; ++i) {
        const State a = rate(y), b = rate(ahead(y, a, 0.5 * h)), c = rate(ahead(y, b, 0.5 * h)),
                    d = rate(ahead(y, c, h));
        for (std::size_t k = 0; k < 3; ++k)
            y[k] += h / 6.0 * (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]);
    }
    return y[0] * y[0] + y[1] * y[1] + E * y[2] * y[2];
}

double stored(Vibrating& v, effects::Key key) {
    return v.rod().effects.energies[static_cast<std::size_t>(key)].stored;
}

TEST_CASE("a standard linear solid takes the energy of its modal equation", "[step][vibration]") {
    const double E = 0.05, periods = 5.0;
    for (const double relaxation : {0.2, 1.0, 5.0}) { // times the mode's frequency: all sides of the peak of the loss
        CAPTURE(relaxation);
        Vibrating v = vibrating(vibratingBeam(), true, 0);
        effects::Model model;
        model.material.branches.push_back({E, relaxation / v.frequency});
        step::setEffects(v.world, 0, model);
        bendTo(v, 0.005);
        const double before = v.energy();
        watch(v, 8.0, periods, undampedSettings(false));
        const double left = v.energy() + stored(v, effects::Key::ViscoelasticBending);
        // As for other dampings: 2 % of the decrement, by the error of the steps.
        CHECK(std::log(left / before) ==
              Approx(std::log(keptBesideBranch(E, relaxation, 2.0 * M_PI * periods))).epsilon(0.02));
        const auto& book = v.rod().effects.energies[static_cast<std::size_t>(effects::Key::ViscoelasticBending)];
        CHECK(book.dissipated == Approx(before - left).epsilon(0.02));
        CHECK(std::abs(v.world.energyBalance.residual()) < 1e-12 * v.world.energyBalance.added);
    }
}

TEST_CASE("a vibrating strip that softens keeps its action", "[step][vibration]") {
    Vibrating v = vibrating(vibratingBeam(), true, 0);
    const double periods = 12.0, period = 2.0 * M_PI / v.frequency, drop = 0.3;
    effects::Model model;
    model.material.softening = drop;
    model.material.softeningTime = 6.0 * period;
    step::setEffects(v.world, 0, model);
    bendTo(v, 0.005);
    const double before = v.energy();
    watch(v, 16.0, periods, undampedSettings(false));
    // Energy over frequency is an adiabatic invariant; frequency goes with the root of the stiffness. 2 %: it
    // oscillates by drop / (2 omega softeningTime), and the scheme takes a per cent.
    const double stiffness = 1.0 - drop * (1.0 - std::exp(-periods / 6.0));
    const double left = v.energy() + stored(v, effects::Key::SofteningOverTime);
    CHECK(left / before == Approx(std::sqrt(stiffness)).epsilon(0.02));
    CHECK(std::abs(v.world.energyBalance.residual()) < 1e-12 * v.world.energyBalance.added);
}

TEST_CASE("a material law of no size changes no vibration", "[step][vibration]") {
    const auto left = [](const effects::Model& model) {
        Vibrating v = vibrating(vibratingBeam(), true, 0);
        step::setEffects(v.world, 0, model);
        bendTo(v, 0.005);
        return watch(v, 8.0, 10.0, undampedSettings(false)).energy;
    };
    const double plain = left({});
    effects::Model branch, soft, plastic;
    branch.material.branches.push_back({1e-6, 0.1});
    soft.material.softening = 1e-6;
    soft.material.softeningTime = 0.1;
    plastic.material.yield = 100.0; // 1/m, thousands of times the curvature of this swing
    plastic.material.hardening = 0.1;
    for (const effects::Model* model : {&branch, &soft, &plastic})
        CHECK(left(*model) == Approx(plain).margin(1e-4)); // a stiffness of 1e-6 changes nothing by more than 1e-5
}

TEST_CASE("a vibrating strip that yields flows in the ordinary step and loses what its law takes",
          "[step][vibration]") {
    Vibrating v = vibrating(vibratingBeam(), true, 0);
    effects::Model model;
    model.material.yield = 0.02; // 1/m, below the largest curvature at the clamp
    model.material.hardening = 0.2;
    step::setEffects(v.world, 0, model);
    bendTo(v, 0.01);
    step::Stepper stepper(undampedSettings(false));
    for (int i = 0; i < 40; ++i)
        REQUIRE(stepper.advance(v.world, M_PI / v.frequency / 20.0, nullptr, {}).failure.empty());
    const auto& book = v.rod().effects.energies[static_cast<std::size_t>(effects::Key::Plasticity)];
    CHECK(book.dissipated > 0.0);
    CHECK(book.dissipated < v.world.energyBalance.added);
    CHECK(std::abs(v.world.energyBalance.residual()) < 1e-9 * v.world.energyBalance.added);
}

namespace {

/// Of a shell that swings widely in its first mode, spins and falls: its tip after half a period in that many steps.
/// Other shapes hold modes that none of these steps resolves, and no order is seen.
Vec2 tipAfterHalfASwing(int steps, bool secondOrder = true, double damping = 0.0, double branch = 0.0) {
    Vibrating v = vibrating(paperShell(), false, 0);
    v.world.gravity = {0.0, -kG};
    v.rod().dampingRatio = damping;
    effects::Model model;
    if (branch > 0.0)
        model.material.branches.push_back({branch, 20.0 / v.frequency}); // what damps more leaves round-off
    step::setEffects(v.world, 0, model);
    v.rod().v[v.rod().model.dofTheta()] = 20.0;
    bendTo(v, 0.2 * kR);
    step::Settings s;
    s.secondOrder = secondOrder;
    s.fixedDt = M_PI / v.frequency / steps;
    step::Stepper stepper(s);
    for (int i = 0; i < steps; ++i)
        REQUIRE(stepper.advance(v.world, s.fixedDt, nullptr, {}).failure.empty());
    return v.rod().kin.node(v.rod().model.elements());
}

} // namespace

TEST_CASE("free motion is of second order", "[step][vibration]") {
    for (const auto& [damping, branch] : {std::pair(0.0, 0.0), std::pair(0.05, 0.0), std::pair(0.0, 0.3)}) {
        const Vec2 exact = tipAfterHalfASwing(6400, true, damping, branch);
        double error[3];
        for (int i = 0; i < 3; ++i)
            error[i] = (tipAfterHalfASwing(100 << i, true, damping, branch) - exact).norm();
        CAPTURE(error[0], error[1], error[2]);
        CHECK(error[0] / error[1] == Approx(4.0).epsilon(0.1));
        CHECK(error[1] / error[2] == Approx(4.0).epsilon(0.1));
    }
}

// docs/results/order_figure.py draws it.
TEST_CASE("errors over the size of the step, as a table", "[.order]") {
    const Vec2 exact = tipAfterHalfASwing(12800);
    std::printf("steps_a_period,second_order,first_order\n");
    for (int steps = 4; steps <= 1600; steps *= 2)
        std::printf("%d,%.6e,%.6e\n", 2 * steps, (tipAfterHalfASwing(steps) - exact).norm() / kR,
                    (tipAfterHalfASwing(steps, false) - exact).norm() / kR);
}

TEST_CASE("linear air takes from all modes at one rate", "[step][vibration][air]") {
    for (const bool game : {false, true})
        for (const int mode : {0, 2}) {
            CAPTURE(game, mode);
            Vibrating v = vibrating(vibratingBeam(), true, mode);
            const double rate = 0.06 * v.frequency, periods = 5.0; // of the energy: twice the damping ratio, 0.03
            effects::Model model;
            model.air.linear = rate * v.rod().model.definition().linearMass;
            step::setEffects(v.world, 0, model);
            bendTo(v, 0.002);
            const double before = v.energy();
            const Seen seen = watch(v, 8.0, periods, undampedSettings(game));
            // As for other dampings: 2 % of the decrement in laboratory quality, 10 % in games.
            CHECK(-std::log(seen.energy) ==
                  Approx(rate * periods * 2.0 * M_PI / v.frequency).epsilon(game ? 0.1 : 0.02));
            const auto& book = v.rod().effects.energies[static_cast<std::size_t>(effects::Key::AirDrag)];
            CHECK(book.dissipated == Approx(before - v.energy()).epsilon(game ? 0.1 : 0.01));
            CHECK(std::abs(v.world.energyBalance.residual()) < 1e-12 * v.world.energyBalance.added);
        }
}

TEST_CASE("an amplitude falls as 1/t in quadratic air", "[step][vibration][air]") {
    Vibrating v = vibrating(vibratingBeam(), true, 0);
    const double amplitude = 0.01, periods = 8.0, end = periods * 2.0 * M_PI / v.frequency;
    std::vector<Vec2> way; // of a unit amplitude
    rod::velocityField(v.rod().model, v.rod().kin, v.rod().gauss, v.shape, way);
    double cubes = 0.0, squares = 0.0;
    for (std::size_t g = 0; g < way.size(); ++g) {
        cubes += v.rod().gauss.mass[g] * std::pow(way[g].norm(), 3);
        squares += v.rod().gauss.mass[g] * way[g].squaredNorm();
    }
    const double wanted = 0.5; // 1/a - 1/a0, of 1/a0, at the end
    effects::Model model;      // da/dt = -4/(3 pi) b2 omega / lambda (cubes / squares) a^2, the mean over a period
    model.air.quadratic = wanted / (amplitude * end) * 3.0 * M_PI / 4.0 * v.rod().model.definition().linearMass /
                          v.frequency * squares / cubes;
    step::setEffects(v.world, 0, model);
    bendTo(v, amplitude);
    const Seen seen = watch(v, 16.0, periods, undampedSettings(false));
    // The mean over a period errs by the loss in a quarter of one, 1.5 % of the whole; the scheme takes a per cent.
    CHECK(1.0 / std::sqrt(seen.energy) - 1.0 == Approx(wanted).epsilon(0.03));
    CHECK(std::abs(v.world.energyBalance.residual()) < 1e-12 * v.world.energyBalance.added);
}

TEST_CASE("a level strip falls through air as the closed form says", "[step][vibration][air]") {
    const double fast = 3.0, time = fast / kG; // m/s, at last; s
    const double mass = vibratingBeam().linearMass;
    for (const bool second : {true, false})
        for (const bool game : {false, true})
            for (const bool quadratic : {false, true})
                for (const double stronger :
                     {1.0, 300.0}) { // 300: it is at its last speed within a thousandth of a second
                    CAPTURE(second, game, quadratic, stronger);
                    step::World world;
                    world.gravity = {0.0, -kG};
                    put(world, vibratingBeam(), {0.0, 10.0}, 0.0, 0.3);
                    effects::Model model;
                    const double last = fast / stronger;
                    (quadratic ? model.air.quadratic : model.air.linear) = mass * kG / (quadratic ? last * last : last);
                    step::setEffects(world, 0, model);
                    step::Settings settings = undampedSettings(game);
                    settings.secondOrder = second;
                    step::Stepper stepper(settings);
                    const int frames = static_cast<int>(std::lround(2.0 * time * 60.0));
                    for (int i = 0; i < frames; ++i)
                        REQUIRE(stepper.advance(world, 1.0 / 60.0, nullptr, {}).failure.empty());
                    const double t = frames / 60.0 * kG / last;
                    const double expected = -last * (quadratic ? std::tanh(t) : -std::expm1(-t));
                    const double speed = momentum(world).y() / (mass * 0.6);
                    // First order errs by half a step of 1/60 s over 0.3 s at most.
                    CHECK(speed == Approx(expected).epsilon(second ? 0.002 : 0.03));
                    CHECK(std::abs(world.energyBalance.residual()) < 1e-12 * world.rods[0].model.mass() * kG * 10.0);
                }
}
