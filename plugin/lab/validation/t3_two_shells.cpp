// T3: two identical shells, cap on cap, both clamped at their crowns.
//
// Thickness is felt more here than on the cylinder, whose radius is made smaller by half of it: the upper shell sits on
// a circle of R + h. The curves move in proportion to h / R by up to 40 times that (3.8 % of the peak at 20 um for
// phi_bar 0.65 without friction), so the comparison with a reference of zero thickness is made by linear extrapolation
// from 20 and 40 um.

#include "plugin/lab/validation/branches.h"
#include "plugin/lab/validation/experiments.h"
#include "plugin/lab/validation/reference.h"

#include <cmath>

namespace supercircle::validation {

namespace {

constexpr double kThin = 2e-5;

Case press(const Pair& p, double thickness, int elements, double fixedDt = 0.0) {
    Case c{"two_shells", thin(thickness), fixedDt};
    c.parameters.insert(c.parameters.end(),
                        {{"phi_bar", p.phiBar}, {"mu", p.mu}, {"elements", static_cast<double>(elements)}});
    return c;
}

Span spanOf(double phiBar) {
    const double seated = -2.0 * std::cos(M_PI * phiBar);
    return {0.02 * seated, 0.92 * seated, 0.86 * seated};
}

BranchErrors errorsOf(const Settings& settings, const Pair& p, const Legs& measured) {
    return branchErrors(measured, solvedBranches(settings, "T3", p), spanOf(p.phiBar));
}

/// Curves at vanishing thickness.
Legs pressed(const Settings& settings, Experiment& e, const Pair& p, int elements, double fixedDt = 0.0) {
    const Legs thin = legs(settings, e, press(p, kThin, elements, fixedDt));
    const Legs twice = legs(settings, e, press(p, 2.0 * kThin, elements, fixedDt));
    const auto [from, to, back] = spanOf(p.phiBar);
    Legs out;
    out.load = atZeroThickness(thin.load, twice.load, from, to);
    out.pull = atZeroThickness(thin.pull, twice.pull, from, back);
    return out;
}

Case push(const Pair& p, int elements, double travel, double thickness = kThin) {
    Case c = press(p, thickness, elements);
    c.parameters.push_back({"travel_over_R", travel});
    c.loadingOnly = true;
    return c;
}

Case roll(double mu, int elements, double d) {
    Case c = push({0.90, mu}, elements, d + 0.04);
    // The solved lower shell never closes on itself. A deep one does, and the pair then holds 7 % more at mu = 0.4.
    // Only its top is loaded, so a shallower one with arcs of the same length is the same specimen without that
    // contact.
    c.parameters.insert(c.parameters.end(),
                        {{"phi_bar_lower", 0.6}, {"elements_lower", std::round(elements * 2.0 / 3.0)}});
    return c;
}

void stuck(const Settings& settings, Experiment& e) {
    const Curve wanted = reference(settings, "T3_typeII_pinned_Phi0.86.csv", "indent_over_R", "fR2_over_B", true);
    Panel panel{"tips stuck", "indentation / R", "force / (B/R²)", false, false, {}, {}};
    const double end = wanted.d.back();
    const Case c = push({0.86, 0.8}, 31, end + 0.01);
    e.commands.push_back(c.command());
    const Curve load = legs(settings, e, c).load;
    const double error = worstDifference(load, wanted, 0.01, end) / wanted.top();
    e.checks.push_back({"Φ/2π = 0.86, μ = 0.8, tips pinned: largest difference of the force, 31 arcs, h = 20 µm", error,
                        0.0, error, "largest force", 0.03, "as on the cylinder, for two shells", false});
    panel.lines.push_back(solid(wanted, "tips pinned, Φ/2π = 0.86 (solved)", 0));
    panel.lines.push_back(markers(load, 0.01, end, 25, "", 0));
    const Table t(settings.data, "T3_typeII_unfold_threshold_coarse.csv");
    for (std::size_t i = 0; i < t.rows(); ++i) {
        const double mu = t.at(i, "mu"), force = t.at(i, "f_unfold_R2_over_B");
        const double d = 1.0 - 2.0 * std::cos(M_PI * 0.90) - t.at(i, "Ycrown_upper");
        const int colour = static_cast<int>(i) + 1;
        for (const int n : {15, 31}) {
            const Case rolling = roll(mu, n, d);
            const Curve ours = legs(settings, e, rolling).load;
            Check check = against(text("unfolding force, μ = %.1f, Φ/2π = 0.90, %d arcs, h = 20 µm", mu, n),
                                  topBeforeCollapse(ours).second, force, {}, "first order in 1/N, as on the cylinder");
            if (n == 31) {
                check.target = 0.03;
                e.commands.push_back(rolling.command());
                panel.lines.push_back(
                    markers(ours, 0.01, d - 0.005, 25, text("rolling, μ = %.1f, Φ/2π = 0.90", mu), colour));
            }
            e.checks.push_back(check);
        }
        panel.lines.push_back({text("unfolds (solved), μ = %.1f", mu),
                               {d - 0.06, d, d + 0.06},
                               {force, force, force},
                               Line::Style::Reference,
                               colour});
    }
    e.panels.push_back(panel);
    e.remarks.push_back(
        "Fixed steps beyond 4 ms are no use here: at 5 mm/s the machine then moves by more than the shells' "
        "thickness of 20 µm in one step, and the curve is wrong by tens of per cent. The adaptive step "
        "limits that motion.");
    e.remarks.push_back(
        "With a lower shell as deep as the upper one, its own two tips meet from an indentation of about "
        "1.1 R on (the solved one has no such contact) and the unfolding force rises by 1 % at μ = 0.2 "
        "and 7 % at μ = 0.4. The comparison therefore clamps a shallower lower shell of Φ/2π = 0.6.");
}

void convergence(const Settings& settings, Experiment& e) {
    const std::vector<Pair> pairs{{0.65, 0.35}, {0.75, 0.0}, {0.75, 0.35}};
    std::vector<std::string> names;
    for (const Pair& p : pairs)
        names.push_back(nameOf(p));
    e.panels.push_back(
        study("pushing: largest difference over the peak, h → 0", "arcs per shell N", {7, 15, 31}, names, 0.01,
              [&](std::size_t i, double n) {
                  return errorsOf(settings, pairs[i], pressed(settings, e, pairs[i], static_cast<int>(n))).load;
              }));
    e.panels.push_back(
        study("pushing: the same against a fixed time step, 31 arcs, 5 mm/s", "time step, ms", {2, 3, 4}, names, 0.01,
              [&](std::size_t i, double ms) {
                  return errorsOf(settings, pairs[i], pressed(settings, e, pairs[i], 31, 1e-3 * ms)).load;
              }));
    e.panels.push_back(study("pushing: the same against the thickness, 31 arcs",
                             "thickness, µm (the paper's shell: 500)", {20, 40, 100, 200, 500}, names, 0.01,
                             [&](std::size_t i, double um) {
                                 const Case c = press(pairs[i], 1e-6 * um, 31);
                                 return errorsOf(settings, pairs[i], legs(settings, e, c)).load;
                             }));
}

} // namespace

void twoShells(const Settings& settings, Experiment& e) {
    e.about =
        "The upper shell is pushed over the lower one at 5 mm/s and pulled off again. Lines: solved curves of zero "
        "thickness; points: our shells of 31 arcs, extrapolated to vanishing thickness from 20 and 40 µm (the upper "
        "shell sits on a circle of R + h, which moves the curves by up to 40 h/R: the lowest diagram).";
    std::vector<std::pair<Pair, Legs>> runs;
    for (const Pair p : {Pair{0.75, 0.35}, {0.75, 0.0}, {0.65, 0.35}, {0.65, 0.0}}) {
        runs.emplace_back(p, pressed(settings, e, p, 31));
        addBranchChecks(e, p, errorsOf(settings, p, runs.back().second),
                        "two shells of 31 arcs; the square of the thickness is left, 0.3 %");
        e.commands.push_back(press(p, kThin, 31).command());
        e.commands.push_back(press(p, 2.0 * kThin, 31).command());
        if (settings.quick)
            break;
    }
    e.panels.push_back(branchPanel(settings, "T3", 0.75, spanOf(0.75), runs));
    if (settings.quick)
        return;
    e.panels.push_back(branchPanel(settings, "T3", 0.65, spanOf(0.65), runs));
    stuck(settings, e);
    convergence(settings, e);
}

} // namespace supercircle::validation
