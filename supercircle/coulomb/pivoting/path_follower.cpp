// For given statuses the problem is linear, and the solution is a piecewise-linear function of the right-hand side.
// Newton jumps between statuses and cycles from a poor guess. Path following changes one contact at a time (decision
// 0126).
//  1 The proximal problem W + eps D, centred at the guess, regularises redundant (nested) contacts. The centre moves
//    to the solution and the step is repeated until the true residual is small enough, so the law stays exact.
//  2 The guess, put on its statuses with small slacks, solves the problem exactly for a shifted right-hand side.
//  3 tau runs from 0 (shifted) to 1 (true). At a breakpoint one contact changes its status, and tau continues in the
//    direction that moves this contact into it. It may run backwards, because the matrix is no P-matrix.
//  4 A ray (no breakpoint while tau runs backwards), tau < -20 or too many pivots end the path without a solution.

#include "supercircle/coulomb/pivoting/path_follower.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::coulomb {

namespace {

constexpr std::size_t kMostBorders = 40; // and one more for every 20 unknowns above 320
constexpr double kFarBack = -20.0;

/// A pseudo-random number in [0.5, 1.5) that depends on contact, use and seed only.
double pseudoRandom(std::size_t k, std::uint32_t seed, std::uint32_t use) {
    std::uint64_t z = (static_cast<std::uint64_t>(k) * 4 + use) * 0x9E3779B97F4A7C15ull + seed * 0xD1B54A32D192ED03ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return 0.5 + static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

} // namespace

double PathFollower::errorOf(const MassNormalisedProblem& problem) const {
    ResidualSum sum;
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        const MassNormalisedProblem::Contact& contact = problem.contact(contacts_[k]);
        const MassNormalisedProblem::Velocity u = problem.velocity(contact, w_.data());
        MassNormalisedProblem::addResidual(contact, u, r_[2 * k], r_[2 * k + 1], sum);
    }
    return sum.error();
}

/// The same right after refine(), which leaves the contact velocities in trial_.
double PathFollower::errorOfRefined(const MassNormalisedProblem& problem) const {
    ResidualSum sum;
    for (std::size_t k = 0; k < contacts_.size(); ++k)
        MassNormalisedProblem::addResidual(problem.contact(contacts_[k]), {trial_[2 * k], trial_[2 * k + 1]}, r_[2 * k],
                                           r_[2 * k + 1], sum);
    return sum.error();
}

/// Puts the guess on its statuses, away from their limits, and finds the shift of the right-hand side that makes it
/// exact.
void PathFollower::begin(const MassNormalisedProblem& problem, const PathSettings& settings, const SolverState& x) {
    const std::size_t count = contacts_.size();
    status_.resize(count);
    r_.resize(2 * count);
    bodies_.clear();
    for (std::size_t k = 0; k < count; ++k) {
        r_[2 * k] = x.r[2 * contacts_[k]];
        r_[2 * k + 1] = x.r[2 * contacts_[k] + 1];
        const MassNormalisedProblem::Contact& contact = problem.contact(contacts_[k]);
        for (std::int32_t s = 0; s < contact.sides; ++s)
            bodies_.push_back(contact.side[s].body);
    }
    std::sort(bodies_.begin(), bodies_.end());
    bodies_.erase(std::unique(bodies_.begin(), bodies_.end()), bodies_.end());
    anchor_ = r_;
    fixVelocities(problem, x);
    copyBodies(problem, x.w, w_);
    errorAtStart_ = settings.error < 0.0 ? errorOf(problem) : settings.error;
    SC_ASSERT_EXPENSIVE(!(std::abs(errorAtStart_ - errorOf(problem)) > 0.0),
                        "the error that was given is that of the guess");
    const double size = settings.slack * std::sqrt(errorAtStart_ / static_cast<double>(count));
    for (std::size_t k = 0; k < count; ++k) {
        const MassNormalisedProblem::Contact& contact = problem.contact(contacts_[k]);
        const double slack = size / std::sqrt(contact.d) * pseudoRandom(k, settings.seed, 0);
        double& rn = r_[2 * k];
        double& rt = r_[2 * k + 1];
        ContactStatus& status = status_[k] = x.status[contacts_[k]];
        if (contact.bilateral()) { // any r is admissible
            status = contact.frictionless() ? ContactStatus::SlipPlus : ContactStatus::Stick;
            contact.project(rn, rt);
            continue;
        }
        if (status != ContactStatus::Open && contact.mu == 0.0)
            status = ContactStatus::SlipPlus;
        if (status == ContactStatus::Open) {
            rn = rt = 0.0;
            continue;
        }
        rn = std::max(rn, slack);
        if (status == ContactStatus::Stick) {
            const double most = contact.mu * std::max(0.25 * rn, rn - slack * pseudoRandom(k, settings.seed, 1));
            rt = std::clamp(rt, -most, most);
        } else {
            rt = -slipSign(status) * contact.mu * rn;
        }
    }
    refreshVelocities(problem);
    shift_.assign(2 * count, 0.0);
    u_.resize(2 * count);
    for (std::size_t k = 0; k < count; ++k) {
        const MassNormalisedProblem::Contact& contact = problem.contact(contacts_[k]);
        const MassNormalisedProblem::Velocity u = problem.velocity(contact, w_.data());
        const double prox = settings.eps * contact.d;
        const double un = u.n + prox * (r_[2 * k] - anchor_[2 * k]);
        const double ut = u.t + prox * (r_[2 * k + 1] - anchor_[2 * k + 1]);
        const double slack = size * std::sqrt(contact.d) * pseudoRandom(k, settings.seed, 2);
        const double sign = slipSign(status_[k]);
        u_[2 * k] = status_[k] == ContactStatus::Open ? std::max(un, slack) : 0.0;
        u_[2 * k + 1] = status_[k] == ContactStatus::Open ? ut : sign * std::max(sign * ut, slack);
        if (contact.frictionless())
            u_[2 * k + 1] = ut;
        shift_[2 * k] = u_[2 * k] - un;
        shift_[2 * k + 1] = u_[2 * k + 1] - ut;
    }
}

