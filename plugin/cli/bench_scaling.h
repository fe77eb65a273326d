#pragma once
// What a stack costs against its number of shells and of threads.

#include "plugin/cli/bench.h"
#include "supercircle/parallel/parallel.h"

#include <array>
#include <mutex>
#include <string>
#include <vector>

namespace supercircle::cli {

/// Plays a machine with any number of cores: runs the turns of every loop one after the other, takes their CPU times,
/// and deals them out to so many threads, each turn to the one that is free first. What is not in a loop is serial.
class VirtualThreads {
public:
    static constexpr std::array kThreads{1, 2, 4, 8, 16, 32, 64};

    /// A loop to hand to the steps; the object must outlive it.
    parallel::For loop();
    /// CPU time of all turns, s.
    [[nodiscard]] double inside() const { return inside_; }
    /// The same as kThreads[i] threads would have taken, s.
    [[nodiscard]] double makespan(std::size_t i) const { return makespan_[i]; }
    [[nodiscard]] std::size_t loops() const { return loops_; }

private:
    void deal();
    double inside_ = 0.0;
    std::array<double, kThreads.size()> makespan_{};
    std::size_t loops_ = 0;
    std::vector<double> turns_, load_;
};

/// One size: a pile made and squeezed once.
struct ScalingRow {
    int shells = 0;
    bool complete = false; ///< false: stopped before the end of the cycle
    double contacts = 0.0, loaded = 0.0;
    double dropCpu = 0.0, cycleCpu = 0.0; ///< s
    double steps = 0.0, solves = 0.0, pivots = 0.0;
    double memory = 0.0;                                           ///< MB
    std::array<double, VirtualThreads::kThreads.size()> speedUp{}; ///< of the cycle
};

std::string scalingTable(const std::vector<ScalingRow>& rows);
/// PNG; empty `error` on success.
std::string scalingPicture(const std::vector<ScalingRow>& rows, std::string& error);

} // namespace supercircle::cli
