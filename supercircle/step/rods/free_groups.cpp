#include "supercircle/step/rods/free_groups.h"

#include <algorithm>

namespace supercircle::step {

namespace {

/// Whether free motion can have the link: its other end moves with it, or is a place. Bodies that yield could be had as
/// blocks of their own (FreeBody), but a crate that lands on a floor of the host then brings in energy.
bool canJoin(const World& world, const Link& l, const LinkEnds& e) {
    if (l.kind == LinkKind::Tether && l.goal != l.length)
        return false;
    if (e.body < 0)
        return true;
    const Body& b = world.bodies[static_cast<std::size_t>(e.body)];
    return !b.dynamic && !b.driven && !b.asleep();
}

/// Sets of rods, and of bodies after them, that links join; the smallest member names its set.
class JoinedSets {
public:
    JoinedSets(std::vector<int>& parent, std::size_t count) : parent_(parent) {
        parent_.resize(count);
        for (std::size_t i = 0; i < count; ++i)
            parent_[i] = static_cast<int>(i);
    }
    [[nodiscard]] std::size_t of(std::size_t i) const {
        while (parent_[i] != static_cast<int>(i))
            i = static_cast<std::size_t>(parent_[i]);
        return i;
    }
    void join(std::size_t i, std::size_t k) {
        i = of(i);
        k = of(k);
        parent_[std::max(i, k)] = static_cast<int>(std::min(i, k));
    }

private:
    std::vector<int>& parent_;
};

void joinAll(const World& world, const std::vector<LinkEnds>& links, JoinedSets& sets) {
    for (const LinkEnds& e : links) {
        const auto a = static_cast<std::size_t>(e.rodA), body = static_cast<std::size_t>(e.body);
        if (e.counts && e.rodB >= 0)
            sets.join(a, static_cast<std::size_t>(e.rodB));
        if (e.counts && e.body >= 0 && world.bodies[body].dynamic)
            sets.join(a, world.rods.size() + body);
    }
}

/// A rod or a link that is not free binds its whole set.
void bindSets(const World& world, TrialStep& t, const JoinedSets& sets, std::vector<char>& free) {
    if (world.links.empty())
        return;
    for (std::size_t k = 0; k < world.links.size(); ++k)
        if (const LinkEnds& e = t.stage.links.ends[k]; e.counts && !canJoin(world, world.links[k], e))
            free[sets.of(static_cast<std::size_t>(e.rodA))] = 0;
    for (std::size_t i = 0; i < free.size(); ++i)
        if (free[i] == 0)
            free[sets.of(i)] = 0;
    for (std::size_t i = 0; i < free.size(); ++i)
        free[i] = free[sets.of(i)];
}

int addGroup(TrialStep& t) {
    if (t.groups.size() == t.groupCount)
        t.groups.emplace_back();
    FreeGroup& g = t.groups[t.groupCount];
    g.rods.clear();
    g.joints.clear();
    g.bodies.clear();
    g.tied = false;
    return static_cast<int>(t.groupCount++);
}

void addJoint(const World& world, std::size_t link, const LinkEnds& e, FreeGroup& g) {
    const auto ofGroup = [&](int rod) {
        const auto at = std::lower_bound(g.rods.begin(), g.rods.end(), static_cast<std::size_t>(rod));
        return static_cast<int>(at - g.rods.begin());
    };
    FreeJoint& j = g.joints.emplace_back();
    j.link = static_cast<int>(link);
    j.a = ofGroup(e.rodA);
    j.b = e.rodB >= 0 ? ofGroup(e.rodB) : -1;
    j.body = e.body;
    if (e.body < 0 || !world.bodies[static_cast<std::size_t>(e.body)].dynamic) {
        g.tied = g.tied || e.rodB < 0;
        return;
    }
    const auto at = std::find_if(g.bodies.begin(), g.bodies.end(), [&](const FreeBody& b) { return b.body == e.body; });
    j.freeBody = static_cast<int>(at - g.bodies.begin());
    if (at == g.bodies.end())
        g.bodies.emplace_back().body = e.body;
}

} // namespace

void listFreeGroups(const World& world, std::vector<char>& free, TrialStep& t) {
    const std::vector<LinkEnds>& links = t.stage.links.ends;
    JoinedSets sets(t.stage.host.groups, world.rods.size() + world.bodies.size());
    joinAll(world, links, sets);
    bindSets(world, t, sets, free);
    t.groupCount = 0;
    std::vector<int>& groupOf = t.stage.host.groupBlocks; // of each set
    groupOf.assign(world.rods.size(), -1);
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        if (free[i] == 0)
            continue;
        int& group = groupOf[sets.of(i)];
        if (group < 0)
            group = addGroup(t);
        FreeGroup& g = t.groups[static_cast<std::size_t>(group)];
        g.rods.push_back(i);
        g.tied = g.tied || !world.rods[i].holds.empty();
    }
    for (std::size_t k = 0; k < links.size(); ++k)
        if (const auto a = static_cast<std::size_t>(links[k].rodA); links[k].counts && free[a] != 0)
            addJoint(world, k, links[k], t.groups[static_cast<std::size_t>(groupOf[sets.of(a)])]);
}

} // namespace supercircle::step
