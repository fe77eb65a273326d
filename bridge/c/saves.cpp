// Saved states and logs. A saved world is a frame of its own around the shells' snapshot: magic, checksum, the poses
// and velocities of the bodies, the snapshot.

#include "bridge/box2d/box2d_port.h"
#include "bridge/c/world.h"

#include <algorithm>

using namespace supercircle::c;
using supercircle::BodyId;
using supercircle::CallLog;
using supercircle::Snapshot;

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr char kMagic[8] = {'S', 'C', 'W', 'O', 'R', 'L', 'D', '1'};
constexpr std::size_t kHeader = sizeof kMagic + 2 * sizeof(std::uint64_t);
constexpr std::size_t kKnown = 16; ///< saves whose handles become valid again

struct SavedBody {
    std::uint64_t id = 0;
    float x = 0, y = 0, angle = 0, vx = 0, vy = 0, spin = 0;
    std::uint32_t awake = 0, type = 0;
};
static_assert(sizeof(SavedBody) == 40, "no padding is saved");

std::uint64_t checksum(const std::uint8_t* first, std::size_t count) {
    std::uint64_t h = 14695981039346656037ULL;
    for (std::size_t i = 0; i < count; ++i)
        h = (h ^ first[i]) * 1099511628211ULL;
    return h;
}

template <class T>
void append(Bytes& bytes, const T& value) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof value);
}
template <class T>
T readAt(const std::uint8_t* first, std::size_t offset) {
    T value;
    std::memcpy(&value, first + offset, sizeof value);
    return value;
}

SavedBody saved(const World& w, const b2Body& b) {
    const b2Transform& t = b.GetTransform();
    const b2Vec2 v = b.GetLinearVelocity();
    return {w.attachment.body_id(b),
            t.p.x,
            t.p.y,
            b.GetAngle(),
            v.x,
            v.y,
            b.GetAngularVelocity(),
            b.IsAwake() ? 1U : 0U,
            static_cast<std::uint32_t>(b.GetType())};
}

Bytes save(World& w) {
    Bytes bytes;
    for (const b2Body* b = w.box2d->GetBodyList(); b != nullptr; b = b->GetNext())
        append(bytes, saved(w, *b));
    const std::uint64_t bodies = bytes.size() / sizeof(SavedBody);
    Snapshot shells = w.shells.save();
    bytes.insert(bytes.end(), shells.bytes().begin(), shells.bytes().end());
    Bytes out(kMagic, kMagic + sizeof kMagic);
    append(out, checksum(bytes.data(), bytes.size()));
    append(out, bodies);
    out.insert(out.end(), bytes.begin(), bytes.end());
    if (w.saved.empty() || !(w.saved.back() == shells))
        w.saved.push_back(std::move(shells));
    if (w.saved.size() > kKnown)
        w.saved.pop_front();
    return out;
}

std::vector<SavedBody> readBodies(World& w, const std::uint8_t* bytes, std::size_t size, std::size_t& offset) {
    if (size < kHeader || !std::equal(kMagic, kMagic + sizeof kMagic, bytes))
        refuse(SC_BAD_INPUT, "these bytes are no saved world (sc_world_save)");
    if (readAt<std::uint64_t>(bytes, sizeof kMagic) != checksum(bytes + kHeader, size - kHeader))
        refuse(SC_BAD_INPUT, "the saved world is damaged: its checksum does not fit");
    const std::uint64_t count = readAt<std::uint64_t>(bytes, sizeof kMagic + sizeof(std::uint64_t));
    if (count > (size - kHeader) / sizeof(SavedBody))
        refuse(SC_BAD_INPUT, "the saved world is damaged: it is too short");
    std::vector<SavedBody> bodies(static_cast<std::size_t>(count));
    if (count > 0)
        std::memcpy(bodies.data(), bytes + kHeader, bodies.size() * sizeof(SavedBody));
    offset = kHeader + bodies.size() * sizeof(SavedBody);
    for (const SavedBody& s : bodies) {
        const b2Body* b = w.attachment.body(s.id);
        if (b == nullptr || static_cast<std::uint32_t>(b->GetType()) != s.type)
            refuse(SC_REFUSED, "body " + std::to_string(s.id) +
                                   " of the saved world is missing here; restore into a world with the same bodies");
        for (const float f : {s.x, s.y, s.angle, s.vx, s.vy, s.spin})
            if (!(std::abs(f) < 1e7F))
                refuse(SC_BAD_INPUT, "the saved world is damaged: a number is not finite");
    }
    return bodies;
}

