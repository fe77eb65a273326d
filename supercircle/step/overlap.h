#pragma once
// A pair that crosses: made, teleported or restored across each other, a body put onto a shell, or a crossing that the
// smallest step cannot avoid. It is outside the law of contact until it is free (contacts/overlaps.h).

#include "supercircle/contact/way_out.h"
#include "supercircle/step/host_constraints.h"

#include <cstdint>
#include <tuple>
#include <vector>

namespace supercircle::step {

struct Overlap {
    std::uint32_t rodA = 0;    ///< key of a rod; of two rods the smaller one
    std::uint32_t rodB = 0;    ///< key of the other rod, or of the same one; 0: an outline
    BodyId body = 0;           ///< of the outline; 0: the other side is a rod
    std::uint32_t outline = 0; ///< contact::Outline::key of the piece
    bool contact = false;      ///< contacts act: they do not cross now, or contacts lead out
    bool free = false;         ///< contacts acted in the last step and left them apart: off the list in the next frame
    std::vector<contact::Push> pushes;               ///< of the next step; empty where contacts act
    contact::WayKind way = contact::WayKind::Normal; ///< the one taken
    std::uint32_t blocked = 0;                       ///< ways that led nowhere: bit min(WayKind, 31) of each
    double from = 0.0;                               ///< what was left of the way when it was last looked at, m
    double tried = 0.0;                              ///< time since then, s
    [[nodiscard]] auto pair() const { return std::tie(rodA, rodB, body, outline); }
};

} // namespace supercircle::step
