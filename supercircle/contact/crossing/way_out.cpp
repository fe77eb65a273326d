#include "supercircle/contact/way_out.h"

#include "supercircle/contact/crossing.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace supercircle::contact {

namespace {

/// Points for each element at which a rod is looked at. Half as many would miss walls thinner than an eighth of an
/// element, which the crossing itself then stands for; twice as many double the cost of a frame with overlaps.
constexpr int kSamples = 8;

struct CurvePoint {
    double s = 0.0; ///< arc length on the rod, m
    Vec2 p = Vec2::Zero();
    Vec2 tangent = Vec2::UnitX();
};

CurvePoint at(const RodCurve& c, double s) {
    std::size_t e = 0;
    while (e + 1 < c.arcs.size() && s >= c.nodeS[e + 1])
        ++e;
    const double x = std::clamp(s - c.nodeS[e], 0.0, c.arcs[e].length);
    return {c.nodeS[e] + x, c.arcs[e].pointAt(x), c.arcs[e].tangentAt(x)};
}

std::vector<CurvePoint> samplesOf(const RodCurve& c) {
    std::vector<CurvePoint> out;
    for (std::size_t e = 0; e < c.arcs.size(); ++e)
        for (int k = 0; k < kSamples; ++k) {
            const double x = c.arcs[e].length * k / kSamples;
            out.push_back({c.nodeS[e] + x, c.arcs[e].pointAt(x), c.arcs[e].tangentAt(x)});
        }
    const Arc& last = c.arcs.back();
    out.push_back({c.nodeS.back(), last.pointAt(last.length), last.tangentAt(last.length)});
    return out;
}

/// Arc length of the point of a rod that is closest to p, of the elements from `first` on.
double closestS(const RodCurve& c, const Vec2& p, std::size_t first) {
    double best = std::numeric_limits<double>::infinity(), s = c.nodeS[first];
    for (std::size_t e = first; e < c.arcs.size(); ++e) {
        double low = 0.0, high = c.arcs[e].length;
        // Along an arc of less than half a circle the component of the way to p along the tangent falls.
        const auto ahead = [&](double x) { return (p - c.arcs[e].pointAt(x)).dot(c.arcs[e].tangentAt(x)); };
        for (int i = 0; i < 50 && high - low > 1e-12 * c.arcs[e].length; ++i) {
            const double middle = 0.5 * (low + high);
            (ahead(middle) > 0.0 ? low : high) = middle;
        }
        const double d = (p - c.arcs[e].pointAt(low)).norm();
        if (d < best) {
            best = d;
            s = c.nodeS[e] + low;
        }
    }
    return s;
}

struct Meeting {
    CurvePoint a, b;
};

double lengthOf(const RodCurve& c) {
    return c.nodeS.back() - c.nodeS.front();
}

using Ways = std::vector<WayOut>;

void offer(Ways& ways, WayKind kind, double distance, std::vector<Push> pushes, bool contactLeads = false) {
    SC_ASSERT(!(distance < 0.0), "a way has a length");
    if (!pushes.empty())
        ways.push_back({kind, distance, std::move(pushes), contactLeads});
}

/// Along the line of A off one of its ends: every place where it crosses moves along itself.
void offerEnds(const RodCurve& a, const std::vector<Meeting>& meetings, double sign, Ways& ways) {
    const auto& line = [sign](const Meeting& m) -> const CurvePoint& { return sign > 0.0 ? m.a : m.b; };
    if (a.closed)
        return;
    double low = std::numeric_limits<double>::infinity(), high = 0.0;
    std::vector<Push> offStart, offEnd;
    for (const Meeting& m : meetings) {
        low = std::min(low, line(m).s - a.nodeS.front());
        high = std::max(high, line(m).s - a.nodeS.front());
        offStart.push_back({m.a.s, m.b.s, sign * line(m).tangent});
        offEnd.push_back({m.a.s, m.b.s, -sign * line(m).tangent});
    }
    offer(ways, sign > 0.0 ? WayKind::StartOfA : WayKind::StartOfB, high, std::move(offStart));
    offer(ways, sign > 0.0 ? WayKind::EndOfA : WayKind::EndOfB, lengthOf(a) - low, std::move(offEnd));
}

/// The middle of the shorter part of a rod between two places.
double between(const RodCurve& c, double s1, double s2) {
    const double middle = 0.5 * (s1 + s2), L = lengthOf(c);
    if (!c.closed || std::abs(s2 - s1) <= 0.5 * L)
        return middle;
    return middle + 0.5 * L < c.nodeS.back() ? middle + 0.5 * L : middle - 0.5 * L;
}

/// Back over each other, where lines that cross twice enclose a lens.
void offerLenses(const RodCurve& a, const RodCurve& b, std::vector<Meeting> meetings, Ways& ways) {
    if (meetings.size() % 2 != 0)
        return;
    std::sort(meetings.begin(), meetings.end(), [](const Meeting& x, const Meeting& y) { return x.a.s < y.a.s; });
    double distance = 0.0;
    std::vector<Push> pushes;
    for (std::size_t i = 0; i + 1 < meetings.size(); i += 2) {
        const CurvePoint onA = at(a, between(a, meetings[i].a.s, meetings[i + 1].a.s));
        const CurvePoint onB = at(b, between(b, meetings[i].b.s, meetings[i + 1].b.s));
        const Vec2 way = onB.p - onA.p;
        if (!(way.norm() > 1e-9 * lengthOf(a)))
            return;
        distance = std::max(distance, way.norm());
        pushes.push_back({onA.s, onB.s, way.normalized()});
    }
    offer(ways, WayKind::Back, distance, std::move(pushes));
}

bool spanHidden(const Outline& o, std::size_t face, double length) {
    double hidden = 0.0;
    for (const HiddenSpan& h : o.seams.hidden)
        if (h.face == static_cast<std::int32_t>(face))
            hidden += std::max(0.0, std::min(h.to, length) - std::max(h.from, 0.0));
    return hidden > 0.5 * length;
}

/// A stretch of a rod inside a solid.
struct Run {
    std::size_t first = 0, last = 0; ///< samples
};

std::vector<Run> runsOf(const std::vector<CurvePoint>& samples, const std::function<bool(const Vec2&)>& in) {
    std::vector<Run> runs;
    bool open = false;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const bool now = in(samples[i].p);
        if (now && !open)
            runs.push_back({i, i});
        else if (now)
            runs.back().last = i;
        open = now;
    }
    return runs;
}

