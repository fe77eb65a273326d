#pragma once
// An outline prepared for joining (private to contact/).

#include "supercircle/contact/seams.h"

namespace supercircle::contact::seam {

constexpr double kSmooth = 0.7;       ///< cosine of the turn up to which a surface continues over a vertex
constexpr double kCollinear = 0.0175; ///< sine of one degree
constexpr double kConvex = 1e-6;      ///< rad, turn from which a vertex of the union is a corner
constexpr double kSame = 1e-3;        ///< tolerances, distance of vertices that are one

/// A face as it leaves a vertex.
struct Ray {
    Vec2 along = Vec2::UnitX();  ///< unit, away from the vertex
    Vec2 normal = Vec2::UnitY(); ///< out of the solid
    double length = 0.0;         ///< m
    bool twoSided = false;
};

struct Shape {
    const SeamPiece* piece = nullptr;
    OutlinePoints points;       ///< as moved so far
    std::vector<Vec2> along;    ///< of face i from point i, unit
    std::vector<double> length; ///< m
    Vec2 low = Vec2::Zero(), high = Vec2::Zero();
    double width = 0.0;     ///< least extent of a polygon, m
    double thickness = 0.0; ///< of shells near it or near what it touches, m; 0: none

    [[nodiscard]] OutlineKind kind() const { return piece->outline.kind; }
    [[nodiscard]] std::size_t faces() const { return along.size(); }
    /// Out of the solid; of a two-sided segment to the left.
    [[nodiscard]] Vec2 normal(std::size_t face) const {
        return kind() == OutlineKind::Polygon ? Vec2(-rod::perp(along[face])) : rod::perp(along[face]);
    }
    [[nodiscard]] std::size_t before(std::size_t vertex) const { return (vertex + points.size() - 1) % points.size(); }
    /// One face or two at a vertex.
    std::size_t rays(std::size_t vertex, Ray (&out)[2]) const;
    /// True if detection can meet a corner at this vertex.
    [[nodiscard]] bool hasCorner(std::size_t vertex) const;
    /// Directions and lengths after a change of the points.
    void update();
};

/// False for a degenerate outline, which is joined to none. `thickest`: of all shells, m.
bool prepare(const SeamPiece& piece, double thickest, Shape& shape);

/// True if they have one filter and one radius.
bool mayJoin(const Outline& a, const Outline& b);

/// Largest distance at which the two are joined, m; 0: they are not.
double toleranceOf(const Shape& a, const Shape& b);

/// True if the surfaces of two bodies move against each other at p by at most `tolerance` within the frame.
bool atRest(const SeamPiece& a, const SeamPiece& b, const Vec2& p, double frame, double tolerance);

/// Where a vertex that lies just above a face goes.
struct Target {
    std::uint32_t shape = 0;
    std::size_t face = 0;
    std::size_t vertex = 0;
};

/// Storage of weld(), per shape.
struct Moves {
    std::vector<Vec2> to;        ///< per vertex
    std::vector<char> welded;    ///< per vertex: it has a partner
    std::vector<Target> targets; ///< of the vertices above faces
};

/// Moves the vertices of all shapes onto each other where the surface continues. `near[i]`: those that shape i touches.
/// Only shapes with `stale[i]` count.
void weld(std::vector<Shape>& shapes, const std::vector<std::vector<std::uint32_t>>& near, double frame,
          const std::vector<char>& stale, std::vector<Moves>& storage);

/// Solid directions from `from` counter-clockwise to `to`; of a two-sided segment a single one.
struct Sector {
    Vec2 from = Vec2::UnitX(), to = Vec2::UnitX();
    double start = 0.0; ///< rad, in [0, 2 pi)
    double width = 0.0; ///< rad
    bool own = false;
};

/// Normal cones of the vertices of shape i in the union; `sectors` is storage.
void findCones(const std::vector<Shape>& shapes, const std::vector<std::uint32_t>& near, std::size_t i, double frame,
               std::vector<Sector>& sectors, std::vector<VertexSeam>& out);

/// Stretches of the faces of shape i inside others.
void findHidden(const std::vector<Shape>& shapes, const std::vector<std::uint32_t>& near, std::size_t i, double frame,
                std::vector<HiddenSpan>& out);

} // namespace supercircle::contact::seam
