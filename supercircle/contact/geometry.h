#pragma once
// Input of contact detection: curves with a thickness, and rigid outlines. Geometry only: no masses, forces or time
// steps.

#include "supercircle/contact/outline_points.h"
#include "supercircle/contact/outline_seams.h"
#include "supercircle/rod/arc.h"

#include <cstdint>
#include <vector>

namespace supercircle::contact {

using rod::Arc;
using rod::Vec2;

/// The centre line of one rod: its arcs joined end to end, from the first tip (arc length 0) to the last.
struct RodCurve {
    std::vector<Arc> arcs;      ///< element i runs from node i to node i+1, all lengths > 0
    std::vector<double> nodeS;  ///< arcs.size() + 1 arc lengths of the nodes, m
    double halfThickness = 0.0; ///< m
    double midS = 0.0;          ///< arc length of the mid-rod sample point, m
    double motion = 0.0;        ///< upper bound of the displacement of any point in the next step, m
    bool closed = false;        ///< ends welded: no tips; the first and last elements are neighbours
    std::uint32_t key = 0;      ///< stable identity of the rod (survives insertion and removal of others), < 2^20
    std::uint32_t category = 1; ///< collision filter bits, as in Box2D
    std::uint32_t mask = 0xffffffffu;
    std::int32_t group = 0; ///< as in Box2D: two objects of the same positive group always collide, of the same
                            ///< negative group never, whatever the masks; not applied to a rod and itself
    /// Asleep: no candidates for pairs of two resting curves, for a resting curve with itself or with outlines.
    bool resting = false;
};

enum class OutlineKind : std::uint8_t {
    Segment,  ///< two-sided wall segment: rods may lie on either side
    OneSided, ///< chain edge: solid on the right of points[0] -> points[1]
    Circle,   ///< solid disc: points[0] is the centre
    Polygon   ///< solid convex polygon, counter-clockwise
};

/// One rigid outline in world coordinates (SI), attached to some body.
struct Outline {
    OutlineKind kind = OutlineKind::Segment;
    OutlinePoints points;
    double radius = 0.0;      ///< radius of the disc (Circle) or skin of the others, m; contact is at this distance
    bool joinedStart = false; ///< one-sided chain edges: a neighbouring edge starts at points[0], which is no free end
    bool joinedEnd = false;
    Vec2 neighbourStart =
        Vec2::Zero(); ///< the far point of the joined neighbour, m; decides whether the corner is convex
    Vec2 neighbourEnd = Vec2::Zero();
    std::uint32_t body = 0; ///< index into the caller's body list
    std::uint32_t key = 0;  ///< stable identity of the outline, < 2^20
    double motion = 0.0;    ///< upper bound of the displacement of any point in the next step, m
    std::uint32_t category = 1;
    std::uint32_t mask = 0xffffffffu;
    std::int32_t group = 0;
    OutlineSeams seams; ///< with the outlines it touches
    bool operator==(const Outline&) const = default;
};

} // namespace supercircle::contact
