#include "plugin/api/snapshot_fields.h"

#include "supercircle/support/failure.h"

#include <algorithm>
#include <cmath>

namespace supercircle {

using rod::Vec2;

namespace {

constexpr double kSeparationShare = 0.05; ///< of the mean thickness: least gap of a separated pair
constexpr double kNewMinimumShare = 0.02; ///< of the released energy: least decrease to a new minimum

double arcFraction(const step::World& world, const contact::RodPoint& at) {
    const double length = world.rods[static_cast<std::size_t>(at.rod)].model.definition().length;
    return std::clamp(at.s / length, 0.0, 1.0);
}

ContactPair pairOf(const step::World& world, const contact::Candidate& c) {
    ContactPair p;
    p.a = world.rods[static_cast<std::size_t>(c.a.rod)].key;
    if (c.b.rod < 0) {
        p.body = world.outlines[static_cast<std::size_t>(c.outline)].body;
        return p;
    }
    p.b = world.rods[static_cast<std::size_t>(c.b.rod)].key;
    if (p.b < p.a)
        std::swap(p.a, p.b);
    return p;
}

/// Velocity of a rod's surface point for generalised velocities v.
Vec2 velocityAt(const step::Rod& rod, const contact::RodPoint& at, const Vec2& surface, const Eigen::VectorXd& v) {
    const rod::MaterialPoint place = rod::locate(rod.model, at.element, at.s);
    Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, rod.model.dofs());
    rod.kin.pointRows(rod.model, place, surface - rod.kin.point(place), Vec2::UnitX(), Vec2::UnitY(), rows);
    return rows * v;
}

double thicknessOf(const step::World& world, const contact::Candidate& c) {
    const double a = world.rods[static_cast<std::size_t>(c.a.rod)].model.definition().thickness;
    return c.b.rod < 0 ? a : 0.5 * (a + world.rods[static_cast<std::size_t>(c.b.rod)].model.definition().thickness);
}

} // namespace

QuarantineEvent quarantineOf(const step::Rod& rod, const EventDetector::HandleOf& handleOf) {
    QuarantineReason reason = QuarantineReason::NotFinite;
    if (rod.quarantineReason == step::QuarantineReason::Runaway)
        reason = QuarantineReason::Runaway;
    if (rod.quarantineReason == step::QuarantineReason::Crushed)
        reason = QuarantineReason::Crushed;
    return {rod.quarantinedAt, handleOf(rod.key), reason};
}

void EventDetector::begin(const step::World& world) {
    events.contact_begin.clear(); // one by one: keeps the storage
    events.contact_end.clear();
    events.impulses.clear();
    events.snap_begin.clear();
    events.snap_end.clear();
    events.quarantined.clear();
    events.crushed.clear();
    events.broke.clear();
    events.overlapping.clear();
    events.hold_blocked.clear();
    frameStart_ = world.time;
    pairImpulses_.clear();
    std::erase_if(state.pairs, [&](const ContactPairState& t) { // shells that are gone
        const bool gone = step::rodIndex(world, t.pair.a) < 0 || (t.pair.b != 0 && step::rodIndex(world, t.pair.b) < 0);
        if (gone)
            events.contact_end.push_back({world.time, t.last});
        return gone;
    });
    matchSnaps(world);
    recordStart(world);
}

void EventDetector::keep() {
    keptState_ = state;
    keptEvents_ = events;
}

void EventDetector::forget() {
    state = keptState_;
    events = keptEvents_;
    pairImpulses_.clear();
}

void EventDetector::recordStart(const step::World& world) {
    velocities_.resize(std::max(velocities_.size(), world.rods.size())); // islands follow each other: keeps the storage
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        velocities_[i] = world.rods[i].v;
    bodies_.resize(world.bodies.size());
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
        bodies_[i] = world.bodies[i].state;
}

