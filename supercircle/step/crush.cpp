#include "supercircle/step/crush.h"

#include "supercircle/contact/crossing.h"
#include "supercircle/step/applied_forces.h"
#include "supercircle/step/sleep.h"
#include "supercircle/step/stages/stages.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace supercircle::step {

namespace {

/// Of the thickness: a given motion shorter than this within a step is no reason of its own for a rejection. Half of it
/// finds contradictions one cut later; twice as much takes shells for crushed that a fast wall hits against a floor.
constexpr double kNoMotion = 0.05;
/// Of the pressing force, that presses back. Far lower ones are of shells that move away.
constexpr double kPressesBack = 0.25;
/// s, for which a body may pass at least: the shell is still between the surfaces when it is let go. Half of it crushes
/// slow presses' shells twice; twice as much lets fast bodies pass a second time.
constexpr double kPassage = 0.25;

/// What is pressed by whom: rods and dynamic bodies that press on each other are one set.
class Sets {
public:
    explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
    std::size_t root(std::size_t i) {
        while (parent_[i] != i)
            i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t a, std::size_t b) { parent_[root(b)] = root(a); }

private:
    std::vector<std::size_t> parent_;
};

/// A body of given motion (static ones too) that presses on a rod.
struct Press {
    std::size_t rod = 0;
    BodyId body = 0;
    double approach = 0.0;       ///< m/s, towards the rod
    Vec2 impulse = Vec2::Zero(); ///< on the rod, N s
};

std::vector<Press> collect(const World& world, const TrialStep& t, Sets& sets) {
    const ContactStage& stage = t.stage;
    const std::size_t rods = world.rods.size();
    const auto dynamic = [&](int body) { return stage.host.place[static_cast<std::size_t>(body)].block >= 0; };
    std::vector<Press> presses;
    for (std::size_t i = 0; i < stage.candidates.size(); ++i) {
        const Vec2 r = stage.r.segment<2>(static_cast<Eigen::Index>(2 * i));
        if (!(r.x() > 0.0))
            continue;
        const ContactWork& k = stage.work[i];
        const auto a = static_cast<std::size_t>(k.rodA);
        if (k.rodB >= 0) {
            sets.join(a, static_cast<std::size_t>(k.rodB));
        } else if (dynamic(k.bodyB)) {
            sets.join(a, rods + static_cast<std::size_t>(k.bodyB));
        } else {
            const Vec2& n = stage.candidates[i].normal;
            presses.push_back({a, world.bodies[static_cast<std::size_t>(k.bodyB)].id, k.surface.x(),
                               n * r.x() + rod::perp(n) * r.y()});
        }
    }
    for (const LinkEnds& e : stage.links.ends)
        if (e.counts && e.rodB >= 0)
            sets.join(static_cast<std::size_t>(e.rodA), static_cast<std::size_t>(e.rodB));
        else if (e.counts && e.body >= 0 && dynamic(e.body))
            sets.join(static_cast<std::size_t>(e.rodA), rods + static_cast<std::size_t>(e.body));
    return presses;
}

/// Mean of the step: a path may begin at rest.
Vec2 velocityOf(const World& world, const Hold& h, double dt) {
    return (poseAfter(world, h, dt).point - poseAfter(world, h, 0.0).point) / dt;
}

bool known(const std::vector<Crushed>& list, const Crushed& c) {
    return std::any_of(list.begin(), list.end(),
                       [&](const Crushed& o) { return o.rod == c.rod && o.body == c.body && o.hold == c.hold; });
}

} // namespace

