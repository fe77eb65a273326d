#include "supercircle/step/contacts/pair_vetoes.h"

#include "supercircle/step/islands/reach.h"
#include "supercircle/step/sleep.h"

#include <algorithm>
#include <iterator>

namespace supercircle::step {

void updateVetoes(World& world, double frame, const PairFilter& filter) {
    if (!filter && world.vetoes.empty())
        return;
    std::vector<VetoedPair> now;
    if (filter) {
        std::vector<Box> pieces;
        for (const BodyOutline& piece : world.outlines)
            pieces.push_back(reachOf(world, piece, frame));
        for (const Rod& r : world.rods) {
            const Box reach = reachOf(world, r, r.kin, r.speed, frame);
            for (std::size_t i = 0; i < pieces.size(); ++i)
                if (const BodyOutline& piece = world.outlines[i]; meet(reach, pieces[i]) && !filter(r, piece))
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
