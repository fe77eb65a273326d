#pragma once
// Rod against outline.
//
// Reported: every sample of the rod (element nodes, tips, mid-rod point) against its closest point of the outline; the
// extremal points of well-conditioned pieces against straight faces, and their closest points to a disc; outline
// corners projected on the rod. Distances to solids are signed: inside a polygon the least deep face gives the normal;
// behind a one-sided edge the normal stays its left one, down to one thickness of the rod plus the outline's radius;
// deeper points are taken to be on the other side of a thin wall and not reported. A rod that has crossed a two-sided
// segment is reported on whichever side each sample lies.

#include "supercircle/contact/detection/rod_pair.h"
#include "supercircle/contact/outline_shape.h"

namespace supercircle::contact {

struct OutlinePairChecks {
    std::vector<std::uint16_t> samples; ///< samples of the rod
    std::vector<std::uint16_t> pieces;  ///< pieces of the rod, against all faces or the disc
    std::vector<Check> corners;         ///< corner (index into OutlineShape::corners), piece
};

struct OutlineSide {
    const OutlineShape* shape = nullptr;
    std::int32_t outline = -1;
    std::uint32_t key = 0;
};

void evaluateOutlinePair(const RodSide& rod, const OutlineSide& outline, const OutlinePairChecks& checks, double reach,
                         Collector& collector, std::vector<Candidate>& out);

/// How far behind a one-sided edge (or corner) a rod is still pushed back, m.
double outlineDepth(double halfThickness, const OutlineShape& shape);

/// Fills in frame, points and gap; `distance` is from the outline without its radius.
void setOutlineFrame(Candidate& c, const Vec2& centreA, double halfA, const OutlineShape& shape, const Vec2& point,
                     const Vec2& normal, double distance);

/// The unit vector that decides the side of a sample exactly on an outline: to where the rod bends.
Vec2 inwardOf(const Sample& sample);

/// The extremal point of a piece against one face, or (face 0) its closest point to a disc; frame in `c`. False when
/// there is none, it is not well conditioned, or another feature of the outline is nearer there.
bool interiorOutline(const Piece& piece, double halfThickness, const OutlineShape& shape, std::int32_t face,
                     double maxGap, Candidate& c, double& s);

} // namespace supercircle::contact
