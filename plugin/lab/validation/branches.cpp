#include "plugin/lab/validation/branches.h"

namespace supercircle::validation {

std::string nameOf(const Pair& p) {
    return text("Φ/2π = %.2f, μ = %.2f", p.phiBar, p.mu);
}

Branches solvedBranches(const Settings& settings, const char* experiment, const Pair& p) {
    const auto read = [&](const char* branch) {
        return reference(settings, text("%s_%s_Phi%.2f_mu%.2f.csv", experiment, branch, p.phiBar, p.mu));
    };
    return {read("load"), read("pull")};
}

BranchErrors branchErrors(const Legs& measured, const Branches& solved, const Span& span) {
    return {worstDifference(measured.load, solved.load, span.from, span.to) / solved.load.top(),
            worstDifference(measured.pull, solved.pull, span.from, span.back) / -solved.pull.bottom(),
            topBetween(measured.load, span.from, span.to) / solved.load.top() - 1.0,
            bottomBetween(measured.pull, span.from, span.back) / solved.pull.bottom() - 1.0};
}

void addBranchChecks(Experiment& e, const Pair& p, const BranchErrors& errors, const std::string& why) {
    const std::string name = nameOf(p) + ": ";
    e.checks.push_back(
        {name + "pushing, largest difference of the force", errors.load, 0.0, errors.load, "peak", 0.01, why, false});
    e.checks.push_back({name + "peak", 1.0 + errors.peak, 1.0, errors.peak, "peak", 0.01, "as above", false});
    e.checks.push_back({name + "pulling, largest difference of the force", errors.pull, 0.0, errors.pull, "pull-off",
                        0.02, "as pushing, and the turn of the friction at the reversal", false});
    e.checks.push_back(
        {name + "pull-off", 1.0 + errors.pullOff, 1.0, errors.pullOff, "pull-off", 0.02, "as pulling", false});
}

Panel branchPanel(const Settings& settings, const char* experiment, double phiBar, const Span& span,
                  const std::vector<std::pair<Pair, Legs>>& runs) {
    Panel panel{text("Φ/2π = %.2f (upper branch: pushing, lower: pulling)", phiBar),
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
        const Branches solved = solvedBranches(settings, experiment, p);
        panel.lines.push_back(solid(solved.load, text("μ = %.2f", p.mu), colour));
        panel.lines.push_back(solid(solved.pull, "", colour));
        panel.lines.push_back(markers(run.load, span.from, span.to, 25, "", colour));
        panel.lines.push_back(markers(run.pull, span.from, span.back, 25, "", colour));
        ++colour;
    }
    return panel;
}

} // namespace supercircle::validation
