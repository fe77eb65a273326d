#pragma once
// Path following: a guess solves the problem exactly for a shifted right-hand side; the path leads from there to the
// true right-hand side (path_follower.cpp).

#include "supercircle/coulomb/pivoting/status_system.h"
#include "supercircle/coulomb/solver.h"
#include "supercircle/coulomb/strategy/solver_state.h"

#include <limits>
#include <span>
#include <vector>

namespace supercircle::coulomb {

/// Counts of one solve, added to by every path.
struct PathCounts {
    int pivots = 0;
    int factorisations = 0;
    SolveEffort effort;
};

struct PathSettings {
    double eps = 1e-6;      ///< proximal term relative to d_c, 1
    double slack = 1.0;     ///< size of the non-degeneracy slacks relative to the error of the guess, 1
    std::uint32_t seed = 0; ///< selects other slacks
    int maxPivots = 600;
    int maxOuter = 12;                                        ///< proximal iterations
    int allPivots = std::numeric_limits<int>::max();          ///< limit of all iterations together
    double maxWork = std::numeric_limits<double>::infinity(); ///< the same of the effort, units
    double error = -1.0; ///< sum d |F|^2 of the guess if it is known, J; negative: it is not
};

class PathFollower {
public:
    enum class Termination : std::uint8_t { Solved, Stalled, Ray, Diverged, PivotLimit, Singular };

    /// Solves `contacts` from x.r and x.status until their sum d |F|^2 <= allowed (J). `outside` are the other contacts
    /// of the same bodies; their impulses stay fixed (none for a whole island). On success x.r, x.w and x.status hold
    /// the last proximal solution.
    Termination run(const MassNormalisedProblem& problem, std::span<const std::int32_t> contacts,
                    std::span<const std::int32_t> outside, const PathSettings& settings, double allowed, SolverState& x,
                    PathCounts& counts);

private:
    enum class Event : std::uint8_t { None, Close, Open, Stick, SlipPlus, SlipMinus };
    struct Breakpoint {
        double step = 0.0;
        std::size_t k = 0;
        Event event = Event::None;
    };

    /// Bounds the normal velocity of an open contact by its bodies and the lengths of its rows.
    struct OpenContactBound {
        std::int32_t body[2] = {0, 0};
        double reach[2] = {0.0, 0.0};
    };

    void begin(const MassNormalisedProblem& problem, const PathSettings& settings, const SolverState& x);
    double errorOf(const MassNormalisedProblem& problem) const;
    double errorOfRefined(const MassNormalisedProblem& problem) const;
    Termination follow(const MassNormalisedProblem& problem, const PathSettings& settings, PathCounts& counts);
    [[nodiscard]] bool direction(const MassNormalisedProblem& problem);
    Breakpoint nextBreakpoint(const MassNormalisedProblem& problem, double sign);
    double openRate(const MassNormalisedProblem& problem, std::size_t k) const;
    double enteringRate(const MassNormalisedProblem& problem, std::size_t k, Event event) const;
    void changeStatus(const MassNormalisedProblem& problem, const Breakpoint& at);
    void fixVelocities(const MassNormalisedProblem& problem, const SolverState& x);
    void copyBodies(const MassNormalisedProblem& problem, const std::vector<double>& from,
                    std::vector<double>& to) const;
    void refreshVelocities(const MassNormalisedProblem& problem);
    [[nodiscard]] bool refactor(const MassNormalisedProblem& problem, const PathSettings& settings, PathCounts& counts);
    [[nodiscard]] bool refine(const MassNormalisedProblem& problem);
    void store(const MassNormalisedProblem& problem, SolverState& x) const;

    std::span<const std::int32_t> contacts_, outside_;
    std::vector<std::int32_t> bodies_;
    std::vector<ContactStatus> status_;
    std::vector<double> r_, u_, anchor_, shift_, dr_, du_, trial_;
    std::vector<double> w_, dw_, mu_, prox_;
    std::vector<double> fixed_; ///< mass-normalised velocities without the impulses of `contacts_`
    std::vector<OpenContactBound> openBounds_;
    std::vector<double> bodyRate_;        ///< norm of dw of each body
    std::vector<std::uint8_t> stale_;     ///< u_n of this open contact is only a lower bound
    std::vector<std::uint8_t> bilateral_; ///< never changes its status
    double edge_ = 0.0;                   ///< slip sign of the cone edge at which a contact last began to stick
    double tau_ = 0.0;
    double errorAtStart_ = 0.0;
    StatusSystem system_;
};

} // namespace supercircle::coulomb
