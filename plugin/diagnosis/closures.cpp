#include "plugin/diagnosis/closures.h"

#include <algorithm>

namespace supercircle::diagnosis {

namespace {

effects::SplineCoefficients coefficients(const std::vector<double>& values) {
    effects::SplineCoefficients c{};
    std::copy_n(values.begin(), std::min(values.size(), c.size()), c.begin());
    return c;
}

std::vector<double> spline(const std::vector<double>& values, const std::vector<double>& at) {
    std::vector<double> out;
    for (const double x : at)
        out.push_back(effects::evaluateSpline(coefficients(values), x).value);
    return out;
}

/// A candidate with coefficients from `lower` up, a step of `step`.
Candidate learned(const std::string& label, const std::string& slot, const std::string& law, double lower, double upper,
                  double step, Curve curve) {
    Candidate c;
    c.label = label;
    c.slot = slot;
    c.law = law;
    c.learned = true;
    c.curve = std::move(curve);
    for (std::size_t k = 1; k <= effects::kSplineCoefficients; ++k)
        c.parameters.push_back({"c" + std::to_string(k), "1", "", 0.0, lower, upper, step, Scale::Linear, true});
    return c;
}

void onReadings(Menu& menu, Candidate c, Reading reading) {
    menu.candidates.push_back(std::move(c));
    menu.recipes.push_back({{}, {}, reading});
}

} // namespace

void addClosures(Menu& menu, const Sizes& s) {
    const double f = 0.2 * s.force;
    onReadings(menu,
               learned("learned_machine_force", "apparatus", "reading += S(displacement)", -20.0, 20.0, 0.05,
                       {"displacement", "m", "added force", false, "N", 0.0, s.travel, false, f, spline}),
               Reading::ByDisplacement);
    onReadings(menu,
               learned("learned_machine_friction", "apparatus", "reading += S(displacement) against the motion", -20.0,
                       20.0, 0.05,
                       {"displacement", "m", "force against the motion", false, "N", 0.0, s.travel, false, f, spline}),
               Reading::ByDirection);
    onReadings(menu,
               learned("learned_drift", "sensor", "reading += S(time)", -20.0, 20.0, 0.05,
                       {"time", "s", "zero of the load cell", false, "N", 0.0, s.duration, false, f, spline}),
               Reading::ByTime);
}

} // namespace supercircle::diagnosis
