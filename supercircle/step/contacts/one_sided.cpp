#include "supercircle/step/contacts/one_sided.h"

#include "supercircle/contact/one_sided.h"
#include "supercircle/step/contacts/overlaps.h"
#include "supercircle/step/islands/reach.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

/// An edge is passed until the centre line is this far from it, in half thicknesses. Ten times what the crossing check
/// takes for touching; doubled or halved, contact begins that much later or sooner.
constexpr double kLeaves = 0.01;

bool isOneSided(const BodyOutline& o) {
    return o.local.kind == contact::OutlineKind::OneSided;
}

PieceId idOf(const BodyOutline& o) {
    return {o.body, o.local.key};
}

bool contains(const std::vector<PieceId>& list, const PieceId& id) {
    return std::find(list.begin(), list.end(), id) != list.end();
}

bool shareVertex(const contact::Outline& a, const contact::Outline& b) {
    return std::any_of(a.points.begin(), a.points.end(),
                       [&](const Vec2& p) { return p == b.points[0] || p == b.points[1]; });
}

/// The outlines of the surfaces that a rod passes: its edges, and from vertex to vertex what continues them.
std::vector<int> surfacesOf(const World& world, const Rod& rod) {
    std::vector<int> list;
    if (rod.passing.empty())
        return list;
    std::vector<char> taken(world.outlines.size(), 0);
    const auto take = [&](auto belongs) {
        for (std::size_t i = 0; i < world.outlines.size(); ++i)
            if (const BodyOutline& o = world.outlines[i]; taken[i] == 0 && isOneSided(o) && belongs(o)) {
                taken[i] = 1;
                list.push_back(static_cast<int>(i));
            }
    };
    take([&](const BodyOutline& o) { return contains(rod.passing, idOf(o)); });
    for (std::size_t k = 0; k < list.size(); ++k) {
        const BodyOutline& from = world.outlines[static_cast<std::size_t>(list[k])];
        take([&](const BodyOutline& o) { return o.body == from.body && shareVertex(o.local, from.local); });
    }
    return list;
}

Box boxOf(const contact::Outline& edge) {
    Box box = emptyBox();
    for (const Vec2& p : edge.points)
        widen(box, p, 0.0);
    return box;
}

bool isPutAcross(const World& world, const Rod& rod, const BodyOutline& piece) {
    return std::any_of(world.overlaps.begin(), world.overlaps.end(),
                       [&](const Overlap& o) { return o.rodA == rod.key && o.rodB == 0 && o.body == piece.body; });
}

} // namespace

void findPassing(World& world, const ContactStage& stage) {
    bool changed = stage.detection.behind; // what was behind may be in front
    if (std::none_of(world.outlines.begin(), world.outlines.end(), isOneSided))
        return;
    for (std::size_t r = 0; r < world.rods.size(); ++r) {
        Rod& rod = world.rods[r];
        if (rod.frozen())
            continue;
        const Box box = reachOf(world, rod, rod.kin, 0.0, 0.0);
        const double leaves = kLeaves * stage.detection.curves[r].halfThickness;
        std::vector<PieceId> now;
        for (std::size_t i = 0; i < world.outlines.size(); ++i) {
            const BodyOutline& piece = world.outlines[i];
            if (isOneSided(piece) && meet(box, boxOf(stage.detection.outlines[i])) && !isPutAcross(world, rod, piece) &&
                contact::reaches(stage.detection.curves[r], stage.detection.outlines[i],
                                 contains(rod.passing, idOf(piece)) ? leaves : 0.0))
                now.push_back(idOf(piece));
        }
        if (now == rod.passing)
            continue;
        rod.passing = std::move(now);
        changed = true;
    }
    if (changed)
        world.range.clear(); // candidates are found anew
}

bool passes(const World& world, const Rod& rod, const BodyOutline& piece) {
    const std::vector<int> list = surfacesOf(world, rod);
    return std::any_of(list.begin(), list.end(),
                       [&](int i) { return idOf(world.outlines[static_cast<std::size_t>(i)]) == idOf(piece); });
}

void collectPassing(const World& world, std::vector<std::pair<int, int>>& pairs) {
    pairs.clear();
    for (std::size_t r = 0; r < world.rods.size(); ++r)
        for (const int outline : surfacesOf(world, world.rods[r]))
            pairs.emplace_back(static_cast<int>(r), outline);
    std::sort(pairs.begin(), pairs.end());
}

bool comesFromBehind(const World& world, const contact::Candidate& c) {
    if (c.b.rod >= 0)
        return false;
    const BodyOutline& piece = world.outlines[static_cast<std::size_t>(c.outline)];
    if (!isOneSided(piece) || isOverlap(world, c.a.rod, -1, c.outline, false))
        return false;
    const Rod& rod = world.rods[static_cast<std::size_t>(c.a.rod)];
    const BodyState& body = world.bodies[static_cast<std::size_t>(bodyIndex(world, piece.body))].state;
    const Vec2 arm = rod.kin.point(rod::locate(rod.model, c.a.element, c.a.s)) - body.centre;
    const double cosine = math::cos(body.angle), sine = math::sin(body.angle);
    return !contact::isInFront({cosine * arm.x() + sine * arm.y(), cosine * arm.y() - sine * arm.x()}, piece.local);
}

} // namespace supercircle::step
