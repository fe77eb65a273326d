#include "tests/reference_simulator/effects.h"

#include <stdexcept>

namespace supercircle::reference_simulator {

namespace {

struct Name {
    const char* label;
    const char* parameter;
    double Effects::*member;
};

constexpr Name kNames[] = {
    {"viscoelastic_bending", "eta_over_B_s", &Effects::kelvinVoigtTime},
    {"viscoelastic_bending", "branch_over_B", &Effects::branch},
    {"viscoelastic_bending", "tau_s", &Effects::branchTime},
    {"nonlinear_elasticity", "uc_1_m", &Effects::softeningCurvature},
    {"nonlinear_elasticity", "stiffening_uc_1_m", &Effects::stiffeningCurvature},
    {"plasticity", "My_over_B_1_m", &Effects::yield},
    {"plasticity", "H_over_B", &Effects::hardening},
    {"plasticity", "kinematic", &Effects::kinematic},
    {"local_damage", "stiffness_drop", &Effects::damage},
    {"local_damage", "curvature_change_1_m", &Effects::damageCurvature},
    {"local_damage", "arc_fraction", &Effects::damageArcFraction},
    {"local_damage", "gauss_width_m", &Effects::damageStandardDeviation},
    {"natural_curvature_defect", "curvature_change_1_m", &Effects::defect},
    {"natural_curvature_defect", "arc_fraction", &Effects::defectArcFraction},
    {"natural_curvature_defect", "length_m", &Effects::defectLength},
    {"stiffness_gradient", "gradient", &Effects::gradient},
    {"stiffness_gradient", "law", &Effects::gradientLaw},
    {"softening_over_time", "drop", &Effects::softening},
    {"softening_over_time", "tau_s", &Effects::softeningTime},
    {"softening_over_time", "logarithmic", &Effects::softeningIsLogarithmic},
    {"*", "specimen", &Effects::specimen},
    {"planar_drag", "f_N_m", &Effects::drag},
    {"gravity", "x_m_s2", &Effects::gravityX},
    {"gravity", "y_m_s2", &Effects::gravityY},
    {"static_friction_excess", "mu_s_over_mu_k", &Effects::staticRatio},
    {"static_friction_excess", "Dc_m", &Effects::slipLength},
    {"static_friction_excess", "tau_heal_s", &Effects::healTime},
    {"rate_dependent_friction", "strength", &Effects::rate},
    {"rate_dependent_friction", "speed_m_s", &Effects::rateSpeed},
    {"rate_dependent_friction", "law", &Effects::rateLaw},
    {"wear", "change", &Effects::wear},
    {"wear", "distance_m", &Effects::wearLength},
    {"adhesion", "F_a_N_m", &Effects::adhesion},
    {"adhesion", "range_m", &Effects::adhesionRange},
    {"contact_compliance", "normal_m_N", &Effects::normalCompliance},
    {"contact_compliance", "tangential_m_N", &Effects::tangentialCompliance},
    {"machine_compliance", "k_N_m", &Effects::machineStiffness},
    {"backlash", "play_m", &Effects::backlash},
    {"misalignment", "offset_m", &Effects::offset},
    {"misalignment", "tilt_rad", &Effects::tilt},
    {"sensor_drift", "a_N", &Effects::drift},
    {"sensor_drift", "tau_s", &Effects::driftTime},
    {"sensor_drift", "rate_N_s", &Effects::driftRate},
    {"sensor_gain", "error", &Effects::gain},
    {"sensor_delay", "delay_s", &Effects::delay},
    {"sensor_delay", "lag_s", &Effects::lag},
    {"rough_patches", "change", &Effects::frictionVariation},
    {"rough_patches", "length_m", &Effects::frictionWavelength},
    {"periodic_disturbance", "a_N", &Effects::disturbance},
    {"periodic_disturbance", "period_s", &Effects::disturbancePeriod},
};

} // namespace

void apply(Effects& effects, const HiddenEffect& hidden) {
    for (const auto& [parameter, value] : hidden.parameters) {
        bool known = false;
        for (const Name& n : kNames)
            if ((hidden.label == n.label || std::string(n.label) == "*") && parameter == n.parameter) {
                effects.*n.member = value;
                known = true;
                break;
            }
        if (!known)
            throw std::invalid_argument(hidden.label + " has no parameter " + parameter);
    }
}

Effects reversed(Effects e) {
    e.damageArcFraction = 1.0 - e.damageArcFraction;
    e.defectArcFraction = 1.0 - e.defectArcFraction;
    e.gradient = -e.gradient;
    return e;
}

} // namespace supercircle::reference_simulator
