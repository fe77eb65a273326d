#include "plugin/pages/run/geometry.h"

#include <algorithm>
#include <cmath>

namespace supercircle::pages {

using namespace graphics;

std::vector<double> elementLengths(const record::ShellInfo& shell, std::size_t elements) {
    if (shell.element_length.size() == elements)
        return shell.element_length;
    return std::vector<double>(elements, elements == 0 ? 0.0 : shell.length / static_cast<double>(elements));
}

std::vector<Point> centreLine(const record::ShellInfo& shell, const record::ShellPose& pose, double tolerance) {
    const std::vector<double> lengths = elementLengths(shell, pose.curvature.size());
    std::vector<Point> points{{pose.start[0], pose.start[1]}};
    double angle = pose.angle;
    bool finite = std::isfinite(angle) && std::isfinite(points[0].x) && std::isfinite(points[0].y);
    for (std::size_t i = 0; i < lengths.size() && finite; ++i) {
        const double curvature = pose.curvature[i], turn = curvature * lengths[i];
        // Sagitta of a chord that turns by a: a^2 / (8 kappa).
        const double step = std::sqrt(8.0 * tolerance * std::max(std::abs(curvature), 1e-9));
        const int pieces = std::clamp(static_cast<int>(std::ceil(std::abs(turn) / step)), 1, 400);
        for (int k = 0; k < pieces && finite; ++k) {
            const double a = turn / pieces, half = 0.5 * a;
            const double chord =
                lengths[i] / pieces * (std::abs(half) < 1e-4 ? 1.0 - half * half / 6.0 : std::sin(half) / half);
            const Point& last = points.back();
            points.push_back({last.x + chord * std::cos(angle + half), last.y + chord * std::sin(angle + half)});
            angle += a;
            finite = std::isfinite(points.back().x) && std::isfinite(points.back().y);
        }
    }
    return finite ? points : std::vector<Point>{};
}

std::vector<Point> worldOutline(const record::OutlineInfo& outline, const record::Frame& frame) {
    record::BodyPose pose;
    if (outline.body >= 0 && static_cast<std::size_t>(outline.body) < frame.bodies.size())
        pose = frame.bodies[static_cast<std::size_t>(outline.body)];
    const double c = std::cos(pose.angle), s = std::sin(pose.angle);
    std::vector<Point> points;
    const auto add = [&](double x, double y) { points.push_back({pose.x + c * x - s * y, pose.y + s * x + c * y}); };
    if (outline.kind == record::OutlineInfo::Kind::Circle && outline.points.empty())
        add(0.0, 0.0);
    for (const auto& p : outline.points)
        add(p[0], p[1]);
    return points;
}

} // namespace supercircle::pages