Snapshot snapshotOf(const World& w, Bytes bytes) {
    for (const Snapshot& known : w.saved)
        if (known.bytes() == bytes)
            return known; // with its handles
    auto read = Snapshot::from_bytes(std::move(bytes));
    return done(read);
}

int32_t sizeOf(std::size_t bytes) {
    if (bytes > 0x7fffffff)
        refuse(SC_NO_MEMORY, "more than 2 GiB");
    return static_cast<int32_t>(bytes);
}

int32_t copyBytes(const Bytes& bytes, std::uint8_t* out, int32_t capacity) {
    const int32_t size = sizeOf(bytes.size());
    if (capacity > 0)
        std::copy_n(bytes.begin(), std::min(size, capacity), out);
    return size;
}

Bytes bytesOf(const std::uint8_t* bytes, int32_t count) {
    if (count < 1)
        refuse(SC_BAD_INPUT, "the count of bytes is not positive");
    return {&given(bytes, "the bytes"), bytes + count};
}

} // namespace

int32_t sc_world_save(sc_world w, uint8_t* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        x.requireUnlocked();
        return copyBytes(save(x), out, capacity);
    });
}

sc_status sc_world_restore(sc_world w, const uint8_t* bytes, int32_t count) {
    return use(w, [&](World& x) {
        x.requireUnlocked();
        const Bytes all = bytesOf(bytes, count);
        std::size_t offset = 0;
        const std::vector<SavedBody> bodies = readBodies(x, all.data(), all.size(), offset);
        const Snapshot shells = snapshotOf(x, Bytes(all.begin() + static_cast<std::ptrdiff_t>(offset), all.end()));
        done(x.shells.restore(shells));
        for (const SavedBody& s : bodies) {
            b2Body* b = x.attachment.body(s.id);
            if (b->GetType() == b2_staticBody)
                continue;
            b->SetTransform({s.x, s.y}, s.angle);
            b->SetLinearVelocity({s.vx, s.vy});
            b->SetAngularVelocity(s.spin);
            b->SetAwake(s.awake != 0);
        }
        x.zoneEvents.clear();
        x.zones.sweep([](std::uint64_t, Zone& z) {
            z.inside.clear();
            return false;
        });
    });
}

sc_status sc_log_start(sc_world w, uint64_t seed) {
    return use(w, [&](World& x) { done(x.shells.start_log(seed)); });
}

int32_t sc_log_read(sc_world w, uint8_t* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        return copyBytes(x.shells.log().bytes(), out, capacity);
    });
}

sc_status sc_log_stop(sc_world w) {
    return use(w, [&](World& x) { x.shells.stop_log(); });
}

sc_status sc_log_replay(sc_world w, const uint8_t* bytes, int32_t count) {
    return use(w, [&](World& x) {
        if (!x.own)
            refuse(SC_REFUSED, "a log is replayed in a world with bodies of its own (sc_world_create)");
        const auto log = CallLog::from_bytes(bytesOf(bytes, count));
        const auto step = [&](double dt) {
            if (!(dt > 0.0 && std::isfinite(dt)))
                return false;
            x.box2d->Step(static_cast<float>(dt), x.velocityIterations, x.positionIterations);
            x.attachment->stepped(dt);
            return true;
        };
        done(x.shells.replay(done(log), step));
    });
}
