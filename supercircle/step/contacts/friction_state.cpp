#include "supercircle/step/contacts/friction_state.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace supercircle::step {

namespace {

constexpr double kOfFriction = 1e-3; ///< of a friction factor

bool anySurface(const World& world) {
    return std::any_of(world.rods.begin(), world.rods.end(), [](const Rod& r) { return r.effects.surface.on(); });
}

/// Speed of slip as last solved, m/s.
double slipOf(const std::vector<RodWork>& rods, double dt, const ContactStage& stage, std::size_t i) {
    SC_ASSERT(i < stage.work.size() && stage.work.size() == stage.candidates.size(), "one work space a candidate");
    const ContactWork& k = stage.work[i];
    double u = k.Ja.row(1).dot(rods[static_cast<std::size_t>(k.rodA)].v);
    if (k.rodB >= 0) {
        u -= k.Jb.row(1).dot(rods[static_cast<std::size_t>(k.rodB)].v);
    } else {
        const BodyMotion& m = stage.host.motion[static_cast<std::size_t>(k.bodyB)];
        u -= rod::perp(stage.candidates[i].normal).dot(m.velocity + m.spin * rod::perp(k.armB));
    }
    if (k.give.y() > 0.0) // what the contact's spring takes is no slip
        u += (k.give.y() * stage.r[static_cast<Eigen::Index>(2 * i + 1)] / dt - k.tangentialDeflection) / dt;
    return std::abs(u);
}

/// The sides of a contact whose surfaces have a memory.
template <class Do>
void forSides(const World& world, const contact::Candidate& c, Do&& act) {
    for (const contact::RodPoint* p : {&c.a, &c.b})
        if (p->rod >= 0) {
            const effects::Surface& s = world.rods[static_cast<std::size_t>(p->rod)].effects.surface;
            if (s.on())
                act(static_cast<std::size_t>(p->rod), s, effects::siteAt(s, p->s));
        }
}

/// Mean over the sides.
double factorAt(const World& world, const contact::Candidate& c, double slip, double dt) {
    double sum = 0.0;
    int count = 0;
    forSides(world, c, [&](std::size_t, const effects::Surface& s, std::size_t site) {
        sum += effects::frictionFactor(s.model.friction, s.sites[site], slip, dt);
        ++count;
    });
    return count > 0 ? sum / count : 1.0;
}

/// Whether a side's friction grows with the speed of slip.
bool grows(const World& world, const contact::Candidate& c) {
    bool any = false;
    forSides(world, c, [&](std::size_t, const effects::Surface& s, std::size_t) {
        const effects::FrictionModel& m = s.model.friction;
        any = any || m.rateStrength > 0.0 || m.direct > 0.0;
    });
    return any;
}

/// The next factor to try after `factor`, at which the law asks for `wanted`.
double nextFactor(FactorBounds& b, double factor, double wanted, bool& bracketed) {
    const double excess = wanted - factor;
    if (excess > 0.0) {
        b.atHigh *= b.last > 0 ? 0.5 : 1.0; // Illinois: the end that stays loses half of its weight
        b.low = factor;
        b.atLow = excess;
        b.last = 1;
    } else {
        b.atLow *= b.last < 0 ? 0.5 : 1.0;
        b.high = factor;
        b.atHigh = excess;
        b.last = -1;
    }
    SC_ASSERT(!(b.atLow < 0.0) && !(b.atHigh > 0.0), "too small below, too large above");
    bracketed = b.atLow > 0.0 && b.atHigh < 0.0;
    return bracketed ? b.low + (b.high - b.low) * b.atLow / (b.atLow - b.atHigh) : wanted;
}

} // namespace

double factorAtRest(const World& world, const contact::Candidate& c, double dt) {
    return factorAt(world, c, 0.0, dt);
}

bool refineFriction(const World& world, const std::vector<RodWork>& rods, double dt, ContactStage& stage) {
    if (!anySurface(world))
        return false;
    constexpr double kShare = 0.3; // of the tolerance: what the next linearisation changes has room
    bool any = false;
    for (std::size_t i = 0; i < stage.candidates.size(); ++i) {
        const contact::Candidate& c = stage.candidates[i];
        if (!(stage.r[static_cast<Eigen::Index>(2 * i)] > 0.0) || !grows(world, c))
            continue;
        ContactWork& k = stage.work[i];
        const double slip = slipOf(rods, dt, stage, i), wanted = factorAt(world, c, slip, dt);
        stage.slips[c.id] = k.slip = slip;
        if (std::abs(wanted - k.friction) <= kShare * kOfFriction * k.friction)
            continue;
        bool bracketed = false;
        const double next = nextFactor(k.bounds, k.friction, wanted, bracketed);
        if (bracketed && k.bounds.high - k.bounds.low <= 0.1 * kShare * kOfFriction * k.friction)
            continue; // as near as it comes
        stage.problem.contacts[i].mu *= next / k.friction;
        k.friction = next;
        any = true;
    }
    return any;
}

void applyFrictionState(const World& world, const std::vector<RodWork>& rods, double dt, bool again,
                        ContactStage& stage) {
    if (!anySurface(world))
        return;
    std::map<std::uint64_t, double> known;
    std::swap(known, stage.slips);
    for (std::size_t i = 0; i < stage.candidates.size(); ++i) {
        const contact::Candidate& c = stage.candidates[i];
        double slip = 0.0;
        if (const auto it = known.find(c.id); again && it != known.end())
            slip = 0.5 * (it->second + slipOf(rods, dt, stage, i));
        else if (again)
            slip = slipOf(rods, dt, stage, i);
        else
            forSides(world, c, [&](std::size_t, const effects::Surface& s, std::size_t site) {
                slip = std::max(slip, s.sites[site].speed);
            });
        stage.slips[c.id] = slip;
        stage.work[i].slip = slip;
        stage.work[i].friction = factorAt(world, c, slip, dt);
        stage.work[i].bounds = {};
        stage.problem.contacts[i].mu *= stage.work[i].friction;
    }
}

double frictionError(const World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage) {
    if (!anySurface(world))
        return 0.0;
    double worst = 0.0;
    for (std::size_t i = 0; i < stage.candidates.size(); ++i)
        if (stage.r[static_cast<Eigen::Index>(2 * i)] > 0.0) {
            const double now = factorAt(world, stage.candidates[i], slipOf(rods, dt, stage, i), dt);
            worst = std::max(worst, std::abs(now - stage.work[i].friction) / (kOfFriction * stage.work[i].friction));
        }
    return worst;
}

void advanceSurfaces(World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage) {
    if (!anySurface(world))
        return;
    std::vector<std::vector<double>> speeds(world.rods.size());
    for (std::size_t i = 0; i < speeds.size(); ++i)
        speeds[i].assign(world.rods[i].effects.surface.sites.size(), 0.0);
    for (std::size_t i = 0; i < stage.candidates.size(); ++i)
        if (stage.r[static_cast<Eigen::Index>(2 * i)] > 0.0) {
            const double slip = slipOf(rods, dt, stage, i);
            forSides(world, stage.candidates[i], [&](std::size_t rod, const effects::Surface&, std::size_t site) {
                speeds[rod][site] = std::max(speeds[rod][site], slip);
            });
        }
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        effects::Surface& s = world.rods[i].effects.surface;
        for (std::size_t k = 0; k < s.sites.size(); ++k)
            effects::advance(s.model.friction, s.sites[k], speeds[i][k], dt);
    }
}

} // namespace supercircle::step
