// The detector: which pairs can touch, and which of their features.
//
// Rods and outlines are frozen in snapshots, each with an allowance: as long as motion bound + displacement since the
// snapshot stays within the allowance, every list of checks made from snapshots grown by their allowances is complete.
// Who leaves his allowance gets a new snapshot, and only his pairs are listed again. The lists decide what is looked
// at, never what is found: whatever is in reach is found by checks that any complete list contains, in the same order.
// (Global rebuilds when anything moves far, and expiry by accumulated travel, were rejected: one falling shell would
// pay for a thousand resting ones, and a trembling one would expire without going anywhere.)

#include "supercircle/contact/detection.h"
#include "supercircle/contact/detection/snapshot.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>

namespace supercircle::contact {

namespace {

struct Filter {
    std::uint32_t category = 0;
    std::uint32_t mask = 0;
    std::int32_t group = 0;
    bool operator==(const Filter&) const = default;
};

bool mayTouchItself(const Filter& a) {
    return (a.category & a.mask) != 0;
}

bool mayTouch(const Filter& a, const Filter& b) {
    if (a.group != 0 && a.group == b.group)
        return a.group > 0;
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

struct RodState {
    RodShape shape;
    std::vector<Arc> arcs; ///< what the shape was prepared from
    std::vector<double> nodeS;
    double midS = 0.0;
    bool resting = false;
    RodSnapshot snapshot;
    Box box; ///< of the snapshot, grown by half thickness and allowance
    Filter filter;
    std::uint32_t key = 0;
    double half = 0.0;
    double allowance = -1.0;
    double displaced = 0.0; ///< since the snapshot, m
    bool known = false;
    bool fresh = false;   ///< new snapshot in this call
    bool renamed = false; ///< new key in this call
};

struct OutlineState {
    OutlineShape shape;
    OutlineShape frozen;
    OutlinePoints points; ///< of the snapshot
    Box box;
    Filter filter;
    std::uint32_t key = 0;
    double allowance = -1.0;
    bool known = false;
    bool fresh = false;
};

struct Checks {
    RodPairChecks rods;
    OutlinePairChecks outline;
};

/// A pair on the list; `checks` indexes the pool, whose vectors keep their storage when pairs go.
struct Pair {
    std::uint32_t keyA = 0; ///< of the rod; of two rods the smaller key
    std::uint32_t keyB = 0;
    bool rigid = false; ///< B is an outline
    std::int32_t a = 0;
    std::int32_t b = 0;
    std::int32_t checks = 0;
    bool idle = false; ///< has no checks
    bool operator<(const Pair& o) const {
        if (rigid != o.rigid)
            return o.rigid;
        return keyA != o.keyA ? keyA < o.keyA : keyB < o.keyB;
    }
};

struct SweepItem {
    double low = 0.0;
    std::int32_t rod = 0;
    bool operator<(const SweepItem& o) const { return low != o.low ? low < o.low : rod < o.rod; }
};

/// Is the rod's shape what this curve gives, to the last digit?
bool prepared(const RodState& rod, const Curve& curve) {
    const auto bits = [](double x, double y) { // 0 and -0 give different digits
        return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
    };
    const auto same = [bits](const Arc& a, const Arc& b) {
        return bits(a.start.x(), b.start.x()) && bits(a.start.y(), b.start.y()) && bits(a.angle, b.angle) &&
               bits(a.curvature, b.curvature) && bits(a.length, b.length);
    };
    return rod.known && rod.shape.halfThickness == curve.halfThickness && rod.shape.closed == curve.closed &&
           rod.midS == curve.midS && rod.arcs.size() == curve.arcs.size() && rod.nodeS.size() == curve.nodeS.size() &&
           std::equal(rod.arcs.begin(), rod.arcs.end(), curve.arcs.begin(), same) && rod.nodeS == curve.nodeS &&
           curve.motion >= 0.0;
}

double displacement(const OutlineState& state, const Outline& now) {
    double moved = 0.0;
    for (std::size_t i = 0; i < now.points.size(); ++i)
        moved = std::max(moved, (now.points[i] - state.points[i]).squaredNorm());
    return std::sqrt(moved);
}

/// What is granted beyond what is needed now: room for a few more steps like this one.
double grant(double motion, double size) {
    return 3.0 * motion + size;
}

/// Work of one thread at a time: a rod's preparation takes some microseconds, a pair's checks about one.
constexpr std::size_t kRodGrain = 16;
constexpr std::size_t kPairGrain = 32;

/// What one chunk of pairs needs and finds.
struct Chunk {
    Collector collector;
    std::vector<Candidate> found;
};

constexpr std::uint32_t kKeyLimit = 1U << 20U;

} // namespace

struct Detector::Impl {
    std::vector<RodState> rods;
    std::vector<OutlineState> outlines;
    std::vector<Pair> pairs;
    std::vector<Pair> added;
    std::vector<Pair> merged;
    std::vector<Checks> pool;
    std::vector<std::int32_t> free;
    std::vector<SweepItem> sweep;
    std::vector<std::uint32_t> keys;
    std::vector<const Pair*> awake;
    std::vector<Chunk> chunks;
    double margin = -1.0;

