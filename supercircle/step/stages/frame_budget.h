#pragma once
// The budget of a frame (private to step/), for hosts that must show a picture every 1/60 s.
//
// Work is counted, not timed: a result must not depend on how busy the machine is. One linearisation costs one unit per
// contact and four per rod that is awake, about 3 us each. Two things happen as it is used up:
// - at a quarter of it (counting the two steps to come) an island is in a rush, at half of it all islands that follow:
//   the controller allows four times the local error and four times the motion per step. Nothing else is relaxed: the
//   contact law, the limit of penetration, the crossing check;
// - at all of it the frame ends early, after a whole accepted step (FrameResult::late). What is left of the frame is
//   not simulated: slow motion instead of wrong motion.

#include "supercircle/step/world.h"

namespace supercircle::step {

class FrameBudget {
public:
    /// Of a world or an island; `spent`: by other islands of the frame.
    FrameBudget(const Settings& settings, const World& world, std::uint64_t spent)
        : whole_(settings.frameWork), spent_(spent), coming_(2 * unitsOf(world, world.impulses.size())),
          patient_(settings), hasty_(settings) {
        hasty_.localError *= kHaste;
        hasty_.motionLimit *= kHaste;
    }
    /// The settings for the next attempt.
    [[nodiscard]] const Settings& settings() const {
        const bool rush = used_ + coming_ > whole_ / 4 || spent_ + used_ + coming_ > whole_ / 2;
        return whole_ > 0 && rush ? hasty_ : patient_;
    }
    void spend(const World& world, std::uint64_t contactsSolved, std::uint64_t solves) {
        used_ += contactsSolved + solves * unitsOf(world, 0);
    }
    [[nodiscard]] bool usedUp() const { return whole_ > 0 && spent_ + used_ >= whole_; }
    /// By this world or island, units.
    [[nodiscard]] std::uint64_t used() const { return used_; }

private:
    static constexpr double kHaste = 4.0;
    static std::uint64_t unitsOf(const World& world, std::uint64_t contacts) {
        std::uint64_t awake = 0;
        for (const Rod& r : world.rods)
            awake += r.frozen() ? 0 : 1;
        return 4 * awake + contacts;
    }
    std::uint64_t whole_, spent_, used_ = 0, coming_;
    Settings patient_, hasty_;
};

} // namespace supercircle::step
