#pragma once
// Other local minima of a fitted effect. The objective is multimodal in the position: force alone hardly distinguishes
// the two halves of an arch. The fit is restarted from its mirror image and from the best probes at other positions.
// Minima below the 90 % level widen the intervals; a lower one replaces the fit.
//
// Force alone does not resolve the sign of an effect across a symmetric set-up (offset, tilt, gradient, lateral
// gravity). Such a fit is restarted with the opposite sign (decision 0085).

#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/screening/screen.h"

#include <Eigen/Core>
#include <vector>

namespace supercircle::diagnosis {

/// Fits of the same single effect at other positions, or with opposite sign where it has no position, whatever their
/// chi-squared.
/// @param without chi-squared of the fit without the effect
std::vector<FitResult> otherLocalMinima(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& fitted,
                                        const std::vector<ScreenedProbe>& screened, double without);

/// Widens 90 % intervals by other minima below their level. Marks amplitudes whose sign is ambiguous
/// (Interval::signAmbiguous): nonzero with either sign.
/// @param dispersions of each of x (sandwich.h)
/// @return the best mirror image found, or null
const FitResult* widenByLocalMinima(const std::vector<FitResult>& minima, const Model& model, const FitResult& fitted,
                                    const Eigen::VectorXd& dispersions, std::vector<Interval>& intervals);

} // namespace supercircle::diagnosis
