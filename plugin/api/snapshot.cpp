// What is hidden history and what is not (checked by tests/plugin/api/test_snapshot.cpp): candidates and their range
// are part of the world, because a list made for a longer motion holds more speculative contacts; the detector's cached
// pairs, the solver's work space and the attempt's are not, their results do not depend on what was there before. Poses
// of driven bodies live in the world (step::Body), not in the port. The feed-forward of dynamic bodies does, too.

#include "plugin/api/snapshot_fields.h"

#include <algorithm>
#include <cmath>

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

std::vector<std::uint8_t> wrap(const Kind& kind, const std::vector<std::uint8_t>& content) {
    Saver out;
    for (int i = 0; i < 8; ++i)
        out.word(static_cast<std::uint8_t>(kind.name[i]), 1);
    out.word(kind.version, 4);
    out.word(content.size(), 8);
    out.word(hashOf(content.data(), content.size()), 8);
    out.bytes.insert(out.bytes.end(), content.begin(), content.end());
    return std::move(out.bytes);
}

std::size_t unwrap(const Kind& kind, const std::vector<std::uint8_t>& file, std::string& fault) {
    Loader in(file.data(), file.size());
    bool same = file.size() >= 8;
    for (int i = 0; i < 8 && same; ++i)
        same = in.word(1) == static_cast<std::uint8_t>(kind.name[i]);
    const std::string name(kind.name);
    if (!same) {
        fault = "these bytes are no " + name + " file";
        return 0;
    }
    const std::uint64_t version = in.word(4), size = in.word(8), sum = in.word(8);
    if (in.fault().empty() && version != kind.version)
        fault = name + ": written as version " + std::to_string(version) + ", this program reads version " +
                std::to_string(kind.version);
    else if (!in.fault().empty() || size != in.left())
        fault = name + ": it is cut off or has something behind its end";
    else if (hashOf(in.at(), in.left()) != sum)
        fault = name + ": its checksum is wrong, the bytes are damaged";
    return file.size() - in.left();
}

} // namespace archive

