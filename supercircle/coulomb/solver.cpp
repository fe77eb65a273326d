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

#include "supercircle/coulomb/strategy/cascade.h"

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

constexpr std::array kTries{Try{0, 1e-6, 0.3}, Try{0, 1e-8, 1.0}, Try{30, 1e-5, 1.0}, Try{60, 1e-7, 0.3},
                            Try{100, 1e-4, 3.0}};

/// Straight from the pieces of a warm start, no sweep before. They take few pivots or go astray: a small cap.
constexpr std::array kWarmTries{Try{0, 1e-7, 0.3}, Try{0, 1e-9, 1.0}};
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

} // namespace

/// Judges x freshly, keeps it if it is the best; true if it meets the target.
bool Solver::Impl::judgeNow(Method method, SolveReport& report) {
    whitened.assemble(x.r, x.w, loop);
    if (best.offer(x.r, whitened.residual(x.r, x.w, loop)))
        report.finishedBy = method;
    return target.reached(best.residual);
}

void Solver::Impl::restoreBest() {
    x.r = best.r;
    x.findPieces(whitened);
    whitened.assemble(x.r, x.w, loop);
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

/// An island's share of what the target allows, J.
double Solver::Impl::allowedError() const {
    return 0.9 * target.eta * target.eta * best.residual.scale /
           static_cast<double>(std::max<std::size_t>(1, islands.count()));
}

void Solver::Impl::allowPivots(const SolverOptions& options) {
    const double load = static_cast<double>(loaded());
    const double most = kBudget * options.maxPivots * std::max(1.0, load / 150.0);
    pivotsLeft = static_cast<int>(std::min(most, kMostWork / std::max(1.0, load)));
}

/// Islands share nothing, so each may have its own thread. What counts is as if they had come one after the other:
/// those for which no pivots were left by then are put back. False if a path did not arrive.
bool Solver::Impl::runPaths(const PathSettings& settings, SolveReport& report) {
    const std::size_t count = islands.count();
    const bool together = loop && count > 1;
    const double allowed = allowedError();
    if (together)
        kept = x;
    if (turns.size() < count)
        turns.resize(count);
    const auto run = [&](std::size_t i) {
        Turn& turn = turns[i];
        turn.ran = false;
        turn.arrived = true;
        turn.counts = {};
        const std::span<const std::int32_t> island = islands.contacts(i);
        if (islandError(island) <= allowed || loaded(island) > kPathLimit)
            return;
        turn.ran = true;
        const parallel::Pool<Path>::Loan path(pathPool);
        const Path::Outcome outcome = path->run(whitened, island, {}, settings, allowed, x, turn.counts);
        turn.arrived = outcome == Path::Outcome::Solved || outcome == Path::Outcome::Stalled;
    };
    if (together)
        parallel::forEach(loop, count, 1, run);
    PathCounts counts;
    bool arrived = true;
    for (std::size_t i = 0; i < count; ++i) {
        if (counts.pivots >= pivotsLeft) {
            if (together && turns[i].ran)
                undo(islands.contacts(i));
            continue;
        }
        if (!together)
            run(i);
        counts.pivots += turns[i].counts.pivots;
        counts.factorisations += turns[i].counts.factorisations;
        arrived = arrived && turns[i].arrived;
    }
    book(counts, report);
    return arrived;
}

void Solver::Impl::undo(std::span<const std::int32_t> island) {
    for (const std::int32_t c : island) {
        x.r[2 * c] = kept.r[2 * c];
        x.r[2 * c + 1] = kept.r[2 * c + 1];
        x.piece[c] = kept.piece[c];
        const Whitened::Contact& contact = whitened.contact(c);
        for (std::int32_t s = 0; s < contact.sides; ++s) {
            const auto at = static_cast<std::ptrdiff_t>(contact.side[s].velocity);
            std::copy_n(kept.w.begin() + at, contact.side[s].padded, x.w.begin() + at);
        }
    }
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
                          std::vector<Eigen::VectorXd>& v, const parallel::For& loop) {
    SolveReport report;
    Impl& s = *impl_;
    s.loop = loop;
    r.setZero(2 * static_cast<Eigen::Index>(problem.contacts.size()));
    report.error = s.whitened.build(problem, loop);
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
    s.whitened.assemble(s.best.r, s.x.w, loop);
    const Residual residual = s.whitened.residual(s.best.r, s.x.w, loop);
    report.converged = s.target.reached(residual);
    report.eta = residual.eta;
    report.penetrationSpeed = residual.penetrationSpeed;
    report.impulseError = residual.impulseError;
    for (std::size_t c = 0; c < problem.contacts.size(); ++c)
        report.loaded += s.best.r[2 * c] > 0.0 || s.whitened.contact(c).tied() ? 1 : 0;
    for (std::size_t i = 0; i < s.best.r.size(); ++i)
        r[static_cast<Eigen::Index>(i)] = s.best.r[i];
    s.whitened.bodyVelocities(s.x.w, v, loop);
    return report;
}

} // namespace supercircle::coulomb
