#pragma once
// Dense factorisations besides those of support/dense.h, compiled once for the same reason.

#include "supercircle/support/dense.h"

#include <Eigen/Cholesky>

namespace supercircle::dense {

/// Positive definite A: its inverse by L L'.
[[nodiscard]] Eigen::MatrixXd inverseLlt(const Eigen::MatrixXd& A);
/// Positive definite A = L L': L.
[[nodiscard]] Eigen::MatrixXd choleskyFactor(const Eigen::MatrixXd& A);
/// Positive definite A = L L': the inverse of L.
[[nodiscard]] Eigen::MatrixXd inverseCholeskyFactor(const Eigen::MatrixXd& A);

/// L D L' of a symmetric matrix, for several right sides.
class Ldlt {
public:
    void compute(const Eigen::MatrixXd& A);
    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

private:
    Eigen::LDLT<Eigen::MatrixXd> factor_;
};

/// Shortest x with the least |A x - b|.
[[nodiscard]] Eigen::VectorXd leastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// Orthonormal columns that span those of A, which has full column rank.
[[nodiscard]] Eigen::MatrixXd orthonormalColumns(const Eigen::MatrixXd& A);

} // namespace supercircle::dense
