// Stretches of faces inside other outlines: a face is clipped by the half planes of a convex solid.

#include "supercircle/contact/seams/seam_shape.h"

#include <algorithm>
#include <cmath>

namespace supercircle::contact::seam {

namespace {

constexpr double kOpposed = 0.86; ///< cosine of the angle up to which two faces count as lying against each other

/// A face as a way along which it is clipped.
struct Way {
    Vec2 start = Vec2::Zero(), along = Vec2::UnitX(), normal = Vec2::UnitY();
    double from = 0.0, to = 0.0; ///< m

    /// Keeps where (p - at) . outward <= limit.
    void clip(const Vec2& at, const Vec2& outward, double limit) {
        const double d = (start - at).dot(outward) - limit, slope = along.dot(outward);
        if (std::abs(slope) < 1e-12) {
            if (d > 0.0)
                to = from - 1.0;
        } else if (slope > 0.0) {
            to = std::min(to, -d / slope);
        } else {
            from = std::max(from, -d / slope);
        }
    }
};

/// True if the way lies against a face: opposed, and not farther from it than the tolerance anywhere.
bool liesAgainst(const Way& way, const Vec2& at, const Vec2& normal, double tolerance) {
    if (way.normal.dot(normal) > -kOpposed)
        return false;
    const double a = (way.start + way.from * way.along - at).dot(normal);
    const double b = (way.start + way.to * way.along - at).dot(normal);
    return std::min(std::abs(a), std::abs(b)) <= tolerance || a * b < 0.0;
}

/// Where a face enters another outline it answers on for one tolerance, so that a shell in the valley that is a little
/// deep in one of the two does not lose the other. A face that ends there enters nothing.
double valley(const Way& way, const Vec2& at, const Vec2& normal, double tolerance) {
    const double a = (way.start + way.from * way.along - at).dot(normal);
    const double b = (way.start + way.to * way.along - at).dot(normal);
    return std::min(std::abs(a), std::abs(b)) <= tolerance ? 0.0 : -tolerance;
}

Way insidePolygon(const Way& whole, const Shape& other, double tolerance) {
    Way way = whole;
    const double least = 1e-6 * tolerance;
    bool against = false;
    for (std::size_t g = 0; g < other.faces(); ++g)
        against = against || liesAgainst(whole, other.points[g], other.normal(g), tolerance);
    for (std::size_t g = 0; g < other.faces(); ++g) {
        const Vec2 normal = other.normal(g);
        const bool alike = way.normal.dot(normal) >= kSmooth;
        way.clip(other.points[g], normal,
                 alike     ? -least
                 : against ? tolerance
                           : valley(whole, other.points[g], normal, tolerance));
    }
    return way;
}

/// A chain edge counts as a solid as deep as detection looks behind it.
Way behindEdge(Way way, const Shape& self, const Shape& other, double tolerance) {
    const Vec2 normal = other.normal(0), along = other.along[0];
    const bool alike = way.normal.dot(normal) >= kSmooth;
    const bool against = liesAgainst(way, other.points[0], normal, tolerance);
    const bool opposed = way.normal.dot(normal) <= -kSmooth;
    if ((self.kind() == OutlineKind::OneSided && !alike) || (opposed && !against))
        way.to = way.from - 1.0;
    way.clip(other.points[0], normal, alike ? -1e-6 * tolerance : against ? tolerance : 0.0);
    way.clip(other.points[0], -normal, tolerance / kSeamTolerance);
    way.clip(other.points[0], -along, 0.0);
    way.clip(other.points[1], along, 0.0);
    return way;
}

Way insideDisc(Way way, const Outline& disc, double tolerance) {
    const Vec2 w = way.start - disc.points[0];
    const double middle = -w.dot(way.along), radius = disc.radius - 1e-6 * tolerance;
    const double off = rod::cross(way.along, w), square = radius * radius - off * off;
    if (disc.radius < tolerance / kSeamTolerance || square <= 0.0) {
        way.to = way.from - 1.0;
        return way;
    }
    way.from = std::max(way.from, middle - std::sqrt(square));
    way.to = std::min(way.to, middle + std::sqrt(square));
    return way;
}

} // namespace

void findHidden(const std::vector<Shape>& shapes, const std::vector<std::uint32_t>& near, std::size_t i, double frame,
                std::vector<HiddenSpan>& out) {
    const Shape& shape = shapes[i];
    out.clear();
    const std::size_t sides = shape.kind() == OutlineKind::Segment ? 2 : shape.faces();
    for (std::size_t side = 0; side < sides; ++side) {
        const std::size_t f = std::min(side, shape.faces() - 1);
        const Vec2 normal = side == f ? shape.normal(f) : Vec2(-shape.normal(f));
        const Way whole{shape.points[f], shape.along[f], normal, 0.0, shape.length[f]};
        for (const std::uint32_t j : near) {
            const Shape& other = shapes[j];
            const double tolerance = toleranceOf(shape, other);
            Way way = whole;
            if (tolerance <= 0.0)
                continue;
            if (other.kind() == OutlineKind::Polygon && other.width >= 2.0 * tolerance)
                way = insidePolygon(whole, other, tolerance);
            else if (other.kind() == OutlineKind::OneSided)
                way = behindEdge(whole, shape, other, tolerance);
            else if (other.kind() == OutlineKind::Circle)
                way = insideDisc(whole, other.piece->outline, tolerance);
            else
                continue;
            const Vec2 middle = way.start + 0.5 * (way.from + way.to) * way.along;
            if (way.to - way.from > 1e-6 * tolerance && atRest(*shape.piece, *other.piece, middle, frame, tolerance))
                out.push_back({static_cast<std::int32_t>(side), way.from, way.to});
        }
    }
}

} // namespace supercircle::contact::seam
