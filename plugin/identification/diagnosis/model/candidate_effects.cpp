#include "plugin/identification/diagnosis/model/candidate_effects.h"

#include "plugin/identification/diagnosis/model/candidate_builder.h"
#include "plugin/identification/diagnosis/model/learned_laws.h"
#include "plugin/identification/replay/free_scales.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/identification/replay/simulate.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

using experiment::Experiment;

ExperimentScales scalesOf(const Experiment& e) {
    ExperimentScales s;
    double force = 0.0, speed = 0.0, travel = 0.0, duration = 0.0;
    for (const experiment::Run& run : e.runs) {
        for (const double f : run.readings.force)
            force = std::isfinite(f) ? std::max(force, std::abs(f)) : force;
        for (std::size_t i = 1; i < run.driveTime.size(); ++i) {
            travel = std::max(travel, std::abs(run.driveDisplacement[i]));
            speed = std::max(speed, std::abs(run.driveDisplacement[i] - run.driveDisplacement[i - 1]) /
                                        (run.driveTime[i] - run.driveTime[i - 1]));
        }
        if (!run.driveTime.empty())
            duration = std::max(duration, run.driveTime.back() - run.driveTime.front());
    }
    s.duration = duration > 0.0 ? duration : s.duration;
    s.units = replay::naturalUnits(e);
    s.second = s.units.time;
    if (e.scene && !experiment::isMechanism(e) && !replay::comparesForce(e)) { // readings of a shell
        const experiment::Specimen& bent = e.specimens.front();
        const double radius = experiment::radiusOf(bent);
        travel = e.scene->observation.quantity == scene::Observation::Quantity::Angle ? 0.1 * radius : force;
        force = bent.bendingModulus.value / (radius * radius);
        speed = travel / s.duration;
    }
    s.force = force > 0.0 ? force : s.force;
    s.travel = travel > 0.0 ? travel : s.travel;
    s.speed = speed > 0.0 ? speed : s.speed;
    if (travel > 0.0 && speed > 0.0)
        s.second = std::clamp(s.second, travel / speed / 3.0, 3.0 * travel / speed);
    if (const double gravity = math::hypot(e.gravity.x, e.gravity.y); gravity > 0.0)
        s.gravity = gravity;
    if (e.specimens.empty())
        return s;
    const experiment::Specimen& first = e.specimens.front();
    s.length = first.length;
    s.modulus = first.bendingModulus.value;
    s.radius = experiment::radiusOf(first);
    return s;
}

