#include "supercircle/contact/outline_shape.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace supercircle::contact {

namespace {

constexpr double kCornerTurn = 1e-6; ///< sine of the angle from which a joint counts as a corner
constexpr double kConeSlack = 0.1;   ///< sine of the angle by which a corner's cone is widened for rods
constexpr double kJointSlack = 1e-9; ///< relative, by which neighbours at a seam overlap rather than leave a hole

[[noreturn]] void fail(const Outline& outline, const std::string& what) {
    throw std::invalid_argument("contact detection: outline with key " + std::to_string(outline.key) + ": " + what);
}

void check(const Outline& outline) {
    const std::size_t n = outline.points.size();
    const bool edge = outline.kind == OutlineKind::Segment || outline.kind == OutlineKind::OneSided;
    if (edge && n != 2)
        fail(outline, "a segment needs two points");
    if (outline.kind == OutlineKind::Circle && n != 1)
        fail(outline, "a circle needs one point");
    if (outline.kind == OutlineKind::Polygon && n < 3)
        fail(outline, "a polygon needs at least three points");
    if (n > 1000)
        fail(outline, "more than 1000 points");
    if (!(outline.radius >= 0.0))
        fail(outline, "negative radius");
    if (!(outline.motion >= 0.0))
        fail(outline, "motion bound is negative or not a number");
    for (const Vec2& p : outline.points)
        if (!std::isfinite(p.x() + p.y()))
            fail(outline, "a point is not finite");
}

/// Face from p to q with its normal on the given side (+1 left, -1 right).
Face makeFace(const Outline& outline, const Vec2& p, const Vec2& q, double side) {
    Face face;
    face.start = p;
    face.along = q - p;
    face.length = face.along.norm();
    if (!(face.length > 0.0))
        fail(outline, "two neighbouring points coincide");
    face.along /= face.length;
    face.normal = side * rod::perp(face.along);
    SC_ASSERT_EXPENSIVE(invariants::isUnit(face.normal), "a normal has length 1");
    return face;
}

/// Adds a corner with its own normal cone, or what the union leaves of it.
void addCorner(const Outline& outline, const Corner& alone, OutlineShape& shape) {
    if (outline.seams.vertices.empty()) {
        shape.corners.push_back(alone);
        return;
    }
    const VertexSeam& seam = outline.seams.vertices[static_cast<std::size_t>(alone.index)];
    if (seam.role == VertexRole::Alone)
        shape.corners.push_back(alone);
    else if (seam.role == VertexRole::Cone)
        shape.corners.push_back({alone.p, seam.c1, seam.c2, alone.index, outline.kind != OutlineKind::Segment});
}

/// False where another outline answers for the vertex in direction w.
bool vertexAnswers(const OutlineShape& shape, std::size_t vertex, const Vec2& w) {
    if (shape.seams.vertices.empty())
        return true;
    const VertexSeam& seam = shape.seams.vertices[vertex];
    if (seam.role != VertexRole::Cone)
        return seam.role == VertexRole::Alone;
    const double slack = -kJointSlack * w.norm();
    return w.dot(seam.c1) >= slack && w.dot(seam.c2) >= slack;
}

/// True at a place of a face that lies inside another outline; x in m from its start.
bool hiddenAt(const OutlineShape& shape, std::size_t face, double x) {
    return std::any_of(shape.seams.hidden.begin(), shape.seams.hidden.end(), [&](const HiddenSpan& span) {
        return span.face == static_cast<std::int32_t>(face) && x >= span.from && x <= span.to;
    });
}

void prepareOneSided(const Outline& outline, OutlineShape& shape) {
    const Vec2& p = outline.points[0];
    const Vec2& q = outline.points[1];
    const Face face = makeFace(outline, p, q, 1.0);
    shape.faces.push_back(face);
    shape.joinedStart = outline.joinedStart;
    shape.joinedEnd = outline.joinedEnd;
    if (shape.joinedStart) {
        shape.before = makeFace(outline, outline.neighbourStart, p, 1.0);
        shape.convexStart = rod::cross(shape.before.along, face.along) < -kCornerTurn;
        if (shape.convexStart)
            addCorner(outline, {p, -face.along, shape.before.along, 0, true}, shape);
    } else {
        addCorner(outline, {p, -face.along, face.normal, 0, false}, shape);
    }
    if (shape.joinedEnd) {
        shape.after = makeFace(outline, q, outline.neighbourEnd, 1.0);
        shape.convexEnd = rod::cross(face.along, shape.after.along) < -kCornerTurn;
    } else {
        addCorner(outline, {q, face.along, face.normal, 1, false}, shape);
    }
}

bool round(const Vec2& corner, const Vec2& p, const Vec2& fallback, OutlineHit& hit) {
    const Vec2 w = p - corner;
    hit.point = corner;
    hit.distance = w.norm();
    hit.normal = hit.distance > 1e-15 ? Vec2(w / hit.distance) : fallback;
    hit.face = -1;
    return true;
}

bool closestOnSegment(const OutlineShape& shape, const Vec2& p, const Vec2& inward, OutlineHit& hit) {
    const Face& face = shape.faces[0];
    const Vec2 w = p - face.start;
    const double x = w.dot(face.along);
    const double y = w.dot(face.normal);
    const double slack = shape.seams.vertices.empty() ? 0.0 : kJointSlack * face.length;
    if (x < -slack)
        return vertexAnswers(shape, 0, w) && round(face.start, p, -face.along, hit);
    if (x > face.length + slack)
        return vertexAnswers(shape, 1, w - face.length * face.along) &&
               round(face.start + face.length * face.along, p, face.along, hit);
    const bool left = y != 0.0 ? y > 0.0 : inward.dot(face.normal) >= 0.0;
    hit.face = left ? 0 : 1;
    if (hiddenAt(shape, left ? 0 : 1, x))
        return false;
    hit.normal = left ? face.normal : Vec2(-face.normal);
    hit.distance = std::abs(y);
    hit.point = p - y * face.normal;
    return true;
}

/// Behind this edge near a convex joined corner: true if the point is less deep behind the neighbour.
bool neighbourIsNearer(const OutlineShape& shape, const Vec2& p, double y) {
    if (shape.joinedEnd && shape.convexEnd) {
        const Vec2 w = p - shape.after.start;
        const double other = w.dot(shape.after.normal);
        if (w.dot(shape.after.along) >= 0.0 && other < 0.0 && other > y)
            return true;
    }
    if (shape.joinedStart && shape.convexStart) {
        const Vec2 w = p - shape.before.start;
        const double other = w.dot(shape.before.normal);
        if (w.dot(shape.before.along) <= shape.before.length && other < 0.0 && other >= y)
            return true;
    }
    return false;
}

bool closestOnOneSided(const OutlineShape& shape, const Vec2& p, double depth, OutlineHit& hit) {
    const Face& face = shape.faces[0];
    const Vec2 w = p - face.start;
    const double x = w.dot(face.along);
    const double y = w.dot(face.normal);
    const double slack = shape.seams.vertices.empty() ? 0.0 : kJointSlack * face.length;
    const double before = shape.joinedStart ? 0.0 : slack, beyond = shape.joinedEnd ? 0.0 : slack;
    if (x >= -before && x <= face.length + beyond) {
        if (hiddenAt(shape, 0, x))
            return false;
        if (y < -depth || (y < 0.0 && neighbourIsNearer(shape, p, y)))
            return false;
        hit = {p - y * face.normal, face.normal, y, 0};
        return true;
    }
    if (x > face.length)
        return !shape.joinedEnd && y >= 0.0 && vertexAnswers(shape, 1, w - face.length * face.along) &&
               round(face.start + face.length * face.along, p, face.normal, hit);
    if (!shape.joinedStart)
        return y >= 0.0 && vertexAnswers(shape, 0, w) && round(face.start, p, face.normal, hit);
    if (w.dot(shape.before.along) < 0.0)
        return false; // the edge before counts
    if (shape.convexStart)
        return vertexAnswers(shape, 0, w) && round(face.start, p, face.normal, hit);
    // The wedge behind a concave corner belongs to neither face.
    if (y >= 0.0 || w.norm() > depth)
        return false;
    round(face.start, p, -face.normal, hit);
    hit.distance = -hit.distance;
    hit.normal = -hit.normal;
    return true;
}

bool closestOnPolygon(const OutlineShape& shape, const Vec2& p, OutlineHit& hit) {
    std::int32_t deepest = 0;
    double highest = -1e300;
    for (std::size_t i = 0; i < shape.faces.size(); ++i) {
        const double y = (p - shape.faces[i].start).dot(shape.faces[i].normal);
        if (y > highest) {
            highest = y;
            deepest = static_cast<std::int32_t>(i);
        }
    }
    if (highest <= 0.0) {
        const Face& face = shape.faces[static_cast<std::size_t>(deepest)];
        hit = {p - highest * face.normal, face.normal, highest, deepest};
        return true;
    }
    double nearest = 1e300;
    for (std::size_t i = 0; i < shape.faces.size(); ++i) {
        const Face& face = shape.faces[i];
        const Vec2 w = p - face.start;
        const double x = w.dot(face.along);
        const double y = w.dot(face.normal);
        if (x > 0.0 && x < face.length) {
            if (y > 0.0 && y < nearest) {
                nearest = y;
                hit = {p - y * face.normal, face.normal, y, static_cast<std::int32_t>(i)};
            }
        } else if (x <= 0.0 && w.norm() < nearest) { // every corner is the start of one face
            nearest = w.norm();
            round(face.start, p, face.normal, hit);
        }
    }
    return nearest < 1e300;
}

/// Of a point inside: the least deep place of its boundary that belongs to the union.
bool deepestInJoined(const OutlineShape& shape, const Vec2& p, OutlineHit& hit) {
    double highest = -1e300;
    for (std::size_t i = 0; i < shape.faces.size(); ++i) {
        const Face& face = shape.faces[i];
        const Vec2 w = p - face.start;
        const double y = w.dot(face.normal);
        if (y <= highest || hiddenAt(shape, i, std::min(std::max(w.dot(face.along), 0.0), face.length)))
            continue;
        highest = y;
        hit = {p - y * face.normal, face.normal, y, static_cast<std::int32_t>(i)};
    }
    return highest > -1e300;
}

/// A polygon that touches others: the closest point if it belongs to the union, else another outline has a closer one.
bool closestOnJoinedPolygon(const OutlineShape& shape, const Vec2& p, OutlineHit& hit) {
    double nearest = 1e300;
    std::size_t vertex = shape.faces.size(), nearestFace = vertex;
    bool inside = true;
    for (std::size_t i = 0; i < shape.faces.size(); ++i) {
        const Face& face = shape.faces[i];
        const Vec2 w = p - face.start;
        const double x = w.dot(face.along), y = w.dot(face.normal), slack = kJointSlack * face.length;
        inside = inside && y <= 0.0;
        if (x >= -slack && x <= face.length + slack) {
            if (y > 0.0 && y < nearest) {
                nearest = y;
                nearestFace = i;
            }
        } else if (x < 0.0 && w.norm() < nearest) { // every corner is the start of one face
            nearest = w.norm();
            vertex = i;
            nearestFace = shape.faces.size();
        }
    }
    if (inside)
        return deepestInJoined(shape, p, hit);
    if (nearestFace < shape.faces.size()) {
        const Face& face = shape.faces[nearestFace];
        hit = {p - nearest * face.normal, face.normal, nearest, static_cast<std::int32_t>(nearestFace)};
        return !hiddenAt(shape, nearestFace, (p - face.start).dot(face.along));
    }
    return vertex < shape.faces.size() && vertexAnswers(shape, vertex, p - shape.faces[vertex].start) &&
           round(shape.faces[vertex].start, p, shape.faces[vertex].normal, hit);
}

} // namespace

