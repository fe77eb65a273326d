#include "plugin/identification/diagnosis/model/decompositions.h"

#include <Eigen/QR>

namespace supercircle::dense {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd inverseLlt(const MatrixXd& A) {
    return A.llt().solve(MatrixXd::Identity(A.rows(), A.cols()));
}

MatrixXd choleskyFactor(const MatrixXd& A) {
    return A.llt().matrixL();
}

MatrixXd inverseCholeskyFactor(const MatrixXd& A) {
    return A.llt().matrixL().solve(MatrixXd::Identity(A.rows(), A.cols()));
}

void Ldlt::compute(const MatrixXd& A) {
    factor_.compute(A);
}

VectorXd Ldlt::solve(const VectorXd& b) const {
    return factor_.solve(b);
}

VectorXd leastSquares(const MatrixXd& A, const VectorXd& b) {
    return A.completeOrthogonalDecomposition().solve(b);
}

MatrixXd orthonormalColumns(const MatrixXd& A) {
    return Eigen::HouseholderQR<MatrixXd>(A).householderQ() * MatrixXd::Identity(A.rows(), A.cols());
}

} // namespace supercircle::dense
