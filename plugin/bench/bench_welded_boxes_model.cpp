// The joints are springs of angular stiffness B / l, or rigid welds (decision 0173).

#include "plugin/bench/bench_welded_boxes.h"

#include "bridge/box2d/lab_world.h"

#include <algorithm>
#include <cmath>

namespace supercircle::cli {

namespace {

/// Ends of the arcs of a pose, m.
std::vector<Vec2> nodes(const ShellDef& shell, const ShellPose& pose, double length) {
    std::vector<Vec2> out{{pose.start.x, pose.start.y}};
    double angle = pose.angle;
    const double part = length / shell.elements;
    for (const double k : pose.curvature) {
        const double half = 0.5 * k * part, chord = std::abs(half) < 1e-8 ? part : part * std::sin(half) / half;
        out.push_back(out.back() + chord * Vec2(std::cos(angle + half), std::sin(angle + half)));
        angle += 2.0 * half;
    }
    return out;
}

} // namespace

void WeldedShells::add(const ShellDef& shell, const ShellPose& pose, bool held) {
    const double length = 2.0 * M_PI * shell.phi_bar * shell.radius, part = length / shell.elements;
    const std::vector<Vec2> at = nodes(shell, pose, length);
    const auto count = static_cast<std::size_t>(shell.elements);
    const double half = 0.5 * (at[1] - at[0]).norm(), thick = 0.5 * shell.thickness;
    const double mass = shell.density * shell.width * shell.thickness * part;
    const double inertia = mass * (4.0 * half * half + 4.0 * thick * thick) / 12.0;
    shells_.push_back({boxes_.size(), count, length, shell.thickness});
    for (std::size_t i = 0; i < count; ++i) {
        const bool kinematic = held && i == count / 2;
        step::BodyDefinition body;
        body.type = kinematic ? step::BodyType::Kinematic : step::BodyType::Dynamic;
        body.position = 0.5 * (at[i] + at[i + 1]);
        // not an angle of atan2: joints measure relative rotations, full turns included
        body.angle = pose.angle + (static_cast<double>(i) + 0.5) * part / shell.radius;
        body.allowSleep = false;
        step::FixtureDefinition box;
        box.vertices = {{-half, -thick}, {half, -thick}, {half, thick}, {-half, thick}};
        box.density = mass / (4.0 * half * thick);
        box.friction = shell.mu;
        body.fixtures.push_back(box);
        definition_.bodies.push_back(body);
        const auto index = static_cast<std::int32_t>(definition_.bodies.size()) - 1;
        boxes_.push_back({static_cast<step::BodyId>(index) + 1, half});
        if (kinematic)
            held_ = boxes_.back().id;
        if (i == 0)
            continue;
        step::JointDefinition weld;
        weld.kind = step::JointKind::Weld;
        weld.bodyA = index - 1;
        weld.bodyB = index;
        weld.anchorA = {half, 0.0};
        weld.anchorB = {-half, 0.0};
        weld.refAngle = part / shell.radius;
        if (settings_.soft) { // Box2D derives the stiffness from a frequency and the reduced inertia of the bodies
            const bool alone = held && (i == count / 2 || i == count / 2 + 1);
            const double reduced = alone ? inertia : 0.5 * inertia;
            weld.frequency = std::sqrt(bending_modulus(shell) / part / reduced) / (2.0 * M_PI);
            weld.dampingRatio = settings_.damping;
        }
        definition_.joints.push_back(weld);
    }
}

std::string WeldedShells::build(std::unique_ptr<step::HostWorld>& host) {
    std::string error;
    host = bridge::makeWorld(definition_, error);
    return error;
}

std::vector<contact::RodCurve> WeldedShells::curves(const step::HostWorld& host) const {
    std::vector<contact::RodCurve> out;
    for (const BoxShell& shell : shells_) {
        std::vector<Vec2> points;
        for (std::size_t i = 0; i < shell.count; ++i) {
            const Box& box = boxes_[shell.first + i];
            const step::BodyState s = host.stateOf(box.id);
            const Vec2 along(std::cos(s.angle), std::sin(s.angle));
            const Vec2 first = s.centre - box.half * along, last = s.centre + box.half * along;
            if (points.empty())
                points.push_back(first);
            else
                points.back() = 0.5 * (points.back() + first); // midpoint of the joint's two ends
            points.push_back(last);
        }
        contact::RodCurve curve;
        curve.halfThickness = 0.5 * shell.thickness;
        curve.key = static_cast<std::uint32_t>(out.size());
        curve.nodeS.push_back(0.0);
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            const Vec2 d = points[i + 1] - points[i];
            rod::Arc arc;
            arc.start = points[i];
            arc.angle = std::atan2(d.y(), d.x());
            arc.curvature = 0.0;
            arc.length = d.norm();
            curve.arcs.push_back(arc);
            curve.nodeS.push_back(curve.nodeS.back() + arc.length);
        }
        curve.midS = 0.5 * curve.nodeS.back();
        out.push_back(std::move(curve));
    }
    return out;
}

double WeldedShells::stretch(const step::HostWorld& host) const {
    double worst = 0.0;
    for (const BoxShell& shell : shells_) {
        double sum = 0.0;
        for (std::size_t i = 1; i < shell.count; ++i) {
            const Box &a = boxes_[shell.first + i - 1], &b = boxes_[shell.first + i];
            const step::BodyState sa = host.stateOf(a.id), sb = host.stateOf(b.id);
            sum += (sa.centre + a.half * Vec2(std::cos(sa.angle), std::sin(sa.angle)) - sb.centre +
                    b.half * Vec2(std::cos(sb.angle), std::sin(sb.angle)))
                       .norm();
        }
        worst = std::max(worst, sum / shell.length);
    }
    return worst;
}

} // namespace supercircle::cli
