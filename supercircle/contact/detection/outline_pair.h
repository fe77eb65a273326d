#pragma once
// Candidates between a rod and an outline.
//
// Reported are: every sample of the rod (element nodes, tips, mid-rod point) against its closest point of the outline;
// the extremal points of well-conditioned sub-arcs against straight faces; their closest points to a disc; the middles
// of other sub-arcs; outline corners projected on the rod. Distances to solids are signed. Inside a polygon the face of
// least depth gives the normal. Behind a one-sided edge the normal is that of its free side, down to a depth of the
// rod's thickness plus the outline's radius. Deeper points are assumed to be on the other side of a thin wall and are
// not reported. A rod that has crossed a two-sided segment is reported on the side of each sample.

#include "supercircle/contact/detection/rod_pair.h"
#include "supercircle/contact/outline_shape.h"

namespace supercircle::contact {

struct OutlinePairChecks {
    std::vector<std::uint16_t> samples; ///< samples of the rod
    std::vector<std::uint16_t> subArcs; ///< sub-arcs of the rod, against all faces or the disc
    std::vector<Check> corners;         ///< corner (index into OutlineShape::corners), sub-arc
};

struct OutlineSide {
    const OutlineShape* shape = nullptr;
    std::int32_t outline = -1;
    std::uint32_t key = 0;
};

void evaluateOutlinePair(const RodSide& rod, const OutlineSide& outline, const OutlinePairChecks& checks, double reach,
                         CandidateReducer& reducer, std::vector<Candidate>& out);

/// Depth behind a one-sided edge or corner down to which a rod is reported, m.
double outlineDepth(double halfThickness, const OutlineShape& shape);

/// Sets frame, points and gap; `distance` (m) is from the outline without its radius.
void setOutlineFrame(Candidate& c, const Vec2& centreA, double halfA, const OutlineShape& shape, const Vec2& point,
                     const Vec2& normal, double distance);

/// Unit vector towards which the rod bends; it decides the side of a sample exactly on an outline.
Vec2 inwardOf(const Sample& sample);

/// The extremal point of a sub-arc against one face, or (face 0) its closest point to a disc; where the sub-arc lies
/// along it, the middle of the sub-arc. Sets the frame in `c`. Returns false if there is none, or if another feature of
/// the outline is nearer.
[[nodiscard]] bool interiorOutline(const SubArc& arc, double halfThickness, const OutlineShape& shape,
                                   std::int32_t face, double maxGap, Candidate& c, double& s);

} // namespace supercircle::contact
