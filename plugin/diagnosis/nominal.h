#pragma once
// The fit of the nominal parameters alone, inside what is stated: what is left by it is what a diagnosis asks about.
//
// A search stays on its branch: a strip that jumps to the other side than the recorded one does so wherever the search
// goes from there, and an effect of no size that opened the other branch explained everything. Where the misfit is far
// off, points all over the box are simulated coarsely, and those nearest to the recordings are starts as well.

#include "plugin/diagnosis/diagnose.h"
#include "plugin/diagnosis/fit.h"

#include <functional>
#include <memory>
#include <string>

namespace supercircle::diagnosis {

struct Nominal {
    std::string failure;            ///< why there is none; empty, too, where the evaluator was stopped
    std::unique_ptr<Misfit> misfit; ///< rows are weighed by what the simulation looks like where it fits
    Fitted fit;                     ///< with derivatives of its own place
};

/// Name of the first run that cannot be simulated, and why; empty: all can.
std::string firstFailure(const Data& data, const std::vector<Response>& all);

/// @param stage told how far the diagnosis is, 0.02 to 0.2
Nominal fitNominal(const Data& data, Evaluator& evaluator, const Noise& noise, const Settings& settings,
                   const std::function<void(double, const std::string&)>& stage);

} // namespace supercircle::diagnosis
