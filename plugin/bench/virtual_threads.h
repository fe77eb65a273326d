#pragma once
// Plays a machine with any number of cores on one thread.
//
// A benchmark machine has a few shared cores, and on those a measured speed-up says more about the neighbours than
// about the program. So one thread does everything; each loop that several threads could share is timed turn by turn
// and dealt out to imagined ones. Uneven turns, loops of too few turns and everything outside of loops count in full.
// Shared caches and memory bandwidth are left out: the result is an upper bound.

#include "supercircle/step/world.h"
#include "supercircle/support/parallel.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace supercircle::cli {

/// Time until the last of `threads` (1 to 64) has done its turns, each turn going to the one that is free first.
constexpr double makespan(std::span<const double> turns, int threads) {
    std::array<double, 64> load{};
    const auto end = load.begin() + std::min(threads, static_cast<int>(load.size()));
    for (const double turn : turns)
        *std::min_element(load.begin(), end) += turn;
    return *std::max_element(load.begin(), end);
}

class VirtualThreads {
public:
    static constexpr std::array kThreads{1, 2, 4, 8, 16, 32, 64};
    /// s a loop for waking and waiting. An empty loop of TBB takes less, because its caller does all.
    static constexpr double kWake = 5e-6;

    /// CPU time, s; `span[i]` is what the turns of loops would have taken kThreads[i] threads.
    struct Cost {
        double total = 0.0, inside = 0.0;
        std::array<double, kThreads.size()> span{};
        double loops = 0.0;

        Cost& operator+=(const Cost& other);
        [[nodiscard]] double time(std::size_t i) const {
            return total - inside + span[i] + (kThreads[i] > 1 ? kWake * loops : 0.0);
        }
    };
    /// By stage; the last one is what lies between stages.
    using Costs = std::array<Cost, static_cast<std::size_t>(step::Stage::Count) + 1>;

    VirtualThreads();
    /// A loop to hand to the steps; the object must outlive it.
    parallel::For loop();
    void enter(step::Stage stage);
    /// Up to now. The work of dealing out is not in it.
    const Costs& costs();
    void reset();

private:
    void deal(double start, double end);
    Costs costs_{};
    step::Stage stage_ = step::Stage::Count;
    double since_ = 0.0; ///< CPU clock at which `stage_` was last booked
    std::vector<double> turns_;
};

} // namespace supercircle::cli
