// The cascade. Measured on stacks of nested shells, which never settle under sweeps of any kind:
//
//   - A warm start brings the pieces of the last step along. Some ten contacts of a hundred change theirs, and the path
//     finds them in 10 to 30 pivots from where the last step ended. Sweeps before it do harm: one to five unsettle
//     pieces that were right (56 to 84 pivots instead of 28), forty cost more than the path itself.
//   - A cold start has no pieces: 40 sweeps guess them.
//   - A path visits the whole island at every pivot, and a large island needs more pivots as well. So islands of more
//     than a stack are solved in overlapping regions first. Regions of one size converge slowly (a factor 0.7 a pass),
//     but a few passes, from the third on with regions twice as large each time, settle nearly all pieces, and the path
//     of the whole then needs a few pivots: 3200 contacts in 25 ms instead of 340, and the time grows in proportion to
//     the contacts. Newton in place of that last path helps not at all: a single wrong piece makes it useless.
//   - What the path cannot solve at first try (a ray, a wandering or stalled path) it solves after some more sweeps
//     with another proximal term and other slacks; Newton and long accelerated sweeps are the last resort, and for
//     contradictory constraints, where nothing can arrive, they decide how good the best iterate is.
//
// Every stage has a cap.

#include "supercircle/coulomb/solver.h"

#include "supercircle/coulomb/gauss_seidel.h"
#include "supercircle/coulomb/islands.h"
#include "supercircle/coulomb/newton.h"
#include "supercircle/coulomb/path.h"
#include "supercircle/coulomb/regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supercircle::coulomb {

std::string_view name(Method m) {
    switch (m) {
    case Method::Cascade:
        return "cascade";
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

/// One try of the path: sweeps before it, proximal term, slacks.
struct Try {
    int sweeps;
    double eps;
    double slack;
};
constexpr std::array kTries{Try{0, 1e-6, 0.3}, Try{0, 1e-8, 1.0}, Try{30, 1e-5, 1.0}, Try{60, 1e-7, 0.3},
                            Try{100, 1e-4, 3.0}};

/// Straight from the pieces of a warm start, no sweep before. They take few pivots or go astray: a small cap.
constexpr std::array kWarmTries{Try{0, 1e-7, 0.3}, Try{0, 1e-9, 1.0}};
constexpr int kWarmPivots = 150;
constexpr std::size_t kFewContacts = 60;
constexpr int kFewSweeps = 3;

/// A strong proximal term makes any problem tame; from its solution down to the wanted one in small steps.
constexpr std::array kLadder{1.0, 0.3, 0.1, 0.03, 1e-2, 3e-3, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12};
constexpr int kLadders = 3;
constexpr std::uint32_t kQuickTries = 2;

/// Above this many loaded contacts in one island even the sparse factor costs more than long accelerated sweeps.
constexpr std::size_t kPathLimit = 20000;
/// All paths of one solve together may take this many times the pivots of one: a problem without solution must end.
constexpr int kBudget = 5;
constexpr double kMostWork = 4e7; ///< pivots times loaded contacts: a large problem without solution must end, too
constexpr int kNewtonSteps = 30;

/// Islands with more loaded contacts than this are first solved region by region.
constexpr std::size_t kRegionLoad = 200;
constexpr std::size_t kRegionSize = 180; ///< contacts; doubled with every pass after the second
constexpr int kRegionPivots = 80;        ///< a pass with fewer pivots is the last one
constexpr int kRegionMost = 150; ///< pivots of one region; with 600 the hopeless ones of cold starts eat the budget
constexpr std::uint32_t kRegionPasses = 8;
constexpr int kRegionDiscount = 16;  ///< so many pivots in a region count as one of the whole
constexpr double kRegionSkip = 0.1;  ///< of the present mean error: contacts below need no region of their own
constexpr double kRegionShare = 0.1; ///< of the error a contact may keep in the end

} // namespace

struct Solver::Impl {
    Whitened whitened;
    GaussSeidel sweeps;
    Islands islands;
    Regions regions;
    std::vector<std::uint8_t> covered;
    Path path;
    Newton newton;
    Iterate x, start;
    Best best;
    Target target;
    int pivotsLeft = 0;

    void run(const SolverOptions& options, SolveReport& report);
    bool judgeNow(Method method, SolveReport& report);
    void restoreBest();
    double islandError(std::span<const std::int32_t> island) const;
    std::size_t loaded(std::span<const std::int32_t> island) const;
    std::size_t loaded() const;
    void allowPivots(const SolverOptions& options);
    void runPaths(const PathSettings& settings, SolveReport& report);
    bool tryPath(const Try& settings, std::uint32_t seed, const SolverOptions& options, SolveReport& report);
    bool tryLadder(std::uint32_t seed, const SolverOptions& options, SolveReport& report);
    double contactError(std::int32_t c) const;
    void passRegions(std::span<const std::int32_t> island, double allowed, std::uint32_t seed, std::size_t size,
                     PathCounts& counts);
    bool tryRegions(std::uint32_t seed, const SolverOptions& options, SolveReport& report);
    void book(const PathCounts& counts, SolveReport& report);
    bool tryFew(SolveReport& report);
    bool tryWarm(const SolverOptions& options, SolveReport& report);
    bool tryNewton(SolveReport& report);
    bool tryAccelerated(int count, SolveReport& report);
    template <class Visit>
    void forEachUnsolved(Visit&& visit);
};

/// Judges x freshly, keeps it if it is the best; true if it meets the target.
bool Solver::Impl::judgeNow(Method method, SolveReport& report) {
    whitened.assemble(x.r, x.w);
    if (best.offer(x.r, whitened.residual(x.r, x.w)))
        report.finishedBy = method;
    return target.reached(best.residual);
}

void Solver::Impl::restoreBest() {
    x.r = best.r;
    x.findPieces(whitened);
    whitened.assemble(x.r, x.w);
}

double Solver::Impl::islandError(std::span<const std::int32_t> island) const {
    ResidualSum sum;
    for (const std::int32_t c : island) {
        const Whitened::Contact& contact = whitened.contact(c);
        const Whitened::Velocity u = whitened.velocity(contact, x.w.data());
        Whitened::judge(contact, u, x.r[2 * c], x.r[2 * c + 1], sum);
    }
    return sum.error();
}

std::size_t Solver::Impl::loaded(std::span<const std::int32_t> island) const {
    return static_cast<std::size_t>(std::count_if(island.begin(), island.end(), [this](std::int32_t c) {
        return x.r[2 * c] > 0.0 || whitened.contact(c).tied();
    }));
}

std::size_t Solver::Impl::loaded() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < islands.count(); ++i)
        count += loaded(islands.contacts(i));
    return count;
}

