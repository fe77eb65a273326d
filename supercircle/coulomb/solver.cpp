// The strategy: which method is tried when. Its figures are measured on stacks of nested shells, for which Gauss-Seidel
// iterations of any kind do not converge (decision 0125).
//  - Warm start: the path starts directly from the statuses of the last step. Iterations before it would spoil
//  statuses.
//  - Cold start: 40 Gauss-Seidel iterations provide the statuses.
//  - An island with more active contacts than a stack is first solved in overlapping subdomains, then by one path.
//  - If a path fails, it is tried again after more iterations, with another proximal term and other slacks. Newton and
//  long
//    accelerated Gauss-Seidel runs are the last resort. For contradictory constraints they decide how good the best
//    solution is.
// Every stage has a limit.

#include "supercircle/coulomb/strategy/solver_impl.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supercircle::coulomb {

std::string_view name(Method m) {
    switch (m) {
    case Method::Strategy:
        return "strategy";
    case Method::GaussSeidel:
        return "gauss_seidel";
    case Method::Accelerated:
        return "accelerated";
    case Method::Path:
        return "path";
    case Method::Newton:
        return "newton";
    case Method::None:
        return "none";
    }
    return "unknown";
}

namespace {

constexpr std::array kAttempts{SolveAttempt{0, 1e-6, 0.3}, SolveAttempt{0, 1e-8, 1.0}, SolveAttempt{30, 1e-5, 1.0},
                               SolveAttempt{60, 1e-7, 0.3}, SolveAttempt{100, 1e-4, 3.0}};

/// From the statuses of a warm start, without iterations before. They take few pivots or fail: a small limit.
constexpr std::array kWarmAttempts{SolveAttempt{0, 1e-7, 0.3}, SolveAttempt{0, 1e-9, 1.0}};
constexpr std::size_t kFewContacts = 60;
constexpr int kFewIterations = 3;

/// Proximal terms of the continuation: a strong term makes any problem easy, then it is reduced step by step.
constexpr std::array kProximalTerms{1.0, 0.3, 0.1, 0.03, 1e-2, 3e-3, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12};
constexpr int kContinuations = 3;
constexpr std::uint32_t kQuickAttempts = 2;

/// Above this many active contacts in an island, the sparse LU costs more than long accelerated Gauss-Seidel runs.
constexpr std::size_t kPathLimit = 20000;
/// Pivot limit of all paths of one solve, as a multiple of that of one path: a problem without solution must end.
constexpr int kBudget = 5;
constexpr double kMostWork =
    4e7; ///< limit of pivots times active contacts: a large problem without solution must end, too
constexpr int kNewtonSteps = 30;
/// What a solve takes before it gives up early. Problems that need more are rare, and a smaller step is cheaper: 100
/// shells squeezed take 99 instead of 164 s. With half of it more steps are cut whose problem is merely large; with
/// twice as much a problem without solution costs twice as much before it is cut.
constexpr int kEarlyPivots = 300;
constexpr int kEarlyPivotsPerContact = 4;

} // namespace

/// Evaluates the residual of x, keeps x if it is the best; true if the best meets the target.
bool Solver::Impl::evaluateState(Method method, SolveReport& report) {
    SC_ASSERT(x.r.size() == 2 * normalised.contactCount(), "two impulses a contact");
    normalised.assemble(x.r, x.w, loop);
    return offerState(method, report);
}

/// The same for velocities that were just assembled.
bool Solver::Impl::offerState(Method method, SolveReport& report) {
    report.effort.visits += 2.0 * static_cast<double>(normalised.contactCount());
    bestIsAssembled = best.offer(x.r, normalised.residual(x.r, x.w, loop));
    if (bestIsAssembled)
        report.finishedBy = method;
    return target.reached(best.residual);
}

