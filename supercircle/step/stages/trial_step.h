#pragma once
// A trial step of fixed size (private to step/): its work space, and what it returns. Stages read the world and write
// here. A rejected trial changes nothing of the world; the controller (stepper.cpp) adopts what is in TrialResult.

#include "supercircle/step/contacts/contact_rows.h"
#include "supercircle/step/rods/rod_system.h"
#include "supercircle/step/stages/work_count.h"
#include "supercircle/step/stepper.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace supercircle::step {

/// What a trial returns whether or not it is accepted.
struct TrialResult {
    Reason reason = Reason::None; ///< why it must not become the next state; None: it may
    WorkCount work;               ///< what it took
    bool outOfWork = false;       ///< it ended unfinished, because it took more than TrialStep::workLimit
    bool judged = false;          ///< it came as far as its end, so that at the smallest size it may be taken
    std::uint64_t solves = 0;     ///< contact problems
    std::uint64_t gaussSeidelIterations = 0, pivots = 0; ///< of the solver
    bool renewed = false;                                ///< `candidates` replace those of the world
    std::vector<contact::Candidate> candidates;          ///< at the start of the step, found with `range`
    std::vector<double> range;                ///< how far each rod may move before candidates must be found anew, m
    std::vector<std::size_t> sleepers;        ///< sleeping rods that somebody pressed on
    std::vector<std::size_t> runaways;        ///< rods with an element curled up to more than a circle
    std::vector<contact::Crossing> crossings; ///< found by the crossing check, if it is on
    std::vector<Overlap> overlaps;            ///< pairs that cross at the start and are not known to
};

struct SecondOrderStep;

/// Work space of trial steps; what it holds belongs to the last one.
struct TrialStep {
    double dt = 0.0;                                            ///< s
    double h = 1e-3;                                            ///< thinnest shell, m
    double workLimit = std::numeric_limits<double>::infinity(); ///< of result.work, units: beyond it the trial ends
    double solveLimit = 0.0;                                    ///< of one contact problem, units; 0: none
    double hurryAt = std::numeric_limits<double>::infinity();   ///< beyond it no further linearisation is made
    bool fullEffort = true;                                     ///< of the contact solver
    std::vector<double> lengths;                                ///< per rod: that of its pairs (lengthOf), m
    TrialResult result;
    std::vector<RodWork> rods;
    ContactStage stage;
    std::vector<double> nextRange;        ///< how far candidates reach after the step, per rod, m
    std::vector<ContactImpulse> impulses; ///< of the last solve
    std::vector<RodEnergies> energies;    ///< of the accepted trial, per rod
    std::vector<contact::Candidate> kept; ///< of the candidates those that this step needs
    bool anyFree = false;                 ///< some rods have moved freely
    std::vector<FreeGroup> groups;        ///< storage; the first groupCount may have moved freely together
    std::size_t groupCount = 0;
    const std::vector<RodWork>* aside = nullptr;  ///< stage of a step of second order: those free here stay aside
    std::shared_ptr<SecondOrderStep> secondOrder; ///< storage of second_order.h
    std::vector<const rod::Kinematics*> kin;
    std::vector<contact::RodCurve> curvesBefore;
    std::vector<contact::Outline> outlinesBefore;
    double error = 0.0;           ///< largest local error, in lengths of its rod, times h, m
    double moved = 0.0;           ///< farthest motion of a touching rod, likewise, m
    double overlapAtStart = 0.0;  ///< deepest, in lengths of its pair, times h, m
    int linearisations = 0;       ///< so far in this trial
    int widenings = 0;            ///< of the candidates' range in this trial
    double impulseScale = 1.0;    ///< of the world (world.h)
    int threads = 1;              ///< of stage.loop; 0: it is the host's
    Stage reached = Stage::Drive; ///< the last stage of this trial

    /// Candidates at the start of the step.
    [[nodiscard]] const std::vector<contact::Candidate>& candidates(const World& world) const {
        return result.renewed ? result.candidates : world.candidates;
    }
    /// Whether the trial took more than it may; it then ends unfinished.
    [[nodiscard]] bool endsForWork() {
        result.outOfWork = result.work.units() > workLimit;
        return result.outOfWork;
    }
    /// What is left for the crossing check, in its units; 0: no limit.
    [[nodiscard]] double checkWorkLeft() const {
        const double left = workLimit - result.work.units();
        return std::isfinite(left) ? std::max(1.0, left / WorkCount::kCheckUnit) : 0.0;
    }
    /// Whether the group has moved freely, and nothing that came to light since has taken it back.
    [[nodiscard]] bool isFree(const FreeGroup& g) const { return rods[g.rods.front()].isFree; }
    /// Whether `kept` are not all candidates.
    [[nodiscard]] bool selects(const Settings& settings) const { return settings.cull || anyFree; }
    [[nodiscard]] bool first() const { return linearisations == 0; }
    /// Begins a stage, which reads what `before` has left.
    void enter(Stage entered, Stage before) {
        SC_ASSERT(reached == before, "the stages of a step follow each other");
        reached = entered;
    }
    /// `length` (m) of a rod or a pair as part of the thinnest shell's: limits are given for that.
    [[nodiscard]] double relative(double length) const { return h / length; }
    /// Forgets the trial before.
    void begin(const World& world, const Settings& settings);
    /// Loops of all stages: the host's if there is one, else over `count` threads.
    void useThreads(int count, const parallel::For& hostLoop);
};

} // namespace supercircle::step
