#pragma once
// An effect fitted from a probe, and the other forms of an effect's law, where the one that was chosen leaves
// something.
//
// The first look at the catalogue is linear: it ranks forms by their signature at a few sizes, and a strong effect
// bends that ranking. Friction that grows with the logarithm of the speed looked most like viscous friction at first,
// which left four times the noise, and the logarithm was never fitted.

#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/tried.h"

#include <optional>
#include <set>
#include <vector>

namespace supercircle::diagnosis {

/// Of one label, the one that explains most first.
using Probes = std::vector<const Screened*>;

/// Probes that explain more than `least`, by label, the label with the best one first.
std::vector<Probes> byLabel(const Model& model, const std::vector<Screened>& screened, double least);

/// Fits a candidate beside what `base` has, from one of its probes.
/// @param rival misfit of a rival (FitSettings)
Tried fitProbe(Evaluator& evaluator, const Misfit& misfit, const Fitted& base, const Screened& probe, double rival);

/// The best fit of a label (a number more has to explain two squares) beside what `base` has: of each of its two best
/// forms from the best probe, or of one form from the two best; in free scenes of all forms. Nothing if none can be
/// simulated.
/// @param least misfit of any rival, which a better one replaces; 0: none yet
/// @param fitted takes the candidates in
std::optional<Tried> fitLabel(Evaluator& evaluator, const Misfit& misfit, const Fitted& base, const Probes& probes,
                              double& least, std::set<std::size_t>& fitted);

/// The same hypothesis fitted from the stated nominal numbers, if that ends lower. A fit without an effect, or with one
/// of two, pushes the nominal numbers into a corner of what is stated, and from there a search may not get away: a
/// drift beside friction that grows with speed ended at 9808 squares and the two of them at 3523, from the stated
/// numbers at 6381 and 1474, which is what the true numbers have.
std::optional<Tried> fromStated(Evaluator& evaluator, const Misfit& misfit, const Tried& known);

/// Fits every form of the label of `known` that is not among `fitted`, from its best probe; the best of them if its
/// misfit is smaller than that of `known`. `fitted` takes them in.
std::optional<Tried> betterForm(Evaluator& evaluator, const Misfit& misfit, const Fitted& base,
                                const std::vector<Screened>& screened, const Tried& known,
                                std::set<std::size_t>& fitted);

} // namespace supercircle::diagnosis
