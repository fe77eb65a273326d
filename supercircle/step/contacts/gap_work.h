#pragma once
// Gaps of a frame whose closing takes much work: which of them close, and by how much (private to step/; gap_energy.h
// decides).

#include "supercircle/step/world.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace supercircle::step {

/// Some overlaps by the ids of their contacts, gaps of joints by their keys, and bodies that close up to their
/// originals by their ids, each sorted.
struct GapSet {
    std::vector<std::uint64_t> contacts;
    std::vector<std::uint32_t> links;
    std::vector<BodyId> bodies;
    [[nodiscard]] bool contact(std::uint64_t id) const { return has(contacts, id); }
    [[nodiscard]] bool link(std::uint32_t key) const { return has(links, key); }
    [[nodiscard]] bool body(BodyId id) const { return has(bodies, id); }
    [[nodiscard]] bool any() const { return !contacts.empty() || !links.empty() || !bodies.empty(); }

private:
    template <class Key>
    [[nodiscard]] static bool has(const std::vector<Key>& sorted, Key key) {
        return !sorted.empty() && std::binary_search(sorted.begin(), sorted.end(), key);
    }
};

/// A body's way to its original that waits.
struct WaitingDrift {
    BodyId body = 0;
    Vec2 velocity = Vec2::Zero(); ///< m/s
    double spin = 0.0;            ///< rad/s
};

/// Gaps of a frame whose closing takes much work (gap_energy.h).
struct GapWork {
    GapSet suspects; ///< stay open in this trial: it is not known yet why they take work
    GapSet slowed;   ///< close by a share in this step
    GapSet waiting;  ///< stay open
    GapSet lawful;   ///< close against forces that are there anyway
    std::vector<WaitingDrift> drifts;
    double share = 0.0;       ///< of slowed gaps
    double power = 0.0;       ///< that the suspects would take, W
    double allowed = 0.0;     ///< to them besides, J
    bool acquitted = false;   ///< the trial is one again whose gaps were found to be lawful
    double lawfulPower = 0.0; ///< that lawful gaps may take, W
    double lawfulWork = 0.0;  ///< that they took within it so far, J
    /// How much of its closing a gap may make: 1 as a rule.
    [[nodiscard]] double shareOfContact(std::uint64_t id) const {
        return suspects.contact(id) || waiting.contact(id) ? 0.0 : slowed.contact(id) ? share : 1.0;
    }
    [[nodiscard]] double shareOfLink(std::uint32_t key) const {
        return suspects.link(key) || waiting.link(key) ? 0.0 : slowed.link(key) ? share : 1.0;
    }
    [[nodiscard]] double shareOfBody(BodyId id) const {
        return suspects.body(id) || waiting.body(id) ? 0.0 : slowed.body(id) ? share : 1.0;
    }
    [[nodiscard]] bool any() const { return suspects.any() || slowed.any() || waiting.any(); }
};

} // namespace supercircle::step
