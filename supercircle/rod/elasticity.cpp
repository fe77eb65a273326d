#include "supercircle/rod/elasticity.h"

namespace supercircle::rod {

namespace {

double strain(const RodModel& model, const Eigen::VectorXd& q, int element) {
    return q[model.dofOfElement(element)] - model.definition().naturalCurvature[static_cast<std::size_t>(element)];
}

} // namespace

double bendingEnergy(const RodModel& model, const Eigen::VectorXd& q) {
    const double B = model.definition().bendingModulus;
    double sum = 0.0;
    for (int i = 0; i < model.elements(); ++i) {
        const double e = strain(model, q, i);
        sum += 0.5 * bendingStiffness(model, i) * e * e;
    }
    forNeighbours(model, [&](int before, int after, double c) {
        const double change = strain(model, q, after) - strain(model, q, before);
        sum -= 0.5 * B * c * change * change;
    });
    return sum;
}

void addBendingForce(const RodModel& model, const Eigen::VectorXd& q, Eigen::VectorXd& force) {
    for (int i = 0; i < model.elements(); ++i)
        force[model.dofOfElement(i)] -= bendingStiffness(model, i) * strain(model, q, i);
    forNeighbours(model, [&](int before, int after, double c) {
        const double pull =
            model.definition().bendingModulus * c * (strain(model, q, after) - strain(model, q, before));
        force[model.dofOfElement(after)] += pull;
        force[model.dofOfElement(before)] -= pull;
    });
}

void addNeighbourStiffness(const RodModel& model, double factor, Eigen::MatrixXd& matrix) {
    forNeighbours(model, [&](int before, int after, double c) {
        const int a = model.dofOfElement(before), b = model.dofOfElement(after);
        const double k = factor * model.definition().bendingModulus * c;
        matrix(a, a) -= k;
        matrix(b, b) -= k;
        matrix(a, b) += k;
        matrix(b, a) += k;
    });
}

void addBendingStiffness(const RodModel& model, double factor, Eigen::MatrixXd& matrix) {
    for (int i = 0; i < model.elements(); ++i) {
        const int d = model.dofOfElement(i);
        matrix(d, d) += factor * bendingStiffness(model, i);
    }
    addNeighbourStiffness(model, factor, matrix);
}

double bendingRate(const RodModel& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    double rate = 0.0;
    for (int i = 0; i < model.elements(); ++i)
        rate += bendingStiffness(model, i) * strain(model, q, i) * v[model.dofOfElement(i)];
    forNeighbours(model, [&](int before, int after, double c) {
        rate -= model.definition().bendingModulus * c * (strain(model, q, after) - strain(model, q, before)) *
                (v[model.dofOfElement(after)] - v[model.dofOfElement(before)]);
    });
    return rate;
}

void addBendingDrag(const RodModel& model, double factor, const Eigen::VectorXd& v, Eigen::VectorXd& force) {
    for (int i = 0; i < model.elements(); ++i) {
        const int d = model.dofOfElement(i);
        force[d] -= factor * bendingStiffness(model, i) * v[d];
    }
    forNeighbours(model, [&](int before, int after, double c) {
        const int a = model.dofOfElement(before), b = model.dofOfElement(after);
        const double pull = factor * model.definition().bendingModulus * c * (v[b] - v[a]);
        force[b] += pull;
        force[a] -= pull;
    });
}

} // namespace supercircle::rod