namespace {

constexpr double kEarth = 9.81; // m/s^2

/// Another gravity, up to 1.5 times the usual one across and 2.5 times along.
void gravity(CandidateBuilder& w, const ExperimentScales& s, double along, double across) {
    const double g = s.gravity / kEarth;
    w.variant("gravity").amplitude("x_m_s2", -15.0 * g, 15.0 * g, 0.5 * g);
    w.amplitude("y_m_s2", -25.0 * g, 25.0 * g, 1.0 * g).probe({0.0, -along * g}).probe({across * g, 0.0});
}

/// @param second s, unit of `probe`
/// Another direction of a gravity that moves bodies. That it acts is seen, and its size is known to half a per cent
/// everywhere: with a free size it would take the place of a wrong length.
void tiltedGravity(CandidateBuilder& w, const ExperimentScales& s, const Experiment& e) {
    const bool vertical = std::abs(e.gravity.y) >= std::abs(e.gravity.x);
    const double g = s.gravity;
    w.variant("gravity", "tilted").amplitude(vertical ? "x_m_s2" : "y_m_s2", -0.5 * g, 0.5 * g, 0.02 * g);
    w.probe({0.1 * g}).correction();
}

void delay(CandidateBuilder& w, double second, double probe) {
    w.variant("sensor_delay", "pure").amplitude("delay_s", 0.0, second, 0.01 * second).probe({probe * second});
    w.variant("sensor_delay", "low pass").amplitude("lag_s", 0.0, 2.0 * second, 0.01 * second).probe({probe * second});
}

void material(CandidateBuilder& w, const ExperimentScales& s) {
    const double bend = 1.0 / s.radius; // 1/m, curvature change that opens a shell flat
    w.variant("viscoelastic_bending", "Kelvin-Voigt")
        .with("law", 0)
        .amplitude("eta_over_B_s", 0.0, 10.0 * s.second, 0.03 * s.second);
    w.probe({0.05 * s.second}).probe({0.3 * s.second});
    w.variant("viscoelastic_bending", "standard linear solid").with("law", 1);
    w.amplitude("branch_over_B", 0.0, 2.0, 0.05).extent("tau_s", 0.02 * s.second, 3.0 * s.duration);
    w.probe({0.1, 0.3 * s.second}).probe({0.1, 2.0 * s.second}).probe({0.1, 0.4 * s.duration});
    w.variant("viscoelastic_bending", "loss factor").with("law", 2).amplitude("loss_factor", 0.0, 1.0, 0.02);
    w.with("f_low_Hz", 0.1 / s.duration).with("f_high_Hz", 1e3 / s.second).probe({0.02}).probe({0.1});
    w.variant("nonlinear_elasticity", "softening").with("law", 0);
    w.amplitude("uc_1_m", 0.03 * bend, 1e6, 2.5 * bend, Scale::ReciprocalSquare).probe({2.5 * bend}).probe({bend});
    w.probe({0.1 * bend}); // thick rings yield long before they are flat
    w.variant("nonlinear_elasticity", "stiffening").with("law", 1);
    w.amplitude("uc_1_m", 0.3 * bend, 1e6, 2.5 * bend, Scale::ReciprocalSquare).probe({2.5 * bend}).probe({bend});
    w.variant("nonlinear_elasticity", "Ramberg-Osgood").with("law", 2);
    w.amplitude("uc_1_m", 0.03 * bend, 1e6, 2.5 * bend, Scale::Reciprocal).extent("exponent", 1.5, 50.0);
    w.probe({0.08 * bend, 10.0}).probe({bend, 3.0});
    w.variant("plasticity", "isotropic hardening").with("hardening", 0);
    w.amplitude("My_over_B_1_m", 0.04 * bend, 1e6, 1.5 * bend, Scale::Reciprocal).extent("H_over_B", 0.01, 5.0);
    w.probe({0.45 * bend, 0.3}).probe({0.2 * bend, 0.3}).probe({0.8 * bend, 0.3}).probe({1.3 * bend, 0.3});
    w.probe({0.08 * bend, 0.03});
    w.variant("plasticity", "kinematic hardening").with("hardening", 1); // differs behind a reversal alone
    w.amplitude("My_over_B_1_m", 0.04 * bend, 1e6, 1.5 * bend, Scale::Reciprocal).extent("H_over_B", 0.01, 5.0);
    w.probe({0.45 * bend, 0.3}).probe({0.2 * bend, 0.3});
    w.variant("softening_over_time", "exponential").with("law", 0);
    w.amplitude("drop", 0.0, 0.9, 0.05).extent("tau_s", 0.2 * s.second, 5.0 * s.duration);
    w.probe({0.1, 0.3 * s.duration}).probe({0.1, 2.0 * s.second});
    w.variant("softening_over_time", "logarithmic").with("law", 1);
    w.amplitude("drop", 0.0, 0.9, 0.03).extent("tau_s", 0.05 * s.second, s.duration);
    w.probe({0.05, 1.0 * s.second});
}

/// A short bend rotates the part beyond it. Runs determine that angle, but hardly the length of the bend.
void localEffects(CandidateBuilder& w, const ExperimentScales& s, const std::vector<std::string>& shells) {
    const double bell = std::sqrt(2.0 * 3.14159265358979); // area of exp(-x^2 / 2)
    const double bend = 1.0 / s.radius;
    for (const std::string& shell : shells) {
        w.variant("local_damage", "", shell).amplitude("stiffness_drop", 0.0, 0.95, 0.15);
        w.amplitude("curvature_change_1_m", -3.0 * bend, 3.0 * bend, 0.15 * bend);
        w.share("arc_fraction", 0.02, 0.98, 0.05).extent("gauss_width_m", 5e-3 * s.length, 0.1 * s.length);
        w.derived("turn_rad", "rad", bell, "curvature_change_1_m", "gauss_width_m");
        for (const double at : {0.2, 0.35, 0.5, 0.65, 0.8})
            w.probe({0.5, -0.4 * bend, at, 0.025 * s.length}).probe({0.5, 0.0, at, 0.025 * s.length});
        w.variant("natural_curvature_defect", "", shell);
        w.amplitude("curvature_change_1_m", -2.0 * bend, 2.0 * bend, 0.1 * bend);
        w.share("arc_fraction", 0.02, 0.98, 0.05).extent("length_m", 0.02 * s.length, 0.8 * s.length).with("shape", 0);
        w.derived("turn_rad", "rad", 1.0, "curvature_change_1_m", "length_m");
        for (const double at : {0.15, 0.3, 0.5, 0.7, 0.85})
            w.probe({-0.25 * bend, at, 0.12 * s.length});
        for (int law = 0; law < 2; ++law) {
            w.variant("stiffness_gradient", law == 0 ? "thickness" : "modulus", shell).with("law", law);
            w.amplitude("gradient", -0.9, 0.9, 0.05).probe({0.1}).probe({-0.1});
        }
    }
}

/// @param compliant contacts may give before they slide
void frictionLaws(CandidateBuilder& w, const ExperimentScales& s, bool compliant) {
    w.variant("static_friction_excess").amplitude("mu_s_over_mu_k", 1.0, 3.0, 0.1);
    const double m = s.units.length; // slips grow with the specimen
    w.extent("Dc_m", 2e-6 * m, 5e-3 * m).extent("tau_heal_s", 0.05 * s.second, 3.0 * s.duration);
    for (const double dc : {2e-5, 1e-4, 5e-4})
        w.probe({1.4, dc * m, 3.0 * s.second});
    w.probe({1.4, 1e-4 * m, 0.5 * s.second});
    if (compliant) {
        w.variant("static_friction_excess", "elastic before sliding").amplitude("mu_s_over_mu_k", 1.0, 3.0, 0.1);
        w.extent("Dc_m", 2e-6 * m, 5e-3 * m).extent("tau_heal_s", 0.05 * s.second, 3.0 * s.duration);
        w.extent("presliding_m", 5e-7 * m, 5e-5 * m);
        for (const double dc : {1e-4, 5e-4})
            w.probe({1.4, dc * m, 3.0 * s.second, 3e-6 * m});
    }
    const char* laws[] = {"Stribeck", "logarithmic", "viscous"};
    for (int law = 0; law < 3; ++law) {
        w.variant("rate_dependent_friction", laws[law]).with("law", law);
        w.amplitude("strength", -0.9, 3.0, 0.1).extent("speed_m_s", 1e-3 * s.speed, 10.0 * s.speed);
        w.probe({0.2, 0.1 * s.speed}).probe({-0.2, 0.1 * s.speed}).probe({0.2, 0.5 * s.speed});
        w.probe({-0.2, 0.01 * s.speed});
    }
    const char* memories[] = {"ageing law", "slip law"};
    for (int law = 0; law < 2; ++law) { // the stated coefficient is that of the drive's speed
        w.variant("rate_and_state_friction", memories[law]).with("law", law).with("V0_m_s", s.speed);
        w.with("creep_m_s", 1e-4 * s.speed).with("rest_s", 60.0 * s.second);
        w.amplitude("a_over_mu", 0.0, 0.5, 0.02).amplitude("b_over_mu", 0.0, 0.5, 0.02);
        w.extent("Dc_m", 2e-6 * m, 5e-3 * m).probe({0.02, 0.04, 1e-5 * m}).probe({0.04, 0.02, 1e-4 * m});
    }
    w.variant("wear").amplitude("change", -0.9, 3.0, 0.1).extent("distance_m", 0.05 * s.travel, 50.0 * s.travel);
    w.probe({0.3, s.travel}).probe({-0.3, s.travel}).probe({0.3, 5.0 * s.travel});
}

void contacts(CandidateBuilder& w, const ExperimentScales& s) {
    frictionLaws(w, s, true);
    const double m = s.units.length; // ranges grow with the specimen
    const double attraction =
        s.modulus / (s.radius * s.radius * s.radius); // N/m, load that bends a shell by its radius
    constexpr double hump = 9.0 / 16.0; // integral of 27/4 x (1 - x)^2: work of separation per length of rod
    w.variant("adhesion", "hump").with("law", 0).amplitude("F_a_N_m", 0.0, 30.0 * attraction, 0.2 * attraction);
    w.extent("range_m", 1e-5 * m, 2e-3 * m).derived("work_N", "N", hump, "F_a_N_m", "range_m");
    w.probe({0.5 * attraction, 1e-4 * m}).probe({1.5 * attraction, 1e-4 * m}).probe({0.5 * attraction, 4e-4 * m});
    w.variant("adhesion", "hump, in spots")
        .with("law", 0)
        .amplitude("F_a_N_m", 0.0, 30.0 * attraction, 0.2 * attraction);
    w.extent("range_m", 1e-5 * m, 2e-3 * m)
        .with("spots_m", 5e-3 * s.length)
        .probe({0.5 * attraction, 1e-4 * m})
        .probe({attraction, 1e-4 * m});
    w.variant("contact_compliance").amplitude("normal_m_N", 0.0, 0.1 * s.travel / s.force, 2e-3 * s.travel / s.force);
    w.amplitude("tangential_m_N", 0.0, 0.1 * s.travel / s.force, 2e-3 * s.travel / s.force);
    w.probe({0.0, 5e-3 * s.travel / s.force}).probe({5e-3 * s.travel / s.force, 0.0});
    w.probe({0.0, 0.05 * s.travel / s.force}); // feet that hardly slip: a search from a tenth of it ends far below
    w.variant("planar_drag")
        .with("presliding_m", 3e-6 * m)
        .amplitude("f_N_m", 0.0, 10.0 * s.force / s.length, 0.03 * s.force / s.length);
    w.probe({0.1 * s.force / s.length}).probe({0.3 * s.force / s.length});
    gravity(w, s, 5.0, 1.0);
    w.probe({0.0, 5.0 * s.gravity / kEarth});
}

void backlashOfReversals(CandidateBuilder& w, const ExperimentScales& s) {
    w.variant("backlash", "taken up at reversals").with("law", 0);
    w.amplitude("play_m", 0.0, 0.2 * s.travel, 3e-3 * s.travel).probe({1e-2 * s.travel}).probe({3e-2 * s.travel});
}

/// @param force N, largest of the load cell
void drift(CandidateBuilder& w, const ExperimentScales& s, double force) {
    w.variant("sensor_drift", "towards an end").amplitude("a_N", -force, force, 0.02 * force);
    w.extent("tau_s", 0.5 * s.second, 5.0 * s.duration);
    w.probe({0.05 * force, 0.2 * s.duration}).probe({0.05 * force, s.duration}).probe({0.05 * force, 2.0 * s.second});
    w.variant("sensor_drift", "steady")
        .amplitude("rate_N_s", -force / s.second, force / s.second, 0.02 * force / s.duration);
    w.probe({0.05 * force / s.duration});
}

/// Of the first channel.
void sensors(CandidateBuilder& w, const ExperimentScales& s) {
    drift(w, s, s.force);
    w.variant("sensor_gain").amplitude("error", -0.6, 1.5, 0.03).probe({0.1});
    delay(w, s.second, 0.05);
    w.probe({0.2 * s.second});
}

/// Largest reading of a further channel, SI unit; 1 if it is never above 0.
double largestOf(const Experiment& e, std::size_t further) {
    double most = 0.0;
    for (const experiment::Run& run : e.runs)
        if (further < run.readings.further.size())
            for (const double v : run.readings.further[further])
                most = std::isfinite(v) ? std::max(most, std::abs(v)) : most;
    return most > 0.0 ? most : 1.0;
}

/// Of channels beside the first one.
void furtherSensors(CandidateBuilder& w, const ExperimentScales& s, const Experiment& e) {
    const auto& further = experiment::furtherChannels(e);
    for (std::size_t k = 0; k < further.size(); ++k) {
        if (further[k].channel.weight == 0.0)
            continue;
        w.ofChannel(k + 1);
        drift(w, s, largestOf(e, k));
        w.variant("sensor_gain").amplitude("error", -0.6, 1.5, 0.03).probe({0.1});
        delay(w, s.second, experiment::isMechanism(e) ? 0.01 : 0.05);
    }
    w.ofChannel(0);
}

void apparatus(CandidateBuilder& w, const ExperimentScales& s) {
    const double stiff = s.force / (0.02 * s.travel);
    w.variant("machine_compliance").amplitude("k_N_m", 0.02 * stiff, 1e12, 3.0 * stiff, Scale::Reciprocal);
    w.probe({5.0 * stiff}).probe({stiff}).probe({0.1 * stiff}); // the last one yields by a fifth of the travel
    backlashOfReversals(w, s);
    w.variant("backlash", "taken up by the force").with("law", 1);
    w.amplitude("play_m", 0.0, 0.2 * s.travel, 3e-3 * s.travel).extent("force_N", 1e-4 * s.force, s.force);
    w.probe({1e-2 * s.travel, 0.02 * s.force}).probe({3e-2 * s.travel, 0.1 * s.force});
    w.variant("support_settlement");
    w.amplitude("bedding_m_N", 0.0, 0.1 * s.travel / s.force, 2e-3 * s.travel / s.force);
    w.probe({5e-3 * s.travel / s.force}).probe({0.05 * s.travel / s.force});
    const double yielding = s.length / s.modulus; // the angle of a moment along the whole specimen
    w.variant("clamp_compliance").amplitude("compliance_rad_N_m", 0.0, 0.5 * yielding, 0.02 * yielding);
    w.probe({0.02 * yielding}).probe({0.1 * yielding});
    w.variant("misalignment", "offset").amplitude("offset_m", -0.3 * s.radius, 0.3 * s.radius, 0.01 * s.radius);
    w.probe({0.05 * s.radius}).probe({-0.05 * s.radius}).probe({0.015 * s.radius});
    w.variant("misalignment", "tilt").amplitude("tilt_rad", -0.3, 0.3, 0.01).probe({0.03}).probe({-0.03}).probe({0.1});
    sensors(w, s);
}

double square(double v) {
    return v * v;
}

/// The air round shells that vibrate. A damping ratio of half a per cent is relevant, at the largest reading.
void airOfShells(CandidateBuilder& w, const ExperimentScales& s, const Experiment& e) {
    const double rate = 3.5 / s.units.time; // rad/s, of a clamped strip in its first mode
    const double linear = 0.01 * e.specimens.front().linearMass.value * rate, quadratic = linear / (rate * s.travel);
    w.variant("air_drag", "linear").amplitude("linear_N_s_m2", 0.0, 100.0 * linear, linear);
    w.probe({linear}).probe({0.2 * linear});
    w.variant("air_drag", "quadratic").amplitude("quadratic_N_s2_m3", 0.0, 100.0 * quadratic, quadratic);
    w.probe({quadratic}).probe({0.2 * quadratic});
}

void bearings(CandidateBuilder& w, double torque, double viscous, double length) {
    w.variant("bearing_friction", "dry").amplitude("torque_N_m", 0.0, 50.0 * torque, torque);
    w.probe({torque}).probe({0.2 * torque});
    w.variant("bearing_friction", "dry, with the load").amplitude("arm_m", 0.0, 0.2 * length, 5e-3 * length);
    w.probe({5e-3 * length}).probe({1e-3 * length});
    w.variant("bearing_friction", "viscous").amplitude("viscous_N_m_s", 0.0, 100.0 * viscous, viscous);
    w.probe({viscous}).probe({0.2 * viscous});
    w.variant("bearing_friction", "dry and viscous").amplitude("torque_N_m", 0.0, 50.0 * torque, torque);
    w.amplitude("viscous_N_m_s", 0.0, 100.0 * viscous, viscous).probe({0.5 * torque, 0.5 * viscous});
}

/// @param force N, viscous N s/m, speed m/s
void guides(CandidateBuilder& w, double force, double viscous, double speed) {
    const double quadratic = viscous / speed;
    w.variant("guide_friction", "dry")
        .amplitude("force_N", 0.0, 50.0 * force, force)
        .probe({force})
        .probe({0.2 * force});
    w.variant("guide_friction", "viscous").amplitude("viscous_N_s_m", 0.0, 100.0 * viscous, viscous);
    w.probe({viscous}).probe({0.2 * viscous});
    w.variant("guide_friction", "quadratic").amplitude("quadratic_N_s2_m2", 0.0, 100.0 * quadratic, quadratic);
    w.probe({quadratic}).probe({0.2 * quadratic});
    w.variant("guide_friction", "dry and viscous").amplitude("force_N", 0.0, 50.0 * force, force);
    w.amplitude("viscous_N_s_m", 0.0, 100.0 * viscous, viscous).probe({0.5 * force, 0.5 * viscous});
}

void air(CandidateBuilder& w, const replay::FreeScales& s, double viscous) {
    const double linear = 3.0 * viscous / math::pow(s.length, 3), // of a rod hinged at its end
        square = 4.0 * viscous / (s.spin * math::pow(s.length, 4));
    w.variant("air_drag", "linear").amplitude("linear_N_s_m2", 0.0, 100.0 * linear, linear);
    w.probe({linear}).probe({0.2 * linear});
    w.variant("air_drag", "quadratic").amplitude("quadratic_N_s2_m3", 0.0, 100.0 * square, square);
    w.probe({square}).probe({0.2 * square});
    w.variant("air_drag", "linear and quadratic").amplitude("linear_N_s_m2", 0.0, 100.0 * linear, linear);
    w.amplitude("quadratic_N_s2_m3", 0.0, 100.0 * square, square).probe({0.5 * linear, 0.5 * square});
}

/// @param most largest elongation, m or rad
void cubic(CandidateBuilder& w, const char* words, const char* parameter, double most) {
    const double unit = 1.0 / square(most);
    w.variant("nonlinear_spring", words).amplitude(parameter, -0.3 * unit, 10.0 * unit, 0.05 * unit);
    w.probe({0.05 * unit}).probe({-0.05 * unit});
}

/// Candidates for the bodies of a free scene. Relevant amplitudes are a hundredth of the torque of the weight.
void bodies(CandidateBuilder& w, const replay::FreeScales& s, const Experiment& e, const ExperimentScales& all) {
    const double torque = 0.01 * s.torque, viscous = torque / s.spin;
    if (s.turns)
        bearings(w, torque, viscous, s.length);
    if (s.slides)
        guides(w, 0.01 * s.force, 0.01 * s.force / (s.way * s.spin), s.way * s.spin);
    if (s.springs)
        cubic(w, "", "cubic_1_m2", s.way);
    if (s.turningSprings)
        cubic(w, "turning", "cubic_1_rad2", s.twist);
    if (s.shaped)
        air(w, s, viscous);
    if (e.scene->rubs)
        frictionLaws(w, all, false);
    if (e.scene->driven)
        backlashOfReversals(w, all);
    if (e.gravity.x != 0.0 || e.gravity.y != 0.0)
        tiltedGravity(w, all, e);
    else
        gravity(w, all, 0.5, 0.3);
    if (e.scene->observation.of == scene::Observation::Of::Machine)
        return sensors(w, all);
    w.variant("sensor_gain").amplitude("error", -0.6, 1.5, 0.03).probe({0.03});
    delay(w, all.second, 0.01);
}

} // namespace