void EventDetector::afterStep(const step::World& world, const step::Stepper& stepper, const HandleOf& handleOf) {
    collectActiveContacts(world, stepper);
    updateContacts(world, stepper, handleOf);
    findSeparations(world);
    updateSnaps(world, handleOf);
}

/// The contact points of the step that carry force, sorted by pair.
void EventDetector::collectActiveContacts(const step::World& world, const step::Stepper& stepper) {
    activeContacts_.clear();
    const std::vector<contact::Candidate>& candidates = stepper.lastCandidates();
    const Eigen::VectorXd& r = stepper.lastImpulses();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(2 * i);
        if (k + 1 < r.size() && r[k] > 0.0)
            activeContacts_.push_back({pairOf(world, candidates[i]), i, r[k], std::abs(r[k + 1])});
    }
    if (activeContacts_.empty())
        return;
    std::sort(activeContacts_.begin(), activeContacts_.end(),
              [](const ActiveContact& x, const ActiveContact& y) { // std::stable_sort would allocate
                  return x.pair != y.pair ? x.pair < y.pair : x.contact < y.contact;
              });
    byId_.clear();
    for (std::size_t i = 0; i < world.candidates.size(); ++i)
        byId_.emplace_back(world.candidates[i].id, i);
    std::sort(byId_.begin(), byId_.end());
}

/// The same contact point after the step, if it still exists: the solver linearises it half a step earlier.
const contact::Candidate& EventDetector::atEnd(const step::World& world, const contact::Candidate& c) const {
    const auto it = std::lower_bound(byId_.begin(), byId_.end(), std::pair<std::uint64_t, std::size_t>{c.id, 0});
    return it != byId_.end() && it->first == c.id ? world.candidates[it->second] : c;
}

double EventDetector::approachSpeed(const step::World& world, const contact::Candidate& c) const {
    const auto ia = static_cast<std::size_t>(c.a.rod);
    if (velocities_.size() < world.rods.size())
        return 0.0;
    Vec2 u = velocityAt(world.rods[ia], c.a, c.pointA, velocities_[ia]);
    if (c.b.rod >= 0) {
        const auto ib = static_cast<std::size_t>(c.b.rod);
        u -= velocityAt(world.rods[ib], c.b, c.pointB, velocities_[ib]);
    } else {
        const step::BodyId id = world.outlines[static_cast<std::size_t>(c.outline)].body;
        for (std::size_t i = 0; i < world.bodies.size() && i < bodies_.size(); ++i)
            if (world.bodies[i].id == id)
                u -= bodies_[i].velocity + bodies_[i].spin * rod::perp(c.pointB - bodies_[i].centre);
    }
    return -u.dot(c.normal);
}

/// Pairs that carry force: begin events of new ones, and their impulses.
void EventDetector::updateContacts(const step::World& world, const step::Stepper& stepper, const HandleOf& handleOf) {
    const std::vector<contact::Candidate>& candidates = stepper.lastCandidates();
    for (std::size_t first = 0; first < activeContacts_.size();) {
        const ContactPair pair = activeContacts_[first].pair;
        std::size_t best = first, next = first;
        double normal = 0.0, tangent = 0.0;
        for (; next < activeContacts_.size() && activeContacts_[next].pair == pair; ++next) {
            normal += activeContacts_[next].normal;
            tangent += activeContacts_[next].tangent;
            if (activeContacts_[next].normal > activeContacts_[best].normal)
                best = next;
        }
        const contact::Candidate& c = atEnd(world, candidates[activeContacts_[best].contact]);
        auto it = std::lower_bound(state.pairs.begin(), state.pairs.end(), pair,
                                   [](const ContactPairState& t, const ContactPair& want) { return t.pair < want; });
        const bool isNew = it == state.pairs.end() || it->pair != pair;
        if (isNew) {
            it = state.pairs.insert(it, {pair, {}});
            it->last.a = handleOf(pair.a);
            it->last.b = pair.b != 0 ? handleOf(pair.b) : ShellHandle{};
            it->last.body = pair.body;
        }
        const bool swapped = c.b.rod >= 0 && world.rods[static_cast<std::size_t>(c.a.rod)].key != pair.a;
        ContactPoint& at = it->last;
        at.fraction_a = arcFraction(world, swapped ? c.b : c.a);
        at.fraction_b = c.b.rod < 0 ? 0.0 : arcFraction(world, swapped ? c.a : c.b);
        at.point = point(0.5 * (c.pointA + c.pointB));
        at.normal = point(swapped ? Vec2(-c.normal) : c.normal);
        if (isNew)
            events.contact_begin.push_back({world.time, at, approachSpeed(world, c)});
        addImpulse(at, pair, world.time, normal, tangent, stepper.lastDt());
        first = next;
    }
}

