#pragma once
// Computes the speed-up by threads from a run on one thread.
//
// A measured speed-up on shared cores depends on other load. Here one thread does all work; every iteration of a
// parallel loop is timed and scheduled to virtual threads. Uneven iterations, short loops and serial parts count in
// full. Shared caches and memory bandwidth are neglected, so the result is an upper bound.

#include "supercircle/step/world.h"
#include "supercircle/support/parallel.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace supercircle::cli {

/// Time until the last of `threads` (1 to 64) has finished; each iteration goes to the thread that is free first.
constexpr double makespan(std::span<const double> iterations, int threads) {
    std::array<double, 64> load{};
    const auto end = load.begin() + std::min(threads, static_cast<int>(load.size()));
    for (const double time : iterations)
        *std::min_element(load.begin(), end) += time;
    return *std::max_element(load.begin(), end);
}

class VirtualThreads {
public:
    static constexpr std::array kThreads{1, 2, 4, 8, 16, 32, 64};
    /// s a loop for waking and waiting. An empty loop of TBB takes less, because its caller does all work.
    static constexpr double kWake = 5e-6;

    /// CPU time, s; `span[i]` is the time of all loops on kThreads[i] threads.
    struct Cost {
        double total = 0.0, inside = 0.0;
        std::array<double, kThreads.size()> span{};
        double loops = 0.0;

        Cost& operator+=(const Cost& other);
        [[nodiscard]] double time(std::size_t i) const {
            return total - inside + span[i] + (kThreads[i] > 1 ? kWake * loops : 0.0);
        }
    };
    /// By stage; the last entry is the time between stages.
    using Costs = std::array<Cost, static_cast<std::size_t>(step::Stage::Count) + 1>;

    VirtualThreads();
    /// A loop to hand to the steps; the object must outlive it.
    parallel::For loop();
    void enter(step::Stage stage);
    /// Up to now, without the time of the scheduling.
    const Costs& costs();
    void reset();

private:
    void schedule(double start, double end);
    Costs costs_{};
    step::Stage stage_ = step::Stage::Count;
    double since_ = 0.0; ///< CPU clock at the last record of `stage_`
    std::vector<double> iterations_;
};

} // namespace supercircle::cli