void prepare(const Outline& outline, OutlineShape& shape) {
    check(outline);
    const OutlinePoints& points = outline.points;
    shape.kind = outline.kind;
    shape.faces.clear();
    shape.corners.clear();
    shape.centre = points[0];
    shape.radius = outline.radius;
    shape.seams = outline.seams;
    shape.joinedStart = shape.joinedEnd = shape.convexStart = shape.convexEnd = false;
    if (outline.kind == OutlineKind::Segment) {
        const Face face = makeFace(outline, points[0], points[1], 1.0);
        shape.faces.push_back(face);
        shape.faces.push_back(makeFace(outline, points[0], points[1], -1.0));
        addCorner(outline, {points[0], -face.along, -face.along, 0, false}, shape);
        addCorner(outline, {points[1], face.along, face.along, 1, false}, shape);
    } else if (outline.kind == OutlineKind::OneSided) {
        prepareOneSided(outline, shape);
    } else if (outline.kind == OutlineKind::Polygon) {
        const std::size_t n = points.size();
        for (std::size_t i = 0; i < n; ++i)
            shape.faces.push_back(makeFace(outline, points[i], points[(i + 1) % n], -1.0));
        for (std::size_t i = 0; i < n; ++i) {
            const Face& last = shape.faces[(i + n - 1) % n];
            if (rod::cross(last.along, shape.faces[i].along) < -kCornerTurn)
                fail(outline, "a polygon must be convex and counter-clockwise");
            addCorner(outline, {points[i], -shape.faces[i].along, last.along, static_cast<std::int32_t>(i), true},
                      shape);
        }
    }
    SC_ASSERT(shape.faces.empty() == (outline.kind == OutlineKind::Circle), "all outlines but discs have faces");
}

