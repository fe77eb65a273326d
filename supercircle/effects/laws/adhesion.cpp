#include "supercircle/effects/laws/adhesion.h"

#include <algorithm>
#include <cmath>

namespace supercircle::effects {

namespace {

constexpr double kSpacing = 2.5e-4;  ///< largest distance of the quadrature points, m
constexpr int kMostPerElement = 128; ///< largest number of quadrature points
/// Points per range: a tip at a steep angle to a surface has only about one range of its length within reach.
constexpr double kPerRange = 3.0;

} // namespace

Adhesion makeAdhesion(const rod::RodModel& rod, const AdhesionModel& model) {
    Adhesion a;
    a.model = model;
    if (!model.on())
        return a;
    const double L = rod.definition().length;
    if (model.spotSpacing > 0.0) {
        const int n = std::max(1, static_cast<int>(std::lround(std::min(1e5, L / model.spotSpacing))));
        for (int i = 0; i <= n; ++i) {
            a.points.push_back(rod::locate(rod, L * i / n));
            a.weight.push_back((i == 0 || i == n ? 0.5 : 1.0) * L / n);
        }
        return a;
    }
    for (int e = 0; e < rod.elements(); ++e) {
        const double l = rod.elementLength(e);
        const int n = std::clamp(static_cast<int>(std::ceil(l / std::min(kSpacing, model.range / kPerRange))), 2,
                                 kMostPerElement);
        for (int i = 0; i < n; ++i) { // midpoints, so that no point is counted twice at nodes
            a.points.push_back(rod::locate(rod, e, rod.nodeS(e) + (i + 0.5) * l / n));
            a.weight.push_back(l / n);
        }
    }
    return a;
}

AdhesionResponse adhesionAt(const AdhesionModel& m, double gap) {
    const double x = gap / m.range;
    if (!(x < 1.0))
        return {};
    const double y = 1.0 - std::max(x, 0.0), y2 = y * y;
    if (m.law == AdhesionModel::Law::Hump) {
        const double f = 6.75 * m.force;
        const bool apart = x > 0.0;
        return {apart ? f * x * y2 : 0.0, apart ? f / m.range * (y2 - 2.0 * x * y) : 0.0,
                -f * m.range * y2 * y * (1.0 / 3.0 - 0.25 * y)};
    }
    if (m.law == AdhesionModel::Law::Learned) {
        const SplinePoint s = evaluateFading(m.learned, std::max(x, 0.0)), end = evaluateFading(m.learned, 1.0);
        return {m.force * s.value, x > 0.0 ? m.force / m.range * s.slope : 0.0,
                m.force * (m.range * (s.area - end.area) + s.value * std::min(gap, 0.0))};
    }
    AdhesionResponse out{m.force * y2, x > 0.0 ? -2.0 * m.force / m.range * y : 0.0, -m.force * m.range * y2 * y / 3.0};
    out.energy += m.force * std::min(gap, 0.0); // pressed into each other by round-off
    return out;
}

} // namespace supercircle::effects
