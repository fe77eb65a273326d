#pragma once
// Which hypotheses are fitted: the effects that promise most at first sight, other forms of their laws, pairs, and
// laws that are learned. Each step is taken only where the one before it left something (docs/diagnosis.md).

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/tried.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// What a search starts from; all of it outlives the search.
struct Ground {
    const Data& data;
    Evaluator& evaluator;
    const Settings& settings;
    const Misfit& misfit;
    const Grouping& grouping;
    const Fitted& base; ///< nominal fit
    const HeldOut& baseHeld;
    const std::vector<Screened>& screened;
    double p = 1.0;            ///< family-wise, of the nominal fit's misfit
    double tails = 0.0;        ///< excess kurtosis of the noise
    double noiseSquares = 1.0; ///< that it may have per row (mostSquares())
};

/// How a fit foretells what it has not seen, as the settings want it.
HeldOut heldOutOf(Evaluator& evaluator, const Misfit& misfit, const Grouping& grouping, const Fitted& fitted,
                  const Settings& settings);

/// Where and how surely a fit leaves something.
Localisation leftBy(const Model& model, const Misfit& misfit, const Fitted& fitted, const Settings& settings);

struct Searched {
    std::vector<Tried> tried; ///< singles best first, then pairs, then learned laws; `parts` index into it
    Localisation left;        ///< by the first; meaningless without any
    /// Nominal numbers with a lower misfit than the base's, which fits of effects that change no reading came upon.
    std::optional<Point> elsewhere{};
    double least = 0.0; ///< misfit there
};

/// Stops early, with what it has, when the evaluator is stopped.
/// @param stage told what is done, with the share of the whole diagnosis that is behind
Searched search(const Ground& ground, const std::function<void(double, const std::string&)>& stage);

} // namespace supercircle::diagnosis
