#include "supercircle/effects/laws/drag.h"

#include "supercircle/effects/laws/quadrature.h"

#include <algorithm>
#include <cmath>

namespace supercircle::effects {

Drag makeDrag(const rod::RodModel& rod, const DragModel& model) {
    Drag d;
    d.model = model;
    if (!model.on())
        return d;
    listPoints(rod, d.points, d.weight);
    d.stretch.assign(d.points.size(), Vec2::Zero());
    return d;
}

DragResponse dragAt(const Drag& d, std::size_t i, const Vec2& displacement, bool secant) {
    DragResponse out;
    const double limit = d.model.force * d.weight[i], spring = limit / d.model.presliding;
    const Vec2 trial = d.stretch[i] + displacement;
    const double length = trial.norm();
    if (length <= d.model.presliding) {
        out.stretch = trial;
        out.stiffness = spring * Eigen::Matrix2d::Identity();
    } else {
        const Vec2 n = trial / length;
        out.stretch = d.model.presliding * n;
        out.slipped = length - d.model.presliding;
        out.stiffness = limit / length * Eigen::Matrix2d::Identity();
        if (!secant)
            out.stiffness -= limit / length * n * n.transpose();
    }
    out.force = -spring * out.stretch;
    return out;
}

double storedEnergy(const Drag& d) {
    double sum = 0.0;
    for (std::size_t i = 0; i < d.stretch.size(); ++i)
        sum += 0.5 * d.model.force * d.weight[i] / d.model.presliding * d.stretch[i].squaredNorm();
    return sum;
}

} // namespace supercircle::effects
