#pragma once
// The linear system of a set of contacts whose pieces (open, stick, slip +-) are fixed, and its cheap change when one
// contact moves to another piece.

#include "supercircle/coulomb/law.h"
#include "supercircle/coulomb/whitened.h"

#include <Eigen/LU>
#include <Eigen/SparseLU>
#include <span>
#include <vector>

namespace supercircle::coulomb {

/// Finds dr with  (W + eps D) dr = rhs  on the rows the pieces keep closed (u_n for slip, u_n and u_t for stick), dr_t
/// =
/// -+mu dr_n where a contact slips and dr = 0 where it is open. D = diag(d_c). One LU (dense, or sparse when large) of
/// the pieces given to `factor`, bordered by one or two rows and columns for every contact whose piece has changed
/// since. A contact without friction must be given as Open or SlipPlus.
class PieceSystem {
public:
    /// `contacts` (indices into the problem) and `piece` have one entry a local contact. False if the matrix is
    /// singular.
    bool factor(const Whitened& problem, std::span<const std::int32_t> contacts, std::span<const Piece> piece,
                double eps);

    /// Moves local contact k to `piece`.
    void setPiece(const Whitened& problem, std::size_t k, Piece piece);

    /// Fixes the right-hand side (2 per local contact, m/s); call after `factor` and whenever it changes.
    void setRightHandSide(std::span<const double> rhs);

    /// Writes dr (2 per local contact, N s). False if the bordered system is singular or not finite.
    bool solve(std::span<double> dr);

    std::size_t size() const { return static_cast<std::size_t>(count_); }
    std::size_t borders() const { return borders_.size(); }
    Piece piece(std::size_t k) const { return local_[k].piece; }

private:
    struct Local {
        std::int32_t contact = -1;
        std::int32_t n = -1; ///< base unknown r_n (slip: along the edge of the cone), -1 if open in the base
        std::int32_t t = -1; ///< base unknown r_t, -1 unless sticking in the base
        double slide = 0.0;  ///< base slip: r_t = slide r_n
        double mu = 0.0;
        double prox = 0.0; ///< eps d
        Piece base = Piece::Open;
        Piece piece = Piece::Open;
    };
    /// One extra unknown and one extra equation.
    struct Border {
        std::int32_t k = 0;
        std::int32_t slackRow = -1; ///< >= 0: the unknown is the velocity of this base row, no longer zero
        double rn = 0.0;            ///< else: the unknown is an impulse along (rn, rt)
        double rt = 0.0;
        std::int32_t velocity = -1; ///< 0 or 1: the equation is u_n = rhs or u_t = rhs
        double an = 0.0;            ///< else: an r_n + at r_t = 0
        double at = 0.0;
    };

    template <class Add>
    void assembleBase(const Whitened& problem, Add&& add);
    void fillBodyBlock(const Whitened& problem, std::span<const std::int32_t> members, std::int32_t body);
    bool factorDense(const Whitened& problem);
    bool factorSparse(const Whitened& problem);
    void collectNeighbours(const Whitened& problem);
    void addBorder(const Whitened& problem, const Border& border);
    void dropBorder(std::size_t j);
    template <class Visit>
    void neighbours(const Whitened& problem, std::size_t k, Visit&& visit) const;
    double entry(const Whitened& problem, const Border& equation, const Border& unknown);
    void borderColumn(const Whitened& problem, const Border& border, Eigen::Ref<Eigen::VectorXd> column);
    void borderRow(const Whitened& problem, const Border& border, Eigen::Ref<Eigen::VectorXd> row);
    void solveBase(Eigen::Ref<Eigen::VectorXd> x) const;

    std::vector<Local> local_;
    std::vector<Border> borders_;
    std::vector<std::vector<std::int32_t>> byBody_; ///< local contacts closed in the base, a list per body
    std::vector<std::int32_t> active_;
    Eigen::Index count_ = 0;
    Eigen::MatrixXd base_;
    Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
    bool sparse_ = false; ///< the base is factored by `sparseLu_`
    std::vector<Eigen::Triplet<double>> triplets_;
    Eigen::SparseMatrix<double> sparseBase_;
    Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::AMDOrdering<int>> sparseLu_;
    Eigen::MatrixXd left_, right_, block_; ///< rows and columns of one body
    std::vector<std::int32_t> index_;
    Eigen::MatrixXd rows_;    ///< V, one column a border
    Eigen::MatrixXd columns_; ///< base^-1 U, one column a border
    Eigen::MatrixXd schur_;
    Eigen::MatrixXd schurLu_;
    std::vector<int> schurPivot_;
    Eigen::VectorXd particular_; ///< base^-1 rhs
    Eigen::VectorXd lambda_, x_;
    std::vector<double> rhs_;
    std::vector<double> field_; ///< body velocities caused by one contact, zero between uses
};

} // namespace supercircle::coulomb
