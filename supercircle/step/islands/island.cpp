#include "supercircle/step/islands/island.h"

#include "supercircle/contact/feature_id.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <numeric>

namespace supercircle::step {

namespace {

/// Keeps the storage of what was in the list.
template <class T>
void add(std::vector<T>& list, std::size_t at, const T& value) {
    if (at < list.size())
        list[at] = value;
    else
        list.push_back(value);
}

template <class T>
void shrink(std::vector<T>& list, std::size_t size) {
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(size), list.end());
}

template <class T>
void takeAll(const std::vector<T>& from, const std::vector<std::size_t>& indices, std::vector<T>& to) {
    for (std::size_t k = 0; k < indices.size(); ++k)
        add(to, k, from[indices[k]]);
    shrink(to, indices.size());
}

bool inGroup(const World& world, const Partition& p, int group, BodyId id) {
    const int body = bodyIndex(world, id);
    return body >= 0 && world.bodies[static_cast<std::size_t>(body)].dynamic &&
           p.groupOf[world.rods.size() + static_cast<std::size_t>(body)] == group;
}

/// Rods, links, the host's constraints, outlines and bodies of a group.
void choose(const World& world, const Partition& p, std::vector<char>& wanted, Island& island) {
    for (std::vector<std::size_t>* list :
         {&island.rods, &island.bodies, &island.outlines, &island.contacts, &island.rows, &island.links})
        list->clear();
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        if (p.groupOf[i] == island.group)
            island.rods.push_back(i);
    wanted.assign(world.bodies.size(), 0);
    const auto want = [&](BodyId id) {
        if (const int body = bodyIndex(world, id); body >= 0)
            wanted[static_cast<std::size_t>(body)] = 1;
    };
    for (std::size_t i = 0; i < world.links.size(); ++i)
        if (const int rod = rodIndex(world, world.links[i].rodA);
            rod >= 0 && p.groupOf[static_cast<std::size_t>(rod)] == island.group) {
            island.links.push_back(i);
            if (world.links[i].end == LinkEnd::Body)
                want(world.links[i].body);
        }
    const auto constrain = [&](const auto& constraints, std::vector<std::size_t>& out) {
        for (std::size_t i = 0; i < constraints.size(); ++i)
            if (inGroup(world, p, island.group, constraints[i].a) ||
                inGroup(world, p, island.group, constraints[i].b)) {
                out.push_back(i);
                want(constraints[i].a);
                want(constraints[i].b);
            }
    };
    constrain(world.constraints.contacts, island.contacts);
    constrain(world.constraints.rows, island.rows);
    for (std::size_t i = 0; i < world.outlines.size(); ++i) {
        const BodyOutline& o = world.outlines[i];
        const Body& b = world.bodies[static_cast<std::size_t>(bodyIndex(world, o.body))];
        const bool near = b.dynamic ? inGroup(world, p, island.group, o.body)
                                    : std::any_of(island.rods.begin(), island.rods.end(),
                                                  [&](std::size_t rod) { return meet(p.rods[rod], p.pieces[i]); });
        if (!near)
            continue;
        island.outlines.push_back(i);
        want(o.body);
    }
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
        if (wanted[i] || inGroup(world, p, island.group, world.bodies[i].id))
            island.bodies.push_back(i);
}

/// Bodies that no shell may meet, and all that are not dynamic.
void chooseRest(const World& world, const Partition& p, Island& rest) {
    for (std::vector<std::size_t>* list :
         {&rest.rods, &rest.bodies, &rest.outlines, &rest.contacts, &rest.rows, &rest.links})
        list->clear();
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
        if (p.groupOf[world.rods.size() + i] < 0)
            rest.bodies.push_back(i);
}

using KeyIndex = std::vector<std::pair<std::uint32_t, int>>;

void sortByKey(const World& world, KeyIndex& index) {
    index.clear();
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        index.emplace_back(world.rods[i].key, static_cast<int>(i));
    std::sort(index.begin(), index.end());
}

/// Index of the first rod of a contact, -1: it is gone.
int firstRodOf(const KeyIndex& index, const ContactImpulse& c) {
    const std::uint32_t key = contact::keyAOf(c.id);
    const auto it = std::lower_bound(index.begin(), index.end(), std::pair{key, -1});
    return it != index.end() && it->first == key ? it->second : -1;
}

void fill(const World& world, const Partition& p, Island& island) {
    World& w = island.world;
    takeAll(world.rods, island.rods, w.rods);
    takeAll(world.bodies, island.bodies, w.bodies);
    takeAll(world.outlines, island.outlines, w.outlines);
    takeAll(world.constraints.contacts, island.contacts, w.constraints.contacts);
    takeAll(world.constraints.rows, island.rows, w.constraints.rows);
    takeAll(world.links, island.links, w.links);
    w.constraints.farthest = world.constraints.farthest;
    w.constraints.mostTurn = world.constraints.mostTurn;
    w.time = world.time;
    w.gravity = world.gravity;
    w.energyBalance = {};
    w.counters = {};
    w.candidates.clear();
    w.range.clear();
    w.impulses.clear();
    w.sleepingImpulses.clear();
    w.dt = world.dt;
    w.dtNext = firstStepOf(w);
    w.pairFriction = world.pairFriction;
    w.bodyMaterials = world.bodyMaterials;
    w.surfaceSpeeds = world.surfaceSpeeds;
    w.vetoes.clear();
    for (const VetoedPair& v : world.vetoes)
        if (rodIndex(w, v.rod) >= 0)
            w.vetoes.push_back(v);
    w.overlaps.clear();
    for (const Overlap& o : world.overlaps)
        if (rodIndex(w, o.rodA) >= 0)
            w.overlaps.push_back(o);
    w.passages.clear();
    for (const Passage& passage : world.passages)
        if (rodIndex(w, passage.rod) >= 0)
            w.passages.push_back(passage);
    island.reading.regions.clear();
    for (const std::size_t rod : island.rods)
        island.reading.regions.push_back(p.rods[rod]);
    island.end = {};
}

/// Gives each island the forces of its contacts.
void distribute(const Partition& p, const Islands& islands, const std::vector<ContactImpulse>& list,
                std::vector<ContactImpulse> World::*to) {
    for (const ContactImpulse& c : list)
        if (const int rod = firstRodOf(islands.byKey, c); rod >= 0)
            if (Island* island = islands.ofGroup[static_cast<std::size_t>(p.groupOf[static_cast<std::size_t>(rod)])])
                (island->world.*to).push_back(c);
}

Island& nextSlot(Islands& islands) {
    if (islands.count == islands.slots.size())
        islands.slots.push_back(std::make_unique<Island>());
    return *islands.slots[islands.count++];
}

void sortByWeight(Islands& islands) {
    islands.order.resize(islands.count);
    std::iota(islands.order.begin(), islands.order.end(), std::size_t{0});
    std::sort(islands.order.begin(), islands.order.end(), [&](std::size_t a, std::size_t b) {
        const std::size_t wa = islands.slots[a]->weight(), wb = islands.slots[b]->weight();
        return wa != wb ? wa > wb : a < b; // std::stable_sort would allocate
    });
}

std::size_t outlineIndex(const World& world, const BodyOutline& piece) {
    const auto order = [](const BodyOutline& a, const BodyOutline& b) {
        return a.body != b.body ? a.body < b.body : a.local.key < b.local.key;
    };
    const auto it = std::lower_bound(world.outlines.begin(), world.outlines.end(), piece, order);
    SC_ASSERT(it != world.outlines.end() && !order(piece, *it), "an outline of the world");
    return static_cast<std::size_t>(it - world.outlines.begin());
}

/// Bodies and outlines that an island has read besides.
void addNewcomers(World& world, const Island& island) {
    const World& w = island.world;
    if (w.bodies.size() == island.bodies.size() && w.outlines.size() == island.outlines.size())
        return;
    for (const Body& b : w.bodies)
        if (bodyIndex(world, b.id) < 0)
            world.bodies.insert(std::upper_bound(world.bodies.begin(), world.bodies.end(), b,
                                                 [](const Body& x, const Body& y) { return x.id < y.id; }),
                                b);
    const auto order = [](const BodyOutline& x, const BodyOutline& y) {
        return x.body != y.body ? x.body < y.body : x.local.key < y.local.key;
    };
    for (const BodyOutline& o : w.outlines)
        if (!std::binary_search(world.outlines.begin(), world.outlines.end(), o, order))
            world.outlines.insert(std::upper_bound(world.outlines.begin(), world.outlines.end(), o, order), o);
}

void returnBodies(World& world, const Island& island) {
    for (const Body& b : island.world.bodies) {
        Body& to = world.bodies[static_cast<std::size_t>(bodyIndex(world, b.id))];
        if (b.dynamic || island.group < 0) {
            const Vec2 force = to.force, impulse = to.impulse;
            const double turn = to.angularImpulse;
            to = b;
            if (!b.dynamic) {
                to.force += force;
                to.impulse += impulse;
                to.angularImpulse += turn;
            }
        } else {
            to.force += b.force;
            to.impulse += b.impulse;
            to.angularImpulse += b.angularImpulse;
        }
    }
}

/// Links with their forces. The key of one that broke becomes 0, until all islands are back.
void returnLinks(World& world, const Island& island) {
    for (const std::size_t i : island.links) {
        Link& to = world.links[i];
        const auto it = std::find_if(island.world.links.begin(), island.world.links.end(),
                                     [&](const Link& l) { return l.key == to.key; });
        if (it != island.world.links.end())
            to = *it;
        else
            to.key = 0;
    }
}

/// Candidates with the indices of the world.
void returnCandidates(World& world, const Island& island) {
    const auto rodOf = [&](std::int32_t rod) {
        return rod < 0 ? rod : static_cast<std::int32_t>(island.rods[static_cast<std::size_t>(rod)]);
    };
    for (contact::Candidate c : island.world.candidates) {
        c.a.rod = rodOf(c.a.rod);
        c.b.rod = rodOf(c.b.rod);
        if (c.outline >= 0)
            c.outline = static_cast<std::int32_t>(
                outlineIndex(world, island.world.outlines[static_cast<std::size_t>(c.outline)]));
        world.candidates.push_back(c);
    }
}

/// Pairs that cross, sorted.
void returnOverlaps(World& world, const Islands& islands) {
    std::erase_if(world.overlaps, [&](const Overlap& o) {
        const int rod = rodIndex(world, o.rodA);
        return rod < 0 || islands.marked[static_cast<std::size_t>(rod)];
    });
    for (std::size_t k = 0; k < islands.count; ++k)
        world.overlaps.insert(world.overlaps.end(), islands.slots[k]->world.overlaps.begin(),
                              islands.slots[k]->world.overlaps.end());
    std::sort(world.overlaps.begin(), world.overlaps.end(),
              [](const Overlap& a, const Overlap& b) { return a.pair() < b.pair(); });
}

void returnForces(const Islands& islands, std::vector<ContactImpulse> World::*list, std::vector<ContactImpulse>& to) {
    std::erase_if(to, [&](const ContactImpulse& c) {
        const int rod = firstRodOf(islands.byKey, c);
        return rod < 0 || islands.marked[static_cast<std::size_t>(rod)];
    });
    for (std::size_t k = 0; k < islands.count; ++k)
        to.insert(to.end(), (islands.slots[k]->world.*list).begin(), (islands.slots[k]->world.*list).end());
    std::sort(to.begin(), to.end(), [](const ContactImpulse& a, const ContactImpulse& b) { return a.id < b.id; });
}

} // namespace