namespace {

constexpr archive::Kind kStateKind{"SCSTATE ", 6};
constexpr archive::Kind kLogKind{"SCCALLS ", 1};

/// What is wrong with a state whose fields could all be read; empty if nothing.
std::string faultOf(const archive::State& s) {
    const step::World& w = s.world;
    const auto rods = static_cast<std::int64_t>(w.rods.size());
    for (std::size_t i = 0; i < w.rods.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if (w.rods[i].key == w.rods[k].key)
                return "two shells have the same key";
    for (const Slot& slot : s.slots)
        if (slot.key != 0 &&
            std::none_of(w.rods.begin(), w.rods.end(), [&](const step::Rod& r) { return r.key == slot.key; }))
            return "a handle leads to no shell";
    for (std::size_t i = 1; i < w.bodies.size(); ++i)
        if (w.bodies[i - 1].id >= w.bodies[i].id)
            return "bodies are out of order";
    for (const step::BodyOutline& o : w.outlines) {
        if (std::none_of(w.bodies.begin(), w.bodies.end(), [&](const step::Body& b) { return b.id == o.body; }))
            return "an outline belongs to no body";
        const std::size_t points = o.local.kind == contact::OutlineKind::Circle    ? 1
                                   : o.local.kind == contact::OutlineKind::Polygon ? 3
                                                                                   : 2;
        if (o.local.kind > contact::OutlineKind::Polygon || o.local.points.size() < points)
            return "an outline is malformed";
    }
    for (const contact::Candidate& c : w.candidates) {
        const auto outside = [&](const contact::RodPoint& p) {
            return p.rod < 0 || p.rod >= rods || p.element < 0 ||
                   p.element >= w.rods[static_cast<std::size_t>(p.rod)].model.elements();
        };
        const bool rigid = c.b.rod < 0;
        if (outside(c.a) || (!rigid && outside(c.b)) ||
            (rigid && (c.outline < 0 || c.outline >= static_cast<std::int64_t>(w.outlines.size()))))
            return "a contact is between nobody";
    }
    if (!w.range.empty() && w.range.size() != w.rods.size())
        return "contact ranges do not fit the shells";
    if (!std::is_sorted(w.impulses.begin(), w.impulses.end(), [](const auto& a, const auto& b) { return a.id < b.id; }))
        return "contact forces are out of order";
    for (const TouchState& t : s.watched.touching)
        if (t.pair.a == 0)
            return "a touching pair has no shell";
    for (const SnapState& snap : s.watched.snaps)
        if (snap.bucket < 0 || snap.filled < 0 || snap.filled > SnapState::kBuckets)
            return "an energy history is malformed";
    if (!std::isfinite(w.time) || !(s.watched.settings.snap_time > 0.0) || !(s.watched.settings.snap_energy > 0.0))
        return "a number is not finite or not positive";
    return {};
}

std::string parse(const std::vector<std::uint8_t>& file, archive::State& state) {
    std::string fault;
    const std::size_t start = archive::unwrap(kStateKind, file, fault);
    if (!fault.empty())
        return fault;
    Loader in(file.data() + start, file.size() - start);
    archive::ioState(in, state.slots, state.advanced, state.world, state.settings, state.watched);
    if (in.fault().empty() && in.left() != 0)
        in.fail("it has something behind its end");
    if (in.fault().empty())
        in.fail(faultOf(state));
    return in.fault().empty() ? std::string() : "SCSTATE: " + in.fault();
}

} // namespace

Result<Snapshot> Snapshot::from_bytes(std::vector<std::uint8_t> bytes) {
    archive::State state;
    try {
        if (std::string why = parse(bytes, state); !why.empty())
            return Result<Snapshot>::failure(std::move(why));
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
    archive::ioState(out, m.slots, m.advanced, m.world, m.stepper.settings(), m.watch.state);
    Snapshot s;
    s.bytes_ = archive::wrap(kStateKind, out.bytes);
    s.origin_ = m.tag;
    return s;
}

std::uint64_t Shells::hash() const {
    Hasher out;
    const Impl& m = *impl_;
    archive::ioState(out, m.slots, m.advanced, m.world, m.stepper.settings(), m.watch.state);
    return out.hash;
}

Outcome Shells::restore(const Snapshot& snapshot) {
    return impl_->change([&] {
        archive::State state;
        if (std::string why = parse(snapshot.bytes_, state); !why.empty())
            return refused(std::move(why));
        Impl& m = *impl_;
        const int threads = m.stepper.settings().threads;
        const bool ours = snapshot.origin_ == m.tag;
        std::vector<Slot> slots = std::move(state.slots);
        if (!ours) { // a new name for the world makes every handle given out so far stale
            m.tag = Impl::nextTag();
            m.slots.clear();
        }
        slots.resize(std::max(slots.size(), m.slots.size()));
        for (std::size_t i = 0; i < slots.size(); ++i) // none given out since the snapshot is given out again
            slots[i].highest = std::max(slots[i].generation, i < m.slots.size() ? m.slots[i].highest : 0);
        if (ours)
            state.world.nextPart = std::max(state.world.nextPart, m.world.nextPart);
        for (TouchState& t : state.watched.touching)
            for (ShellHandle* h : {&t.last.a, &t.last.b})
                h->world = h->null() ? 0 : m.tag;
        m.slots = std::move(slots);
        m.advanced = state.advanced;
        m.world = std::move(state.world);
        m.stepper.settings() = state.settings;
        m.stepper.settings().threads = threads;
        m.watch.state = std::move(state.watched);
        m.watch.events = {};
        m.recorder.record(Call::Restore, snapshot.bytes_, m.tag);
        return done();
    });
}

Result<CallLog> CallLog::from_bytes(std::vector<std::uint8_t> bytes) {
    std::string fault;
    const std::size_t start = archive::unwrap(kLogKind, bytes, fault);
    CallLog log;
    if (fault.empty()) {
        Loader in(bytes.data() + start, bytes.size() - start);
        in(log.seed_);
        while (in.left() > 0 && in.fault().empty()) {
            Call call{};
            in(call);
            in.skip(in.count());
            if (call < Call::Restore || call >= Call::Count)
                in.fail("it holds a call that does not exist");
            log.calls_ += call == Call::FrameEnd ? 0 : 1;
            log.frames_ += call == Call::PreStep ? 1 : 0;
        }
        fault = in.fault().empty() ? std::string() : "SCCALLS: " + in.fault();
    }
    if (!fault.empty())
        return Result<CallLog>::failure(std::move(fault));
    log.bytes_ = std::move(bytes);
    return log;
}

void CallRecorder::start(std::uint64_t seed) {
    content_.bytes.clear();
    content_(seed);
    on_ = true;
}

Outcome Shells::start_log(std::uint64_t seed) {
    return impl_->change([&] {
        impl_->recorder.start(seed);
        impl_->recorder.record(Call::Restore, save().bytes(), impl_->tag); // what everything starts from
        return done();
    });
}

void Shells::stop_log() {
    impl_->recorder.stop();
}

CallLog Shells::log() const {
    Saver nothing;
    nothing(std::uint64_t{0});
    const std::vector<std::uint8_t>& content = impl_->recorder.content();
    return *CallLog::from_bytes(archive::wrap(kLogKind, content.empty() ? nothing.bytes : content));
}

} // namespace supercircle