void PathFollower::copyBodies(const MassNormalisedProblem& problem, const std::vector<double>& from,
                              std::vector<double>& to) const {
    to.resize(problem.freeVelocity().size());
    for (const std::int32_t b : bodies_) {
        const auto at = static_cast<std::ptrdiff_t>(problem.bodyOffset(b));
        std::copy_n(from.begin() + at, problem.bodyPadded(b), to.begin() + at);
    }
}

/// Velocities of the bodies without the contacts of this path. Entries of other bodies are not used.
void PathFollower::fixVelocities(const MassNormalisedProblem& problem, const SolverState& x) {
    copyBodies(problem, problem.freeVelocity(), fixed_);
    for (const std::int32_t c : outside_)
        if (x.r[2 * c] != 0.0 || x.r[2 * c + 1] != 0.0)
            problem.apply(problem.contact(c), x.r[2 * c], x.r[2 * c + 1], fixed_.data());
}

/// w = w_fixed + G r on the bodies of the path.
void PathFollower::refreshVelocities(const MassNormalisedProblem& problem) {
    copyBodies(problem, fixed_, w_);
    for (std::size_t k = 0; k < contacts_.size(); ++k)
        if (r_[2 * k] != 0.0 || r_[2 * k + 1] != 0.0)
            problem.apply(problem.contact(contacts_[k]), r_[2 * k], r_[2 * k + 1], w_.data());
}

/// dr/dtau and du/dtau with the present statuses.
bool PathFollower::direction(const MassNormalisedProblem& problem) {
    if (!system_.solve(dr_))
        return false;
    for (const std::int32_t b : bodies_)
        std::fill_n(dw_.begin() + static_cast<std::ptrdiff_t>(problem.bodyOffset(b)), problem.bodyPadded(b), 0.0);
    for (std::size_t k = 0; k < contacts_.size(); ++k)
        if (status_[k] != ContactStatus::Open)
            problem.apply(problem.contact(contacts_[k]), dr_[2 * k], dr_[2 * k + 1], dw_.data());
    for (const std::int32_t b : bodies_) {
        const double* dw = dw_.data() + problem.bodyOffset(b);
        DoublePair square = {0.0, 0.0};
        for (std::size_t i = 0; i < problem.bodyPadded(b); i += 2) {
            const DoublePair pair = *reinterpret_cast<const UnalignedPair*>(dw + i);
            square += pair * pair;
        }
        bodyRate_[b] = std::sqrt(square[0] + square[1]);
    }
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        du_[2 * k] = du_[2 * k + 1] = 0.0; // open contacts are computed in nextBreakpoint
        if (slipSign(status_[k]) != 0.0 && mu_[k] > 0.0)
            du_[2 * k + 1] = problem.tangentProduct(problem.contact(contacts_[k]), dw_.data()) - shift_[2 * k + 1] +
                             prox_[k] * dr_[2 * k + 1];
    }
    return true;
}