double firstStepOf(const World& world) {
    double least = 0.0;
    for (const Rod& r : world.rods)
        if (r.dtNext > 0.0 && (least == 0.0 || r.dtNext < least))
            least = r.dtNext;
    return least;
}

void takeIslands(const World& world, const Partition& p, Islands& islands) {
    islands.count = 0;
    islands.ofGroup.assign(static_cast<std::size_t>(p.groups), nullptr);
    for (int group = 0; group < p.groups; ++group)
        if (!p.still[static_cast<std::size_t>(group)]) {
            Island& island = nextSlot(islands);
            island.group = group;
            choose(world, p, islands.marked, island);
            fill(world, p, island);
            islands.ofGroup[static_cast<std::size_t>(group)] = &island;
        }
    sortByKey(world, islands.byKey);
    distribute(p, islands, world.impulses, &World::impulses);
    distribute(p, islands, world.sleepingImpulses, &World::sleepingImpulses);
    if (!world.bodies.empty()) {
        Island& rest = nextSlot(islands);
        rest.group = -1;
        chooseRest(world, p, rest);
        fill(world, p, rest);
    }
    sortByWeight(islands);
}

void keepStep(World& world, const Island& island) {
    for (std::size_t i = 0; i < island.rods.size(); ++i) {
        world.rods[island.rods[i]].dtNext = island.world.rods[i].dtNext;
        world.rods[island.rods[i]].cuts = island.world.rods[i].cuts;
    }
}