/// Iterations over all contacts, and over those of a subdomain, need their order and laws: most solves need neither.
GaussSeidel& Solver::Impl::readyGaussSeidel() {
    if (!gaussSeidelIsReady)
        gaussSeidel.prepare(normalised);
    gaussSeidelIsReady = true;
    bestIsAssembled = false;
    return gaussSeidel;
}

void Solver::Impl::restoreBest() {
    SC_ASSERT(best.r.size() == 2 * normalised.contactCount(), "a solution was evaluated before");
    bestIsAssembled = false;
    x.r = best.r;
    x.findStatuses(normalised);
    normalised.assemble(x.r, x.w, loop);
}

double Solver::Impl::islandError(std::span<const std::int32_t> island) const {
    ResidualSum sum;
    for (const std::int32_t c : island) {
        const MassNormalisedProblem::Contact& contact = normalised.contact(c);
        const MassNormalisedProblem::Velocity u = normalised.velocity(contact, x.w.data());
        MassNormalisedProblem::addResidual(contact, u, x.r[2 * c], x.r[2 * c + 1], sum);
    }
    return sum.error();
}

std::size_t Solver::Impl::activeContacts(std::span<const std::int32_t> island) const {
    return static_cast<std::size_t>(std::count_if(island.begin(), island.end(), [this](std::int32_t c) {
        return x.r[2 * c] > 0.0 || normalised.contact(c).bilateral();
    }));
}

std::size_t Solver::Impl::activeContacts() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < islands.count(); ++i)
        count += activeContacts(islands.contacts(i));
    return count;
}

/// Share of one island in the allowed error, J.
double Solver::Impl::allowedError() const {
    return 0.9 * target.contactResidual * target.contactResidual * best.residual.scale /
           static_cast<double>(std::max<std::size_t>(1, islands.count()));
}

void Solver::Impl::setPivotBudget(const SolverOptions& options) {
    const double load = static_cast<double>(activeContacts());
    const double most = kBudget * options.maxPivots * std::max(1.0, load / 150.0);
    SC_ASSERT(load <= static_cast<double>(normalised.contactCount()), "an active contact is counted once");
    pivotsLeft = static_cast<int>(std::min(most, kMostWork / std::max(1.0, load)));
    if (options.giveUpEarly)
        pivotsLeft = std::min(pivotsLeft, kEarlyPivots + kEarlyPivotsPerContact * static_cast<int>(load));
}

/// Islands are independent, so each may run on its own thread. The result is that of running them one after the other:
/// islands for which no pivots would have been left are restored. Returns false if a path failed.
bool Solver::Impl::runPaths(const PathSettings& settings, SolveReport& report) {
    SC_ASSERT(settings.eps > 0.0 && settings.slack > 0.0, "the proximal problem is regular");
    const std::size_t count = islands.count();
    const bool together = loop && count > 1;
    bestIsAssembled = false;
    const double allowed = allowedError();
    if (together)
        saved = x;
    if (workItems.size() < count)
        workItems.resize(count);
    PathSettings bounded = settings;
    bounded.maxWork = workLeft(report);
    if (giveUp)
        bounded.allPivots = pivotsLeft;
    const auto run = [&](std::size_t i) {
        WorkItem& item = workItems[i];
        item.ran = false;
        item.completed = true;
        item.counts = {};
        const std::span<const std::int32_t> island = islands.contacts(i);
        PathSettings ownSettings = bounded;
        ownSettings.error = islandError(island);
        if (ownSettings.error <= allowed || activeContacts(island) > kPathLimit)
            return;
        item.ran = true;
        const parallel::Pool<PathFollower>::Lease path(pathFollowers);
        const PathFollower::Termination termination =
            path->run(normalised, island, {}, ownSettings, allowed, x, item.counts);
        item.completed =
            termination == PathFollower::Termination::Solved || termination == PathFollower::Termination::Stalled;
    };
    if (together)
        parallel::forEach(loop, count, 1, run);
    PathCounts counts;
    bool completed = true;
    for (std::size_t i = 0; i < count; ++i) {
        if (counts.pivots >= pivotsLeft || counts.effort.units() >= bounded.maxWork) {
            if (together && workItems[i].ran)
                restoreIsland(islands.contacts(i));
            continue;
        }
        if (!together)
            run(i);
        counts.pivots += workItems[i].counts.pivots;
        counts.factorisations += workItems[i].counts.factorisations;
        counts.effort.add(workItems[i].counts.effort);
        completed = completed && workItems[i].completed;
    }
    countPivots(counts, report);
    return completed;
}

