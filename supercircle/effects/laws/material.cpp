#include "supercircle/effects/laws/material.h"

#include "supercircle/effects/laws/elastic_law.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::effects {

namespace {

/// Fraction of B that remains at an age.
double remaining(const MaterialModel& m, double age) {
    if (m.softening == 0.0)
        return 1.0;
    const double x = age / m.softeningTime;
    const double lost = m.softeningByDecades ? math::log10(1.0 + x) : -math::expm1(-x);
    return std::max(1e-3, 1.0 - m.softening * lost);
}

/// (1 - exp(-x)) / x
double meanDecay(double x) {
    return x > 1e-8 ? -math::expm1(-x) / x : 1.0 - 0.5 * x;
}

double naturalCurvature(const rod::RodModel& rod, int element) {
    return rod.definition().naturalCurvature[static_cast<std::size_t>(element)];
}

struct YieldResult {
    double plastic, hardened; ///< at the end, 1/m
    double increment;         ///< accumulated in the step, >= 0
};

/// Implicit return mapping: the plastic curvature at the end of the step. With s the side on which the trial state
/// leaves the elastic range, solves  s stiffness g(u - p - s d) - (back stress)  =  M_y / B + (hardening).
YieldResult yieldStep(const MaterialModel& m, double stiffness, double u, double plastic, double hardened) {
    YieldResult out{plastic, hardened, 0.0};
    if (!std::isfinite(m.yield))
        return out;
    const double back = m.kinematic ? m.hardening : 0.0, widening = m.kinematic ? 0.0 : m.hardening;
    const auto excess = [&](double s, double d) {
        const double stress = stiffness * evaluate(m.elastic, u - plastic - s * d).value - back * (plastic + s * d);
        return s * stress - m.yield - widening * (hardened + d);
    };
    const double s = stiffness * evaluate(m.elastic, u - plastic).value - back * plastic > 0.0 ? 1.0 : -1.0;
    if (excess(s, 0.0) <= 0.0)
        return out;
    // Decreases strictly with d and is negative when the elastic part vanishes.
    double low = 0.0, high = std::abs(u - plastic) + 1e-9;
    double d = excess(s, 0.0) / (stiffness + m.hardening); // exact for a linear elastic law
    for (int i = 0; i < 80; ++i) {
        const double value = excess(s, d);
        if (std::abs(value) <= 1e-12 * (m.yield + std::abs(u)))
            break;
        (value > 0.0 ? low : high) = d;
        const double slope = stiffness * evaluate(m.elastic, u - plastic - s * d).slope + m.hardening;
        d += value / slope;
        if (!(d > low && d < high))
            d = 0.5 * (low + high);
    }
    return {plastic + s * d, hardened + d, d};
}

/// Moment and tangent over B of the springs and the yielding, `ahead` s from now.
MaterialResponse springs(const rod::RodModel& rod, const Material& m, int element, double curvature, double ahead) {
    const auto e = static_cast<std::size_t>(element);
    const Section& section = m.cumulativeSections.back();
    const double stiffness = remaining(m.model, m.age + ahead) * section.factor[e];
    const double u = curvature - naturalCurvature(rod, element) - section.curvature[e];
    const YieldResult y = yieldStep(m.model, stiffness, u, m.plastic[e], m.hardened[e]);
    const ElasticResponse g = evaluate(m.model.elastic, u - y.plastic);
    double moment = stiffness * g.value, tangent = stiffness * g.slope;
    if (y.increment > 0.0)
        tangent *= m.model.hardening / (tangent + m.model.hardening);
    return {moment, tangent, y.plastic, y.hardened};
}

/// Of kinematic hardening, J/m without the factor B.
double backEnergy(const Material& m, std::size_t e) {
    return m.model.kinematic ? 0.5 * m.model.hardening * m.plastic[e] * m.plastic[e] : 0.0;
}

/// Energies by cause, each relative to the state without it: J/m without the factor B.
template <class Add>
void storedLine(const rod::RodModel& rod, const Material& m, std::size_t e, double kappa, Add&& add) {
    const double strain = kappa - naturalCurvature(rod, static_cast<int>(e));
    double last = 0.5 * strain * strain;
    const auto next = [&](Key cause, double energy) {
        if (energy != last)
            add(cause, energy - last);
        last = energy;
    };
    for (std::size_t k = 0; k + 1 < m.cumulativeSections.size(); ++k) {
        const Section& s = m.cumulativeSections[k + 1];
        const double u = strain - s.curvature[e];
        next(m.model.profiles[k].cause, 0.5 * s.factor[e] * u * u);
    }
    const Section& section = m.cumulativeSections.back();
    const double u = strain - section.curvature[e] - m.plastic[e];
    const double back = backEnergy(m, e);
    next(Key::Plasticity, 0.5 * section.factor[e] * u * u + back);
    const double energy = evaluate(m.model.elastic, u).energy;
    next(Key::NonlinearElasticity, section.factor[e] * energy + back);
    next(Key::SofteningOverTime, remaining(m.model, m.age) * section.factor[e] * energy + back);
    for (std::size_t b = 0; b < m.model.branches.size(); ++b)
        add(Key::ViscoelasticBending, 0.5 * m.model.branches[b].stiffness * m.overstress[b][e] * m.overstress[b][e]);
}

/// Overstress of a Maxwell branch at the end of a step of steady rate.
double relaxed(const MaxwellBranch& branch, double overstress, double change, double dt) {
    const double x = dt / branch.time;
    return overstress * math::exp(-x) + change * meanDecay(x);
}

/// Integral of overstress^2 / time over the step: dissipation of the branch's dashpot, per stiffness.
double dashpot(const MaxwellBranch& branch, double overstress, double change, double dt) {
    const double x = dt / branch.time, a = change / x, b = overstress - a; // a + b exp(-t/time)
    if (x < 1e-4) // avoids cancellation; to first order in x the overstress is linear
        return x * (overstress * overstress + overstress * change + change * change / 3.0);
    return a * a * x - 2.0 * a * b * math::expm1(-x) - 0.5 * b * b * math::expm1(-2.0 * x);
}

} // namespace

