// The solids round a vertex are sectors of directions. What they leave free decides: a free sector of more than half a
// turn makes the vertex a corner of the union, whose normal cone lies between the perpendiculars of its bounds.

#include "supercircle/contact/seams/seam_shape.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::contact::seam {

namespace {

constexpr double kCrack = 0.1;    ///< rad, free sector up to which a vertex counts as covered all round
constexpr double kValley = 0.785; ///< rad, concave turn from which a vertex is left as it is

double angleFrom(const Vec2& a, const Vec2& b) {
    const double turn = math::atan2(rod::cross(a, b), a.dot(b));
    return turn < 0.0 ? turn + 2.0 * M_PI : turn;
}

void add(const Vec2& from, const Vec2& to, bool own, std::vector<Sector>& sectors) {
    sectors.push_back({from, to, angleFrom(Vec2::UnitX(), from), angleFrom(from, to), own});
}

/// The solid at a vertex of an outline itself.
void addVertex(const Shape& shape, std::size_t vertex, bool own, std::vector<Sector>& sectors) {
    const Outline& o = shape.piece->outline;
    if (shape.kind() == OutlineKind::Polygon) {
        add(shape.along[vertex], -shape.along[shape.before(vertex)], own, sectors);
        return;
    }
    const Vec2& along = shape.along[0];
    if (shape.kind() == OutlineKind::Segment) {
        const Vec2 ray = vertex == 0 ? along : Vec2(-along);
        add(ray, ray, own, sectors);
        return;
    }
    // Solid on the right; a free end falls off at a right angle.
    const Vec2 down = -rod::perp(along);
    if (vertex == 0)
        add(o.joinedStart ? Vec2((o.neighbourStart - shape.points[0]).normalized()) : down, along, own, sectors);
    else
        add(-along, o.joinedEnd ? Vec2((o.neighbourEnd - shape.points[1]).normalized()) : down, own, sectors);
}

/// The solid beside a face.
void addFace(const Shape& shape, std::size_t face, std::vector<Sector>& sectors) {
    const Vec2& along = shape.along[face];
    if (shape.kind() == OutlineKind::Segment) {
        add(along, along, false, sectors);
        add(-along, -along, false, sectors);
    } else if (shape.kind() == OutlineKind::Polygon) {
        add(along, -along, false, sectors);
    } else {
        add(-along, along, false, sectors);
    }
}

enum class Meeting : std::uint8_t { None, Touches, Inside };

struct Query {
    const Shape& shape; ///< whose vertex it is
    std::size_t vertex;
    const Vec2& p;
    double tolerance; ///< m
    bool earlier;     ///< the other outline precedes, and answers for a common vertex
};

Meeting meetCircle(const Query& q, const Outline& disc, double thickness, std::vector<Sector>& sectors) {
    const Vec2 w = q.p - disc.points[0];
    const double depth = disc.radius - w.norm();
    if (disc.radius < thickness || depth < -q.tolerance)
        return Meeting::None; // a shell can reach round a small disc
    if (depth > q.tolerance)
        return Meeting::Inside;
    const Vec2 tangent = rod::perp(w.normalized());
    add(tangent, -tangent, false, sectors);
    return Meeting::Touches;
}

/// The vertex of `other` that is met, or its number of points.
std::size_t vertexAt(const Query& q, const Shape& other) {
    std::size_t nearest = other.points.size();
    double least = q.tolerance;
    for (std::size_t m = 0; m < other.points.size(); ++m)
        if (const double d = (other.points[m] - q.p).norm(); d <= least) {
            least = d;
            nearest = m;
        }
    return nearest;
}

Meeting meetPolygon(const Query& q, const Shape& other, std::vector<Sector>& sectors) {
    double highest = -1e300;
    std::size_t face = 0;
    for (std::size_t f = 0; f < other.faces(); ++f)
        if (const double y = (q.p - other.points[f]).dot(other.normal(f)); y > highest) {
            highest = y;
            face = f;
        }
    if (highest > q.tolerance)
        return Meeting::None;
    if (highest < -q.tolerance)
        return Meeting::Inside;
    const double x = (q.p - other.points[face]).dot(other.along[face]);
    if (x < 0.0 || x > other.length[face])
        return Meeting::None;
    addFace(other, face, sectors);
    return Meeting::Touches;
}

Meeting meetEdge(const Query& q, const Shape& other, double depth, std::vector<Sector>& sectors) {
    const Vec2 w = q.p - other.points[0];
    const double x = w.dot(other.along[0]), y = w.dot(other.normal(0));
    if (x < 0.0 || x > other.length[0] || y > q.tolerance || y < -depth)
        return Meeting::None;
    if (std::abs(y) <= q.tolerance) {
        addFace(other, 0, sectors);
        return Meeting::Touches;
    }
    // Behind a chain: unreachable for shells on its free side, but not what faces away from it.
    Ray rays[2];
    const std::size_t count = q.shape.rays(q.vertex, rays);
    const bool behind = other.kind() == OutlineKind::OneSided && std::all_of(rays, rays + count, [&](const Ray& r) {
                            return !r.twoSided && r.normal.dot(other.normal(0)) > -0.1;
                        });
    return behind ? Meeting::Inside : Meeting::None;
}

/// Adds what an outline has at the vertex. `lost` is set if the vertex is also the other's and the other answers.
Meeting meet(const Query& q, const Shape& other, std::vector<Sector>& sectors, bool& lost) {
    const double thickness = q.tolerance / kSeamTolerance;
    if (other.kind() == OutlineKind::Circle)
        return meetCircle(q, other.piece->outline, thickness, sectors);
    if (other.kind() == OutlineKind::Polygon && other.width < 2.0 * q.tolerance)
        return Meeting::None;
    if (const std::size_t m = vertexAt(q, other); m < other.points.size()) {
        addVertex(other, m, false, sectors);
        lost = lost || (q.earlier && other.hasCorner(m) && (other.points[m] - q.p).norm() <= kSame * q.tolerance);
        return Meeting::Touches;
    }
    return other.kind() == OutlineKind::Polygon ? meetPolygon(q, other, sectors)
                                                : meetEdge(q, other, thickness, sectors);
}

/// Bounds of the widest free sector: indices of the sector it follows and of the one it ends at. Returns its width,
/// rad.
double widestFree(std::vector<Sector>& sectors, std::size_t& after, std::size_t& until) {
    std::stable_sort(sectors.begin(), sectors.end(),
                     [](const Sector& a, const Sector& b) { return a.start < b.start; });
    double reach = -1e300, widest = -1e300;
    std::size_t last = 0;
    for (std::size_t k = 0; k < sectors.size(); ++k)
        if (const double end = sectors[k].start + sectors[k].width - 2.0 * M_PI; end > reach) {
            reach = end;
            last = k;
        }
    for (std::size_t k = 0; k < sectors.size(); ++k) {
        if (sectors[k].start - reach > widest) {
            widest = sectors[k].start - reach;
            after = last;
            until = k;
        }
        if (const double end = sectors[k].start + sectors[k].width; end > reach) {
            reach = end;
            last = k;
        }
    }
    return widest;
}

} // namespace

