#pragma once
// Values of the result, computed from fits.

#include "plugin/identification/diagnosis/estimation/profile.h"
#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/fitted_hypothesis.h"

#include <vector>

namespace supercircle::diagnosis {

/// One effect of a hypothesis (its term `shown`): fitted values with 90 % intervals, errors. Probability, gain and
/// confounded labels are set by the caller.
/// @param intervals of the parameters of all its terms
/// @param baselineChiSquared of the fit without effects
FittedEffect presentEffect(const Model& model, const Likelihood& likelihood, const Grouping& grouping,
                           const FittedHypothesis& hypotheses, std::size_t shown, const ParameterIntervals& intervals,
                           double baselineChiSquared);

/// The best of the probes of each label, in the order of the catalogue.
/// @param critical value of the localisation
std::vector<ScreenedEffect> presentScreening(const std::vector<CandidateEffect>& candidates,
                                             const std::vector<ScreenedProbe>& screened, double critical);

/// Stated and fitted nominal parameters.
std::vector<NominalResult> presentNominal(const Model& model, const FitResult& nominal);

/// Cosines between the changes of fits against the baseline.
std::vector<std::vector<double>> presentSimilarity(const Likelihood& likelihood, const FitResult& nominal,
                                                   const std::vector<const FitResult*>& fits);

/// Recorded minus simulated force, N; not a number in rows that do not count.
Eigen::VectorXd forceResidual(const Likelihood& likelihood, std::size_t run, const Response& simulated);

/// Errors of channels beside the first one.
std::vector<ChannelError> furtherErrorsOf(const Likelihood& likelihood, const FitResult& nominal,
                                          const FitResult* best);

/// @param best may be null. It is visible where its mean over a quarter of a second differs from the baseline by more
/// than 0.7 sigma; gaps of 0.3 s are closed.
std::vector<RunCurves> presentCurves(const Likelihood& likelihood, const FitResult& nominal, const FitResult* best);

/// Sets the band that simulations with the stated intervals fill: the stated simulation, and beside it the sum of what
/// each parameter changes up to the end of its interval, linearly. Intervals of normal priors are those of 90 %. Driven
/// runs only: of a swing, phases are not linear. Throws Stopped.
void addStatedBand(Evaluator& evaluator, const Likelihood& likelihood, std::vector<RunCurves>& curves);

/// Windows of an effect whose signature is significant while no window is.
std::vector<ResidualWindow> windowsOfEffect(const RecordedData& data, const std::vector<RunCurves>& curves,
                                            const Localisation& found);

} // namespace supercircle::diagnosis
