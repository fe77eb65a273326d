#pragma once
// One attempt at a step of fixed size (private to step/): stages collide to solve, repeated until the gaps hold.

#include "supercircle/step/stages/contact_stage.h"
#include "supercircle/step/stages/rod_stage.h"
#include "supercircle/step/stepper.h"

#include <chrono>

namespace supercircle::step {

/// Adds the wall time of its life to one stage.
class StageTimer {
public:
    StageTimer(StageTimes& times, Stage stage)
        : times_(times), stage_(stage), start_(std::chrono::steady_clock::now()) {
        if (times_.onStage)
            times_.onStage(stage_);
    }
    ~StageTimer() {
        times_[static_cast<std::size_t>(stage_)] +=
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        if (times_.onStage)
            times_.onStage(Stage::Count);
    }
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

private:
    StageTimes& times_;
    Stage stage_;
    std::chrono::steady_clock::time_point start_;
};

enum class Verdict : std::uint8_t {
    Accept,
    Smaller, ///< not acceptable at this size: cut the step and try again
    Woken    ///< somebody pressed on a sleeper, who is awake now: try again
};

/// Work space of attempts; what it holds after `solve` belongs to the last attempt.
struct Attempt {
    double dt = 0.0; ///< s
    double h = 1e-3; ///< thinnest shell, m
    std::vector<RodWork> rods;
    ContactStage stage;
    std::vector<double> nextRange;        ///< how far candidates reach after the step, per rod, m
    std::vector<ContactImpulse> impulses; ///< of the last solve
    std::vector<RodBooks> books;          ///< of the accepted attempt, per rod
    std::vector<contact::Candidate> kept; ///< of the world's candidates those this step needs (Settings::prune)
    std::vector<const rod::Kinematics*> kin;
    std::vector<contact::Curve> curvesBefore;
    std::vector<contact::Outline> outlinesBefore;
    std::vector<contact::Crossing> crossings; ///< found by the witness on the way, if it is on
    double error = 0.0;                       ///< largest local error, m
    double moved = 0.0;                       ///< farthest motion of a touching rod, m
    std::vector<std::size_t> runaways;        ///< rods faster than sound in their own material
    bool rejectedBeforeEnd = true;            ///< the last attempt was given up before its end was looked at
    int threads = 1;                          ///< of stage.loop; 0: it is the host's
    std::uint64_t contactsSolved = 0;         ///< of all linearisations of the last attempt together

    /// Solves at most settings.maxIterations linearisations; the result is left in rods and stage.
    Verdict solve(World& world, const Settings& settings, StageTimes& times,
                  const std::function<void(const coulomb::Problem&, const coulomb::SolveReport&)>& onSolve);

    /// Loops of all stages: the host's if there is one, else over `count` threads.
    void useThreads(int count, const parallel::For& hostLoop);

    /// Finds candidates at the world's present configuration if the known ones do not reach far enough for this step.
    void collidePresent(World& world, const Settings& settings);

private:
    enum class Reach : std::uint8_t { Enough, Wider, Never };
    bool wakeTouched(World& world) const;
    [[nodiscard]] bool partsOff(const World& world, double tolerance) const;
    void begin(const World& world, const Settings& settings);
    const std::vector<contact::Candidate>& startCandidates(const World& world, const Settings& settings);
    void solveCoupled(World& world, const Settings& settings);
    void solveOnce(World& world, const Settings& settings, StageTimes& times, bool first);
    Reach measure(World& world, const Settings& settings, int& widened, bool first);
    void collideEnd(const World& world, const Settings& settings);
    void witness(const World& world);
};

/// Makes the attempt the world's new state and books its energies.
void accept(World& world, Attempt& attempt);

/// Deepest overlap of a list of candidates, m.
double deepest(const std::vector<contact::Candidate>& list);

} // namespace supercircle::step
