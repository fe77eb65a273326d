#pragma once
// Quadrature points of laws that act along a rod (private to effects/).

#include "supercircle/rod/kinematics.h"

#include <cmath>
#include <vector>

namespace supercircle::effects {

/// Two points of equal weight for every element (Gauss), and the length of rod of each, m.
inline void listPoints(const rod::RodModel& rod, std::vector<rod::MaterialPoint>& points, std::vector<double>& weight) {
    for (int e = 0; e < rod.elements(); ++e)
        for (const double g : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)}) {
            points.push_back(rod::locate(rod, e, rod.nodeS(e) + g * rod.elementLength(e)));
            weight.push_back(0.5 * rod.elementLength(e));
        }
}

} // namespace supercircle::effects
