#include "supercircle/step/second_order.h"

#include "supercircle/step/contact_memory.h"
#include "supercircle/step/contacts/link_rows.h"
#include "supercircle/step/rods/free_motion.h"
#include "supercircle/step/rods/sdirk2.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace supercircle::step {

namespace {

/// Smaller errors are no reason for two more stages: of Settings::localError, in Settings::dtMax. Half of it changes no
/// rebound by more than 0.1 %, and makes stages for what nobody sees; twice as much takes 1 % of a rebound in games.
constexpr double kWorth = 0.02;
/// Smaller errors of first order, of Settings::localError, are no reason to cut a step that has to be of first order.
/// With half of it a ring rebounds 0.5 % higher and a slack strip that comes to rest on a drum costs twice as much;
/// with twice as much the rebound is 1 % lower in laboratory quality, 3 % in games.
constexpr double kAtChange = 0.05;
/// Energy that a step may gain, of Settings::freeError and what the rods move and bend with: the scheme takes energy
/// where it is linear, not where a shell turns fast. Half of it costs a tenth more steps of a shell that spins on a
/// floor; ten times as much lets its energy grow by 0.1 % a bounce.
constexpr double kGain = 1e-3;

/// Whether what touches a rod touches anything of the host: then a blow would pass through both laws at once.
bool touchHeldBody(const World& world, const TrialStep& t) {
    const HostConstraints& host = world.constraints;
    if (host.contacts.empty() && host.rows.empty())
        return false;
    std::vector<BodyId> held; // sorted
    for (const HostContact& c : host.contacts)
        held.insert(held.end(), {c.a, c.b});
    for (const HostRow& r : host.rows)
        held.insert(held.end(), {r.a, r.b});
    std::sort(held.begin(), held.end());
    return std::any_of(t.stage.candidates.begin(), t.stage.candidates.end(), [&](const contact::Candidate& c) {
        if (c.outline < 0)
            return false;
        const BodyId id = world.outlines[static_cast<std::size_t>(c.outline)].body;
        if (!std::binary_search(held.begin(), held.end(), id))
            return false;
        const int index = bodyIndex(world, id);
        return index >= 0 && world.bodies[static_cast<std::size_t>(index)].dynamic;
    });
}

/// Whether bodies have moved with rods: stages of the others do not know where they are.
bool anyBodyFree(const TrialStep& t) {
    return std::any_of(t.stage.host.motion.begin(), t.stage.host.motion.end(),
                       [](const BodyMotion& m) { return m.isFree; });
}

/// Whether all that acts can be extrapolated.
bool canBeMade(const World& world, const Settings& s, const TrialStep& t) {
    if (!s.secondOrder || s.fixedDt > 0.0 || t.stage.links.count > 0 || t.stage.pushes.count > 0 ||
        !t.stage.pulls.empty() || !world.overlaps.empty() || !world.crossheadVelocity.isZero(0.0))
        return false;
    int solved = 0;
    for (std::size_t i = 0; i < t.rods.size(); ++i) {
        const Rod& r = world.rods[i];
        if (!t.rods[i].solved())
            continue;
        ++solved;
        if (r.effects.on() || !mayMoveFreely(r) ||
            std::any_of(r.holds.begin(), r.holds.end(), [](const Hold& h) { return h.target.moving(); }))
            return false;
    }
    return solved > 0 && solved <= s.secondOrderRods && !anyBodyFree(t) && !touchHeldBody(world, t);
}

/// Error of a position in a step of `dt` s that is no reason for anything, m.
double least(const Settings& s, const Rod& r, double dt) {
    return kWorth * s.localError * lengthOf(r, s.length) * dt / s.dtMax;
}

bool isWorth(const World& world, const Settings& s, const TrialStep& t) {
    for (std::size_t i = 0; i < t.rods.size(); ++i)
        if (t.rods[i].solved() && t.rods[i].error > least(s, world.rods[i], t.dt))
            return true;
    return false;
}

/// How a contact that carries force does so: 0 stick, +-1 slip.
int statusOf(double normal, double tangent, double mu) {
    constexpr double kOnCone = 1e-6; // the solver's own tolerance; it puts what slips on the cone
    return std::abs(tangent) < (1.0 - kOnCone) * mu * normal || mu == 0.0 ? 0 : tangent > 0.0 ? 1 : -1;
}

/// Ids of what the host has in the problem: contacts and limits by their entry, and rows at their strength.
constexpr std::uint64_t kHostRow = std::uint64_t{3} << 62U;
std::uint64_t idOfEntry(int entry) {
    return (std::uint64_t{1} << 63U) + static_cast<std::uint32_t>(entry);
}

/// Contacts of a stage that carry force, those of the host too, and its rows at their strength.
void collectStatus(const TrialStep& stage, ContactStatuses& out) {
    out.clear();
    const ContactStage& c = stage.stage;
    const auto add = [&](std::uint64_t id, std::size_t contact) {
        if (const auto r = c.r.segment<2>(static_cast<Eigen::Index>(2 * contact)); r.x() > 0.0)
            out.emplace_back(id, statusOf(r.x(), r.y(), c.problem.contacts[contact].mu));
    };
    for (std::size_t i = 0; i < c.candidates.size(); ++i)
        add(c.candidates[i].id, i);
    for (std::size_t i = 0; i < c.host.entries.size() && !c.problem.contacts.empty(); ++i)
        add(idOfEntry(c.host.entries[i]), c.candidates.size() + c.links.count + i);
    for (std::size_t k = 0; k < c.host.saturated.size(); ++k)
        if (c.host.saturated[k] != 0)
            out.emplace_back(kHostRow + k, c.host.saturated[k]);
    std::sort(out.begin(), out.end());
}

/// The same of the step before, of what is in the problem of this one. False: something has opened meanwhile.
bool collectStatusBefore(const World& world, const TrialStep& stage, ContactStatuses& out) {
    out.clear();
    const ContactStage& c = stage.stage;
    for (std::size_t i = 0; i < c.candidates.size(); ++i)
        if (const ContactImpulse* f = findImpulse(world.impulses, c.candidates[i].id))
            out.emplace_back(f->id, statusOf(f->normal, f->tangent, c.problem.contacts[i].mu));
    const bool all = out.size() == world.impulses.size();
    const HostConstraints& host = world.constraints;
    for (std::size_t i = 0; i < c.host.entries.size() && !c.problem.contacts.empty(); ++i) {
        const int entry = c.host.entries[i];
        const Vec2 force = entry >= 0 ? Vec2(host.contacts[static_cast<std::size_t>(entry)].normalForce,
                                             host.contacts[static_cast<std::size_t>(entry)].tangentForce)
                                      : Vec2(host.rows[static_cast<std::size_t>(-1 - entry)].last, 0.0);
        if (force.x() > 0.0)
            out.emplace_back(
                idOfEntry(entry),
                statusOf(force.x(), force.y(), c.problem.contacts[c.candidates.size() + c.links.count + i].mu));
    }
    for (std::size_t k = 0; k < host.rows.size(); ++k)
        if (host.rows[k].saturated != 0)
            out.emplace_back(kHostRow + k, host.rows[k].saturated);
    std::sort(out.begin(), out.end());
    return all;
}

/// a + kExtrapolate (b - a), into b.
template <class T>
void extrapolate(const T& a, T& b) {
    b = a + kExtrapolate * (b - a);
}

void extrapolate(const EnergyBalance& a, EnergyBalance& b) {
    using Terms = std::array<double, sizeof(EnergyBalance) / sizeof(double)>;
    const auto from = std::bit_cast<Terms>(a);
    auto to = std::bit_cast<Terms>(b);
    for (std::size_t i = 0; i < to.size(); ++i)
        extrapolate(from[i], to[i]);
    b = std::bit_cast<EnergyBalance>(to);
}

void extrapolate(const Body& a, Body& b) {
    extrapolate(a.state.centre, b.state.centre);
    extrapolate(a.state.angle, b.state.angle);
    extrapolate(a.state.velocity, b.state.velocity);
    extrapolate(a.state.spin, b.state.spin);
    extrapolate(a.impulse, b.impulse);
    extrapolate(a.angularImpulse, b.angularImpulse);
    HostCoupling& h = b.hostCoupling;
    extrapolate(a.hostCoupling.coupledTime, h.coupledTime);
    extrapolate(a.hostCoupling.travel, h.travel);
    extrapolate(a.hostCoupling.turn, h.turn);
    extrapolate(a.hostCoupling.hostImpulse, h.hostImpulse);
    extrapolate(a.hostCoupling.hostTurnImpulse, h.hostTurnImpulse);
}

void extrapolate(const HostConstraints& a, HostConstraints& b) {
    for (std::size_t i = 0; i < b.contacts.size(); ++i) {
        HostContact& c = b.contacts[i];
        extrapolate(a.contacts[i].sumNormal, c.sumNormal);
        extrapolate(a.contacts[i].sumTangent, c.sumTangent);
        extrapolate(a.contacts[i].clearance, c.clearance);
        c.clearance = std::max(0.0, c.clearance);
    }
    for (std::size_t i = 0; i < b.rows.size(); ++i) {
        extrapolate(a.rows[i].sum, b.rows[i].sum);
        extrapolate(a.rows[i].clearance, b.rows[i].clearance);
        b.rows[i].clearance = std::max(0.0, b.rows[i].clearance);
    }
}

/// From the end of the first stage to the start of the second.
void toSecondStage(const World& start, const TrialStep& first, World& world) {
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        if (!first.rods[i].solved())
            continue;
        const Rod& from = start.rods[i];
        Rod& r = world.rods[i];
        Vec2 centre = rod::massCentre(r.kin, r.gauss);
        extrapolate(rod::massCentre(from.kin, from.gauss), centre);
        extrapolate(from.q, r.q);
        extrapolate(from.v, r.v);
        const double angle = meanAngle(from.model, from.kin);
        turnAbout(r.gauss, angle - meanAngle(r.model, r.kin), r.u); // a turn grows when it is extrapolated
        for (std::size_t g = 0; g < r.u.size(); ++g)
            extrapolate(from.u[g], r.u[g]);
        r.kin.evaluate(r.model, r.q);
        rod::evaluateGauss(r.model, r.kin, r.gauss);
        r.q.segment<2>(r.model.dofX()) += centre - rod::massCentre(r.kin, r.gauss); // so does a way on a circle
        r.kin.evaluate(r.model, r.q);
        rod::evaluateGauss(r.model, r.kin, r.gauss);
        turnAbout(r.gauss, meanAngle(r.model, r.kin) - angle, r.u);
        r.lastAccepted = r.q;
    }
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
        extrapolate(start.bodies[i], world.bodies[i]);
    extrapolate(start.constraints, world.constraints);
    extrapolate(start.energyBalance, world.energyBalance);
    world.range.clear(); // candidates are those of another configuration
    world.candidates.clear();
}

