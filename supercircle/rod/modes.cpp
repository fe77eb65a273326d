#include "supercircle/rod/modes.h"

#include "supercircle/rod/elasticity.h"
#include "supercircle/rod/inertia.h"
#include "supercircle/support/dense.h"
#include "supercircle/support/invariants.h"

#include <cmath>

namespace supercircle::rod {

Eigen::VectorXd circularFrequencies(const RodModel& model, const Eigen::VectorXd& q, const Eigen::MatrixXd& held) {
    SC_ASSERT(held.rows() == 0 || held.cols() == model.dofs(), "one column for each degree of freedom");
    Kinematics kin;
    kin.evaluate(model, q);
    GaussField field;
    evaluateGauss(model, kin, field);
    Eigen::MatrixXd M, K = Eigen::MatrixXd::Zero(model.dofs(), model.dofs());
    massMatrix(model, kin, field, M);
    addBendingStiffness(model, 1.0, K);
    const Eigen::MatrixXd Z =
        held.rows() > 0 ? dense::nullSpaceBasis(held) : Eigen::MatrixXd(Eigen::MatrixXd::Identity(M.rows(), M.cols()));
    if (Z.cols() == 0)
        return {};
    const Eigen::VectorXd squares = dense::generalisedEigenvalues(Z.transpose() * K * Z, Z.transpose() * M * Z);
    // The slowest mode that any hold leaves a rod is far above this, and round-off far below.
    const double L = model.definition().length;
    const double rigid = 1e-3 * model.definition().bendingModulus / (model.mass() * L * L * L);
    Eigen::Index first = 0;
    while (first < squares.size() && !(squares[first] > rigid))
        ++first;
    return squares.tail(squares.size() - first).cwiseSqrt();
}

} // namespace supercircle::rod
