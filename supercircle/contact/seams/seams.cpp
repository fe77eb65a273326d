#include "supercircle/contact/seams.h"

#include "supercircle/contact/seams/seam_shape.h"

#include <algorithm>
#include <numeric>

namespace supercircle::contact {

namespace {

using Neighbours = std::vector<std::vector<std::uint32_t>>;

/// Neighbours of pieces near shells that are joined as well, because the places of their vertices count.
constexpr int kBeyond = 2;
/// Neighbours over which a change of a piece can reach a result: one for its cones, three for the places of vertices.
constexpr int kHops = 4 + kBeyond;

bool before(const SeamPiece& a, const SeamPiece& b) {
    return a.body != b.body ? a.body < b.body : a.key < b.key;
}

bool together(const seam::Shape& a, const seam::Shape& b) {
    return a.low.x() <= b.high.x() && b.low.x() <= a.high.x() && a.low.y() <= b.high.y() && b.low.y() <= a.high.y();
}

/// Pairs whose boxes meet, by a sweep along the axis of the larger spread.
void findNeighbours(const std::vector<seam::Shape>& shapes, const std::vector<char>& sound,
                    std::vector<std::uint32_t>& order, Neighbours& near) {
    near.resize(shapes.size());
    for (std::vector<std::uint32_t>& list : near)
        list.clear();
    Vec2 low = Vec2::Constant(1e300), high = Vec2::Constant(-1e300);
    for (const seam::Shape& s : shapes) {
        low = low.cwiseMin(s.low);
        high = high.cwiseMax(s.high);
    }
    const int axis = high.x() - low.x() >= high.y() - low.y() ? 0 : 1;
    order.resize(shapes.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const double x = shapes[a].low[axis], y = shapes[b].low[axis];
        return x != y ? x < y : a < b;
    });
    for (std::size_t k = 0; k < order.size(); ++k) {
        const std::uint32_t a = order[k];
        for (std::size_t m = k + 1; m < order.size() && shapes[order[m]].low[axis] <= shapes[a].high[axis]; ++m) {
            const std::uint32_t b = order[m];
            if (sound[a] && sound[b] && together(shapes[a], shapes[b]) &&
                seam::mayJoin(shapes[a].piece->outline, shapes[b].piece->outline)) {
                near[a].push_back(b);
                near[b].push_back(a);
            }
        }
    }
    for (std::vector<std::uint32_t>& list : near)
        std::sort(list.begin(), list.end());
}

/// Storage of spread().
struct Front {
    std::vector<std::uint32_t> edge, next;
};

/// Marks what is within `hops` neighbours of what is marked.
void spread(const Neighbours& near, int hops, Front& front, std::vector<char>& marked) {
    auto& [edge, next] = front;
    edge.clear();
    for (std::size_t i = 0; i < marked.size(); ++i)
        if (marked[i])
            edge.push_back(static_cast<std::uint32_t>(i));
    for (int hop = 0; hop < hops; ++hop) {
        next.clear();
        for (const std::uint32_t i : edge)
            for (const std::uint32_t j : near[i])
                if (!marked[j]) {
                    marked[j] = 1;
                    next.push_back(j);
                }
        edge.swap(next);
    }
}

/// Gives the neighbours of pieces near shells the thickness of those shells.
void spreadThickness(const Neighbours& near, std::vector<double>& next, std::vector<seam::Shape>& shapes) {
    next.resize(shapes.size());
    for (int hop = 0; hop < kBeyond; ++hop) {
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            next[i] = shapes[i].thickness;
            for (const std::uint32_t j : near[i])
                if (shapes[i].thickness <= 0.0 && shapes[j].thickness > 0.0)
                    next[i] = next[i] > 0.0 ? std::min(next[i], shapes[j].thickness) : shapes[j].thickness;
        }
        for (std::size_t i = 0; i < shapes.size(); ++i)
            shapes[i].thickness = next[i];
    }
}

} // namespace

struct SeamJoiner::Impl {
    std::vector<SeamPiece> known; ///< of the last call: identities only
    std::vector<Joined> results;
    Neighbours near;

