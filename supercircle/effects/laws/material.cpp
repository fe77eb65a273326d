#include "supercircle/effects/laws/material.h"

#include "supercircle/effects/laws/elastic_law.h"
#include "supercircle/rod/elasticity.h"
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
    // Decreases strictly with d and is negative when neither the elastic part nor the back stress points along the
    // flow: in a reversal the back stress drives it on after the elastic part has vanished.
    double low = 0.0, high = std::max(std::abs(u - plastic), back > 0.0 ? -s * plastic : 0.0) + 1e-9;
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

/// What the springs of an element answer with at a curvature.
struct SpringState {
    double factor;            ///< of the section
    double strain;            ///< elastic, u, 1/m
    ElasticResponse law;      ///< at this strain
    double plastic, hardened; ///< at the end, 1/m
    double elastic;           ///< du / dkappa: 1, less where it yields
    double moment, tangent;   ///< over B
};

SpringState springs(const rod::RodModel& rod, const Material& m, int element, double curvature, double left) {
    const auto e = static_cast<std::size_t>(element);
    const Section& section = m.cumulativeSections.back();
    const double stiffness = left * section.factor[e];
    const double u = curvature - naturalCurvature(rod, element) - section.curvature[e];
    const YieldResult y = yieldStep(m.model, stiffness, u, m.plastic[e], m.hardened[e]);
    const ElasticResponse g = evaluate(m.model.elastic, u - y.plastic);
    const double tangent = stiffness * g.slope;
    const double elastic = y.increment > 0.0 ? m.model.hardening / (tangent + m.model.hardening) : 1.0;
    return {section.factor[e],   u - y.plastic,    g, y.plastic, y.hardened, elastic,
            stiffness * g.value, tangent * elastic};
}

/// The energy of a pair is -1/2 c B left / f (N_j - N_i) (U_j - U_i) with U = f_e u, N = f_e g(u) and f the mean of
/// both factors f_e: for any law and any section what a moment that varies linearly leaves of -1/2 c B (u_j - u_i)^2.
/// Only elastic strains count: where it yields the arcs stay by themselves.
NeighbourResponse pairOf(const SpringState& b, const SpringState& a, double weight) {
    const double k = 2.0 * weight / (a.factor + b.factor);
    const double U = a.factor * a.strain - b.factor * b.strain, N = a.factor * a.law.value - b.factor * b.law.value;
    NeighbourResponse out;
    out.forceAfter = 0.5 * k * a.factor * (a.law.slope * U + N);
    out.forceBefore = -0.5 * k * b.factor * (b.law.slope * U + N);
    out.ownAfter = k * a.factor * a.factor * a.law.slope * a.elastic;
    out.ownBefore = k * b.factor * b.factor * b.law.slope * b.elastic;
    out.cross = -0.5 * k * a.factor * b.factor * (a.law.slope + b.law.slope) * std::min(a.elastic, b.elastic);
    return out;
}

/// Which effects count in an energy.
struct Counted {
    std::size_t profiles; ///< the first ones
    bool plastic, law;
    double left; ///< of the stiffness
};

/// Energy of the springs with the effects that count, J.
double energyWith(const rod::RodModel& rod, const Material& m, const Eigen::VectorXd& q, const Counted& counted) {
    const Section& section = m.cumulativeSections[counted.profiles];
    const auto strain = [&](int i) {
        const auto e = static_cast<std::size_t>(i);
        return q[rod.dofOfElement(i)] - naturalCurvature(rod, i) - section.curvature[e] -
               (counted.plastic ? m.plastic[e] : 0.0);
    };
    const auto law = [&](double u) {
        return counted.law ? evaluate(m.model.elastic, u) : ElasticResponse{u, 1.0, 0.5 * u * u};
    };
    double sum = 0.0;
    for (int i = 0; i < rod.elements(); ++i) {
        const auto e = static_cast<std::size_t>(i);
        double line = counted.left * section.factor[e] * law(strain(i)).energy;
        if (counted.plastic && m.model.kinematic)
            line += 0.5 * m.model.hardening * m.plastic[e] * m.plastic[e];
        sum += rod.elementLength(i) * line;
    }
    rod::forNeighbours(rod, [&](int before, int after, double c) {
        const double a = section.factor[static_cast<std::size_t>(after)],
                     b = section.factor[static_cast<std::size_t>(before)];
        const double ua = strain(after), ub = strain(before);
        sum -= c * counted.left / (a + b) * (a * law(ua).value - b * law(ub).value) * (a * ua - b * ub);
    });
    return rod.definition().bendingModulus * sum;
}

