// Arcs as polylines: a chord over the angle 2 a deviates from its arc of radius r by r (1 - cos a).

#include "plugin/api/shells_impl.h"
#include "supercircle/step/contact_memory.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace supercircle {

using rod::Vec2;

namespace {

constexpr int kMostChords = 4096; ///< a whole circle to 3e-7 of its radius

/// Chords that keep an arc of this radius and angle within the tolerance.
int chords(double radius, double angle, double tolerance) {
    if (!(angle > 0.0) || !std::isfinite(radius))
        return 1;
    const double half = math::acos(std::clamp(1.0 - tolerance / radius, 0.0, 1.0));
    return static_cast<int>(std::clamp(std::ceil(0.5 * angle / std::max(half, 1e-9)), 1.0, 1.0 * kMostChords));
}

/// Adds the points of the curve at distance d to the left of an arc, its start left out.
void addArc(const rod::Arc& arc, double d, double tolerance, std::vector<Point>& out) {
    const double angle = std::abs(arc.curvature) * arc.length;
    const double radius = angle > 0.0 ? std::abs(1.0 / arc.curvature - d) : INFINITY;
    const int n = chords(radius, angle, tolerance);
    for (int i = 1; i <= n; ++i) {
        const double s = arc.length * i / n;
        out.push_back(point(arc.pointAt(s) + d * rod::perp(arc.tangentAt(s))));
    }
}

/// A half circle from the left side of the tip round to the right one (or the other way at the first tip).
void addCap(const Vec2& tip, double from, double radius, double tolerance, std::vector<Point>& out) {
    const int n = chords(radius, M_PI, tolerance);
    for (int i = 1; i <= n; ++i) {
        const math::SinCos a = math::sinCos(from - M_PI * i / n);
        out.push_back(point(tip + radius * Vec2(a.cosine, a.sine)));
    }
}

void drawOutline(const step::Rod& rod, const DrawOptions& options, const Colour& colour, std::vector<Point>& points,
                 DebugDraw& canvas) {
    const std::vector<rod::Arc>& arcs = rod.kin.arcs();
    const double half = 0.5 * rod.model.definition().thickness;
    const auto leftOf = [&](const rod::Arc& a, double s, double d) {
        return point(a.pointAt(s) + d * rod::perp(a.tangentAt(s)));
    };
    std::vector<Point> right{leftOf(arcs.front(), 0.0, -half)};
    points.assign({leftOf(arcs.front(), 0.0, half)});
    for (const rod::Arc& a : arcs) {
        addArc(a, half, options.tolerance, points);
        addArc(a, -half, options.tolerance, right);
    }
    const bool ring = rod.model.definition().closed;
    if (ring) { // two closed lines; the last point is the first one
        points.pop_back();
        right.pop_back();
        canvas.outline(points, colour);
        canvas.outline(right, colour);
        return;
    }
    const rod::Arc& last = arcs.back();
    addCap(last.pointAt(last.length), last.angleAt(last.length) + 0.5 * M_PI, half, options.tolerance, points);
    points.insert(points.end(), right.rbegin() + 1, right.rend());
    addCap(arcs.front().start, arcs.front().angle - 0.5 * M_PI, half, options.tolerance, points);
    points.pop_back(); // the first one again
    canvas.outline(points, colour);
}

void drawCentreLine(const step::Rod& rod, const DrawOptions& options, std::vector<Point>& points, DebugDraw& canvas) {
    const std::vector<rod::Arc>& arcs = rod.kin.arcs();
    points.assign({point(arcs.front().start)});
    for (std::size_t i = 0; i < arcs.size(); ++i) {
        addArc(arcs[i], 0.0, options.tolerance, points);
        if (!options.strain || rod.quarantined)
            continue;
        canvas.polyline(points, strain_colour(surfaceStrain(rod, static_cast<int>(i)), options.full_strain));
        points.assign({points.back()});
    }
    if (points.size() > 1)
        canvas.polyline(points, rod.quarantined ? options.quarantined : options.line);
}

void drawContacts(const step::World& world, const DrawOptions& options, DebugDraw& canvas) {
    for (const contact::Candidate& c : world.candidates) {
        const step::ContactImpulse* force = step::findImpulse(world.impulses, c.id);
        if (force == nullptr)
            continue;
        if (options.contacts)
            canvas.mark(point(c.pointA), options.contact);
        if (!options.forces)
            continue;
        const Vec2 f = force->normal * c.normal + force->tangent * rod::perp(c.normal);
        const Point line[2] = {point(c.pointA), point(c.pointA + options.metres_per_newton * f)};
        canvas.polyline(line, options.contact);
    }
}

} // namespace

Colour strain_colour(double strain, double full) {
    const double x = std::clamp(strain / full, 0.0, 1.0); // NaN stays NaN and ends in the last branch
    if (x < 0.5)
        return {0.1F, static_cast<float>(0.3 + 1.2 * x), static_cast<float>(0.9 - 1.6 * x)};
    if (x <= 1.0)
        return {static_cast<float>(0.1 + 1.8 * (x - 0.5)), static_cast<float>(0.9 - 1.6 * (x - 0.5)), 0.1F};
    return {1.0F, 0.0F, 1.0F};
}

Status Shells::draw(DebugDraw& canvas, const DrawOptions& options) const {
    if (impl_->gone)
        return refused(kMovedFrom);
    if (!(options.tolerance > 0.0) || !(options.full_strain > 0.0) || !std::isfinite(options.metres_per_newton) ||
        std::isnan(options.alpha))
        return refused("tolerance and full_strain must be positive, metres_per_newton finite, alpha a number");
    return Impl::withoutExceptions([&] { // the canvas is the user's and may throw
        std::vector<Point> points;
        std::optional<step::Rod> between;
        for (const step::Rod& last : impl_->world.rods) {
            if (options.alpha < 1.0) {
                between = last;
                between->q = impl_->between(last, options.alpha);
                between->kin.evaluate(last.model, between->q);
            }
            const step::Rod& rod = between ? *between : last;
            if (options.outlines)
                drawOutline(rod, options, rod.quarantined ? options.quarantined : options.outline, points, canvas);
            if (options.centre_lines)
                drawCentreLine(rod, options, points, canvas);
            for (const step::Hold& h : rod.holds)
                if (options.holds)
                    canvas.mark(point(rod.kin.point(rod::locate(rod.model, h.s))), options.hold);
        }
        if (options.contacts || options.forces)
            drawContacts(impl_->world, options, canvas);
        return done();
    });
}

} // namespace supercircle