void EventDetector::addImpulse(const ContactPoint& at, const ContactPair& pair, double time, double normal,
                               double tangent, double dt) {
    if (std::isinf(state.settings.impulse_threshold))
        return;
    auto it = std::lower_bound(pairImpulses_.begin(), pairImpulses_.end(), pair,
                               [](const PairImpulse& x, const ContactPair& want) { return x.pair < want; });
    if (it == pairImpulses_.end() || it->pair != pair)
        it = pairImpulses_.insert(it, {{}, pair, -1.0});
    it->event.normal_impulse += normal;
    it->event.friction_impulse += tangent;
    it->event.peak_force = std::max(it->event.peak_force, normal / dt);
    if (normal > it->largestStep) {
        it->largestStep = normal;
        it->event.time = time;
        it->event.at = at;
    }
}

/// End events of pairs without force whose gap has opened. Sleeping pairs have no candidates and stay in contact.
void EventDetector::findSeparations(const step::World& world) {
    const auto before = [](const ActiveContact& x, const ActiveContact& y) { return x.pair < y.pair; };
    const auto sleeps = [&](std::uint32_t key) {
        const int i = step::rodIndex(world, key);
        return i >= 0 && world.rods[static_cast<std::size_t>(i)].asleep();
    };
    unloaded_.clear(); // sorted, as `pairs` is
    for (const ContactPairState& t : state.pairs)
        if (!std::binary_search(activeContacts_.begin(), activeContacts_.end(), ActiveContact{t.pair, 0, 0.0, 0.0},
                                before) &&
            step::rodIndex(world, t.pair.a) >= 0)
            unloaded_.push_back({t.pair, sleeps(t.pair.a) && (t.pair.b == 0 || sleeps(t.pair.b))});
    if (unloaded_.empty())
        return;
    for (const contact::Candidate& c : world.candidates) {
        if (c.gap > kSeparationShare * thicknessOf(world, c))
            continue;
        const ContactPair pair = pairOf(world, c);
        const auto it = std::lower_bound(unloaded_.begin(), unloaded_.end(), pair,
                                         [](const auto& u, const ContactPair& want) { return u.first < want; });
        if (it != unloaded_.end() && it->first == pair)
            it->second = true;
    }
    std::erase_if(state.pairs, [&](const ContactPairState& t) {
        const auto it = std::lower_bound(unloaded_.begin(), unloaded_.end(), t.pair,
                                         [](const auto& u, const ContactPair& want) { return u.first < want; });
        if (it == unloaded_.end() || it->first != t.pair || it->second)
            return false;
        events.contact_end.push_back({world.time, t.last});
        return true;
    });
}

