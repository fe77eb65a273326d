#pragma once
// Hidden effects: amplitudes, absent by default. Labels and parameters are those of docs/reference/effects.md.
// Their laws are written anew in this folder.

#include <map>
#include <string>
#include <vector>

namespace supercircle::reference_simulator {

/// Amplitudes and details by name; SI.
struct Effects {
    // material
    double kelvinVoigtTime = 0.0;                               ///< eta / B, s
    double branch = 0.0, branchTime = 1.0;                      ///< Maxwell branch over B; s
    double softeningCurvature = 0.0, stiffeningCurvature = 0.0; ///< curvature change at the knee, 1/m; 0: linear
    double yield = 0.0, hardening = 0.3;                        ///< M_y / B, 1/m; 0: never; H / B
    double kinematic = 0.0;                                     ///< 1: the yield range moves instead of widening
    double damage = 0.0, damageCurvature = 0.0;                 ///< share of B lost; change of natural curvature, 1/m
    double damageArcFraction = 0.5, damageStandardDeviation = 2e-3; ///< arc fraction; standard deviation, m
    double defect = 0.0; ///< change of natural curvature over a part of the length, 1/m
    double defectArcFraction = 0.5, defectLength = 0.01;
    double gradient = 0.0, gradientLaw = 0.0;     ///< law 0: of the thickness, 1: of the modulus
    double softening = 0.0, softeningTime = 20.0; ///< share of B lost with time
    double softeningIsLogarithmic = 0.0;          ///< 1: per decade of time
    double specimen = -1.0;                       ///< index of the specimen with the material's effect; -1: all
    // load
    double drag = 0.0, preslidingDistance = 3e-6; ///< N/m; m
    double gravityX = 0.0, gravityY = 0.0;
    // contact
    double staticRatio = 1.0, slipLength = 1e-4, healTime = 3.0;
    double rate = 0.0, rateSpeed = 1e-3, rateLaw = 0.0; ///< law 0: Stribeck, 1: logarithmic, 2: viscous
    double wear = 0.0, wearLength = 0.05;
    double adhesion = 0.0, adhesionRange = 1e-4; ///< N/m; m
    double normalCompliance = 0.0, tangentialCompliance = 0.0;
    double frictionVariation = 0.0; ///< friction varies along obstacles by this share (in no catalogue)
    double frictionWavelength = 2e-3;
    // apparatus
    double machineStiffness = 0.0; ///< stiffness, N/m; 0: rigid
    double backlash = 0.0;
    double offset = 0.0, tilt = 0.0;
    // sensor
    double drift = 0.0, driftTime = 20.0, driftRate = 0.0;
    double gain = 0.0;
    double delay = 0.0, lag = 0.0;
    double disturbance = 0.0, disturbancePeriod = 5.0; ///< N, s: a slow periodic disturbance (in no catalogue)
};

/// Effects of a specimen that is mounted end for end.
Effects reversed(Effects effects);

/// A hidden effect: label and parameters of docs/reference/effects.md.
struct HiddenEffect {
    std::string label;
    std::map<std::string, double> parameters;
};

/// Adds an effect. Throws std::invalid_argument for an unknown parameter.
void apply(Effects& effects, const HiddenEffect& hidden);

} // namespace supercircle::reference_simulator
