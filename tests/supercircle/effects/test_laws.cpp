// The laws alone: closed forms, tangents against differences, energies against work.

#include "supercircle/effects/backlash.h"
#include "supercircle/effects/effect.h"
#include "supercircle/effects/laws/adhesion.h"
#include "supercircle/effects/laws/elastic_law.h"
#include "supercircle/effects/laws/material.h"
#include "supercircle/effects/sensor.h"
#include "supercircle/effects/surface.h"
#include "supercircle/rod/elasticity.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;
using namespace supercircle::effects;

namespace {

rod::RodModel shell(int elements = 4) {
    rod::RodDefinition d;
    d.length = 0.09;
    d.naturalCurvature.assign(static_cast<std::size_t>(elements), 52.0);
    return rod::RodModel(d);
}

Model modelOf(std::initializer_list<const char*> texts) {
    std::vector<Setting> settings;
    for (const char* text : texts)
        REQUIRE(add(settings, text).empty());
    REQUIRE(validate(settings).empty());
    return modelFor(settings, "all");
}

struct Balance {
    double given = 0.0, taken = 0.0, leastDissipated = 0.0;
};

/// Bends a rod back and forth in n steps: work of the moments against the recorded energies, and the least dissipation.
Balance bendToAndFro(const rod::RodModel& rod, Material material, int n, double period) {
    EffectEnergies energies{};
    Eigen::VectorXd q = Eigen::VectorXd::Zero(rod.dofs()), q1 = q;
    const auto shape = [&](double phase, Eigen::VectorXd& out) {
        for (int e = 0; e < rod.elements(); ++e)
            out[rod.dofOfElement(e)] = 52.0 + 40.0 * std::sin(phase) * (1.0 + 0.2 * e);
    };
    shape(0.0, q);
    storedEnergy(rod, material, q, energies);
    const double B = rod.definition().bendingModulus, dt = period / n;
    const auto total = [&] {
        double sum = 0.0;
        for (const EffectEnergy& b : energies)
            sum += b.stored + b.dissipated;
        return sum;
    };
    const double start = total();
    Balance out;
    std::vector<NeighbourResponse> early, late;
    for (int i = 0; i < n; ++i) {
        shape(2.0 * M_PI * 1.3 * (i + 1) / n, q1);
        const EffectEnergies before = energies;
        for (int e = 0; e < rod.elements(); ++e) {
            const double a = q[rod.dofOfElement(e)], b = q1[rod.dofOfElement(e)];
            const auto extra = [&](double from, double to) { // without linear bending
                return materialResponse(rod, material, e, from, to, dt).moment - B * (to - 52.0);
            };
            // Trapezoid of the moments at both ends of the step: second order, unlike the step's own backward rule.
            // A dashpot has the same rate at both.
            const double dashpot = B * material.model.viscosity * (b - a) / dt;
            out.given += rod.elementLength(e) * (b - a) * 0.5 * (extra(a, b) + extra(a, a + 1e-9 * (b - a)) + dashpot);
        }
        // The same of neighbours, without those of linear bending and with the whole dashpot at the early end too.
        materialNeighbours(rod, material, q, q1, dt, late);
        springNeighbours(rod, material, q, 0.0, early);
        std::size_t pair = 0;
        rod::forNeighbours(rod, [&](int first, int second, double c) {
            const int db = rod.dofOfElement(first), da = rod.dofOfElement(second);
            const double ofB = q1[db] - q[db], ofA = q1[da] - q[da];
            const double linear = 0.5 * B * c * (q1[da] + q[da] - q1[db] - q[db]);
            double dashpot = B * c * material.model.viscosity * (ofA - ofB) / dt;
            for (std::size_t j = 0; j < material.model.branches.size(); ++j)
                dashpot += B * c * material.model.branches[j].stiffness *
                           (material.overstress[j][static_cast<std::size_t>(second)] -
                            material.overstress[j][static_cast<std::size_t>(first)]);
            out.given -= ofA * (0.5 * (late[pair].forceAfter + early[pair].forceAfter + dashpot) - linear) +
                         ofB * (0.5 * (late[pair].forceBefore + early[pair].forceBefore - dashpot) + linear);
            ++pair;
        });
        advance(rod, q, q1, dt, material, energies);
        for (std::size_t k = 0; k < kKeys; ++k)
            out.leastDissipated = std::min(out.leastDissipated, energies[k].dissipated - before[k].dissipated);
        q = q1;
    }
    out.taken = total() - start;
    return out;
}

} // namespace

