#include "supercircle/step/crush.h"

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
/// Own forces of a shell. With half of it or twice as much a press stops at half the force or twice.
constexpr double kDiverges = 1e6;
/// s, for which a body stands. Half of it costs a closed press twice as many frames that end early; twice as much lets
/// one that was stopped by a hard contact problem stand for half a second.
constexpr double kStands = 0.25;

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

bool isDriven(const World& world, BodyId id) {
    const Body* body = findBody(world.bodies, id);
    return body != nullptr && body->driven;
}

/// Whether a motion still leads into the rods that have stopped it.
bool leadsOn(const StoppedBody& s, const Vec2& velocity, double spin) {
    return velocity.dot(s.velocity) > 0.0 || spin * s.spin > 0.0;
}

const StoppedBody* findStopped(const World& world, BodyId body) {
    const auto it =
        std::find_if(world.stopped.begin(), world.stopped.end(), [&](const StoppedBody& s) { return s.body == body; });
    return it != world.stopped.end() ? &*it : nullptr;
}

} // namespace

void addCrushed(std::vector<Crushed>& list, const std::vector<Crushed>& more) {
    for (const Crushed& c : more)
        if (std::none_of(list.begin(), list.end(),
                         [&](const Crushed& o) { return o.rod == c.rod && o.body == c.body && o.hold == c.hold; }))
            list.push_back(c);
}

bool forcesDiverge(const World& world, const TrialStep& t) {
    if (static_cast<std::size_t>(t.stage.r.size()) < 2 * t.stage.candidates.size())
        return false;
    for (std::size_t i = 0; i < t.stage.candidates.size(); ++i) {
        const rod::RodModel& m = world.rods[static_cast<std::size_t>(t.stage.work[i].rodA)].model;
        const double length = m.definition().length;
        const double own = m.mass() * world.gravity.norm() + m.definition().bendingModulus / (length * length);
        if (t.stage.r[static_cast<Eigen::Index>(2 * i)] > kDiverges * own * t.dt)
            return true;
    }
    return false;
}

void findCrushed(const World& world, const TrialStep& t, std::vector<Crushed>& out) {
    out.clear();
    if (static_cast<std::size_t>(t.stage.r.size()) < 2 * t.stage.candidates.size() || !t.stage.r.allFinite())
        return;
    Sets sets(world.rods.size() + world.bodies.size());
    const std::vector<Press> presses = collect(world, t, sets);
    const auto small = [&](double speed, std::size_t rod) {
        return speed * t.dt <= kNoMotion * world.rods[rod].model.definition().thickness;
    };
    const auto add = [&](const Crushed& c) { addCrushed(out, {c}); };
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
            add({world.rods[p.rod].key, p.body, 0, world.time, isDriven(world, p.body)});
    }
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        for (const Hold& h : world.rods[i].holds) {
            const Vec2 v = velocityOf(world, h, t.dt);
            if (!(v.norm() > 0.0) || !small(v.norm(), i))
                continue;
            for (const Press& p : presses)
                if (sets.root(p.rod) == sets.root(i) && p.impulse.dot(v) < -kPressesBack * p.impulse.norm() * v.norm())
                    add({world.rods[h.onCrosshead ? p.rod : i].key, p.body, h.onCrosshead ? 0U : h.key, world.time,
                         h.onCrosshead});
        }
}

bool endCrushing(World& world, const Settings& settings, const std::vector<Crushed>& crushed) {
    bool stops = false;
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
            stops = true;
        }
    }
    if (!crushed.empty())
        world.range.clear(); // candidates are found anew
    return stops;
}

void stopBodies(World& world, const std::vector<Crushed>& crushed) {
    for (const Crushed& c : crushed) {
        StoppedBody s;
        const Body* body = findBody(world.bodies, c.body);
        if (c.hold != 0 || (!c.crosshead && body == nullptr))
            continue;
        s.body = c.crosshead ? 0 : c.body;
        s.velocity = c.crosshead ? world.crossheadVelocity : body->state.velocity;
        s.spin = c.crosshead ? 0.0 : body->state.spin;
        s.until = world.time + kStands;
        std::erase_if(world.stopped, [&](const StoppedBody& o) { return o.body == s.body; });
        world.stopped.push_back(s);
    }
}

void endStops(World& world) {
    std::erase_if(world.stopped, [&](const StoppedBody& s) { return world.time >= s.until; });
}

bool crossheadStands(const World& world) {
    const StoppedBody* s = findStopped(world, 0);
    return s != nullptr && leadsOn(*s, world.crossheadVelocity, 0.0);
}

void standStill(const World& world, const Body& old, Body& b) {
    const StoppedBody* s = findStopped(world, b.id);
    if (s == nullptr || !leadsOn(*s, b.state.velocity, b.state.spin))
        return;
    b.state.centre = old.state.centre;
    b.state.angle = old.state.angle;
    b.state.velocity.setZero();
    b.state.spin = 0.0;
}

void stopInHost(World& world, Port& port) {
    std::erase_if(world.stopped, [&](StoppedBody& s) {
        if (s.body == 0)
            return false;
        const Body* body = findBody(world.bodies, s.body);
        BodyState now;
        const bool stands = body != nullptr && body->state.velocity.isZero(0.0) && !(std::abs(body->state.spin) > 0.0);
        if (!stands || !port.state(s.body, now))
            return true;
        if (!now.moving) // a static body that is put forward: only its copy stands
            return false;
        s.hostVelocity = now.velocity;
        s.hostSpin = now.spin;
        port.drive(s.body, body->state.centre, body->state.angle, Vec2::Zero(), 0.0);
        return false;
    });
}

void resumeInHost(const World& world, Port& port) {
    for (const StoppedBody& s : world.stopped) {
        BodyState now;
        if (s.body != 0 && port.state(s.body, now) && now.moving && now.velocity.isZero(0.0) &&
            !(std::abs(now.spin) > 0.0))
            port.drive(s.body, now.centre, now.angle, s.hostVelocity, s.hostSpin);
    }
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