std::vector<Meeting> middles(const std::vector<CurvePoint>& samples, const std::vector<Run>& runs) {
    std::vector<Meeting> out;
    for (const Run& r : runs)
        out.push_back({samples[(r.first + r.last) / 2], {}});
    return out;
}

/// Off the ends of the rod, the whole of a stretch counted.
void offerEnds(const RodCurve& a, const std::vector<CurvePoint>& samples, const std::vector<Run>& runs, Ways& ways) {
    if (a.closed || runs.empty())
        return;
    std::vector<Push> offStart, offEnd;
    for (const Meeting& m : middles(samples, runs)) {
        offStart.push_back({m.a.s, 0.0, m.a.tangent});
        offEnd.push_back({m.a.s, 0.0, -m.a.tangent});
    }
    offer(ways, WayKind::StartOfA, samples[runs.back().last].s - a.nodeS.front(), std::move(offStart));
    offer(ways, WayKind::EndOfA, a.nodeS.back() - samples[runs.front().first].s, std::move(offEnd));
}

template <class Depth>
std::vector<Push> deepestOf(const std::vector<CurvePoint>& samples, const std::vector<Run>& runs, Depth depth,
                            const Vec2& direction) {
    std::vector<Push> out;
    for (const Run& r : runs) {
        std::size_t deepest = r.first;
        for (std::size_t i = r.first; i <= r.last; ++i)
            if (depth(samples[i].p) > depth(samples[deepest].p))
                deepest = i;
        out.push_back({samples[deepest].s, 0.0, direction});
    }
    return out;
}