/// One stage. False: it is not to be used.
bool tryStage(const World& world, const Settings& s, const TrialStep& whole, TrialStep& stage, StageTimes& times,
              const SolveObserver& onSolve) {
    stage.dt = kGamma * whole.dt;
    stage.h = whole.h;
    stage.workLimit = whole.workLimit - whole.result.work.units();
    stage.solveLimit = whole.solveLimit;
    stage.hurryAt = whole.hurryAt;
    stage.fullEffort = whole.fullEffort;
    stage.stage.loop = whole.stage.loop;
    stage.aside = &whole.rods;
    tryStep(world, s, stage, times, onSolve);
    return stage.result.reason == Reason::None && stage.result.judged && !stage.result.outOfWork &&
           stage.stage.report.converged && stage.result.overlaps.empty();
}

void addWork(const TrialResult& from, TrialResult& to) {
    to.work.add(from.work);
    to.solves += from.solves;
    to.gaussSeidelIterations += from.gaussSeidelIterations;
    to.pivots += from.pivots;
}

/// Energy that the rods of the step move and bend with, J.
double scaleOf(const World& world, const TrialStep& stage) {
    double scale = 0.0;
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        if (stage.rods[i].solved())
            scale += rod::kineticEnergy(world.rods[i].gauss, world.rods[i].u) +
                     rod::bendingEnergy(world.rods[i].model, world.rods[i].q);
    return scale;
}

