// Before stage Linearise: rods that touch nothing in this step have moved, and are no more asked about.

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/contacts/cull.h"
#include "supercircle/step/parallel.h"
#include "supercircle/step/rods/free_motion.h"
#include "supercircle/step/stages/stages.h"

#include <algorithm>

namespace supercircle::step {

namespace {

/// Where something comes within the step: a way that all of it goes, and what its points add to it.
struct Way {
    Vec2 together = Vec2::Zero(); ///< m
    double about = 0.0;           ///< m
};

double fallOf(const World& world, const TrialStep& t) {
    return world.gravity.norm() * t.dt * t.dt;
}

Way wayOf(const World& world, const TrialStep& t, std::int32_t rod) {
    const auto i = static_cast<std::size_t>(rod);
    if (t.rods[i].isFree)
        return {t.rods[i].free.carried, t.rods[i].free.about};
    return {Vec2::Zero(), world.rods[i].frozen() ? 0.0 : 1.5 * world.rods[i].speed * t.dt + 2.0 * fallOf(world, t)};
}

/// Of the point of an outline that a candidate names.
Way wayOfOutline(const World& world, const TrialStep& t, const contact::Candidate& c) {
    const int index = bodyIndex(world, world.outlines[static_cast<std::size_t>(c.outline)].body);
    if (index < 0)
        return {};
    const Body& body = world.bodies[static_cast<std::size_t>(index)];
    const BodyMotion& m = t.stage.motion[static_cast<std::size_t>(index)];
    const Vec2 way = t.dt * (m.velocity + m.spin * rod::perp(c.pointB - body.state.centre));
    const double turned = t.dt * std::abs(m.spin) * way.norm();
    return {way, turned + (body.dynamic ? 2.0 : 1.0) * fallOf(world, t)}; // the rod's way is no straight one
}

/// Whether a candidate may close on the ways that are known. Two points of one rod were watched on them.
bool mayMeet(const World& world, const Settings& settings, const TrialStep& t, const contact::Candidate& c) {
    const double margin = settings.margin * t.h;
    if (c.a.rod == c.b.rod)
        return t.rods[static_cast<std::size_t>(c.a.rod)].free.closest <= margin;
    const Way a = wayOf(world, t, c.a.rod);
    const Way b = c.b.rod >= 0 ? wayOf(world, t, c.b.rod) : wayOfOutline(world, t, c);
    return c.gap <= margin + (a.together - b.together).norm() + a.about + b.about;
}

/// Holds that are where they are to be: a gap is closed by the ordinary step, with a bounded speed.
bool holdsAreClosed(const World& world, const Rod& rod) {
    constexpr double kClosed = 1e-7; // of the length; what free motion leaves is far less
    const double small = kClosed * rod.model.definition().length;
    return std::all_of(rod.holds.begin(), rod.holds.end(), [&](const Hold& h) {
        const Pose goal = poseAfter(world, h, 0.0);
        const rod::MaterialPoint at = rod::locate(rod.model, h.s);
        return (rod.kin.point(at) - goal.point).norm() < small &&
               (!h.clamped || std::abs(rod.kin.angle(at) - goal.angle) < kClosed);
    });
}

/// Takes out of `free` what a link, a push between overlapping rods or a contact may act on.
void leaveOutJoined(const World& world, std::vector<char>& free) {
    const auto out = [&](std::uint32_t key) {
        const int i = key != 0 ? rodIndex(world, key) : -1;
        if (i >= 0)
            free[static_cast<std::size_t>(i)] = 0;
    };
    for (const Link& l : world.links) {
        out(l.rodA);
        out(l.end == LinkEnd::Rod ? l.rodB : 0);
    }
    for (const Overlap& o : world.overlaps) {
        out(o.rodA);
        out(o.rodB);
    }
}

} // namespace

void moveFreeRods(const World& world, const Settings& settings, TrialStep& t) {
    std::vector<RodWork>& rods = t.rods;
    for (RodWork& w : rods)
        w.isFree = false;
    t.anyFree = false;
    if (!settings.secondOrder)
        return;
    std::vector<char>& free = t.stage.marked;
    free.assign(rods.size(), 0);
    for (std::size_t i = 0; i < rods.size(); ++i)
        free[i] = mayMoveFreely(world.rods[i]) ? 1 : 0;
    leaveOutJoined(world, free);
    const auto each = [&](const contact::Candidate& c, const auto& what) {
        what(static_cast<std::size_t>(c.a.rod));
        if (c.b.rod >= 0)
            what(static_cast<std::size_t>(c.b.rod));
    };
    cull(world, t.dt, settings.margin * t.h, t.candidates(world), t.kept);
    for (const contact::Candidate& c : t.kept) // a spin seems to bring points of one rod together
        if (c.a.rod != c.b.rod || c.gap <= settings.margin * t.h)
            each(c, [&](std::size_t i) { free[i] = 0; });
    for (RodWork& w : rods)
        w.free.selfPairs.clear();
    for (const contact::Candidate& c : t.candidates(world))
        if (c.a.rod == c.b.rod) {
            const Rod& r = world.rods[static_cast<std::size_t>(c.a.rod)];
            const Vec2 apart = r.kin.point(rod::locate(r.model, c.a.s)) - r.kin.point(rod::locate(r.model, c.b.s));
            rods[static_cast<std::size_t>(c.a.rod)].free.selfPairs.push_back({{c.a.s, c.b.s}, c.gap, apart.norm()});
        }
    forEachRod(t.stage.loop, rods.size(), [&](std::size_t i) {
        rods[i].isFree = free[i] != 0 && holdsAreClosed(world, world.rods[i]) &&
                         moveFreely(world, settings, world.rods[i], t.dt, rods[i]);
    });
    for (std::size_t i = 0; i < rods.size(); ++i)
        if (free[i] != 0) {
            const FreeWork& f = rods[i].free;
            t.result.work.rods += 0.5 * f.iterations;
            t.result.work.freedoms += f.steps * static_cast<double>(f.q.size() * f.q.size());
        }
    for (bool changed = true; changed;) { // one that came farther than foreseen may touch, and so may its neighbour
        changed = false;
        for (const contact::Candidate& c : t.candidates(world)) {
            bool any = false;
            each(c, [&](std::size_t i) { any = any || rods[i].isFree; });
            if (!any || !mayMeet(world, settings, t, c))
                continue;
            each(c, [&](std::size_t i) { rods[i].isFree = false; });
            changed = true;
        }
    }
    t.anyFree = std::any_of(rods.begin(), rods.end(), [](const RodWork& w) { return w.isFree; });
}

} // namespace supercircle::step
