#pragma once
// Physics that the second simulator can hide: amplitudes of every effect, all absent by default. The meanings of labels
// and parameters are those of docs/effects.md; how each acts is written anew in this folder.

#include <map>
#include <string>
#include <vector>

namespace supercircle::oracle {

/// Amplitudes and details by name; SI.
struct Effects {
    // material
    double kelvinTime = 0.0;                      ///< eta / B, s
    double branch = 0.0, branchTime = 1.0;        ///< Maxwell branch over B; s
    double softKnee = 0.0, stiffKnee = 0.0;       ///< curvature change at the knee, 1/m; 0: linear
    double yield = 0.0, hardening = 0.3;          ///< M_y / B, 1/m; 0: never; H / B
    double kinematic = 0.0;                       ///< 1: the yield range moves instead of widening
    double damage = 0.0, damageCurvature = 0.0;   ///< share of B lost; change of natural curvature, 1/m
    double damagePlace = 0.5, damageWidth = 2e-3; ///< arc fraction; standard deviation, m
    double defect = 0.0;                          ///< change of natural curvature on a stretch, 1/m
    double defectPlace = 0.5, defectLength = 0.01;
    double gradient = 0.0, gradientLaw = 0.0; ///< law 0: of the thickness, 1: of the modulus
    double drop = 0.0, dropTime = 20.0;       ///< share of B lost with time
    double dropLogarithmic = 0.0;             ///< 1: per decade of time
    double specimen = -1.0;                   ///< index of the specimen with the material's effect; -1: all
    // load
    double drag = 0.0, presliding = 3e-6; ///< N/m; m
    double gravityX = 0.0, gravityY = 0.0;
    // contact
    double staticRatio = 1.0, slipLength = 1e-4, healTime = 3.0;
    double rate = 0.0, rateSpeed = 1e-3, rateLaw = 0.0; ///< law 0: Stribeck, 1: logarithmic, 2: viscous
    double wear = 0.0, wearLength = 0.05;
    double adhesion = 0.0, adhesionRange = 1e-4; ///< N/m; m
    double normalGive = 0.0, tangentialGive = 0.0;
    double roughness = 0.0; ///< friction varies along obstacles by this share (in no catalogue)
    double roughLength = 2e-3;
    // apparatus
    double machine = 0.0; ///< stiffness, N/m; 0: rigid
    double play = 0.0;
    double offset = 0.0, tilt = 0.0;
    // sensor
    double drift = 0.0, driftTime = 20.0, driftRate = 0.0;
    double gain = 0.0;
    double delay = 0.0, lag = 0.0;
    double hum = 0.0, humPeriod = 5.0; ///< N, s: a slow periodic disturbance (in no catalogue)
};

/// What sits in a specimen, seen from its other end.
Effects turnedEndForEnd(Effects effects);

/// One hidden effect: label and parameters as in docs/effects.md.
struct Hidden {
    std::string label;
    std::map<std::string, double> parameters;
};

/// Switches an effect on. Throws std::invalid_argument for a name that is not known.
void apply(Effects& effects, const Hidden& hidden);

} // namespace supercircle::oracle
