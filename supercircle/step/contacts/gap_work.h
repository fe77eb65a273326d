#pragma once
// Gaps of a frame whose closing takes much work: which of them close, and by how much (private to step/; gap_energy.h
// decides).

#include "supercircle/step/world.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace supercircle::step {

/// Penetrations by the ids of their contacts, gaps of joints by the keys of their links, and by their ids bodies whose
/// copies close up to the host's originals (HostCoupling::drift). Each list is sorted.
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

/// The way of a body's copy to the host's original that waits or is slowed: its velocity before that.
struct WaitingDrift {
    BodyId body = 0;
    Vec2 velocity = Vec2::Zero(); ///< m/s
    double spin = 0.0;            ///< rad/s
};

/// Gaps of a frame whose closing takes much work (gap_energy.h).
struct GapWork {
    GapSet suspects;                  ///< stay open in this trial: it is not known yet why they take work
    GapSet slowed;                    ///< close by a share in this step
    GapSet waiting;                   ///< stay open
    GapSet lawful;                    ///< close against forces that are there anyway
    std::vector<WaitingDrift> drifts; ///< of the bodies among them
    double share = 0.0;               ///< of its closing that a slowed gap makes, 0 to 1
    double power = 0.0;               ///< that all gaps took in the trial that made some of them suspects, W
    double allowed = 0.0;             ///< to the suspects beyond the work of the force they carry while open, J
    bool acquitted = false;           ///< this trial repeats one whose suspects were found to be lawful or were slowed
    double lawfulPower = 0.0;         ///< that lawful gaps may take, W
    double lawfulWork = 0.0;          ///< of that, what they took in the accepted steps of this frame, J
    /// How much of its closing a gap may make, 0 to 1: 1 as a rule.
    [[nodiscard]] double shareOfContact(std::uint64_t id) const {
        return suspects.contact(id) || waiting.contact(id) ? 0.0 : slowed.contact(id) ? share : 1.0;
    }
    [[nodiscard]] double shareOfLink(std::uint32_t key) const {
        return suspects.link(key) || waiting.link(key) ? 0.0 : slowed.link(key) ? share : 1.0;
    }
    [[nodiscard]] double shareOfBody(BodyId id) const {
        return suspects.body(id) || waiting.body(id) ? 0.0 : slowed.body(id) ? share : 1.0;
    }
    /// Whether a gap does not close as fast as it could.
    [[nodiscard]] bool any() const { return suspects.any() || slowed.any() || waiting.any(); }
};

} // namespace supercircle::step
