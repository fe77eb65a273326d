#include "supercircle/contact/detection/sound_candidate.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::contact {

namespace {

/// Whether a point lies on an arc of its curve, to round-off.
bool liesOn(const RodPoint& p, const std::vector<RodCurve>& curves) {
    if (!invariants::inRange(p.rod, curves.size()))
        return false;
    const RodCurve& curve = curves[static_cast<std::size_t>(p.rod)];
    if (!invariants::inRange(p.element, curve.arcs.size()))
        return false;
    const auto e = static_cast<std::size_t>(p.element);
    const double slack = 1e-9 * (curve.nodeS.back() - curve.nodeS.front());
    return !(p.s < curve.nodeS[e] - slack) && !(p.s > curve.nodeS[e + 1] + slack);
}

/// Whether the gap is the distance of the surface points along the normal, to round-off.
[[maybe_unused]] bool gapFits(const Candidate& c) {
    const double size = c.pointA.lpNorm<1>() + c.pointB.lpNorm<1>() + std::abs(c.gap);
    return !(std::abs(c.normal.dot(c.pointA - c.pointB) - c.gap) > 1e-9 * size + 1e-15);
}

} // namespace

bool idsAreUnique(const std::vector<Candidate>& list) {
    std::vector<std::uint64_t> ids;
    for (const Candidate& c : list)
        ids.push_back(c.id);
    std::sort(ids.begin(), ids.end());
    return invariants::strictlyRising(ids);
}

void assertSound(const Candidate& c, const std::vector<RodCurve>& curves, const std::vector<Outline>& outlines,
                 double margin) {
    const bool rigid = c.b.rod < 0;
    SC_ASSERT(liesOn(c.a, curves), "side A is a point of a rod");
    SC_ASSERT(rigid ? invariants::inRange(c.outline, outlines.size()) : liesOn(c.b, curves),
              "side B is an outline or a point of a rod");
    SC_ASSERT(invariants::isUnit(c.normal), "a normal has length 1");
    SC_ASSERT_EXPENSIVE(gapFits(c), "the gap is the distance of the surface points along the normal");
    const RodCurve& a = curves[static_cast<std::size_t>(c.a.rod)];
    const double motion =
        rigid ? outlines[static_cast<std::size_t>(c.outline)].motion : curves[static_cast<std::size_t>(c.b.rod)].motion;
    SC_ASSERT_EXPENSIVE(!(c.gap > (margin + a.motion + motion) * (1.0 + 1e-6) + 1e-9 * a.halfThickness),
                        "a candidate is within reach");
    SC_ASSERT(!a.resting || (!rigid && !curves[static_cast<std::size_t>(c.b.rod)].resting),
              "two resting rods make no candidate");
}

} // namespace supercircle::contact
