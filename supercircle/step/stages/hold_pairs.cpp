// Held points of one shell stop where the shell between them cannot follow: holds are eliminated from the step's
// equations, so that a shell drawn straight, or its ends pressed onto each other, would answer with any force. Each
// frame compares the way of both points with what the arc between them allows (decision 0226).

#include "supercircle/step/stages/hold_pairs.h"

#include "supercircle/rod/kinematics.h"
#include "supercircle/step/applied_forces.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

/// Of the longest chord between two held points. With 1 - kTaut halved the force is four times as large where clamps
/// turn the ends (a boundary layer of the length sqrt(B / T)) and 1.6 times where pins do not.
constexpr double kTaut = 0.995;
/// Thicknesses between two held points that come together; their surfaces would meet at 1. Halved to 1.02 the law of
/// contact is still far (overlaps of 0.001 count); doubled it shows.
constexpr double kApart = 1.05;
constexpr double kRounding = 1e-9; ///< of the arc
constexpr int kParts = 16;         ///< of a frame, in which the cubic ways of targets are looked at

/// Two held points and the arc between them.
struct HeldPair {
    const World& world;
    const Rod& rod;
    const Hold& a;
    const Hold& b;
    double arc; ///< the shorter one, m

    [[nodiscard]] double taut(const Pose& pa, const Pose& pb) const;
    /// Way that is left until the points are too far apart, and until they are too close, m; at `ahead` s from now.
    [[nodiscard]] double slack(double ahead) const {
        const Pose pa = poseAfter(world, a, ahead), pb = poseAfter(world, b, ahead);
        const double chord = (pb.point - pa.point).norm();
        const double near = kApart * rod.model.definition().thickness;
        return std::min(taut(pa, pb) - chord,
                        arc > 2.0 * near ? chord - near : std::numeric_limits<double>::infinity());
    }
};

/// Longest chord that the elements can reach, m: a clamp turns its element out of the straight line.
double HeldPair::taut(const Pose& pa, const Pose& pb) const {
    const Vec2 chord = pb.point - pa.point;
    double lost = 0.0;
    const auto turn = [&](const Hold& h, double angle) {
        if (!h.clamped || chord.isZero(0.0))
            return;
        const Vec2 tangent(math::cos(angle), math::sin(angle));
        const double off = std::abs(math::atan2(rod::cross(tangent, chord), tangent.dot(chord)));
        const double length = rod.model.elementLength(rod.model.elementAt(h.s));
        lost += off > 0.0 ? length * (1.0 - math::sin(off) / off) : 0.0;
    };
    if (!rod.model.definition().closed) {
        turn(a, pa.angle);
        turn(b, pb.angle);
    }
    return kTaut * std::max(0.0, arc - lost);
}

/// When the pair leaves what the shell allows, s from now; infinite: not in this frame.
double leaves(const HeldPair& pair, double frame) {
    const double least = std::min(0.0, pair.slack(0.0)) - kRounding * pair.arc;
    double before = 0.0;
    for (int i = 1; i <= kParts; ++i) {
        double after = frame * i / kParts;
        if (pair.slack(after) >= least) {
            before = after;
            continue;
        }
        for (int k = 0; k < 50; ++k) {
            const double middle = 0.5 * (before + after);
            (pair.slack(middle) >= least ? before : after) = middle;
        }
        return before;
    }
    return std::numeric_limits<double>::infinity();
}

} // namespace

void stopHeldPairs(const World& world, double frame, Rod& rod) {
    const auto stopBy = [&](Hold& hold, double at) {
        hold.stop.time = std::min(hold.stop.time, world.time + at);
        hold.stop.byHold = hold.stop.byHold || hold.target.moving();
    };
    for (std::size_t i = 0; i < rod.holds.size(); ++i)
        for (std::size_t j = i + 1; j < rod.holds.size(); ++j) {
            Hold *a = &rod.holds[i], *b = &rod.holds[j];
            if (a->s > b->s)
                std::swap(a, b);
            if (a->onCrosshead || b->onCrosshead || (!a->target.moving() && !b->target.moving()))
                continue;
            double arc = b->s - a->s;
            if (rod.model.definition().closed)
                arc = std::min(arc, rod.model.definition().length - arc);
            const double at = leaves({world, rod, *a, *b, arc}, frame);
            if (!(at < std::numeric_limits<double>::infinity()))
                continue;
            stopBy(*a, at);
            stopBy(*b, at);
        }
}

} // namespace supercircle::step
