#pragma once
// Do single runs ask for the same nominal parameters? A bending modulus that depends on the speed is missing physics.

#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/result.h"

namespace supercircle::diagnosis {

/// The gain of misfit from giving every run parameters of its own (linearised, not bounded), which is chi^2 with
/// (runs - 1) x (identifiable directions) degrees of freedom if one set serves all. Cochran's Q of meta-analysis
/// (W. G. Cochran, Biometrics 10 (1954) 101) in several dimensions.
Homogeneity homogeneityOf(const Misfit& misfit, const Fitted& fitted);

} // namespace supercircle::diagnosis
