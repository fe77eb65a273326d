// Order. Contacts arrive grouped by pair of bodies. Two consecutive contacts of the same pair wait for each other's
// velocity update, and this latency limits the iteration (25 instead of 15 ns per contact). Therefore all first
// contacts of the pairs are visited, then all second ones, and so on. The order is fixed and independent of addresses.
//
// Acceleration. One iteration is a map F. F(r) - r acts as a descent direction, with Fletcher-Reeves coefficients
// (Silcowitz-Hansen, Niebe & Erleben 2010). r and the velocities are extrapolated alike, so nothing is recomputed.
// Anderson mixing and over-relaxation bring no consistent gain on loaded nests (decision 0125).

#include "supercircle/coulomb/gauss_seidel/gauss_seidel.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace supercircle::coulomb {

void SolverState::findStatuses(const MassNormalisedProblem& problem) {
    SC_ASSERT(status.size() == problem.contactCount() && r.size() == 2 * status.size(), "one status a contact");
    for (std::size_t c = 0; c < status.size(); ++c) {
        const double rn = r[2 * c];
        const double rt = r[2 * c + 1];
        if (problem.contact(c).bilateral())
            status[c] = problem.contact(c).frictionless() ? ContactStatus::SlipPlus : ContactStatus::Stick;
        else if (!(rn > 0.0))
            status[c] = ContactStatus::Open;
        else if (std::abs(rt) < problem.contact(c).mu * rn * (1.0 - 1e-9)) // scaling with dt leaves round-off
            status[c] = ContactStatus::Stick;
        else
            status[c] = rt < 0.0 ? ContactStatus::SlipPlus : ContactStatus::SlipMinus;
    }
}

void SolverState::start(const MassNormalisedProblem& problem, const Eigen::VectorXd& warm) {
    const std::size_t count = problem.contactCount();
    SC_ASSERT(warm.size() == 0 || static_cast<std::size_t>(warm.size()) == 2 * count, "two numbers a contact");
    r.assign(2 * count, 0.0);
    status.assign(count, ContactStatus::Open);
    for (std::size_t c = 0; c < count && warm.size() > 0; ++c) {
        r[2 * c] = warm[static_cast<Eigen::Index>(2 * c)];
        r[2 * c + 1] = warm[static_cast<Eigen::Index>(2 * c + 1)];
        problem.contact(c).project(r[2 * c], r[2 * c + 1]);
    }
    SC_ASSERT_EXPENSIVE(
        invariants::forAll(count, [&](std::size_t c) { return problem.contact(c).bilateral() || !(r[2 * c] < 0.0); }),
        "a projected warm start does not pull");
    findStatuses(problem);
    problem.assemble(r, w);
}

bool BestSolution::offer(const std::vector<double>& candidate, const Residual& value) {
    SC_ASSERT(r.empty() || r.size() == candidate.size(), "candidates of one problem have one size");
    SC_ASSERT(!(value.contactResidual < 0.0) && !(value.impulseError < 0.0), "an error is not negative");
    if (!r.empty() && !(value.contactResidual < residual.contactResidual))
        return false;
    r = candidate;
    residual = value;
    return true;
}

void GaussSeidel::prepare(const MassNormalisedProblem& problem) {
    const std::size_t count = problem.contactCount();
    law_.resize(count);
    order_.resize(count);
    rank_.resize(count);
    seen_.assign(problem.bodyCount() + 1, 0);
    for (std::size_t c = 0; c < count; ++c) {
        const MassNormalisedProblem::Contact& contact = problem.contact(c);
        law_[c] = contact.law();
        std::int32_t rank = 0;
        for (std::int32_t s = 0; s < contact.sides; ++s)
            rank = std::max(rank, seen_[contact.side[s].body]);
        for (std::int32_t s = 0; s < contact.sides; ++s)
            seen_[contact.side[s].body] = rank + 1;
        rank_[c] = rank;
    }
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(),
              [this](std::int32_t a, std::int32_t b) { return rank_[a] != rank_[b] ? rank_[a] < rank_[b] : a < b; });
    SC_ASSERT_EXPENSIVE(invariants::strictlyRising(order_, [this](std::int32_t c) { return std::pair(rank_[c], c); }),
                        "every contact is visited once");
}

