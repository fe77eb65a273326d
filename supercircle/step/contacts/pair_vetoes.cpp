#include "supercircle/step/contacts/pair_vetoes.h"

#include "supercircle/step/sleep.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace supercircle::step {

namespace {

struct Reach {
    Vec2 lower = Vec2::Constant(std::numeric_limits<double>::infinity());
    Vec2 upper = Vec2::Constant(-std::numeric_limits<double>::infinity());
    void add(const Vec2& p, double pad) {
        lower = lower.cwiseMin(p - Vec2::Constant(pad));
        upper = upper.cwiseMax(p + Vec2::Constant(pad));
    }
    [[nodiscard]] bool meets(const Reach& o) const {
        return (lower.array() <= o.upper.array()).all() && (o.lower.array() <= upper.array()).all();
    }
};

/// As far as ReadHost looks for outlines.
Reach reachOf(const World& world, const Rod& r, double frame) {
    Reach reach;
    const double pad = 2.0 * frame * (r.speed + frame * world.gravity.norm()) + r.model.longestElement();
    for (int i = 0; i <= r.model.elements(); ++i)
        reach.add(r.kin.node(i), pad);
    return reach;
}

Reach reachOf(const World& world, const BodyOutline& piece, double frame) {
    Reach reach;
    const Body& b = world.bodies[static_cast<std::size_t>(bodyIndex(world, piece.body))];
    const contact::Outline now = placed(piece, b.state.centre, b.state.angle);
    for (std::size_t i = 0; i < now.points.size(); ++i) {
        const double speed = b.state.velocity.norm() + std::abs(b.state.spin) * piece.local.points[i].norm();
        reach.add(now.points[i], now.radius + 2.0 * frame * (speed + frame * world.gravity.norm()));
    }
    return reach;
}

} // namespace

void updateVetoes(World& world, double frame, const PairFilter& filter) {
    if (!filter && world.vetoes.empty())
        return;
    std::vector<VetoedPair> now;
    if (filter) {
        std::vector<Reach> pieces;
        for (const BodyOutline& piece : world.outlines)
            pieces.push_back(reachOf(world, piece, frame));
        for (const Rod& r : world.rods) {
            const Reach reach = reachOf(world, r, frame);
            for (std::size_t i = 0; i < pieces.size(); ++i)
                if (const BodyOutline& piece = world.outlines[i]; reach.meets(pieces[i]) && !filter(r, piece))
                    now.push_back({r.key, piece.body, piece.local.key});
        }
        std::sort(now.begin(), now.end());
    }
    if (now == world.vetoes)
        return;
    std::vector<VetoedPair> changed;
    std::set_symmetric_difference(now.begin(), now.end(), world.vetoes.begin(), world.vetoes.end(),
                                  std::back_inserter(changed));
    for (const VetoedPair& v : changed)
        if (const int rod = rodIndex(world, v.rod); rod >= 0)
            wake(world, static_cast<std::size_t>(rod));
    world.vetoes = std::move(now);
    world.range.clear();
}

bool vetoed(const World& world, const Rod& rod, const BodyOutline& piece) {
    return !world.vetoes.empty() && std::binary_search(world.vetoes.begin(), world.vetoes.end(),
                                                       VetoedPair{rod.key, piece.body, piece.local.key});
}

} // namespace supercircle::step
