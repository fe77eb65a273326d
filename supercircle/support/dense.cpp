#include "supercircle/support/dense.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace supercircle::dense {

using Eigen::MatrixXd;
using Eigen::VectorXd;

SymmetricEigen symmetricEigen(const MatrixXd& A) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(A);
    return {eigen.eigenvalues(), eigen.eigenvectors()};
}

VectorXd symmetricEigenvalues(const MatrixXd& A) {
    return Eigen::SelfAdjointEigenSolver<MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

VectorXd generalisedEigenvalues(const MatrixXd& A, const MatrixXd& M) {
    return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(A, M, Eigen::EigenvaluesOnly).eigenvalues();
}

VectorXd solveLdlt(const MatrixXd& A, const VectorXd& b) {
    return A.ldlt().solve(b);
}

MatrixXd inverseLdlt(const MatrixXd& A) {
    return A.ldlt().solve(MatrixXd::Identity(A.rows(), A.cols()));
}

VectorXd solveFullPivLu(const MatrixXd& A, const VectorXd& b) {
    return A.fullPivLu().solve(b);
}

VectorXd leastSquaresOfTransposed(const MatrixXd& A, const VectorXd& b) {
    return A.transpose().completeOrthogonalDecomposition().solve(b);
}

MatrixXd rangeBasis(const MatrixXd& A, double threshold) {
    Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
    qr.setThreshold(threshold);
    const MatrixXd thin = MatrixXd::Identity(A.rows(), qr.rank());
    return qr.householderQ() * thin;
}

MatrixXd nullSpaceBasis(const MatrixXd& A) {
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(A.transpose());
    const Eigen::Index n = A.cols();
    const MatrixXd Q = qr.householderQ() * MatrixXd::Identity(n, n);
    return Q.rightCols(n - qr.rank());
}

} // namespace supercircle::dense
