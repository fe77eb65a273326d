#pragma once
// Learning a law: the closures of closures.h fitted, smoothed, and put into words.

#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/selection/tried.h"

namespace supercircle::diagnosis {

/// Fits the `most` learned laws that promise most at first sight. Roughness is chosen by a Fellner-Schall step.
std::vector<Tried> learn(Evaluator& evaluator, const Misfit& misfit, const Fitted& nominal, std::size_t most);

/// The law with its uncertainty where the runs have been, and in words. Elsewhere it is refused: there the posterior
/// deviation is more than half of the prior's.
LearnedLaw describe(const Model& model, const Misfit& misfit, const Tried& tried);

} // namespace supercircle::diagnosis
