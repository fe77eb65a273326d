#pragma once
// Block Gauss-Seidel on the mass-normalised velocities, with the exact law of each contact; plain and accelerated.

#include "supercircle/coulomb/strategy/solver_state.h"

#include <span>

namespace supercircle::coulomb {

class GaussSeidel {
public:
    /// Prepares the local laws and the order of the contacts.
    void prepare(const MassNormalisedProblem& problem);

    /// One iteration over all contacts; returns sum d |dr|^2 (J).
    double iterate(const MassNormalisedProblem& problem, SolverState& x) const;

    /// `iterations` plain iterations over some contacts only, in the given order.
    void iterateSome(const MassNormalisedProblem& problem, std::span<const std::int32_t> contacts, int iterations,
                     SolverState& x) const;

    /// Up to `iterations` plain iterations. Evaluates the residual at times, offers to `best`, stops at `target`.
    int run(const MassNormalisedProblem& problem, SolverState& x, int iterations, const SolveTarget& target,
            BestSolution& best) const;

    /// The same with nonlinear conjugate-gradient acceleration.
    int runAccelerated(const MassNormalisedProblem& problem, SolverState& x, int iterations, const SolveTarget& target,
                       BestSolution& best);

private:
    double update(const MassNormalisedProblem& problem, std::int32_t c, SolverState& x) const;

    std::vector<LocalLaw> law_;
    std::vector<std::int32_t> order_;
    std::vector<std::int32_t> rank_;
    std::vector<std::int32_t> seen_;
    std::vector<double> previousR_, previousW_, directionR_, directionW_;
};

} // namespace supercircle::coulomb
