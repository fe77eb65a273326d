#pragma once
// A pair that crosses without having got there by its motion: made, teleported or restored across each other, a body
// put onto a shell. It is outside the law of contact until it is free (contacts/overlaps.h).

#include "supercircle/contact/way_out.h"
#include "supercircle/step/host_constraints.h"

#include <cstdint>
#include <tuple>
#include <vector>

namespace supercircle::step {

struct Overlap {
    std::uint32_t rodA = 0;                          ///< key; of two rods the smaller one
    std::uint32_t rodB = 0;                          ///< key; 0: an outline
    BodyId body = 0;                                 ///< 0: a rod
    std::uint32_t outline = 0;                       ///< contact::Outline::key of the piece
    bool contact = false;                            ///< contacts act: they do not cross now, or contacts lead out
    bool free = false;                               ///< at the end of the last step they did not cross, by a margin
    std::vector<contact::Push> pushes;               ///< at the start of the next step
    contact::WayKind way = contact::WayKind::Normal; ///< the one taken
    std::uint32_t blocked = 0;                       ///< ways that led nowhere, a bit each
    double from = 0.0;                               ///< what was left of the way when `tried` began, m
    double tried = 0.0;                              ///< since when this way is tried, s
    [[nodiscard]] auto pair() const { return std::tie(rodA, rodB, body, outline); }
};

} // namespace supercircle::step
