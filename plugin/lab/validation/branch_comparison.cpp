#include "plugin/lab/validation/branch_comparison.h"

namespace supercircle::validation {

std::string labelOf(const CurveParameters& p) {
    return text("Φ/2π = %.2f, μ = %.2f", p.phiBar, p.mu);
}

SolvedBranches readSolvedBranches(const ValidationSettings& settings, const char* prefix, const CurveParameters& p) {
    const auto read = [&](const char* branch) {
        return reference(settings, text("%s_%s_Phi%.2f_mu%.2f.csv", prefix, branch, p.phiBar, p.mu));
    };
    return {read("load"), read("pull")};
}

BranchErrors branchErrors(const MeasuredCurves& measured, const SolvedBranches& solved, const ComparedRange& span) {
    return {worstDifference(measured.loading, solved.loading, span.from, span.to) / solved.loading.top(),
            worstDifference(measured.unloading, solved.unloading, span.from, span.back) / -solved.unloading.bottom(),
            topBetween(measured.loading, span.from, span.to) / solved.loading.top() - 1.0,
            bottomBetween(measured.unloading, span.from, span.back) / solved.unloading.bottom() - 1.0};
}

void addBranchChecks(ValidationExperiment& e, const CurveParameters& p, const BranchErrors& errors,
                     const std::string& reason) {
    const std::string name = labelOf(p) + ": ";
    e.checks.push_back({name + "pushing, largest difference of the force", errors.loading, 0.0, errors.loading, "peak",
                        0.01, reason, false});
    e.checks.push_back({name + "peak", 1.0 + errors.peak, 1.0, errors.peak, "peak", 0.01, "as above", false});
    e.checks.push_back({name + "pulling, largest difference of the force", errors.unloading, 0.0, errors.unloading,
                        "pull-off", 0.02, "as pushing, and the reversal of friction", false});
    e.checks.push_back(
        {name + "pull-off", 1.0 + errors.pullOff, 1.0, errors.pullOff, "pull-off", 0.02, "as pulling", false});
}

Diagram branchDiagram(const ValidationSettings& settings, const char* prefix, double phiBar, const ComparedRange& span,
                      const std::vector<std::pair<CurveParameters, MeasuredCurves>>& runs) {
    Diagram diagram{text("Φ/2π = %.2f (upper branch: pushing, lower: pulling)", phiBar),
                    "indentation / R",
                    "force / (B/R²)",
                    false,
                    false,
                    {},
                    {}};
    int colour = 0;
    for (const auto& [p, run] : runs) {
        if (p.phiBar != phiBar)
            continue;
        const SolvedBranches solved = readSolvedBranches(settings, prefix, p);
        diagram.lines.push_back(solid(solved.loading, text("μ = %.2f", p.mu), colour));
        diagram.lines.push_back(solid(solved.unloading, "", colour));
        diagram.lines.push_back(markers(run.loading, span.from, span.to, 25, "", colour));
        diagram.lines.push_back(markers(run.unloading, span.from, span.back, 25, "", colour));
        ++colour;
    }
    return diagram;
}

} // namespace supercircle::validation
