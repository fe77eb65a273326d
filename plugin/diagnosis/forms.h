#pragma once
// An effect fitted from a probe, and the other forms of an effect's law, where the one that was chosen leaves
// something.
//
// The first look at the catalogue is linear: it ranks forms by their signature at a few sizes, and a strong effect
// bends that ranking. Friction that grows with the logarithm of the speed looked most like viscous friction at first,
// which left four times the noise, and the logarithm was never fitted.

#include "plugin/diagnosis/screen.h"
#include "plugin/diagnosis/tried.h"

#include <optional>
#include <set>
#include <vector>

namespace supercircle::diagnosis {

/// Fits a candidate beside the nominal parameters, from one of its probes.
/// @param rival misfit of a rival (FitSettings)
Tried fitProbe(Evaluator& evaluator, const Misfit& misfit, const Fitted& base, const Screened& probe, double rival);

/// Fits every form of the label of `known` that is not among `fitted`, from its best probe; the best of them if its
/// misfit is smaller than that of `known`. `fitted` takes them in.
std::optional<Tried> betterForm(Evaluator& evaluator, const Misfit& misfit, const Fitted& base,
                                const std::vector<Screened>& screened, const Tried& known,
                                std::set<std::size_t>& fitted);

} // namespace supercircle::diagnosis
