#include "supercircle/step/islands/island.h"

#include "supercircle/contact/feature_id.h"
#include "supercircle/step/contact_memory.h"
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

using KeyIndex = std::vector<std::pair<std::uint32_t, int>>;

void sortByKey(const World& world, KeyIndex& index) {
    index.clear();
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        index.emplace_back(world.rods[i].key, static_cast<int>(i));
    std::sort(index.begin(), index.end());
}

/// Index of a rod, -1: it is gone.
int indexOf(const KeyIndex& index, std::uint32_t key) {
    const auto it = std::lower_bound(index.begin(), index.end(), std::pair{key, -1});
    return it != index.end() && it->first == key ? it->second : -1;
}

// Key of the rod that an entry goes with.
std::uint32_t rodOf(const ContactImpulse& c) {
    return contact::keyAOf(c.id);
}
std::uint32_t rodOf(const Link& l) {
    return l.rodA;
}
std::uint32_t rodOf(const VetoedPair& v) {
    return v.rod;
}
std::uint32_t rodOf(const Overlap& o) {
    return o.rodA;
}

/// The island of a node; null: it has none.
Island* islandOf(const Partition& p, const Islands& islands, Node node) {
    const int group = p.groupOf[node];
    return group >= 0 ? islands.ofGroup[static_cast<std::size_t>(group)] : nullptr;
}

template <class T>
Island* islandOf(const Partition& p, const Islands& islands, const T& entry) {
    const int rod = indexOf(islands.byKey, rodOf(entry));
    return rod >= 0 ? islandOf(p, islands, static_cast<Node>(rod)) : nullptr;
}

/// Which rods, bodies, outlines, links and constraints of the host each island takes. `rest`: bodies that no shell may
/// meet, and all that are not dynamic.
void choose(const World& world, const Partition& p, Islands& islands, Island& rest) {
    const std::size_t rods = world.rods.size();
    const auto takeBody = [](Island& island, int body) {
        if (body >= 0)
            island.bodies.push_back(static_cast<std::size_t>(body));
    };
    for (std::size_t i = 0; i < rods; ++i)
        if (Island* island = islandOf(p, islands, i))
            island->rods.push_back(i);
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        Island* island = islandOf(p, islands, rods + i);
        (island ? *island : rest).bodies.push_back(i);
    }
    for (std::size_t i = 0; i < world.links.size(); ++i)
        if (Island* island = islandOf(p, islands, world.links[i])) {
            island->links.push_back(i);
            if (world.links[i].end == LinkEnd::Body)
                takeBody(*island, bodyIndex(world, world.links[i].body));
        }
    const auto constrain = [&](const auto& constraints, std::vector<std::size_t> Island::*out) {
        for (std::size_t i = 0; i < constraints.size(); ++i) {
            const int a = bodyIndex(world, constraints[i].a), b = bodyIndex(world, constraints[i].b);
            for (const int body : {a, b})
                if (Island* island =
                        body >= 0 ? islandOf(p, islands, rods + static_cast<std::size_t>(body)) : nullptr) {
                    (island->*out).push_back(i);
                    takeBody(*island, a);
                    takeBody(*island, b);
                    break; // both are in one group, or the other is immovable
                }
        }
    };
    constrain(world.constraints.contacts, &Island::contacts);
    constrain(world.constraints.rows, &Island::rows);
    for (std::size_t i = 0; i < world.outlines.size(); ++i) {
        const int body = bodyIndex(world, world.outlines[i].body);
        if (Island* island = islandOf(p, islands, rods + static_cast<std::size_t>(body)))
            island->outlines.push_back(i);
        if (world.bodies[static_cast<std::size_t>(body)].dynamic)
            continue;
        for (std::size_t k = 0; k < rods; ++k)
            if (Island* island = islandOf(p, islands, k);
                island && (island->outlines.empty() || island->outlines.back() != i) && meet(p.rods[k], p.pieces[i])) {
                island->outlines.push_back(i);
                takeBody(*island, body);
            }
    }
}

void fill(const World& world, const Partition& p, Island& island) {
    std::sort(island.bodies.begin(), island.bodies.end());
    island.bodies.erase(std::unique(island.bodies.begin(), island.bodies.end()), island.bodies.end());
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
    w.dt = world.dt;
    w.dtNext = firstStepOf(w);
    w.pairFriction = world.pairFriction;
    w.bodyMaterials = world.bodyMaterials;
    w.surfaceSpeeds = world.surfaceSpeeds;
    island.reading.regions.clear();
    for (const std::size_t rod : island.rods)
        island.reading.regions.push_back(p.rods[rod]);
    island.end = {};
}

