#pragma once
// Cost of a stack against its number of shells and of threads.

#include "plugin/bench/bench.h"
#include "plugin/bench/virtual_threads.h"

#include <string>
#include <vector>

namespace supercircle::cli {

/// Means over the solves with at least 90 % of the largest number of active contacts.
struct FullLoad {
    double solves = 0.0, contacts = 0.0, activeContacts = 0.0;
    double pivots = 0.0, mostPivots = 0.0, factorisations = 0.0, iterations = 0.0;
    double ms = 0.0;       ///< CPU time of one linearised step, solve included
    double solverMs = 0.0; ///< of that, the Coulomb solver
    double pathOnly = 0.0; ///< fraction of solves without a Gauss-Seidel iteration
    double unsolved = 0.0; ///< fraction
};

/// One size: a pile made and squeezed once.
struct ScalingRow {
    int shells = 0;
    bool complete = false;                ///< false: stopped before the end of the cycle
    std::string reached;                  ///< phase and force at the end
    double contacts = 0.0;                ///< most at once
    double dropCpu = 0.0, cycleCpu = 0.0; ///< s
    double steps = 0.0, solves = 0.0;     ///< of the cycle, or of the drop if no cycle began
    double memory = 0.0;                  ///< peak, MB
    FullLoad full;
    VirtualThreads::Costs costs; ///< of the cycle, or of the drop if no cycle began

    [[nodiscard]] double speedUp(std::size_t i) const;
};

/// A number in a printf format.
std::string number(const char* format, double value);

std::string scalingTables(const std::vector<ScalingRow>& rows);
/// PNG; empty `error` on success.
[[nodiscard]] std::string scalingPicture(const std::vector<ScalingRow>& rows, std::string& error);

/// Results of a size are stored, because they take hours: its file below the current directory.
std::string scalingFile(int shells);
[[nodiscard]] std::string saveScaling(const ScalingRow& row);
[[nodiscard]] bool loadScaling(int shells, ScalingRow& row);

} // namespace supercircle::cli