/// du_n/dtau of an open contact. Its u_t is not followed; Close computes it anew.
double PathFollower::openRate(const MassNormalisedProblem& problem, std::size_t k) const {
    return problem.normalProduct(problem.contact(contacts_[k]), dw_.data()) - shift_[2 * k];
}

/// The next contact that changes its status. Most contacts are open and far from closing. Their gap shrinks no faster
/// than their bodies move; where this bound excludes them, u_n and its rate are not computed, which saves half a pivot.
PathFollower::Breakpoint PathFollower::nextBreakpoint(const MassNormalisedProblem& problem, double sign) {
    Breakpoint next{std::numeric_limits<double>::infinity(), 0, Event::None};
    const auto consider = [&](std::size_t k, double value, double rate, Event event) {
        const double speed = -sign * rate;
        if (speed <= 0.0 || value > (1.0 + 1e-12) * next.step * speed) // the latter spares most divisions
            return;
        const double step = std::max(value, 0.0) / speed;
        if (step < next.step)
            next = {step, k, event};
    };
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        const double side = slipSign(status_[k]);
        if (status_[k] == ContactStatus::Open || bilateral_[k] != 0)
            continue;
        if (status_[k] == ContactStatus::Stick) {
            const double mu = mu_[k];
            consider(k, mu * r_[2 * k] - r_[2 * k + 1], mu * dr_[2 * k] - dr_[2 * k + 1], Event::SlipMinus);
            consider(k, mu * r_[2 * k] + r_[2 * k + 1], mu * dr_[2 * k] + dr_[2 * k + 1], Event::SlipPlus);
        } else {
            consider(k, r_[2 * k], dr_[2 * k], Event::Open);
            if (mu_[k] > 0.0)
                consider(k, side * u_[2 * k + 1], side * du_[2 * k + 1], Event::Stick);
        }
    }
    const double arrival = sign > 0.0 ? 1.0 - tau_ : std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        if (status_[k] != ContactStatus::Open)
            continue;
        const OpenContactBound& bound = openBounds_[k];
        const double fastest = bound.reach[0] * bodyRate_[bound.body[0]] + bound.reach[1] * bodyRate_[bound.body[1]] +
                               std::abs(shift_[2 * k]);
        if (u_[2 * k] > 1.000001 * std::min(arrival, next.step) * fastest) {
            du_[2 * k] = -sign * fastest;
            stale_[k] = 1;
            continue;
        }
        if (stale_[k] != 0) {
            stale_[k] = 0;
            const MassNormalisedProblem::Contact& contact = problem.contact(contacts_[k]);
            u_[2 * k] = problem.normalProduct(contact, w_.data()) + contact.wn + (1.0 - tau_) * shift_[2 * k] -
                        prox_[k] * anchor_[2 * k];
        }
        du_[2 * k] = openRate(problem, k);
        consider(k, u_[2 * k], du_[2 * k], Event::Close);
    }
    return next;
}

/// Rate (per unit of tau) at which contact k, just changed by `event`, moves into its new status.
double PathFollower::enteringRate(const MassNormalisedProblem& problem, std::size_t k, Event event) const {
    switch (event) {
    case Event::Close:
        return dr_[2 * k];
    case Event::Open:
        return openRate(problem, k);
    case Event::Stick: // away from the edge it came from
        return mu_[k] * dr_[2 * k] + edge_ * dr_[2 * k + 1];
    case Event::SlipPlus:
        return du_[2 * k + 1];
    case Event::SlipMinus:
        return -du_[2 * k + 1];
    case Event::None:
        break;
    }
    return 0.0;
}

void PathFollower::changeStatus(const MassNormalisedProblem& problem, const Breakpoint& at) {
    const std::size_t k = at.k;
    const MassNormalisedProblem::Contact& contact = problem.contact(contacts_[k]);
    ContactStatus& status = status_[k];
    double& rt = r_[2 * k + 1];
    SC_ASSERT(bilateral_[k] == 0, "a bilateral contact never changes its status");
    SC_ASSERT((at.event == Event::Close) == (status == ContactStatus::Open), "an open contact can only close");
    SC_ASSERT(at.event == Event::Close || at.event == Event::None ||
                  (at.event == Event::Open || at.event == Event::Stick) == (slipSign(status) != 0.0),
              "opens or sticks from slip, slips from stick");
    switch (at.event) {
    case Event::Close: {
        u_[2 * k] = 0.0;
        u_[2 * k + 1] = problem.velocity(contact, w_.data()).t + (1.0 - tau_) * shift_[2 * k + 1] +
                        prox_[k] * (rt - anchor_[2 * k + 1]);
        status = u_[2 * k + 1] < 0.0 && contact.mu > 0.0 ? ContactStatus::SlipMinus : ContactStatus::SlipPlus;
        break;
    }
    case Event::Open:
        r_[2 * k] = rt = 0.0;
        stale_[k] = 0; // u_n = 0
        status = ContactStatus::Open;
        break;
    case Event::Stick:
        edge_ = slipSign(status); // r_t = -edge mu r_n
        u_[2 * k + 1] = 0.0;
        status = ContactStatus::Stick;
        break;
    case Event::SlipPlus:
    case Event::SlipMinus:
        status = at.event == Event::SlipPlus ? ContactStatus::SlipPlus : ContactStatus::SlipMinus;
        rt = -slipSign(status) * contact.mu * r_[2 * k];
        u_[2 * k + 1] = 0.0;
        break;
    case Event::None:
        break;
    }
    system_.setStatus(problem, k, status);
}

