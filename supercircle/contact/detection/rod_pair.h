#pragma once
// Candidates between two rods A and B, and of a rod with itself:
//  - every sample of A (node, tip, mid-rod point) at each local minimum of its distance to B, in the interior of B's
//    sub-arcs or at B's tips. Side A of the candidate is the sampled rod. The same with the roles exchanged.
//  - two tips that face each other, one candidate, and interior-interior minima of well-conditioned pairs of sub-arcs.
//    Here side A is the rod with the smaller key.
// Rods in contact along a length thus have a candidate at least every element length, and these move with the material.
// Self contact and the choice of sides are explained in decision 0124.

#include "supercircle/contact/detection/candidate_reducer.h"
#include "supercircle/contact/detection/closest.h"

#include <vector>

namespace supercircle::contact {

constexpr double kSelfThicknesses = 3.0;
/// Candidates whose points agree to this fraction of the summed half thicknesses are the same one.
constexpr double kSameShare = 1e-6;

/// A prepared rod with its index and key.
struct RodSide {
    const RodShape* shape = nullptr;
    std::int32_t rod = -1;
    std::uint32_t key = 0;
};

/// Two features to check: indices of a sample or sub-arc of A, and of a sub-arc of B.
struct Check {
    std::uint16_t first = 0;
    std::uint16_t second = 0;
};

struct RodPairChecks {
    std::vector<Check> samplesOfA; ///< sample of A, sub-arc of B
    std::vector<Check> samplesOfB; ///< sample of B, sub-arc of A
    std::vector<Check> subArcs;    ///< sub-arc of A, sub-arc of B
};

/// Evaluates the checks of two rods; candidates with gap <= reach (m) go to `out`. The key of A is the smaller one.
/// For a rod with itself, pass the same side twice, no `samplesOfB` and sub-arcs with first < second.
void evaluateRodPair(const RodSide& a, const RodSide& b, const RodPairChecks& checks, double reach,
                     CandidateReducer& reducer, std::vector<Candidate>& out);

/// True if two points of one rod belong to different parts that can touch each other.
bool differentParts(const RodShape& rod, double s1, double s2);

/// Sets frame, points and gap of a candidate between two rods.
void setRodFrame(Candidate& c, const Vec2& centreA, double halfA, const Vec2& centreB, double halfB, const Vec2& normal,
                 double distance);
/// True if the sample lies on the left of a foot.
bool liesLeft(const Sample& sample, const Foot& foot, double curvature, double tolerance);
/// Sample against the end of a rod, a tip or the weld of a closed one: distance (m), unit vector from the end to the
/// sample, and side.
struct EndHit {
    double distance = 0.0;
    Vec2 normal = Vec2::Zero();
    bool left = false;
};
EndHit againstEnd(const Sample& sample, const Vec2& end, const Vec2& tangent);

} // namespace supercircle::contact
