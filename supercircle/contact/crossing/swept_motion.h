#pragma once
// Motion of rods and outlines between two configurations, for the crossing check.
//
// Most elements are far from any other rod. Every element therefore first gets a box around its whole motion, from
// bounds without trigonometry. Circular arcs are built only where boxes of two rods' elements overlap.

#include "supercircle/contact/circular_arc.h"
#include "supercircle/support/parallel.h"

#include <cmath>
#include <cstdint>
#include <vector>

namespace supercircle::contact::crossing_check {

struct AlignedBox {
    Vec2 lower = Vec2::Constant(INFINITY);
    Vec2 upper = Vec2::Constant(-INFINITY);
    void include(const Vec2& p) {
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
    }
    void include(const CircularArc& p) {
        include(p.start);
        include(p.end);
        include(p.apex);
    }
    void enlarge(double pad) {
        lower -= Vec2::Constant(pad);
        upper += Vec2::Constant(pad);
    }
    [[nodiscard]] bool overlaps(const AlignedBox& b) const {
        return lower.x() <= b.upper.x() && b.lower.x() <= upper.x() && lower.y() <= b.upper.y() &&
               b.lower.y() <= upper.y();
    }
};

/// The rigid part of a motion: `reference` moves straight by `shift` (m), the rest rotates about it by `turn` (rad).
struct RigidMotion {
    Vec2 reference = Vec2::Zero();
    Vec2 shift = Vec2::Zero();
    double turn = 0.0;
    Vec2 back{1.0, 0.0}; ///< cosine and sine of -turn
};

/// An arc that moves from one configuration to the next.
struct MovingArc {
    CircularArc before;
    bool complete = false; ///< false: only `before`, `angle`, `s0` and the indices are set
    RigidMotion frame;
    Vec2 arm = Vec2::Zero();       ///< from the frame's reference to the middle at the start, m
    Vec2 armChange = Vec2::Zero(); ///< change of the arm in the frame, m
    Vec2 shift = Vec2::Zero();     ///< displacement of the middle, m
    double angle = 0.0;            ///< at the middle, at the start, rad
    double turn = 0.0;             ///< rotation of the middle, rad
    double curvatureChange = 0.0;  ///< change of curvature, 1/m
    double pathBound = 0.0;        ///< bound on any point's path beyond the middle's mean motion, m
    double endMismatch = 0.0;      ///< bound on the distance of an end from its neighbour's end during the motion, m
    AlignedBox box;                ///< of the whole motion
    double s0 = 0.0;               ///< arc length on the rod at the middle, m
    std::int32_t rod = -1;
    std::int32_t element = -1;
    std::int32_t outline = -1;
    double halfThickness = 0.0;

    [[nodiscard]] CircularArc at(double lambda) const;
};

/// Bounds valid for all elements of a rod.
struct MotionBound {
    double path = 0.0;        ///< bound on the path of any point of an element, m
    double endMismatch = 0.0; ///< bound on MovingArc::endMismatch, m
};

/// Motion of a rod. `first` counts the elements of the rods before it.
struct RodMotion {
    AlignedBox box;
    RigidMotion frame;
    MotionBound bound;
    std::size_t first = 0;
    std::size_t count = 0; ///< 0: malformed, left out
    bool still = false;    ///< resting, and the same in both configurations
};

/// Boxes of all elements' motions, as separate arrays for the vector unit.
struct ElementBoxes {
    std::vector<double> lowX, lowY, highX, highY;
    void resize(std::size_t n);
};

/// The motion of all rods and outlines; storage is kept from call to call.
class SweptMotion {
public:
    /// Computes boxes of all rods and arcs of all outlines. The lists must outlive the use of this object.
    void prepare(const std::vector<RodCurve>& before, const std::vector<RodCurve>& after,
                 const std::vector<Outline>& outlinesBefore, const std::vector<Outline>& outlinesAfter,
                 const parallel::For& loop);

    std::vector<RodMotion> rods;
    ElementBoxes boxes;
    std::vector<MovingArc> outlines;
    const std::vector<RodCurve>* before = nullptr;
    const std::vector<RodCurve>* after = nullptr;

private:
    void addRod(std::size_t r);
    void addOutline(std::size_t o, const Outline& from, const Outline& to);
};

/// The arcs that one search has requested; storage is kept from search to search.
class MovingArcs {
public:
    /// Discards all arcs. `motion` must outlive the use of this object.
    void begin(const SweptMotion& motion);
    /// The arcs of an element, built (not completed) at the first request: [first, first + count) of `arc`.
    struct ArcRange {
        std::size_t first = 0;
        std::size_t count = 0;
        std::uint64_t search = 0; ///< the search for which they were built
    };
    ArcRange arcsOf(std::size_t rod, std::size_t element);
    /// As built so far; the reference is valid until the next call of `of`.
    [[nodiscard]] const MovingArc& arc(std::size_t i) const { return arcs_[i]; }
    /// With its motion.
    const MovingArc& completed(std::size_t i);

private:
    const SweptMotion* motion_ = nullptr;
    std::vector<MovingArc> arcs_; ///< the first `used_` of them; the rest is storage
    std::size_t used_ = 0;
    std::vector<ArcRange> ranges_; ///< one for each element
    std::uint64_t search_ = 0;
};

} // namespace supercircle::contact::crossing_check