bool PathFollower::refactor(const MassNormalisedProblem& problem, const PathSettings& settings, PathCounts& counts) {
    ++counts.factorisations;
    const bool regular = system_.factor(problem, contacts_, status_, settings.eps);
    counts.effort.factors += system_.cost();
    if (!regular)
        return false;
    if (tau_ != 0.0 && !refine(problem))
        return false;
    system_.setRightHandSide(shift_);
    return true;
}

PathFollower::Termination PathFollower::follow(const MassNormalisedProblem& problem, const PathSettings& settings,
                                               PathCounts& counts) {
    tau_ = 0.0;
    // The limit is meant for one stack of some 150 active contacts; it is larger for larger ones.
    const double load = static_cast<double>(system_.size()) / 250.0;
    const int most = static_cast<int>(settings.maxPivots * std::max(1.0, load));
    const std::size_t extra = system_.size() > 320 ? (system_.size() - 320) / 20 : 0;
    const std::size_t borders = kMostBorders + std::min<std::size_t>(60, extra);
    double sign = 1.0;
    Breakpoint last;
    for (int pivots = 0;; ++pivots) {
        if (!direction(problem))
            return Termination::Singular;
        if (last.event != Event::None) {
            const double rate = enteringRate(problem, last.k, last.event);
            if (rate == 0.0)
                return Termination::Singular;
            sign = rate > 0.0 ? 1.0 : -1.0;
        }
        last = nextBreakpoint(problem, sign);
        SC_ASSERT(!(last.step < 0.0) && last.k < contacts_.size(), "the path goes forward to a contact of its own");
        const bool arrives = sign > 0.0 && tau_ + last.step >= 1.0;
        if (last.event == Event::None && !arrives)
            return Termination::Ray;
        const double step = sign * (arrives ? 1.0 - tau_ : last.step);
        for (std::size_t i = 0; i < r_.size(); ++i) {
            r_[i] += step * dr_[i];
            u_[i] += step * du_[i];
        }
        for (const std::int32_t b : bodies_)
            for (std::size_t i = problem.bodyOffset(b); i < problem.bodyOffset(b) + problem.bodyPadded(b); ++i)
                w_[i] += step * dw_[i];
        tau_ += step;
        if (arrives)
            return Termination::Solved;
        if (tau_ < kFarBack)
            return Termination::Diverged;
        if (pivots >= most || counts.pivots >= settings.allPivots || counts.effort.units() >= settings.maxWork)
            return Termination::PivotLimit;
        ++counts.pivots;
        counts.effort.pivots += static_cast<double>(contacts_.size() + system_.size());
        changeStatus(problem, last);
        if (system_.borders() > borders && !refactor(problem, settings, counts))
            return Termination::Singular;
    }
}

