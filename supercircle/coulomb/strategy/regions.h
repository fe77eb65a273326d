#pragma once
// Small neighbourhoods of a large island, in which a path costs what it costs in a small problem.

#include "supercircle/coulomb/strategy/whitened.h"

#include <span>
#include <vector>

namespace supercircle::coulomb {

/// Contacts that may change, and those that act on the same bodies and stay as they are.
struct Region {
    std::vector<std::int32_t> contacts; ///< ascending
    std::vector<std::int32_t> outside;
    std::vector<std::int32_t> core; ///< those of `contacts` that lie well inside
};

class Regions {
public:
    /// Has the problem list the contacts of every body.
    void prepare(Whitened& problem);

    /// Grows a region around contact `seed`, neighbour by neighbour, until it holds `most` contacts. Null if it would
    /// hold one of the bodies marked in `busy` (one entry a body, or none).
    const Region* grow(const Whitened& problem, std::int32_t seed, std::size_t most,
                       std::span<const std::uint8_t> busy = {});

private:
    bool growBodies(const Whitened& problem, std::int32_t seed, std::size_t most, std::span<const std::uint8_t> busy);
    void addBody(std::int32_t body);

    std::vector<std::int32_t> bodies_;
    std::vector<std::int32_t> rank_;  ///< position of a body in bodies_, -1 if it is not in the region
    std::vector<std::uint8_t> taken_; ///< contacts already listed
    Region region_;
};

} // namespace supercircle::coulomb
