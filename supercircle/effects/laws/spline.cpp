#include "supercircle/effects/laws/spline.h"

#include <algorithm>
#include <span>

namespace supercircle::effects {

namespace {

/// Four basis functions on a segment at t in [0, 1], or their derivatives and integrals with respect to t.
struct Basis {
    double value[4], slope[4], area[4], moment[4];
};

Basis basisAt(double t) {
    const double s = 1.0 - t, t2 = t * t, t3 = t2 * t, t4 = t2 * t2, t5 = t4 * t, s2 = s * s;
    return {{s2 * s / 6.0, (3.0 * t3 - 6.0 * t2 + 4.0) / 6.0, (-3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0) / 6.0, t3 / 6.0},
            {-0.5 * s2, 1.5 * t2 - 2.0 * t, -1.5 * t2 + t + 0.5, 0.5 * t2},
            {(1.0 - s2 * s2) / 24.0, (0.75 * t4 - 2.0 * t3 + 4.0 * t) / 6.0, (-0.75 * t4 + t3 + 1.5 * t2 + t) / 6.0,
             t4 / 24.0},
            {(t - (1.0 - s2 * s2 * s) / 5.0) / 24.0, (0.15 * t5 - 0.5 * t4 + 2.0 * t2) / 6.0,
             (-0.15 * t5 + 0.25 * t4 + 0.5 * t3 + 0.5 * t2) / 6.0, t5 / 120.0}};
}

/// @param segments of [0, 1]; coefficients beyond the last are zero
SplinePoint evaluate(std::span<const double> c, std::size_t segments, double x) {
    const double n = static_cast<double>(segments), h = 1.0 / n;
    const double inside = std::clamp(x, 0.0, 1.0);
    const auto last = std::min(segments - 1, static_cast<std::size_t>(inside * n));
    SplinePoint p;
    for (std::size_t j = 0; j <= last; ++j) {
        const double t = j < last ? 1.0 : inside * n - static_cast<double>(j);
        const Basis b = basisAt(t);
        double area = 0.0, moment = 0.0;
        p.value = p.slope = 0.0;
        for (std::size_t k = 0; k < 4; ++k) {
            const double ck = j + k < c.size() ? c[j + k] : 0.0;
            p.value += ck * b.value[k];
            p.slope += ck * b.slope[k] * n;
            area += ck * b.area[k] * h;
            moment += ck * b.moment[k] * h * h;
        }
        p.moment += p.area * t * h + moment;
        p.area += area;
    }
    if (const double beyond = x - inside; beyond != 0.0) {
        p.slope = 0.0;
        p.moment += p.area * beyond + 0.5 * p.value * beyond * beyond;
        p.area += p.value * beyond;
    }
    return p;
}

} // namespace

SplinePoint evaluateSpline(const SplineCoefficients& c, double x) {
    return evaluate(c, kSplineCoefficients - 3, x);
}

SplinePoint evaluateTable(const TableCoefficients& c, double x) {
    return evaluate(c, kTableCoefficients - 3, x);
}

SplinePoint evaluateFading(const SplineCoefficients& c, double x) {
    return evaluate(c, kSplineCoefficients, x);
}

} // namespace supercircle::effects