TEST_CASE("every documented label is in the catalogue, in the order of its keys, and off by default") {
    const char* const labels[] = {"viscoelastic_bending",
                                  "static_friction_excess",
                                  "rate_dependent_friction",
                                  "adhesion",
                                  "machine_compliance",
                                  "support_settlement",
                                  "clamp_compliance",
                                  "rate_and_state_friction",
                                  "sensor_drift",
                                  "sensor_gain",
                                  "backlash",
                                  "misalignment",
                                  "natural_curvature_defect",
                                  "local_damage",
                                  "plasticity",
                                  "stiffness_gradient",
                                  "planar_drag",
                                  "wear",
                                  "softening_over_time",
                                  "contact_compliance",
                                  "nonlinear_elasticity",
                                  "gravity"};
    for (const char* label : labels)
        CHECK(find(label) != nullptr);
    REQUIRE(catalog().size() == kKeys);
    for (std::size_t k = 0; k < kKeys; ++k) {
        const Effect& e = catalog()[k];
        INFO(e.name);
        CHECK(static_cast<std::size_t>(e.key) == k);
        CHECK(isOff(off(e)));
        CHECK_FALSE(e.law.empty());
        CHECK_FALSE(e.literature.empty());
        CHECK_FALSE(e.fingerprint.empty());
        bool isSwitch = false;
        for (const Parameter& p : e.parameters) {
            CHECK(p.off >= p.min);
            CHECK(p.off <= p.max);
            CHECK_FALSE(p.unit.empty());
            isSwitch = isSwitch || p.isSwitch;
        }
        CHECK(isSwitch);
    }
}

TEST_CASE("a profile rotated end for end is the mirror image") {
    using Shape = effects::Profile::Shape;
    for (const Shape shape : {Shape::Gauss, Shape::Flat, Shape::Linear, Shape::Thickness}) {
        const effects::Profile p{Key::LocalDamage, shape, 0.3, 0.02, -0.4, 7.0};
        const effects::Profile t = effects::mirrored(p);
        for (const double s : {0.0, 0.013, 0.029, 0.05, 0.069, 0.1}) {
            CHECK(effects::stiffnessAt(t, 0.1, s) == Approx(effects::stiffnessAt(p, 0.1, 0.1 - s)));
            CHECK(t.curvature * effects::shapeAt(t, 0.1, s) ==
                  Approx(p.curvature * effects::shapeAt(p, 0.1, 0.1 - s)).margin(1e-12));
        }
    }
}

TEST_CASE("unknown names are refused with the nearest known name") {
    std::vector<Setting> s;
    CHECK(add(s, "plasticty:My_over_B_1_m=3").find("plasticity") != std::string::npos);
    CHECK(add(s, "adhesion:range=3").find("range_m") != std::string::npos);
    CHECK(add(s, "adhesion:range_m=-1").find("out of range") != std::string::npos);
    CHECK(add(s, "adhesion:range_m=nan").find("adhesion") != std::string::npos);
    CHECK(add(s, "adhesion").find("KEY:NAME=VALUE") != std::string::npos);
    CHECK(add(s, "nonlinear_elasticity:law=softning").find("softening") != std::string::npos);
}

TEST_CASE("elastic laws: slope and energy are the derivative and the integral of the moment") {
    for (const ElasticModel& b :
         {ElasticModel{}, ElasticModel{ElasticModel::Law::Softening, 110.0, 3.0},
          ElasticModel{ElasticModel::Law::Stiffening, 60.0, 3.0},
          ElasticModel{ElasticModel::Law::RambergOsgood, 40.0, 5.0},
          ElasticModel{ElasticModel::Law::Learned, 70.0, 3.0, {0.1, -0.2, 0.4, 0.3, -0.5, 0.2, 0.6}}})
        for (const double u : {-90.0, -3.0, 0.5, 20.0, 75.0}) {
            const double d = 1e-4;
            CHECK((evaluate(b, u + d).value - evaluate(b, u - d).value) / (2.0 * d) ==
                  Approx(evaluate(b, u).slope).epsilon(1e-6));
            CHECK((evaluate(b, u + d).energy - evaluate(b, u - d).energy) / (2.0 * d) ==
                  Approx(evaluate(b, u).value).epsilon(1e-6));
        }
}

