#pragma once
// What a stepper keeps between frames beside its settings (private to step/): work spaces, no state.

#include "supercircle/step/coupling/host_coupling.h"
#include "supercircle/step/islands/island.h"

#include <optional>
#include <utility>

namespace supercircle::step {

/// What is stepped through a frame: the world, or an island of it as a world of its own.
struct Stepper::Part {
    World& world;
    TrialStep& trial;
    HostReading& reading;
    const World* whole = nullptr;   ///< that the island was taken from
    Partition* partition = nullptr; ///< of that world
    const Island* island = nullptr;
    double budget = 0.0;                          ///< units; 0: no limit
    bool budgeted = true;                         ///< it ends early where the budget is used up
    std::optional<std::pair<Node, Node>> meets{}; ///< nodes that must be joined, and the frame begun again
    // While it is stepped:
    double frame = 0.0;         ///< s
    int cuts = 0, unsolved = 0; ///< in a row; of them those for a contact problem that was given up
    std::int64_t ticks = 0;     ///< of the frame, that the trial takes
    /// Whether no shorter step is tried than the trial's.
    [[nodiscard]] bool isSmallest(const Settings& settings) const;

    /// Whether rods of the island have left the reach it was made with and come into that of another one.
    [[nodiscard]] bool rodsMeetOthers();
    /// The same of its bodies; `left`: of the frame, s.
    [[nodiscard]] bool bodiesMeetOthers(double left);
};

struct Stepper::Work {
    TrialStep trial;
    const TrialStep* last = &trial; ///< whose step was tried last
    double lastDt = 0.0;
    HostReading reading;
    HostCouplingWork coupling;
    Partition partition;
    Islands islands;
};

} // namespace supercircle::step