/// The exact law of contact c at the present velocities; returns d |dr|^2.
inline double GaussSeidel::update(const MassNormalisedProblem& problem, std::int32_t c, SolverState& x) const {
    const MassNormalisedProblem::Contact& contact = problem.contacts()[c];
    double* w = x.w.data();
    double& rn = x.r[2 * c];
    double& rt = x.r[2 * c + 1];
    if (rn == 0.0 && rt == 0.0 && !contact.bilateral() && problem.normalProduct(contact, w) + contact.wn >= 0.0) {
        x.status[c] = ContactStatus::Open;
        return 0.0;
    }
    const MassNormalisedProblem::Velocity u = problem.velocity(contact, w);
    const LocalImpulse next =
        law_[c].solve(u.n - contact.Wnn * rn - contact.Wnt * rt, u.t - contact.Wnt * rn - contact.Wtt * rt);
    const double dn = next.n - rn;
    const double dt = next.t - rt;
    x.status[c] = next.status;
    rn = next.n;
    rt = next.t;
    problem.apply(contact, dn, dt, w);
    return contact.d * (dn * dn + dt * dt);
}

double GaussSeidel::iterate(const MassNormalisedProblem& problem, SolverState& x) const {
    SC_ASSERT(order_.size() == problem.contactCount() && x.r.size() == 2 * order_.size(), "prepared for this problem");
    double change = 0.0;
    for (const std::int32_t c : order_)
        change += update(problem, c, x);
    SC_ASSERT(!(change < 0.0), "the change of an iteration is a sum of squares");
    return change;
}

void GaussSeidel::iterateSome(const MassNormalisedProblem& problem, std::span<const std::int32_t> contacts,
                              int iterations, SolverState& x) const {
    SC_ASSERT(law_.size() == problem.contactCount() && x.r.size() == 2 * law_.size(), "prepared for this problem");
    SC_ASSERT_EXPENSIVE(
        invariants::forAll(contacts.size(),
                           [&](std::size_t k) { return invariants::inRange(contacts[k], law_.size()); }),
        "contacts of the problem");
    for (int done = 0; done < iterations; ++done)
        for (const std::int32_t c : contacts)
            update(problem, c, x);
}

namespace {

/// The evaluation costs about half an iteration: frequent at first, where a warm start may suffice, then rare.
bool timeToEvaluate(int done, int iterations) {
    return done == iterations || done == 1 || done == 3 || done == 6 || done % 10 == 0;
}

} // namespace

int GaussSeidel::run(const MassNormalisedProblem& problem, SolverState& x, int iterations, const SolveTarget& target,
                     BestSolution& best) const {
    for (int done = 1; done <= iterations; ++done) {
        iterate(problem, x);
        if (!timeToEvaluate(done, iterations))
            continue;
        if (done % 50 == 0)
            problem.assemble(x.r, x.w); // round-off of the incremental velocities
        const Residual residual = problem.residual(x.r, x.w);
        best.offer(x.r, residual);
        if (target.reached(residual))
            return done;
    }
    return iterations;
}

int GaussSeidel::runAccelerated(const MassNormalisedProblem& problem, SolverState& x, int iterations,
                                const SolveTarget& target, BestSolution& best) {
    SC_ASSERT(x.r.size() == 2 * problem.contactCount(), "two impulses a contact");
    directionR_.assign(x.r.size(), 0.0);
    directionW_.assign(x.w.size(), 0.0);
    double lastChange = std::numeric_limits<double>::infinity();
    for (int done = 1; done <= iterations; ++done) {
        previousR_ = x.r;
        previousW_ = x.w;
        const double change = iterate(problem, x);
        if (timeToEvaluate(done, iterations)) {
            if (done % 50 == 0)
                problem.assemble(x.r, x.w);
            const Residual residual = problem.residual(x.r, x.w);
            best.offer(x.r, residual);
            if (target.reached(residual) || done == iterations)
                return done;
        }
        // F(r) - r acts as the gradient. If it grows, the search direction is discarded.
        const double beta = change / lastChange;
        const bool restart = !(beta <= 1.0);
        lastChange = change;
        const double keep = restart ? 0.0 : beta;
        for (std::size_t i = 0; i < x.r.size(); ++i) {
            const double step = x.r[i] - previousR_[i];
            x.r[i] += keep * directionR_[i];
            directionR_[i] = keep * directionR_[i] + step;
        }
        for (std::size_t i = 0; i < x.w.size(); ++i) {
            const double step = x.w[i] - previousW_[i];
            x.w[i] += keep * directionW_[i];
            directionW_[i] = keep * directionW_[i] + step;
        }
    }
    return iterations;
}

} // namespace supercircle::coulomb
