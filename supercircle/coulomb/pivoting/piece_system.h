#pragma once
// The linear system of a set of contacts whose pieces (open, stick, slip +-) are fixed, and its cheap change when one
// contact moves to another piece.

#include "supercircle/coulomb/law.h"
#include "supercircle/coulomb/pivoting/envelope_lu.h"
#include "supercircle/coulomb/strategy/whitened.h"

#include <Eigen/LU>
#include <Eigen/SparseLU>
#include <array>
#include <span>
#include <vector>

namespace supercircle::coulomb {

/// Finds dr with  (W + eps D) dr = rhs  on the rows the pieces keep closed (u_n for slip, u_n and u_t for stick), dr_t
/// =
/// -+mu dr_n where a contact slips and dr = 0 where it is open. D = diag(d_c). One LU of the
/// pieces given to `factor`, bordered by one or two rows and columns for every contact whose piece has changed
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
        EnvelopeLu::Range range{}; ///< of its column, zero elsewhere
        double constant = 0.0;     ///< right-hand side minus what the base solution gives
    };
    struct SparseRow {
        std::vector<std::int32_t> index;
        std::vector<double> value;
        double dot(const double* x) const;
    };

    void collectNeighbours(const Whitened& problem);
    void orderBodies(const Whitened& problem);
    void visitBodies(const Whitened& problem, std::int32_t from);
    void orderUnknowns(const Whitened& problem);
    template <class Add>
    void assembleBase(const Whitened& problem, Add&& add) const;
    template <class Add>
    void assemblePair(const Whitened& problem, const Local& i, const Local& j, std::int32_t body, Add&& add) const;
    bool factorEnvelope(const Whitened& problem);
    bool factorDense(const Whitened& problem);
    bool factorSparse(const Whitened& problem);
    void reserveBorders(std::size_t width);
    void addBorder(const Whitened& problem, const Border& border);
    void dropBorder(std::size_t j);
    void findConstant(std::size_t j);
    template <class Visit>
    void neighbours(const Whitened& problem, std::size_t k, Visit&& visit) const;
    double entry(const Whitened& problem, const Border& equation, const Border& unknown);
    std::size_t borderColumn(const Whitened& problem, const Border& border, double* column);
    void borderRow(const Whitened& problem, const Border& border, SparseRow& row);
    EnvelopeLu::Range solveBase(double* x, std::size_t begin) const;
    double* column(std::size_t j) { return columns_.data() + j * height_; }

    enum class Factor : std::uint8_t { Envelope, Dense, Sparse };

    std::vector<Local> local_;
    std::vector<Border> borders_;
    std::vector<std::int32_t> bodies_;              ///< bodies with a closed contact, in the order of elimination
    std::vector<std::int32_t> rank_;                ///< position of a body in bodies_, -1 if none, -2 while unvisited
    std::vector<std::vector<std::int32_t>> byBody_; ///< local contacts closed in the base, a list per body
    std::vector<std::int32_t> active_;              ///< local contacts closed in the base, in the order of elimination
    std::vector<std::array<std::int32_t, 3>> key_;
    std::vector<std::int32_t> first_, queue_;
    Eigen::Index count_ = 0;
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