    void forget();
    void checkKeys();
    void updateRod(const Curve& curve, RodState& rod) const;
    void updateRods(const std::vector<Curve>& curves, const parallel::For& loop);
    void updateOutlines(const std::vector<Outline>& given);
    void updatePairs();
    void sortSweep(int axis);
    void findRodPairs();
    void findOutlinePairs();
    void addPair(std::int32_t a, std::int32_t b, bool rigid);
    bool listChecks(const Pair& pair);
    void evaluate(const Pair& pair, const std::vector<Curve>& curves, const std::vector<Outline>& given,
                  Collector& collector, std::vector<Candidate>& out) const;
};

void Detector::Impl::forget() {
    for (RodState& rod : rods)
        rod.known = false;
    for (OutlineState& outline : outlines)
        outline.known = false;
}

/// Distinct keys below 2^20: ids are made of them.
void Detector::Impl::checkKeys() {
    const auto check = [this](const char* what) {
        std::sort(keys.begin(), keys.end());
        for (std::size_t i = 0; i < keys.size(); ++i) {
            if (keys[i] >= kKeyLimit)
                throw std::invalid_argument(std::string("contact detection: ") + what + " key " +
                                            std::to_string(keys[i]) + " is not below 2^20");
            if (i > 0 && keys[i] == keys[i - 1])
                throw std::invalid_argument(std::string("contact detection: two of the ") + what + "s have key " +
                                            std::to_string(keys[i]));
        }
    };
    keys.clear();
    for (const RodState& rod : rods)
        keys.push_back(rod.key);
    check("rod");
    keys.clear();
    for (const OutlineState& outline : outlines)
        keys.push_back(outline.key);
    check("outline");
}

void Detector::Impl::updateRod(const Curve& curve, RodState& rod) const {
    const bool unchanged = prepared(rod, curve);
    if (!unchanged) {
        prepare(curve, rod.shape);
        rod.arcs = curve.arcs;
        rod.nodeS = curve.nodeS;
        rod.midS = curve.midS;
    }
    rod.resting = curve.resting;
    const Filter filter{curve.category, curve.mask, curve.group};
    rod.renamed = rod.key != curve.key || !rod.known;
    const double size = std::max(curve.halfThickness, 0.5 * margin);
    const double granted = grant(curve.motion, size);
    // A wide allowance makes long lists, which nobody reads while the rod rests.
    rod.fresh = !rod.known || rod.key != curve.key || rod.filter != filter || rod.half != curve.halfThickness ||
                (rod.allowance > 3.0 * granted && !curve.resting);
    if (!rod.fresh && !(unchanged && rod.displaced + curve.motion <= rod.allowance)) {
        rod.displaced = displacement(rod.shape, rod.snapshot);
        rod.fresh = !(rod.displaced + curve.motion <= rod.allowance);
    }
    rod.known = true;
    if (!rod.fresh)
        return;
    rod.key = curve.key;
    rod.filter = filter;
    rod.half = curve.halfThickness;
    rod.allowance = granted;
    rod.displaced = 0.0;
    takeSnapshot(rod.shape, rod.snapshot);
    rod.box = rod.snapshot.box.grown(rod.half + rod.allowance + 0.5 * margin);
}

void Detector::Impl::updateRods(const std::vector<Curve>& curves, const parallel::For& loop) {
    rods.resize(curves.size());
    parallel::forChunks(loop, rods.size(), kRodGrain, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            updateRod(curves[i], rods[i]);
    });
    if (std::any_of(rods.begin(), rods.end(), [](const RodState& rod) { return rod.renamed; }))
        checkKeys();
}

void Detector::Impl::updateOutlines(const std::vector<Outline>& given) {
    outlines.resize(given.size());
    bool newKeys = false;
    for (std::size_t i = 0; i < given.size(); ++i) {
        const Outline& now = given[i];
        OutlineState& state = outlines[i];
        prepare(now, state.shape);
        const Filter filter{now.category, now.mask, now.group};
        if (state.key != now.key || !state.known)
            newKeys = true;
        const double granted = grant(now.motion, margin);
        const OutlineShape& old = state.frozen;
        const bool same = state.known && state.key == now.key && state.filter == filter && old.kind == now.kind &&
                          old.radius == now.radius && state.points.size() == now.points.size() &&
                          old.corners.size() == state.shape.corners.size();
        state.fresh =
            !same || state.allowance > 3.0 * granted || !(displacement(state, now) + now.motion <= state.allowance);
        state.known = true;
        if (!state.fresh)
            continue;
        state.key = now.key;
        state.filter = filter;
        state.allowance = granted;
        state.frozen = state.shape;
        state.points = now.points;
        state.box = boxOf(state.frozen, state.points).grown(state.allowance + 0.5 * margin);
    }
    if (newKeys)
        checkKeys();
}

void Detector::Impl::addPair(std::int32_t a, std::int32_t b, bool rigid) {
    Pair pair;
    pair.rigid = rigid;
    if (!rigid && rods[static_cast<std::size_t>(b)].key < rods[static_cast<std::size_t>(a)].key)
        std::swap(a, b);
    pair.a = a;
    pair.b = b;
    pair.keyA = rods[static_cast<std::size_t>(a)].key;
    pair.keyB = rigid ? outlines[static_cast<std::size_t>(b)].key : rods[static_cast<std::size_t>(b)].key;
    if (free.empty()) {
        free.push_back(static_cast<std::int32_t>(pool.size()));
        pool.emplace_back();
    }
    pair.checks = free.back();
    free.pop_back();
    pair.idle = !listChecks(pair);
    added.push_back(pair);
}

/// False if there is nothing to check.
bool Detector::Impl::listChecks(const Pair& pair) {
    const RodState& a = rods[static_cast<std::size_t>(pair.a)];
    Checks& checks = pool[static_cast<std::size_t>(pair.checks)];
    if (pair.rigid) {
        const OutlineState& b = outlines[static_cast<std::size_t>(pair.b)];
        OutlinePairChecks& list = checks.outline;
        collectChecks(a.snapshot, b.frozen, a.half + margin + a.allowance + b.allowance, list);
        return !(list.samples.empty() && list.pieces.empty() && list.corners.empty());
    }
    const RodState& b = rods[static_cast<std::size_t>(pair.b)];
    const double reach = a.half + b.half + margin + a.allowance + b.allowance;
    RodPairChecks& list = checks.rods;
    if (pair.a == pair.b)
        collectSelfChecks(a.snapshot, reach, list);
    else
        collectChecks(a.snapshot, b.snapshot, reach, list);
    return !(list.samplesOfA.empty() && list.samplesOfB.empty() && list.pieces.empty());
}

/// Rods by the lower end of their boxes; nearly sorted from the call before.
void Detector::Impl::sortSweep(int axis) {
    if (sweep.size() != rods.size()) {
        sweep.clear();
        for (std::size_t i = 0; i < rods.size(); ++i)
            sweep.push_back({0.0, static_cast<std::int32_t>(i)});
    }
    for (SweepItem& item : sweep)
        item.low = rods[static_cast<std::size_t>(item.rod)].box.low[axis];
    std::sort(sweep.begin(), sweep.end());
}

void Detector::Impl::findRodPairs() {
    // Sweep along the direction in which the rods are spread widest.
    Box all;
    double width[2] = {0.0, 0.0};
    for (const RodState& rod : rods) {
        all.include(rod.box.low, 0.0);
        all.include(rod.box.high, 0.0);
        for (int k = 0; k < 2; ++k)
            width[k] = std::max(width[k], rod.box.high[k] - rod.box.low[k]);
    }
    const Vec2 extent = all.high - all.low;
    const int axis = extent.x() * width[1] >= extent.y() * width[0] ? 0 : 1;
    sortSweep(axis);
    for (const SweepItem& item : sweep) {
        const RodState& rod = rods[static_cast<std::size_t>(item.rod)];
        if (!rod.fresh)
            continue;
        if (mayTouchItself(rod.filter))
            addPair(item.rod, item.rod, false);
        const SweepItem from{item.low - width[axis], -1};
        for (auto it = std::lower_bound(sweep.begin(), sweep.end(), from); it != sweep.end(); ++it) {
            if (it->low > rod.box.high[axis])
                break;
            const RodState& other = rods[static_cast<std::size_t>(it->rod)];
            if (it->rod == item.rod || (other.fresh && it->rod < item.rod))
                continue; // two fresh rods meet once
            if (overlap(rod.box, other.box) && mayTouch(rod.filter, other.filter))
                addPair(item.rod, it->rod, false);
        }
    }
}

void Detector::Impl::findOutlinePairs() {
    for (std::size_t j = 0; j < outlines.size(); ++j) {
        const OutlineState& outline = outlines[j];
        for (std::size_t i = 0; i < rods.size(); ++i) {
            const RodState& rod = rods[i];
            if (!(rod.fresh || outline.fresh) || !overlap(rod.box, outline.box))
                continue;
            if (mayTouch(rod.filter, outline.filter))
                addPair(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), true);
        }
    }
}

