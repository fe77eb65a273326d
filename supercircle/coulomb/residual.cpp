// The residual of the natural map, with De Saxce's change of variable (Acary & Brogliato 2008, ch. 3):
//   F_c = r_c - P_K( r_c - (u_c + mu |u_t| n) / d_c ),   d_c = tr(W_cc) / 2,   W = H A^-1 H^T
//   contact residual = sqrt( sum d_c |F_c|^2 / sum over closing contacts of |q_c|^2 / d_c )
// For a bilateral contact P is the identity on prescribed rows and 0 on a free tangent, the term mu |u_t| is absent,
// and the contact counts as closing:  F = (u_n, u_t) / d_c  or  (u_n / d_c, r_t).
//
// Two special cases:
// - No contact closes freely: r = 0 solves the problem and the denominator vanishes. The energy of the impulses,
//   sum d_c |r_c|^2, replaces it. If r = 0 as well, the residual is 0.
// - d_c = 0 (a contact that moves nothing): d_c becomes 1e-12 of the largest d, or 1 if all vanish. A closing contact
//   that no impulse can stop thus keeps its full weight, and the problem counts as unsolved.

#include "supercircle/coulomb/residual.h"

#include "supercircle/support/invariants.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::coulomb {

Residual ResidualSum::result() const {
    SC_ASSERT(!(closing_ < 0.0) && !(held_ < 0.0) && !(impulse_ < 0.0), "sums of squares are not negative");
    const double scale = closing_ > 0.0 ? closing_ : held_;
    // Rows that contradict each other have impulses of any size, beside which u_c / d_c is lost: F_c = r_c - r_c = 0.
    // What cannot be told from round-off counts as error where it reaches the residual above which nothing is solved.
    // Halved or doubled, impulses count that are half or twice as large. At 1e-8 those count that stop a clamp in a
    // frame, at 1e-9 those of a strip pressed lengthwise; contradictions have impulses ten orders above either.
    constexpr double kSeen = 1e-3;
    constexpr double kRoundOff = std::numeric_limits<double>::epsilon();
    const bool blind = kRoundOff * kRoundOff * held_ > kSeen * kSeen * scale;
    const double error = blind ? error_ + kRoundOff * kRoundOff * held_ : error_;
    Residual result;
    if (error != 0.0) // also for NaN, which must not pass as solved
        result.contactResidual =
            error > 0.0 && scale > 0.0 ? std::sqrt(error / scale) : std::numeric_limits<double>::infinity();
    result.scale = scale;
    result.penetrationSpeed = penetration_;
    result.impulseError = std::sqrt(impulse_);
    result.speedError = std::sqrt(speed_);
    if (blind) { // nothing excuses it
        result.impulseError = std::max(result.impulseError, kRoundOff * std::sqrt(impulseSquares_));
        result.speedError = std::max(result.speedError, kRoundOff * std::sqrt(speedSquares_));
    }
    return result;
}

namespace {

using Row = Eigen::Matrix<double, 2, Eigen::Dynamic>;

/// H_b of `contact` for body `index`; both sides add up where a body touches itself.
Row rowOf(const Contact& contact, std::int32_t index) {
    if (contact.a == index && contact.b == index)
        return contact.Ha + contact.Hb;
    return contact.a == index ? contact.Ha : contact.Hb;
}

template <class Visit>
void forEachBody(const Contact& contact, Visit&& visit) {
    if (contact.a >= 0)
        visit(contact.a);
    if (contact.b >= 0 && contact.b != contact.a)
        visit(contact.b);
}

std::vector<Eigen::LLT<Eigen::MatrixXd>> factors(const Problem& problem) {
    std::vector<Eigen::LLT<Eigen::MatrixXd>> result;
    result.reserve(problem.bodies.size());
    for (const Body& body : problem.bodies)
        result.emplace_back(body.A);
    return result;
}

std::vector<Eigen::VectorXd> velocities(const Problem& problem, const std::vector<Eigen::LLT<Eigen::MatrixXd>>& factor,
                                        const Eigen::VectorXd& r) {
    std::vector<Eigen::VectorXd> momentum;
    for (const Body& body : problem.bodies)
        momentum.emplace_back(Eigen::VectorXd::Zero(body.vFree.size()));
    for (std::size_t c = 0; c < problem.contacts.size(); ++c)
        forEachBody(problem.contacts[c], [&](std::int32_t b) {
            momentum[b] += rowOf(problem.contacts[c], b).transpose() * r.segment<2>(2 * static_cast<Eigen::Index>(c));
        });
    for (std::size_t b = 0; b < momentum.size(); ++b)
        momentum[b] = problem.bodies[b].vFree + factor[b].solve(momentum[b]);
    return momentum;
}

} // namespace

std::vector<Eigen::VectorXd> bodyVelocities(const Problem& problem, const Eigen::VectorXd& r) {
    SC_ASSERT(r.size() == 2 * static_cast<Eigen::Index>(problem.contacts.size()), "two impulses a contact");
    return velocities(problem, factors(problem), r);
}

Residual evaluateResidual(const Problem& problem, const Eigen::VectorXd& r) {
    SC_ASSERT(r.size() == 2 * static_cast<Eigen::Index>(problem.contacts.size()), "two impulses a contact");
    if (!r.allFinite())
        return {std::numeric_limits<double>::infinity(), 0.0, std::numeric_limits<double>::infinity(),
                std::numeric_limits<double>::infinity(), 0.0};
    const auto factor = factors(problem);
    const auto v = velocities(problem, factor, r);
    const auto count = static_cast<Eigen::Index>(problem.contacts.size());
    Eigen::VectorXd d = Eigen::VectorXd::Zero(count);
    Eigen::VectorXd u(2 * count);
    Eigen::VectorXd q(2 * count);
    for (Eigen::Index c = 0; c < count; ++c) {
        const Contact& contact = problem.contacts[static_cast<std::size_t>(c)];
        u.segment<2>(2 * c) = contact.w;
        q.segment<2>(2 * c) = contact.w;
        forEachBody(contact, [&](std::int32_t b) {
            const Row row = rowOf(contact, b);
            d[c] += 0.5 * (row * factor[b].solve(row.transpose())).trace();
            u.segment<2>(2 * c) += row * v[b];
            q.segment<2>(2 * c) += row * problem.bodies[b].vFree;
        });
    }
    const double largest = count > 0 ? d.maxCoeff() : 0.0;
    const double floor = largest > 0.0 ? 1e-12 * largest : 1.0;
    ResidualSum sum;
    for (Eigen::Index c = 0; c < count; ++c) {
        const Contact& contact = problem.contacts[static_cast<std::size_t>(c)];
        const Eigen::Index t = 2 * c + 1;
        if (contact.bilateral())
            sum.addBilateral(u[2 * c], u[t], q[2 * c], q[t], r[2 * c], r[t], contact.locked(), std::max(d[c], floor));
        else
            sum.add(u[2 * c], u[t], q[2 * c], q[t], r[2 * c], r[t], contact.mu, std::max(d[c], floor));
    }
    return sum.result();
}

} // namespace supercircle::coulomb