bool MaterialModel::on() const {
    return !profiles.empty() || elastic.law != ElasticModel::Law::Linear || viscosity > 0.0 || !branches.empty() ||
           std::isfinite(yield) || softening != 0.0;
}

Material makeMaterial(const rod::RodModel& rod, const MaterialModel& model) {
    Material m;
    m.model = model;
    if (!model.on())
        return m;
    for (std::size_t k = 0; k <= model.profiles.size(); ++k)
        m.cumulativeSections.push_back(sections(rod, model.profiles, k));
    const auto n = static_cast<std::size_t>(rod.elements());
    m.plastic.assign(n, 0.0);
    m.hardened.assign(n, 0.0);
    m.overstress.assign(model.branches.size(), std::vector<double>(n, 0.0));
    return m;
}

void applyLongRest(Material& m) {
    m.age = 0.0;
    for (auto& branch : m.overstress)
        std::fill(branch.begin(), branch.end(), 0.0);
}

MaterialResponse springResponse(const rod::RodModel& rod, const Material& m, int element, double curvature,
                                double ahead) {
    const double B = rod.definition().bendingModulus;
    MaterialResponse r = springs(rod, m, element, curvature, ahead);
    r.moment *= B;
    r.tangent *= B;
    return r;
}

double springEnergy(const rod::RodModel& rod, const Material& m, const Eigen::VectorXd& q, double ahead) {
    const double B = rod.definition().bendingModulus, left = remaining(m.model, m.age + ahead);
    const Section& section = m.cumulativeSections.back();
    double sum = 0.0;
    for (int i = 0; i < rod.elements(); ++i) {
        const auto e = static_cast<std::size_t>(i);
        const double u = q[rod.dofOfElement(i)] - naturalCurvature(rod, i) - section.curvature[e] - m.plastic[e];
        sum +=
            rod.elementLength(i) * (left * section.factor[e] * evaluate(m.model.elastic, u).energy + backEnergy(m, e));
    }
    return B * sum;
}

