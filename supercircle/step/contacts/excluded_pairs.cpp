#include "supercircle/step/contacts/excluded_pairs.h"

#include "supercircle/step/contacts/overlaps.h"
#include "supercircle/step/contacts/pair_vetoes.h"

#include <algorithm>

namespace supercircle::step {

namespace {

std::pair<std::uint64_t, std::uint64_t> pairOf(std::uint32_t rodA, std::uint32_t rodB) {
    return {std::min(rodA, rodB), std::max(rodA, rodB)};
}
std::pair<std::uint64_t, std::uint64_t> pairOf(std::uint32_t rod, BodyId body) {
    return {(std::uint64_t{1} << 32U) | rod, body};
}

} // namespace

void collectExcluded(const World& world, ContactStage& stage) {
    stage.detection.excluded.clear();
    for (const Link& l : world.links)
        if (!l.collide && l.end == LinkEnd::Rod)
            stage.detection.excluded.push_back(pairOf(l.rodA, l.rodB));
        else if (!l.collide && l.end == LinkEnd::Body)
            stage.detection.excluded.push_back(pairOf(l.rodA, l.body));
    std::sort(stage.detection.excluded.begin(), stage.detection.excluded.end());
}

bool excluded(const World& world, const ContactStage& stage, int rodA, int rodB, int outline) {
    if (rodB < 0 &&
        vetoed(world, world.rods[static_cast<std::size_t>(rodA)], world.outlines[static_cast<std::size_t>(outline)]))
        return true;
    if (isOverlap(world, rodA, rodB, outline, true) ||
        (rodB < 0 &&
         std::binary_search(stage.detection.passing.begin(), stage.detection.passing.end(), std::pair(rodA, outline))))
        return true;
    if (stage.detection.excluded.empty())
        return false;
    const std::uint32_t a = world.rods[static_cast<std::size_t>(rodA)].key;
    const auto pair = rodB >= 0 ? pairOf(a, world.rods[static_cast<std::size_t>(rodB)].key)
                                : pairOf(a, world.outlines[static_cast<std::size_t>(outline)].body);
    return std::binary_search(stage.detection.excluded.begin(), stage.detection.excluded.end(), pair);
}

} // namespace supercircle::step
