#include "supercircle/effects/laws/air.h"

#include <cmath>

namespace supercircle::effects {

void listPoints(const rod::RodModel& rod, std::vector<rod::MaterialPoint>& points, std::vector<double>& weight) {
    for (int e = 0; e < rod.elements(); ++e)
        for (const double g : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)}) {
            points.push_back(rod::locate(rod, e, rod.nodeS(e) + g * rod.elementLength(e)));
            weight.push_back(0.5 * rod.elementLength(e));
        }
}

Air makeAir(const rod::RodModel& rod, const AirModel& model) {
    Air a;
    a.model = model;
    if (model.on())
        listPoints(rod, a.points, a.weight);
    return a;
}

AirResponse airAt(const Air& a, std::size_t i, double speed) {
    const double size = std::abs(speed);
    return {a.weight[i] * (a.model.linear + a.model.quadratic * size) * speed,
            a.weight[i] * (a.model.linear + 2.0 * a.model.quadratic * size)};
}

} // namespace supercircle::effects
