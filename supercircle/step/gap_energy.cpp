#include "supercircle/step/gap_energy.h"

#include "supercircle/step/contacts/link_rows.h"
#include "supercircle/step/energy_gain.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

/// Of what the gaps of a trial bring in, from which on one of them is suspected. With a tenth of it more gaps wait that
/// contradict nothing; with ten times as much trials are made again more often.
constexpr double kLeastShare = 0.01;
/// What lawful gaps take at most, in what their forces without closing would take. At 1 no joint lifts what hangs from
/// it; with 2 a contradiction may double its force with each step, and twice as many random scenes raise the alarm.
constexpr double kLawful = 1.2;

Vec2 impulseOf(const TrialStep& t, std::size_t contact) {
    return t.stage.r.segment<2>(static_cast<Eigen::Index>(2 * contact));
}

/// What the gaps of a trial bring in, or would if none waited, one after the other, J: overlap(id, energy),
/// joint(key, energy) by row, drift(body's id, energy) by row that feels a body's way to its original.
template <class Overlap, class Joint, class Drift>
void forEachInjection(const World& world, const TrialStep& t, const Overlap& overlap, const Joint& joint,
                      const Drift& drift) {
    const ContactStage& stage = t.stage;
    const auto driftOf = [&](const Body& b) {
        const auto& stopped = stage.gaps.drifts;
        const auto at =
            std::find_if(stopped.begin(), stopped.end(), [&](const WaitingDrift& d) { return d.body == b.id; });
        return at != stopped.end() ? *at : WaitingDrift{b.id, b.hostCoupling.drift, b.hostCoupling.driftSpin};
    };
    for (std::size_t i = 0; i < stage.candidates.size(); ++i) {
        const ContactWork& k = stage.work[i];
        const Vec2 r = impulseOf(t, i);
        if (!(r.x() > 0.0))
            continue;
        if (k.bodyB >= 0 && world.bodies[static_cast<std::size_t>(k.bodyB)].dynamic) {
            const WaitingDrift d = driftOf(world.bodies[static_cast<std::size_t>(k.bodyB)]);
            const Vec2& n = stage.candidates[i].normal;
            drift(d.body, (r.x() * n + r.y() * rod::perp(n)).dot(d.velocity + d.spin * rod::perp(k.armB)));
        }
        const double damping = t.dt * k.damping; // one that gives way is slower
        overlap(stage.candidates[i].id, r.x() * (k.closing - (damping > 0.0 ? r.x() / damping : 0.0)));
    }
    for (std::size_t i = 0; i < stage.links.count; ++i) {
        const LinkRow& row = stage.links.rows[i];
        const Vec2 r = impulseOf(t, stage.candidates.size() + i);
        if (row.bodyProblem >= 0) {
            const WaitingDrift d = driftOf(world.bodies[static_cast<std::size_t>(row.bodyB)]);
            drift(d.body, r.dot(inRow(row, d.velocity + d.spin * rod::perp(row.armB), d.spin)));
        }
        joint(world.links[static_cast<std::size_t>(row.link)].key, r.dot(row.wanted));
    }
}

/// Motion of the shells and dynamic bodies at the speed of closing, J.
double atClosingSpeed(const World& world, const Settings& settings) {
    double sum = 0.0;
    const auto add = [&](double mass, double length) {
        sum += 0.5 * mass * settings.recovery * settings.recovery * length * length;
    };
    for (const Rod& r : world.rods)
        if (!r.frozen())
            add(r.model.mass(), lengthOf(r, settings.length));
    for (const Body& b : world.bodies)
        if (b.dynamic)
            add(b.state.mass, b.thicknessNear);
    return sum;
}

template <class Key>
void insert(std::vector<Key>& sorted, const std::vector<Key>& keys) {
    for (const Key key : keys)
        if (const auto at = std::lower_bound(sorted.begin(), sorted.end(), key); at == sorted.end() || *at != key)
            sorted.insert(at, key);
}

void move(GapSet& from, GapSet& to) {
    insert(to.contacts, from.contacts);
    insert(to.links, from.links);
    insert(to.bodies, from.bodies);
    from = {};
}

/// Lets ways of bodies to their originals go on by the share that they may.
void setDrifts(World& world, GapWork& gaps) {
    for (const Body& b : world.bodies)
        if (gaps.suspects.body(b.id))
            gaps.drifts.push_back({b.id, b.hostCoupling.drift, b.hostCoupling.driftSpin});
    std::erase_if(gaps.drifts, [&](const WaitingDrift& d) {
        HostCoupling& h = world.bodies[static_cast<std::size_t>(bodyIndex(world, d.body))].hostCoupling;
        const double share = gaps.shareOfBody(d.body);
        h.drift = share * d.velocity;
        h.driftSpin = share * d.spin;
        return share >= 1.0;
    });
}