void findCones(const std::vector<Shape>& shapes, const std::vector<std::uint32_t>& near, std::size_t i, double frame,
               std::vector<Sector>& sectors, std::vector<VertexSeam>& out) {
    const Shape& shape = shapes[i];
    out.assign(shape.points.size(), {});
    for (std::size_t k = 0; k < shape.points.size(); ++k) {
        if (!shape.hasCorner(k))
            continue;
        sectors.clear();
        addVertex(shape, k, true, sectors);
        bool inside = false, lost = false;
        for (const std::uint32_t j : near) {
            const double tolerance = toleranceOf(shape, shapes[j]);
            const Query query{shape, k, shape.points[k], tolerance, j < i};
            if (tolerance > 0.0 && atRest(*shape.piece, *shapes[j].piece, query.p, frame, tolerance))
                inside = inside || meet(query, shapes[j], sectors, lost) == Meeting::Inside;
        }
        if (sectors.size() == 1 && !inside)
            continue;
        std::size_t after = 0, until = 0;
        const double free = inside ? 0.0 : widestFree(sectors, after, until);
        if (!inside && free > kCrack && free < M_PI - kValley)
            continue; // in a valley: its own cone points into the other outline, where no shell is
        if (inside || lost || free <= M_PI + kConvex)
            out[k].role = VertexRole::Hidden;
        else if (!sectors[after].own || !sectors[until].own)
            out[k] = {VertexRole::Cone, -sectors[after].to, -sectors[until].from};
    }
}

} // namespace supercircle::contact::seam
