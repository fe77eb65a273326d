// Large islands, subdomain by subdomain (decision 0125).
//
// Subdomains of one colour share no body. They are independent and run on several threads with bitwise identical
// results. The effect of a subdomain on its neighbours is seen by the next colour.

#include "supercircle/coulomb/strategy/solver_impl.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace supercircle::coulomb {

namespace {

constexpr std::size_t kSubdomainSize = 180; ///< contacts; doubled with every pass after the second
constexpr int kMinPassPivots = 40;          ///< a pass with fewer pivots is the last one
constexpr int kSubdomainPivots =
    150; ///< pivot limit of one subdomain; failing ones of cold starts must not use up the budget
constexpr std::array kSubdomainIterations{0, 40}; ///< Gauss-Seidel iterations before the attempts of one subdomain
constexpr std::uint32_t kSubdomainPasses = 8;
constexpr int kSubdomainDiscount = 16;  ///< this many pivots in subdomains count as one of the whole island
constexpr double kSubdomainSkip = 0.1;  ///< fraction of the mean error below which a contact needs no subdomain
constexpr double kSubdomainShare = 0.1; ///< fraction of the error that a contact may keep in the end

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

bool Solver::Impl::isBusy(const MassNormalisedProblem::Contact& contact) const {
    for (std::int32_t s = 0; s < contact.sides; ++s)
        if (busy[contact.side[s].body])
            return true;
    return false;
}

/// Builds one colour: subdomains around unsolved contacts of `seedContacts` that share no body. Contacts that have to
/// wait for one of them go to `later`.
void Solver::Impl::collectColour(double share, std::size_t size) {
    SC_ASSERT(covered.size() == normalised.contactCount(), "one mark a contact");
    SC_ASSERT(!(share < 0.0), "an error is not negative");
    busy.assign(normalised.bodyCount(), 0);
    later.clear();
    workItemCount = 0;
    for (const std::int32_t c : seedContacts) {
        if (covered[c])
            continue;
        if (isBusy(normalised.contact(c))) {
            later.push_back(c);
            continue;
        }
        if (contactError(c) <= share)
            continue;
        const Subdomain* subdomain = subdomains.grow(normalised, c, size, busy);
        if (subdomain == nullptr) {
            later.push_back(c);
            continue;
        }
        SC_ASSERT_EXPENSIVE(std::none_of(subdomain->contacts.begin(), subdomain->contacts.end(),
                                         [this](std::int32_t k) { return isBusy(normalised.contact(k)); }),
                            "subdomains of one colour share no body");
        for (const std::int32_t k : subdomain->core)
            covered[k] = 1;
        for (const std::int32_t k : subdomain->contacts)
            for (std::int32_t s = 0; s < normalised.contact(k).sides; ++s)
                busy[normalised.contact(k).side[s].body] = 1;
        if (workItemCount == workItems.size())
            workItems.emplace_back();
        workItems[workItemCount].counts = {};
        workItems[workItemCount++].subdomain = *subdomain;
    }
}

/// A path that fails would fail again from the same statuses, and one such subdomain prevents the solution of the whole
/// island. Gauss-Seidel iterations in the subdomain lead to other statuses.
void Solver::Impl::runSubdomain(WorkItem& item, std::uint32_t seed, double allowed, double most) {
    const Subdomain& subdomain = item.subdomain;
    const parallel::Pool<PathFollower>::Lease path(pathFollowers);
    for (const int count : kSubdomainIterations) {
        gaussSeidel.iterateSome(normalised, subdomain.contacts, count, x);
        item.counts.effort.visits += static_cast<double>(count) * static_cast<double>(subdomain.contacts.size());
        const PathFollower::Termination termination = path->run(
            normalised, subdomain.contacts, subdomain.outside,
            {.eps = 1e-6, .slack = 0.3, .seed = seed, .maxPivots = kSubdomainPivots, .maxOuter = 4, .maxWork = most},
            allowed, x, item.counts);
        if (termination == PathFollower::Termination::Solved || termination == PathFollower::Termination::Stalled)
            return;
    }
}

/// One path in the neighbourhood of every unsolved contact; cores do not overlap. Subdomains of one colour share no
/// body and may run on several threads.
void Solver::Impl::passSubdomains(std::span<const std::int32_t> island, double allowed, std::uint32_t seed,
                                  std::size_t size, double work, PathCounts& counts) {
    const double error = findErrors(island);
    if (error <= allowed)
        return;
    SC_ASSERT(contactErrors.size() == island.size() && !island.empty(), "one error a contact");
    const double share =
        std::max(kSubdomainShare * allowed, kSubdomainSkip * error) / static_cast<double>(island.size());
    seedContacts.clear();
    for (std::size_t k = 0; k < island.size(); ++k)
        if (contactErrors[k] > share)
            seedContacts.push_back(island[k]);
    for (; !seedContacts.empty() && counts.effort.units() < work; seedContacts.swap(later)) {
        const double left = work - counts.effort.units();
        collectColour(share, size);
        parallel::forEach(loop, workItemCount, 1, [&](std::size_t i) {
            WorkItem& item = workItems[i];
            const double most = share * static_cast<double>(item.subdomain.contacts.size());
            runSubdomain(item, seed, most, left);
        });
        for (std::size_t i = 0; i < workItemCount; ++i) {
            counts.pivots += workItems[i].counts.pivots;
            counts.factorisations += workItems[i].counts.factorisations;
            counts.effort.add(workItems[i].counts.effort);
        }
    }
}

/// Large islands: paths in subdomains until the statuses hardly change, then one path of the whole island with few
/// pivots. A pivot of the whole costs about as much as a tenth of a pass over all subdomains.
bool Solver::Impl::trySubdomains(std::uint32_t seed, const SolverOptions& options, SolveReport& report) {
    subdomains.prepare(normalised);
    readyGaussSeidel(); // before several threads use them
    for (std::uint32_t round = 0; round < 4 && mayGoOn(report); ++round) {
        for (std::uint32_t pass = 0; pass < kSubdomainPasses; ++pass) {
            PathCounts counts;
            covered.assign(normalised.contactCount(), 0);
            const double allowed = allowedError();
            for (std::size_t i = 0; i < islands.count(); ++i)
                if (activeContacts(islands.contacts(i)) > kSubdomainContacts)
                    passSubdomains(islands.contacts(i), allowed, seed + kSubdomainPasses * round + pass,
                                   kSubdomainSize << (pass > 1 ? pass - 1 : 0), workLeft(report), counts);
            const int pivotsLeftBefore = pivotsLeft;
            countPivots(counts, report);
            pivotsLeft = pivotsLeftBefore - counts.pivots / kSubdomainDiscount;
            if (evaluateState(Method::Path, report))
                return true;
            if (counts.pivots < kMinPassPivots || !(report.effort.units() < maxWork))
                break;
        }
        // The statuses of redundant contacts may contradict each other by round-off. Their impulses then drift apart,
        // faster for a weaker proximal term, until one of them opens or slips. High accuracy may need that.
        for (const double eps : {1e-7, 1e-9, 1e-11}) {
            const bool completed = runPaths({eps, 0.3, seed, std::min(options.maxPivots, kWarmPivots), 20}, report);
            if (evaluateState(Method::Path, report))
                return true;
            if (!completed)
                break;
        }
    }
    return false;
}

} // namespace supercircle::coulomb
