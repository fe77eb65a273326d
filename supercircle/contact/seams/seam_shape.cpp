#include "supercircle/contact/seams/seam_shape.h"

#include <algorithm>
#include <cmath>

namespace supercircle::contact::seam {

namespace {

/// Least distance between a face and the polygon's farthest vertex behind it.
double widthOf(const Shape& shape) {
    double width = 1e300;
    for (std::size_t f = 0; f < shape.faces(); ++f) {
        const Vec2 normal = shape.normal(f);
        double deepest = 0.0;
        for (const Vec2& p : shape.points)
            deepest = std::max(deepest, -(p - shape.points[f]).dot(normal));
        width = std::min(width, deepest);
    }
    return width;
}

} // namespace

void Shape::update() {
    const std::size_t n = points.size();
    const std::size_t count = kind() == OutlineKind::Circle ? 0 : kind() == OutlineKind::Polygon ? n : 1;
    along.resize(count);
    length.resize(count);
    for (std::size_t f = 0; f < count; ++f) {
        along[f] = points[(f + 1) % n] - points[f];
        length[f] = along[f].norm();
        along[f] /= length[f];
    }
}

std::size_t Shape::rays(std::size_t vertex, Ray (&out)[2]) const {
    if (kind() == OutlineKind::Circle)
        return 0;
    if (kind() == OutlineKind::Polygon) {
        const std::size_t last = before(vertex);
        out[0] = {along[vertex], normal(vertex), length[vertex], false};
        out[1] = {-along[last], normal(last), length[last], false};
        return 2;
    }
    out[0] = {vertex == 0 ? along[0] : Vec2(-along[0]), normal(0), length[0], kind() == OutlineKind::Segment};
    return 1;
}

bool Shape::hasCorner(std::size_t vertex) const {
    const Outline& o = piece->outline;
    if (kind() != OutlineKind::OneSided)
        return kind() != OutlineKind::Circle;
    if (vertex == 1)
        return !o.joinedEnd; // a joined corner belongs to the edge that starts there
    return !o.joinedStart || rod::cross(points[0] - o.neighbourStart, along[0]) < 0.0;
}

bool prepare(const SeamPiece& piece, double thickest, Shape& shape) {
    shape.piece = &piece;
    shape.thickness = piece.thickness;
    shape.points = piece.outline.points;
    shape.update();
    // A chain edge counts as a solid of one thickness (hidden_spans.cpp).
    double pad = (shape.kind() == OutlineKind::OneSided ? 1.0 : kSeamTolerance) * thickest;
    if (shape.kind() == OutlineKind::Circle)
        pad += piece.outline.radius;
    shape.low = shape.high = shape.points[0];
    for (const Vec2& p : shape.points) {
        if (!std::isfinite(p.x() + p.y()))
            return false;
        shape.low = shape.low.cwiseMin(p);
        shape.high = shape.high.cwiseMax(p);
    }
    shape.low -= Vec2::Constant(pad);
    shape.high += Vec2::Constant(pad);
    for (const double length : shape.length)
        if (!(length > 0.0))
            return false;
    shape.width = shape.kind() == OutlineKind::Polygon ? widthOf(shape) : 0.0;
    return true;
}

bool mayJoin(const Outline& a, const Outline& b) {
    const double skinA = a.kind == OutlineKind::Circle ? 0.0 : a.radius;
    const double skinB = b.kind == OutlineKind::Circle ? 0.0 : b.radius;
    return a.category == b.category && a.mask == b.mask && a.group == b.group && skinA == skinB;
}

double toleranceOf(const Shape& a, const Shape& b) {
    if (a.thickness > 0.0 && b.thickness > 0.0)
        return kSeamTolerance * std::min(a.thickness, b.thickness);
    return 0.0;
}

bool atRest(const SeamPiece& a, const SeamPiece& b, const Vec2& p, double frame, double tolerance) {
    if (a.body == b.body)
        return true;
    const Vec2 motion = a.velocity - b.velocity + a.spin * rod::perp(p - a.centre) - b.spin * rod::perp(p - b.centre);
    return motion.norm() * frame <= tolerance;
}

} // namespace supercircle::contact::seam