void Solver::Impl::restoreIsland(std::span<const std::int32_t> island) {
    SC_ASSERT(saved.r.size() == x.r.size() && saved.w.size() == x.w.size(), "saved from this problem");
    for (const std::int32_t c : island) {
        x.r[2 * c] = saved.r[2 * c];
        x.r[2 * c + 1] = saved.r[2 * c + 1];
        x.status[c] = saved.status[c];
        const MassNormalisedProblem::Contact& contact = normalised.contact(c);
        for (std::int32_t s = 0; s < contact.sides; ++s) {
            const auto at = static_cast<std::ptrdiff_t>(contact.side[s].velocity);
            std::copy_n(saved.w.begin() + at, contact.side[s].padded, x.w.begin() + at);
        }
    }
}

void Solver::Impl::countPivots(const PathCounts& counts, SolveReport& report) {
    SC_ASSERT(counts.pivots >= 0 && counts.factorisations >= 0, "counts only grow");
    pivotsLeft -= counts.pivots;
    report.pivots += counts.pivots;
    report.factorisations += counts.factorisations;
    report.effort.add(counts.effort);
}

void Solver::Impl::countIterations(int iterations, SolveReport& report) const {
    report.gaussSeidelIterations += iterations;
    report.effort.visits += 1.2 * static_cast<double>(iterations) * static_cast<double>(normalised.contactCount());
}

bool Solver::Impl::tryPath(const SolveAttempt& settings, std::uint32_t seed, const SolverOptions& options,
                           SolveReport& report) {
    if (settings.iterations > 0) {
        restoreBest();
        countIterations(readyGaussSeidel().runAccelerated(normalised, x, settings.iterations, target, best), report);
        if (evaluateState(Method::Accelerated, report))
            return true;
    }
    runPaths({settings.eps, settings.slack, seed, options.maxPivots, 20}, report);
    return evaluateState(Method::Path, report);
}

/// Proximal terms from strong to weak. Each path starts where the last one ended, with a few proximal iterations.
bool Solver::Impl::tryContinuation(std::uint32_t seed, const SolverOptions& options, SolveReport& report) {
    restoreBest();
    for (const double eps : kProximalTerms) {
        if (!(report.effort.units() < maxWork))
            return false;
        runPaths({eps, seed % 2 == 0 ? 1.0 : 0.1, seed, options.maxPivots, eps > 1e-5 ? 2 : 12}, report);
        if (evaluateState(Method::Path, report))
            return true;
    }
    return false;
}

/// A few contacts are often solved after one to three iterations. If not, x is reset: its statuses were better.
bool Solver::Impl::trySmall(SolveReport& report) {
    if (normalised.contactCount() > kFewContacts)
        return false;
    start = x;
    const double before = best.residual.contactResidual;
    countIterations(readyGaussSeidel().run(normalised, x, kFewIterations, target, best), report);
    if (best.residual.contactResidual < before)
        report.finishedBy = Method::GaussSeidel;
    if (target.reached(best.residual))
        return true;
    x = start;
    return false;
}

