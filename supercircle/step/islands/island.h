#pragma once
// An island as a world of its own, and its way back (private to step/). The world it is taken from stays at the start
// of the frame until all islands have come to its end, so that a frame can begin again.

#include "supercircle/step/islands/partition.h"
#include "supercircle/step/stages/host_reading.h"
#include "supercircle/step/stages/trial_step.h"

#include <memory>

namespace supercircle::step {

struct Island {
    int group = -1; ///< of the partition; -1: bodies that no shell may meet
    World world;
    TrialStep trial;
    HostReading reading;
    /// Indices into the lists of the world it is taken from, rising.
    std::vector<std::size_t> rods, bodies, outlines, contacts, rows, links;
    FrameResult end;

    /// Work to expect, in no unit: what took long in the last frame will do so again.
    [[nodiscard]] std::size_t weight() const { return world.rods.size() + 2 * world.impulses.size(); }
};

struct Islands {
    std::vector<std::unique_ptr<Island>> slots; ///< those behind `count` are storage
    std::size_t count = 0;
    std::vector<std::size_t> order; ///< in which they are stepped
    std::vector<Island*> ofGroup;   ///< storage
    std::vector<char> marked;
    std::vector<std::pair<std::uint32_t, int>> byKey; ///< rods of the world by key
    std::vector<BodyState> statesBefore;
};

/// Size of the step that the rods want next, s; 0: not known.
[[nodiscard]] double firstStepOf(const World& world);

/// Takes out of the world the groups that are not still, and the bodies that no shell may meet as an island without
/// rods. Those that will take long come first: where the budget ends decides how far the others go.
void takeIslands(const World& world, const Partition& partition, Islands& islands);
/// Passes on to the world's rods what size of step their island wants next.
void keepStep(World& world, const Island& island);
/// Makes what the islands have become the state of the world.
void returnIslands(World& world, Islands& islands);

} // namespace supercircle::step
