#pragma once
// A problem in coordinates in which every body has unit mass: A = L L^T, velocities w = L^T v, contact rows G = L^-1
// H^T. A contact then costs dot products and vector updates only, and W_cc' = G_c^T G_c'.

#include "supercircle/coulomb/law.h"
#include "supercircle/coulomb/problem.h"
#include "supercircle/coulomb/residual.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace supercircle::coulomb {

/// Two doubles, which every x86-64 and ARM64 machine adds and multiplies in one instruction.
using DoublePair [[gnu::vector_size(16)]] = double;

/// The same, at any address that holds a double.
using UnalignedPair [[gnu::vector_size(16), gnu::aligned(8), gnu::may_alias]] = double;

class MassNormalisedProblem {
public:
    /// One contact's rows on one body. Entries outside [begin1, end1) and [begin2, end2) are exactly zero.
    struct Side {
        std::int32_t body = -1;
        std::int32_t padded = 0;  ///< length of a row: n rounded up to even; the tangent row follows the normal row
        std::size_t velocity = 0; ///< start of the body's w
        std::size_t row = 0;      ///< start of the normal row in the row storage
        std::int32_t begin1 = 0;
        std::int32_t end1 = 0;
        std::int32_t begin2 = 0;
        std::int32_t end2 = 0;
        double reach = 0.0; ///< Euclidean length of the normal row
    };

    struct Contact {
        Side side[2];
        std::int32_t sides = 0;                            ///< 0 .. 2; two sides on one body are merged
        BilateralRows bilateralRows = BilateralRows::None; ///< rows with prescribed zero velocity
        double wn = 0.0;                                   ///< m/s
        double wt = 0.0;
        double mu = 0.0; ///< 0 for bilateral contacts
        double qn = 0.0; ///< velocity without impulses, m/s
        double qt = 0.0;
        double Wnn = 0.0; ///< 1/kg
        double Wnt = 0.0;
        double Wtt = 0.0;
        double d = 0.0; ///< tr W / 2, with the floor of the residual evaluation, 1/kg

        bool bilateral() const { return bilateralRows != BilateralRows::None; }
        /// Never transmits a tangential impulse: its status when closed is SlipPlus.
        bool frictionless() const { return mu == 0.0 && bilateralRows != BilateralRows::Both; }
        LocalLaw law() const { return {Wnn, Wnt, Wtt, mu, bilateralRows}; }
        /// Projects on the nearest admissible impulse, in place.
        void project(double& rn, double& rt) const {
            if (bilateralRows == BilateralRows::None)
                projectOnCone(mu, rn, rt);
            else if (bilateralRows == BilateralRows::Normal)
                rt = 0.0;
        }
    };

    struct Velocity {
        double n = 0.0;
        double t = 0.0;
    };

    /// Factors the masses, normalises rows and velocities. Returns a sentence if the problem is invalid, else an empty
    /// string. A body whose A is bitwise that of the last call keeps its factor.
    [[nodiscard]] std::string build(const Problem& problem, const parallel::For& loop = {});

    std::size_t contactCount() const { return contacts_.size(); }
    std::size_t bodyCount() const { return bodies_.size(); }
    const Contact& contact(std::size_t c) const { return contacts_[c]; }
    std::span<const Contact> contacts() const { return contacts_; }
    const double* rows() const { return rows_.data(); }
    /// Free mass-normalised velocities of all bodies in one array.
    const std::vector<double>& freeVelocity() const { return free_; }
    /// What the digits of the free velocities cannot tell apart at a contact, m/s.
    double speedRoundOff() const;
    std::size_t bodyOffset(std::size_t b) const { return bodies_[b].velocity; }
    std::size_t bodyPadded(std::size_t b) const { return bodies_[b].padded; }

    /// G^T w of one contact, without its own w.
    Velocity product(const Contact& contact, const double* w) const;
    double normalProduct(const Contact& contact, const double* w) const;
    double tangentProduct(const Contact& contact, const double* w) const;
    /// w += G (rn, rt).
    void apply(const Contact& contact, double rn, double rt, double* w) const;
    /// Contact velocity u (m/s) for mass-normalised body velocities w.
    Velocity velocity(const Contact& contact, const double* w) const {
        const Velocity u = product(contact, w);
        return {u.n + contact.wn, u.t + contact.wt};
    }
    /// Adds the residual of this contact to `sum`.
    static void addResidual(const Contact& contact, const Velocity& u, double rn, double rt, ResidualSum& sum) {
        if (contact.bilateral())
            sum.addBilateral(u.n, u.t, contact.qn, contact.qt, rn, rt, contact.bilateralRows == BilateralRows::Both,
                             contact.d);
        else
            sum.add(u.n, u.t, contact.qn, contact.qt, rn, rt, contact.mu, contact.d);
    }
    /// w = w_free + G r.
    void assemble(std::span<const double> r, std::vector<double>& w) const;
    void assemble(std::span<const double> r, std::vector<double>& w, const parallel::For& loop);
    /// The residual on mass-normalised data; w must belong to r.
    Residual residual(std::span<const double> r, const std::vector<double>& w) const;
    Residual residual(std::span<const double> r, const std::vector<double>& w, const parallel::For& loop);
    /// v = L^-T w of every body.
    void bodyVelocities(const std::vector<double>& w, std::vector<Eigen::VectorXd>& v,
                        const parallel::For& loop = {}) const;

