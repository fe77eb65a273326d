// The detector decides which pairs can touch, and which of their features.
//
// For every rod and outline it keeps a reference shape and an enlarged box, as a Verlet neighbour list does. As long as
// displacement since the reference + motion bound stays within the enlargement, all lists of checks are complete. A rod
// that exceeds its enlargement gets a new reference, and only its pairs are listed again (decision 0123).
// The lists decide what is checked, not what is found: any complete list finds the same candidates in the same order.

#include "supercircle/contact/detection.h"
#include "supercircle/contact/detection/reference_shape.h"
#include "supercircle/contact/detection/sound_candidate.h"
#include "supercircle/contact/filter.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tuple>

namespace supercircle::contact {

namespace {

struct RodState {
    RodShape shape;
    std::vector<Arc> arcs; ///< from which the shape was prepared
    std::vector<double> nodeS;
    double midS = 0.0;
    bool resting = false;
    ReferenceShape reference;
    Box box; ///< of the reference, enlarged by half thickness and enlargement
    Filter filter;
    std::uint32_t key = 0;
    double half = 0.0;
    double enlargement = -1.0;
    double displaced = 0.0; ///< since the reference, m
    bool valid = false;
    bool rebuilt = false; ///< new reference in this call
    bool newKey = false;  ///< new key in this call
};

struct OutlineState {
    OutlineShape shape;
    OutlineShape reference;
    OutlinePoints points; ///< of the reference
    Box box;
    Filter filter;
    std::uint32_t key = 0;
    double enlargement = -1.0;
    bool valid = false;
    bool rebuilt = false;
};

struct Checks {
    RodPairChecks rods;
    OutlinePairChecks outline;
};

/// A listed pair. `checks` indexes the pool, whose vectors keep their storage when pairs are removed.
struct CandidatePair {
    std::uint32_t keyA = 0; ///< of the rod; for two rods the smaller key
    std::uint32_t keyB = 0;
    bool rigid = false; ///< B is an outline
    std::int32_t a = 0;
    std::int32_t b = 0;
    std::int32_t checks = 0;
    bool empty = false; ///< has no checks
    bool operator<(const CandidatePair& o) const {
        if (rigid != o.rigid)
            return o.rigid;
        return keyA != o.keyA ? keyA < o.keyA : keyB < o.keyB;
    }
};

struct SortedRod {
    double low = 0.0;
    std::int32_t rod = 0;
    bool operator<(const SortedRod& o) const { return low != o.low ? low < o.low : rod < o.rod; }
};

/// True if the rod's shape was prepared from a bitwise identical curve.
bool prepared(const RodState& rod, const RodCurve& curve) {
    const auto bits = [](double x, double y) { // 0 and -0 give different results
        return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
    };
    const auto same = [bits](const Arc& a, const Arc& b) {
        return bits(a.start.x(), b.start.x()) && bits(a.start.y(), b.start.y()) && bits(a.angle, b.angle) &&
               bits(a.curvature, b.curvature) && bits(a.length, b.length);
    };
    return rod.valid && rod.shape.halfThickness == curve.halfThickness && rod.shape.closed == curve.closed &&
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

/// True if the lists of checks, which number the corners, fit both shapes.
bool sameCorners(const OutlineShape& a, const OutlineShape& b) {
    return std::equal(a.corners.begin(), a.corners.end(), b.corners.begin(), b.corners.end(),
                      [](const Corner& x, const Corner& y) { return x.index == y.index; });
}

/// Enlargement of a box beyond the present need, for a few more steps like this one, m.
double enlargementFor(double motion, double size) {
    return 3.0 * motion + size;
}

/// Items per chunk: preparing a rod takes some microseconds, the checks of a pair about one.
constexpr std::size_t kRodGrain = 16;
constexpr std::size_t kPairGrain = 32;

/// Workspace and result of one chunk of pairs.
struct Chunk {
    CandidateReducer reducer;
    std::vector<Candidate> found;
};

constexpr std::uint32_t kKeyLimit = 1U << 20U;

} // namespace

struct Detector::Impl {
    std::vector<RodState> rods;
    std::vector<OutlineState> outlines;
    std::vector<CandidatePair> pairs;
    std::vector<CandidatePair> added;
    std::vector<CandidatePair> merged;
    std::vector<Checks> pool;
    std::vector<std::int32_t> free;
    std::vector<SortedRod> sortedRods;
    std::vector<std::uint32_t> keys;
    std::vector<const CandidatePair*> awake;
    std::vector<Chunk> chunks;
    double margin = -1.0;

