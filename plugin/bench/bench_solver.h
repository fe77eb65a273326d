#pragma once
// The solver benchmark: contact problems of simulated stacks, every method, two tolerances; table and picture.

#include "plugin/bench/bench.h"
#include "supercircle/coulomb/solver.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::cli {

/// Problems of one kind and size with their warm starts.
struct SolverSet {
    std::string kind; ///< "nest": squeezed with 3 to 5 N; "pile": under its own weight
    int shells = 0;
    std::vector<coulomb::Problem> problems;
};

/// `copies` stacks side by side, made of `stacks` (one after the other, again from the first), as one problem: shells
/// of neighbouring stacks touch at `links` random places, half of them with a gap. All must have the same time step,
/// which is that of the first. Depends on its arguments only.
coulomb::Problem rowOfStacks(const std::vector<coulomb::Problem>& stacks, int copies, int links, std::uint64_t seed);

/// Parts of the name of a measurement, such as "solver/nest/30/strategy/1e-06".
struct SolverRow {
    std::string kind, solver, tolerance;
    int shells = 0;
    double contacts = 0.0, active = 0.0;
    double median = 0.0;  ///< ms of CPU
    double reached = 0.0; ///< fraction of the problems that met the tolerance
};
[[nodiscard]] std::optional<SolverRow> solverRow(const Measurement& m);

/// One line a set, one column a solver, as Markdown.
std::string solverTable(const std::vector<SolverRow>& rows);
/// Time against contacts, log-log, a panel for each kind and tolerance, as a PNG file. Empty `error` on success.
[[nodiscard]] std::string solverPicture(const std::vector<SolverRow>& rows, std::string& error);

} // namespace supercircle::cli