/// After a trial with the suspects left open. True: they are lawful, or a share of their closing is: another trial.
bool judgeSuspects(World& world, const TrialStep& t, GapWork& gaps) {
    double carried = 0.0;
    const auto add = [&](bool counts, double energy) { carried += counts ? std::max(0.0, energy) : 0.0; };
    forEachInjection(
        world, t, [&](std::uint64_t id, double energy) { add(gaps.suspects.contact(id), energy); },
        [&](std::uint32_t key, double energy) { add(gaps.suspects.link(key), energy); },
        [&](BodyId id, double energy) { add(gaps.suspects.body(id), energy); });
    const double wanted = gaps.power * t.dt;
    const bool lawful = wanted <= kLawful * carried + gaps.allowed;
    // What closing adds to a force grows with its share, so that its work grows with the square.
    gaps.share = lawful ? 1.0 : std::sqrt(gaps.allowed / (wanted - carried));
    const bool slower = gaps.share > kLeastShare;
    move(gaps.suspects, lawful ? gaps.lawful : slower ? gaps.slowed : gaps.waiting);
    setDrifts(world, gaps);
    if (lawful)
        gaps.lawfulPower = kLawful * carried / t.dt;
    gaps.acquitted = lawful || slower;
    return gaps.acquitted;
}

} // namespace

bool judgeGaps(const EnergyBalance& before, const Settings& settings, bool last, World& world, TrialStep& t) {
    GapWork& gaps = t.stage.gaps;
    if (t.stage.links.count == 0)
        return false; // contacts alone part as far as they can
    if (last && gaps.suspects.any()) {
        move(gaps.suspects, gaps.waiting);
        return false;
    }
    if (gaps.suspects.any() && judgeSuspects(world, t, gaps))
        return true;
    double overlaps = 0.0, others = 0.0, lawful = 0.0;
    const auto add = [&](double share, bool isLawful, double energy, double& sum) {
        sum += share * std::max(0.0, energy);
        lawful += isLawful ? share * std::max(0.0, energy) : 0.0;
    };
    forEachInjection(
        world, t,
        [&](std::uint64_t id, double energy) {
            add(gaps.shareOfContact(id), gaps.lawful.contact(id), energy, overlaps);
        },
        [&](std::uint32_t key, double energy) { add(gaps.shareOfLink(key), gaps.lawful.link(key), energy, others); },
        [&](BodyId id, double energy) { add(gaps.shareOfBody(id), gaps.lawful.body(id), energy, others); });
    const double adds = overlaps + others;
    lawful = std::min(lawful, gaps.lawfulPower * t.dt);
    const auto accept = [&] {
        gaps.lawfulWork += lawful;
        return false;
    };
    if (!(adds > lawful) || gaps.acquitted) {
        gaps.acquitted = false;
        return accept();
    }
    const InjectedEnergy &now = world.energyBalance.injected, &then = before.injected;
    overlaps += now.contact - then.contact;
    others += now.link - then.link + now.drift - then.drift;
    const double allowed = atClosingSpeed(world, settings) + gaps.lawfulWork + lawful;
    if (overlaps + others <= allowed)
        return accept();
    const double moved = movedEnergy(before, world);
    const double beyond =
        std::max(0.0, overlaps - kGainShareOfOverlaps * moved) + std::max(0.0, others - kGainShare * moved) - allowed;
    if (beyond <= 0.0)
        return accept();
    gaps.lawful = {};
    gaps.lawfulPower = 0.0;
    gaps.power = adds / t.dt;
    gaps.allowed = std::max(0.0, adds - lawful - beyond);
    const auto count = static_cast<double>(2 * (t.stage.candidates.size() + t.stage.links.count)); // most of them
    const double least = std::min(kLeastShare, 0.5 / count) * adds; // the largest is above it
    forEachInjection(
        world, t,
        [&](std::uint64_t id, double energy) {
            if (energy > least && gaps.shareOfContact(id) > 0.0)
                insert(gaps.suspects.contacts, {id});
        },
        [&](std::uint32_t key, double energy) {
            if (energy > least && gaps.shareOfLink(key) > 0.0)
                insert(gaps.suspects.links, {key});
        },
        [&](BodyId id, double energy) {
            if (energy > least && gaps.shareOfBody(id) > 0.0)
                insert(gaps.suspects.bodies, {id});
        });
    setDrifts(world, gaps);
    return true;
}

void endShares(World& world, TrialStep& t) {
    GapWork& gaps = t.stage.gaps;
    if (!gaps.slowed.any())
        return;
    move(gaps.slowed, gaps.waiting);
    setDrifts(world, gaps);
}

} // namespace supercircle::step