namespace {

bool closestOn(const OutlineShape& shape, const Vec2& p, double depth, const Vec2& inward, OutlineHit& hit) {
    switch (shape.kind) {
    case OutlineKind::Segment:
        return closestOnSegment(shape, p, inward, hit);
    case OutlineKind::OneSided:
        return closestOnOneSided(shape, p, depth, hit);
    case OutlineKind::Polygon:
        return shape.seams.empty() ? closestOnPolygon(shape, p, hit) : closestOnJoinedPolygon(shape, p, hit);
    case OutlineKind::Circle:
        return round(shape.centre, p, inward, hit);
    }
    return false;
}

} // namespace

bool closestOnOutline(const OutlineShape& shape, const Vec2& p, double depth, const Vec2& inward, OutlineHit& hit) {
    const bool found = closestOn(shape, p, depth, inward, hit);
    SC_ASSERT_EXPENSIVE(!found || invariants::isUnit(hit.normal), "a normal has length 1");
    SC_ASSERT_EXPENSIVE(!found || hit.face < static_cast<std::int32_t>(shape.faces.size()),
                        "a face of the outline, or a corner");
    return found;
}

double distanceBound(const OutlineShape& shape, const Vec2& p) {
    if (shape.kind == OutlineKind::Circle)
        return (p - shape.centre).norm() - shape.radius;
    if (shape.kind == OutlineKind::Polygon) {
        double highest = -1e300;
        for (const Face& face : shape.faces)
            highest = std::max(highest, (p - face.start).dot(face.normal));
        return highest - shape.radius;
    }
    const Face& face = shape.faces[0];
    const Vec2 w = p - face.start;
    const double x = w.dot(face.along);
    const Vec2 q(x - std::min(std::max(x, 0.0), face.length), w.dot(face.normal));
    return q.norm() - shape.radius;
}

bool cornerHit(const Corner& corner, const Foot& foot, double depth, Vec2& normal, double& distance) {
    // foot.distance is the corner's signed distance from the rod: the corner lies along +normal of the foot.
    const Vec2 out = foot.distance >= 0.0 ? Vec2(-foot.normal) : foot.normal; // from the corner to the rod
    distance = std::abs(foot.distance);
    normal = out;
    if (out.dot(corner.c1) >= -kConeSlack && out.dot(corner.c2) >= -kConeSlack)
        return true;
    // The rod's centre line has passed over the corner into the solid.
    if (!corner.solid || distance > depth)
        return false;
    if (out.dot(corner.c1) > kConeSlack || out.dot(corner.c2) > kConeSlack)
        return false;
    normal = -out;
    distance = -distance;
    return true;
}

} // namespace supercircle::contact