    std::vector<char> stale;         ///< to be joined again
    std::vector<char> gone;          ///< of the last call: changed or removed
    std::vector<std::uint32_t> from; ///< index in the last call
    std::vector<Joined> old;
    std::vector<seam::Shape> shapes;
    std::vector<char> sound;
    // Storage: a world at rest, whose crates move by rounding, takes nothing from the heap.
    std::vector<char> around;
    std::vector<std::uint32_t> order;
    std::vector<double> thickness;
    std::vector<seam::Moves> moves;
    std::vector<seam::Sector> sectors;
    Front front;

    bool matchKnown(const std::vector<SeamPiece>& pieces);
    void renew(const std::vector<SeamPiece>& pieces, double frame);
};

/// Takes over results of pieces that are still there. Fills `stale` with what changed, and with what was near it.
bool SeamJoiner::Impl::matchKnown(const std::vector<SeamPiece>& pieces) {
    gone.assign(known.size(), 0);
    from.assign(pieces.size(), ~0u);
    bool any = false;
    std::size_t i = 0, j = 0;
    while (i < known.size() || j < pieces.size()) {
        if (j == pieces.size() || (i < known.size() && before(known[i], pieces[j]))) {
            gone[i++] = 1;
            any = true;
        } else if (i == known.size() || before(pieces[j], known[i])) {
            ++j;
            any = true;
        } else {
            gone[i] = pieces[j].changed ? 1 : 0;
            any = any || pieces[j].changed;
            from[j++] = static_cast<std::uint32_t>(i++);
        }
    }
    if (!any)
        return false;
    spread(near, kHops, front, gone);
    old.swap(results);
    results.resize(pieces.size());
    stale.assign(pieces.size(), 1);
    for (std::size_t k = 0; k < pieces.size(); ++k)
        if (from[k] != ~0u) {
            std::swap(results[k], old[from[k]]);
            stale[k] = gone[from[k]];
        }
    return true;
}

void SeamJoiner::Impl::renew(const std::vector<SeamPiece>& pieces, double frame) {
    shapes.resize(pieces.size());
    sound.resize(pieces.size());
    double thickest = 0.0;
    for (const SeamPiece& piece : pieces)
        thickest = std::max(thickest, piece.thickness);
    for (std::size_t i = 0; i < pieces.size(); ++i)
        sound[i] = seam::prepare(pieces[i], thickest, shapes[i]) ? 1 : 0;
    findNeighbours(shapes, sound, order, near);
    spreadThickness(near, thickness, shapes);
    spread(near, kHops, front, stale);
    around = stale;
    spread(near, kHops, front, around);
    seam::weld(shapes, near, frame, around, moves);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (!stale[i])
            continue;
        Joined& r = results[i];
        r.seams.clear();
        r.points = shapes[i].points;
        r.moved = !(r.points == pieces[i].outline.points);
        if (near[i].empty() || pieces[i].thickness <= 0.0)
            continue;
        seam::findCones(shapes, near[i], i, frame, sectors, r.seams.vertices);
        seam::findHidden(shapes, near[i], i, frame, r.seams.hidden);
        if (std::all_of(r.seams.vertices.begin(), r.seams.vertices.end(),
                        [](const VertexSeam& v) { return v.role == VertexRole::Alone; }))
            r.seams.vertices.clear();
    }
}

SeamJoiner::SeamJoiner() : impl_(std::make_unique<Impl>()) {}
SeamJoiner::~SeamJoiner() = default;
SeamJoiner::SeamJoiner(SeamJoiner&&) noexcept = default;
SeamJoiner& SeamJoiner::operator=(SeamJoiner&&) noexcept = default;

const std::vector<Joined>& SeamJoiner::join(const std::vector<SeamPiece>& pieces, double frame) {
    Impl& m = *impl_;
    if (m.matchKnown(pieces)) {
        m.renew(pieces, frame);
        m.known.resize(pieces.size());
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            m.known[i].body = pieces[i].body;
            m.known[i].key = pieces[i].key;
        }
    }
    return m.results;
}

} // namespace supercircle::contact
