#pragma once
// Fits of an effect from its probes, and of the other variants of its law where the chosen one leaves a residual. The
// screening is linear, so it ranks variants of a strong effect badly (decision 0082).

#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/fitted_hypothesis.h"

#include <optional>
#include <set>
#include <vector>

namespace supercircle::diagnosis {

/// Probes of one label, largest gain first.
using RankedProbes = std::vector<const ScreenedProbe*>;

/// Probes with a gain above `least`, by label, the label with the best one first.
std::vector<RankedProbes> byLabel(const Model& model, const std::vector<ScreenedProbe>& screened, double least);

/// Fits a candidate beside the effects of `base`, from one of its probes.
/// @param competitor chi-squared of a competing fit (FitSettings)
FittedHypothesis fitProbe(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& base,
                          const ScreenedProbe& probe, double competitor);

/// The best fit of a label beside the effects of `base`, compared by Akaike's criterion: its two best variants from
/// their best probes, or one variant from its two best. Where bodies alone move freely, all variants. Nothing if none
/// can be simulated.
/// @param least chi-squared of the best competing fit so far, updated; 0: none yet
/// @param fitted receives the candidates
[[nodiscard]] std::optional<FittedHypothesis> fitLabel(Evaluator& evaluator, const Likelihood& likelihood,
                                                       const FitResult& base, const RankedProbes& probes, double& least,
                                                       std::set<std::size_t>& fitted);

/// Refits a hypothesis from the stated nominal values; nothing if that is not better. A fit with one of two effects
/// pushes nominal parameters into corners that a search cannot leave (decision 0082).
[[nodiscard]] std::optional<FittedHypothesis> refitFromStated(Evaluator& evaluator, const Likelihood& likelihood,
                                                              const FittedHypothesis& known);

/// Fits every variant of the label of `known` that is not among `fitted`, from its best probe. Returns the best one if
/// it is better than `known`. `fitted` receives the candidates.
[[nodiscard]] std::optional<FittedHypothesis>
betterVariant(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& base,
              const std::vector<ScreenedProbe>& screened, const FittedHypothesis& known, std::set<std::size_t>& fitted);

} // namespace supercircle::diagnosis
