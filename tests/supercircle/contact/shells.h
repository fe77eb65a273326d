#pragma once
// Rods for the tests of contact detection: shells of arcs, their dense sampling, and a pile of them.

#include "supercircle/contact/detection.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace contact_test {

using namespace supercircle::contact;

constexpr double kPi = 3.141592653589793;
constexpr double kHalf = 0.25e-3; ///< half thickness of the paper's shell, m
constexpr double kRadius = 19.2e-3;

/// A rod from the frame of its first point.
inline RodCurve makeCurve(std::uint32_t key, const Vec2& start, double angle, const std::vector<double>& curvatures,
                          double elementLength, double half = kHalf) {
    RodCurve curve;
    curve.key = key;
    curve.halfThickness = half;
    curve.nodeS.push_back(0.0);
    Vec2 p = start;
    double theta = angle;
    for (const double k : curvatures) {
        const Arc arc{p, theta, k, elementLength};
        curve.arcs.push_back(arc);
        p = arc.pointAt(elementLength);
        theta = arc.angleAt(elementLength);
        curve.nodeS.push_back(curve.nodeS.back() + elementLength);
    }
    curve.midS = 0.5 * curve.nodeS.back();
    return curve;
}

/// A shell of uniform curvature around a centre, its middle in direction `middle`.
inline RodCurve makeShell(std::uint32_t key, const Vec2& centre, double radius, double opening, double middle,
                          int elements = 15, double half = kHalf) {
    const double first = middle - 0.5 * opening;
    const Vec2 start = centre + radius * Vec2(std::cos(first), std::sin(first));
    return makeCurve(key, start, first + 0.5 * kPi,
                     std::vector<double>(static_cast<std::size_t>(elements), 1.0 / radius), radius * opening / elements,
                     half);
}

/// A shell with uneven curvatures.
inline RodCurve randomShell(std::uint32_t key, std::mt19937& rng, double spread, int elements = 15) {
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    const double phi = 2.0 * kPi * (0.75 + 0.2 * u(rng));
    std::vector<double> k;
    for (int i = 0; i < elements; ++i)
        k.push_back((1.0 + 0.5 * u(rng)) / kRadius);
    return makeCurve(key, spread * Vec2(u(rng), u(rng)), kPi * u(rng), k, kRadius * phi / elements);
}

inline void move(RodCurve& curve, const Vec2& shift, double turn = 0.0) {
    const double c = std::cos(turn);
    const double s = std::sin(turn);
    for (Arc& arc : curve.arcs) {
        arc.start = Vec2(c * arc.start.x() - s * arc.start.y(), s * arc.start.x() + c * arc.start.y()) + shift;
        arc.angle += turn;
    }
}

struct Dense {
    std::vector<Vec2> p;
    std::vector<double> s;
};

inline Dense sampleDensely(const RodCurve& curve, int n) {
    Dense dense;
    const double length = curve.nodeS.back();
    std::size_t e = 0;
    for (int i = 0; i <= n; ++i) {
        const double s = length * i / n;
        while (e + 1 < curve.arcs.size() && curve.nodeS[e + 1] < s)
            ++e;
        dense.p.push_back(curve.arcs[e].pointAt(s - curve.nodeS[e]));
        dense.s.push_back(s);
    }
    return dense;
}

inline double pointSegment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 e = b - a;
    const double u = std::min(std::max((p - a).dot(e) / e.squaredNorm(), 0.0), 1.0);
    return (p - a - u * e).norm();
}

inline double toPolyline(const Vec2& p, const Dense& dense) {
    double best = 1e300;
    for (std::size_t j = 0; j + 1 < dense.p.size(); ++j) {
        // Cheap bound first: neighbours are one spacing apart.
        if ((p - dense.p[j]).norm() > best + (dense.p[j + 1] - dense.p[j]).norm())
            continue;
        best = std::min(best, pointSegment(p, dense.p[j], dense.p[j + 1]));
    }
    return best;
}

/// Smallest distance of two densely sampled curves, both ways.
inline double denseDistance(const Dense& a, const Dense& b) {
    double best = 1e300;
    for (const Vec2& p : a.p)
        best = std::min(best, toPolyline(p, b));
    for (const Vec2& p : b.p)
        best = std::min(best, toPolyline(p, a));
    return best;
}

/// Columns of nests: `nest` shells hang in each other, a little more than a thickness apart, the nests touch outside.
inline std::vector<RodCurve> makePile(int count, int nest = 1000000) {
    std::vector<RodCurve> curves;
    const int columns = std::max(4, static_cast<int>(std::sqrt(static_cast<double>(count) / std::min(nest, 4))));
    const double pitch = 2.0 * kRadius + 2.1 * kHalf;
    for (int i = 0; i < count; ++i) {
        const int row = i / columns;
        const int column = i % columns;
        const double radius = kRadius * (1.0 + 0.01 * ((i * 7) % 5 - 2));
        const Vec2 centre(column * pitch, (row / nest) * pitch + (row % nest) * 2.04 * kHalf + 0.001 * (column % 3));
        curves.push_back(makeShell(static_cast<std::uint32_t>(i), centre, radius, 4.712, 0.5 * kPi));
    }
    return curves;
}

inline bool identical(const Candidate& a, const Candidate& b) {
    return a.a.rod == b.a.rod && a.a.element == b.a.element && a.a.s == b.a.s && a.b.rod == b.b.rod &&
           a.b.element == b.b.element && a.b.s == b.b.s && a.outline == b.outline && a.normal == b.normal &&
           a.pointA == b.pointA && a.pointB == b.pointB && a.gap == b.gap && a.id == b.id;
}

inline bool identical(const std::vector<Candidate>& a, const std::vector<Candidate>& b) {
    if (a.size() != b.size())
        return false;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (!identical(a[i], b[i]))
            return false;
    return true;
}

} // namespace contact_test