TEST_CASE("a learned law: equal coefficients are a constant, its integrals those of a fine sum, the far end smooth") {
    const SplineCoefficients same = {0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3}, c = {0.4, -1.0, 2.0, 0.5, -0.3, 1.0, 0.2};
    for (const double x : {0.0, 0.2, 0.25, 0.9, 1.0, 1.7}) {
        CHECK(evaluateSpline(same, x).value == Approx(0.3).epsilon(1e-14)); // the basis sums to one
        CHECK(evaluateSpline(same, x).area == Approx(0.3 * x).margin(1e-15));
        double area = 0.0, moment = 0.0;
        constexpr int kSteps = 4000;
        for (int i = 0; i < kSteps; ++i) { // midpoint rule: h^2 / 24 S'' < 1e-6
            area += evaluateSpline(c, x * (i + 0.5) / kSteps).value * x / kSteps;
            moment += evaluateSpline(c, x * (i + 0.5) / kSteps).area * x / kSteps;
        }
        CHECK(evaluateSpline(c, x).area == Approx(area).margin(2e-6));
        CHECK(evaluateSpline(c, x).moment == Approx(moment).margin(2e-6));
        CHECK(evaluateFading(c, 0.3).slope ==
              Approx((evaluateFading(c, 0.3 + 1e-6).value - evaluateFading(c, 0.3 - 1e-6).value) / 2e-6).epsilon(1e-6));
    }
    CHECK(evaluateFading(c, 1.0).value == Approx(0.0).margin(1e-15));
    CHECK(evaluateFading(c, 1.0).slope == Approx(0.0).margin(1e-13));
}

TEST_CASE("the tangent of every material law is the derivative of its moment") {
    const rod::RodModel rod = shell();
    for (const Model& m :
         {modelOf({"viscoelastic_bending:eta_over_B_s=0.1"}),
          modelOf({"viscoelastic_bending:law=standard_linear_solid", "viscoelastic_bending:branch_over_B=0.4",
                   "viscoelastic_bending:tau_s=0.3"}),
          modelOf({"nonlinear_elasticity:law=softening", "nonlinear_elasticity:uc_1_m=80"}),
          modelOf({"plasticity:My_over_B_1_m=22", "plasticity:H_over_B=0.35"}),
          modelOf({"plasticity:My_over_B_1_m=22", "plasticity:H_over_B=0.35", "nonlinear_elasticity:law=softening",
                   "nonlinear_elasticity:uc_1_m=80", "viscoelastic_bending:eta_over_B_s=0.01",
                   "local_damage:stiffness_drop=0.5", "softening_over_time:drop=0.2"})}) {
        const Material material = makeMaterial(rod, m.material);
        for (const double now : {20.0, 50.0, 60.0, 95.0, 140.0}) {
            const double d = 1e-5;
            const auto moment = [&](double k) { return materialResponse(rod, material, 1, 52.0, k, 0.02).moment; };
            CHECK((moment(now + d) - moment(now - d)) / (2.0 * d) ==
                  Approx(materialResponse(rod, material, 1, 52.0, now, 0.02).tangent).epsilon(1e-5));
        }
    }
}

