#pragma once
// What the crossing witness looks at: rods and outlines on their way from one configuration to the next, cut into
// pieces of circles.
//
// Most elements are nowhere near another rod. So every element first gets a box about its whole way, by bounds without
// a sine; only where boxes of two rods' elements meet are the pieces made.

#include "supercircle/contact/crossing_piece.h"
#include "supercircle/support/parallel.h"

#include <cmath>
#include <cstdint>
#include <vector>

namespace supercircle::contact::witness {

struct AlignedBox {
    Vec2 lower = Vec2::Constant(INFINITY);
    Vec2 upper = Vec2::Constant(-INFINITY);
    void include(const Vec2& p) {
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
    }
    void include(const Piece& p) {
        include(p.start);
        include(p.end);
        include(p.apex);
    }
    void grow(double pad) {
        lower -= Vec2::Constant(pad);
        upper += Vec2::Constant(pad);
    }
    [[nodiscard]] bool meets(const AlignedBox& b) const {
        return lower.x() <= b.upper.x() && b.lower.x() <= upper.x() && lower.y() <= b.upper.y() &&
               b.lower.y() <= upper.y();
    }
};

/// The rigid part of a way: `reference` moves straight by `shift` while the rest turns about it by `turn`.
struct Frame {
    Vec2 reference = Vec2::Zero();
    Vec2 shift = Vec2::Zero();
    double turn = 0.0;
    Vec2 back{1.0, 0.0}; ///< cosine and sine of -turn
};

/// A piece on its way from one configuration to the next.
struct Moving {
    Piece before;
    bool complete = false; ///< false: only `before`, `angle` and the places below it are set
    Frame frame;
    Vec2 arm = Vec2::Zero();   ///< from the frame's reference to the middle, before, m
    Vec2 drift = Vec2::Zero(); ///< change of the arm in the frame, m
    Vec2 shift = Vec2::Zero(); ///< of the middle, from first to last, m
    double angle = 0.0;        ///< before, at the middle, rad
    double turn = 0.0;         ///< rad
    double bend = 0.0;         ///< change of curvature, 1/m
    double swing = 0.0;        ///< bound on any point's path beyond the middle's mean motion, m
    double gap = 0.0;          ///< bound on how far an end strays from its neighbour's on the way, m
    AlignedBox box;            ///< of the whole way
    double s0 = 0.0;           ///< arc length on the rod at the middle
    std::int32_t rod = -1;
    std::int32_t element = -1;
    std::int32_t outline = -1;
    double halfThickness = 0.0;

    [[nodiscard]] Piece at(double lambda) const;
};

/// Bounds for all elements of a rod, m.
struct Motion {
    double travel = 0.0; ///< bound on the path of any point of an element
    double slack = 0.0;  ///< bound on Moving::gap
};

/// A rod on its way. `first` counts the elements of the rods before it.
struct RodWay {
    AlignedBox box;
    Frame frame;
    Motion motion;
    std::size_t first = 0;
    std::size_t count = 0; ///< 0: malformed, left out
    bool still = false;    ///< resting, and the same in both configurations
};

/// Boxes of all elements' ways, side by side for the vector unit.
struct ElementBoxes {
    std::vector<double> lowX, lowY, highX, highY;
    void resize(std::size_t n);
};

/// All ways between two configurations; storage is kept from call to call.
class Ways {
public:
    /// Boxes of all rods, pieces of all outlines. The lists must live as long as pieces are asked for.
    void prepare(const std::vector<Curve>& before, const std::vector<Curve>& after,
                 const std::vector<Outline>& outlinesBefore, const std::vector<Outline>& outlinesAfter,
                 const parallel::For& loop);

    std::vector<RodWay> rods;
    ElementBoxes boxes;
    std::vector<Moving> outlines;
    const std::vector<Curve>* before = nullptr;
    const std::vector<Curve>* after = nullptr;

private:
    void addRod(std::size_t r);
    void addOutline(std::size_t o, const Outline& from, const Outline& to);
};

/// The pieces that one search has asked for; storage is kept from search to search.
class Pieces {
public:
    /// Forgets all pieces. `ways` must live as long as pieces are asked for.
    void begin(const Ways& ways);
    /// The pieces of an element, made (not completed) when first asked for: [first, first + count) of `piece`.
    struct Range {
        std::size_t first = 0;
        std::size_t count = 0;
        std::uint64_t search = 0; ///< for which they were made
    };
    Range of(std::size_t rod, std::size_t element);
    /// As it is; references hold until the next call of `of`.
    [[nodiscard]] const Moving& piece(std::size_t i) const { return pieces_[i]; }
    /// With its way.
    const Moving& completed(std::size_t i);

private:
    const Ways* ways_ = nullptr;
    std::vector<Moving> pieces_; ///< the first `used_` of them; the rest is storage
    std::size_t used_ = 0;
    std::vector<Range> ranges_; ///< of every element
    std::uint64_t search_ = 0;
};

} // namespace supercircle::contact::witness
