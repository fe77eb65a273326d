#include "supercircle/coulomb/strategy/regions.h"

#include <algorithm>

namespace supercircle::coulomb {

void Regions::prepare(Whitened& problem) {
    problem.listContacts();
    rank_.assign(problem.bodyCount(), -1);
    taken_.assign(problem.contactCount(), 0);
    bodies_.clear();
}

void Regions::addBody(std::int32_t body) {
    if (rank_[body] >= 0)
        return;
    rank_[body] = static_cast<std::int32_t>(bodies_.size());
    bodies_.push_back(body);
}

/// False if a busy body was met.
bool Regions::growBodies(const Whitened& problem, std::int32_t seed, std::size_t most,
                         std::span<const std::uint8_t> busy) {
    for (const std::int32_t b : bodies_)
        rank_[b] = -1;
    bodies_.clear();
    std::size_t touching = 0; // counts inner contacts twice, which is near enough
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
            const Whitened::Contact& contact = problem.contact(at / 2);
            for (std::int32_t s = 0; s < contact.sides; ++s)
                if (const std::int32_t b = contact.side[s].body; rank_[b] < 0 && touching < 2 * most)
                    if (!take(b))
                        return false;
        }
    return true;
}

const Region* Regions::grow(const Whitened& problem, std::int32_t seed, std::size_t most,
                            std::span<const std::uint8_t> busy) {
    if (!growBodies(problem, seed, most, busy))
        return nullptr;
    region_.contacts.clear();
    region_.outside.clear();
    region_.core.clear();
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
            (inside ? region_.contacts : region_.outside).push_back(c);
            if (inside && (low <= inner || c == seed))
                region_.core.push_back(c);
        }
    for (const std::int32_t c : region_.contacts)
        taken_[c] = 0;
    for (const std::int32_t c : region_.outside)
        taken_[c] = 0;
    std::sort(region_.contacts.begin(), region_.contacts.end());
    return &region_;
}

} // namespace supercircle::coulomb
