#pragma once
// Test whether single runs agree on the nominal parameters. A bending modulus that depends on speed is missing physics.

#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/result.h"

namespace supercircle::diagnosis {

/// Decrease of chi-squared if every run has parameters of its own (linearised, without bounds). With common parameters
/// it is chi-squared distributed with (runs - 1) x (identifiable directions) degrees of freedom.
/// Names the parameter that explains most of it with a value of its own in every run.
/// Source: Cochran's Q of meta-analysis (W. G. Cochran, Biometrics 10 (1954) 101), in several dimensions.
Homogeneity homogeneityOf(const Model& model, const Likelihood& likelihood, const FitResult& fitted);

} // namespace supercircle::diagnosis