void returnIslands(World& world, Islands& islands) {
    std::vector<char>& taken = islands.marked;
    taken.assign(world.rods.size(), 0);
    for (Body& b : world.bodies)
        if (!b.dynamic)
            b.force.setZero();
    world.candidates.clear();
    // Islands have looked no farther than their own reach: the next frame finds candidates anew.
    world.range.assign(world.rods.size(), -1.0);
    double least = 0.0, leastNext = 0.0;
    const auto shorter = [](double all, double one) { return all > 0.0 ? std::min(all, one) : one; };
    for (std::size_t k = 0; k < islands.count; ++k)
        addNewcomers(world, *islands.slots[k]);
    for (std::size_t k = 0; k < islands.count; ++k) {
        Island& island = *islands.slots[k];
        returnBodies(world, island);
        returnCandidates(world, island);
        for (std::size_t i = 0; i < island.rods.size(); ++i) {
            std::swap(world.rods[island.rods[i]], island.world.rods[i]);
            taken[island.rods[i]] = 1;
        }
        returnLinks(world, island);
        for (std::size_t i = 0; i < island.contacts.size(); ++i)
            world.constraints.contacts[island.contacts[i]] = island.world.constraints.contacts[i];
        for (std::size_t i = 0; i < island.rows.size(); ++i)
            world.constraints.rows[island.rows[i]] = island.world.constraints.rows[i];
        for (const Passage& passage : island.world.passages)
            if (std::find(world.passages.begin(), world.passages.end(), passage) == world.passages.end())
                world.passages.push_back(passage);
        world.energyBalance += island.world.energyBalance;
        if (island.group < 0)
            continue; // nobody's step
        world.counters += island.world.counters;
        least = shorter(least, island.world.dt);
        leastNext = shorter(leastNext, island.world.dtNext);
    }
    if (least > 0.0) {
        world.dt = least;
        world.dtNext = leastNext;
    }
    std::erase_if(world.links, [](const Link& l) { return l.key == 0; });
    returnOverlaps(world, islands);
    sortByKey(world, islands.byKey);
    returnForces(islands, &World::impulses, world.impulses);
    returnForces(islands, &World::sleepingImpulses, world.sleepingImpulses);
}

} // namespace supercircle::step
