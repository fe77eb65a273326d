#pragma once
// Detects contact, impulse, snap, hold, quarantine and overlap events while a frame runs (private to plugin/api);
// events.hpp defines them.
//
// Contact events belong to a pair of shells, not to a contact point: the points that carry a nested pair change from
// step to step. Snaps are detected per shell from its elastic energy, compared with its minimum over a longer time
// before. Vibration about an equilibrium returns to the same minimum each half period; slow unloading releases too
// little within the short time (decision 0140).

#include "plugin/api/include/supercircle/events.hpp"
#include "supercircle/step/stepper.h"

#include <array>
#include <compare>

namespace supercircle {

/// Two shells, or a shell and a body, by persistent numbers: keys of rods, ids of bodies.
struct ContactPair {
    std::uint32_t a = 0;   ///< key of a rod; of two the smaller one
    std::uint32_t b = 0;   ///< key of a rod, 0: a body
    step::BodyId body = 0; ///< 0: a rod
    friend auto operator<=>(const ContactPair&, const ContactPair&) = default;
};

/// A pair in contact.
struct ContactPairState {
    ContactPair pair;
    ContactPoint last; ///< where it last carried force
};

/// Elastic energy of one shell over the recent past: minima over buckets of equal duration.
struct SnapState {
    static constexpr int kShort = 4;                ///< buckets of the short time
    static constexpr int kLong = 6 * kShort;        ///< buckets of the longer time before
    static constexpr int kBuckets = kShort + kLong; ///< in the ring
    std::uint32_t key = 0;                          ///< of the rod
    std::array<double, kBuckets> lowest{};          ///< elastic energy per bucket, ring, J
    std::int64_t bucket = 0;                        ///< number of the current bucket since time 0
    std::int64_t filled = 0;                        ///< buckets with a value, the current one included
    double time = 0.0, energy = 0.0;                ///< last sample
    bool snapping = false;
    double begun = 0.0, energyBefore = 0.0, minimum = 0.0, minimumTime = 0.0,
           kineticPeak = 0.0; ///< of the present snap
};

/// The part of a detector that belongs to the saved state.
struct EventDetectorState {
    EventSettings settings;
    std::vector<ContactPairState> pairs;    ///< sorted by pair
    std::vector<SnapState> snaps;           ///< in the order of the rods
    std::vector<std::uint32_t> quarantined; ///< keys of rods
    std::vector<ContactPair> overlapping;   ///< sorted
};

class EventDetector {
public:
    using HandleOf = std::function<ShellHandle(std::uint32_t)>;

    EventDetectorState state;
    FrameEvents events;

    /// Before the frame's first step.
    void begin(const step::World& world);
    /// After each accepted step, before the observer is called. `world` may be an island, which the pairs and snaps of
    /// other shells are left out of.
    void afterStep(const step::World& world, const step::Stepper& stepper, const HandleOf& handleOf);
    /// Keeps all that was detected, until forget() goes back to it.
    void keep();
    void forget();
    /// After the frame's last step.
    void end(const step::World& world, const HandleOf& handleOf);
    /// Records the velocities at the start of the next step.
    void recordStart(const step::World& world);

private:
    struct ActiveContact {
        ContactPair pair;
        std::size_t contact = 0; ///< index of the candidate
        double normal = 0.0;     ///< N s
        double tangent = 0.0;
    };
    /// Impulse of a pair in this frame.
    struct PairImpulse {
        ImpulseEvent event;
        ContactPair pair;
        double largestStep = 0.0; ///< largest normal impulse of one step, N s
    };
    void collectActiveContacts(const step::World& world, const step::Stepper& stepper);
    void updateContacts(const step::World& world, const step::Stepper& stepper, const HandleOf& handleOf);
    void findSeparations(const step::World& world);
    void addImpulse(const ContactPoint& at, const ContactPair& pair, double time, double normal, double tangent,
                    double dt);
    void matchSnaps(const step::World& world);
    void updateOverlaps(const step::World& world, const HandleOf& handleOf);
    void updateSnaps(const step::World& world, const HandleOf& handleOf);
    void sampleEnergy(SnapState& s, const step::Rod& rod, double time, const HandleOf& handleOf);
    [[nodiscard]] const contact::Candidate& atEnd(const step::World& world, const contact::Candidate& c) const;
    [[nodiscard]] double approachSpeed(const step::World& world, const contact::Candidate& c) const;

    std::vector<ActiveContact> activeContacts_;               ///< of this step, sorted by pair
    std::vector<std::pair<std::uint64_t, std::size_t>> byId_; ///< candidates after the step, sorted
    std::vector<PairImpulse> pairImpulses_;
    std::vector<Eigen::VectorXd> velocities_;                   ///< of the rods before the step
    std::vector<std::uint32_t> quarantinedNow_;                 ///< keys
    double frameStart_ = 0.0;                                   ///< s
    std::vector<step::BodyState> bodies_;                       ///< before the step
    std::vector<std::pair<ContactPair, bool>> unloaded_;        ///< pairs without force; still within the gap?
    std::vector<std::pair<std::uint32_t, std::size_t>> snapOf_; ///< key of a rod, index of its SnapState, sorted
    EventDetectorState keptState_;
    FrameEvents keptEvents_;
    std::vector<ContactPair> overlappingNow_; ///< sorted
};

/// Since when and why a rod is quarantined.
QuarantineEvent quarantineOf(const step::Rod& rod, const EventDetector::HandleOf& handleOf);

} // namespace supercircle
