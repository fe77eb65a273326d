#pragma once
// Judges of passages that know poses alone: no contacts, no events, no part of the crossing check.
//
// A shell that closes an opening parts the plane. The region behind it is bounded by its centre line and a polyline
// through the solid walls of the opening, so that a body gets into the region through the shell only. Bodies travel 2
// units or pi/2 a step at most, and the region is larger than that.

#include "plugin/api/include/supercircle/shells.hpp"

#include <algorithm>
#include <box2d/box2d.h>
#include <cmath>
#include <limits>
#include <vector>

namespace supercircle::bridge_test {

/// Points of a centre line of elements of equal length, `parts` an element.
inline std::vector<Point> centreLine(const ShellPose& pose, double length, int parts = 12) {
    std::vector<Point> line{pose.start};
    double angle = pose.angle;
    const double step = length / (static_cast<double>(pose.curvature.size()) * parts);
    for (const double curvature : pose.curvature)
        for (int i = 0; i < parts; ++i) {
            const double half = 0.5 * step * curvature; // chord of an arc
            const double chord = std::abs(half) < 1e-9 ? step : step * std::sin(half) / half;
            line.push_back(
                {line.back().x + chord * std::cos(angle + half), line.back().y + chord * std::sin(angle + half)});
            angle += 2.0 * half;
        }
    return line;
}

/// Points of the outlines of a body, m: rims of circles, and faces of polygons.
inline std::vector<Point> outlinePoints(const b2Body& body, double unitsPerMetre, double spacing = 0.02) {
    std::vector<Point> points;
    const auto add = [&](const b2Vec2& local) {
        const b2Vec2 p = body.GetWorldPoint(local);
        points.push_back({static_cast<double>(p.x) / unitsPerMetre, static_cast<double>(p.y) / unitsPerMetre});
    };
    for (const b2Fixture* f = body.GetFixtureList(); f != nullptr; f = f->GetNext())
        if (f->GetType() == b2Shape::e_circle) {
            const auto& circle = static_cast<const b2CircleShape&>(*f->GetShape());
            for (int i = 0; i < 64; ++i) {
                const auto a = static_cast<float>(2.0 * M_PI * i / 64);
                add(circle.m_p + circle.m_radius * b2Vec2(std::cos(a), std::sin(a)));
            }
            add(circle.m_p);
        } else if (f->GetType() == b2Shape::e_polygon) {
            const auto& polygon = static_cast<const b2PolygonShape&>(*f->GetShape());
            for (int i = 0; i < polygon.m_count; ++i) {
                const b2Vec2 from = polygon.m_vertices[i];
                const b2Vec2 side = polygon.m_vertices[(i + 1) % polygon.m_count] - from;
                const int n = 1 + static_cast<int>(static_cast<double>(side.Length()) / (spacing * unitsPerMetre));
                for (int k = 0; k < n; ++k)
                    add(from + static_cast<float>(k) / static_cast<float>(n) * side);
            }
        }
    return points;
}

/// Distance of a point from a polyline, m.
inline double distanceTo(const std::vector<Point>& line, const Point& p) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const Point a = line[i], side{line[i + 1].x - a.x, line[i + 1].y - a.y};
        const double square = side.x * side.x + side.y * side.y;
        const double t =
            square > 0.0 ? std::clamp(((p.x - a.x) * side.x + (p.y - a.y) * side.y) / square, 0.0, 1.0) : 0.0;
        least = std::min(least, std::hypot(a.x + t * side.x - p.x, a.y + t * side.y - p.y));
    }
    return least;
}

/// Even-odd rule.
inline bool isInside(const std::vector<Point>& polygon, const Point& p) {
    bool inside = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Point &a = polygon[i], &b = polygon[j];
        if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x))
            inside = !inside;
    }
    return inside;
}

/// How deep a body stands behind a shell across a shaft of x = -halfWidth .. halfWidth below y = 0, with an end at each
/// edge of the mouth, first the left one or the right one. 0: no point of its outline is behind the centre line, m.
inline double depthBehind(const std::vector<Point>& line, double halfWidth, const std::vector<Point>& outline) {
    constexpr double kFar = 1000.0; // m, farther than bodies come
    const bool leftFirst = line.front().x < line.back().x;
    const double last = leftFirst ? kFar : -kFar;
    std::vector<Point> region = line; // closed through the walls
    region.insert(region.end(), {{last, line.back().y}, {last, -kFar}, {-last, -kFar}, {-last, line.front().y}});
    double depth = 0.0;
    for (const Point& p : outline)
        if (std::abs(p.x) < halfWidth && isInside(region, p)) // the walls are the host's matter
            depth = std::max(depth, distanceTo(line, p));
    return depth;
}

/// Whether a point came through the top face of a box between two frames, in the box's frame: y = 0 on the face.
inline bool cameThrough(const Point& before, const Point& after, double halfWidth, double tolerance) {
    if (before.y < -tolerance || after.y >= -tolerance)
        return false;
    const double share = before.y / std::max(before.y - after.y, 1e-300);
    return std::abs(before.x + std::clamp(share, 0.0, 1.0) * (after.x - before.x)) < halfWidth;
}

} // namespace supercircle::bridge_test
