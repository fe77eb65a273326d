#pragma once
// What the methods of one solve share (private to coulomb/): the problem, the iterate, the best so far, and the tries
// of the cascade. solver.cpp says in which order they come; solver_regions.cpp is about large islands.

#include "supercircle/coulomb/gauss_seidel/gauss_seidel.h"
#include "supercircle/coulomb/pivoting/newton.h"
#include "supercircle/coulomb/pivoting/path.h"
#include "supercircle/coulomb/solver.h"
#include "supercircle/coulomb/strategy/islands.h"
#include "supercircle/coulomb/strategy/regions.h"

namespace supercircle::coulomb {

/// One try of the path: sweeps before it, proximal term, slacks.
struct Try {
    int sweeps;
    double eps;
    double slack;
};
constexpr int kWarmPivots = 150; ///< of a path straight from the pieces of a warm start

/// Islands with more loaded contacts than this are first solved region by region.
constexpr std::size_t kRegionLoad = 200;

/// A path on its own bodies, run by whichever thread comes first.
struct Turn {
    Region region;
    bool ran = false;
    bool arrived = true; ///< false: the path met a ray, wandered, took too many pivots, or was singular
    PathCounts counts;
};

struct Solver::Impl {
    Whitened whitened;
    GaussSeidel sweeps;
    Islands islands;
    Regions regions;
    std::vector<std::uint8_t> covered, busy;
    std::vector<std::int32_t> seeds, later;
    std::vector<double> contactErrors;
    std::vector<Turn> turns;
    std::size_t turnCount = 0;
    parallel::Pool<Path> pathPool;
    Newton newton;
    Iterate x, start, kept;
    parallel::For loop;
    Best best;
    Target target;
    int pivotsLeft = 0;

    void run(const SolverOptions& options, SolveReport& report);
    bool judgeNow(Method method, SolveReport& report);
    void restoreBest();
    double islandError(std::span<const std::int32_t> island) const;
    std::size_t loaded(std::span<const std::int32_t> island) const;
    std::size_t loaded() const;
    double allowedError() const;
    void allowPivots(const SolverOptions& options);
    bool runPaths(const PathSettings& settings, SolveReport& report);
    bool tryPath(const Try& settings, std::uint32_t seed, const SolverOptions& options, SolveReport& report);
    bool tryLadder(std::uint32_t seed, const SolverOptions& options, SolveReport& report);
    double contactError(std::int32_t c) const;
    double findErrors(std::span<const std::int32_t> island);
    void passRegions(std::span<const std::int32_t> island, double allowed, std::uint32_t seed, std::size_t size,
                     PathCounts& counts);
    void collectWave(double share, std::size_t size);
    void runRegion(Turn& turn, std::uint32_t seed, double allowed);
    bool isBusy(const Whitened::Contact& contact) const;
    void undo(std::span<const std::int32_t> island);
    bool tryRegions(std::uint32_t seed, const SolverOptions& options, SolveReport& report);
    void book(const PathCounts& counts, SolveReport& report);
    bool tryFew(SolveReport& report);
    bool tryWarm(const SolverOptions& options, SolveReport& report);
    bool tryNewton(SolveReport& report);
    bool tryAccelerated(int count, SolveReport& report);
    template <class Visit>
    void forEachUnsolved(Visit&& visit);
};

/// Visits the islands whose error is above their share of what the target allows, with that share.
template <class Visit>
void Solver::Impl::forEachUnsolved(Visit&& visit) {
    const double allowed = allowedError();
    for (std::size_t i = 0; i < islands.count(); ++i)
        if (!(islandError(islands.contacts(i)) <= allowed))
            visit(islands.contacts(i), allowed);
}

} // namespace supercircle::coulomb
