#pragma once
// What a stack costs against its number of shells and of threads.

#include "plugin/bench/bench.h"
#include "plugin/bench/virtual_threads.h"

#include <string>
#include <vector>

namespace supercircle::cli {

/// Means over the solves of the cycle with at least 90 % of the most contacts under load.
struct FullLoad {
    double solves = 0.0, contacts = 0.0, loaded = 0.0;
    double pivots = 0.0, mostPivots = 0.0, factorisations = 0.0, sweeps = 0.0;
    double ms = 0.0;       ///< CPU time of a solve with everything around it: the cost of one linearised step
    double solverMs = 0.0; ///< of that, the Coulomb solver
    double pathOnly = 0.0; ///< share of solves that regions and paths settled without a sweep
    double unsolved = 0.0; ///< share
};

/// One size: a pile made and squeezed once.
struct ScalingRow {
    int shells = 0;
    bool complete = false;                ///< false: stopped before the end of the cycle
    std::string reached;                  ///< how far it got
    double contacts = 0.0;                ///< most at once
    double dropCpu = 0.0, cycleCpu = 0.0; ///< s
    double steps = 0.0, solves = 0.0;     ///< of the cycle, or of the drop if no cycle began
    double memory = 0.0;                  ///< peak, MB
    FullLoad full;
    VirtualThreads::Costs costs; ///< of the cycle, or of the drop if no cycle began

    [[nodiscard]] double speedUp(std::size_t i) const;
};

/// A figure as printf writes it.
std::string number(const char* format, double value);

std::string scalingTables(const std::vector<ScalingRow>& rows);
/// PNG; empty `error` on success.
std::string scalingPicture(const std::vector<ScalingRow>& rows, std::string& error);

/// Hours of work are kept: the file of a size, below the current directory.
std::string scalingFile(int shells);
std::string keepScaling(const ScalingRow& row);
bool recallScaling(int shells, ScalingRow& row);

} // namespace supercircle::cli
