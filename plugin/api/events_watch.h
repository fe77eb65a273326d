#pragma once
// Sees the shells touch, snap and fall out while a frame runs (private to shells/); what it says is in events.hpp.
//
// A pair of shells, not a contact of features, begins and ends to touch: the features that carry a nested pair change
// from step to step. Snap-fits are told per shell from its elastic energy. What was considered: drops of a machine's
// force (plugin/lab/session keeps them for its curves) need a machine and cannot say who snapped; bursts of kinetic
// energy are set off by every impact; a fall of elastic energy alone by every vibration. Lower envelopes do it:
// vibration about an equilibrium comes back to the same minimum each half period, so energy below the minimum of the
// last 0.6 T (four half periods of the slowest mode) is news, and slow unloading does not release enough within 0.1 T.

#include "plugin/api/include/supercircle/events.hpp"
#include "supercircle/step/stepper.h"

#include <array>
#include <compare>

namespace supercircle {

/// Who touches whom, by what stays the same: keys of rods, ids of bodies.
struct TouchPair {
    std::uint32_t a = 0;   ///< key of a rod; of two the smaller one
    std::uint32_t b = 0;   ///< key of a rod, 0: a body
    step::BodyId body = 0; ///< 0: a rod
    friend auto operator<=>(const TouchPair&, const TouchPair&) = default;
};

/// A pair in touch.
struct TouchState {
    TouchPair pair;
    Touch last; ///< where it last carried force
};

/// One shell's elastic energy over the recent past.
struct SnapState {
    static constexpr int kShort = 4;                ///< buckets of "a short time"
    static constexpr int kLong = 6 * kShort;        ///< buckets before it
    static constexpr int kBuckets = kShort + kLong; ///< all that are looked at
    std::uint32_t key = 0;                          ///< of the rod
    std::array<double, kBuckets> lowest{};          ///< elastic energy per bucket, ring, J
    std::int64_t bucket = 0;                        ///< running number of the current one
    std::int64_t filled = 0;                        ///< buckets known, the current one included
    double time = 0.0, energy = 0.0;                ///< last sample
    bool snapping = false;
    double begun = 0.0, before = 0.0, low = 0.0, lowTime = 0.0, kineticPeak = 0.0; ///< of the snap under way
};

/// The part of a watch that belongs to the state of the world.
struct WatchState {
    EventSettings settings;
    std::vector<TouchState> touching;       ///< sorted by pair
    std::vector<SnapState> snaps;           ///< in the order of the rods
    std::vector<std::uint32_t> quarantined; ///< keys known to be
};

class Watch {
public:
    using HandleOf = std::function<ShellHandle(std::uint32_t)>;

    WatchState state;
    FrameEvents events;

    /// Before the frame's first step.
    void begin(const step::World& world);
    /// After each accepted step, before anybody else may change the world.
    void afterStep(const step::World& world, const step::Stepper& stepper, const HandleOf& handleOf);
    /// After the frame's last step.
    void end(const step::World& world, const HandleOf& handleOf);
    /// Takes down what the next step starts from.
    void remember(const step::World& world);

private:
    struct Load {
        TouchPair pair;
        std::size_t contact = 0; ///< index of the candidate
        double normal = 0.0;     ///< N s
        double tangent = 0.0;
    };
    /// What a pair exchanged in this frame.
    struct Exchange {
        ImpulseEvent event;
        TouchPair pair;
        double strongest = 0.0; ///< N s in one step
    };
    void gather(const step::World& world, const step::Stepper& stepper);
    void touch(const step::World& world, const step::Stepper& stepper, const HandleOf& handleOf);
    void part(const step::World& world);
    void exchange(const Touch& at, const TouchPair& pair, double time, double normal, double tangent, double dt);
    void snap(const step::World& world, const HandleOf& handleOf);
    void sample(SnapState& s, const step::Rod& rod, double time, const HandleOf& handleOf);
    [[nodiscard]] const contact::Candidate& atEnd(const step::World& world, const contact::Candidate& c) const;
    [[nodiscard]] double approachSpeed(const step::World& world, const contact::Candidate& c) const;

    std::vector<Load> loads_;                                 ///< of this step, sorted by pair
    std::vector<std::pair<std::uint64_t, std::size_t>> byId_; ///< candidates after the step, sorted
    std::vector<Exchange> exchanges_;
    std::vector<Eigen::VectorXd> velocities_;          ///< of the rods before the step
    std::vector<std::uint32_t> quarantinedNow_;        ///< keys
    std::vector<step::BodyState> bodies_;              ///< before the step
    std::vector<std::pair<TouchPair, bool>> unloaded_; ///< pairs in touch without force; still near?
};

} // namespace supercircle