/// One step of iterative refinement of the closed rows at the present tau, against accumulated round-off.
bool PathFollower::refine(const MassNormalisedProblem& problem) {
    refreshVelocities(problem);
    const double rest = 1.0 - tau_;
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        const MassNormalisedProblem::Velocity u = problem.velocity(problem.contact(contacts_[k]), w_.data());
        trial_[2 * k] = -u.n - prox_[k] * (r_[2 * k] - anchor_[2 * k]) - rest * shift_[2 * k];
        trial_[2 * k + 1] = -u.t - prox_[k] * (r_[2 * k + 1] - anchor_[2 * k + 1]) - rest * shift_[2 * k + 1];
    }
    system_.setRightHandSide(trial_);
    if (!system_.solve(dr_))
        return false;
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        r_[2 * k] = bilateral_[k] != 0 ? r_[2 * k] + dr_[2 * k] : std::max(0.0, r_[2 * k] + dr_[2 * k]);
        r_[2 * k + 1] += dr_[2 * k + 1];
        if (status_[k] != ContactStatus::Stick)
            r_[2 * k + 1] = -slipSign(status_[k]) * mu_[k] * r_[2 * k];
    }
    refreshVelocities(problem);
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        const MassNormalisedProblem::Velocity u = problem.velocity(problem.contact(contacts_[k]), w_.data());
        const double un = u.n + prox_[k] * (r_[2 * k] - anchor_[2 * k]) + rest * shift_[2 * k];
        const double ut = u.t + prox_[k] * (r_[2 * k + 1] - anchor_[2 * k + 1]) + rest * shift_[2 * k + 1];
        trial_[2 * k] = u.n;
        trial_[2 * k + 1] = u.t;
        stale_[k] = 0;
        u_[2 * k] = status_[k] == ContactStatus::Open ? un : 0.0;
        u_[2 * k + 1] = status_[k] == ContactStatus::Stick ? 0.0 : ut;
        SC_ASSERT_EXPENSIVE(bilateral_[k] != 0 || !(r_[2 * k] < 0.0), "a contact does not pull");
    }
    return true;
}

void PathFollower::store(const MassNormalisedProblem& problem, SolverState& x) const {
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        x.r[2 * contacts_[k]] = r_[2 * k];
        x.r[2 * contacts_[k] + 1] = r_[2 * k + 1];
        x.status[contacts_[k]] = status_[k];
    }
    copyBodies(problem, w_, x.w);
}

PathFollower::Termination PathFollower::run(const MassNormalisedProblem& problem,
                                            std::span<const std::int32_t> contacts,
                                            std::span<const std::int32_t> outside, const PathSettings& settings,
                                            double allowed, SolverState& x, PathCounts& counts) {
    SC_ASSERT(x.r.size() == 2 * problem.contactCount() && x.status.size() == problem.contactCount(),
              "a state of this problem");
    SC_ASSERT(settings.eps > 0.0 && settings.slack > 0.0 && settings.maxPivots >= 0, "the proximal problem is regular");
    SC_ASSERT(!(allowed < 0.0), "an error is not negative");
    SC_ASSERT_EXPENSIVE(invariants::strictlyRising(contacts), "the contacts of a path are in rising order");
    contacts_ = contacts;
    outside_ = outside;
    const std::size_t count = contacts.size();
    mu_.resize(count);
    prox_.resize(count);
    openBounds_.resize(count);
    stale_.assign(count, 0);
    bilateral_.resize(count);
    bodyRate_.resize(problem.bodyCount() + 1);
    for (std::size_t k = 0; k < count; ++k) {
        mu_[k] = problem.contact(contacts[k]).mu;
        bilateral_[k] = problem.contact(contacts[k]).bilateral() ? 1 : 0;
        prox_[k] = settings.eps * problem.contact(contacts[k]).d;
        openBounds_[k] = {};
        for (std::int32_t s = 0; s < problem.contact(contacts[k]).sides; ++s) {
            const MassNormalisedProblem::Side& side = problem.contact(contacts[k]).side[s];
            openBounds_[k].body[s] = side.body;
            openBounds_[k].reach[s] = side.reach;
        }
    }
    dr_.assign(2 * count, 0.0);
    du_.assign(2 * count, 0.0);
    trial_.resize(2 * count);
    dw_.resize(x.w.size());
    begin(problem, settings, x);
    tau_ = 0.0;
    if (errorAtStart_ <= allowed)
        return Termination::Solved;
    if (!refactor(problem, settings, counts))
        return Termination::Singular;
    double error = errorAtStart_;
    for (int outer = 0;; ++outer) {
        const Termination termination = follow(problem, settings, counts);
        if (termination != Termination::Solved || !refine(problem))
            return termination == Termination::Solved ? Termination::Singular : termination;
        const double now = errorOfRefined(problem);
        SC_ASSERT_EXPENSIVE(now == errorOf(problem) || !std::isfinite(now), "nothing has changed since refine()");
        if (!std::isfinite(now))
            return Termination::Singular;
        store(problem, x);
        if (now <= allowed)
            return Termination::Solved;
        if (outer >= settings.maxOuter || (outer > 0 && now > 0.8 * error))
            return Termination::Stalled;
        error = now;
        // Move the proximal centre; the present solution is exact for the old one.
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t i = 2 * k; i < 2 * k + 2; ++i) {
                shift_[i] = prox_[k] * (r_[i] - anchor_[i]);
                anchor_[i] = r_[i];
            }
        system_.setRightHandSide(shift_);
    }
}

} // namespace supercircle::coulomb