/// One state a rod, in the order of the rods.
void EventDetector::matchSnaps(const step::World& world) {
    std::vector<SnapState>& snaps = state.snaps;
    const bool known = std::equal(snaps.begin(), snaps.end(), world.rods.begin(), world.rods.end(),
                                  [](const SnapState& s, const step::Rod& r) { return s.key == r.key; });
    if (!known) {
        std::vector<SnapState> now;
        now.reserve(world.rods.size());
        for (const step::Rod& r : world.rods) {
            const auto it =
                std::find_if(snaps.begin(), snaps.end(), [&](const SnapState& s) { return s.key == r.key; });
            now.push_back(it != snaps.end() ? *it : SnapState{});
            now.back().key = r.key;
        }
        snaps = std::move(now);
    }
    snapOf_.clear();
    for (std::size_t i = 0; i < snaps.size(); ++i)
        snapOf_.emplace_back(snaps[i].key, i);
    std::sort(snapOf_.begin(), snapOf_.end());
}

void EventDetector::updateSnaps(const step::World& world, const HandleOf& handleOf) {
    for (const step::Rod& r : world.rods) {
        const auto it = std::lower_bound(snapOf_.begin(), snapOf_.end(), std::pair{r.key, std::size_t{0}});
        SC_ASSERT(it != snapOf_.end() && it->first == r.key, "one state a rod");
        sampleEnergy(state.snaps[it->second], r, world.time, handleOf);
    }
}

void EventDetector::sampleEnergy(SnapState& s, const step::Rod& rod, double time, const HandleOf& handleOf) {
    const rod::RodDefinition& d = rod.model.definition();
    const double unitTime = d.length * d.length * std::sqrt(d.linearMass / d.bendingModulus);
    const double width = state.settings.snap_time * unitTime / SnapState::kShort;
    const double least = state.settings.snap_energy * d.bendingModulus / d.length;
    const double energy = rod::bendingEnergy(rod.model, rod.q);
    const double place = std::floor(time / width);
    if (!std::isfinite(energy) || !(std::abs(place) < 9e15))
        return;
    const auto bucket = static_cast<std::int64_t>(place), from = s.bucket;
    const bool follows = s.filled > 0 && bucket >= from && bucket - from <= 2 * SnapState::kBuckets;
    if (!follows) {
        s.filled = s.filled == 0 ? 1 : SnapState::kBuckets; // after one long step the past is a straight line
        if (s.filled > 1)
            s.lowest.fill(std::min(s.energy, energy));
    } else {
        for (std::int64_t b = s.bucket + 1; b <= bucket; ++b) { // the energy is linear between two samples
            const double share = (static_cast<double>(b) * width - s.time) / (time - s.time);
            const double there = s.energy + std::clamp(share, 0.0, 1.0) * (energy - s.energy);
            auto& previous = s.lowest[static_cast<std::size_t>((b - 1) % SnapState::kBuckets)];
            previous = std::min(previous, there);
            s.lowest[static_cast<std::size_t>(b % SnapState::kBuckets)] = there;
            s.filled = std::min<std::int64_t>(s.filled + 1, SnapState::kBuckets);
        }
    }
    auto& current = s.lowest[static_cast<std::size_t>(bucket % SnapState::kBuckets)];
    current = s.filled == 1 ? energy : std::min(current, energy);
    if (follows && rod.leastBending < std::min(s.energy, energy)) // it swung between the two samples
        for (std::int64_t b = std::max(from, bucket - SnapState::kBuckets + 1); b <= bucket; ++b) {
            auto& lowest = s.lowest[static_cast<std::size_t>(b % SnapState::kBuckets)];
            lowest = std::min(lowest, rod.leastBending);
        }
    s.bucket = bucket;
    s.time = time;
    s.energy = energy;
    if (!s.snapping && s.filled == SnapState::kBuckets) {
        double before = s.lowest[static_cast<std::size_t>((bucket + 1) % SnapState::kBuckets)];
        for (int i = 2; i <= SnapState::kLong; ++i)
            before = std::min(before, s.lowest[static_cast<std::size_t>((bucket + i) % SnapState::kBuckets)]);
        if (energy < before - least) {
            s.snapping = true;
            s.begun = s.minimumTime = time;
            s.energyBefore = before;
            s.minimum = energy;
            s.kineticPeak = 0.0;
            events.snap_begin.push_back({time, handleOf(s.key), before, energy});
        }
    }
    if (!s.snapping)
        return;
    s.kineticPeak = std::max(s.kineticPeak, rod::kineticEnergy(rod.gauss, rod.u));
    if (energy < s.minimum - kNewMinimumShare * (s.energyBefore - s.minimum))
        s.minimumTime = time;
    s.minimum = std::min(s.minimum, energy);
    if (time - s.minimumTime > SnapState::kLong / 2 * width) {
        s.snapping = false;
        events.snap_end.push_back({time, s.begun, handleOf(s.key), s.energyBefore - s.minimum, s.kineticPeak});
    }
}

