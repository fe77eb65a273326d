// Large islands, region by region. The figures behind the constants are in solver.cpp.
//
// Regions of one wave share no body, so none sees what another does: they run on as many threads as there are, with the
// same digits. What a region misses of its neighbours it learns in the next wave, as it would one after the other.

#include "supercircle/coulomb/strategy/cascade.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace supercircle::coulomb {

namespace {

constexpr std::size_t kRegionSize = 180; ///< contacts; doubled with every pass after the second
constexpr int kRegionPivots = 40;        ///< a pass with fewer pivots is the last one
constexpr int kRegionMost = 150; ///< pivots of one region; with 600 the hopeless ones of cold starts eat the budget
constexpr std::array kRegionSweeps{0, 40}; ///< before the tries of one region
constexpr std::uint32_t kRegionPasses = 8;
constexpr int kRegionDiscount = 16;  ///< so many pivots in a region count as one of the whole
constexpr double kRegionSkip = 0.1;  ///< of the present mean error: contacts below need no region of their own
constexpr double kRegionShare = 0.1; ///< of the error a contact may keep in the end

} // namespace

double Solver::Impl::contactError(std::int32_t c) const {
    const std::array one{c};
    return islandError(one);
}

/// Fills contactErrors for the contacts of an island and returns their sum, which is islandError.
double Solver::Impl::findErrors(std::span<const std::int32_t> island) {
    contactErrors.resize(island.size());
    parallel::forEach(loop, island.size(), 128, [&](std::size_t k) { contactErrors[k] = contactError(island[k]); });
    return std::accumulate(contactErrors.begin(), contactErrors.end(), 0.0);
}

bool Solver::Impl::isBusy(const Whitened::Contact& contact) const {
    for (std::int32_t s = 0; s < contact.sides; ++s)
        if (busy[contact.side[s].body])
            return true;
    return false;
}

/// Regions around the contacts of `seeds` that are not at rest, as long as they share no body; what has to wait for
/// one of them goes into `later`.
void Solver::Impl::collectWave(double share, std::size_t size) {
    busy.assign(whitened.bodyCount(), 0);
    later.clear();
    turnCount = 0;
    for (const std::int32_t c : seeds) {
        if (covered[c])
            continue;
        if (isBusy(whitened.contact(c))) {
            later.push_back(c);
            continue;
        }
        if (contactError(c) <= share)
            continue;
        const Region* region = regions.grow(whitened, c, size, busy);
        if (region == nullptr) {
            later.push_back(c);
            continue;
        }
        for (const std::int32_t k : region->core)
            covered[k] = 1;
        for (const std::int32_t k : region->contacts)
            for (std::int32_t s = 0; s < whitened.contact(k).sides; ++s)
                busy[whitened.contact(k).side[s].body] = 1;
        if (turnCount == turns.size())
            turns.emplace_back();
        turns[turnCount].counts = {};
        turns[turnCount++].region = *region;
    }
}

/// A path that meets a ray or wanders does so again from the same pieces, whatever is tried with them, and one such
/// spot keeps the whole island from its solution. Sweeps of its own take the region elsewhere.
void Solver::Impl::runRegion(Turn& turn, std::uint32_t seed, double allowed) {
    const Region& region = turn.region;
    const parallel::Pool<Path>::Loan path(pathPool);
    for (const int count : kRegionSweeps) {
        sweeps.sweepSome(whitened, region.contacts, count, x);
        const Path::Outcome outcome = path->run(whitened, region.contacts, region.outside,
                                                {1e-6, 0.3, seed, kRegionMost, 4}, allowed, x, turn.counts);
        if (outcome == Path::Outcome::Solved || outcome == Path::Outcome::Stalled)
            return;
    }
}

/// One path in the neighbourhood of every contact that is not at rest yet; cores do not overlap. In waves of regions
/// that share no body: those of one wave do not see each other, and may run on several threads.
void Solver::Impl::passRegions(std::span<const std::int32_t> island, double allowed, std::uint32_t seed,
                               std::size_t size, PathCounts& counts) {
    const double error = findErrors(island);
    if (error <= allowed)
        return;
    const double share = std::max(kRegionShare * allowed, kRegionSkip * error) / static_cast<double>(island.size());
    seeds.clear();
    for (std::size_t k = 0; k < island.size(); ++k)
        if (contactErrors[k] > share)
            seeds.push_back(island[k]);
    for (; !seeds.empty(); seeds.swap(later)) {
        collectWave(share, size);
        parallel::forEach(loop, turnCount, 1, [&](std::size_t i) {
            Turn& turn = turns[i];
            const double most = share * static_cast<double>(turn.region.contacts.size());
            runRegion(turn, seed, most);
        });
        for (std::size_t i = 0; i < turnCount; ++i) {
            counts.pivots += turns[i].counts.pivots;
            counts.factorisations += turns[i].counts.factorisations;
        }
    }
}

/// Large islands: paths in regions until the pieces hardly change any more, then one path of the whole island, which
/// has little left to do. A pivot of the whole costs as much as some tenth of a pass over all regions.
bool Solver::Impl::tryRegions(std::uint32_t seed, const SolverOptions& options, SolveReport& report) {
    regions.prepare(whitened);
    for (std::uint32_t round = 0; round < 4 && pivotsLeft > 0; ++round) {
        for (std::uint32_t pass = 0; pass < kRegionPasses; ++pass) {
            PathCounts counts;
            covered.assign(whitened.contactCount(), 0);
            const double allowed = allowedError();
            for (std::size_t i = 0; i < islands.count(); ++i)
                if (loaded(islands.contacts(i)) > kRegionLoad)
                    passRegions(islands.contacts(i), allowed, seed + kRegionPasses * round + pass,
                                kRegionSize << (pass > 1 ? pass - 1 : 0), counts);
            const int pivotsLeftBefore = pivotsLeft;
            book(counts, report);
            pivotsLeft = pivotsLeftBefore - counts.pivots / kRegionDiscount;
            if (judgeNow(Method::Path, report))
                return true;
            if (counts.pivots < kRegionPivots)
                break;
        }
        // Redundant contacts whose pieces contradict each other by round-off: their impulses drift apart, the faster
        // the weaker the proximal term, until one of them opens or slips. The last digits may need that.
        for (const double eps : {1e-7, 1e-9, 1e-11}) {
            const bool arrived = runPaths({eps, 0.3, seed, std::min(options.maxPivots, kWarmPivots), 20}, report);
            if (judgeNow(Method::Path, report))
                return true;
            if (!arrived)
                break;
        }
    }
    return false;
}

} // namespace supercircle::coulomb
