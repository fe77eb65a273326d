#pragma once
// The ways out of an overlap: where and along which directions two things that cross are moved until they are free.
//
// Ways are: off the ends of both centre lines, along the lines themselves; through the faces of a solid; off the ends
// of a two-sided segment; and, where two lines cross an even number of times, back over each other.

#include "supercircle/contact/geometry.h"

#include <cstdint>
#include <vector>

namespace supercircle::contact {

/// A point of A that has to move along a direction relative to the point of B beside it.
struct Push {
    double sA = 0.0;                ///< arc length on rod A, m
    double sB = 0.0;                ///< on rod B, m; 0 for an outline
    Vec2 direction = Vec2::UnitX(); ///< unit
    bool operator==(const Push&) const = default;
};

/// What a way leads over.
enum class WayKind : std::uint8_t {
    StartOfA,
    EndOfA,
    StartOfB,
    EndOfB,
    Back,   ///< over each other, to where they came from
    Normal, ///< of a disc, of a one-sided edge, or of lines that only touch
    Face    ///< and the following values: the faces of a polygon
};

struct WayOut {
    WayKind kind = WayKind::Normal;
    double distance = 0.0;     ///< to go, m
    std::vector<Push> pushes;  ///< at least one
    bool contactLeads = false; ///< contacts of this pair push all of the rod that way
};

/// Of two rods, or of a rod and itself (b the same object as a); empty: they do not cross.
[[nodiscard]] std::vector<WayOut> waysOut(const RodCurve& a, const RodCurve& b);
/// Of a rod in an outline.
[[nodiscard]] std::vector<WayOut> waysOut(const RodCurve& a, const Outline& b);

} // namespace supercircle::contact