/// Squared error, in units of what may be: the embedded one, gamma dt (k2 - k1), in the norm of energy.
double errorOf(const World& world, const Settings& s, const SecondOrderStep& w) {
    double energy = 0.0, bySize = 0.0;
    const double scale = scaleOf(world, w.stages[0]);
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        const RodWork &one = w.stages[0].rods[i], &two = w.stages[1].rods[i];
        if (!one.solved())
            continue;
        const Rod& r = world.rods[i];
        const rod::RodModel& model = r.model;
        double way = 0.0;
        for (std::size_t g = 0; g < r.u.size(); ++g) {
            const Vec2 change = (two.u1[g] - two.u0[g]) - (one.u1[g] - one.u0[g]);
            energy += 0.5 * two.gauss.mass[g] * change.squaredNorm();
        }
        const auto bent = w.stages[0].dt * (two.v - one.v);
        energy += 0.5 * rod::bendingForm(model, bent);
        for (int k = 0; k < model.elements(); ++k)
            way += std::abs(bent[k]) * model.elementLength(model.elementOfDof(k));
        bySize = std::max(bySize, 0.5 * way * model.definition().length / least(s, r, w.stages[0].dt));
    }
    return std::min(energy / std::max(s.freeError * s.freeError * scale, 1e-300), bySize * bySize);
}

