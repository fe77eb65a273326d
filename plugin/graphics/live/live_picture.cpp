#include "plugin/graphics/live/live_picture.h"

#include "supercircle/step/contact_memory.h"
#include "supercircle/step/world.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::live {

using rod::Vec2;

namespace {

picture::Point point(const Vec2& p) {
    return {p.x(), p.y()};
}

/// Chords that keep an arc within the tolerance.
int chords(double curvature, double length, double tolerance) {
    const double angle = std::abs(curvature) * length;
    if (!(angle > 1e-9))
        return 1;
    const double half = math::acos(std::clamp(1.0 - tolerance * std::abs(curvature), 0.0, 1.0));
    return static_cast<int>(std::clamp(std::ceil(0.5 * angle / std::max(half, 1e-9)), 1.0, 256.0));
}

/// Energy per length at an element's part t (0 to 1): linear between the middles of elements, so that colours do not
/// step from one to the next.
double blended(const std::vector<double>& of, std::size_t element, double t, bool closed) {
    const std::size_t n = of.size();
    const bool up = t >= 0.5;
    const bool end = up ? element + 1 == n : element == 0;
    const std::size_t other = up ? (element + 1) % n : (element + n - 1) % n;
    const double share = end && !closed ? 0.0 : std::abs(t - 0.5);
    return (1.0 - share) * of[element] + share * of[other];
}

/// Change of curvature that has the last colour, over the natural curvature. Half of it makes all snapping shells pale;
/// twice of it leaves a stack under its own weight in the first three colours.
constexpr double kFullAmplitude = 0.5;

} // namespace

std::vector<picture::Body> bodiesOf(const step::Port& port, const std::vector<step::BodyOutline>& outlines) {
    std::vector<picture::Body> out;
    for (const step::BodyOutline& o : outlines) {
        step::BodyState s;
        if (!port.state(o.body, s) || !s.enabled)
            continue;
        const contact::Outline placed = step::placed(o, s.centre, s.angle);
        picture::Body body;
        for (const Vec2& p : placed.points)
            body.points.push_back(point(p));
        body.radius = placed.kind == contact::OutlineKind::Circle ? placed.radius : 0.0;
        body.solid = placed.kind == contact::OutlineKind::Polygon || placed.kind == contact::OutlineKind::Circle;
        body.role = !s.moving ? picture::Role::Still : s.mass > 0.0 ? picture::Role::Loose : picture::Role::Driven;
        body.id = o.body;
        if (body.role == picture::Role::Loose)
            body.angle = s.angle;
        out.push_back(std::move(body));
    }
    return out;
}

std::vector<picture::Shell> shellsOf(const Shells& shells, double alpha, double tolerance) {
    std::vector<picture::Shell> out;
    const step::World& world = shells.world();
    std::size_t next = 0;
    for (const ShellHandle handle : shells.shells()) {
        if (next >= world.rods.size())
            break;
        const step::Rod& rod = world.rods[next++];
        const auto pose = shells.pose(handle, alpha);
        if (!pose)
            continue;
        const rod::RodDefinition& d = rod.model.definition();
        picture::Shell shell;
        shell.thickness = d.thickness;
        shell.closed = d.closed;
        shell.quarantined = rod.quarantined;
        const double flat = kFullAmplitude / rod.model.meanRadius();
        shell.fullEnergy = 0.5 * d.bendingModulus * flat * flat;
        std::vector<double> energy;
        for (std::size_t i = 0; i < pose->curvature.size(); ++i) {
            const double change = pose->curvature[i] - d.naturalCurvature[i];
            energy.push_back(0.5 * d.bendingModulus * change * change);
        }
        rod::Arc arc{};
        arc.start = {pose->start.x, pose->start.y};
        arc.angle = pose->angle;
        for (std::size_t i = 0; i < energy.size(); ++i) {
            arc.curvature = pose->curvature[i];
            arc.length = rod.model.elementLength(static_cast<int>(i));
            const int n = std::max(chords(arc.curvature, arc.length, tolerance), 2);
            for (int k = 0; k < n; ++k) {
                const double t = static_cast<double>(k) / n;
                shell.line.push_back(point(arc.pointAt(t * arc.length)));
                shell.energy.push_back(blended(energy, i, t, d.closed));
            }
            const Vec2 end = arc.pointAt(arc.length);
            arc.angle = arc.angleAt(arc.length);
            arc.start = end;
        }
        if (!d.closed) {
            shell.line.push_back(point(arc.start));
            shell.energy.push_back(energy.back());
        }
        out.push_back(std::move(shell));
    }
    return out;
}

void addMarks(const Shells& shells, const Layers& layers, picture::Content& content) {
    const step::World& world = shells.world();
    if (layers.contacts || layers.forces)
        for (const contact::Candidate& c : world.candidates) {
            const step::ContactImpulse* force = step::findImpulse(world.impulses, c.id);
            if (force == nullptr)
                continue;
            const Vec2 f = force->normal * c.normal + force->tangent * rod::perp(c.normal);
            content.contacts.push_back({point(c.pointA), layers.forces ? point(f) : picture::Point{}});
        }
    if (layers.holds)
        for (const step::Rod& rod : world.rods)
            for (const step::Hold& h : rod.holds)
                content.holds.push_back(point(rod.kin.point(rod::locate(rod.model, h.s))));
}

void SnapWatch::frame(const Shells& shells) {
    for (const SnapEndEvent& snap : shells.events().snap_end)
        if (const auto middle = shells.section(snap.shell, 0.5))
            marks_.add({middle->position.x, middle->position.y}, snap.energy_released, snap.time);
}

std::vector<picture::SnapMark> SnapWatch::at(const Shells& shells, double clock) {
    return marks_.at(clock > 0.0 ? clock : shells.time(), shells.time());
}

} // namespace supercircle::live