/// Out of a convex polygon: through each of its faces until all that lies in its shadow is out.
void offerFaces(const Outline& o, const std::vector<CurvePoint>& samples, const std::vector<Run>& runs, Ways& ways) {
    const std::size_t n = o.points.size();
    std::vector<Vec2> normals(n);
    for (std::size_t i = 0; i < n; ++i)
        normals[i] = -rod::perp(Vec2((o.points[(i + 1) % n] - o.points[i]).normalized()));
    const auto depthBelow = [&](const Vec2& p, std::size_t f) { return (o.points[f] - p).dot(normals[f]); };
    const auto nearestFace = [&](const Vec2& p) {
        std::size_t nearest = 0;
        for (std::size_t f = 1; f < n; ++f)
            if (depthBelow(p, f) < depthBelow(p, nearest))
                nearest = f;
        return nearest;
    };
    for (std::size_t f = 0; f < n; ++f) {
        const Vec2 side = rod::perp(normals[f]);
        if (spanHidden(o, f, (o.points[(f + 1) % n] - o.points[f]).norm()))
            continue;
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const Vec2& p : o.points) {
            low = std::min(low, p.dot(side));
            high = std::max(high, p.dot(side));
        }
        double distance = 0.0;
        for (const CurvePoint& c : samples)
            if (c.p.dot(side) > low && c.p.dot(side) < high)
                distance = std::max(distance, depthBelow(c.p, f));
        // Contacts push towards the nearest face. Where the rod cuts off a corner, the corner pushes against them.
        bool contactLeads = true;
        for (const Run& r : runs) {
            for (std::size_t i = r.first; i <= r.last; ++i)
                contactLeads = contactLeads && nearestFace(samples[i].p) == f;
            for (const std::size_t i : {r.first - 1, r.last + 1}) // wraps to one that is not there
                contactLeads = contactLeads && !(i < samples.size() && depthBelow(samples[i].p, f) > 0.0);
        }
        // Ways are told apart by 32 numbers: of a polygon of many faces some share one.
        const std::size_t number = static_cast<std::size_t>(WayKind::Face) + f % 24;
        offer(ways, static_cast<WayKind>(number), distance,
              deepestOf(
                  samples, runs, [&](const Vec2& p) { return depthBelow(p, f); }, normals[f]),
              contactLeads);
    }
}

void offerDisc(const Outline& o, const std::vector<CurvePoint>& samples, const std::vector<Run>& runs, Ways& ways) {
    const Vec2& centre = o.points[0];
    const auto depth = [&](const Vec2& p) { return o.radius - (p - centre).norm(); };
    const CurvePoint* deepest = &samples[runs.front().first];
    for (const Run& r : runs)
        for (std::size_t i = r.first; i <= r.last; ++i)
            if (depth(samples[i].p) > depth(deepest->p))
                deepest = &samples[i];
    Vec2 out = deepest->p - centre;
    out = out.norm() > 1e-9 * o.radius ? Vec2(out.normalized()) : rod::perp(deepest->tangent);
    bool contactLeads = true;
    for (const Run& r : runs)
        for (std::size_t i = r.first; i <= r.last; ++i)
            contactLeads = contactLeads && (samples[i].p - centre).dot(out) > 0.5 * (samples[i].p - centre).norm();
    offer(ways, WayKind::Normal, std::max(0.0, depth(deepest->p)), deepestOf(samples, runs, depth, out), contactLeads);
}

bool insideSolid(const Vec2& p, const Outline& o) {
    if (o.kind == OutlineKind::Circle)
        return (p - o.points[0]).norm() < o.radius;
    for (std::size_t i = 0; i < o.points.size(); ++i)
        if (!(rod::cross(o.points[(i + 1) % o.points.size()] - o.points[i], p - o.points[i]) > 0.0))
            return false;
    return true;
}

Ways outOfSolid(const RodCurve& a, const std::vector<CurvePoint>& samples, const std::vector<Crossing>& crossings,
                const Outline& o) {
    Ways ways;
    std::vector<Run> runs = runsOf(samples, [&](const Vec2& p) { return insideSolid(p, o); });
    std::vector<CurvePoint> points = samples;
    if (runs.empty()) { // thinner than the samples are apart
        points = {at(a, crossings.front().sA)};
        runs = {{0, 0}};
    }
    if (o.kind == OutlineKind::Circle)
        offerDisc(o, points, runs, ways);
    else
        offerFaces(o, points, runs, ways);
    offerEnds(a, points, runs, ways);
    return ways;
}

/// In front of a one-sided edge: by its contacts where they reach, else along its normal.
Ways beforeEdge(const RodCurve& a, const std::vector<CurvePoint>& samples, const std::vector<Crossing>& crossings,
                const Outline& o) {
    Ways ways;
    const Vec2 along = (o.points[1] - o.points[0]).normalized(), normal = rod::perp(along);
    const double length = (o.points[1] - o.points[0]).norm(), reach = 2.0 * a.halfThickness;
    const auto depth = [&](const Vec2& p) { return (o.points[0] - p).dot(normal); };
    std::vector<Run> runs = runsOf(samples, [&](const Vec2& p) {
        const double x = (p - o.points[0]).dot(along);
        return depth(p) > 0.0 && x >= 0.0 && x <= length;
    });
    std::erase_if(runs, [&](const Run& r) { // what lies far behind has nothing to do with this edge
        for (std::size_t i = r.first; i <= r.last; ++i)
            if (depth(samples[i].p) < reach)
                return false;
        return true;
    });
    std::vector<Push> pushes = deepestOf(samples, runs, depth, normal);
    if (pushes.empty())
        pushes.push_back({crossings.front().sA, 0.0, normal});
    double distance = 0.0;
    for (const Push& p : pushes)
        distance = std::max(distance, depth(at(a, p.sA).p));
    offer(ways, WayKind::Normal, distance, std::move(pushes), distance < reach);
    return ways;
}

