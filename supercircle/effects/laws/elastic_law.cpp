#include "supercircle/effects/laws/elastic_law.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::effects {

namespace {

/// g of u = g + uc (g/uc)^n for u >= 0: Newton from below on a convex function whose root lies in [0, u].
ElasticResponse rambergOsgood(double uc, double n, double u) {
    double x = std::min(u / uc, math::pow(u / uc, 1.0 / n)); // at or above the root: u = x + x^n there is too large
    for (int i = 0; i < 60; ++i) {
        const double power = math::pow(x, n - 1.0);
        const double step = (x * (1.0 + power) - u / uc) / (1.0 + n * power);
        x -= step;
        if (std::abs(step) <= 1e-15 * std::max(x, 1e-300))
            break;
    }
    const double g = uc * x;
    ElasticResponse out;
    out.value = g;
    out.slope = 1.0 / (1.0 + n * math::pow(x, n - 1.0));
    out.energy = 0.5 * g * g + n / (n + 1.0) * uc * uc * math::pow(x, n + 1.0);
    return out;
}

} // namespace

ElasticResponse evaluate(const ElasticModel& b, double u) {
    const double x = u / b.knee; // 0 where there is no knee
    switch (b.law) {
    case ElasticModel::Law::Softening: {
        const double root = std::sqrt(1.0 + x * x);
        // uc^2 (root - 1) without cancellation
        return {u / root, 1.0 / (root * root * root), u * u / (1.0 + root)};
    }
    case ElasticModel::Law::Stiffening:
        return {u * (1.0 + x * x), 1.0 + 3.0 * x * x, u * u * (0.5 + 0.25 * x * x)};
    case ElasticModel::Law::RambergOsgood:
        if (u != 0.0 && std::isfinite(b.knee)) {
            ElasticResponse out = rambergOsgood(b.knee, b.exponent, std::abs(u));
            out.value = std::copysign(out.value, u);
            return out;
        }
        break;
    case ElasticModel::Law::Learned:
        if (std::isfinite(b.knee)) {
            const SplinePoint s = evaluateSpline(b.learned, std::abs(x));
            return {u + (u < 0.0 ? -b.knee : b.knee) * s.area, 1.0 + s.value, 0.5 * u * u + b.knee * b.knee * s.moment};
        }
        break;
    case ElasticModel::Law::Linear:
        break;
    }
    return {u, 1.0, 0.5 * u * u};
}

} // namespace supercircle::effects
