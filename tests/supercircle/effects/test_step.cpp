// Effects inside the step: off is absent, the energy balance holds, and the laws show in the motion.

#include "tests/supercircle/step/setup.h"

#include "supercircle/effects/effect.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

effects::Model stepModelOf(std::initializer_list<const char*> texts) {
    std::vector<effects::Setting> settings;
    for (const char* text : texts)
        REQUIRE(effects::add(settings, text).empty());
    REQUIRE(effects::validate(settings).empty());
    return effects::modelFor(settings, "all");
}

/// A shell with its tips above a floor.
step::World aboveFloor(FakeHost& host, double tilt, const rod::Vec2& velocity) {
    host.g = {0.0, -kG};
    host.addGround(1, 0.35);
    step::World w;
    w.gravity = {0.0, -kG};
    put(w, paperShell(), {0.0, 0.045}, M_PI + tilt, 0.35, velocity);
    return w;
}

/// The same dropped, with the model; 0.12 s.
step::World dropped(const effects::Model* model, double tilt = 0.3) {
    FakeHost host;
    step::World w = aboveFloor(host, tilt, {0.05, -0.2});
    if (model)
        step::setEffects(w, 0, *model);
    step::Stepper stepper{step::Settings{}};
    for (int i = 0; i < 30; ++i)
        frame(stepper, w, host, 4e-3);
    return w;
}

/// A strip along a slope, `gap` above it; x points down.
step::World onSlope(FakeHost& host, const rod::RodDefinition& d, double slope, double mu, double gap) {
    host.g = {kG * std::sin(slope), -kG * std::cos(slope)};
    host.addGround(1, mu);
    step::World w;
    w.gravity = host.g;
    put(w, d, {0.0, 0.5 * d.thickness + gap}, 0.0, mu, {0.0, 0.0});
    return w;
}

double scale(const step::EnergyBalance& l) {
    return std::abs(l.added) + std::abs(l.kinetic) + std::abs(l.bending) + 1e-9;
}

} // namespace

TEST_CASE("an effect that is off is bit-identical to one that is absent") {
    const step::World without = dropped(nullptr);
    std::vector<effects::Setting> all;
    for (const effects::Effect& e : effects::catalog())
        all.push_back(effects::off(e));
    const effects::Model off = effects::modelFor(all, "all");
    CHECK(sameState(dropped(&off), without));
}

TEST_CASE("the energy balance holds with each effect on, and dissipation is never negative") {
    for (const auto& texts : std::vector<std::vector<const char*>>{
             {"viscoelastic_bending:eta_over_B_s=0.002"},
             {"viscoelastic_bending:law=standard_linear_solid", "viscoelastic_bending:branch_over_B=0.5",
              "viscoelastic_bending:tau_s=0.01"},
             {"nonlinear_elasticity:law=softening", "nonlinear_elasticity:uc_1_m=10"},
             {"plasticity:My_over_B_1_m=1", "plasticity:H_over_B=0.3"},
             {"local_damage:stiffness_drop=0.6", "local_damage:arc_fraction=0.8"},
             {"natural_curvature_defect:curvature_change_1_m=-10"},
             {"stiffness_gradient:gradient=0.3"},
             {"softening_over_time:drop=0.3", "softening_over_time:tau_s=0.05"},
             {"planar_drag:f_N_m=0.02"},
             {"static_friction_excess:mu_s_over_mu_k=1.5", "static_friction_excess:Dc_m=0.001"},
             {"static_friction_excess:mu_s_over_mu_k=1.5", "static_friction_excess:presliding_m=1e-5"},
             {"rate_dependent_friction:strength=-0.4", "rate_dependent_friction:speed_m_s=0.05"},
             {"viscoelastic_bending:law=loss_factor", "viscoelastic_bending:loss_factor=0.2",
              "viscoelastic_bending:f_low_Hz=1", "viscoelastic_bending:f_high_Hz=1000"},
             {"rate_and_state_friction:a_over_mu=0.05", "rate_and_state_friction:b_over_mu=0.02",
              "rate_and_state_friction:Dc_m=1e-4", "rate_and_state_friction:V0_m_s=0.05"},
             {"rate_and_state_friction:a_over_mu=0.02", "rate_and_state_friction:b_over_mu=0.05",
              "rate_and_state_friction:law=slip", "rate_and_state_friction:V0_m_s=0.05"},
             {"wear:change=0.5", "wear:distance_m=0.005"},
             {"contact_compliance:normal_m_N=1e-4", "contact_compliance:tangential_m_N=2e-4"},
             {"adhesion:F_a_N_m=0.5", "adhesion:range_m=0.0005"}}) {
        std::vector<effects::Setting> settings;
        for (const char* text : texts)
            REQUIRE(effects::add(settings, text).empty());
        const effects::Model model = effects::modelFor(settings, "all");
        const step::World w = dropped(&model);
        INFO(texts.front() << ": residual " << w.energyBalance.residual() << " of " << scale(w.energyBalance)
                           << ", numerical " << w.energyBalance.numerical << ", effects " << w.energyBalance.effects);
        CHECK(std::abs(w.energyBalance.residual()) <
              1e-9 * scale(w.energyBalance)); // round-off: every term is recorded
        CHECK(w.energyBalance.friction >= 0.0);
        for (const effects::EffectEnergy& b : step::effectEnergies(w))
            CHECK(b.dissipated >= 0.0);
        CHECK_FALSE(sameState(w, dropped(nullptr)));
    }
}