void Detector::Impl::updatePairs() {
    const auto isFresh = [](const auto& state) { return state.fresh; };
    const bool freshRods = std::any_of(rods.begin(), rods.end(), isFresh);
    if (!freshRods && std::none_of(outlines.begin(), outlines.end(), isFresh))
        return;
    const auto stale = [this](const Pair& pair) {
        const bool gone = rods[static_cast<std::size_t>(pair.a)].fresh ||
                          (pair.rigid ? outlines[static_cast<std::size_t>(pair.b)].fresh
                                      : rods[static_cast<std::size_t>(pair.b)].fresh);
        if (gone)
            free.push_back(pair.checks);
        return gone;
    };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), stale), pairs.end());
    added.clear();
    if (freshRods)
        findRodPairs();
    findOutlinePairs();
    std::sort(added.begin(), added.end());
    merged.resize(pairs.size() + added.size());
    std::merge(pairs.begin(), pairs.end(), added.begin(), added.end(), merged.begin());
    pairs.swap(merged);
}

void Detector::Impl::evaluate(const Pair& pair, const std::vector<Curve>& curves, const std::vector<Outline>& given,
                              Collector& collector, std::vector<Candidate>& out) const {
    const auto a = static_cast<std::size_t>(pair.a);
    const auto b = static_cast<std::size_t>(pair.b);
    const Checks& checks = pool[static_cast<std::size_t>(pair.checks)];
    const RodSide rod{&rods[a].shape, pair.a, pair.keyA};
    if (pair.rigid) {
        const OutlineSide outline{&outlines[b].shape, pair.b, pair.keyB};
        evaluateOutlinePair(rod, outline, checks.outline, margin + curves[a].motion + given[b].motion, collector, out);
    } else {
        const RodSide other{&rods[b].shape, pair.b, pair.keyB};
        evaluateRodPair(rod, other, checks.rods, margin + curves[a].motion + curves[b].motion, collector, out);
    }
}

