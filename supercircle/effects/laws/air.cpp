#include "supercircle/effects/laws/air.h"

#include "supercircle/effects/laws/quadrature.h"
#include "supercircle/support/trig.h"

#include <cmath>

namespace supercircle::effects {

Air makeAir(const rod::RodModel& rod, const AirModel& model) {
    Air a;
    a.model = model;
    if (model.on())
        listPoints(rod, a.points, a.weight);
    return a;
}

Vec2 normalAt(const rod::Kinematics& kin, const rod::MaterialPoint& at) {
    const auto [sine, cosine] = math::sinCos(kin.angle(at));
    return {-sine, cosine};
}

AirResponse airAt(const Air& a, std::size_t i, double speed) {
    const double size = std::abs(speed);
    return {a.weight[i] * (a.model.linear + a.model.quadratic * size) * speed,
            a.weight[i] * (a.model.linear + 2.0 * a.model.quadratic * size)};
}

} // namespace supercircle::effects
