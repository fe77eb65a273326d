#pragma once
// The fit of the nominal parameters alone, inside what is stated: what is left by it is what a diagnosis asks about.
//
// A search stays on its branch: a strip that jumps to the other side than the recorded one does so wherever the search
// goes from there, and an effect of no size that opened the other branch explained everything. Where the misfit is far
// off, points all over the box are simulated coarsely, and those nearest to the recordings are starts as well. So they
// are where something stands out of the noise by little (searchOn): bent valleys let searches end three to twenty
// squares above the best point, and 13 are an alarm. Where a search ended at the edge of its branch the box is looked
// through however much stands out: behind a narrow passage of (curvature, friction) a control's misfit was 160 squares
// lower (47 of seed 2039), and a step along either number alone leads off the branch.

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/fit.h"

#include <functional>
#include <memory>
#include <string>

namespace supercircle::diagnosis {

struct Nominal {
    std::string failure;            ///< why there is none; empty, too, where the evaluator was stopped
    std::unique_ptr<Misfit> misfit; ///< rows are weighed by what the simulation looks like where it fits
    Fitted fit;                     ///< with derivatives of its own place
};

using Stage = std::function<void(double, const std::string&)>;

/// @param stage told how far the diagnosis is, 0.02 to 0.2
Nominal fitNominal(const Data& data, Evaluator& evaluator, const Noise& noise, const Settings& settings,
                   const Stage& stage);

/// Looks for a lower misfit than that of a fit which was found, from the other side and from all over; whether there
/// was one.
bool searchOn(Evaluator& evaluator, const Settings& settings, const Misfit& misfit, Fitted& found);

/// The same, from nominal numbers that something else came upon.
bool searchFrom(Evaluator& evaluator, const Misfit& misfit, const Point& start, Fitted& found);

} // namespace supercircle::diagnosis