void EventDetector::end(const step::World& world, const HandleOf& handleOf) {
    for (PairImpulse& x : pairImpulses_)
        if (x.event.normal_impulse > state.settings.impulse_threshold)
            events.impulses.push_back(x.event);
    std::vector<std::uint32_t>& now = quarantinedNow_;
    now.clear();
    std::vector<std::uint32_t>& known = state.quarantined;
    for (const step::Rod& r : world.rods) {
        if (!r.quarantined)
            continue;
        now.push_back(r.key);
        if (std::find(known.begin(), known.end(), r.key) == known.end())
            events.quarantined.push_back(quarantineOf(r, handleOf));
    }
    std::swap(known, now);
    updateOverlaps(world, handleOf);
    for (const step::Rod& r : world.rods)
        for (const step::Hold& h : r.holds) {
            const auto blocked = [&](double time, BodyId body, bool stopped) {
                if (time < frameStart_ || time >= world.time)
                    return;
                const ShellHandle shell = handleOf(r.key);
                events.hold_blocked.push_back({time, shell, {r.key, h.key, shell.world}, body, stopped});
            };
            if (h.stop.body != 0)
                blocked(h.stop.since, h.stop.body, h.stop.driven);
            if (h.stop.byHold && !h.stop.byHoldBefore)
                blocked(h.stop.time, 0, true);
        }
    std::stable_sort(events.hold_blocked.begin(), events.hold_blocked.end(),
                     [](const HoldBlockedEvent& a, const HoldBlockedEvent& b) { return a.time < b.time; });
}

/// Begin events of pairs that overlap; the pieces of a body are one pair.
void EventDetector::updateOverlaps(const step::World& world, const HandleOf& handleOf) {
    std::vector<ContactPair>& now = overlappingNow_;
    now.clear();
    for (const step::Overlap& o : world.overlaps)
        now.push_back({o.rodA, o.rodB, o.body});
    std::sort(now.begin(), now.end());
    now.erase(std::unique(now.begin(), now.end()), now.end());
    for (const ContactPair& p : now)
        if (!std::binary_search(state.overlapping.begin(), state.overlapping.end(), p))
            events.overlapping.push_back({world.time, handleOf(p.a), p.b != 0 ? handleOf(p.b) : ShellHandle{}, p.body});
    std::swap(state.overlapping, now);
}

const FrameEvents& Shells::events() const {
    return impl_->detector.events;
}

const EventSettings& Shells::event_settings() const {
    return impl_->detector.state.settings;
}

Status Shells::set_event_settings(const EventSettings& s) {
    return impl_->change([&] {
        if (!(s.impulse_threshold >= 0.0) || !(s.snap_energy > 0.0) || !(s.snap_time > 0.0) ||
            std::isinf(s.snap_time) || std::isinf(s.snap_energy))
            return refused("event settings must be positive and finite (impulse_threshold may be infinite)");
        EventDetectorState& state = impl_->detector.state;
        if (s.snap_time != state.settings.snap_time)
            state.snaps.clear(); // their buckets are in units of it
        state.settings = s;
        impl_->recorder.record(Call::SetEventSettings, s);
        return done();
    });
}

} // namespace supercircle