Result<effects::Setting> settingAt(const EffectMapping& mapping, const CandidateEffect& candidate,
                                   const std::vector<double>& values) {
    std::vector<double> physical;
    for (std::size_t i = 0; i < values.size(); ++i)
        physical.push_back(toPhysical(candidate.parameters[i].scale, values[i]));
    if (mapping.make)
        return mapping.make(physical);
    effects::Setting setting = mapping.base;
    for (std::size_t i = 0; i < physical.size(); ++i)
        setting.values[mapping.parameterAt[i]] = physical[i];
    return setting;
}

CandidateEffects candidateEffectsFor(const Experiment& e, const std::vector<std::string>& without, double largestBend) {
    CandidateEffects candidateEffects;
    ExperimentScales s = scalesOf(e);
    s.bend = largestBend;
    std::vector<std::string> shells = {"all"};
    if (e.specimens.size() > 1) {
        shells.clear();
        for (const experiment::Specimen& specimen : e.specimens)
            shells.push_back(specimen.id);
    }
    CandidateBuilder w(candidateEffects, e, without);
    if (experiment::isMechanism(e)) {
        bodies(w, replay::freeScales(e), e, s);
        furtherSensors(w, s, e);
        return candidateEffects;
    }
    material(w, s);
    localEffects(w, s, shells);
    airOfShells(w, s, e);
    contacts(w, s);
    apparatus(w, s);
    furtherSensors(w, s, e);
    addLearnedLaws(candidateEffects, e, s);
    return candidateEffects;
}

} // namespace supercircle::diagnosis