    void invalidate();
    void checkKeys();
    void updateRod(const RodCurve& curve, RodState& rod) const;
    void updateRods(const std::vector<RodCurve>& curves, const parallel::For& loop);
    void updateOutlines(const std::vector<Outline>& given);
    void updatePairs();
    void sortRods(int axis);
    void findRodPairs();
    void findOutlinePairs();
    void addPair(std::int32_t a, std::int32_t b, bool rigid);
    bool listChecks(const CandidatePair& pair);
    void evaluate(const CandidatePair& pair, const std::vector<RodCurve>& curves, const std::vector<Outline>& given,
                  CandidateReducer& reducer, std::vector<Candidate>& out) const;
};

void Detector::Impl::invalidate() {
    for (RodState& rod : rods)
        rod.valid = false;
    for (OutlineState& outline : outlines)
        outline.valid = false;
}

/// Keys must be distinct and below 2^20, because ids are made of them.
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

void Detector::Impl::updateRod(const RodCurve& curve, RodState& rod) const {
    const bool unchanged = prepared(rod, curve);
    if (!unchanged) {
        prepare(curve, rod.shape);
        rod.arcs = curve.arcs;
        rod.nodeS = curve.nodeS;
        rod.midS = curve.midS;
    }
    rod.resting = curve.resting;
    const Filter filter{curve.category, curve.mask, curve.group};
    rod.newKey = rod.key != curve.key || !rod.valid;
    const double size = std::max(curve.halfThickness, 0.5 * margin);
    const double wanted = enlargementFor(curve.motion, size);
    // A large enlargement makes long lists. They are not read while the rod rests.
    rod.rebuilt = !rod.valid || rod.key != curve.key || rod.filter != filter || rod.half != curve.halfThickness ||
                  (rod.enlargement > 3.0 * wanted && !curve.resting);
    if (!rod.rebuilt && !(unchanged && rod.displaced + curve.motion <= rod.enlargement)) {
        rod.displaced = displacement(rod.shape, rod.reference);
        rod.rebuilt = !(rod.displaced + curve.motion <= rod.enlargement);
    }
    rod.valid = true;
    SC_ASSERT(rod.rebuilt || !(rod.displaced + curve.motion > rod.enlargement),
              "the enlarged box holds the displacement and the motion to come");
    if (!rod.rebuilt)
        return;
    rod.key = curve.key;
    rod.filter = filter;
    rod.half = curve.halfThickness;
    rod.enlargement = wanted;
    rod.displaced = 0.0;
    setReference(rod.shape, rod.reference);
    rod.box = rod.reference.box.enlarged(rod.half + rod.enlargement + 0.5 * margin);
    SC_ASSERT(!(rod.enlargement < curve.motion), "the enlarged box holds the motion to come");
    SC_ASSERT(!(rod.box.low.x() > rod.box.high.x()) && !(rod.box.low.y() > rod.box.high.y()), "a box is not empty");
}

void Detector::Impl::updateRods(const std::vector<RodCurve>& curves, const parallel::For& loop) {
    rods.resize(curves.size());
    parallel::forChunks(loop, rods.size(), kRodGrain, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            updateRod(curves[i], rods[i]);
    });
    if (std::any_of(rods.begin(), rods.end(), [](const RodState& rod) { return rod.newKey; }))
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
        if (state.key != now.key || !state.valid)
            newKeys = true;
        const double wanted = enlargementFor(now.motion, margin);
        const OutlineShape& old = state.reference;
        const bool same = state.valid && state.key == now.key && state.filter == filter && old.kind == now.kind &&
                          old.radius == now.radius && state.points.size() == now.points.size() &&
                          sameCorners(old, state.shape);
        state.rebuilt =
            !same || state.enlargement > 3.0 * wanted || !(displacement(state, now) + now.motion <= state.enlargement);
        state.valid = true;
        if (!state.rebuilt)
            continue;
        state.key = now.key;
        state.filter = filter;
        state.enlargement = wanted;
        state.reference = state.shape;
        state.points = now.points;
        state.box = boxOf(state.reference, state.points).enlarged(state.enlargement + 0.5 * margin);
        SC_ASSERT(!(state.enlargement < now.motion), "the enlarged box holds the motion to come");
    }
    if (newKeys)
        checkKeys();
}

