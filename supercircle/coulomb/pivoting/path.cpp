// Why this and not Newton. A planar contact lies on one of four linear pieces, so for given pieces the problem is
// linear and the solution is a piecewise-linear function of the right-hand side. Newton jumps between pieces and cycles
// when the guess is unsettled (loaded nests: always). Following the path never jumps: it flips one contact at a time.
//
//   1 The proximal problem W + eps D anchored at the guess keeps redundant (nested) contacts regular. It leaves the law
//     exact: the anchor is moved to the solution and the step repeated until the true residual is reached.
//   2 The guess, put on its pieces with small slacks, solves the problem exactly for a shifted right-hand side.
//   3 tau runs from 0 (shifted) to 1 (true). At a breakpoint one contact moves to the neighbouring piece and tau goes
//   on
//     in the direction that carries this contact into it; it may run backwards for a while. The matrix is no P-matrix,
//     so this really happens.
//   4 A ray (no breakpoint while tau runs backwards), tau < -20 or too many flips: give up, the caller tries another
//   eps,
//     other slacks, some more sweeps.
//
// Slacks must shrink with the residual of the guess: fixed ones turn into rays near the solution. Without any slack the
// start is degenerate and the first flips are arbitrary. eps below 1e-9 makes the path wander.

#include "supercircle/coulomb/pivoting/path.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::coulomb {

namespace {

constexpr std::size_t kMostBorders = 40; // and one more for every 20 unknowns above 320
constexpr double kFarBack = -20.0;

/// A number in [0.5, 1.5) that depends on contact, use and seed only.
double scatter(std::size_t k, std::uint32_t seed, std::uint32_t use) {
    std::uint64_t z = (static_cast<std::uint64_t>(k) * 4 + use) * 0x9E3779B97F4A7C15ull + seed * 0xD1B54A32D192ED03ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return 0.5 + static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

} // namespace

double Path::errorOf(const Whitened& problem) const {
    ResidualSum sum;
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        const Whitened::Contact& contact = problem.contact(contacts_[k]);
        const Whitened::Velocity u = problem.velocity(contact, w_.data());
        Whitened::judge(contact, u, r_[2 * k], r_[2 * k + 1], sum);
    }
    return sum.error();
}

/// Puts the guess on its pieces, away from their edges, and finds the shift of the right-hand side that makes it exact.
void Path::begin(const Whitened& problem, const PathSettings& settings, const Iterate& x) {
    const std::size_t count = contacts_.size();
    piece_.resize(count);
    r_.resize(2 * count);
    bodies_.clear();
    for (std::size_t k = 0; k < count; ++k) {
        r_[2 * k] = x.r[2 * contacts_[k]];
        r_[2 * k + 1] = x.r[2 * contacts_[k] + 1];
        const Whitened::Contact& contact = problem.contact(contacts_[k]);
        for (std::int32_t s = 0; s < contact.sides; ++s)
            bodies_.push_back(contact.side[s].body);
    }
    std::sort(bodies_.begin(), bodies_.end());
    bodies_.erase(std::unique(bodies_.begin(), bodies_.end()), bodies_.end());
    anchor_ = r_;
    fixVelocities(problem, x);
    copyBodies(problem, x.w, w_);
    errorAtStart_ = errorOf(problem);
    const double size = settings.slack * std::sqrt(errorAtStart_ / static_cast<double>(count));
    for (std::size_t k = 0; k < count; ++k) {
        const Whitened::Contact& contact = problem.contact(contacts_[k]);
        const double slack = size / std::sqrt(contact.d) * scatter(k, settings.seed, 0);
        double& rn = r_[2 * k];
        double& rt = r_[2 * k + 1];
        Piece& piece = piece_[k] = x.piece[contacts_[k]];
        if (contact.tied()) { // on its piece whatever r; nothing to keep clear of
            piece = contact.smooth() ? Piece::SlipPlus : Piece::Stick;
            contact.project(rn, rt);
            continue;
        }
        if (piece != Piece::Open && contact.mu == 0.0)
            piece = Piece::SlipPlus;
        if (piece == Piece::Open) {
            rn = rt = 0.0;
            continue;
        }
        rn = std::max(rn, slack);
        if (piece == Piece::Stick) {
            const double most = contact.mu * std::max(0.25 * rn, rn - slack * scatter(k, settings.seed, 1));
            rt = std::clamp(rt, -most, most);
        } else {
            rt = -slipSign(piece) * contact.mu * rn;
        }
    }
    refreshVelocities(problem);
    shift_.assign(2 * count, 0.0);
    u_.resize(2 * count);
    for (std::size_t k = 0; k < count; ++k) {
        const Whitened::Contact& contact = problem.contact(contacts_[k]);
        const Whitened::Velocity u = problem.velocity(contact, w_.data());
        const double prox = settings.eps * contact.d;
        const double un = u.n + prox * (r_[2 * k] - anchor_[2 * k]);
        const double ut = u.t + prox * (r_[2 * k + 1] - anchor_[2 * k + 1]);
        const double slack = size * std::sqrt(contact.d) * scatter(k, settings.seed, 2);
        const double sign = slipSign(piece_[k]);
        u_[2 * k] = piece_[k] == Piece::Open ? std::max(un, slack) : 0.0;
        u_[2 * k + 1] = piece_[k] == Piece::Open ? ut : sign * std::max(sign * ut, slack);
        if (contact.smooth())
            u_[2 * k + 1] = ut;
        shift_[2 * k] = u_[2 * k] - un;
        shift_[2 * k + 1] = u_[2 * k + 1] - ut;
    }
}