/// Off the ends of the rod or of the segment, or back to one side of it.
Ways offSegment(const RodCurve& a, const std::vector<CurvePoint>& samples, const std::vector<Crossing>& crossings,
                const Outline& o) {
    Ways ways;
    const Vec2 along = (o.points[1] - o.points[0]).normalized(), normal = rod::perp(along);
    const double length = (o.points[1] - o.points[0]).norm();
    std::vector<Meeting> meetings;
    std::vector<Push> toStart, toEnd;
    double low = length, high = 0.0;
    for (const Crossing& c : crossings) {
        meetings.push_back({at(a, c.sA), {}});
        const double x = (c.where - o.points[0]).dot(along);
        low = std::min(low, x);
        high = std::max(high, x);
        toStart.push_back({c.sA, 0.0, -along});
        toEnd.push_back({c.sA, 0.0, along});
    }
    offerEnds(a, meetings, 1.0, ways);
    const auto continues = [&](std::size_t vertex) {
        return !o.seams.vertices.empty() && o.seams.vertices[vertex].role == VertexRole::Hidden;
    };
    if (!continues(0))
        offer(ways, WayKind::StartOfB, high, std::move(toStart));
    if (!continues(1))
        offer(ways, WayKind::EndOfB, length - low, std::move(toEnd));
    if (meetings.size() % 2 == 0) { // its ends are on one side: the parts between come back
        const double side = (samples.front().p - o.points[0]).dot(normal) > 0.0 ? 1.0 : -1.0;
        const auto depth = [&](const Vec2& p) { return -side * (p - o.points[0]).dot(normal); };
        const std::vector<Run> runs = runsOf(samples, [&](const Vec2& p) {
            const double x = (p - o.points[0]).dot(along);
            return depth(p) > 0.0 && x >= 0.0 && x <= length;
        });
        std::vector<Push> pushes = deepestOf(samples, runs, depth, side * normal);
        double distance = 0.0;
        for (const Push& p : pushes)
            distance = std::max(distance, depth(at(a, p.sA).p));
        offer(ways, WayKind::Back, distance, std::move(pushes));
    }
    return ways;
}

} // namespace

std::vector<WayOut> waysOut(const RodCurve& a, const RodCurve& b) {
    const bool self = &a == &b;
    std::vector<Crossing> crossings;
    findCrossings(self ? std::vector<RodCurve>{a} : std::vector<RodCurve>{a, b}, {}, crossings);
    std::vector<Meeting> meetings;
    for (const Crossing& c : crossings) {
        if (c.rodA != 0 || c.rodB != (self ? 0 : 1))
            continue;
        std::size_t next = 0; // of the elements of a rod that may cross itself, the later one is side B
        while (self && next + 1 < a.arcs.size() && a.nodeS[next] <= c.sA)
            ++next;
        if (!self || next + 1 < a.arcs.size())
            meetings.push_back({at(a, c.sA), at(b, closestS(b, c.where, self ? next + 1 : 0))});
    }
    Ways ways;
    if (meetings.empty())
        return ways;
    offerEnds(a, meetings, 1.0, ways);
    offerEnds(b, meetings, -1.0, ways);
    if (!self)
        offerLenses(a, b, meetings, ways);
    if (ways.empty()) // two rings that touch in one point
        for (const Meeting& m : meetings)
            offer(ways, WayKind::Normal, 0.0, {{m.a.s, m.b.s, rod::perp(m.b.tangent)}});
    return ways;
}

std::vector<WayOut> waysOut(const RodCurve& a, const Outline& b) {
    std::vector<Crossing> crossings;
    findCrossings({a}, {b}, crossings);
    std::erase_if(crossings, [](const Crossing& c) { return c.outline < 0; });
    if (crossings.empty())
        return {};
    const std::vector<CurvePoint> samples = samplesOf(a);
    switch (b.kind) {
    case OutlineKind::Segment:
        return offSegment(a, samples, crossings, b);
    case OutlineKind::OneSided:
        return beforeEdge(a, samples, crossings, b);
    case OutlineKind::Circle:
    case OutlineKind::Polygon:
        break;
    }
    return outOfSolid(a, samples, crossings, b);
}

} // namespace supercircle::contact
