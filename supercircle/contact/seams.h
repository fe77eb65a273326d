#pragma once
// Joins outlines that touch. A floor of many boxes has corners and side faces that are no part of its surface; a shell
// that met them would be thrown back by a normal that the floor does not have. Vertices within a tenth of the shell's
// thickness are moved onto each other where the surface continues, so that small steps become slopes. Then every vertex
// gets the normal cone of the union, and stretches of faces inside another outline are marked (decision 0178).

#include "supercircle/contact/geometry.h"

#include <memory>

namespace supercircle::contact {

/// One outline in world coordinates, and what decides whether it is joined to another.
struct SeamPiece {
    Outline outline; ///< points, kind, radius, joints of chains and filter count; key and motion do not
    std::uint64_t body = 0;
    std::uint32_t key = 0;        ///< with `body` the identity; pieces are sorted by (body, key)
    Vec2 centre = Vec2::Zero();   ///< of the body, m
    Vec2 velocity = Vec2::Zero(); ///< of that point, m/s
    double spin = 0.0;            ///< rad/s
    double thickness = 0.0;       ///< of the thinnest shell near it, m; 0: no shell is near
    bool changed = true;          ///< something above differs from the last call
};

/// What joining makes of one piece.
struct Joined {
    OutlineSeams seams;   ///< directions in world coordinates
    OutlinePoints points; ///< m; the piece's own unless `moved`
    bool moved = false;
};

/// Thicknesses, largest distance that is joined: a tenth, and what a host in single precision adds to it.
constexpr double kSeamTolerance = 0.101;

/// Keeps the neighbours of the last call, so that only pieces near changed ones are joined again. The result does not
/// depend on that history.
class SeamJoiner {
public:
    SeamJoiner();
    ~SeamJoiner();
    SeamJoiner(SeamJoiner&&) noexcept;
    SeamJoiner& operator=(SeamJoiner&&) noexcept;

    /// Pieces are joined if they have one filter and one radius and move against each other by at most the tolerance
    /// within `frame` (s). Returns one result per piece, valid until the next call.
    const std::vector<Joined>& join(const std::vector<SeamPiece>& pieces, double frame);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::contact