/// Visits the islands whose error is above their share of what the target allows, with that share.
template <class Visit>
void Solver::Impl::forEachUnsolved(Visit&& visit) {
    const double allowed = 0.9 * target.eta * target.eta * best.residual.scale /
                           static_cast<double>(std::max<std::size_t>(1, islands.count()));
    for (std::size_t i = 0; i < islands.count(); ++i)
        if (!(islandError(islands.contacts(i)) <= allowed))
            visit(islands.contacts(i), allowed);
}

void Solver::Impl::allowPivots(const SolverOptions& options) {
    const double load = static_cast<double>(loaded());
    const double most = kBudget * options.maxPivots * std::max(1.0, load / 150.0);
    pivotsLeft = static_cast<int>(std::min(most, kMostWork / std::max(1.0, load)));
}

void Solver::Impl::runPaths(const PathSettings& settings, SolveReport& report) {
    PathCounts counts;
    forEachUnsolved([&](std::span<const std::int32_t> island, double allowed) {
        if (loaded(island) <= kPathLimit && counts.pivots < pivotsLeft)
            path.run(whitened, island, {}, settings, allowed, x, counts);
    });
    book(counts, report);
}

void Solver::Impl::book(const PathCounts& counts, SolveReport& report) {
    pivotsLeft -= counts.pivots;
    report.pivots += counts.pivots;
    report.factorisations += counts.factorisations;
}

bool Solver::Impl::tryPath(const Try& settings, std::uint32_t seed, const SolverOptions& options, SolveReport& report) {
    if (settings.sweeps > 0) {
        restoreBest();
        report.sweeps += sweeps.runAccelerated(whitened, x, settings.sweeps, target, best);
        if (judgeNow(Method::Accelerated, report))
            return true;
    }
    runPaths({settings.eps, settings.slack, seed, options.maxPivots, 20}, report);
    return judgeNow(Method::Path, report);
}

