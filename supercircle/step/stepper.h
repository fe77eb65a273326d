#pragma once
// One implicit step of the shells, and the controller that chooses its size.
//
// Scheme (Moreau time stepping). Unknowns: velocities v and impulses r. With J the Jacobian at the linearisation point
// and u the material velocities the rod has now,
//     (M + dt^2 K) v = int lambda J^T u + dt F(q) + H^T r + (holds),        q_new = q + dt v.
// Bending is linear in q and enters exactly. M, J and the contact rows H are linearised again at q_new as long as the
// gap of a loaded contact is off ("evaluate" to "solve" repeat). Equations: docs/theory/time_step.md. Why it is so and
// what was tried: decisions 0041 to 0046 and 0056.

#include "supercircle/step/world.h"
#include "supercircle/support/parallel.h"

#include <array>
#include <functional>
#include <memory>

namespace supercircle::step {

/// A rod that given motions leave no room: a body's, or that of a hold against a body.
struct Crushed {
    std::uint32_t rod = 0; ///< key
    BodyId body = 0;
    std::uint32_t hold = 0; ///< key of the hold that was driven; 0: the body or the crosshead moves
    double time = 0.0;      ///< s
    bool crosshead = false; ///< it carries the body or a hold
};

/// A hold or link that was asked for more than its largest force.
struct Broken {
    std::uint32_t rod = 0; ///< key
    std::uint32_t key = 0; ///< its own
    bool link = false;
    Vec2 force = Vec2::Zero(); ///< on the rod, N
    double time = 0.0;         ///< s
};

/// How a frame ended.
struct FrameResult {
    double advanced = 0.0;        ///< s, may be less than asked for when the observer stopped it, it was late or failed
    bool stopped = false;         ///< the observer asked to stop
    bool budgetExhausted = false; ///< Settings::frameWork was used up
    double work = 0.0;            ///< that the frame took, in the units of Settings::frameWork
    double gained = 0.0;          ///< J, of the islands that raise the alarm (energy_gain.h)
    std::vector<Crushed> crushed;
    std::vector<Broken> broken;
    std::string failure;                ///< empty unless the simulation cannot go on
    std::string refused;                ///< what of the host was left out because of numbers that are not finite
    std::vector<std::uint32_t> carried; ///< keys of rods that were moved along with their bodies (carry_along.h)
};

/// Wall time per stage, s.
struct StageTimes : std::array<double, static_cast<std::size_t>(Stage::Count)> {
    std::function<void(Stage)> onStage; ///< called when a stage begins, and with Stage::Count when it ends
};

struct TrialStep;
class FrameBudget;

/// Called with every contact problem after it was solved.
using SolveObserver = std::function<void(const coulomb::Problem&, const coulomb::SolveReport&)>;

/// Whether a rod and a piece of a host body may collide in the coming frame; both are not filtered out otherwise.
using PairFilter = std::function<bool(const Rod&, const BodyOutline&)>;

/// Follows a frame step by step. No call may throw.
class FrameObserver {
public:
    virtual ~FrameObserver() = default;
    /// Whether each call must show all shells at one time. Else islands step one after the other, each at its own pace.
    [[nodiscard]] virtual bool wantsWholeWorld() const = 0;
    /// Several islands follow: what is seen from here on may have to be forgotten.
    virtual void beginIslands() {}
    /// It is to be forgotten: the frame begins again.
    virtual void beginAgain() {}
    /// Before the first step of the world or of an island.
    virtual void begin(const World& /*stepped*/) {}
    /// After each accepted step. `stepped`: the world, or an island as a world of its own. True: stop here, where whole
    /// worlds were asked for.
    virtual bool afterStep(const World& stepped) = 0;
};

class Stepper {
public:
    struct Work;
    explicit Stepper(Settings settings);
    ~Stepper();

    Settings& settings() { return settings_; }
    [[nodiscard]] const Settings& settings() const { return settings_; }

    /// Advances the world by `frame` seconds in as many steps as it takes. `port` may be null (no host); it is pulled
    /// from before the first step and pushed to after the last one.
    FrameResult advance(World& world, double frame, Port* port, FrameObserver& observer);
    /// The same with a function that is called with the whole world after each accepted step; returning true stops
    /// there. Without one, islands step by themselves.
    FrameResult advance(World& world, double frame, Port* port, const std::function<bool(const World&)>& observer);

    /// Reads gravity, bodies near the shells and their outlines, without a step.
    void readHost(World& world, const Port& port, double frame) const;
    /// After the host's own step of `advanced` seconds: gives the bodies the velocities they have at the end of the
    /// frame and learns what the host's constraints did to them (coupling/host_coupling.h).
    void learnFromHost(World& world, Port& port, double advanced) const;

    [[nodiscard]] const StageTimes& times() const { return times_; }
    /// Tells whoever measures which stage runs: at the start of every stage, and Stage::Count at its end. Must not
    /// throw.
    void watchStages(std::function<void(Stage)> watcher) { times_.onStage = std::move(watcher); }
    /// The contact problem of the last solve, for dumps and observers.
    [[nodiscard]] const coulomb::Problem& lastProblem() const;
    [[nodiscard]] const std::vector<contact::Candidate>& lastCandidates() const;
    [[nodiscard]] const Eigen::VectorXd& lastImpulses() const;
    [[nodiscard]] double lastDt() const;
    /// For dumps and benchmarks; empty: nobody listens.
    SolveObserver onSolve;
    /// Asked at the start of a frame for each pair that may meet in it; empty: all may collide.
    PairFilter pairFilter;
    /// Runs the turns of a step on the host's own threads instead of Settings::threads of ours; empty: none.
    parallel::For loop;

private:
    struct Part;
    enum class Verdict : std::uint8_t;
    Verdict judge(Part& part, double elapsed, Port* port, FrameBudget& budget, FrameResult& out);
    Verdict judgeRegions(Part& part, const TrialStep& moved, double elapsed, Port* port);
    Verdict refine(Part& part, double elapsed, Port* port, FrameBudget& budget, bool& made);
    [[nodiscard]] Reason rejection(const TrialStep& trial, int cuts, bool inAHurry) const;
    FrameResult advancePart(Part& part, double frame, Port* port, FrameObserver& observer);
    FrameResult advanceWhole(World& world, double frame, Port* port, FrameObserver& observer);
    FrameResult advanceAlone(World& world, double frame, Port* port, FrameObserver& observer);
    FrameResult advanceIslands(World& world, double frame, Port* port, FrameObserver& observer);
    Settings settings_;
    std::unique_ptr<Work> work_;
    StageTimes times_{};
};

} // namespace supercircle::step
