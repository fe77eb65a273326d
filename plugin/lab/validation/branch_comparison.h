#pragma once
// A specimen pushed and pulled back, compared with solved loading and unloading branches.

#include "plugin/lab/validation/simulation.h"

namespace supercircle::validation {

/// Opening angle over 2 pi and friction coefficient of a solved curve.
struct CurveParameters {
    double phiBar = 0.0, mu = 0.0;
};

/// "Φ/2π = 0.75, μ = 0.20"
std::string labelOf(const CurveParameters& p);

/// Indentations over R between which branches are compared: both from `from`, loading up to `to`, unloading up to
/// `back` (friction reverses first). The sudden start and turn of the crosshead lie outside.
struct ComparedRange {
    double from = 0.0, to = 0.0, back = 0.0;
};

/// Forces over B / R^2 against indentation over R.
struct SolvedBranches {
    ForceCurve loading, unloading;
};

/// Reads PREFIX_load_PhiP_muM.csv and PREFIX_pull_..., PREFIX being "T2" (cylinder) or "T3" (two shells).
SolvedBranches readSolvedBranches(const ValidationSettings& settings, const char* prefix, const CurveParameters& p);

/// Differences relative to the solved peak (loading) and pull-off force (unloading).
struct BranchErrors {
    double loading = 0.0, unloading = 0.0; ///< largest ones along the branches
    double peak = 0.0, pullOff = 0.0;      ///< of the extremes, signed
};
BranchErrors branchErrors(const MeasuredCurves& measured, const SolvedBranches& solved, const ComparedRange& span);

/// Four checks of one curve: 1 % of the peak and 2 % of the pull-off. `reason` says where the target of loading comes
/// from.
void addBranchChecks(ValidationExperiment& e, const CurveParameters& p, const BranchErrors& errors,
                     const std::string& reason);

/// Both branches of all runs of one opening angle, measured points on solved lines.
Diagram branchDiagram(const ValidationSettings& settings, const char* prefix, double phiBar, const ComparedRange& span,
                      const std::vector<std::pair<CurveParameters, MeasuredCurves>>& runs);

} // namespace supercircle::validation
