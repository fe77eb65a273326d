#include "supercircle/effects/laws/profile.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::effects {

namespace {

constexpr double kMinStiffness = 1e-3;
constexpr int kIntervals =
    16; ///< per element, each with two Gauss points: resolves a width of a tenth of an element to 1e-6

} // namespace

double shapeAt(const Profile& p, double length, double s) {
    const double x = s - p.centre * length;
    switch (p.shape) {
    case Profile::Shape::Gauss:
        return math::exp(-0.5 * (x / p.width) * (x / p.width));
    case Profile::Shape::Flat:
        return std::abs(x) <= 0.5 * p.width ? 1.0 : 0.0;
    case Profile::Shape::Linear:
    case Profile::Shape::Thickness:
        return 2.0 * s / length - 1.0;
    }
    return 0.0;
}

double stiffnessAt(const Profile& p, double length, double s) {
    const double x = 1.0 + p.stiffness * shapeAt(p, length, s);
    return std::max(kMinStiffness, p.shape == Profile::Shape::Thickness ? x * x * x : x);
}

Profile mirrored(Profile p) {
    p.centre = 1.0 - p.centre;
    if (p.shape == Profile::Shape::Linear || p.shape == Profile::Shape::Thickness) { // odd about the middle
        p.stiffness = -p.stiffness;
        p.curvature = -p.curvature;
    }
    return p;
}

Section sections(const rod::RodModel& model, const std::vector<Profile>& profiles, std::size_t count) {
    const auto n = static_cast<std::size_t>(model.elements());
    Section out{std::vector<double>(n, 1.0), std::vector<double>(n, 0.0)};
    if (count == 0)
        return out;
    const double L = model.definition().length;
    for (std::size_t e = 0; e < n; ++e) {
        const double start = model.nodeS(static_cast<int>(e)), l = model.elementLength(static_cast<int>(e));
        // Flat parts begin and end anywhere. Cuts at their ends make the quadrature exact.
        std::vector<double> cuts;
        for (int i = 0; i <= kIntervals; ++i)
            cuts.push_back(start + l * i / kIntervals);
        for (std::size_t k = 0; k < count; ++k)
            if (profiles[k].shape == Profile::Shape::Flat)
                for (const double edge : {-0.5, 0.5}) {
                    const double s = profiles[k].centre * L + edge * profiles[k].width;
                    if (s > start && s < start + l)
                        cuts.push_back(s);
                }
        std::sort(cuts.begin(), cuts.end());
        double compliance = 0.0, curvature = 0.0;
        for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
            for (const double g : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)}) {
                const double part = 0.5 * (cuts[i + 1] - cuts[i]) / l;
                const double s = cuts[i] + g * (cuts[i + 1] - cuts[i]);
                double factor = 1.0;
                for (std::size_t k = 0; k < count; ++k) {
                    factor *= stiffnessAt(profiles[k], L, s);
                    curvature += part * profiles[k].curvature * shapeAt(profiles[k], L, s);
                }
                compliance += part / factor;
            }
        out.factor[e] = 1.0 / compliance;
        out.curvature[e] = curvature;
    }
    return out;
}

} // namespace supercircle::effects
