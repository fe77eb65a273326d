#pragma once
// What may act, as a further run would have to tell it apart.
//
// Where the runs say that something is missing these are the effects that were fitted, by their probability. Near the
// limit of detection that says little more than which effect happened to be worth a fit: there it is, besides, what
// explains nearly as much at first sight, fitted for the purpose. (A drift was the only one beside nothing; the run
// that tells these two was a run of the friction that it was, .89, for which two would have been asked.)

#include "plugin/identification/diagnosis/next.h"
#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/tried.h"

#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// A label of the report.
struct Named {
    std::string label;
    double probability = 0.0;
    const Tried* shown = nullptr; ///< the hypothesis it is shown by
    bool twin = false;            ///< in the first one's group
};

/// Four effects at most, the most probable first, behind them the mirror image of the first if these runs do not tell
/// the side, and nothing if it may be.
/// @param named most probable first
/// @param nothing its probability
std::vector<Rival> suspects(Evaluator& evaluator, const Misfit& misfit, const Fitted& base,
                            const std::vector<Named>& named, const std::vector<Screened>& screened, double nothing);

} // namespace supercircle::diagnosis
