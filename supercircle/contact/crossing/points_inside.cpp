#include "supercircle/contact/crossing/points_inside.h"

#include "supercircle/contact/one_sided.h"

namespace supercircle::contact::crossing_check {

namespace {

bool inside(const Vec2& p, const Outline& o) {
    if (o.kind == OutlineKind::Circle)
        return (p - o.points[0]).norm() < o.radius;
    for (std::size_t i = 0; i < o.points.size(); ++i) {
        const Vec2& a = o.points[i];
        if (!(rod::cross(o.points[(i + 1) % o.points.size()] - a, p - a) > 0.0))
            return false;
    }
    return true;
}

/// A point as seen from an edge: along it from its start, and to its left, m.
Vec2 seenFrom(const Outline& edge, const Vec2& p) {
    const Vec2 along = (edge.points[1] - edge.points[0]).normalized(), q = p - edge.points[0];
    return {along.dot(q), rod::cross(along, q)};
}

bool isBeside(const Outline& edge, double along) {
    return along >= 0.0 && along <= (edge.points[1] - edge.points[0]).norm();
}

bool isBehind(const Vec2& p, const Outline& edge, double depth) {
    const Vec2 seen = seenFrom(edge, p);
    return seen.y() > -depth && isBeside(edge, seen.x()) && !isInFront(p, edge);
}

/// Whether a point that ends behind an edge came through it from the front, not round one of its ends.
bool cameThrough(const Vec2& from, const Outline& before, const Vec2& to, const Outline& after) {
    const Vec2 a = seenFrom(before, from), b = seenFrom(after, to);
    return a.y() >= 0.0 && b.y() < 0.0 && isBeside(before, a.x() + a.y() / (a.y() - b.y()) * (b.x() - a.x()));
}

AlignedBox boxOf(const Outline& o, double pad) {
    AlignedBox box;
    for (const Vec2& p : o.points)
        box.include(p);
    const Vec2 margin = Vec2::Constant(pad + (o.kind == OutlineKind::Circle ? o.radius : 0.0));
    box.lower -= margin;
    box.upper += margin;
    return box;
}

} // namespace

void findInside(const std::vector<RodCurve>& curves, const SweptMotion& motion, const std::vector<Outline>& before,
                const std::vector<Outline>& outlines, const std::vector<char>& outlineMoves, bool skipStill,
                std::vector<Crossing>& out) {
    for (std::size_t o = 0; o < outlines.size(); ++o) {
        const Outline& outline = outlines[o];
        if (outline.kind == OutlineKind::Segment)
            continue;
        const bool atRest = skipStill && outlineMoves[o] == 0;
        const AlignedBox narrow = boxOf(outline, 0.0);
        for (std::size_t r = 0; r < motion.rods.size(); ++r) {
            const RodCurve& c = curves[r];
            const RodMotion& rod = motion.rods[r];
            const double depth = 2.0 * c.halfThickness;
            AlignedBox box = narrow;
            box.enlarge(depth);
            if (rod.count == 0 || (atRest && rod.still) || !mayTouch(c, outline) || !rod.box.overlaps(box))
                continue;
            const auto report = [&](double s, const Vec2& p, std::size_t e, double at) {
                const bool hit = outline.kind != OutlineKind::OneSided
                                     ? inside(p, outline)
                                     : isBehind(p, outline, depth) &&
                                           (!skipStill || cameThrough((*motion.before)[r].arcs[e].pointAt(at),
                                                                      before[o], p, outline));
                if (hit)
                    out.push_back({static_cast<std::int32_t>(r), -1, static_cast<std::int32_t>(o), s, p});
                return hit;
            };
            bool found = false;
            for (std::size_t e = 0; e < c.arcs.size() && !found; ++e) {
                const std::size_t i = rod.first + e;
                const ElementBoxes& all = motion.boxes;
                if (all.lowX[i] > box.upper.x() || all.highX[i] < box.lower.x() || all.lowY[i] > box.upper.y() ||
                    all.highY[i] < box.lower.y())
                    continue;
                const Arc& arc = c.arcs[e];
                const double s = e < c.nodeS.size() ? c.nodeS[e] : 0.0;
                const double half = 0.5 * arc.length;
                found = report(s, arc.start, e, 0.0) || report(s + half, arc.pointAt(half), e, half);
                if (!found && e + 1 == c.arcs.size())
                    found = report(s + arc.length, arc.pointAt(arc.length), e, arc.length);
            }
        }
    }
}

} // namespace supercircle::contact::crossing_check