/// Energies at the end, and what the scheme took: all that the other terms of the balance leave.
void closeBalance(const World& start, World& end) {
    EnergyBalance &b = end.energyBalance, before = start.energyBalance;
    b.kinetic = before.kinetic;
    b.bending = before.bending;
    b.gravity = before.gravity;
    for (std::size_t i = 0; i < end.rods.size(); ++i) {
        const Rod &from = start.rods[i], &to = end.rods[i];
        if (to.frozen())
            continue;
        b.kinetic += rod::kineticEnergy(to.gauss, to.u) - rod::kineticEnergy(from.gauss, from.u);
        b.bending += rod::bendingEnergy(to.model, to.q) - rod::bendingEnergy(from.model, from.q);
        b.gravity -= to.model.mass() *
                     end.gravity.dot(rod::massCentre(to.kin, to.gauss) - rod::massCentre(from.kin, from.gauss));
    }
    b.numerical -= b.residual() - before.residual();
}

/// Mean of a force over both stages, from its value in the first one.
template <class T>
void toMean(const T& first, T& second) {
    second = (1.0 - kGamma) * first + kGamma * second;
}

/// Forces as a step of first order leaves them: means, so that force times step is the impulse.
void meanForces(const SecondOrderStep& w, World& end) {
    const std::vector<ContactImpulse>& first = w.stages[0].impulses;
    SC_ASSERT(first.size() == end.impulses.size(), "the same contacts carry force in both stages");
    for (std::size_t i = 0; i < first.size(); ++i) {
        SC_ASSERT(first[i].id == end.impulses[i].id, "the same contacts carry force in both stages");
        toMean(first[i].normal, end.impulses[i].normal);
        toMean(first[i].tangent, end.impulses[i].tangent);
    }
    for (std::size_t i = 0; i < end.bodies.size(); ++i)
        toMean(w.bodyForces[i], end.bodies[i].force);
    for (std::size_t i = 0; i < end.constraints.contacts.size(); ++i) {
        toMean(w.constraints.contacts[i].normalForce, end.constraints.contacts[i].normalForce);
        toMean(w.constraints.contacts[i].tangentForce, end.constraints.contacts[i].tangentForce);
    }
    for (std::size_t i = 0; i < end.constraints.rows.size(); ++i)
        toMean(w.constraints.rows[i].last, end.constraints.rows[i].last);
}

