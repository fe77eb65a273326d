#include "supercircle/rod/elasticity.h"

namespace supercircle::rod {

double bendingEnergy(const RodModel& model, const Eigen::VectorXd& q, int element) {
    const double strain =
        q[model.dofOfElement(element)] - model.definition().naturalCurvature[static_cast<std::size_t>(element)];
    return 0.5 * bendingStiffness(model, element) * strain * strain;
}

double bendingEnergy(const RodModel& model, const Eigen::VectorXd& q) {
    double sum = 0.0;
    for (int i = 0; i < model.elements(); ++i)
        sum += bendingEnergy(model, q, i);
    return sum;
}

void addBendingForce(const RodModel& model, const Eigen::VectorXd& q, Eigen::VectorXd& force) {
    for (int i = 0; i < model.elements(); ++i) {
        const int d = model.dofOfElement(i);
        force[d] -=
            bendingStiffness(model, i) * (q[d] - model.definition().naturalCurvature[static_cast<std::size_t>(i)]);
    }
}

} // namespace supercircle::rod
