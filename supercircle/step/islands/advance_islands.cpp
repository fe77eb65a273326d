// A frame of several islands.

#include "supercircle/step/crush.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/step/stages/stepper_workspace.h"
#include "supercircle/support/invariants.h"

#include <algorithm>

namespace supercircle::step {

bool Stepper::Part::rodsMeetOthers() {
    if (!partition)
        return false;
    for (std::size_t k = 0; k < island->rods.size() && !meets; ++k) {
        Box& reach = partition->rods[island->rods[k]];
        if (contains(reach, reading.regions[k]))
            continue;
        widen(reach, reading.regions[k]);
        if (const std::ptrdiff_t other = partition->meetsRod(*whole, island->group, reach); other >= 0)
            meets = {island->rods[k], static_cast<Node>(other)};
    }
    return meets.has_value();
}

bool Stepper::Part::bodiesMeetOthers(double left) {
    if (!partition)
        return false;
    for (std::size_t k = 0; k < island->outlines.size() && !meets; ++k) {
        const BodyOutline& piece = whole->outlines[island->outlines[k]];
        const int body = bodyIndex(world, piece.body);
        if (body < 0 || !world.bodies[static_cast<std::size_t>(body)].dynamic)
            continue;
        Box& reach = partition->pieces[island->outlines[k]];
        if (contains(reach, reachOf(world, piece, 0.0)))
            continue;
        widen(reach, reachOf(world, piece, left));
        if (const std::ptrdiff_t rod = partition->meetsBody(island->group, reach); rod >= 0)
            meets = {whole->rods.size() + static_cast<Node>(bodyIndex(*whole, piece.body)), static_cast<Node>(rod)};
    }
    return meets.has_value();
}

/// Bits as those of an island among others: candidates are found anew, immovable bodies move in one go.
FrameResult Stepper::advanceAlone(World& world, double frame, Port* port, FrameObserver& observer) {
    std::vector<BodyState>& before = work_->islands.statesBefore;
    before.clear();
    for (const Body& b : world.bodies)
        before.push_back(b.state);
    world.range.clear();
    world.candidates.clear();
    if (const double first = firstStepOf(world); first > 0.0)
        world.dtNext = first;
    Part part{world, work_->trial, work_->reading};
    part.budget = static_cast<double>(settings_.frameWork);
    FrameResult out = advancePart(part, frame, port, observer);
    if (port && out.advanced > 0.0)
        endFrame(world, out.advanced, port, times_);
    for (Body& b : world.bodies)
        if (const std::size_t i = static_cast<std::size_t>(&b - world.bodies.data());
            !b.dynamic && world.bodies.size() == before.size()) {
            b.state.centre = before[i].centre + out.advanced * b.state.velocity;
            b.state.angle = before[i].angle + out.advanced * b.state.spin;
        }
    return out;
}

FrameResult Stepper::advanceIslands(World& world, double frame, Port* port, FrameObserver& observer) {
    Work& w = *work_;
    std::vector<std::pair<Node, Node>> joined;
    double target = frame; // s, that the slowest one has come to
    FrameResult out;
    constexpr double kLeastShare = 0.02; // of the budget: half of it makes single shells late, twice as much piles
    constexpr int kMostLate = 3;         // times that the frame begins again for it, each within the budget
    observer.beginIslands();
    int late = 0;
    for (bool complete = false; !complete;) {
        complete = true;
        takeIslands(world, w.partition, w.islands);
        // What an island leaves of its share goes to those that follow.
        double left = static_cast<double>(settings_.frameWork), weights = 0.0;
        for (std::size_t k = 0; k < w.islands.count; ++k)
            weights += static_cast<double>(w.islands.slots[k]->weight());
        for (std::size_t k = 0; k < w.islands.count && complete; ++k) {
            Island& island = *w.islands.slots[w.islands.order[k]];
            Part part{island.world, island.trial, island.reading, &world, &w.partition, &island};
            const auto weight = static_cast<double>(island.weight());
            if (left > 0.0) // 0: no limit
                part.budget = std::max(left * weight / std::max(weights, 1.0),
                                       kLeastShare * static_cast<double>(settings_.frameWork));
            weights -= weight;
            part.budgeted = late <= kMostLate;
            island.end = target > 0.0 ? advancePart(part, target, port, observer) : FrameResult{};
            left = left > 0.0 ? std::max(left - island.end.work, 1.0) : 0.0;
            out.work += island.end.work;
            if (island.end.advanced <= 0.0 && island.end.budgetExhausted)
                keepStep(world, island); // the frame stands still: the next one goes on from here
            if (part.meets) {
                joined.push_back(*part.meets);
                complete = false;
            } else if (island.end.advanced < target) {       // late, it cannot go on, or something must stop
                addCrushed(out.crushed, island.end.crushed); // another round to this time does not find them
                out.budgetExhausted = out.budgetExhausted || island.end.budgetExhausted;
                if (out.failure.empty())
                    out.failure = island.end.failure;
                target = island.end.advanced;
                std::erase_if(out.crushed, [&](const Crushed& c) { return c.time > world.time + target; });
                complete = k == 0; // those before it have gone farther
                ++late;
            }
        }
        if (!complete) {
            makePartition(world, frame, joined, w.partition);
            observer.beginAgain();
        }
    }
    if (port && target > 0.0)
        for (std::size_t k = 0; k < w.islands.count; ++k)
            endFrame(w.islands.slots[k]->world, target, port, times_);
    for (std::size_t k = 0; k < w.islands.count; ++k) {
        const FrameResult& end = w.islands.slots[w.islands.order[k]]->end;
        out.gained += end.gained;
        addCrushed(out.crushed, end.crushed);
        out.broken.insert(out.broken.end(), end.broken.begin(), end.broken.end());
    }
    returnIslands(world, w.islands);
    world.time += target;
    out.advanced = target;
    return out;
}

} // namespace supercircle::step