/// Rods that the stages left out, and what counts steps.
void finish(const World& start, TrialStep& t, World& end) {
    for (std::size_t i = 0; i < end.rods.size(); ++i)
        if (!end.rods[i].frozen() && t.rods[i].isFree) {
            const RodEnergies e = acceptFreeMotion(end, end.rods[i], t.dt, t.rods[i]);
            end.energyBalance.work += e.holdWork + e.loadWork;
            end.energyBalance.damping += e.damping;
            end.energyBalance.effects += e.effects;
        }
    end.links = start.links; // no joint is in the stages; those of free rods have moved a whole step
    for (Link& l : end.links) {
        l.force.setZero();
        l.torque = 0.0;
    }
    for (std::size_t k = 0; k < t.groupCount; ++k)
        if (t.isFree(t.groups[k]))
            acceptFreeJoints(end, t.dt, t.groups[k]);
    advanceLinks(end, t.dt);
    for (std::size_t i = 0; i < end.rods.size(); ++i)
        if (t.rods[i].solved()) {
            double way = 0.0;
            for (int k = 0; k <= end.rods[i].model.elements(); ++k)
                way = std::max(way, (end.rods[i].kin.node(k) - start.rods[i].kin.node(k)).norm());
            end.rods[i].speed = way / t.dt;
        }
    end.dt = t.dt;
    end.counters.steps = start.counters.steps + 1;
    closeBalance(start, end);
}

/// The straight way from the start of the step to its end, which no stage has gone.
bool crosses(const World& start, const Settings& s, const TrialStep& t, TrialStep& last) {
    if (!s.crossingCheck)
        return false;
    for (std::size_t i = 0; i < t.rods.size(); ++i)
        if (t.rods[i].isFree)
            last.stage.detection.curves[i] = t.stage.detection.curves[i];
    checkCrossings(start, last);
    return last.result.reason != Reason::None || last.result.outOfWork;
}

} // namespace

SecondOrder trySecondOrder(const World& world, const Settings& settings, TrialStep& t, StageTimes& times,
                           const SolveObserver& onSolve) {
    if (!canBeMade(world, settings, t) || !isWorth(world, settings, t))
        return SecondOrder::NotWorth;
    if (!t.secondOrder)
        t.secondOrder = std::make_shared<SecondOrderStep>();
    SecondOrderStep& w = *t.secondOrder;
    const SecondOrder changed =
        t.error <= kAtChange * settings.localError * t.h ? SecondOrder::NotWorth : SecondOrder::StatusChanged;
    Settings s = settings;
    s.crossingCheck = false; // of the stages: crosses()
    const bool first = tryStage(world, s, t, w.stages[0], times, onSolve);
    addWork(w.stages[0].result, t.result);
    if (!first)
        return changed;
    collectStatus(w.stages[0], w.status);
    if (!collectStatusBefore(world, w.stages[0], w.before) || w.before != w.status)
        return changed;
    w.world = world;
    acceptStep(w.world, w.stages[0], times);
    w.bodyForces.clear();
    for (const Body& b : w.world.bodies)
        w.bodyForces.push_back(b.force);
    w.constraints = w.world.constraints;
    toSecondStage(world, w.stages[0], w.world);
    const bool second = tryStage(w.world, s, t, w.stages[1], times, onSolve);
    addWork(w.stages[1].result, t.result);
    if (!second)
        return changed;
    collectStatus(w.stages[1], w.status);
    if (w.before != w.status || crosses(world, settings, t, w.stages[1]))
        return changed;
    w.error = errorOf(world, settings, w);
    if (w.error > 1.0)
        return SecondOrder::ErrorTooLarge;
    acceptStep(w.world, w.stages[1], times);
    meanForces(w, w.world);
    finish(world, t, w.world);
    const auto taken = [](const EnergyBalance& b) { return b.numerical + b.impact + b.lostToCorrection(); };
    const double gained = taken(world.energyBalance) - taken(w.world.energyBalance);
    return gained > kGain * settings.freeError * scaleOf(world, w.stages[0]) ? SecondOrder::ErrorTooLarge
                                                                             : SecondOrder::Made;
}

void acceptSecondOrder(World& world, TrialStep& t) {
    std::swap(world, t.secondOrder->world);
}

double nextSize(const TrialStep& t) {
    constexpr double kShortestCut = 0.25, kLongestGrowth = 2.0;
    const double error = std::max(t.secondOrder->error, 1e-12);
    return t.dt * std::clamp(0.9 / std::sqrt(std::sqrt(error)), kShortestCut, kLongestGrowth);
}

} // namespace supercircle::step