void Path::copyBodies(const Whitened& problem, const std::vector<double>& from, std::vector<double>& to) const {
    to.resize(problem.freeVelocity().size());
    for (const std::int32_t b : bodies_) {
        const auto at = static_cast<std::ptrdiff_t>(problem.bodyOffset(b));
        std::copy_n(from.begin() + at, problem.bodyPadded(b), to.begin() + at);
    }
}

/// What the bodies do without the contacts of this path. Entries of other bodies are of no interest.
void Path::fixVelocities(const Whitened& problem, const Iterate& x) {
    copyBodies(problem, problem.freeVelocity(), fixed_);
    for (const std::int32_t c : outside_)
        if (x.r[2 * c] != 0.0 || x.r[2 * c + 1] != 0.0)
            problem.apply(problem.contact(c), x.r[2 * c], x.r[2 * c + 1], fixed_.data());
}

/// w = w_fixed + G r on the bodies of the path.
void Path::refreshVelocities(const Whitened& problem) {
    copyBodies(problem, fixed_, w_);
    for (std::size_t k = 0; k < contacts_.size(); ++k)
        if (r_[2 * k] != 0.0 || r_[2 * k + 1] != 0.0)
            problem.apply(problem.contact(contacts_[k]), r_[2 * k], r_[2 * k + 1], w_.data());
}

/// dr/dtau and du/dtau with the present pieces.
bool Path::direction(const Whitened& problem) {
    if (!system_.solve(dr_))
        return false;
    for (const std::int32_t b : bodies_)
        std::fill_n(dw_.begin() + static_cast<std::ptrdiff_t>(problem.bodyOffset(b)), problem.bodyPadded(b), 0.0);
    for (std::size_t k = 0; k < contacts_.size(); ++k)
        if (piece_[k] != Piece::Open)
            problem.apply(problem.contact(contacts_[k]), dr_[2 * k], dr_[2 * k + 1], dw_.data());
    for (const std::int32_t b : bodies_) {
        const double* dw = dw_.data() + problem.bodyOffset(b);
        double square = 0.0;
        for (std::size_t i = 0; i < problem.bodyPadded(b); ++i)
            square += dw[i] * dw[i];
        bodyRate_[b] = std::sqrt(square);
    }
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        du_[2 * k] = du_[2 * k + 1] = 0.0; // open ones follow in nextBreakpoint
        if (slipSign(piece_[k]) != 0.0 && mu_[k] > 0.0)
            du_[2 * k + 1] = problem.tangentProduct(problem.contact(contacts_[k]), dw_.data()) - shift_[2 * k + 1] +
                             prox_[k] * dr_[2 * k + 1];
    }
    return true;
}

/// du_n/dtau of an open contact. Its u_t is not followed: Close finds it afresh.
double Path::openRate(const Whitened& problem, std::size_t k) const {
    return problem.normalProduct(problem.contact(contacts_[k]), dw_.data()) - shift_[2 * k];
}