void Detector::Impl::addPair(std::int32_t a, std::int32_t b, bool rigid) {
    SC_ASSERT(invariants::inRange(a, rods.size()), "a rod of this call");
    SC_ASSERT(invariants::inRange(b, rigid ? outlines.size() : rods.size()), "a rod or outline of this call");
    CandidatePair pair;
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
    SC_ASSERT(rigid || pair.keyA <= pair.keyB, "side A is the rod with the smaller key");
    SC_ASSERT(invariants::inRange(pair.checks, pool.size()), "a list of the pool");
    pair.empty = !listChecks(pair);
    added.push_back(pair);
}

/// Returns false if there is nothing to check.
bool Detector::Impl::listChecks(const CandidatePair& pair) {
    const RodState& a = rods[static_cast<std::size_t>(pair.a)];
    Checks& checks = pool[static_cast<std::size_t>(pair.checks)];
    if (pair.rigid) {
        const OutlineState& b = outlines[static_cast<std::size_t>(pair.b)];
        OutlinePairChecks& list = checks.outline;
        collectChecks(a.reference, b.reference, a.half + margin + a.enlargement + b.enlargement, list);
        return !(list.samples.empty() && list.subArcs.empty() && list.corners.empty());
    }
    const RodState& b = rods[static_cast<std::size_t>(pair.b)];
    const double reach = a.half + b.half + margin + a.enlargement + b.enlargement;
    RodPairChecks& list = checks.rods;
    if (pair.a == pair.b)
        collectSelfChecks(a.reference, reach, list);
    else
        collectChecks(a.reference, b.reference, reach, list);
    return !(list.samplesOfA.empty() && list.samplesOfB.empty() && list.subArcs.empty());
}

/// Rods sorted by the lower ends of their boxes; nearly sorted since the last call.
void Detector::Impl::sortRods(int axis) {
    if (sortedRods.size() != rods.size()) {
        sortedRods.clear();
        for (std::size_t i = 0; i < rods.size(); ++i)
            sortedRods.push_back({0.0, static_cast<std::int32_t>(i)});
    }
    for (SortedRod& item : sortedRods)
        item.low = rods[static_cast<std::size_t>(item.rod)].box.low[axis];
    std::sort(sortedRods.begin(), sortedRods.end());
}

void Detector::Impl::findRodPairs() {
    // Sort along the axis of the widest spread of the rods.
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
    sortRods(axis);
    for (const SortedRod& item : sortedRods) {
        const RodState& rod = rods[static_cast<std::size_t>(item.rod)];
        if (!rod.rebuilt)
            continue;
        if (mayTouchItself(rod.filter))
            addPair(item.rod, item.rod, false);
        const SortedRod from{item.low - width[axis], -1};
        for (auto it = std::lower_bound(sortedRods.begin(), sortedRods.end(), from); it != sortedRods.end(); ++it) {
            if (it->low > rod.box.high[axis])
                break;
            const RodState& other = rods[static_cast<std::size_t>(it->rod)];
            if (it->rod == item.rod || (other.rebuilt && it->rod < item.rod))
                continue; // a pair of two rebuilt rods is added once
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
            if (!(rod.rebuilt || outline.rebuilt) || !overlap(rod.box, outline.box))
                continue;
            if (mayTouch(rod.filter, outline.filter))
                addPair(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), true);
        }
    }
}