TEST_CASE("a strip that slides against front and back walls stops after the distance given by its friction") {
    // Free flight without gravity: m v^2 / 2 = f L x; all of it is dissipated.
    step::World w;
    const double v = 0.1, f = 0.05;
    rod::RodDefinition d = strip(0.05, 100.0);
    put(w, d, {0.0, 0.0}, 0.0, 0.0, {v, 0.0});
    effects::Model m = stepModelOf({"planar_drag:f_N_m=0.05"});
    step::setEffects(w, 0, m);
    step::Settings s;
    s.fixedDt = 1e-4;
    step::Stepper stepper{s};
    FakeHost host;
    for (int i = 0; i < 30; ++i)
        frame(stepper, w, host, 4e-3);
    const double expected = 0.5 * d.linearMass * v * v / f;
    CHECK(centre(w.rods[0]).x() == Approx(expected).epsilon(0.02)); // one step of travel is 1 % of it
    CHECK(w.rods[0].speed < 1e-6);
}

TEST_CASE("an adhesive shell at rest takes one linearisation per step, whatever the number of near points") {
    FakeHost host;
    step::World w = aboveFloor(host, 0.0, {0.0, 0.0});
    step::setEffects(w, 0, stepModelOf({"adhesion:F_a_N_m=0.5", "adhesion:range_m=0.002"}));
    step::Stepper stepper{step::Settings{}};
    for (int i = 0; i < 200; ++i)
        frame(stepper, w, host, 4e-3);
    REQUIRE(w.rods[0].speed < 1e-4);
    const step::Counters before = w.counters;
    for (int i = 0; i < 50; ++i)
        frame(stepper, w, host, 4e-3);
    // Nothing moves, so the law is where it was predicted, and one linearisation is enough.
    CHECK(w.counters.solves - before.solves <= w.counters.steps - before.steps + 1);
}

TEST_CASE("a world with effects restored from its copy continues bitwise identically") {
    FakeHost host;
    step::World w = aboveFloor(host, 0.3, {0.05, -0.2});
    step::setEffects(w, 0,
                     stepModelOf({"plasticity:My_over_B_1_m=1", "planar_drag:f_N_m=0.02",
                                  "static_friction_excess:mu_s_over_mu_k=1.5", "adhesion:F_a_N_m=0.5"}));
    step::Stepper stepper{step::Settings{}};
    for (int i = 0; i < 12; ++i)
        frame(stepper, w, host, 4e-3);
    step::World copy = w;
    step::Stepper other{step::Settings{}};
    for (int i = 0; i < 6; ++i) {
        frame(stepper, w, host, 4e-3);
        frame(other, copy, host, 4e-3);
    }
    CHECK(sameState(w, copy));
}