/// The next contact to leave its piece. Most contacts are open and far from closing: their gap shrinks no faster than
/// their bodies move, and where that bound excludes them neither u_n nor its rate is worked out (half of a pivot else).
Path::Breakpoint Path::nextBreakpoint(const Whitened& problem, double sign) {
    Breakpoint next{std::numeric_limits<double>::infinity(), 0, Event::None};
    const auto consider = [&](std::size_t k, double value, double rate, Event event) {
        if (sign * rate >= 0.0)
            return;
        const double step = std::max(value, 0.0) / (-sign * rate);
        if (step < next.step)
            next = {step, k, event};
    };
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        const double side = slipSign(piece_[k]);
        if (piece_[k] == Piece::Open || tied_[k] != 0)
            continue;
        if (piece_[k] == Piece::Stick) {
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
        if (piece_[k] != Piece::Open)
            continue;
        const Watch& watch = watch_[k];
        const double fastest = watch.reach[0] * bodyRate_[watch.body[0]] + watch.reach[1] * bodyRate_[watch.body[1]] +
                               std::abs(shift_[2 * k]);
        if (u_[2 * k] > 1.000001 * std::min(arrival, next.step) * fastest) {
            du_[2 * k] = -sign * fastest;
            stale_[k] = 1;
            continue;
        }
        if (stale_[k] != 0) {
            stale_[k] = 0;
            const Whitened::Contact& contact = problem.contact(contacts_[k]);
            u_[2 * k] = problem.normalProduct(contact, w_.data()) + contact.wn + (1.0 - tau_) * shift_[2 * k] -
                        prox_[k] * anchor_[2 * k];
        }
        du_[2 * k] = openRate(problem, k);
        consider(k, u_[2 * k], du_[2 * k], Event::Close);
    }
    return next;
}

/// Rate (per unit of tau) at which contact k, just flipped by `event`, moves into its new piece.
double Path::enteringRate(const Whitened& problem, std::size_t k, Event event) const {
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

void Path::flip(const Whitened& problem, const Breakpoint& at) {
    const std::size_t k = at.k;
    const Whitened::Contact& contact = problem.contact(contacts_[k]);
    Piece& piece = piece_[k];
    double& rt = r_[2 * k + 1];
    switch (at.event) {
    case Event::Close: {
        u_[2 * k] = 0.0;
        u_[2 * k + 1] = problem.velocity(contact, w_.data()).t + (1.0 - tau_) * shift_[2 * k + 1] +
                        prox_[k] * (rt - anchor_[2 * k + 1]);
        piece = u_[2 * k + 1] < 0.0 && contact.mu > 0.0 ? Piece::SlipMinus : Piece::SlipPlus;
        break;
    }
    case Event::Open:
        r_[2 * k] = rt = 0.0;
        stale_[k] = 0; // u_n = 0
        piece = Piece::Open;
        break;
    case Event::Stick:
        edge_ = slipSign(piece); // r_t = -edge mu r_n
        u_[2 * k + 1] = 0.0;
        piece = Piece::Stick;
        break;
    case Event::SlipPlus:
    case Event::SlipMinus:
        piece = at.event == Event::SlipPlus ? Piece::SlipPlus : Piece::SlipMinus;
        rt = -slipSign(piece) * contact.mu * r_[2 * k];
        u_[2 * k + 1] = 0.0;
        break;
    case Event::None:
        break;
    }
    system_.setPiece(problem, k, piece);
}

bool Path::refactor(const Whitened& problem, const PathSettings& settings, PathCounts& counts) {
    ++counts.factorisations;
    if (!system_.factor(problem, contacts_, piece_, settings.eps))
        return false;
    if (tau_ != 0.0 && !polish(problem))
        return false;
    system_.setRightHandSide(shift_);
    return true;
}

Path::Outcome Path::follow(const Whitened& problem, const PathSettings& settings, PathCounts& counts) {
    tau_ = 0.0;
    // The cap is meant for one stack of some 150 loaded contacts; longer for larger ones.
    const double load = static_cast<double>(system_.size()) / 250.0;
    const int most = static_cast<int>(settings.maxPivots * std::max(1.0, load));
    const std::size_t extra = system_.size() > 320 ? (system_.size() - 320) / 20 : 0;
    const std::size_t borders = kMostBorders + std::min<std::size_t>(60, extra);
    double sign = 1.0;
    Breakpoint last;
    for (int pivots = 0;; ++pivots) {
        if (!direction(problem))
            return Outcome::Singular;
        if (last.event != Event::None) {
            const double rate = enteringRate(problem, last.k, last.event);
            if (rate == 0.0)
                return Outcome::Singular;
            sign = rate > 0.0 ? 1.0 : -1.0;
        }
        last = nextBreakpoint(problem, sign);
        const bool arrives = sign > 0.0 && tau_ + last.step >= 1.0;
        if (last.event == Event::None && !arrives)
            return Outcome::Ray;
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
            return Outcome::Solved;
        if (tau_ < kFarBack)
            return Outcome::Wandered;
        if (pivots >= most)
            return Outcome::Pivots;
        ++counts.pivots;
        flip(problem, last);
        if (system_.borders() > borders && !refactor(problem, settings, counts))
            return Outcome::Singular;
    }
}

/// One step of iterative refinement of the closed rows at the present tau: removes what round-off has gathered.
bool Path::polish(const Whitened& problem) {
    refreshVelocities(problem);
    const double rest = 1.0 - tau_;
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        const Whitened::Velocity u = problem.velocity(problem.contact(contacts_[k]), w_.data());
        trial_[2 * k] = -u.n - prox_[k] * (r_[2 * k] - anchor_[2 * k]) - rest * shift_[2 * k];
        trial_[2 * k + 1] = -u.t - prox_[k] * (r_[2 * k + 1] - anchor_[2 * k + 1]) - rest * shift_[2 * k + 1];
    }
    system_.setRightHandSide(trial_);
    if (!system_.solve(dr_))
        return false;
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        r_[2 * k] = tied_[k] != 0 ? r_[2 * k] + dr_[2 * k] : std::max(0.0, r_[2 * k] + dr_[2 * k]);
        r_[2 * k + 1] += dr_[2 * k + 1];
        if (piece_[k] != Piece::Stick)
            r_[2 * k + 1] = -slipSign(piece_[k]) * mu_[k] * r_[2 * k];
    }
    refreshVelocities(problem);
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        const Whitened::Velocity u = problem.velocity(problem.contact(contacts_[k]), w_.data());
        const double un = u.n + prox_[k] * (r_[2 * k] - anchor_[2 * k]) + rest * shift_[2 * k];
        const double ut = u.t + prox_[k] * (r_[2 * k + 1] - anchor_[2 * k + 1]) + rest * shift_[2 * k + 1];
        stale_[k] = 0;
        u_[2 * k] = piece_[k] == Piece::Open ? un : 0.0;
        u_[2 * k + 1] = piece_[k] == Piece::Stick ? 0.0 : ut;
    }
    return true;
}

