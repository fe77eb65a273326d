#pragma once
// Dynamic bodies that the host's step carried elsewhere than the shells foresaw (private to step/).
//
// Within the host's step a blow, a joint or a force of its user may make a body fast that was at rest, and no shell
// acts there: the body may be past a shell at the end. It goes back to where its way first meets a shell, and keeps its
// velocity, so that the contact of the next frame stops it. The way is the straight one from the pose that was foreseen
// for the end of the frame: the copy's, or that of free flight. No shell has come there.

#include "supercircle/step/coupling/host_coupling.h"
#include "supercircle/step/stepper.h"

#include <algorithm>
#include <span>
#include <vector>

namespace supercircle::step {

/// Depth of overlap with the shells in HostCouplingWork::curves per outline, m.
void depths(const std::vector<contact::Outline>& outlines, HostCouplingWork& work, std::vector<double>& depth);

/// The shells where they are: HostCouplingWork::curves.
void takeCurves(const World& world, HostCouplingWork& work);

/// The outlines of one body, which stand together (before() in port.h). By pointer and number, because libc++ 13 makes
/// no span of two iterators of a vector.
inline std::span<const BodyOutline> outlinesOf(const std::vector<BodyOutline>& outlines, BodyId body) {
    const auto belongs = [&](const BodyOutline& o) { return o.body == body; };
    const auto first = std::find_if(outlines.begin(), outlines.end(), belongs);
    const auto last = std::find_if_not(first, outlines.end(), belongs);
    return std::span(outlines).subspan(static_cast<std::size_t>(first - outlines.begin()),
                                       static_cast<std::size_t>(last - first));
}

/// Part of the straight way between two poses on which the outlines of a body cross no shell that stops them, 1: all of
/// it. It ends where the first one is touched.
double freeShare(const World& world, std::span<const BodyOutline> pieces, const BodyState& from, const BodyState& to,
                 const PairFilter& filter, HostCouplingWork& work);

/// The pose at a share of the straight way.
inline void moveAlong(const BodyState& from, const BodyState& to, double share, BodyState& out) {
    out.centre = from.centre + share * (to.centre - from.centre);
    out.angle = from.angle + share * (to.angle - from.angle);
}

constexpr double kLeave = 0.02; ///< h, difference of place that is left to the drift

/// Reads where the original of a copy was put back to. The copy follows it where it could not get there: the copy knows
/// nothing of what the body had not touched when the frame began.
inline void seePutBack(const Port& port, Body& copy) {
    BodyState& seen = copy.hostCoupling.seen;
    (void)port.state(copy.id, seen); // it answered in this frame
    if ((seen.centre - copy.state.centre).norm() > kLeave * copy.thicknessNear) {
        copy.state.centre = seen.centre;
        copy.state.angle = seen.angle;
    }
}

/// After the host's step: puts back the bodies that are past a shell of which no outline was read for this frame.
void putBackStrays(World& world, const PairFilter& filter, Port& port, HostCouplingWork& work);

} // namespace supercircle::step
