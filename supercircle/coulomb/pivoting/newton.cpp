// Newton fails from a poor set of statuses, so it is not the main method; from a good set it takes a few steps. The
// statuses come from the exact law of each contact alone, given the present velocities.

#include "supercircle/coulomb/pivoting/newton.h"

#include "supercircle/support/invariants.h"

#include <algorithm>

namespace supercircle::coulomb {

double Newton::errorOf(const MassNormalisedProblem& problem, std::span<const std::int32_t> island,
                       const std::vector<double>& r) {
    problem.assemble(r, trialW_);
    ResidualSum sum;
    for (const std::int32_t c : island) {
        const MassNormalisedProblem::Contact& contact = problem.contact(c);
        const MassNormalisedProblem::Velocity u = problem.velocity(contact, trialW_.data());
        MassNormalisedProblem::addResidual(contact, u, r[2 * c], r[2 * c + 1], sum);
    }
    return sum.error();
}

/// Chooses statuses, and the right-hand side that brings the closed rows to rest from r projected on them.
void Newton::chooseStatuses(const MassNormalisedProblem& problem, std::span<const std::int32_t> island,
                            const SolverState& x, double eps) {
    trial_ = x.r;
    for (std::size_t k = 0; k < island.size(); ++k) {
        const std::size_t c = static_cast<std::size_t>(island[k]);
        const MassNormalisedProblem::Contact& contact = problem.contact(c);
        const MassNormalisedProblem::Velocity u = problem.velocity(contact, x.w.data());
        double& rn = trial_[2 * c];
        double& rt = trial_[2 * c + 1];
        const LocalLaw law = contact.law();
        const LocalImpulse local =
            law.solve(u.n - contact.Wnn * rn - contact.Wnt * rt, u.t - contact.Wnt * rn - contact.Wtt * rt);
        status_[k] =
            local.status != ContactStatus::Open && contact.frictionless() ? ContactStatus::SlipPlus : local.status;
        if (status_[k] == ContactStatus::Open)
            rn = rt = 0.0;
        else if (status_[k] != ContactStatus::Stick)
            rt = -slipSign(status_[k]) * contact.mu * rn;
    }
    problem.assemble(trial_, trialW_);
    for (std::size_t k = 0; k < island.size(); ++k) {
        const std::size_t c = static_cast<std::size_t>(island[k]);
        const MassNormalisedProblem::Contact& contact = problem.contact(c);
        const MassNormalisedProblem::Velocity u = problem.velocity(contact, trialW_.data());
        rhs_[2 * k] = -u.n - eps * contact.d * (trial_[2 * c] - x.r[2 * c]);
        rhs_[2 * k + 1] = -u.t - eps * contact.d * (trial_[2 * c + 1] - x.r[2 * c + 1]);
    }
}

int Newton::run(const MassNormalisedProblem& problem, std::span<const std::int32_t> island, double eps, int most,
                double allowed, SolverState& x, SolveEffort& effort) {
    SC_ASSERT(x.r.size() == 2 * problem.contactCount(), "two impulses a contact");
    SC_ASSERT(eps > 0.0 && most >= 0 && !(allowed < 0.0), "the proximal problem is regular");
    status_.resize(island.size());
    rhs_.resize(2 * island.size());
    step_.resize(2 * island.size());
    double error = errorOf(problem, island, x.r);
    int steps = 0;
    for (; steps < most && !(error <= allowed);) {
        ++steps;
        chooseStatuses(problem, island, x, eps);
        effort.visits += 4.0 * static_cast<double>(problem.contactCount());
        if (!system_.factor(problem, island, status_, eps))
            return steps;
        effort.factors += system_.cost();
        system_.setRightHandSide(rhs_);
        if (!system_.solve(step_))
            return steps;
        for (std::size_t k = 0; k < island.size(); ++k)
            for (std::size_t i = 0; i < 2; ++i) {
                const std::size_t at = 2 * static_cast<std::size_t>(island[k]) + i;
                step_[2 * k + i] += trial_[at] - x.r[at]; // from x, via its projection on the statuses
            }
        bool better = false;
        for (double length = 1.0; length > 0.01 && !better; length *= 0.5) {
            trial_ = x.r;
            for (std::size_t k = 0; k < island.size(); ++k) {
                const std::size_t c = static_cast<std::size_t>(island[k]);
                trial_[2 * c] += length * step_[2 * k];
                trial_[2 * c + 1] += length * step_[2 * k + 1];
                problem.contact(c).project(trial_[2 * c], trial_[2 * c + 1]);
            }
            const double now = errorOf(problem, island, trial_);
            better = now < 0.99 * error;
            if (better) {
                SC_ASSERT(now < error, "Newton never increases the residual");
                error = now;
                x.r = trial_;
                x.w = trialW_;
            }
        }
        if (!better)
            return steps;
    }
    return steps;
}

} // namespace supercircle::coulomb
