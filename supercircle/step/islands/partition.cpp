#include "supercircle/step/islands/partition.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <numeric>

namespace supercircle::step {

namespace {

class Joiner {
public:
    Joiner(std::vector<Node>& roots, std::size_t nodes) : roots_(roots) {
        roots_.resize(nodes);
        std::iota(roots_.begin(), roots_.end(), Node{0});
    }
    Node root(Node i) {
        SC_ASSERT(i < roots_.size(), "a node of the world");
        while (roots_[i] != i)
            i = roots_[i] = roots_[roots_[i]];
        return i;
    }
    void join(Node a, Node b) {
        a = root(a);
        b = root(b);
        roots_[std::max(a, b)] = std::min(a, b); // a group with rods has a rod as its root
    }

private:
    std::vector<Node>& roots_;
};

bool yields(const World& world, int body) {
    return body >= 0 && world.bodies[static_cast<std::size_t>(body)].yields();
}

void joinRods(const World& world, Partition& p, Joiner& joiner) {
    std::vector<Node>& order = p.order;
    order.resize(p.rods.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return p.rods[a].lower.x() < p.rods[b].lower.x(); });
    for (std::size_t i = 0; i < order.size(); ++i) // along x: those behind begin too late to meet it
        for (std::size_t k = i + 1; k < order.size() && p.rods[order[k]].lower.x() <= p.rods[order[i]].upper.x(); ++k)
            if (meet(p.rods[order[i]], p.rods[order[k]]))
                joiner.join(order[i], order[k]);
    std::vector<std::pair<std::uint32_t, Node>>& sleepers = p.sleepers; // by their islands
    sleepers.clear();
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        if (world.rods[i].asleep())
            sleepers.emplace_back(world.rods[i].island, i);
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
        if (world.bodies[i].island != 0)
            sleepers.emplace_back(world.bodies[i].island, world.rods.size() + i);
    std::sort(sleepers.begin(), sleepers.end());
    for (std::size_t i = 1; i < sleepers.size(); ++i)
        if (sleepers[i].first == sleepers[i - 1].first)
            joiner.join(sleepers[i].second, sleepers[i - 1].second);
}

void joinBodies(const World& world, const Partition& p, Joiner& joiner) {
    const std::size_t rods = world.rods.size();
    for (std::size_t o = 0; o < world.outlines.size(); ++o) {
        const int body = bodyIndex(world, world.outlines[o].body);
        if (!yields(world, body))
            continue;
        for (std::size_t i = 0; i < rods; ++i)
            if (meet(p.rods[i], p.pieces[o]))
                joiner.join(i, rods + static_cast<std::size_t>(body));
    }
    const auto join = [&](const auto& constraint) {
        const int a = bodyIndex(world, constraint.a), b = bodyIndex(world, constraint.b);
        if (yields(world, a) && yields(world, b))
            joiner.join(rods + static_cast<std::size_t>(a), rods + static_cast<std::size_t>(b));
    };
    std::for_each(world.constraints.contacts.begin(), world.constraints.contacts.end(), join);
    std::for_each(world.constraints.rows.begin(), world.constraints.rows.end(), join);
}

void joinLinks(const World& world, Joiner& joiner) {
    for (const Link& l : world.links) {
        const int a = rodIndex(world, l.rodA);
        if (a < 0)
            continue;
        if (const int b = l.end == LinkEnd::Rod ? rodIndex(world, l.rodB) : -1; b >= 0)
            joiner.join(static_cast<Node>(a), static_cast<Node>(b));
        if (const int b = l.end == LinkEnd::Body ? bodyIndex(world, l.body) : -1; yields(world, b))
            joiner.join(static_cast<Node>(a), world.rods.size() + static_cast<Node>(b));
    }
}

} // namespace

void makePartition(const World& world, double frame, const std::vector<std::pair<Node, Node>>& joined, Partition& p) {
    const std::size_t rods = world.rods.size(), nodes = rods + world.bodies.size();
    p.rods.clear();
    for (const Rod& r : world.rods)
        p.rods.push_back(reachOf(world, r, r.kin, r.speed, frame));
    p.pieces.clear();
    for (const BodyOutline& o : world.outlines)
        p.pieces.push_back(reachOf(world, o, frame));
    Joiner joiner(p.roots, nodes);
    joinRods(world, p, joiner);
    joinBodies(world, p, joiner);
    joinLinks(world, joiner);
    for (const auto& [a, b] : joined)
        joiner.join(a, b);
    p.groupOf.assign(nodes, -1);
    p.groups = 0;
    p.still.clear();
    for (Node i = 0; i < nodes; ++i) {
        const Node root = joiner.root(i);
        if (root == i && i < rods) {
            p.groupOf[i] = p.groups++;
            p.still.push_back(1);
        }
        if (root < rods)
            p.groupOf[i] = p.groupOf[root];
        const bool moves = i < rods ? !world.rods[i].frozen() : !world.bodies[i - rods].asleep();
        if (p.groupOf[i] >= 0 && moves)
            p.still[static_cast<std::size_t>(p.groupOf[i])] = 0;
    }
    SC_ASSERT(p.groups <= static_cast<int>(rods), "a group has a rod");
}

bool Partition::isOne(const World& world) const {
    if (groups != 1 || still.front())
        return false;
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
        if (world.bodies[i].dynamic && groupOf[rods.size() + i] != 0)
            return false;
    return true;
}

std::ptrdiff_t Partition::meetsRod(const World& world, int group, const Box& box) const {
    if (const std::ptrdiff_t rod = meetsBody(group, box); rod >= 0)
        return rod;
    for (std::size_t o = 0; o < pieces.size(); ++o) {
        const int body = bodyIndex(world, world.outlines[o].body);
        const std::size_t node = rods.size() + static_cast<std::size_t>(body);
        if (yields(world, body) && groupOf[node] != group && meet(pieces[o], box))
            return static_cast<std::ptrdiff_t>(node);
    }
    return -1;
}

std::ptrdiff_t Partition::meetsBody(int group, const Box& box) const {
    for (std::size_t i = 0; i < rods.size(); ++i)
        if (groupOf[i] != group && meet(rods[i], box))
            return static_cast<std::ptrdiff_t>(i);
    return -1;
}

} // namespace supercircle::step