/// Proximal terms from strong to weak, each path starting where the last ended, a few proximal repeats each.
bool Solver::Impl::tryLadder(std::uint32_t seed, const SolverOptions& options, SolveReport& report) {
    restoreBest();
    for (const double eps : kLadder) {
        runPaths({eps, seed % 2 == 0 ? 1.0 : 0.1, seed, options.maxPivots, eps > 1e-5 ? 2 : 12}, report);
        if (judgeNow(Method::Path, report))
            return true;
    }
    return false;
}

double Solver::Impl::contactError(std::int32_t c) const {
    const std::array one{c};
    return islandError(one);
}

/// One path in the neighbourhood of every contact that is not at rest yet; cores do not overlap.
void Solver::Impl::passRegions(std::span<const std::int32_t> island, double allowed, std::uint32_t seed,
                               std::size_t size, PathCounts& counts) {
    const double share =
        std::max(kRegionShare * allowed, kRegionSkip * islandError(island)) / static_cast<double>(island.size());
    for (const std::int32_t c : island) {
        if (covered[c] || contactError(c) <= share)
            continue;
        const Region& region = regions.grow(whitened, c, size);
        for (const std::int32_t k : region.core)
            covered[k] = 1;
        const double most = share * static_cast<double>(region.contacts.size());
        path.run(whitened, region.contacts, region.outside, {1e-6, 0.3, seed, kRegionMost, 4}, most, x, counts);
    }
}

/// Large islands: paths in regions until the pieces hardly change any more, then one path of the whole island, which
/// has little left to do. A pivot of the whole costs as much as some tenth of a pass over all regions.
bool Solver::Impl::tryRegions(std::uint32_t seed, const SolverOptions& options, SolveReport& report) {
    regions.prepare(whitened);
    for (std::uint32_t round = 0; round < 2 && pivotsLeft > 0; ++round) {
        for (std::uint32_t pass = 0; pass < kRegionPasses; ++pass) {
            PathCounts counts;
            covered.assign(whitened.contactCount(), 0);
            forEachUnsolved([&](std::span<const std::int32_t> island, double allowed) {
                if (loaded(island) > kRegionLoad)
                    passRegions(island, allowed, seed + kRegionPasses * round + pass,
                                kRegionSize << (pass > 1 ? pass - 1 : 0), counts);
            });
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
            runPaths({eps, 0.3, seed, std::min(options.maxPivots, kWarmPivots), 20}, report);
            if (judgeNow(Method::Path, report))
                return true;
        }
    }
    return false;
}

/// A handful of contacts is often at rest after a sweep or three. If not, x is the start again: its pieces are better.
bool Solver::Impl::tryFew(SolveReport& report) {
    if (whitened.contactCount() > kFewContacts)
        return false;
    start = x;
    const double before = best.residual.eta;
    report.sweeps += sweeps.run(whitened, x, kFewSweeps, target, best);
    if (best.residual.eta < before)
        report.finishedBy = Method::GaussSeidel;
    if (target.reached(best.residual))
        return true;
    x = start;
    return false;
}

/// From the pieces the last step ended with. On failure x is the warm start again.
bool Solver::Impl::tryWarm(const SolverOptions& options, SolveReport& report) {
    const std::size_t load = loaded();
    if (load == 0)
        return false;
    const int most = std::min(options.maxPivots, kWarmPivots);
    if (load > kRegionLoad) {
        if (tryRegions(0, options, report))
            return true;
        restoreBest();
        return false;
    }
    for (std::uint32_t k = 0; k < kWarmTries.size(); ++k) {
        runPaths({kWarmTries[k].eps, kWarmTries[k].slack, k, most, 20}, report);
        if (judgeNow(Method::Path, report))
            return true;
    }
    restoreBest();
    return false;
}

bool Solver::Impl::tryNewton(SolveReport& report) {
    restoreBest();
    forEachUnsolved([&](std::span<const std::int32_t> island, double allowed) {
        if (loaded(island) <= kPathLimit)
            report.factorisations += newton.run(whitened, island, 1e-6, kNewtonSteps, allowed, x);
    });
    return judgeNow(Method::Newton, report);
}