MaterialResponse materialResponse(const rod::RodModel& rod, const Material& m, int element, double before, double now,
                                  double dt) {
    const auto e = static_cast<std::size_t>(element);
    const double B = rod.definition().bendingModulus;
    auto [moment, tangent, plastic, hardened] = springs(rod, m, element, now, dt);
    moment += m.model.viscosity * (now - before) / dt;
    tangent += m.model.viscosity / dt;
    for (std::size_t b = 0; b < m.model.branches.size(); ++b) {
        const MaxwellBranch& branch = m.model.branches[b];
        moment += branch.stiffness * relaxed(branch, m.overstress[b][e], now - before, dt);
        tangent += branch.stiffness * meanDecay(dt / branch.time);
    }
    return {B * moment, B * tangent, plastic, hardened};
}

void storedEnergy(const rod::RodModel& rod, const Material& m, const Eigen::VectorXd& q, EffectEnergies& energies) {
    for (std::size_t k = 0; k <= static_cast<std::size_t>(Key::SofteningOverTime);
         ++k) // the keys of this slot come first
        energies[k].stored = 0.0;
    const double B = rod.definition().bendingModulus;
    for (int e = 0; e < rod.elements(); ++e)
        storedLine(rod, m, static_cast<std::size_t>(e), q[rod.dofOfElement(e)], [&](Key cause, double energy) {
            energies[static_cast<std::size_t>(cause)].stored += B * rod.elementLength(e) * energy;
        });
}

void advance(const rod::RodModel& rod, const Eigen::VectorXd& q, const Eigen::VectorXd& q1, double dt, Material& m,
             EffectEnergies& energies) {
    const double B = rod.definition().bendingModulus;
    const Section& section = m.cumulativeSections.back();
    const double lost = remaining(m.model, m.age) - remaining(m.model, m.age + dt);
    for (int i = 0; i < rod.elements(); ++i) {
        const auto e = static_cast<std::size_t>(i);
        const int dof = rod.dofOfElement(i);
        const double before = q[dof], now = q1[dof], change = now - before, weight = B * rod.elementLength(i);
        const auto lose = [&](Key cause, double energy) {
            energies[static_cast<std::size_t>(cause)].dissipated += weight * energy;
        };
        const double u0 = before - naturalCurvature(rod, i) - section.curvature[e] - m.plastic[e];
        if (lost != 0.0) // the spring softens under load and loses its energy
            lose(Key::SofteningOverTime, lost * section.factor[e] * evaluate(m.model.elastic, u0).energy);
        const MaterialResponse r = materialResponse(rod, m, i, before, now, dt);
        const double slid = r.hardened - m.hardened[e];
        lose(Key::Plasticity, slid > 0.0 ? slid * (m.model.yield + (m.model.kinematic ? 0.0 : m.model.hardening) *
                                                                       (m.hardened[e] + 0.5 * slid))
                                         : 0.0);
        m.plastic[e] = r.plastic;
        m.hardened[e] = r.hardened;
        lose(Key::ViscoelasticBending, m.model.viscosity * change * change / dt);
        for (std::size_t b = 0; b < m.model.branches.size(); ++b) {
            const MaxwellBranch& branch = m.model.branches[b];
            lose(Key::ViscoelasticBending, branch.stiffness * dashpot(branch, m.overstress[b][e], change, dt));
            m.overstress[b][e] = relaxed(branch, m.overstress[b][e], change, dt);
        }
    }
    m.age += dt;
    storedEnergy(rod, m, q1, energies);
}

} // namespace supercircle::effects
