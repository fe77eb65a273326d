#pragma once
// Fits turned into what a report shows.

#include "plugin/identification/diagnosis/estimation/profile.h"
#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/selection/tried.h"

#include <vector>

namespace supercircle::diagnosis {

/// One effect of a hypothesis (its term `shown`): fitted values with 90 % intervals, errors. Probability, gain and
/// group are the caller's.
/// @param spread of the numbers of all its terms
FoundEffect presentEffect(const Model& model, const Misfit& misfit, const Grouping& grouping, const Tried& tried,
                          std::size_t shown, const Spread& spread);

/// Stated and fitted nominal parameters.
std::vector<NominalResult> presentNominal(const Model& model, const Fitted& nominal);

/// Cosines between what fits change against the nominal one.
std::vector<std::vector<double>> presentSimilarity(const Misfit& misfit, const Fitted& nominal,
                                                   const std::vector<const Fitted*>& fits);

/// @param best may be null. It shows where it moves the reading away from the nominal fit by more than 0.7 noise units
/// in the mean of a quarter of a second, which is what an eye would mark; gaps of 0.3 s are closed.
std::vector<RunCurves> presentCurves(const Misfit& misfit, const Fitted& nominal, const Fitted* best);

/// Where an effect shows whose trace stands out of the noise while no window does by itself.
std::vector<Window> windowsOfEffect(const Data& data, const std::vector<RunCurves>& curves, const Localisation& found);

} // namespace supercircle::diagnosis