    /// Lists the contacts of every body, unless that was done since build().
    void listContacts();
    /// After listContacts(): those of body b, ascending, as 2 contact + side.
    [[nodiscard]] std::span<const std::int32_t> sidesOf(std::size_t b) const {
        return std::span(ofBody_).subspan(firstOfBody_[b], firstOfBody_[b + 1] - firstOfBody_[b]);
    }

private:
    struct Factor {
        std::size_t n = 0;
        std::size_t padded = 0;
        std::size_t velocity = 0;
        std::vector<double> matrix; ///< A of the last call
        std::vector<double> lower;  ///< L by columns, n x n
        std::vector<double> inverseDiagonal;
    };

    [[nodiscard]] static bool factor(Factor& body, const double* A);
    void layoutContact(const coulomb::Contact& source, Contact& contact);
    void fillContact(const coulomb::Contact& source, Contact& contact, std::vector<DoublePair>& scratch);
    void fillSide(Contact& contact, Side& side, const Eigen::Matrix<double, 2, -1>& H,
                  const Eigen::Matrix<double, 2, -1>* other, std::vector<DoublePair>& scratch);
    void layoutBodies(const Problem& problem);
    void applySide(const Side& side, double rn, double rt, double* w) const;

    std::vector<Factor> bodies_;
    std::vector<Contact> contacts_;
    std::vector<double> rows_;
    std::vector<double> free_;
    std::vector<std::uint8_t> positiveDefinite_; ///< bodies whose A is positive definite
    std::size_t rowsUsed_ = 0;
    std::vector<std::size_t> firstOfBody_; ///< contacts of every body, ascending; empty: not listed yet
    std::vector<std::int32_t> ofBody_;     ///< 2 contact + side
    std::vector<Velocity> velocity_;
    std::size_t longest_ = 0;                      ///< body, padded
    std::vector<std::vector<DoublePair>> columns_; ///< workspace per chunk of contacts
};

// ---- kernels, inline because Gauss-Seidel iterations spend all their time here ----

inline MassNormalisedProblem::Velocity MassNormalisedProblem::product(const Contact& contact, const double* w) const {
    DoublePair n = {0.0, 0.0};
    DoublePair t = {0.0, 0.0};
    for (std::int32_t s = 0; s < contact.sides; ++s) {
        const Side& side = contact.side[s];
        const double* gn = rows_.data() + side.row;
        const double* gt = gn + side.padded;
        const double* v = w + side.velocity;
        for (std::int32_t i = side.begin1; i < side.end1; i += 2) {
            const DoublePair x = *reinterpret_cast<const UnalignedPair*>(v + i);
            n += *reinterpret_cast<const UnalignedPair*>(gn + i) * x;
            t += *reinterpret_cast<const UnalignedPair*>(gt + i) * x;
        }
        for (std::int32_t i = side.begin2; i < side.end2; i += 2) {
            const DoublePair x = *reinterpret_cast<const UnalignedPair*>(v + i);
            n += *reinterpret_cast<const UnalignedPair*>(gn + i) * x;
            t += *reinterpret_cast<const UnalignedPair*>(gt + i) * x;
        }
    }
    return {n[0] + n[1], t[0] + t[1]};
}

namespace kernels {

inline double rowProduct(const double* g, const double* v, const MassNormalisedProblem::Side& side) {
    DoublePair sum = {0.0, 0.0};
    for (std::int32_t i = side.begin1; i < side.end1; i += 2)
        sum += *reinterpret_cast<const UnalignedPair*>(g + i) * *reinterpret_cast<const UnalignedPair*>(v + i);
    for (std::int32_t i = side.begin2; i < side.end2; i += 2)
        sum += *reinterpret_cast<const UnalignedPair*>(g + i) * *reinterpret_cast<const UnalignedPair*>(v + i);
    return sum[0] + sum[1];
}

} // namespace kernels

inline double MassNormalisedProblem::normalProduct(const Contact& contact, const double* w) const {
    double u = 0.0;
    for (std::int32_t s = 0; s < contact.sides; ++s) {
        const Side& side = contact.side[s];
        u += kernels::rowProduct(rows_.data() + side.row, w + side.velocity, side);
    }
    return u;
}

inline double MassNormalisedProblem::tangentProduct(const Contact& contact, const double* w) const {
    double u = 0.0;
    for (std::int32_t s = 0; s < contact.sides; ++s) {
        const Side& side = contact.side[s];
        u += kernels::rowProduct(rows_.data() + side.row + side.padded, w + side.velocity, side);
    }
    return u;
}

inline void MassNormalisedProblem::applySide(const Side& side, double rn, double rt, double* w) const {
    const DoublePair n = {rn, rn};
    const DoublePair t = {rt, rt};
    const double* gn = rows_.data() + side.row;
    const double* gt = gn + side.padded;
    double* v = w + side.velocity;
    const auto add = [&](std::int32_t i) {
        auto* x = reinterpret_cast<UnalignedPair*>(v + i);
        *x = *x + n * *reinterpret_cast<const UnalignedPair*>(gn + i) +
             t * *reinterpret_cast<const UnalignedPair*>(gt + i);
    };
    for (std::int32_t i = side.begin1; i < side.end1; i += 2)
        add(i);
    for (std::int32_t i = side.begin2; i < side.end2; i += 2)
        add(i);
}

inline void MassNormalisedProblem::apply(const Contact& contact, double rn, double rt, double* w) const {
    for (std::int32_t s = 0; s < contact.sides; ++s)
        applySide(contact.side[s], rn, rt, w);
}

} // namespace supercircle::coulomb