TEST_CASE("moments and what neighbours take from each other are the gradient of the energy of the springs") {
    const rod::RodModel rod = shell();
    for (const Model& m : {modelOf({"nonlinear_elasticity:law=softening", "nonlinear_elasticity:uc_1_m=80"}),
                           modelOf({"nonlinear_elasticity:law=stiffening", "nonlinear_elasticity:uc_1_m=80"}),
                           modelOf({"local_damage:stiffness_drop=0.5", "stiffness_gradient:gradient=0.2"}),
                           modelOf({"softening_over_time:drop=0.3", "softening_over_time:tau_s=0.5"})}) {
        const Material material = makeMaterial(rod, m.material);
        Eigen::VectorXd q = Eigen::VectorXd::Zero(rod.dofs());
        for (int e = 0; e < rod.elements(); ++e)
            q[rod.dofOfElement(e)] = 52.0 + 40.0 * std::sin(1.0 + 0.9 * e);
        Eigen::VectorXd force = Eigen::VectorXd::Zero(rod.dofs());
        for (int e = 0; e < rod.elements(); ++e)
            force[rod.dofOfElement(e)] -=
                rod.elementLength(e) * springResponse(rod, material, e, q[rod.dofOfElement(e)], 0.1).moment;
        std::vector<NeighbourResponse> pairs;
        springNeighbours(rod, material, q, 0.1, pairs);
        for (const NeighbourResponse& p : pairs) {
            force[rod.dofOfElement(p.before)] += p.forceBefore;
            force[rod.dofOfElement(p.after)] += p.forceAfter;
        }
        for (int e = 0; e < rod.elements(); ++e) {
            const Eigen::VectorXd d = 1e-3 * Eigen::VectorXd::Unit(rod.dofs(), rod.dofOfElement(e));
            const double slope =
                (springEnergy(rod, material, q + d, 0.1) - springEnergy(rod, material, q - d, 0.1)) / 2e-3;
            CHECK(force[rod.dofOfElement(e)] == Approx(-slope).epsilon(1e-6).margin(1e-6 * force.norm()));
        }
    }
}

TEST_CASE("the energy balance of materials holds to second order in the step, and dissipation never decreases") {
    const rod::RodModel rod = shell();
    for (const Model& m :
         {modelOf({"viscoelastic_bending:eta_over_B_s=0.1"}),
          modelOf({"viscoelastic_bending:law=standard_linear_solid", "viscoelastic_bending:branch_over_B=0.4",
                   "viscoelastic_bending:tau_s=0.3"}),
          modelOf({"nonlinear_elasticity:law=softening", "nonlinear_elasticity:uc_1_m=80"}),
          modelOf({"plasticity:My_over_B_1_m=22", "plasticity:H_over_B=0.35"}),
          modelOf({"plasticity:My_over_B_1_m=22", "plasticity:H_over_B=0.35", "plasticity:hardening=kinematic"}),
          modelOf({"local_damage:stiffness_drop=0.5", "stiffness_gradient:gradient=0.2"}),
          modelOf({"softening_over_time:drop=0.3", "softening_over_time:tau_s=0.5"})}) {
        double off[2];
        for (int i = 0; i < 2; ++i) {
            const Balance b = bendToAndFro(rod, makeMaterial(rod, m.material), 400 << i, 1.0);
            off[i] = std::abs(b.given - b.taken) / (std::abs(b.taken) + 1e-6);
            CHECK(b.leastDissipated >= -1e-18);
        }
        CHECK(off[1] < 0.02);                // of what the effect moves, at 800 steps
        CHECK(off[1] < 0.6 * off[0] + 1e-9); // and falling with the step
    }
}

TEST_CASE("rate effects vanish in the slow limit") {
    const rod::RodModel rod = shell();
    for (const Model& m : {modelOf({"viscoelastic_bending:eta_over_B_s=0.1"}),
                           modelOf({"viscoelastic_bending:law=standard_linear_solid",
                                    "viscoelastic_bending:branch_over_B=0.4", "viscoelastic_bending:tau_s=0.3"})}) {
        const Material material = makeMaterial(rod, m.material);
        const double B = rod.definition().bendingModulus, elastic = B * 30.0;
        const auto extra = [&](double dt) {
            return materialResponse(rod, material, 0, 52.0, 82.0, dt).moment - elastic;
        };
        CHECK(std::abs(extra(1e5)) < 1e-4 * elastic);
        CHECK(extra(2e5) == Approx(0.5 * extra(1e5)).epsilon(1e-3)); // linear in the rate
    }
}

TEST_CASE("a Maxwell branch relaxes by exp(-t / tau), for any step") {
    const rod::RodModel rod = shell();
    const Model m = modelOf({"viscoelastic_bending:law=standard_linear_solid", "viscoelastic_bending:branch_over_B=0.4",
                             "viscoelastic_bending:tau_s=0.3"});
    for (const int n : {1, 7}) {
        Material material = makeMaterial(rod, m.material);
        EffectEnergies energies{};
        Eigen::VectorXd q = Eigen::VectorXd::Zero(rod.dofs()), q1 = q;
        q1.setConstant(10.0);
        advance(rod, q, q1, 1e-9, material, energies); // a jump
        for (int i = 0; i < n; ++i)
            advance(rod, q1, q1, 0.6 / n, material, energies);
        CHECK(material.overstress[0][0] == Approx(10.0 * std::exp(-2.0)).epsilon(1e-6));
    }
}

