#include "tests/blind_benchmark/synthetic_cases/effect_families.h"

#include <algorithm>
#include <stdexcept>

namespace supercircle::blind_benchmark {

namespace {

using P = Protocol;
using Values = std::map<std::string, double>;
using Make = std::function<HiddenEffect(double)>;

constexpr double kBend = 50.0; ///< curvature of the shells, 1/m

/// Typical peak force of the set-up, N.
double peak(P p) {
    return p == P::Strip ? 1.2 : p == P::Arch ? 0.7 : p == P::Shells ? 0.06 : 0.085;
}

Make make(const std::string& label, Values fixed, const std::string& amplitude, double one) {
    return [=](double a) {
        HiddenEffect h{label, fixed};
        h.parameters[amplitude] = one * a;
        return h;
    };
}

std::vector<Family> materials() {
    return {
        {"kelvin_voigt",
         "viscoelastic_bending",
         {P::Arch, P::Strip, P::Cylinder},
         false,
         8.0,
         true,
         false,
         [](Random&, P) { return make("viscoelastic_bending", {}, "eta_over_B_s", 0.03); }},
        {"relaxation",
         "viscoelastic_bending",
         {P::Arch, P::Strip, P::Cylinder},
         false,
         4.0,
         true,
         false,
         [](Random& d, P) {
             return make("viscoelastic_bending", {{"tau_s", d.logarithmic(0.5, 5.0)}}, "branch_over_B", 0.1);
         }},
        {"softening_moment",
         "nonlinear_elasticity",
         {P::Strip, P::Arch},
         false,
         6.0,
         true,
         false,
         [](Random&, P p) {
             const double knee = p == P::Strip ? 300.0 : 100.0;
             return Make([=](double a) {
                 return HiddenEffect{"nonlinear_elasticity", {{"uc_1_m", knee / std::sqrt(a)}}};
             });
         }},
        {"plasticity",
         "plasticity",
         {P::Arch, P::Strip},
         false,
         2.0,
         true,
         false,
         [](Random& d, P p) { // yield moment relative to the largest moment in the set-up
             const double most = p == P::Strip ? 78.0 : 33.0, hardening = d.uniform(0.2, 0.6);
             return Make([=](double a) {
                 return HiddenEffect{
                     "plasticity",
                     {{"My_over_B_1_m", most * (1.0 - 0.12 * std::min(a, 6.0))}, {"H_over_B", hardening}}};
             });
         }},
        {"softening",
         "softening_over_time",
         {P::Arch, P::Strip, P::Cylinder},
         false,
         6.0,
         true,
         false,
         [](Random& d, P) {
             return make("softening_over_time", {{"tau_s", d.logarithmic(4.0, 25.0)}}, "drop", 0.08);
         }},
        {"damage",
         "local_damage",
         {P::Cylinder, P::Arch, P::Shells},
         true,
         1.5,
         true,
         false,
         [](Random& d, P p) {
             const double place = d.chance(0.5) ? d.uniform(0.15, 0.4) : d.uniform(0.6, 0.85);
             const double width = d.uniform(0.0015, 0.003), bend = -0.3 * kBend;
             return Make([=](double a) {
                 HiddenEffect h{"local_damage",
                                {{"arc_fraction", place},
                                 {"gauss_width_m", width},
                                 {"stiffness_drop", std::min(0.85, 0.5 * a)},
                                 {"curvature_change_1_m", bend * a}}};
                 if (p == P::Shells)
                     h.parameters["specimen"] = 1.0;
                 return h;
             });
         }},
        {"defect",
         "natural_curvature_defect",
         {P::Cylinder, P::Arch},
         true,
         4.0,
         true,
         false,
         [](Random& d, P) {
             const double place = d.chance(0.5) ? d.uniform(0.15, 0.4) : d.uniform(0.6, 0.85);
             const double length = d.uniform(0.006, 0.014),
                          sign = d.sign(); // the order of arguments is unspecified
             return make("natural_curvature_defect", {{"arc_fraction", place}, {"length_m", length}},
                         "curvature_change_1_m", sign * 0.15 * kBend);
         }},
        {"gradient",
         "stiffness_gradient",
         {P::Cylinder, P::Arch},
         true,
         6.0,
         true,
         false,
         [](Random& d, P) {
             return make("stiffness_gradient", {{"law", 0.0}}, "gradient", d.sign() * 0.05);
         }},
    };
}

std::vector<Family> contacts() {
    return {
        {"static_friction",
         "static_friction_excess",
         {P::Arch, P::Cylinder},
         false,
         5.0,
         true,
         false,
         [](Random& d, P) {
             const double length = d.logarithmic(8e-5, 4e-4), heal = d.uniform(1.0, 5.0);
             return Make([=](double a) {
                 return HiddenEffect{"static_friction_excess",
                                     {{"mu_s_over_mu_k", 1.0 + 0.3 * a}, {"Dc_m", length}, {"tau_heal_s", heal}}};
             });
         }},
        {"stribeck",
         "rate_dependent_friction",
         {P::Cylinder, P::Arch},
         false,
         2.5,
         true,
         false,
         [](Random& d, P) {
             const double speed = d.logarithmic(8e-4, 4e-3), sign = d.sign();
             return make("rate_dependent_friction", {{"law", 0.0}, {"speed_m_s", speed}}, "strength", sign * 0.2);
         }},
        {"logarithmic_friction",
         "rate_dependent_friction",
         {P::Cylinder, P::Arch},
         false,
         4.0,
         true,
         false,
         [](Random& d, P) {
             return make("rate_dependent_friction", {{"law", 1.0}, {"speed_m_s", d.logarithmic(1e-5, 2e-4)}},
                         "strength", 0.04);
         }},
        {"wear",
         "wear",
         {P::Cylinder, P::Arch},
         false,
         3.0,
         true,
         false,
         [](Random& d, P) {
             const double distance = d.logarithmic(0.01, 0.06), sign = d.sign();
             return make("wear", {{"distance_m", distance}}, "change", sign * 0.25);
         }},
        {"adhesion",
         "adhesion",
         {P::Cylinder},
         false,
         5.0,
         true,
         false,
         [](Random& d, P) {
             return make("adhesion", {{"range_m", d.uniform(1e-4, 3e-4)}}, "F_a_N_m", 15.0);
         }},
        {"contact_give",
         "contact_compliance",
         {P::Arch},
         false,
         8.0,
         true,
         false,
         [](Random&, P) { return make("contact_compliance", {}, "tangential_m_N", 1e-4); }},
        {"drag",
         "planar_drag",
         {P::Cylinder, P::Shells},
         false,
         5.0,
         true,
         false,
         [](Random&, P) { return make("planar_drag", {}, "f_N_m", 0.04); }},
        {"gravity",
         "gravity",
         {P::Cylinder},
         true,
         2.5, // 24.5 m/s^2, inside the range that a diagnosis searches
         true,
         true,
         [](Random& d, P) {
             const double lean = d.uniform(-0.3, 0.3);
             return Make([=](double a) {
                 return HiddenEffect{"gravity",
                                     {{"x_m_s2", 9.81 * a * std::sin(lean)}, {"y_m_s2", -9.81 * a * std::cos(lean)}}};
             });
         }},
        {"rough_patches",
         "rough_patches",
         {P::Cylinder},
         false,
         3.0,
         false,
         false,
         [](Random& d, P) {
             return make("rough_patches", {{"length_m", d.uniform(0.002, 0.005)}}, "change", 0.2);
         }},
    };
}

std::vector<Family> apparatus() {
    return {
        {"machine",
         "machine_compliance",
         {P::Arch, P::Strip},
         false,
         6.0,
         true,
         false,
         [](Random&, P p) {
             const double stiff = p == P::Strip ? 2500.0 : 5000.0;
             return Make([=](double a) { return HiddenEffect{"machine_compliance", {{"k_N_m", stiff / a}}}; });
         }},
        {"backlash",
         "backlash",
         {P::Arch, P::Strip, P::Cylinder},
         false,
         6.0,
         true,
         false,
         [](Random&, P p) { return make("backlash", {}, "play_m", p == P::Cylinder ? 2e-4 : 5e-5); }},
        {"offset",
         "misalignment",
         {P::Cylinder, P::Shells},
         true,
         6.0,
         true,
         false,
         [](Random& d, P) { return make("misalignment", {}, "offset_m", d.sign() * 4e-4); }},
        {"tilt",
         "misalignment",
         {P::Cylinder, P::Strip},
         true,
         6.0,
         true,
         false,
         [](Random& d, P) { return make("misalignment", {}, "tilt_rad", d.sign() * 0.015); }},
        {"drift",
         "sensor_drift",
         {P::Cylinder, P::Arch, P::Strip, P::Shells},
         false,
         8.0,
         true,
         false,
         [](Random& d, P p) {
             const double time = d.logarithmic(3.0, 20.0), sign = d.sign();
             return make("sensor_drift", {{"tau_s", time}}, "a_N", sign * 0.05 * peak(p));
         }},
        {"gain",
         "sensor_gain",
         {P::Cylinder, P::Arch},
         false,
         5.0,
         true,
         false,
         [](Random& d, P) { return make("sensor_gain", {}, "error", d.sign() * 0.1); }},
        {"delay",
         "sensor_delay",
         {P::Arch, P::Strip, P::Cylinder},
         false,
         8.0,
         true,
         false,
         [](Random&, P) { return make("sensor_delay", {}, "delay_s", 0.03); }},
        {"periodic",
         "periodic_disturbance",
         {P::Cylinder, P::Arch},
         false,
         6.0,
         false,
         false,
         [](Random& d, P p) {
             return make("periodic_disturbance", {{"period_s", d.uniform(2.5, 7.0)}}, "a_N", 0.02 * peak(p));
         }},
    };
}

} // namespace

const std::vector<Family>& families() {
    static const std::vector<Family> kAll = [] {
        std::vector<Family> all;
        for (const auto& part : {materials(), contacts(), apparatus()})
            all.insert(all.end(), part.begin(), part.end());
        return all;
    }();
    return kAll;
}

const Family& family(const std::string& name) {
    const auto at = std::find_if(families().begin(), families().end(), [&](const Family& f) { return f.name == name; });
    if (at == families().end())
        throw std::invalid_argument("there is no effect family \"" + name + "\"");
    return *at;
}

std::vector<std::string> equivalentLabels(const std::string& label) {
    if (label == "machine_compliance") // deflections by the force, before, behind or inside the contact
        return {"backlash", "contact_compliance"};
    if (label == "local_damage") // another curvature or stiffness over a few millimetres
        return {"natural_curvature_defect", "stiffness_gradient"};
    return {};
}

} // namespace supercircle::blind_benchmark
