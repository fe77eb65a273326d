#pragma once
// A specimen pushed and pulled back against the two solved branches of T2 and T3.

#include "plugin/lab/validation/play.h"

namespace supercircle::validation {

/// Opening angle over 2 pi and friction coefficient of a solved curve.
struct Pair {
    double phiBar = 0.0, mu = 0.0;
};

/// "Φ/2π = 0.75, μ = 0.20"
std::string nameOf(const Pair& p);

/// Indentations over R between which branches are compared: both from `from`, pushing up to `to`, pulling up to `back`
/// (friction has to turn round first). The machine's sudden start and turn lie outside.
struct Span {
    double from = 0.0, to = 0.0, back = 0.0;
};

/// The solved branches of a pair: forces over B / R^2 against indentation over R.
struct Branches {
    Curve load, pull;
};

/// Reads EXPERIMENT_load_PhiP_muM.csv and EXPERIMENT_pull_..., EXPERIMENT being "T2" or "T3".
Branches solvedBranches(const Settings& settings, const char* experiment, const Pair& p);

/// Differences relative to the solved peak (pushing) and pull-off force (pulling).
struct BranchErrors {
    double load = 0.0, pull = 0.0;    ///< largest ones along the branches
    double peak = 0.0, pullOff = 0.0; ///< of the extremes, signed
};
BranchErrors branchErrors(const Legs& measured, const Branches& solved, const Span& span);

/// Four checks of a pair: 1 % of the peak and 2 % of the pull-off. `why` says where the pushing target comes from.
void addBranchChecks(Experiment& e, const Pair& p, const BranchErrors& errors, const std::string& why);

/// Both branches of all runs of one opening angle, measured points on solved lines.
Panel branchPanel(const Settings& settings, const char* experiment, double phiBar, const Span& span,
                  const std::vector<std::pair<Pair, Legs>>& runs);

} // namespace supercircle::validation
