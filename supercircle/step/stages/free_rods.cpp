// Before stage Linearise: rods that touch nothing in this step have moved, and are no more asked about.

#include "supercircle/step/parallel.h"
#include "supercircle/step/rods/free_groups.h"
#include "supercircle/step/rods/free_motion.h"
#include "supercircle/step/rods/hold_rows.h"
#include "supercircle/step/stages/stages.h"

#include <algorithm>
#include <cmath>

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
    const BodyMotion& m = t.stage.host.motion[static_cast<std::size_t>(index)];
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
bool holdsAreClosed(const World& world, const Rod& rod, RodWork& w) {
    constexpr double kClosed = 1e-7; // of the length; what free motion leaves is far less
    holdGaps(world, rod, rod.kin, Vec2::Zero(), 0.0, w.held.gaps);
    const double length = rod.model.definition().length;
    bool closed = true;
    forEachHeldPoint(rod.model, rod.holds, [&](Eigen::Index row, bool angle) {
        closed = closed && w.held.gaps.segment<2>(row).norm() < kClosed * length &&
                 (!angle || std::abs(w.held.gaps[row + 2]) < kClosed);
    });
    return closed;
}

/// Whether the rod is drawn straight between two of its held points that are more than an element apart. It cannot move
/// there, and to first order the rows of its holds depend on each other: free motion takes thousands of steps of its
/// own. In the ordinary step it lies still.
bool isTaut(const Rod& rod) {
    // Of the arc: a sag of 0.2 % of it. With a tenth, a strip of 1e-5 slack takes 2 to 20 times the work; tenfold puts
    // strips that hang through by 0.6 % into first order, at a tenth of the work.
    constexpr double kTaut = 1e-5;
    const double element = rod.model.definition().length / rod.model.elements();
    for (std::size_t i = 0; i < rod.holds.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            const double a = rod.holds[i].s, b = rod.holds[k].s, arc = std::abs(a - b);
            const Vec2 chord = rod.kin.point(rod::locate(rod.model, a)) - rod.kin.point(rod::locate(rod.model, b));
            if (arc > element && chord.norm() > (1.0 - kTaut) * arc)
                return true;
        }
    return false;
}

/// Takes out of `free` what pushes between overlapping rods act on.
void leaveOutOverlapping(const World& world, std::vector<char>& free) {
    const auto out = [&](int rod) {
        if (rod >= 0)
            free[static_cast<std::size_t>(rod)] = 0;
    };
    for (const Overlap& o : world.overlaps) {
        out(rodIndex(world, o.rodA));
        out(o.rodB != 0 ? rodIndex(world, o.rodB) : -1);
    }
}

/// The points of rods that may touch themselves, to be watched on their ways.
void listSelfPairs(const World& world, const std::vector<char>& free, TrialStep& t) {
    for (RodWork& w : t.rods)
        w.free.selfPairs.clear();
    for (const contact::Candidate& c : t.candidates(world)) {
        const auto i = static_cast<std::size_t>(c.a.rod);
        if (c.a.rod != c.b.rod || free[i] == 0)
            continue;
        const Rod& r = world.rods[i];
        const Vec2 apart = r.kin.point(rod::locate(r.model, c.a.s)) - r.kin.point(rod::locate(r.model, c.b.s));
        t.rods[i].free.selfPairs.push_back({{c.a.s, c.b.s}, c.gap, apart.norm()});
    }
}

/// Counts what the motions took. Two iterations of a stage are about one linearisation of a rod.
void countWork(TrialStep& t) {
    for (std::size_t k = 0; k < t.groupCount; ++k) {
        const FreeGroup& g = t.groups[k];
        for (const std::size_t i : g.rods) {
            t.result.work.rods += 0.5 * g.iterations;
            t.result.work.freedoms += g.steps * static_cast<double>(t.rods[i].free.q.size() * t.rods[i].free.q.size());
        }
        if (!g.joints.empty())
            t.result.work.freedoms += g.iterations * static_cast<double>(g.rows * g.rows);
    }
}

/// Joints of free rods have done what they do.
void leaveOutJoints(TrialStep& t) {
    for (LinkEnds& e : t.stage.links.ends)
        e.counts = e.counts && !t.rods[static_cast<std::size_t>(e.rodA)].isFree;
}

