#pragma once
// Small neighbourhoods of a large island, in which a path costs as much as in a small problem.

#include "supercircle/coulomb/strategy/mass_normalised.h"

#include <span>
#include <vector>

namespace supercircle::coulomb {

/// Contacts that may change, and contacts of the same bodies that stay fixed.
struct Subdomain {
    std::vector<std::int32_t> contacts; ///< ascending
    std::vector<std::int32_t> outside;
    std::vector<std::int32_t> core; ///< those of `contacts` far from the boundary
};

class Subdomains {
public:
    /// Lists the contacts of every body in the problem.
    void prepare(MassNormalisedProblem& problem);

    /// Grows a subdomain around contact `seed`, neighbour by neighbour, up to `most` contacts. Null if it would contain
    /// a body marked in `busy` (one entry per body, or empty).
    const Subdomain* grow(const MassNormalisedProblem& problem, std::int32_t seed, std::size_t most,
                          std::span<const std::uint8_t> busy = {});

private:
    bool growBodies(const MassNormalisedProblem& problem, std::int32_t seed, std::size_t most,
                    std::span<const std::uint8_t> busy);
    void addBody(std::int32_t body);

    std::vector<std::int32_t> bodies_;
    std::vector<std::int32_t> rank_;  ///< position of a body in bodies_, -1 if it is outside
    std::vector<std::uint8_t> taken_; ///< contacts already listed
    Subdomain subdomain_;
};

} // namespace supercircle::coulomb