Detector::Detector() : impl_(std::make_unique<Impl>()) {}
Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

void Detector::detect(const std::vector<Curve>& curves, const std::vector<Outline>& outlines,
                      const DetectionOptions& options, std::vector<Candidate>& out, const parallel::For& loop) {
    Impl& m = *impl_;
    out.clear();
    if (!(options.margin >= 0.0))
        throw std::invalid_argument("contact detection: the margin is negative");
    // Indices into the lists are cached in the pairs: another number of rods, or another margin, starts anew.
    if (m.rods.size() != curves.size() || m.outlines.size() != outlines.size() || m.margin != options.margin) {
        m.forget();
        for (const Pair& pair : m.pairs)
            m.free.push_back(pair.checks);
        m.pairs.clear();
        m.margin = options.margin;
    }
    try {
        m.updateRods(curves, loop);
        m.updateOutlines(outlines);
    } catch (...) {
        m.margin = -1.0; // half updated: forget everything at the next call
        throw;
    }
    m.updatePairs();
    m.awake.clear();
    for (const Pair& pair : m.pairs)
        if (!pair.idle && !(m.rods[static_cast<std::size_t>(pair.a)].resting &&
                            (pair.rigid || m.rods[static_cast<std::size_t>(pair.b)].resting)))
            m.awake.push_back(&pair);
    const std::size_t count = parallel::chunkCount(loop, m.awake.size(), kPairGrain);
    if (m.chunks.size() < count)
        m.chunks.resize(count);
    parallel::forChunks(loop, m.awake.size(), kPairGrain, [&](std::size_t c, std::size_t begin, std::size_t end) {
        std::vector<Candidate>& found = count > 1 ? m.chunks[c].found : out;
        found.clear();
        for (std::size_t i = begin; i < end; ++i)
            m.evaluate(*m.awake[i], curves, outlines, m.chunks[c].collector, found);
    });
    for (std::size_t c = 0; count > 1 && c < count; ++c)
        out.insert(out.end(), m.chunks[c].found.begin(), m.chunks[c].found.end());
}

} // namespace supercircle::contact
