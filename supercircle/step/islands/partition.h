#pragma once
// Which shells and bodies may act on each other in a frame (private to step/): islands. Each is stepped by itself, with
// steps of its own size, so that what happens in one changes no bit of another.
//
// Two rods, or a rod and a dynamic body, belong together where their reaches in the frame meet (reach.h); rods that a
// link joins; bodies that a constraint of the host joins; what is in one sleeping island. Immovable bodies join nobody.
// What moves farther than its reach and comes near another island is joined with it, and the frame begins again.

#include "supercircle/step/islands/reach.h"

#include <utility>
#include <vector>

namespace supercircle::step {

/// A rod (its index) or a body (number of rods + its index).
using Node = std::size_t;

struct Partition {
    std::vector<Box> rods;          ///< reach of each rod
    std::vector<Box> pieces;        ///< reach of each outline
    std::vector<int> groupOf;       ///< per node; -1: an immovable body, or one that no shell may meet
    int groups = 0;                 ///< numbered by their first rods
    std::vector<char> still;        ///< per group: all its rods are frozen, and only sleeping bodies may touch them
    std::vector<Node> roots, order; ///< storage
    std::vector<std::pair<std::uint32_t, Node>> sleepers;

    /// All rods and all dynamic bodies are in one group, and it moves.
    [[nodiscard]] bool isOne(const World& world) const;
    /// A node outside `group` that a rod in this box may meet, -1: none. Bodies that no shell may meet count.
    [[nodiscard]] std::ptrdiff_t meetsRod(const World& world, int group, const Box& box) const;
    /// A rod outside `group` that a body in this box may meet, -1: none.
    [[nodiscard]] std::ptrdiff_t meetsBody(int group, const Box& box) const;
};

/// `joined`: nodes that belong together besides.
void makePartition(const World& world, double frame, const std::vector<std::pair<Node, Node>>& joined,
                   Partition& partition);

} // namespace supercircle::step
