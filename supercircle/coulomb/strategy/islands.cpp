#include "supercircle/coulomb/strategy/islands.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <numeric>

namespace supercircle::coulomb {

std::int32_t Islands::root(std::int32_t body) {
    SC_ASSERT_EXPENSIVE(invariants::inRange(body, parent_.size()), "a body of the problem");
    while (parent_[body] != body) {
        parent_[body] = parent_[parent_[body]];
        body = parent_[body];
    }
    return body;
}

void Islands::split(const MassNormalisedProblem& problem) {
    parent_.resize(problem.bodyCount());
    std::iota(parent_.begin(), parent_.end(), 0);
    for (const MassNormalisedProblem::Contact& contact : problem.contacts())
        if (contact.sides == 2) {
            const std::int32_t a = root(contact.side[0].body);
            const std::int32_t b = root(contact.side[1].body);
            parent_[std::max(a, b)] = std::min(a, b);
        }
    islandOfRoot_.assign(parent_.size(), -1);
    islandOf_.assign(problem.contactCount(), -1);
    first_.assign(1, 0);
    for (std::size_t c = 0; c < problem.contactCount(); ++c) {
        const MassNormalisedProblem::Contact& contact = problem.contact(c);
        if (contact.sides == 0)
            continue;
        std::int32_t& island = islandOfRoot_[root(contact.side[0].body)];
        if (island < 0) {
            island = static_cast<std::int32_t>(first_.size()) - 1;
            first_.push_back(0);
        }
        islandOf_[c] = island;
        ++first_[island + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    contacts_.resize(first_.back());
    for (std::size_t c = problem.contactCount(); c-- > 0;)
        if (islandOf_[c] >= 0)
            contacts_[--first_[islandOf_[c] + 1]] = static_cast<std::int32_t>(c);
    // Filling from the back has moved every start to that of its own island; shift the starts into place.
    for (std::size_t i = 0; i + 1 < first_.size(); ++i)
        first_[i] = first_[i + 1];
    first_.back() = contacts_.size();
    SC_ASSERT(first_.front() == 0 && contacts_.size() <= problem.contactCount(), "a contact is in one island at most");
    SC_ASSERT_EXPENSIVE(
        invariants::forAll(count(), [&](std::size_t i) { return invariants::strictlyRising(contacts(i)); }),
        "the contacts of an island are in rising order");
    SC_ASSERT_EXPENSIVE(invariants::forAll(problem.contactCount(),
                                           [&](std::size_t c) {
                                               const MassNormalisedProblem::Contact& contact = problem.contact(c);
                                               return contact.sides < 2 ||
                                                      root(contact.side[0].body) == root(contact.side[1].body);
                                           }),
                        "no contact joins two islands");
}

} // namespace supercircle::coulomb