/// From the statuses of the last step. On failure x is the warm start again.
bool Solver::Impl::tryWarmStart(const SolverOptions& options, SolveReport& report) {
    const std::size_t load = activeContacts();
    if (load == 0)
        return false;
    const int most = std::min(options.maxPivots, kWarmPivots);
    if (load > kSubdomainContacts) {
        if (trySubdomains(0, options, report))
            return true;
        restoreBest();
        return false;
    }
    for (std::uint32_t k = 0; k < kWarmAttempts.size(); ++k) {
        runPaths({kWarmAttempts[k].eps, kWarmAttempts[k].slack, k, most, 20}, report);
        if (evaluateState(Method::Path, report))
            return true;
    }
    restoreBest();
    return false;
}

bool Solver::Impl::tryNewton(SolveReport& report) {
    restoreBest(); // what follows changes x
    forEachUnsolved([&](std::span<const std::int32_t> island, double allowed) {
        if (activeContacts(island) <= kPathLimit)
            report.factorisations += newton.run(normalised, island, 1e-6, kNewtonSteps, allowed, x, report.effort);
    });
    return evaluateState(Method::Newton, report);
}

bool Solver::Impl::tryAccelerated(int count, SolveReport& report) {
    restoreBest();
    const double before = best.residual.contactResidual;
    countIterations(readyGaussSeidel().runAccelerated(normalised, x, count, target, best), report);
    if (best.residual.contactResidual < before)
        report.finishedBy = Method::Accelerated;
    return target.reached(best.residual);
}

void Solver::Impl::run(const SolverOptions& options, SolveReport& report) {
    report.finishedBy = Method::None;
    maxWork = options.maxWork > 0.0 ? options.maxWork : std::numeric_limits<double>::infinity();
    giveUp = options.giveUpEarly;
    best.reset();
    gaussSeidelIsReady = false;
    if (offerState(Method::None, report) || options.method == Method::None)
        return;
    const bool paths = options.method == Method::Strategy || options.method == Method::Path;
    if (paths || options.method == Method::Newton) {
        islands.split(normalised);
        setPivotBudget(options);
    }
    const int allowed = pivotsLeft;
    if (paths && (trySmall(report) || tryWarmStart(options, report)))
        return;
    const bool only = options.method == Method::GaussSeidel;
    const double before = best.residual.contactResidual;
    countIterations(readyGaussSeidel().run(
                        normalised, x, only ? options.maxGaussSeidelIterations : options.initialGaussSeidelIterations,
                        target, best),
                    report);
    if (best.residual.contactResidual < before)
        report.finishedBy = Method::GaussSeidel;
    if (only || target.reached(best.residual))
        return;
    if (options.method == Method::Accelerated) {
        tryAccelerated(options.maxGaussSeidelIterations, report);
        return;
    }
    const int spent = allowed - pivotsLeft;
    setPivotBudget(options); // the iterations give a better number of active contacts
    if (options.giveUpEarly)
        pivotsLeft -= spent;
    if (options.method == Method::Newton) {
        tryNewton(report);
        return;
    }
    if (activeContacts() > kSubdomainContacts) {
        if (trySubdomains(100, options, report))
            return;
        restoreBest();
    }
    // Two quick attempts, then a continuation before the slower attempts: it mostly succeeds where a plain path
    // diverges.
    for (std::uint32_t k = 0; k < kAttempts.size() && mayGoOn(report); ++k)
        if (tryPath(kAttempts[k], k, options, report) ||
            (k == kQuickAttempts - 1 && tryContinuation(0, options, report)))
            return;
    if (options.giveUpEarly || options.method == Method::Path || !(report.effort.units() < maxWork) ||
        tryNewton(report))
        return;
    for (std::uint32_t k = 1; k < kContinuations && mayGoOn(report); ++k)
        if (tryContinuation(k, options, report))
            return;
    if (!(report.effort.units() < maxWork))
        return;
    if (!tryAccelerated(options.maxGaussSeidelIterations, report) && mayGoOn(report))
        tryPath({0, 1e-6, 1.0}, static_cast<std::uint32_t>(kAttempts.size()), options, report);
}