/// So have the bodies that hang on them.
void setBodies(const World& world, TrialStep& t) {
    for (std::size_t k = 0; k < t.groupCount; ++k)
        for (const FreeBody& b : t.groups[k].bodies) {
            const auto i = static_cast<std::size_t>(b.body);
            const Eigen::Vector3d mean = (b.q - b.before) / t.dt;
            t.stage.host.motion[i] =
                t.isFree(t.groups[k]) ? BodyMotion{mean.head<2>(), mean.z(), true} : predictedMotion(world.bodies[i]);
        }
}

void setFree(const FreeGroup& g, bool isFree, std::vector<RodWork>& rods) {
    for (const std::size_t i : g.rods)
        rods[i].isFree = isFree;
}

/// Those that came farther than foreseen may touch, and so may their neighbours.
void takeBack(const World& world, const Settings& settings, TrialStep& t) {
    std::vector<int>& groupOf = t.stage.host.groupBlocks; // of rods, then of bodies
    groupOf.assign(t.rods.size() + world.bodies.size(), -1);
    for (std::size_t k = 0; k < t.groupCount; ++k) {
        for (const std::size_t i : t.groups[k].rods)
            groupOf[i] = static_cast<int>(k);
        for (const FreeBody& b : t.groups[k].bodies)
            groupOf[t.rods.size() + static_cast<std::size_t>(b.body)] = static_cast<int>(k);
    }
    const auto bind = [&](std::size_t member) {
        if (groupOf[member] >= 0)
            setFree(t.groups[static_cast<std::size_t>(groupOf[member])], false, t.rods);
    };
    for (bool changed = true; changed;) {
        changed = false;
        setBodies(world, t);
        for (const contact::Candidate& c : t.candidates(world)) {
            const bool ofBody = isOfFreeBody(world, t.stage, c);
            if ((!isOfFreeRod(t.rods, c) && !ofBody) || !mayMeet(world, settings, t, c))
                continue;
            bind(static_cast<std::size_t>(c.a.rod));
            if (c.b.rod >= 0)
                bind(static_cast<std::size_t>(c.b.rod));
            if (ofBody)
                bind(t.rods.size() + static_cast<std::size_t>(
                                         bodyIndex(world, world.outlines[static_cast<std::size_t>(c.outline)].body)));
            changed = true;
        }
    }
}

} // namespace

void moveFreeRods(const World& world, const Settings& settings, TrialStep& t) {
    std::vector<RodWork>& rods = t.rods;
    for (RodWork& w : rods)
        w.isFree = false;
    t.anyFree = false;
    t.groupCount = 0;
    if (t.aside) {
        for (std::size_t i = 0; i < rods.size(); ++i)
            if ((*t.aside)[i].isFree) {
                standAside(world.rods[i], rods[i]);
                t.anyFree = true;
            }
        leaveOutJoints(t);
        return;
    }
    if (!settings.secondOrder)
        return;
    std::vector<char>& free = t.stage.scratch.marked;
    free.assign(rods.size(), 0);
    for (std::size_t i = 0; i < rods.size(); ++i)
        free[i] = mayMoveFreely(world.rods[i]) ? 1 : 0;
    leaveOutOverlapping(world, free);
    for (const contact::Candidate& c : t.kept) // a spin seems to bring points of one rod together
        if (c.a.rod != c.b.rod || c.gap <= settings.margin * t.h) {
            free[static_cast<std::size_t>(c.a.rod)] = 0;
            if (c.b.rod >= 0)
                free[static_cast<std::size_t>(c.b.rod)] = 0;
        }
    for (std::size_t i = 0; i < rods.size(); ++i)
        if (free[i] != 0 && (isTaut(world.rods[i]) || !holdsAreClosed(world, world.rods[i], rods[i])))
            free[i] = 0;
    listFreeGroups(world, free, t);
    listSelfPairs(world, free, t);
    forEachRod(t.stage.loop, t.groupCount, [&](std::size_t k) {
        setFree(t.groups[k], moveFreely(world, settings, t.stage.host.motion, t.dt, rods, t.groups[k]), rods);
    });
    countWork(t);
    takeBack(world, settings, t);
    leaveOutJoints(t);
    t.anyFree = std::any_of(rods.begin(), rods.end(), [](const RodWork& w) { return w.isFree; });
}

} // namespace supercircle::step
