#pragma once
// Connected components of bodies and contacts. They do not influence each other and are solved separately.

#include "supercircle/coulomb/strategy/mass_normalised.h"

#include <span>
#include <vector>

namespace supercircle::coulomb {

class Islands {
public:
    /// Contacts that move no body belong to no island. Islands are ordered by their first contact.
    void split(const MassNormalisedProblem& problem);

    std::size_t count() const { return first_.empty() ? 0 : first_.size() - 1; }
    std::span<const std::int32_t> contacts(std::size_t island) const {
        return std::span(contacts_).subspan(first_[island], first_[island + 1] - first_[island]);
    }

private:
    std::int32_t root(std::int32_t body);

    std::vector<std::int32_t> parent_;
    std::vector<std::int32_t> islandOfRoot_;
    std::vector<std::int32_t> islandOf_;
    std::vector<std::int32_t> contacts_;
    std::vector<std::size_t> first_;
};

} // namespace supercircle::coulomb