namespace {

/// Whether all impulses lie in their cones as far as the residual says. The residual projects on the cone, so that no
/// impulse is farther from its cone than its natural-map error.
bool insideCones(const MassNormalisedProblem& problem, const std::vector<double>& r, double error) {
    return invariants::forAll(problem.contactCount(), [&](std::size_t c) {
        const MassNormalisedProblem::Contact& contact = problem.contact(c);
        const double rn = r[2 * c], rt = std::abs(r[2 * c + 1]);
        const double slack = error + 1e-12 * (std::abs(rn) + rt);
        if (contact.bilateral())
            return contact.bilateralRows == BilateralRows::Both || rt <= slack;
        return rn >= -slack && rt <= contact.mu * rn + (1.0 + contact.mu) * slack;
    });
}

} // namespace

Solver::Solver() : impl_(std::make_unique<Impl>()) {}
Solver::~Solver() = default;
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;

SolveReport Solver::solve(const Problem& problem, const SolverOptions& options, Eigen::VectorXd& r,
                          std::vector<Eigen::VectorXd>& v, const parallel::For& loop) {
    SolveReport report;
    Impl& s = *impl_;
    s.loop = loop;
    r.setZero(2 * static_cast<Eigen::Index>(problem.contacts.size()));
    report.error = s.normalised.build(problem, loop);
    if (!report.error.empty()) {
        report.contactResidual = std::numeric_limits<double>::infinity();
        v.resize(problem.bodies.size());
        for (std::size_t b = 0; b < v.size(); ++b)
            v[b] = problem.bodies[b].vFree;
        return report;
    }
    s.target = {options.tolerance, options.absoluteImpulse, s.normalised.speedRoundOff()};
    s.x.start(s.normalised, problem.r0);
    s.run(options, report);

    // The residual is that of newly assembled velocities, so that the result is consistent to round-off.
    if (!s.bestIsAssembled) {
        s.normalised.assemble(s.best.r, s.x.w, loop);
        s.best.residual = s.normalised.residual(s.best.r, s.x.w, loop);
    }
    const Residual& residual = s.best.residual;
    report.converged = s.target.reached(residual);
    report.contactResidual = s.target.isRoundOff(residual) ? std::min(residual.contactResidual, options.tolerance)
                                                           : residual.contactResidual;
    report.byAbsoluteFloor = report.converged && report.contactResidual > options.tolerance;
    report.penetrationSpeed = residual.penetrationSpeed;
    report.impulseError = residual.impulseError;
    for (std::size_t c = 0; c < problem.contacts.size(); ++c)
        report.activeContacts += s.best.r[2 * c] > 0.0 || s.normalised.contact(c).bilateral() ? 1 : 0;
    for (std::size_t i = 0; i < s.best.r.size(); ++i)
        r[static_cast<Eigen::Index>(i)] = s.best.r[i];
    s.normalised.bodyVelocities(s.x.w, v, loop);
    SC_ASSERT(s.best.r.size() == 2 * problem.contacts.size(), "two impulses a contact");
    SC_ASSERT(r.allFinite(), "impulses are finite, whatever the method");
    SC_ASSERT(!report.converged || insideCones(s.normalised, s.best.r, residual.impulseError),
              "r_n >= 0 and |r_t| <= mu r_n");
    SC_ASSERT(!(report.contactResidual < 0.0) && !(report.penetrationSpeed < 0.0), "an error is not negative");
    SC_ASSERT(v.size() == problem.bodies.size(), "one velocity a body");
    SC_ASSERT(report.activeContacts >= 0 && static_cast<std::size_t>(report.activeContacts) <= problem.contacts.size(),
              "an active contact is counted once");
    SC_ASSERT(report.pivots >= 0 && report.gaussSeidelIterations >= 0, "counts are not negative");
    SC_ASSERT_EXPENSIVE(
        invariants::forAll(v.size(), [&](std::size_t b) { return v[b].size() == problem.bodies[b].vFree.size(); }),
        "one velocity for each degree of freedom");
    return report;
}

} // namespace supercircle::coulomb
