#pragma once
// The linear system of contacts with fixed statuses (open, stick, slip +-), and its cheap update when one contact
// changes its status.

#include "supercircle/coulomb/law.h"
#include "supercircle/coulomb/pivoting/envelope_lu.h"
#include "supercircle/coulomb/strategy/mass_normalised.h"

#include <Eigen/LU>
#include <Eigen/SparseLU>
#include <array>
#include <span>
#include <vector>

namespace supercircle::coulomb {

/// Finds dr with  (W + eps D) dr = rhs  on the closed rows (u_n for slip, u_n and u_t for stick), D = diag(d_c).
/// dr_t = -+mu dr_n where a contact slips, and dr = 0 where it is open. One LU factorisation of the statuses given to
/// `factor` is bordered by one or two rows and columns for every contact that has changed since. A frictionless contact
/// must be Open or SlipPlus.
class StatusSystem {
public:
    /// `contacts` (indices into the problem) and `status` have one entry per local contact. False if the matrix is
    /// singular.
    [[nodiscard]] bool factor(const MassNormalisedProblem& problem, std::span<const std::int32_t> contacts,
                              std::span<const ContactStatus> status, double eps);

    /// Changes the status of local contact k.
    void setStatus(const MassNormalisedProblem& problem, std::size_t k, ContactStatus status);

    /// Sets the right-hand side (2 per local contact, m/s); call after `factor` and whenever it changes.
    void setRightHandSide(std::span<const double> rhs);

    /// Writes dr (2 per local contact, N s). False if the bordered system is singular or not finite.
    [[nodiscard]] bool solve(std::span<double> dr);

    std::size_t size() const { return static_cast<std::size_t>(count_); }
    std::size_t borders() const { return borders_.size(); }
    /// Multiply-adds of the last factorisation, as if it was one of an envelope.
    double cost() const { return cost_; }
    ContactStatus status(std::size_t k) const { return local_[k].status; }

private:
    struct LocalContact {
        std::int32_t contact = -1;
        std::int32_t n = -1; ///< base unknown r_n (slip: along the cone edge), -1 if open in the base
        std::int32_t t = -1; ///< base unknown r_t, -1 unless sticking in the base
        double slide = 0.0;  ///< base slip: r_t = slide r_n
        double mu = 0.0;
        double prox = 0.0; ///< eps d
        ContactStatus base = ContactStatus::Open;
        ContactStatus status = ContactStatus::Open;
    };
    /// One extra unknown and one extra equation.
    struct Border {
        std::int32_t k = 0;
        std::int32_t slackRow = -1; ///< >= 0: the unknown is the velocity of this base row
        double rn = 0.0;            ///< else: the unknown is an impulse along (rn, rt)
        double rt = 0.0;
        std::int32_t velocity = -1; ///< 0 or 1: the equation is u_n = rhs or u_t = rhs
        double an = 0.0;            ///< else: an r_n + at r_t = 0
        double at = 0.0;
        EnvelopeLu::IndexRange range{}; ///< of its column, zero elsewhere
        double constant = 0.0;          ///< right-hand side minus the value of the base solution
    };
    struct SparseRow {
        std::vector<std::int32_t> index;
        std::vector<double> value;
        double dot(const double* x) const;
    };

    void collectNeighbours(const MassNormalisedProblem& problem);
    void orderBodies(const MassNormalisedProblem& problem);
    void visitBodies(const MassNormalisedProblem& problem, std::int32_t from);
    void orderUnknowns(const MassNormalisedProblem& problem);
    template <class Add>
    void assembleBase(const MassNormalisedProblem& problem, Add&& add) const;
    template <class Add>
    void assemblePair(const MassNormalisedProblem& problem, const LocalContact& i, const LocalContact& j,
                      std::int32_t body, Add&& add) const;
    [[nodiscard]] bool factorEnvelope(const MassNormalisedProblem& problem);
    [[nodiscard]] bool factorDense(const MassNormalisedProblem& problem);
    [[nodiscard]] bool factorSparse(const MassNormalisedProblem& problem);
    void reserveBorders(std::size_t width);
    void addBorder(const MassNormalisedProblem& problem, const Border& border);
    void dropBorder(std::size_t j);
    void findConstant(std::size_t j);
    template <class Visit>
    void neighbours(const MassNormalisedProblem& problem, std::size_t k, Visit&& visit) const;
    double entry(const MassNormalisedProblem& problem, const Border& equation, const Border& unknown);
    std::size_t borderColumn(const MassNormalisedProblem& problem, const Border& border, double* column);
    void borderRow(const MassNormalisedProblem& problem, const Border& border, SparseRow& row);
    EnvelopeLu::IndexRange solveBase(double* x, std::size_t begin) const;
    double* column(std::size_t j) { return columns_.data() + j * height_; }

    enum class Factor : std::uint8_t { Envelope, Dense, Sparse };

    std::vector<LocalContact> local_;
    std::vector<Border> borders_;
    std::vector<std::int32_t> bodies_;              ///< bodies with a closed contact, in the order of elimination
    std::vector<std::int32_t> rank_;                ///< position of a body in bodies_, -1 if none, -2 while unvisited
    std::vector<std::vector<std::int32_t>> byBody_; ///< local contacts closed in the base, a list per body
    std::vector<std::int32_t> active_;              ///< local contacts closed in the base, in the order of elimination
    std::vector<std::array<std::int32_t, 3>> key_;
    std::vector<std::int32_t> first_, queue_;
    Eigen::Index count_ = 0;
    double cost_ = 0.0;
    Factor factor_ = Factor::Envelope;
    EnvelopeLu envelope_;
    Eigen::MatrixXd base_;
    Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
    std::vector<Eigen::Triplet<double>> triplets_;
    Eigen::SparseMatrix<double> sparseBase_;
    Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::AMDOrdering<int>> sparseLu_;
    std::vector<SparseRow> rows_; ///< V, one a border
    std::vector<double> columns_; ///< base^-1 U, one column of height_ a border
    std::size_t height_ = 0;
    Eigen::MatrixXd schur_;
    std::vector<double> schurLu_;
    std::vector<double> particular_; ///< base^-1 rhs
    std::vector<double> lambda_, x_;
    std::vector<double> rhs_;
    std::vector<double> field_; ///< body velocities caused by one contact, zero between uses
};

} // namespace supercircle::coulomb
