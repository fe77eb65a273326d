#pragma once
// The entries of the catalogue, one file each (private to effects/).

#include "supercircle/effects/effect.h"

namespace supercircle::effects {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A parameter that switches the effect on where it differs from `off`.
inline Parameter amplitude(std::string name, std::string unit, double off, double min, double max, double typical,
                           std::string about) {
    return {std::move(name), std::move(unit), off, min, max, typical, true, std::move(about), {}};
}
/// A further parameter of the effect.
inline Parameter detail(std::string name, std::string unit, double standard, double min, double max,
                        std::string about) {
    return {std::move(name), std::move(unit), standard, min, max, standard, false, std::move(about), {}};
}
/// A choice between words; the first one is the default.
inline Parameter choice(std::string name, std::vector<std::string> choices, std::string about) {
    const double last = static_cast<double>(choices.size()) - 1.0;
    return {std::move(name), "1", 0.0, 0.0, last, 0.0, false, std::move(about), std::move(choices)};
}

/// Appends the coefficients c1 ... of a learned law.
inline void addCoefficients(std::vector<Parameter>& to, double min, double max, const std::string& about) {
    for (std::size_t k = 1; k <= kSplineCoefficients; ++k)
        to.push_back(detail("c" + std::to_string(k), "1", 0.0, min, max, about));
}
/// Appends the coefficients t1 ... of a law that is given as a formula.
inline void addTable(std::vector<Parameter>& to) {
    for (std::size_t k = 1; k <= kTableCoefficients; ++k)
        to.push_back(detail("t" + std::to_string(k), "1", 0.0, -0.99, 1e3, "coefficient of S of a table"));
}
inline TableCoefficients tableAt(const Values& v, std::size_t first) {
    TableCoefficients t{};
    for (std::size_t k = 0; k < t.size(); ++k)
        t[k] = v[first + k];
    return t;
}
inline SplineCoefficients coefficientsAt(const Values& v, std::size_t first) {
    SplineCoefficients c{};
    for (std::size_t k = 0; k < c.size(); ++k)
        c[k] = v[first + k];
    return c;
}

Effect viscoelasticBending();
Effect nonlinearElasticity();
Effect plasticity();
Effect localDamage();
Effect naturalCurvatureDefect();
Effect stiffnessGradient();
Effect softeningOverTime();
Effect planarDrag();
Effect gravity();
Effect staticFrictionExcess();
Effect rateDependentFriction();
Effect wear();
Effect adhesion();
Effect contactCompliance();
Effect machineCompliance();
Effect backlash();
Effect misalignment();
Effect sensorDrift();
Effect sensorGain();
Effect sensorDelay();
Effect bearingFriction();
Effect airDrag();
Effect guideFriction();
Effect nonlinearSpring();
Effect rateAndStateFriction();
Effect supportSettlement();
Effect clampCompliance();

} // namespace supercircle::effects
