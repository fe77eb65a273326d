#include "plugin/identification/replay/strung_bow.h"

#include "supercircle/rod/equilibrium.h"
#include "supercircle/support/trig.h"

#include <cmath>

namespace supercircle::replay {

namespace {

using rod::Vec2;

/// Curvature of an arc of length `half` whose end has the distance `height` from its tangent; 0: there is none.
double curvatureFor(double half, double height) {
    double low = 0.0, high = M_PI / half; // up to a half circle
    const auto at = [&](double k) { return k > 0.0 ? (1.0 - math::cos(k * half)) / k : 0.0; };
    if (!(height > 0.0) || at(high) <= height)
        return 0.0;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (at(middle) < height ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

} // namespace

StrungBow stringBow(const rod::RodModel& model, const Vec2& gravity, double s, const Vec2& point, double angle,
                    const Vec2& nock) {
    StrungBow out;
    const double length = model.definition().length, half = 0.5 * length;
    const Vec2 t(math::cos(angle), math::sin(angle));
    Vec2 n(-t.y(), t.x());
    const double side = (nock - point).dot(n) < 0.0 ? -1.0 : 1.0;
    n *= side;
    const double height = (nock - point).dot(n);
    const double curvature = curvatureFor(half, height);
    if (curvature <= 0.0 || std::abs((nock - point).dot(t)) > 1e-3 * length) {
        out.failure =
            "the middle of the string must lie perpendicular to the clamp and within reach of the ends of the strip";
        return out;
    }
    rod::RodDefinition bent = model.definition();
    for (double& k : bent.naturalCurvature)
        k = side * curvature;
    Eigen::VectorXd start = rod::naturalShape(rod::RodModel(bent), point, angle);
    double pull = 0.0; // N, transverse to the string
    const auto at = [&](double a) {
        rod::EquilibriumProblem strung;
        strung.gravity = gravity;
        strung.supports = {rod::clamp(s, point, angle), rod::pin(0.0, point - a * t + height * n),
                           rod::pin(length, point + a * t + height * n)};
        const rod::Equilibrium found = rod::solveEquilibrium(model, strung, start);
        out.failure = found.failure.empty() ? "" : "no equilibrium of the strung bow was found: " + found.failure;
        out.q = found.q;
        if (found.converged()) {
            start = found.q;
            pull = (found.reactions[1].force + found.reactions[2].force).dot(n);
        }
        return pull;
    };
    double a0 = math::sin(curvature * half) / curvature, a1 = 0.998 * a0;
    double f0 = at(a0);
    constexpr int kRounds = 40;
    for (int i = 0; i < kRounds && out.failure.empty(); ++i) { // secant iteration
        const double f1 = at(a1);
        out.half = a1;
        if (!out.failure.empty() || std::abs(a1 - a0) < 1e-12 * length || f1 == f0)
            break;
        const double next = a1 - f1 * (a1 - a0) / (f1 - f0);
        a0 = a1;
        f0 = f1;
        a1 = next;
    }
    return out;
}

} // namespace supercircle::replay
