#include "supercircle/coulomb/strategy/subdomains.h"

#include "supercircle/support/invariants.h"

#include <algorithm>

namespace supercircle::coulomb {

void Subdomains::prepare(MassNormalisedProblem& problem) {
    problem.listContacts();
    rank_.assign(problem.bodyCount(), -1);
    taken_.assign(problem.contactCount(), 0);
    bodies_.clear();
}

void Subdomains::addBody(std::int32_t body) {
    if (rank_[body] >= 0)
        return;
    rank_[body] = static_cast<std::int32_t>(bodies_.size());
    bodies_.push_back(body);
}

/// Returns false if it met a busy body.
bool Subdomains::growBodies(const MassNormalisedProblem& problem, std::int32_t seed, std::size_t most,
                            std::span<const std::uint8_t> busy) {
    for (const std::int32_t b : bodies_)
        rank_[b] = -1;
    bodies_.clear();
    std::size_t touching = 0; // counts inner contacts twice; an estimate is sufficient
    const auto take = [&](std::int32_t body) {
        addBody(body);
        touching += problem.sidesOf(static_cast<std::size_t>(body)).size();
        return busy.empty() || busy[body] == 0;
    };
    for (std::int32_t s = 0; s < problem.contact(seed).sides; ++s)
        if (!take(problem.contact(seed).side[s].body))
            return false;
    for (std::size_t head = 0; head < bodies_.size() && touching < 2 * most; ++head)
        for (const std::int32_t at : problem.sidesOf(static_cast<std::size_t>(bodies_[head]))) {
            const MassNormalisedProblem::Contact& contact = problem.contact(at / 2);
            for (std::int32_t s = 0; s < contact.sides; ++s)
                if (const std::int32_t b = contact.side[s].body; rank_[b] < 0 && touching < 2 * most)
                    if (!take(b))
                        return false;
        }
    return true;
}

const Subdomain* Subdomains::grow(const MassNormalisedProblem& problem, std::int32_t seed, std::size_t most,
                                  std::span<const std::uint8_t> busy) {
    SC_ASSERT(invariants::inRange(seed, taken_.size()) && taken_.size() == problem.contactCount(),
              "prepared for this problem");
    SC_ASSERT(most > 0 && problem.contact(seed).sides > 0, "a subdomain holds its seed, which moves a body");
    SC_ASSERT(busy.empty() || busy.size() == problem.bodyCount(), "one mark a body");
    if (!growBodies(problem, seed, most, busy))
        return nullptr;
    subdomain_.contacts.clear();
    subdomain_.outside.clear();
    subdomain_.core.clear();
    const auto inner = static_cast<std::int32_t>(bodies_.size() / 2);
    for (const std::int32_t body : bodies_)
        for (const std::int32_t at : problem.sidesOf(static_cast<std::size_t>(body))) {
            const std::int32_t c = at / 2;
            if (taken_[c])
                continue;
            taken_[c] = 1;
            std::int32_t low = rank_[body];
            bool inside = true;
            for (std::int32_t s = 0; s < problem.contact(c).sides; ++s) {
                const std::int32_t rank = rank_[problem.contact(c).side[s].body];
                inside = inside && rank >= 0;
                low = std::min(low, rank);
            }
            (inside ? subdomain_.contacts : subdomain_.outside).push_back(c);
            if (inside && (low <= inner || c == seed))
                subdomain_.core.push_back(c);
        }
    for (const std::int32_t c : subdomain_.contacts)
        taken_[c] = 0;
    for (const std::int32_t c : subdomain_.outside)
        taken_[c] = 0;
    std::sort(subdomain_.contacts.begin(), subdomain_.contacts.end());
    SC_ASSERT(std::binary_search(subdomain_.contacts.begin(), subdomain_.contacts.end(), seed),
              "a subdomain holds its seed");
    SC_ASSERT(subdomain_.core.size() <= subdomain_.contacts.size(), "the core is a part of the subdomain");
    SC_ASSERT_EXPENSIVE(invariants::strictlyRising(subdomain_.contacts), "every contact is listed once");
    SC_ASSERT_EXPENSIVE(std::none_of(subdomain_.outside.begin(), subdomain_.outside.end(),
                                     [this](std::int32_t c) {
                                         return std::binary_search(subdomain_.contacts.begin(),
                                                                   subdomain_.contacts.end(), c);
                                     }),
                        "a contact is inside or outside");
    return &subdomain_;
}

} // namespace supercircle::coulomb