/// Sum over the rod of a quadratic form of curvatures x (entries: elements), with what neighbours take out.
template <class Form>
double sumOf(const rod::RodModel& rod, const Form& form, const std::vector<double>& x, const std::vector<double>& y) {
    double sum = 0.0;
    for (int i = 0; i < rod.elements(); ++i)
        sum += rod.elementLength(i) * form(x[static_cast<std::size_t>(i)], y[static_cast<std::size_t>(i)]);
    rod::forNeighbours(rod, [&](int before, int after, double c) {
        const auto a = static_cast<std::size_t>(after), b = static_cast<std::size_t>(before);
        sum -= c * form(x[a] - x[b], y[a] - y[b]);
    });
    return rod.definition().bendingModulus * sum;
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

MaterialModel whileResting(MaterialModel model, ViscousMoments viscous) {
    constexpr double kForever = 1e9; // of the time that a rest takes over that in which the model changes
    model.viscosity *= viscous == ViscousMoments::Gone ? 0.0 : kForever;
    for (MaxwellBranch& branch : model.branches)
        if (viscous == ViscousMoments::Gone)
            branch.stiffness = 0.0;
        else
            branch.time *= kForever;
    return model;
}

MaterialResponse springResponse(const rod::RodModel& rod, const Material& m, int element, double curvature,
                                double ahead) {
    const double B = rod.definition().bendingModulus;
    const SpringState r = springs(rod, m, element, curvature, remaining(m.model, m.age + ahead));
    return {B * r.moment, B * r.tangent, r.plastic, r.hardened};
}

void springNeighbours(const rod::RodModel& rod, const Material& m, const Eigen::VectorXd& q, double ahead,
                      std::vector<NeighbourResponse>& out) {
    out.clear();
    const double B = rod.definition().bendingModulus, left = remaining(m.model, m.age + ahead);
    const auto at = [&](int element) { return springs(rod, m, element, q[rod.dofOfElement(element)], left); };
    SpringState last{};
    int known = -1; // each element is the first of one pair and the second of another
    rod::forNeighbours(rod, [&](int before, int after, double c) {
        const SpringState first = before == known ? last : at(before);
        last = at(known = after);
        out.push_back(pairOf(first, last, B * c * left));
        out.back().before = before;
        out.back().after = after;
    });
}

double springEnergy(const rod::RodModel& rod, const Material& m, const Eigen::VectorXd& q, double ahead) {
    return energyWith(rod, m, q, {m.model.profiles.size(), true, true, remaining(m.model, m.age + ahead)});
}

MaterialResponse materialResponse(const rod::RodModel& rod, const Material& m, int element, double before, double now,
                                  double dt) {
    const auto e = static_cast<std::size_t>(element);
    MaterialResponse r = springResponse(rod, m, element, now, dt);
    const double B = rod.definition().bendingModulus;
    r.moment += B * m.model.viscosity * (now - before) / dt;
    r.tangent += B * m.model.viscosity / dt;
    for (std::size_t b = 0; b < m.model.branches.size(); ++b) {
        const MaxwellBranch& branch = m.model.branches[b];
        r.moment += B * branch.stiffness * relaxed(branch, m.overstress[b][e], now - before, dt);
        r.tangent += B * branch.stiffness * meanDecay(dt / branch.time);
    }
    return r;
}

void addNeighbourStiffness(const rod::RodModel& rod, const std::vector<NeighbourResponse>& pairs, double factor,
                           Eigen::MatrixXd& matrix) {
    for (const NeighbourResponse& p : pairs) {
        const int b = rod.dofOfElement(p.before), a = rod.dofOfElement(p.after);
        matrix(b, b) -= factor * p.ownBefore;
        matrix(a, a) -= factor * p.ownAfter;
        matrix(a, b) -= factor * p.cross;
        matrix(b, a) -= factor * p.cross;
    }
}

void materialNeighbours(const rod::RodModel& rod, const Material& m, const Eigen::VectorXd& q,
                        const Eigen::VectorXd& q1, double dt, std::vector<NeighbourResponse>& out) {
    springNeighbours(rod, m, q1, dt, out);
    if (m.model.viscosity == 0.0 && m.model.branches.empty())
        return;
    double tangent = m.model.viscosity / dt;
    for (const MaxwellBranch& branch : m.model.branches)
        tangent += branch.stiffness * meanDecay(dt / branch.time);
    auto pair = out.begin();
    rod::forNeighbours(rod, [&](int before, int after, double c) {
        const auto a = static_cast<std::size_t>(after), b = static_cast<std::size_t>(before);
        const int da = rod.dofOfElement(after), db = rod.dofOfElement(before);
        const double change = (q1[da] - q[da]) - (q1[db] - q[db]);
        double moment = m.model.viscosity * change / dt;
        for (std::size_t k = 0; k < m.model.branches.size(); ++k)
            moment += m.model.branches[k].stiffness *
                      relaxed(m.model.branches[k], m.overstress[k][a] - m.overstress[k][b], change, dt);
        const double weight = rod.definition().bendingModulus * c;
        pair->forceAfter += weight * moment;
        pair->forceBefore -= weight * moment;
        pair->ownAfter += weight * tangent;
        pair->ownBefore += weight * tangent;
        pair->cross -= weight * tangent;
        ++pair;
    });
}

void storedEnergy(const rod::RodModel& rod, const Material& m, const Eigen::VectorXd& q, EffectEnergies& energies) {
    for (std::size_t k = 0; k <= static_cast<std::size_t>(Key::SofteningOverTime);
         ++k) // the keys of this slot come first
        energies[k].stored = 0.0;
    // By cause, each relative to the state without it.
    double last = rod::bendingEnergy(rod, q);
    const auto next = [&](Key cause, const Counted& counted) {
        const double energy = energyWith(rod, m, q, counted);
        energies[static_cast<std::size_t>(cause)].stored += energy - last;
        last = energy;
    };
    const std::size_t n = m.model.profiles.size();
    for (std::size_t k = 0; k < n; ++k)
        next(m.model.profiles[k].cause, {k + 1, false, false, 1.0});
    if (std::isfinite(m.model.yield))
        next(Key::Plasticity, {n, true, false, 1.0});
    if (m.model.elastic.law != ElasticModel::Law::Linear)
        next(Key::NonlinearElasticity, {n, true, true, 1.0});
    if (m.model.softening != 0.0)
        next(Key::SofteningOverTime, {n, true, true, remaining(m.model, m.age)});
    for (std::size_t b = 0; b < m.model.branches.size(); ++b)
        energies[static_cast<std::size_t>(Key::ViscoelasticBending)].stored += sumOf(
            rod, [&](double z, double) { return 0.5 * m.model.branches[b].stiffness * z * z; }, m.overstress[b],
            m.overstress[b]);
}

namespace {

/// Moves the plastic state over a step. Returns what it dissipates, J: the work of the yield moment, and what the pairs
/// give when the elastic strain of one side falls.
double yielded(const rod::RodModel& rod, Material& m, const Eigen::VectorXd& q, const Eigen::VectorXd& q1, double dt) {
    std::vector<NeighbourResponse> early, late;
    springNeighbours(rod, m, q, 0.0, early);
    springNeighbours(rod, m, q1, dt, late);
    const double widening = m.model.kinematic ? 0.0 : m.model.hardening;
    std::vector<double> flown(static_cast<std::size_t>(rod.elements()));
    double work = 0.0;
    for (int i = 0; i < rod.elements(); ++i) {
        const auto e = static_cast<std::size_t>(i);
        const MaterialResponse r = springResponse(rod, m, i, q1[rod.dofOfElement(i)], dt);
        const double slid = r.hardened - m.hardened[e];
        if (slid > 0.0)
            work += rod.definition().bendingModulus * rod.elementLength(i) * slid *
                    (m.model.yield + widening * (m.hardened[e] + 0.5 * slid));
        flown[e] = r.plastic - m.plastic[e];
        m.plastic[e] = r.plastic;
        m.hardened[e] = r.hardened;
    }
    for (std::size_t k = 0; k < late.size(); ++k)
        work -= 0.5 * ((early[k].forceBefore + late[k].forceBefore) * flown[static_cast<std::size_t>(late[k].before)] +
                       (early[k].forceAfter + late[k].forceAfter) * flown[static_cast<std::size_t>(late[k].after)]);
    return work;
}

} // namespace

void advance(const rod::RodModel& rod, const Eigen::VectorXd& q, const Eigen::VectorXd& q1, double dt, Material& m,
             EffectEnergies& energies) {
    const auto lose = [&](Key cause, double energy) { energies[static_cast<std::size_t>(cause)].dissipated += energy; };
    if (m.model.softening != 0.0) // the spring softens under load and loses its energy
        lose(Key::SofteningOverTime, springEnergy(rod, m, q, 0.0) - springEnergy(rod, m, q, dt));
    std::vector<double> change(static_cast<std::size_t>(rod.elements())); // of the curvatures
    for (int i = 0; i < rod.elements(); ++i)
        change[static_cast<std::size_t>(i)] = q1[rod.dofOfElement(i)] - q[rod.dofOfElement(i)];
    if (std::isfinite(m.model.yield))
        lose(Key::Plasticity, yielded(rod, m, q, q1, dt));
    if (m.model.viscosity != 0.0)
        lose(Key::ViscoelasticBending,
             sumOf(
                 rod, [&](double x, double) { return m.model.viscosity * x * x / dt; }, change, change));
    for (std::size_t b = 0; b < m.model.branches.size(); ++b) {
        const MaxwellBranch& branch = m.model.branches[b];
        std::vector<double>& overstress = m.overstress[b];
        lose(Key::ViscoelasticBending,
             sumOf(
                 rod, [&](double z, double x) { return branch.stiffness * dashpot(branch, z, x, dt); }, overstress,
                 change));
        for (std::size_t e = 0; e < overstress.size(); ++e)
            overstress[e] = relaxed(branch, overstress[e], change[e], dt);
    }
    m.age += dt;
    storedEnergy(rod, m, q1, energies);
}

} // namespace supercircle::effects
