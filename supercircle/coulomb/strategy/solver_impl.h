#pragma once
// Data and methods of one solve (private to coulomb/): problem, state, best solution so far, and the attempts of the
// strategy. solver.cpp defines their order; solver_subdomains.cpp treats large islands.

#include "supercircle/coulomb/gauss_seidel/gauss_seidel.h"
#include "supercircle/coulomb/pivoting/newton.h"
#include "supercircle/coulomb/pivoting/path_follower.h"
#include "supercircle/coulomb/solver.h"
#include "supercircle/coulomb/strategy/islands.h"
#include "supercircle/coulomb/strategy/subdomains.h"

namespace supercircle::coulomb {

/// One attempt of the path follower: Gauss-Seidel iterations before it, proximal term, slacks.
struct SolveAttempt {
    int iterations;
    double eps;
    double slack;
};
constexpr int kWarmPivots = 150; ///< limit of a path that starts from the statuses of the warm start

/// Islands with more active contacts than this are first solved in subdomains.
constexpr std::size_t kSubdomainContacts = 200;

/// A path on bodies of its own, for any thread.
struct WorkItem {
    Subdomain subdomain;
    bool ran = false;
    bool completed = true; ///< false: the path ended in a ray, diverged, reached the pivot limit, or was singular
    PathCounts counts;
};

struct Solver::Impl {
    MassNormalisedProblem normalised;
    GaussSeidel gaussSeidel;
    Islands islands;
    Subdomains subdomains;
    std::vector<std::uint8_t> covered, busy;
    std::vector<std::int32_t> seedContacts, later;
    std::vector<double> contactErrors;
    std::vector<WorkItem> workItems;
    std::size_t workItemCount = 0;
    parallel::Pool<PathFollower> pathFollowers;
    Newton newton;
    SolverState x, start, saved;
    parallel::For loop;
    BestSolution best;
    SolveTarget target;
    int pivotsLeft = 0;
    double maxWork = 0.0; ///< of the solve, units
    bool giveUp = false;  ///< SolverOptions::giveUpEarly
    bool gaussSeidelIsReady = false;
    bool bestIsAssembled = false; ///< x is the best solution, with the residual of newly assembled velocities

    void run(const SolverOptions& options, SolveReport& report);
    [[nodiscard]] bool evaluateState(Method method, SolveReport& report);
    [[nodiscard]] bool offerState(Method method, SolveReport& report);
    GaussSeidel& readyGaussSeidel();
    void restoreBest();
    double islandError(std::span<const std::int32_t> island) const;
    std::size_t activeContacts(std::span<const std::int32_t> island) const;
    std::size_t activeContacts() const;
    double allowedError() const;
    void setPivotBudget(const SolverOptions& options);
    /// Counts iterations over all contacts; `iterations` is what they took.
    void countIterations(int iterations, SolveReport& report) const;
    [[nodiscard]] bool mayGoOn(const SolveReport& report) const {
        return pivotsLeft > 0 && report.effort.units() < maxWork;
    }
    [[nodiscard]] double workLeft(const SolveReport& report) const { return maxWork - report.effort.units(); }
    bool runPaths(const PathSettings& settings, SolveReport& report);
    bool tryPath(const SolveAttempt& settings, std::uint32_t seed, const SolverOptions& options, SolveReport& report);
    [[nodiscard]] bool tryContinuation(std::uint32_t seed, const SolverOptions& options, SolveReport& report);
    double contactError(std::int32_t c) const;
    double findErrors(std::span<const std::int32_t> island);
    void passSubdomains(std::span<const std::int32_t> island, double allowed, std::uint32_t seed, std::size_t size,
                        double work, PathCounts& counts);
    void collectColour(double share, std::size_t size);
    void runSubdomain(WorkItem& item, std::uint32_t seed, double allowed, double most);
    bool isBusy(const MassNormalisedProblem::Contact& contact) const;
    void restoreIsland(std::span<const std::int32_t> island);
    [[nodiscard]] bool trySubdomains(std::uint32_t seed, const SolverOptions& options, SolveReport& report);
    void countPivots(const PathCounts& counts, SolveReport& report);
    [[nodiscard]] bool trySmall(SolveReport& report);
    [[nodiscard]] bool tryWarmStart(const SolverOptions& options, SolveReport& report);
    bool tryNewton(SolveReport& report);
    bool tryAccelerated(int count, SolveReport& report);
    template <class Visit>
    void forEachUnsolved(Visit&& visit);
};

/// Visits the islands whose error exceeds their share of the allowed error, with that share.
template <class Visit>
void Solver::Impl::forEachUnsolved(Visit&& visit) {
    const double allowed = allowedError();
    for (std::size_t i = 0; i < islands.count(); ++i)
        if (!(islandError(islands.contacts(i)) <= allowed))
            visit(islands.contacts(i), allowed);
}

} // namespace supercircle::coulomb