TEST_CASE("friction that grows with speed lets a strip creep down a slope at the speed where the two balance") {
    // mu (1 + s ln(1 + v / v0)) = tan(slope) at v = 3 v0. At a step of a few milliseconds the balance is stiff: gravity
    // alone would change the speed by a hundred v0.
    const double mu = 0.35, strength = 0.2, v0 = 1e-4, slope = std::atan(mu * (1.0 + strength * std::log(4.0)));
    FakeHost host;
    const rod::RodDefinition d = strip(0.05, 100.0);
    step::World w = onSlope(host, d, slope, mu, 1e-6);
    step::setEffects(w, 0,
                     stepModelOf({"rate_dependent_friction:law=logarithmic", "rate_dependent_friction:strength=0.2",
                                  "rate_dependent_friction:speed_m_s=1e-4"}));
    step::Stepper stepper{step::Settings{}};
    for (int i = 0; i < 25; ++i)
        frame(stepper, w, host, 4e-3);
    const double x = centre(w.rods[0]).x(), friction = w.energyBalance.friction;
    for (int i = 0; i < 25; ++i)
        frame(stepper, w, host, 4e-3);
    const double way = centre(w.rods[0]).x() - x, time = 0.1;
    // A coefficient that is right to a thousandth gives the speed to 1e-3 (1 + s ln 4) / s (1 + v0 / v) = 0.9 %.
    CHECK(way == Approx(3.0 * v0 * time).epsilon(0.02));
    const double weight = d.linearMass * 0.05 * kG;
    CHECK(w.energyBalance.friction - friction == Approx(weight * std::sin(slope) * way).epsilon(0.02));
}

TEST_CASE("a contact that is elastic before it slides deflects in proportion to its load, and less as it ages") {
    // A strip at rest on a slope. All of its contacts deflect by e, with F = mu N e / presliding, so that
    // e = presliding tan(slope) / mu, however they share the weight. mu grows as they heal from 4/5 of their slip.
    const double mu = 0.3, ratio = 1.5, presliding = 4e-6, slope = std::atan(0.1), heal = 0.05;
    FakeHost host;
    step::World w = onSlope(host, strip(0.05, 100.0), slope, mu, 0.0);
    step::setEffects(
        w, 0,
        stepModelOf({"static_friction_excess:mu_s_over_mu_k=1.5", "static_friction_excess:Dc_m=1",
                     "static_friction_excess:tau_heal_s=0.05", "static_friction_excess:presliding_m=4e-6"}));
    for (effects::Site& site : w.rods[0].effects.surface.sites)
        site.weakened = 0.8;
    step::Settings s;
    s.fixedDt = 1e-3;
    step::Stepper stepper{s};
    const auto tangentialDeflection = [&] { // mean over the contacts by what they carry, m
        double sum = 0.0, load = 0.0;
        for (const step::ContactImpulse& c : w.impulses) {
            sum += c.tangentialDeflection * c.normal;
            load += c.normal;
        }
        return std::abs(sum / load);
    };
    const auto expected = [&](double t) {
        return presliding * 0.1 / (mu * (1.0 + (ratio - 1.0) * (1.0 - 0.8 * std::exp(-t / heal))));
    };
    for (int i = 0; i < 5; ++i)
        frame(stepper, w, host, 4e-3);
    const double x = centre(w.rods[0]).x();
    CHECK(tangentialDeflection() == Approx(expected(0.02)).epsilon(0.02));
    for (int i = 0; i < 50; ++i)
        frame(stepper, w, host, 4e-3);
    CHECK(tangentialDeflection() == Approx(expected(0.22)).epsilon(0.02));
    CHECK(x - centre(w.rods[0]).x() == Approx(expected(0.02) - expected(0.22)).epsilon(0.05));
}
