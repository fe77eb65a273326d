// Order. Contacts arrive grouped by body pair; two neighbours on the same pair wait for each other's velocity update,
// and latency, not arithmetic, limits a sweep (15 against 25 ns a contact on the machine this was designed on). So all
// first contacts of the pairs are visited, then all second ones, and so on: fixed, and independent of addresses.
//
// Acceleration. One sweep is a map F; g = F(r) - r plays the part of a descent direction and Fletcher-Reeves that of
// the step (Silcowitz-Hansen, Niebe & Erleben 2010). Both r and the whitened velocities are extrapolated alike, so
// nothing is recomputed. Anderson mixing and over-relaxation gained nothing consistent on loaded nests.

#include "supercircle/coulomb/gauss_seidel/gauss_seidel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace supercircle::coulomb {

void Iterate::findPieces(const Whitened& problem) {
    for (std::size_t c = 0; c < piece.size(); ++c) {
        const double rn = r[2 * c];
        const double rt = r[2 * c + 1];
        if (problem.contact(c).tied())
            piece[c] = problem.contact(c).smooth() ? Piece::SlipPlus : Piece::Stick;
        else if (!(rn > 0.0))
            piece[c] = Piece::Open;
        else if (std::abs(rt) < problem.contact(c).mu * rn * (1.0 - 1e-9)) // scaling with dt leaves round-off
            piece[c] = Piece::Stick;
        else
            piece[c] = rt < 0.0 ? Piece::SlipPlus : Piece::SlipMinus;
    }
}

void Iterate::start(const Whitened& problem, const Eigen::VectorXd& warm) {
    const std::size_t count = problem.contactCount();
    r.assign(2 * count, 0.0);
    piece.assign(count, Piece::Open);
    for (std::size_t c = 0; c < count && warm.size() > 0; ++c) {
        r[2 * c] = warm[static_cast<Eigen::Index>(2 * c)];
        r[2 * c + 1] = warm[static_cast<Eigen::Index>(2 * c + 1)];
        problem.contact(c).project(r[2 * c], r[2 * c + 1]);
    }
    findPieces(problem);
    problem.assemble(r, w);
}

bool Best::offer(const std::vector<double>& candidate, const Residual& value) {
    if (!r.empty() && !(value.eta < residual.eta))
        return false;
    r = candidate;
    residual = value;
    return true;
}

void GaussSeidel::prepare(const Whitened& problem) {
    const std::size_t count = problem.contactCount();
    law_.resize(count);
    order_.resize(count);
    rank_.resize(count);
    seen_.assign(problem.bodyCount() + 1, 0);
    for (std::size_t c = 0; c < count; ++c) {
        const Whitened::Contact& contact = problem.contact(c);
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
}

/// The exact law of contact c at the present velocities; returns d |dr|^2.
inline double GaussSeidel::update(const Whitened& problem, std::int32_t c, Iterate& x) const {
    const Whitened::Contact& contact = problem.contacts()[c];
    double* w = x.w.data();
    double& rn = x.r[2 * c];
    double& rt = x.r[2 * c + 1];
    if (rn == 0.0 && rt == 0.0 && !contact.tied() && problem.normalProduct(contact, w) + contact.wn >= 0.0) {
        x.piece[c] = Piece::Open;
        return 0.0;
    }
    const Whitened::Velocity u = problem.velocity(contact, w);
    const LocalImpulse next =
        law_[c].solve(u.n - contact.Wnn * rn - contact.Wnt * rt, u.t - contact.Wnt * rn - contact.Wtt * rt);
    const double dn = next.n - rn;
    const double dt = next.t - rt;
    x.piece[c] = next.piece;
    rn = next.n;
    rt = next.t;
    problem.apply(contact, dn, dt, w);
    return contact.d * (dn * dn + dt * dt);
}

double GaussSeidel::sweep(const Whitened& problem, Iterate& x) const {
    double change = 0.0;
    for (const std::int32_t c : order_)
        change += update(problem, c, x);
    return change;
}

void GaussSeidel::sweepSome(const Whitened& problem, std::span<const std::int32_t> contacts, int sweeps,
                            Iterate& x) const {
    for (int done = 0; done < sweeps; ++done)
        for (const std::int32_t c : contacts)
            update(problem, c, x);
}

namespace {

/// Judging costs about half a sweep: often at first, where a warm start may already be good, then more rarely.
bool timeToJudge(int done, int sweeps) {
    return done == sweeps || done == 1 || done == 3 || done == 6 || done % 10 == 0;
}

} // namespace

int GaussSeidel::run(const Whitened& problem, Iterate& x, int sweeps, const Target& target, Best& best) const {
    for (int done = 1; done <= sweeps; ++done) {
        sweep(problem, x);
        if (!timeToJudge(done, sweeps))
            continue;
        if (done % 50 == 0)
            problem.assemble(x.r, x.w); // round-off of the incremental velocities
        const Residual residual = problem.residual(x.r, x.w);
        best.offer(x.r, residual);
        if (target.reached(residual))
            return done;
    }
    return sweeps;
}

int GaussSeidel::runAccelerated(const Whitened& problem, Iterate& x, int sweeps, const Target& target, Best& best) {
    directionR_.assign(x.r.size(), 0.0);
    directionW_.assign(x.w.size(), 0.0);
    double lastChange = std::numeric_limits<double>::infinity();
    for (int done = 1; done <= sweeps; ++done) {
        previousR_ = x.r;
        previousW_ = x.w;
        const double change = sweep(problem, x);
        if (timeToJudge(done, sweeps)) {
            if (done % 50 == 0)
                problem.assemble(x.r, x.w);
            const Residual residual = problem.residual(x.r, x.w);
            best.offer(x.r, residual);
            if (target.reached(residual) || done == sweeps)
                return done;
        }
        // The difference F(r) - r is the "gradient"; a growing one means the direction has gone stale.
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
    return sweeps;
}

} // namespace supercircle::coulomb