void Path::store(const Whitened& problem, Iterate& x) const {
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
        x.r[2 * contacts_[k]] = r_[2 * k];
        x.r[2 * contacts_[k] + 1] = r_[2 * k + 1];
        x.piece[contacts_[k]] = piece_[k];
    }
    copyBodies(problem, w_, x.w);
}

Path::Outcome Path::run(const Whitened& problem, std::span<const std::int32_t> contacts,
                        std::span<const std::int32_t> outside, const PathSettings& settings, double allowed, Iterate& x,
                        PathCounts& counts) {
    contacts_ = contacts;
    outside_ = outside;
    const std::size_t count = contacts.size();
    mu_.resize(count);
    prox_.resize(count);
    watch_.resize(count);
    stale_.assign(count, 0);
    tied_.resize(count);
    bodyRate_.resize(problem.bodyCount() + 1);
    for (std::size_t k = 0; k < count; ++k) {
        mu_[k] = problem.contact(contacts[k]).mu;
        tied_[k] = problem.contact(contacts[k]).tied() ? 1 : 0;
        prox_[k] = settings.eps * problem.contact(contacts[k]).d;
        watch_[k] = {};
        for (std::int32_t s = 0; s < problem.contact(contacts[k]).sides; ++s) {
            const Whitened::Side& side = problem.contact(contacts[k]).side[s];
            watch_[k].body[s] = side.body;
            watch_[k].reach[s] = side.reach;
        }
    }
    dr_.assign(2 * count, 0.0);
    du_.assign(2 * count, 0.0);
    trial_.resize(2 * count);
    dw_.resize(x.w.size());
    begin(problem, settings, x);
    tau_ = 0.0;
    if (errorAtStart_ <= allowed)
        return Outcome::Solved;
    if (!refactor(problem, settings, counts))
        return Outcome::Singular;
    double error = errorAtStart_;
    for (int outer = 0;; ++outer) {
        const Outcome outcome = follow(problem, settings, counts);
        if (outcome != Outcome::Solved || !polish(problem))
            return outcome == Outcome::Solved ? Outcome::Singular : outcome;
        const double now = errorOf(problem);
        if (!std::isfinite(now))
            return Outcome::Singular;
        store(problem, x);
        if (now <= allowed)
            return Outcome::Solved;
        if (outer >= settings.maxOuter || (outer > 0 && now > 0.8 * error))
            return Outcome::Stalled;
        error = now;
        // Move the anchor; the present solution is exact for the old one.
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t i = 2 * k; i < 2 * k + 2; ++i) {
                shift_[i] = prox_[k] * (r_[i] - anchor_[i]);
                anchor_[i] = r_[i];
            }
        system_.setRightHandSide(shift_);
    }
}

} // namespace supercircle::coulomb