bool Solver::Impl::tryAccelerated(int count, SolveReport& report) {
    restoreBest();
    const double before = best.residual.eta;
    report.sweeps += sweeps.runAccelerated(whitened, x, count, target, best);
    if (best.residual.eta < before)
        report.finishedBy = Method::Accelerated;
    return target.reached(best.residual);
}

void Solver::Impl::run(const SolverOptions& options, SolveReport& report) {
    report.finishedBy = Method::None;
    best.reset();
    if (judgeNow(Method::None, report) || options.method == Method::None)
        return;
    const bool paths = options.method == Method::Cascade || options.method == Method::Path;
    if (paths || options.method == Method::Newton) {
        islands.split(whitened);
        allowPivots(options);
    }
    sweeps.prepare(whitened);
    if (paths && (tryFew(report) || tryWarm(options, report)))
        return;
    const bool only = options.method == Method::GaussSeidel;
    const double before = best.residual.eta;
    report.sweeps += sweeps.run(whitened, x, only ? options.maxSweeps : options.firstSweeps, target, best);
    if (best.residual.eta < before)
        report.finishedBy = Method::GaussSeidel;
    if (only || target.reached(best.residual))
        return;
    if (options.method == Method::Accelerated) {
        tryAccelerated(options.maxSweeps, report);
        return;
    }
    allowPivots(options); // the sweeps know better what is loaded
    if (options.method == Method::Newton) {
        tryNewton(report);
        return;
    }
    if (loaded() > kRegionLoad) {
        if (tryRegions(100, options, report))
            return;
        restoreBest();
    }
    // Two quick tries, then a ladder before the slower ones: where the plain path wanders the ladder mostly does not.
    for (std::uint32_t k = 0; k < kTries.size() && pivotsLeft > 0; ++k)
        if (tryPath(kTries[k], k, options, report) || (k == kQuickTries - 1 && tryLadder(0, options, report)))
            return;
    if (options.method == Method::Path || tryNewton(report))
        return;
    for (std::uint32_t k = 1; k < kLadders && pivotsLeft > 0; ++k)
        if (tryLadder(k, options, report))
            return;
    if (!tryAccelerated(options.maxSweeps, report) && pivotsLeft > 0)
        tryPath({0, 1e-6, 1.0}, static_cast<std::uint32_t>(kTries.size()), options, report);
}

Solver::Solver() : impl_(std::make_unique<Impl>()) {}
Solver::~Solver() = default;
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;

SolveReport Solver::solve(const Problem& problem, const SolverOptions& options, Eigen::VectorXd& r,
                          std::vector<Eigen::VectorXd>& v) {
    SolveReport report;
    Impl& s = *impl_;
    r.setZero(2 * static_cast<Eigen::Index>(problem.contacts.size()));
    report.error = s.whitened.build(problem);
    if (!report.error.empty()) {
        report.eta = std::numeric_limits<double>::infinity();
        v.resize(problem.bodies.size());
        for (std::size_t b = 0; b < v.size(); ++b)
            v[b] = problem.bodies[b].vFree;
        return report;
    }
    s.target = {options.tolerance, options.absoluteImpulse};
    s.x.start(s.whitened, problem.r0);
    s.run(options, report);

    // The verdict is on freshly assembled velocities, so that what is returned is consistent to round-off.
    s.whitened.assemble(s.best.r, s.x.w);
    const Residual residual = s.whitened.residual(s.best.r, s.x.w);
    report.converged = s.target.reached(residual);
    report.eta = residual.eta;
    report.penetrationSpeed = residual.penetrationSpeed;
    report.impulseError = residual.impulseError;
    for (std::size_t c = 0; c < problem.contacts.size(); ++c)
        report.loaded += s.best.r[2 * c] > 0.0 || s.whitened.contact(c).tied() ? 1 : 0;
    for (std::size_t i = 0; i < s.best.r.size(); ++i)
        r[static_cast<Eigen::Index>(i)] = s.best.r[i];
    s.whitened.bodyVelocities(s.x.w, v);
    return report;
}

} // namespace supercircle::coulomb
