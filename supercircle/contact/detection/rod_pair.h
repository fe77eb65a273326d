#pragma once
// Rod against rod, and a rod against itself.
//
// What is reported for two rods A and B:
//  - every sample of A (element nodes, tips, mid-rod point) at each local minimum of its distance to B: in the interior
//    of B's pieces, or at B's tips when the sample lies beyond them; side A of the candidate is the sampled rod;
//  - the same with the roles exchanged; two tips facing each other are one candidate, whichever rod saw it;
//  - interior-interior minima of well-conditioned pairs of pieces; side A is the rod with the smaller key.
// A rod that lies along another for a stretch thus has a candidate at least every element length of the finer of the
// two, and these move with the material: the set does not jump.
//
// Self contact: two points of one rod make a candidate only if (1) they are more than kSelfThicknesses thicknesses
// apart along the rod, and (2) the tangent turns through more than 90 degrees somewhere between them. Both are
// necessary for two different stretches to touch: with a tangent within 45 degrees of some direction the chord of a
// stretch is at least cos 45 of its length, and a closest point needs the stretch to come back past the normal at its
// foot. In a closed rod both ways round must pass.
//
// Sides. The normal points to the side on which the sample lies. Where the centre lines meet to 1e-9 of the thickness
// this is rounding noise, and local shape decides: a tip lies where it comes from, a node where its rod bends away to.
// Centre lines that have crossed cannot be told from ones that have not, by geometry alone; the crossing test sees
// them.

#include "supercircle/contact/detection/closest.h"
#include "supercircle/contact/detection/collector.h"

#include <vector>

namespace supercircle::contact {

constexpr double kSelfThicknesses = 3.0;
/// Interior minima count when the curves part by more than this share of the summed half thicknesses within half an
/// element (see arcArcMinimum): 0.1 micrometre for the paper's shells. A larger share (0.005 was tried) makes a gap of
/// that size appear and vanish as curvatures cross it, and the stack chatters.
constexpr double kConditionedShare = 0.0002;
/// Candidates that agree to this share of the summed half thicknesses on both sides are one.
constexpr double kSameShare = 1e-6;

/// A prepared rod and what candidates call it.
struct RodSide {
    const RodShape* shape = nullptr;
    std::int32_t rod = -1;
    std::uint32_t key = 0;
};

/// Which features of a pair to look at: indices of a sample or piece of A, and of a piece of B.
struct Check {
    std::uint16_t first = 0;
    std::uint16_t second = 0;
};

struct RodPairChecks {
    std::vector<Check> samplesOfA; ///< sample of A, piece of B
    std::vector<Check> samplesOfB; ///< sample of B, piece of A
    std::vector<Check> pieces;     ///< piece of A, piece of B
};

/// Evaluates the checks of two rods (or of one with itself: the same side twice, `samplesOfB` unused and pieces with
/// first < second); candidates with gap <= reach go to `out`. The key of A is the smaller one.
void evaluateRodPair(const RodSide& a, const RodSide& b, const RodPairChecks& checks, double reach,
                     Collector& collector, std::vector<Candidate>& out);

/// Do two points of one rod belong to different stretches?
bool differentStretches(const RodShape& rod, double s1, double s2);

/// Fills in frame, points and gap of a candidate between two rods.
void setRodFrame(Candidate& c, const Vec2& centreA, double halfA, const Vec2& centreB, double halfB, const Vec2& normal,
                 double distance);
/// On which side of a foot the sample lies: true for the left.
bool liesLeft(const Sample& sample, const Foot& foot, double curvature, double tolerance);
/// Sample against the end of a rod (a tip, or the weld of a closed one): distance, unit vector from the end to the
/// sample, and the side.
struct EndHit {
    double distance = 0.0;
    Vec2 normal = Vec2::Zero();
    bool left = false;
};
EndHit againstEnd(const Sample& sample, const Vec2& end, const Vec2& tangent);

} // namespace supercircle::contact
