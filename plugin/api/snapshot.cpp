// What belongs to the state (checked by tests/plugin/api/test_snapshot.cpp): candidates and their ranges do, because a
// list made for a longer motion holds more speculative contacts. Caches of contact detection and workspaces of step and
// solver do not: the results do not depend on their content. Poses of driven bodies and the feed-forward of dynamic
// bodies are in step::Body, not in the port.

#include "plugin/api/snapshot_fields.h"
#include "supercircle/contact/feature_id.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle {

using archive::Hasher;
using archive::Loader;
using archive::Saver;

namespace archive {

std::uint64_t hashOf(const std::uint8_t* bytes, std::size_t count) {
    std::uint64_t hash = kHashStart;
    for (std::size_t i = 0; i < count; ++i)
        hashByte(hash, bytes[i]);
    return hash;
}

std::vector<std::uint8_t> wrap(const FileKind& kind, const std::vector<std::uint8_t>& content) {
    Saver out;
    for (int i = 0; i < 8; ++i)
        out.word(static_cast<std::uint8_t>(kind.name[i]), 1);
    out.word(kind.version, 4);
    out.word(content.size(), 8);
    out.word(hashOf(content.data(), content.size()), 8);
    out.bytes.insert(out.bytes.end(), content.begin(), content.end());
    return std::move(out.bytes);
}

Result<std::size_t> unwrap(const FileKind& kind, const std::vector<std::uint8_t>& file) {
    using Offset = Result<std::size_t>;
    Loader in(file.data(), file.size());
    bool same = file.size() >= 8;
    for (int i = 0; i < 8 && same; ++i)
        same = in.word(1) == static_cast<std::uint8_t>(kind.name[i]);
    std::string name(kind.name);
    name.resize(name.find_last_not_of(' ') + 1);
    if (!same)
        return Offset::failure("these bytes are not an " + name + " file");
    const std::uint64_t version = in.word(4), size = in.word(8), sum = in.word(8);
    if (in.fault().empty() && version != kind.version)
        return Offset::failure(name + ": written as version " + std::to_string(version) +
                               ", this program reads version " + std::to_string(kind.version));
    if (!in.fault().empty() || size != in.left())
        return Offset::failure(name + ": it is cut off or continues after its end");
    if (hashOf(in.at(), in.left()) != sum)
        return Offset::failure(name + ": the checksum is wrong, the bytes are damaged");
    return file.size() - in.left();
}

} // namespace archive