TEST_CASE("yield follows the bilinear curve, and unloading is elastic") {
    const rod::RodModel rod = shell(1);
    const Model m = modelOf({"plasticity:My_over_B_1_m=22", "plasticity:H_over_B=0.35"});
    Material material = makeMaterial(rod, m.material);
    EffectEnergies energies{};
    Eigen::VectorXd q = Eigen::VectorXd::Constant(rod.dofs(), 52.0), q1 = q;
    q1[rod.dofOfElement(0)] = 52.0 + 62.0;
    const double B = rod.definition().bendingModulus;
    // Beyond yield the slope is B H / (B + H) = B 0.35 / 1.35.
    CHECK(materialResponse(rod, material, 0, 52.0, 114.0, 1.0).moment / B ==
          Approx(22.0 + 40.0 * 0.35 / 1.35).epsilon(1e-9));
    advance(rod, q, q1, 1.0, material, energies);
    const double top = 22.0 + 40.0 * 0.35 / 1.35;
    CHECK(materialResponse(rod, material, 0, 114.0, 104.0, 1.0).moment / B == Approx(top - 10.0).epsilon(1e-9));
    CHECK(material.plastic[0] == Approx(62.0 - top).epsilon(1e-9));
}

TEST_CASE("what yields ends on the yield surface, for every elastic law and both kinds of hardening") {
    constexpr double kYield = 22.0, kHardening = 0.35;
    const rod::RodModel rod = shell(1);
    const double B = rod.definition().bendingModulus;
    for (const bool kinematic : {false, true})
        for (const ElasticModel& elastic : {ElasticModel{}, ElasticModel{ElasticModel::Law::Softening, 40.0, 3.0},
                                            ElasticModel{ElasticModel::Law::Stiffening, 60.0, 3.0},
                                            ElasticModel{ElasticModel::Law::RambergOsgood, 40.0, 5.0}})
            for (const double plastic : {-300.0, -200.0, -20.0, 0.0, 90.0, 200.0, 300.0})
                for (int step = -16; step <= 16; ++step) { // 200 after 200 is a reversal through zero elastic strain
                    const double u = 25.0 * step;
                    Material material = makeMaterial(
                        rod, modelOf({"plasticity:My_over_B_1_m=22", "plasticity:H_over_B=0.35"}).material);
                    material.model.elastic = elastic;
                    material.model.kinematic = kinematic;
                    material.plastic[0] = plastic;
                    material.hardened[0] = std::abs(plastic);
                    const MaterialResponse r = springResponse(rod, material, 0, 52.0 + u, 0.0);
                    INFO((kinematic ? "kinematic" : "isotropic")
                         << ", law " << static_cast<int>(elastic.law) << ", " << u << " after " << plastic);
                    const double s = r.plastic < plastic ? -1.0 : 1.0;
                    const auto excess = [&](double d) {
                        const double strain = u - plastic - s * d;
                        return s * evaluate(elastic, strain).value -
                               kHardening * (kinematic ? s * plastic + d : std::abs(plastic) + d) - kYield;
                    };
                    if (r.plastic == plastic) { // neither side yields
                        const double stress =
                            evaluate(elastic, u - plastic).value - (kinematic ? kHardening * plastic : 0.0);
                        CHECK(std::abs(stress) <= kYield + (kinematic ? 0.0 : kHardening * std::abs(plastic)) + 1e-9);
                        continue;
                    }
                    double low = 0.0, high = 1.0;
                    while (excess(high) > 0.0)
                        high *= 2.0;
                    for (int i = 0; i < 100; ++i)
                        (excess(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
                    CHECK(s * (r.plastic - plastic) == Approx(low).margin(1e-8));
                    CHECK(r.hardened - std::abs(plastic) == Approx(low).margin(1e-8));
                    CHECK(std::abs(excess(s * (r.plastic - plastic))) <= 1e-10 * kYield);
                    CHECK(r.moment / B == Approx(evaluate(elastic, u - r.plastic).value).epsilon(1e-12));
                }
}

TEST_CASE("adhesion: force is the derivative of its energy, slope of its force") {
    for (const AdhesionModel::Law law : {AdhesionModel::Law::Hump, AdhesionModel::Law::Decaying}) {
        const AdhesionModel m{law, 36.0, 1.2e-4, 0.0};
        for (const double gap : {1e-6, 3e-5, 4e-5, 9e-5, 1.19e-4}) {
            const double d = 1e-9;
            CHECK((adhesionAt(m, gap + d).energy - adhesionAt(m, gap - d).energy) / (2.0 * d) ==
                  Approx(adhesionAt(m, gap).force).epsilon(1e-4).margin(1e-6));
            CHECK((adhesionAt(m, gap + d).force - adhesionAt(m, gap - d).force) / (2.0 * d) ==
                  Approx(adhesionAt(m, gap).slope).epsilon(1e-4).margin(1e-3));
        }
        CHECK(adhesionAt(m, 1.3e-4).force == 0.0);
        CHECK(adhesionAt(m, 1.3e-4).energy == 0.0);
    }
    // Largest at a third of the range, where it is the parameter.
    CHECK(adhesionAt({AdhesionModel::Law::Hump, 36.0, 1.2e-4, 0.0}, 4e-5).force == Approx(36.0));
}

TEST_CASE("friction weakens with slip over Dc and heals with time over tau, exactly, for any step") {
    FrictionModel m;
    m.staticRatio = 1.45;
    m.slipWeakening = 2.5e-4;
    m.healing = 3.0;
    CHECK(frictionFactor(m, Site{}, 0.0, 1.0) == 1.45); // fresh
    for (const int n : {1, 10}) {
        Site site;
        for (int i = 0; i < n; ++i)
            advance(m, site, 1e-2, 0.05 / n); // two Dc, much faster than healing
        const double v = 1e-2 / 2.5e-4 + 1.0 / 3.0, rest = (1.0 / 3.0) / v;
        CHECK(1.0 - site.weakened == Approx(rest + (1.0 - rest) * std::exp(-0.05 * v)).epsilon(1e-9));
        const double before = site.weakened;
        for (int i = 0; i < n; ++i)
            advance(m, site, 0.0, 6.0 / n);
        CHECK(site.weakened == Approx(before * std::exp(-2.0)).epsilon(1e-9));
    }
    // Slow limit of the rate laws: the declared coefficient.
    for (const FrictionModel::Rate law :
         {FrictionModel::Rate::Stribeck, FrictionModel::Rate::Logarithmic, FrictionModel::Rate::Viscous}) {
        FrictionModel rate;
        rate.rate = law;
        rate.rateStrength = -0.3;
        CHECK(frictionFactor(rate, Site{}, 1e-9, 1.0) == Approx(1.0).margin(1e-6));
    }
}

TEST_CASE("a drive with backlash loses its width once at each reversal") {
    const DriveMotion head = motionBehindBacklash({{0.0, 1.0, 2.0}, {0.0, 1e-3, 0.0}}, 1e-4);
    CHECK(head.displacement.back() == Approx(1e-4));
    CHECK(*std::max_element(head.displacement.begin(), head.displacement.end()) == Approx(1e-3));
    const DriveMotion same = motionBehindBacklash({{0.0, 1.0, 2.0}, {0.0, 1e-3, 0.0}}, 0.0);
    CHECK(same.displacement == std::vector<double>{0.0, 1e-3, 0.0});
}

TEST_CASE("the sensor chain: drift, gain and lag in closed form") {
    SensorModel m;
    m.drift = 0.016;
    m.driftTime = 20.0;
    m.gain = 0.1;
    SensorChain a(m);
    a.read(5.0, 0.0);
    CHECK(a.read(25.0, 2.0) == Approx(2.2 + 0.016 * (1.0 - std::exp(-1.0))).epsilon(1e-12));
    SensorModel slow;
    slow.lag = 0.5;
    SensorChain b(slow);
    b.read(0.0, 0.0);
    for (int i = 1; i <= 10; ++i) // a ramp of 1 N/s lags behind by 0.5 s (1 - exp(-t / 0.5))
        CHECK(b.read(0.1 * i, 0.1 * i) == Approx(0.1 * i - 0.5 * (1.0 - std::exp(-0.2 * i))).epsilon(1e-9));
}
