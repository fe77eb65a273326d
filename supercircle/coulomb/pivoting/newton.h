#pragma once
// Proximal active-set (semismooth) Newton with a line search on the contact residual: the fallback after path
// following.

#include "supercircle/coulomb/pivoting/status_system.h"
#include "supercircle/coulomb/solver.h"
#include "supercircle/coulomb/strategy/solver_state.h"

#include <span>
#include <vector>

namespace supercircle::coulomb {

class Newton {
public:
    /// Improves x on the contacts of `island` until sum d |F|^2 <= allowed (J) or no step helps; at most `most` steps.
    /// Never increases the residual. Returns the number of factorisations.
    int run(const MassNormalisedProblem& problem, std::span<const std::int32_t> island, double eps, int most,
            double allowed, SolverState& x, SolveEffort& effort);

private:
    double errorOf(const MassNormalisedProblem& problem, std::span<const std::int32_t> island,
                   const std::vector<double>& r);
    void chooseStatuses(const MassNormalisedProblem& problem, std::span<const std::int32_t> island,
                        const SolverState& x, double eps);

    std::vector<ContactStatus> status_;
    std::vector<double> rhs_, step_, trial_, trialW_;
    StatusSystem system_;
};

} // namespace supercircle::coulomb
