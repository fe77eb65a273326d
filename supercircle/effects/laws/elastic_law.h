#pragma once
// Elastic moment over curvature change u, divided by B.

#include "supercircle/effects/model.h"

namespace supercircle::effects {

struct ElasticResponse {
    double value = 0.0;  ///< g, 1/m
    double slope = 1.0;  ///< dg/du, 1
    double energy = 0.0; ///< integral of g du, 1/m^2
};

/// Softening: u / sqrt(1 + (u/uc)^2). Stiffening: u (1 + (u/uc)^2). Ramberg-Osgood (Ramberg and Osgood 1943), in
/// inverse form: u = g + uc (g/uc)^n. Learned: dg/du = 1 + S(|u|/uc), S a spline.
ElasticResponse evaluate(const ElasticModel& model, double u);

} // namespace supercircle::effects
