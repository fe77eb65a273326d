#include "supercircle/step/coupling/stray_bodies.h"

#include "supercircle/step/contacts/pair_vetoes.h"
#include "supercircle/step/islands/reach.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

constexpr double kTurn = 0.3;      ///< rad that a body turns at most in one part of its way
constexpr int kHalvings = 16;      ///< of a part in which a shell is met: 0.1 mm of 4 m
constexpr double kOverlap = 0.001; ///< of a shell's thickness, that a body may stand in it where it is put back

/// Whether a rod lets a piece pass, whatever their filters say.
bool letsPass(const World& world, const Rod& rod, const BodyOutline& piece, const PairFilter& filter) {
    const auto joined = [&](const Link& l) {
        return !l.collide && l.end == LinkEnd::Body && l.rodA == rod.key && l.body == piece.body;
    };
    const auto overlaps = [&](const Overlap& o) {
        return o.rodA == rod.key && o.rodB == 0 && o.body == piece.body && o.outline == piece.local.key;
    };
    const PieceId id{piece.body, piece.local.key};
    return rod.quarantined || std::any_of(world.links.begin(), world.links.end(), joined) ||
           std::any_of(world.overlaps.begin(), world.overlaps.end(), overlaps) ||
           std::find(rod.passing.begin(), rod.passing.end(), id) != rod.passing.end() || vetoed(world, rod, piece) ||
           (filter && !filter(rod, piece));
}

/// A body on its way among the shells of HostCouplingWork::curves.
class Way {
public:
    Way(const World& world, std::span<const BodyOutline> pieces, const BodyState& from, const BodyState& to,
        const PairFilter& filter, HostCouplingWork& work)
        : world_(world), pieces_(pieces), from_(from), to_(to), filter_(filter), work_(work) {}

    bool crosses(double begin, double end) {
        put(begin, work_.copies);
        put(end, work_.originals);
        contact::findCrossingsSwept(work_.curves, work_.curves, work_.copies, work_.originals, work_.crossings);
        return std::any_of(work_.crossings.begin(), work_.crossings.end(), [&](const contact::Crossing& c) {
            return c.rodB < 0 && !letsPass(world_, world_.rods[static_cast<std::size_t>(c.rodA)],
                                           pieces_[static_cast<std::size_t>(c.outline)], filter_);
        });
    }
    double depth(double share) {
        put(share, work_.originals);
        depths(work_.originals, work_, work_.depthOfOriginal);
        return *std::max_element(work_.depthOfOriginal.begin(), work_.depthOfOriginal.end());
    }

private:
    void put(double share, std::vector<contact::Outline>& out) {
        BodyState s;
        moveAlong(from_, to_, share, s);
        out.resize(pieces_.size());
        for (std::size_t i = 0; i < out.size(); ++i) {
            place(pieces_[i], s.centre, s.angle, out[i]);
            out[i].key = static_cast<std::uint32_t>(i);
        }
    }

    const World& world_;
    std::span<const BodyOutline> pieces_;
    const BodyState &from_, &to_;
    const PairFilter& filter_;
    HostCouplingWork& work_;
};

/// Bodies whose ways reconcilePoses judges, sorted.
void listJudged(const World& world, std::vector<BodyId>& ids) {
    ids.clear();
    for (const BodyOutline& o : world.outlines)
        if (ids.empty() || ids.back() != o.body)
            ids.push_back(o.body);
    std::erase_if(ids, [&](BodyId id) {
        const Body* b = findBody(world.bodies, id);
        return b == nullptr || !b->hostCoupling.known || b->asleep();
    });
    SC_ASSERT(std::is_sorted(ids.begin(), ids.end()), "outlines are sorted by their bodies");
}

} // namespace

void takeCurves(const World& world, HostCouplingWork& work) {
    work.curves.resize(world.rods.size());
    for (std::size_t i = 0; i < work.curves.size(); ++i)
        toCurve(world.rods[i], world.rods[i].kin, work.curves[i]);
}

void depths(const std::vector<contact::Outline>& outlines, HostCouplingWork& work, std::vector<double>& depth) {
    work.detector.detect(work.curves, outlines, {0.0}, work.near);
    depth.assign(outlines.size(), 0.0);
    for (const contact::Candidate& c : work.near)
        if (c.outline >= 0) {
            double& d = depth[static_cast<std::size_t>(c.outline)];
            d = std::max(d, -c.gap);
        }
}

double freeShare(const World& world, std::span<const BodyOutline> pieces, const BodyState& from, const BodyState& to,
                 const PairFilter& filter, HostCouplingWork& work) {
    SC_ASSERT(!pieces.empty(), "a body with outlines");
    for (contact::RodCurve& c : work.curves)
        c.resting = false; // sleepers stop bodies as well
    Way way(world, pieces, from, to, filter, work);
    const int parts = 1 + static_cast<int>(std::abs(to.angle - from.angle) / kTurn);
    for (int k = 0; k < parts; ++k) {
        double low = static_cast<double>(k) / parts, high = static_cast<double>(k + 1) / parts;
        if (!way.crosses(low, high))
            continue;
        const double deepest = std::max(way.depth(low), kOverlap * thinnest(world));
        for (int i = 0; i < kHalvings; ++i) {
            const double middle = 0.5 * (low + high);
            (way.crosses(low, middle) || way.depth(middle) > deepest ? high : low) = middle;
        }
        return low;
    }
    return 1.0;
}

void putBackStrays(World& world, const PairFilter& filter, Port& port, HostCouplingWork& work) {
    work.shellBoxes.clear();
    for (const Rod& r : world.rods) {
        Box box = emptyBox();
        for (int i = 0; i <= r.model.elements(); ++i)
            widen(box, r.kin.node(i), surfaceReach(r));
        work.shellBoxes.push_back(box);
    }
    if (work.shellBoxes.empty())
        return;
    listJudged(world, work.judged);
    work.strays.clear();
    work.strayOutlines.clear();
    port.strayed(work.judged, work.shellBoxes, work.strays, work.strayOutlines);
    if (work.strays.empty())
        return;
    takeCurves(world, work);
    for (const StrayBody& s : work.strays) {
        const std::span<const BodyOutline> pieces = outlinesOf(work.strayOutlines, s.body);
        BodyState now, from;
        if (pieces.empty() || !port.state(s.body, now))
            continue;
        const int index = bodyIndex(world, s.body);
        Body* copy = index >= 0 ? &world.bodies[static_cast<std::size_t>(index)] : nullptr;
        const bool known = copy != nullptr && copy->hostCoupling.known;
        from.centre = known ? copy->state.centre : s.centre;
        from.angle = known ? copy->state.angle : s.angle;
        const double share = freeShare(world, pieces, from, now, filter, work);
        if (share >= 1.0)
            continue;
        moveAlong(from, now, share, now);
        port.putBack(s.body, now.centre, now.angle);
        if (copy != nullptr) {
            copy->state.centre = now.centre;
            copy->state.angle = now.angle;
            seePutBack(port, *copy);
        }
    }
}

} // namespace supercircle::step
