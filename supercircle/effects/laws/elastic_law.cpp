#include "supercircle/effects/laws/elastic_law.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::effects {

namespace {

/// g of u = g + uc (g/uc)^n for u >= 0: Halley's steps on x + x^n = u/uc, a convex function, from a point at or above
/// the root. A power is most of the cost, so the last step corrects the power by its series: what is left out is 1e-20.
ElasticResponse rambergOsgood(double uc, double n, double u) {
    constexpr double kLastStep = 1e-5; // of x/n; the next step would be its third power
    const double goal = u / uc;
    double x = goal <= 1.0 ? goal : math::pow(goal, 1.0 / n), power = 0.0;
    for (int i = 0; i < 60; ++i) {
        power = math::pow(x, n - 1.0);
        const double slope = 1.0 + n * power, newton = (x * (1.0 + power) - goal) / slope;
        const double step = newton / std::max(0.5, 1.0 - 0.5 * newton * n * (n - 1.0) * power / (x * slope));
        const double share = step / x;
        x -= step;
        if (n * std::abs(share) <= kLastStep) {
            power *= 1.0 - (n - 1.0) * share * (1.0 - 0.5 * (n - 2.0) * share * (1.0 - (n - 3.0) * share / 3.0));
            break;
        }
    }
    const double g = uc * x;
    ElasticResponse out;
    out.value = g;
    out.slope = 1.0 / (1.0 + n * power);
    out.energy = g * g * (0.5 + n / (n + 1.0) * power);
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
    case ElasticModel::Law::Table:
        if (std::isfinite(b.knee)) {
            const SplinePoint s = b.law == ElasticModel::Law::Table ? evaluateTable(b.table, std::abs(x))
                                                                    : evaluateSpline(b.learned, std::abs(x));
            return {u + (u < 0.0 ? -b.knee : b.knee) * s.area, 1.0 + s.value, 0.5 * u * u + b.knee * b.knee * s.moment};
        }
        break;
    case ElasticModel::Law::Linear:
        break;
    }
    return {u, 1.0, 0.5 * u * u};
}

} // namespace supercircle::effects
