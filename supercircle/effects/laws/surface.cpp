#include "supercircle/effects/surface.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::effects {

namespace {

constexpr int kSitesPerElement = 4;
constexpr double kMinFriction = 0.01; ///< of the declared coefficient

/// Exact answer of dw/dt = (1 - w) / tau - w v / Dc to a steady v, for 1 - w.
double weakenedAfter(const FrictionModel& m, double weakened, double speed, double dt) {
    const double heal = 1.0 / m.healing, wear = speed / m.slipWeakening;
    const double end = wear / (heal + wear);
    return end + (weakened - end) * math::exp(-dt * (heal + wear));
}

/// Exact answer of theta to a steady speed v over dt: dtheta/dt = 1 - v theta / Dc, or with x = v theta / Dc of the
/// slip law d ln x / dt = -v / Dc ln x.
double agedAfter(const FrictionModel& m, double age, double speed, double dt) {
    const double slips = speed * dt / m.stateSlip; // 1
    if (m.stateBySlip) {
        if (!(slips > 1e-300)) // Dc over the speed would be infinite
            return age;
        const double steady = m.stateSlip / speed;
        return steady * math::pow(age / steady, math::exp(-slips));
    }
    const double grown = slips > 1e-8 ? -math::expm1(-slips) / slips : 1.0 - 0.5 * slips;
    return age * math::exp(-slips) + dt * grown;
}

double rateAndStateFactor(const FrictionModel& m, double age, double speed) {
    return 1.0 + m.direct * math::log((speed + m.stateCreep) / m.stateSpeed) +
           m.evolution * math::log(std::max(age, 1e-12) * m.stateSpeed / m.stateSlip);
}

/// @param slip over the distance of the law
double wearFactor(const FrictionModel& m, double slip) {
    switch (m.wear) {
    case FrictionModel::Wear::Exponential:
        return 1.0 - m.wearChange * math::expm1(-slip);
    case FrictionModel::Wear::Learned:
        return 1.0 + m.wearChange * evaluateSpline(m.wearCurve, slip).value;
    case FrictionModel::Wear::Table:
        return 1.0 + m.wearChange * evaluateTable(m.wearTable, slip).value;
    }
    return 1.0;
}

double rateFactor(const FrictionModel& m, double speed) {
    const double x = speed / m.rateSpeed;
    switch (m.rate) {
    case FrictionModel::Rate::Stribeck:
        return 1.0 - m.rateStrength * math::expm1(-x);
    case FrictionModel::Rate::Logarithmic:
        return 1.0 + m.rateStrength * math::log1p(x);
    case FrictionModel::Rate::Viscous:
        return 1.0 + m.rateStrength * x;
    case FrictionModel::Rate::Learned: {
        constexpr double kDecades = 4.0;
        const double at = 0.5 + math::log10(std::max(x, 1e-9)) / kDecades;
        return 1.0 + m.rateStrength * evaluateSpline(m.rateCurve, at).value;
    }
    case FrictionModel::Rate::Table:
        return 1.0 +
               m.rateStrength * evaluateTable(m.rateTable, 0.5 + math::log10(std::max(x, 1e-9)) / kTableDecades).value;
    }
    return 1.0;
}

} // namespace

Surface makeSurface(const rod::RodModel& rod, const ContactModel& model) {
    Surface s;
    s.model = model;
    if (!model.friction.on())
        return s;
    const auto n = static_cast<std::size_t>(kSitesPerElement * rod.elements());
    s.spacing = rod.definition().length / static_cast<double>(n);
    s.sites.resize(n + 1);
    applyLongRest(s);
    return s;
}

void applyLongRest(Surface& s) {
    for (Site& site : s.sites) {
        site.weakened = 0.0;
        site.speed = 0.0;
        site.age = s.model.friction.stateRest;
    }
}

std::size_t siteAt(const Surface& surface, double s) {
    const double last = static_cast<double>(surface.sites.size() - 1);
    return static_cast<std::size_t>(std::clamp(std::round(s / surface.spacing), 0.0, last));
}

double frictionFactor(const FrictionModel& m, const Site& site, double speed, double dt) {
    double factor = 1.0;
    if (m.staticRatio != 1.0)
        factor *= 1.0 + (m.staticRatio - 1.0) * (1.0 - weakenedAfter(m, site.weakened, speed, dt));
    if (m.rateStrength != 0.0)
        factor *= rateFactor(m, speed);
    if (m.rateAndState())
        factor *= rateAndStateFactor(m, agedAfter(m, site.age, speed, dt), speed);
    if (m.wearChange != 0.0) {
        const double slip = (site.slid + dt * speed) / m.wearDistance;
        factor *= wearFactor(m, slip);
    }
    return std::max(kMinFriction, factor);
}

void advance(const FrictionModel& m, Site& site, double speed, double dt) {
    if (m.staticRatio != 1.0)
        site.weakened = weakenedAfter(m, site.weakened, speed, dt);
    if (m.rateAndState())
        site.age = agedAfter(m, site.age, speed, dt);
    site.slid += dt * speed;
    site.speed = speed;
}

} // namespace supercircle::effects