void Detector::Impl::updatePairs() {
    const auto isFresh = [](const auto& state) { return state.rebuilt; };
    const bool freshRods = std::any_of(rods.begin(), rods.end(), isFresh);
    if (!freshRods && std::none_of(outlines.begin(), outlines.end(), isFresh))
        return;
    const auto stale = [this](const CandidatePair& pair) {
        const bool gone = rods[static_cast<std::size_t>(pair.a)].rebuilt ||
                          (pair.rigid ? outlines[static_cast<std::size_t>(pair.b)].rebuilt
                                      : rods[static_cast<std::size_t>(pair.b)].rebuilt);
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
    SC_ASSERT(
        invariants::strictlyRising(pairs, [](const CandidatePair& p) { return std::tuple(p.rigid, p.keyA, p.keyB); }),
        "pairs are unique, sorted by their keys");
    SC_ASSERT(pairs.size() + free.size() == pool.size(), "a list belongs to one pair or is free");
}

void Detector::Impl::evaluate(const CandidatePair& pair, const std::vector<RodCurve>& curves,
                              const std::vector<Outline>& given, CandidateReducer& reducer,
                              std::vector<Candidate>& out) const {
    const auto a = static_cast<std::size_t>(pair.a);
    const auto b = static_cast<std::size_t>(pair.b);
    SC_ASSERT(pair.keyA == rods[a].key && pair.keyB == (pair.rigid ? outlines[b].key : rods[b].key),
              "a pair names its rods and outlines by their present indices");
    const Checks& checks = pool[static_cast<std::size_t>(pair.checks)];
    const RodSide rod{&rods[a].shape, pair.a, pair.keyA};
    if (pair.rigid) {
        const OutlineSide outline{&outlines[b].shape, pair.b, pair.keyB};
        evaluateOutlinePair(rod, outline, checks.outline, margin + curves[a].motion + given[b].motion, reducer, out);
    } else {
        const RodSide other{&rods[b].shape, pair.b, pair.keyB};
        evaluateRodPair(rod, other, checks.rods, margin + curves[a].motion + curves[b].motion, reducer, out);
    }
}

Detector::Detector() : impl_(std::make_unique<Impl>()) {}
Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

void Detector::detect(const std::vector<RodCurve>& curves, const std::vector<Outline>& outlines,
                      const DetectionOptions& options, std::vector<Candidate>& out, const parallel::For& loop) {
    Impl& m = *impl_;
    out.clear();
    if (!(options.margin >= 0.0))
        throw std::invalid_argument("contact detection: the margin is negative");
    // Pairs hold indices into the lists: another number of rods, or another margin, invalidates them.
    if (m.rods.size() != curves.size() || m.outlines.size() != outlines.size() || m.margin != options.margin) {
        m.invalidate();
        for (const CandidatePair& pair : m.pairs)
            m.free.push_back(pair.checks);
        m.pairs.clear();
        m.margin = options.margin;
    }
    try {
        m.updateRods(curves, loop);
        m.updateOutlines(outlines);
    } catch (...) {
        m.margin = -1.0; // partly updated: rebuild everything at the next call
        throw;
    }
    m.updatePairs();
    m.awake.clear();
    for (const CandidatePair& pair : m.pairs)
        if (!pair.empty && !(m.rods[static_cast<std::size_t>(pair.a)].resting &&
                             (pair.rigid || m.rods[static_cast<std::size_t>(pair.b)].resting)))
            m.awake.push_back(&pair);
    const std::size_t count = parallel::chunkCount(loop, m.awake.size(), kPairGrain);
    if (m.chunks.size() < count)
        m.chunks.resize(count);
    parallel::forChunks(loop, m.awake.size(), kPairGrain, [&](std::size_t c, std::size_t begin, std::size_t end) {
        std::vector<Candidate>& found = count > 1 ? m.chunks[c].found : out;
        found.clear();
        for (std::size_t i = begin; i < end; ++i)
            m.evaluate(*m.awake[i], curves, outlines, m.chunks[c].reducer, found);
    });
    for (std::size_t c = 0; count > 1 && c < count; ++c)
        out.insert(out.end(), m.chunks[c].found.begin(), m.chunks[c].found.end());
    for (const Candidate& c : out)
        assertSound(c, curves, outlines, options.margin);
    SC_ASSERT_EXPENSIVE(idsAreUnique(out), "an id names one candidate");
}

} // namespace supercircle::contact