void findCrushed(const World& world, const TrialStep& t, std::vector<Crushed>& out) {
    out.clear();
    if (static_cast<std::size_t>(t.stage.r.size()) < 2 * t.stage.candidates.size() || !t.stage.r.allFinite())
        return;
    Sets sets(world.rods.size() + world.bodies.size());
    const std::vector<Press> presses = collect(world, t, sets);
    const auto small = [&](double speed, std::size_t rod) {
        return speed * t.dt <= kNoMotion * world.rods[rod].model.definition().thickness;
    };
    const auto add = [&](const Crushed& c) {
        if (!known(out, c))
            out.push_back(c);
    };
    std::vector<char> held(world.rods.size() + world.bodies.size(), 0);
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        if (!world.rods[i].holds.empty())
            held[sets.root(i)] = 1;
    for (const Press& p : presses) {
        if (!(p.approach > 0.0) || !small(p.approach, p.rod))
            continue;
        Vec2 pressing = Vec2::Zero(), back = Vec2::Zero();
        for (const Press& o : presses)
            if (sets.root(o.rod) == sets.root(p.rod))
                (o.body == p.body ? pressing : back) += o.impulse;
        if (held[sets.root(p.rod)] != 0 || back.dot(pressing) < -kPressesBack * pressing.squaredNorm())
            add({world.rods[p.rod].key, p.body, 0, world.time});
    }
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        for (const Hold& h : world.rods[i].holds) {
            const Vec2 v = velocityOf(world, h, t.dt);
            if (!(v.norm() > 0.0) || !small(v.norm(), i))
                continue;
            for (const Press& p : presses)
                if (sets.root(p.rod) == sets.root(i) && p.impulse.dot(v) < -kPressesBack * p.impulse.norm() * v.norm())
                    add({world.rods[h.onCrosshead ? p.rod : i].key, p.body, h.onCrosshead ? 0U : h.key, world.time});
        }
}

void endCrushing(World& world, const Settings& settings, const std::vector<Crushed>& crushed) {
    for (const Crushed& c : crushed) {
        const int index = rodIndex(world, c.rod);
        if (index < 0)
            continue;
        Rod& rod = world.rods[static_cast<std::size_t>(index)];
        if (c.hold != 0) {
            for (Rod& r : world.rods)
                for (Hold& h : r.holds)
                    if (h.key == c.hold) {
                        const Pose now = poseAfter(world, h, 0.0);
                        h.target = Target{};
                        h.target.point = now.point;
                        h.target.angle = now.angle;
                    }
        } else if (settings.crush == CrushPolicy::Freeze) {
            if (!rod.quarantined)
                quarantine(world, rod, QuarantineReason::Crushed);
        } else {
            world.passages.push_back({c.rod, c.body, world.time + kPassage});
            wake(world, static_cast<std::size_t>(index));
        }
    }
    if (!crushed.empty())
        world.range.clear(); // candidates are found anew
}

void closePassages(World& world) {
    const auto inside = [&](const Passage& p, int index) {
        std::vector<contact::RodCurve> curve(1);
        toCurve(world.rods[static_cast<std::size_t>(index)], world.rods[static_cast<std::size_t>(index)].kin, curve[0]);
        std::vector<contact::Outline> outlines;
        const Body& body = world.bodies[static_cast<std::size_t>(bodyIndex(world, p.body))];
        for (const BodyOutline& o : world.outlines)
            if (o.body == p.body)
                outlines.push_back(placed(o, body.state.centre, body.state.angle));
        std::vector<contact::Crossing> found;
        contact::findCrossings(curve, outlines, found);
        return std::any_of(found.begin(), found.end(), [](const contact::Crossing& c) { return c.outline >= 0; });
    };
    const std::size_t closed = std::erase_if(world.passages, [&](const Passage& p) {
        const int rod = rodIndex(world, p.rod);
        if (rod < 0 || bodyIndex(world, p.body) < 0)
            return true;
        return world.time >= p.until && !inside(p, rod);
    });
    if (closed > 0)
        world.range.clear();
}

void breakOverloaded(World& world, std::vector<Broken>& out) {
    const auto overloaded = [](double most, const Vec2& force) { return most > 0.0 && force.norm() > most; };
    for (Rod& r : world.rods)
        std::erase_if(r.holds, [&](const Hold& h) {
            if (!overloaded(h.maxForce, h.reaction))
                return false;
            out.push_back({r.key, h.key, false, h.reaction, world.time});
            return true;
        });
    for (Link& l : world.links)
        if (!l.broken && overloaded(l.maxForce, l.force)) {
            out.push_back({l.rodA, l.key, true, l.force, world.time});
            l.broken = true;
        }
}

void removeBroken(World& world) {
    if (std::erase_if(world.links, [](const Link& l) { return l.broken; }) > 0)
        world.range.clear(); // the pair may collide again
}

} // namespace supercircle::step
