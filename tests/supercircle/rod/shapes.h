#pragma once
// Rods and configurations the rod tests share.

#include "supercircle/rod/inertia.h"
#include "supercircle/rod/kinematics.h"

#include <string>
#include <vector>

namespace supercircle::rod::shapes {

inline const std::vector<int> kElementCounts = {1, 2, 3, 5, 15, 16, 31};

/// A rod of length 1.3, thickness 0.01, linear mass 0.7 and modulus 0.4: all different, none equal to one.
inline RodModel rod(int elements, double naturalCurvature = 0.6, double tipRefinement = 1.0) {
    RodDefinition d;
    d.length = 1.3;
    if (tipRefinement != 1.0)
        d.elementLength = gradedLengths(d.length, elements, tipRefinement);
    d.thickness = 0.01;
    d.linearMass = 0.7;
    d.bendingModulus = 0.4;
    d.naturalCurvature.assign(static_cast<std::size_t>(elements), naturalCurvature);
    return RodModel(d);
}

/// Equal arcs, and arcs that shorten towards the tips or the middle.
inline std::vector<RodModel> models(double naturalCurvature = 0.6) {
    std::vector<RodModel> list;
    for (const int n : kElementCounts)
        list.push_back(rod(n, naturalCurvature));
    for (const int n : {3, 4, 5, 31, 32}) // the long arcs rotate no further than one of 15 equal arcs
        list.push_back(rod(n, naturalCurvature, 3.0));
    list.push_back(rod(31, naturalCurvature, 0.4));
    return list;
}

struct Shape {
    std::string name;
    Eigen::VectorXd q;
};

/// Deterministic, irregular numbers in (-1, 1).
inline double wobble(int i) {
    const double x = 0.618033988749895 * (i + 1) * (i + 3);
    return 2.0 * (x - static_cast<double>(static_cast<long>(x))) - 1.0;
}

/// Straight, almost straight, curved one way, wavy, and curled more than once over (at most half a radian an element
/// from 15 elements on).
inline std::vector<Shape> shapesOf(const RodModel& model) {
    const auto make = [&](const std::string& name, double mean, double spread) {
        Eigen::VectorXd q(model.dofs());
        for (int i = 0; i < model.elements(); ++i)
            q[model.dofOfElement(i)] = mean + spread * wobble(i);
        q[model.dofX()] = 0.3;
        q[model.dofY()] = -0.8;
        q[model.dofTheta()] = 2.1;
        return Shape{name, q};
    };
    return {make("straight", 0.0, 0.0), make("almost straight", 0.0, 1e-7), make("curved", 2.0, 0.5),
            make("wavy", 0.0, 4.0), make("curled", -4.5, 1.0)};
}

/// Material points all along the rod, including both tips and the element boundaries.
inline std::vector<MaterialPoint> materialPointsOf(const RodModel& model) {
    std::vector<MaterialPoint> points;
    for (int i = 0; i < model.elements(); ++i)
        for (double t : {0.0, 0.3, 0.5, 0.8, 1.0})
            points.push_back(locate(model, i, model.nodeS(i) + t * model.elementLength(i)));
    return points;
}

inline Kinematics at(const RodModel& model, const Eigen::VectorXd& q) {
    Kinematics kin;
    kin.evaluate(model, q);
    return kin;
}

inline Eigen::VectorXd velocity(const RodModel& model) {
    Eigen::VectorXd v(model.dofs());
    for (int i = 0; i < model.dofs(); ++i)
        v[i] = 1.5 * wobble(i + 7);
    return v;
}

} // namespace supercircle::rod::shapes
