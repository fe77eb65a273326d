// Vertices that nearly coincide, or that lie just above a face that continues their own, are moved onto each other.

#include "supercircle/contact/seams/seam_shape.h"

#include <algorithm>
#include <cmath>

namespace supercircle::contact::seam {

namespace {

/// Free ends of chains keep their place, because the next edge knows it. So do vertices of faces so short that their
/// direction would be lost.
bool movable(const Shape& shape, std::size_t vertex, double tolerance) {
    Ray rays[2];
    const std::size_t count = shape.rays(vertex, rays);
    return shape.kind() != OutlineKind::OneSided && count > 0 &&
           std::all_of(rays, rays + count, [&](const Ray& r) { return r.length >= 4.0 * tolerance; });
}

bool alike(const Ray& a, const Ray& b, double cosine) {
    const double c = a.normal.dot(b.normal);
    return (a.twoSided || b.twoSided ? std::abs(c) : c) >= cosine;
}

/// True if the surface goes on from one vertex to the other.
bool continues(const Shape& a, std::size_t vertexA, const Shape& b, std::size_t vertexB) {
    Ray ra[2], rb[2];
    const std::size_t na = a.rays(vertexA, ra), nb = b.rays(vertexB, rb);
    for (std::size_t i = 0; i < na; ++i)
        for (std::size_t j = 0; j < nb; ++j)
            if (ra[i].along.dot(rb[j].along) <= -kSmooth && alike(ra[i], rb[j], kSmooth))
                return true;
    return false;
}

/// The mean of the vertices that meet here, or the place of one that cannot move.
bool meetingPoint(const std::vector<Shape>& shapes, const std::vector<std::uint32_t>& near, std::size_t i,
                  std::size_t vertex, double frame, Vec2& place) {
    const Shape& shape = shapes[i];
    const Vec2& v = shape.points[vertex];
    Vec2 sum = v;
    double count = 1.0;
    for (const std::uint32_t j : near) {
        const Shape& other = shapes[j];
        const double tolerance = toleranceOf(shape, other);
        if (tolerance <= 0.0 || !movable(shape, vertex, tolerance) ||
            !atRest(*shape.piece, *other.piece, v, frame, tolerance))
            continue;
        for (std::size_t m = 0; m < other.points.size(); ++m) {
            const Vec2& w = other.points[m];
            if ((w - v).norm() > tolerance || !continues(shape, vertex, other, m))
                continue;
            if (!movable(other, m, tolerance)) {
                place = w;
                return true;
            }
            sum += w;
            count += 1.0;
        }
    }
    place = sum / count;
    return count > 1.0;
}

/// The face under a vertex that continues a face of its own; the highest if there are several.
bool faceBelow(const std::vector<Shape>& shapes, const std::vector<std::uint32_t>& near, std::size_t i,
               std::size_t vertex, double frame, Target& target) {
    const Shape& shape = shapes[i];
    const Vec2& v = shape.points[vertex];
    Ray rays[2];
    const std::size_t count = shape.rays(vertex, rays);
    double least = 1e300;
    for (const std::uint32_t j : near) {
        const Shape& other = shapes[j];
        const double tolerance = toleranceOf(shape, other);
        if (tolerance <= 0.0 || !movable(shape, vertex, tolerance) ||
            !atRest(*shape.piece, *other.piece, v, frame, tolerance))
            continue;
        for (std::size_t f = 0; f < other.faces(); ++f) {
            const Vec2 w = v - other.points[f];
            const double x = w.dot(other.along[f]);
            const Ray face{other.along[f], other.normal(f), other.length[f], other.kind() == OutlineKind::Segment};
            for (std::size_t r = 0; r < count; ++r) {
                const double y = face.twoSided ? std::abs(w.dot(face.normal)) : w.dot(face.normal);
                if (x <= 0.0 || x >= face.length || y < 0.0 || y > tolerance || y >= least ||
                    std::abs(rod::cross(rays[r].along, face.along)) > kCollinear || !alike(rays[r], face, kSmooth))
                    continue;
                least = y;
                target = {j, f, vertex};
            }
        }
    }
    return least < 1e300;
}

bool convex(const Shape& shape) {
    for (std::size_t f = 0; f < shape.faces(); ++f)
        if (shape.kind() == OutlineKind::Polygon && rod::cross(shape.along[shape.before(f)], shape.along[f]) < 0.0)
            return false;
    return true;
}

/// Takes over places that differ by more than rounding.
void move(Shape& shape, const std::vector<Vec2>& to) {
    const double least = 1e-6 * kSeamTolerance * shape.thickness;
    bool any = false;
    for (std::size_t k = 0; k < to.size(); ++k)
        if ((to[k] - shape.points[k]).norm() > least) {
            shape.points[k] = to[k];
            any = true;
        }
    if (!any)
        return;
    shape.update();
    if (convex(shape))
        return;
    shape.points = shape.piece->outline.points;
    shape.update();
}

} // namespace

void weld(std::vector<Shape>& shapes, const std::vector<std::vector<std::uint32_t>>& near, double frame,
          const std::vector<char>& stale, std::vector<Moves>& moves) {
    moves.resize(shapes.size());
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        Moves& m = moves[i];
        m.to.assign(shapes[i].points.begin(), shapes[i].points.end());
        m.welded.assign(m.to.size(), 0);
        m.targets.clear();
        if (!stale[i] || shapes[i].faces() == 0)
            continue;
        for (std::size_t k = 0; k < m.to.size(); ++k)
            m.welded[k] = meetingPoint(shapes, near[i], i, k, frame, m.to[k]) ? 1 : 0;
        Target target;
        for (std::size_t k = 0; k < m.to.size(); ++k)
            if (!m.welded[k] && faceBelow(shapes, near[i], i, k, frame, target))
                m.targets.push_back(target);
    }
    for (std::size_t i = 0; i < shapes.size(); ++i)
        move(shapes[i], moves[i].to);
    // A face under a vertex may have moved itself: the second pass takes the place where it has gone.
    for (int pass = 0; pass < 2; ++pass) {
        for (std::size_t i = 0; i < shapes.size(); ++i) {
            moves[i].to.assign(shapes[i].points.begin(), shapes[i].points.end());
            for (const Target& t : moves[i].targets) {
                const Shape& other = shapes[t.shape];
                const Vec2 normal = rod::perp(other.along[t.face]);
                Vec2& p = moves[i].to[t.vertex];
                p -= (p - other.points[t.face]).dot(normal) * normal;
            }
        }
        for (std::size_t i = 0; i < shapes.size(); ++i)
            if (!moves[i].targets.empty())
                move(shapes[i], moves[i].to);
    }
}

} // namespace supercircle::contact::seam