/// Gives each island its entries of a list.
template <class T>
void distribute(const World& world, const Partition& p, const Islands& islands, std::vector<T> World::*list) {
    for (std::size_t k = 0; k < islands.count; ++k)
        (islands.slots[k]->world.*list).clear();
    for (const T& entry : world.*list)
        if (Island* island = islandOf(p, islands, entry))
            (island->world.*list).push_back(entry);
}

/// Takes the entries of the islands' rods back from them.
template <class T>
void collect(World& world, const Islands& islands, std::vector<T> World::*list) {
    std::erase_if(world.*list, [&](const T& entry) {
        const int rod = indexOf(islands.byKey, rodOf(entry));
        return rod < 0 || islands.marked[static_cast<std::size_t>(rod)];
    });
    for (std::size_t k = 0; k < islands.count; ++k)
        (world.*list)
            .insert((world.*list).end(), (islands.slots[k]->world.*list).begin(),
                    (islands.slots[k]->world.*list).end());
}

Island& nextSlot(Islands& islands) {
    if (islands.count == islands.slots.size())
        islands.slots.push_back(std::make_unique<Island>());
    Island& island = *islands.slots[islands.count++];
    for (std::vector<std::size_t>* list :
         {&island.rods, &island.bodies, &island.outlines, &island.contacts, &island.rows, &island.links})
        list->clear();
    return island;
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
    const auto it = std::lower_bound(world.outlines.begin(), world.outlines.end(), piece, before);
    SC_ASSERT(it != world.outlines.end() && !before(piece, *it), "an outline of the world");
    return static_cast<std::size_t>(it - world.outlines.begin());
}

/// Bodies and outlines that an island has read besides.
void addNewcomers(World& world, const Island& island) {
    const World& w = island.world;
    if (w.bodies.size() == island.bodies.size() && w.outlines.size() == island.outlines.size())
        return;
    for (const Body& b : w.bodies)
        if (bodyIndex(world, b.id) < 0) {
            const auto at = std::upper_bound(world.bodies.begin(), world.bodies.end(), b,
                                             [](const Body& x, const Body& y) { return x.id < y.id; });
            Body& added = *world.bodies.insert(at, b);
            added.force = added.impulse = Vec2::Zero(); // islands bring theirs (returnBodies)
            added.angularImpulse = 0.0;
        }
    for (const BodyOutline& o : w.outlines)
        if (!std::binary_search(world.outlines.begin(), world.outlines.end(), o, before))
            world.outlines.insert(std::upper_bound(world.outlines.begin(), world.outlines.end(), o, before), o);
}

void returnBodies(World& world, const Island& island) {
    for (const Body& b : island.world.bodies) {
        Body& to = world.bodies[static_cast<std::size_t>(bodyIndex(world, b.id))];
        if (b.dynamic) {
            to = b;
            continue;
        }
        if (island.group < 0) // immovable bodies may be in several islands, and move in one go here
            to.state = b.state;
        to.force += b.force;
        to.impulse += b.impulse;
        to.angularImpulse += b.angularImpulse;
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
            islands.ofGroup[static_cast<std::size_t>(group)] = &nextSlot(islands);
            islands.ofGroup[static_cast<std::size_t>(group)]->group = group;
        }
    Island& rest = nextSlot(islands);
    rest.group = -1;
    sortByKey(world, islands.byKey);
    choose(world, p, islands, rest);
    if (rest.bodies.empty())
        --islands.count;
    for (std::size_t k = 0; k < islands.count; ++k)
        fill(world, p, *islands.slots[k]);
    distribute(world, p, islands, &World::impulses);
    distribute(world, p, islands, &World::sleepingImpulses);
    distribute(world, p, islands, &World::overlaps);
    distribute(world, p, islands, &World::vetoes);
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
        for (std::size_t i = 0; i < island.links.size(); ++i)
            std::swap(world.links[island.links[i]], island.world.links[i]);
        for (std::size_t i = 0; i < island.contacts.size(); ++i)
            world.constraints.contacts[island.contacts[i]] = island.world.constraints.contacts[i];
        for (std::size_t i = 0; i < island.rows.size(); ++i)
            world.constraints.rows[island.rows[i]] = island.world.constraints.rows[i];
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
    sortByKey(world, islands.byKey);
    collect(world, islands, &World::impulses);
    collect(world, islands, &World::sleepingImpulses);
    collect(world, islands, &World::overlaps);
    sortById(world.impulses);
    sortById(world.sleepingImpulses);
    std::sort(world.overlaps.begin(), world.overlaps.end(),
              [](const Overlap& a, const Overlap& b) { return a.pair() < b.pair(); });
}

} // namespace supercircle::step
