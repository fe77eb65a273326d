#pragma once
// Dense factorisations of matrices whose size is known at run time. Eigen's templates are compiled once, in dense.cpp:
// a source that instantiates one of them costs the compiler five to fifteen seconds.

#include <Eigen/Core>

namespace supercircle::dense {

/// Eigenvalues in increasing order and their eigenvectors, the columns.
struct SymmetricEigen {
    Eigen::VectorXd values;
    Eigen::MatrixXd vectors;
};

/// Of a symmetric matrix; only its lower triangle is read.
[[nodiscard]] SymmetricEigen symmetricEigen(const Eigen::MatrixXd& A);
/// Eigenvalues alone.
[[nodiscard]] Eigen::VectorXd symmetricEigenvalues(const Eigen::MatrixXd& A);

/// Of A x = lambda M x with symmetric A and positive definite M; only lower triangles are read.
[[nodiscard]] Eigen::VectorXd generalisedEigenvalues(const Eigen::MatrixXd& A, const Eigen::MatrixXd& M);

/// Symmetric A: x of A x = b by L D L'.
[[nodiscard]] Eigen::VectorXd solveLdlt(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// Symmetric A: its inverse by L D L'.
[[nodiscard]] Eigen::MatrixXd inverseLdlt(const Eigen::MatrixXd& A);

/// Square A of any rank: x of A x = b by LU with full pivoting; if there is none, a vector that does not satisfy it.
[[nodiscard]] Eigen::VectorXd solveFullPivLu(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// Shortest x with the least |A' x - b|.
[[nodiscard]] Eigen::VectorXd leastSquaresOfTransposed(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// Orthonormal columns that span those of A: pivots below `threshold` times the largest count as zero.
[[nodiscard]] Eigen::MatrixXd rangeBasis(const Eigen::MatrixXd& A, double threshold);
/// Orthonormal columns that span {x: A x = 0}; none if there is only zero.
[[nodiscard]] Eigen::MatrixXd nullSpaceBasis(const Eigen::MatrixXd& A);

} // namespace supercircle::dense
