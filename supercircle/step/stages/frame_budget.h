#pragma once
// The budget of a frame (private to step/), for hosts that must show a picture every 1/60 s.
//
// Work is counted (work_count.h), accepted or not. Three things happen as it is used up:
// - at half of it (counting the two trials to come) the world or island is in a rush: the
// controller allows four times the local
//   error and four times the motion per step. Nothing else is relaxed: the contact law, the limit of penetration, the
//   crossing check;
// - no trial begins that would mostly lie beyond it, and one that grows beyond one and a half budgets is dropped. The
//   frame ends after its last accepted step (FrameResult::budgetExhausted). What is left of it is not simulated: slow
//   motion instead of wrong motion;
// - a frame without an accepted step ends after one and a half budgets and two trials. The next one goes on with
//   their smaller step, so that the motion never stops for good. A contact problem may take one budget.

#include "supercircle/step/stages/work_count.h"
#include "supercircle/step/world.h"

#include <algorithm>
#include <limits>

namespace supercircle::step {

class FrameBudget {
public:
    /// `whole` units for a world or an island; 0: no limit. `mayEnd`: the frame may end early for it.
    FrameBudget(const Settings& settings, const World& world, double whole, bool mayEnd)
        : whole_(whole), mayEnd_(mayEnd), patient_(settings), hasty_(settings) {
        hasty_.localError *= kHaste;
        hasty_.motionLimit *= kHaste;
        WorkCount first, read;
        read.outlines = static_cast<double>(world.outlines.size());
        used_ = read.units();
        for (const Rod& r : world.rods)
            first.rods += r.frozen() ? 0.0 : 1.0;
        first.contacts = static_cast<double>(std::max(world.candidates.size(), world.impulses.size()));
        last_ = first.units();
    }
    /// The settings for the next trial.
    [[nodiscard]] const Settings& settings() const { return rushes() ? hasty_ : patient_; }
    /// By how much the next step may be longer than the last one of `dt` s, for which `wanted` s were asked: steps are
    /// powers of two. A rejected trial costs a busy frame more than a short step does. With a growth of 1.2 one trial
    /// in six is made in vain, with 1.5 one in four, with 2 one in three.
    [[nodiscard]] double growth(double dt, double wanted) const {
        return rushes() ? std::clamp(1.5 * wanted / dt, 1.5, 3.0) : 2.0;
    }
    /// A trial that took so many units, accepted or not.
    void spend(double units) {
        used_ += units;
        last_ = units;
        ++trials_;
    }
    /// The last trial became the next state.
    void accept() { accepted_ = true; }
    /// Whether no further trial may begin.
    [[nodiscard]] bool exhausted() const {
        if (!limited() || !mayEnd_)
            return false;
        const double expected = used_ + 0.5 * last_;
        return accepted_ ? expected >= whole_ : expected >= kMost * whole_ && trials_ >= kFewestTrials;
    }
    /// What the next trial may take, units.
    [[nodiscard]] double trialLimit() const {
        return limited() && accepted_ && mayEnd_ ? kMost * whole_ - used_ : std::numeric_limits<double>::infinity();
    }
    /// What a contact problem may take, units; 0: no limit. Where the budget is gone it is a quarter, which its first
    /// iterations need.
    [[nodiscard]] double solveLimit() const { return std::max(whole_ - used_, 0.25 * whole_); }
    /// Work of the next trial from which on it is not linearised again: as much again would leave no second trial.
    [[nodiscard]] double hurryAt() const {
        return limited() ? (whole_ - used_) / 3.0 : std::numeric_limits<double>::infinity();
    }
    /// Whether there is no time for another trial after one of so many units.
    [[nodiscard]] bool hurries(double units) const { return limited() && used_ + units >= whole_; }
    /// By this world or island, units.
    [[nodiscard]] double used() const { return used_; }

private:
    [[nodiscard]] bool rushes() const { return limited() && used_ + 2.0 * last_ > kRush * whole_; }
    [[nodiscard]] bool limited() const { return whole_ > 0.0; }
    /// With half of it busy frames are finer and slower; with twice as much their snaps and landings are coarser than a
    /// game's own step.
    static constexpr double kHaste = 4.0;
    static constexpr double kRush = 0.5; ///< of the budget; half of it coarsens frames that fit, 1 loses whole frames
    static constexpr double kMost = 1.5; ///< budgets, as promised; 1 would drop half of the last trials
    static constexpr int kFewestTrials = 2; ///< without an accepted step; one shows more frames that stand still
    double whole_, used_ = 0.0, last_ = 0.0;
    bool mayEnd_, accepted_ = false;
    int trials_ = 0;
    Settings patient_, hasty_;
};

} // namespace supercircle::step