namespace {

constexpr archive::FileKind kStateKind{"SCSTATE ", 17};
constexpr archive::FileKind kLogKind{"SCCALLS ", 4};

/// Joints, what the host's joints do, and the numbers that the next part and the next sleeping island get.
Status checkParts(const step::World& w) {
    const auto outside = [&](std::uint32_t key, double at) {
        const int i = step::rodIndex(w, key);
        return i < 0 || !(at >= 0.0 && at <= w.rods[static_cast<std::size_t>(i)].model.definition().length);
    };
    std::uint32_t lastPart = 0, lastIsland = 0;
    for (const step::Link& l : w.links) {
        if (l.kind > step::LinkKind::Tether || l.end > step::LinkEnd::Rod)
            return refused("a joint is of an unknown kind");
        if (outside(l.rodA, l.sA) || (l.end == step::LinkEnd::Rod && outside(l.rodB, l.sB)))
            return refused("a joint lies outside its shell");
        lastPart = std::max(lastPart, l.key);
    }
    for (const step::Rod& r : w.rods) {
        const auto count = [&](const auto& list) {
            for (const auto& part : list)
                lastPart = std::max(lastPart, part.key);
        };
        count(r.holds), count(r.forces), count(r.mouseJoints);
        lastIsland = std::max(lastIsland, r.island);
    }
    for (const step::Body& b : w.bodies)
        lastIsland = std::max(lastIsland, b.island);
    if (w.nextPart <= lastPart)
        return refused("the next hold, force or joint would get a key that is in use");
    if (w.nextIsland <= lastIsland)
        return refused("the next sleeping island would get a number that is in use");
    for (const step::HostRow& r : w.constraints.rows)
        if (r.kind > step::HostRowKind::Limit || r.saturated < -1 || r.saturated > 1)
            return refused("a constraint of the host is malformed");
    return {};
}

/// Counts that grow must not come to the end of their range; limits that loops count to must be some.
Status checkCounts(const step::World& w, const step::Settings& s) {
    constexpr int most = 1 << 20;
    for (const step::Rod& r : w.rods)
        if (r.cuts < 0 || r.cuts > most)
            return refused("a shell's number of cuts is out of range");
    constexpr std::uint64_t mostSteps = std::uint64_t{1} << 62U;
    if (w.counters.steps > mostSteps || w.counters.unconverged > mostSteps)
        return refused("its number of steps is out of range");
    const coulomb::SolverOptions& c = s.contact;
    if (s.maxIterations < 1 || c.method > coulomb::Method::None || c.maxPivots < 0 || c.maxPivots > most)
        return refused("its settings of the contact solver are out of range");
    return {};
}

/// Checks the consistency of a state whose fields could all be read.
Status checkConsistency(const archive::State& s) {
    const step::World& w = s.world;
    const auto rods = static_cast<std::int64_t>(w.rods.size());
    for (std::size_t i = 0; i < w.rods.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if (w.rods[i].key == w.rods[k].key)
                return refused("two shells have the same key");
    // The next shell takes nextKey, below the limit of contact ids; there a key that is free.
    constexpr std::uint32_t keyLimit = 1U << 20U;
    if (w.nextKey == 0 || w.nextKey > keyLimit ||
        std::any_of(w.rods.begin(), w.rods.end(), [&](const step::Rod& r) { return r.key == 0 || r.key >= w.nextKey; }))
        return refused("the key of a shell, or of the next one, is 0 or out of order");
    for (const Slot& slot : s.slots)
        if (slot.key != 0 &&
            std::none_of(w.rods.begin(), w.rods.end(), [&](const step::Rod& r) { return r.key == slot.key; }))
            return refused("a handle refers to no shell");
    std::vector<std::uint32_t> handled;
    for (const Slot& slot : s.slots) {
        if (slot.key != 0)
            handled.push_back(slot.key);
        if (slot.generation == std::numeric_limits<std::uint32_t>::max())
            return refused("a handle was given out too often");
    }
    std::sort(handled.begin(), handled.end());
    if (!invariants::strictlyRising(handled))
        return refused("two handles refer to one shell");
    for (std::size_t i = 1; i < w.bodies.size(); ++i)
        if (w.bodies[i - 1].id >= w.bodies[i].id)
            return refused("bodies are out of order");
    for (const step::BodyOutline& o : w.outlines) {
        if (std::none_of(w.bodies.begin(), w.bodies.end(), [&](const step::Body& b) { return b.id == o.body; }))
            return refused("an outline belongs to no body");
        const std::size_t points = o.local.kind == contact::OutlineKind::Circle    ? 1
                                   : o.local.kind == contact::OutlineKind::Polygon ? 3
                                                                                   : 2;
        if (o.local.kind > contact::OutlineKind::Polygon || o.local.points.size() < points)
            return refused("an outline is malformed");
        const std::vector<contact::VertexSeam>& seams = o.local.seams.vertices;
        if (!seams.empty() && seams.size() != o.local.points.size())
            return refused("the seams of an outline do not fit its points");
    }
    if (!std::is_sorted(w.outlines.begin(), w.outlines.end(), step::before))
        return refused("outlines are out of order");
    for (const contact::Candidate& c : w.candidates) {
        const auto outside = [&](const contact::RodPoint& p) {
            if (p.rod < 0 || p.rod >= rods)
                return true;
            const rod::RodModel& model = w.rods[static_cast<std::size_t>(p.rod)].model;
            const double length = model.definition().length; // a place is found from it by a cast to an integer
            return p.element < 0 || p.element >= model.elements() || !(std::abs(p.s) <= 2.0 * length);
        };
        const bool rigid = c.b.rod < 0;
        if (outside(c.a) || (!rigid && outside(c.b)) ||
            (rigid && (c.outline < 0 || c.outline >= static_cast<std::int64_t>(w.outlines.size()))))
            return refused("a contact refers to a missing shell or body");
        if (contact::betweenRods(c.id) == rigid || (!rigid && c.outline >= 0))
            return refused("a contact of two shells is one with a body, or the reverse");
    }
    if (!w.range.empty() && w.range.size() != w.rods.size())
        return refused("contact ranges do not fit the shells");
    for (const step::Overlap& o : w.overlaps) {
        const auto length = [&](std::uint32_t key) {
            const int i = step::rodIndex(w, key);
            return i < 0 ? -1.0 : w.rods[static_cast<std::size_t>(i)].model.definition().length;
        };
        const double lengthA = length(o.rodA), lengthB = o.rodB != 0 ? length(o.rodB) : 0.0;
        for (const contact::Push& p : o.pushes)
            if (!(p.sA >= 0.0 && p.sA <= lengthA && p.sB >= 0.0 && p.sB <= lengthB && p.direction.allFinite()))
                return refused("an overlap refers to a missing shell");
    }
    if (!std::is_sorted(w.overlaps.begin(), w.overlaps.end(),
                        [](const auto& a, const auto& b) { return a.pair() < b.pair(); }))
        return refused("overlaps are out of order");
    if (!std::is_sorted(w.impulses.begin(), w.impulses.end(), [](const auto& a, const auto& b) { return a.id < b.id; }))
        return refused("contact forces are out of order");
    for (const ContactPairState& t : s.detector.pairs)
        if (t.pair.a == 0)
            return refused("a contact pair has no shell");
    for (const SnapState& snap : s.detector.snaps)
        if (snap.bucket < 0 || snap.filled < 0 || snap.filled > SnapState::kBuckets)
            return refused("an energy history is malformed");
    if (Status parts = checkParts(w); !parts)
        return parts;
    if (Status counts = checkCounts(w, s.settings); !counts)
        return counts;
    if (!(w.time >= 0.0) || std::isinf(w.time)) // buckets of energies are numbered from time 0
        return refused("the time is negative or not finite");
    if (!(s.detector.settings.snap_time > 0.0) || !(s.detector.settings.snap_energy > 0.0))
        return refused("a number is not finite or not positive");
    return {};
}

Result<archive::State> parse(const std::vector<std::uint8_t>& file) {
    using Parsed = Result<archive::State>;
    const auto start = archive::unwrap(kStateKind, file);
    if (!start)
        return Parsed::failure(start.error());
    Loader in(file.data() + *start, file.size() - *start);
    archive::State state;
    archive::ioState(in, state.slots, state.advanced, state.world, state.settings, state.detector, state.effectsOfNew);
    if (in.fault().empty() && in.left() != 0)
        in.fail("it continues after its end");
    if (in.fault().empty())
        in.fail(checkConsistency(state).error());
    return in.fault().empty() ? Parsed(std::move(state)) : Parsed::failure("SCSTATE: " + in.fault());
}

} // namespace

Result<Snapshot> Snapshot::from_bytes(std::vector<std::uint8_t> bytes) {
    try {
        if (const auto parsed = parse(bytes); !parsed)
            return Result<Snapshot>::failure(parsed.error());
    } catch (const std::exception& e) {
        return Result<Snapshot>::failure(std::string("SCSTATE: ") + e.what());
    }
    Snapshot s;
    s.bytes_ = std::move(bytes);
    return s;
}

Snapshot Shells::save() const {
    Saver out;
    const Impl& m = *impl_;
    if (m.gone)
        return {};
    archive::ioState(out, m.slots, m.advanced, m.world, m.stepper.settings(), m.detector.state, m.effectsOfNew);
    Snapshot s;
    s.bytes_ = archive::wrap(kStateKind, out.bytes);
    s.origin_ = m.worldId;
    return s;
}

std::uint64_t Shells::hash() const {
    Hasher out;
    const Impl& m = *impl_;
    archive::ioState(out, m.slots, m.advanced, m.world, m.stepper.settings(), m.detector.state, m.effectsOfNew);
    return out.hash;
}

Status Shells::restore(const Snapshot& snapshot) {
    return impl_->change([&] {
        Result<archive::State> parsed = parse(snapshot.bytes_);
        if (!parsed)
            return refused(parsed.error());
        archive::State& state = *parsed;
        Impl& m = *impl_;
        const int threads = m.stepper.settings().threads;
        const bool ours = snapshot.origin_ == m.worldId;
        std::vector<Slot> slots = std::move(state.slots);
        if (!ours) { // a new world id makes all handles given out so far stale
            m.worldId = Impl::nextWorldId();
            m.slots.clear();
        }
        slots.resize(std::max(slots.size(), m.slots.size()));
        for (std::size_t i = 0; i < slots.size(); ++i) // no generation is given out twice
            slots[i].highest = std::max(slots[i].generation, i < m.slots.size() ? m.slots[i].highest : 0);
        if (ours)
            state.world.nextPart = std::max(state.world.nextPart, m.world.nextPart);
        for (ContactPairState& t : state.detector.pairs)
            for (ShellHandle* h : {&t.last.a, &t.last.b})
                h->world = h->null() ? 0 : m.worldId;
        for (const Slot& slot : slots)
            SC_ASSERT(slot.generation <= slot.highest, "no generation is given out twice");
        m.slots = std::move(slots);
        m.advanced = state.advanced;
        m.world = std::move(state.world);
        m.stepper.settings() = state.settings;
        m.stepper.settings().threads = threads;
        m.detector.state = std::move(state.detector);
        SC_ASSERT(m.world.range.empty() || m.world.range.size() == m.world.rods.size(), "one range a rod");
        m.detector.events = {};
        m.effectsOfNew = std::move(state.effectsOfNew);
        m.startPoses.clear();
        m.recorder.record(Call::Restore, snapshot.bytes_, m.worldId);
        return done();
    });
}

Result<CallLog> CallLog::from_bytes(std::vector<std::uint8_t> bytes) {
    const auto start = archive::unwrap(kLogKind, bytes);
    if (!start)
        return Result<CallLog>::failure(start.error());
    CallLog log;
    Loader in(bytes.data() + *start, bytes.size() - *start);
    in(log.seed_);
    while (in.left() > 0 && in.fault().empty()) {
        Call call{};
        in(call);
        in.skip(in.count());
        if (call < Call::Restore || call >= Call::Count)
            in.fail("it contains an unknown call");
        log.calls_ += call == Call::FrameEnd ? 0 : 1;
        log.frames_ += call == Call::PreStep ? 1 : 0;
    }
    if (!in.fault().empty())
        return Result<CallLog>::failure("SCCALLS: " + in.fault());
    log.bytes_ = std::move(bytes);
    return log;
}

void CallRecorder::start(std::uint64_t seed) {
    content_.bytes.clear();
    content_(seed);
    on_ = true;
}

Status Shells::start_log(std::uint64_t seed) {
    return impl_->change([&] {
        impl_->recorder.start(seed);
        impl_->recorder.record(Call::Restore, save().bytes(), impl_->worldId); // the initial state
        return done();
    });
}

void Shells::stop_log() {
    if (!impl_->gone)
        impl_->recorder.stop();
}

CallLog Shells::log() const {
    Saver nothing;
    nothing(std::uint64_t{0});
    const std::vector<std::uint8_t>& content = impl_->recorder.content();
    return *CallLog::from_bytes(archive::wrap(kLogKind, content.empty() ? nothing.bytes : content));
}

} // namespace supercircle
