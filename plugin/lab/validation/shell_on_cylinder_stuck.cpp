// A shell on a rigid cylinder, Type II: the tips stick, the shell coils up over them and unfolds abruptly.

#include "plugin/lab/validation/experiments.h"
#include "plugin/lab/validation/reference_table.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>

namespace supercircle::validation {

namespace {

SimulationCase onStickingCylinder(double phiBar, double mu, int elements, double travel, double fixedDt = 0.0) {
    SimulationCase c{"shell_on_cylinder", thin(kThin), fixedDt};
    c.parameters.insert(
        c.parameters.end(),
        {{"phi_bar", phiBar}, {"mu", mu}, {"elements", static_cast<double>(elements)}, {"travel_over_R", travel}});
    c.loadingOnly = true;
    return c;
}

struct Rolling {
    double mu, phiBar, force, crown; ///< f and height of the crown's centre line where the tip slips out

    [[nodiscard]] double indentation() const { return 1.0 - 2.0 * math::cos(M_PI * phiBar) - crown; }
};

std::vector<Rolling> table(const ValidationSettings& settings) {
    const ReferenceTable t(settings.data, "T2_typeII_unfold_threshold_coarse.csv");
    std::vector<Rolling> out;
    for (std::size_t i = 0; i < t.rows(); ++i) { // deep enough to stick at first contact, mu*(0.905) = 0.08
        const double mu = t.at(i, "mu");
        out.push_back({mu, mu < 0.2 ? 0.905 : 0.90, t.at(i, "f_unfold_R2_over_B"), t.at(i, "Ycrown_over_R")});
    }
    return out;
}

constexpr double kCrownTouches = 0.9995; ///< of the travel until the driven crown meets the cylinder
constexpr double kBeyond = 0.05;         ///< R, travel beyond the solved unfolding

double seated(double phiBar) {
    return -2.0 * math::cos(M_PI * phiBar);
}

struct Pinned {
    double phiBar, mu;
};

/// Indentation at which the tip is tangent to the cylinder (beyond it the shell rolls), or the crown touches.
double endOfPinning(const ValidationSettings& settings, double phiBar) {
    const ReferenceTable t(settings.data, text("T2_typeII_pinned_Phi%.2f.csv", phiBar));
    double end = 0.0;
    for (std::size_t i = 0; i < t.rows(); ++i)
        if (t.at(i, "theta_c_rad") <= M_PI + t.at(i, "psi_rad"))
            end = t.at(i, "indent_over_R");
    return std::min(end, 0.98 * seated(phiBar));
}

double differenceWhilePinned(const ForceCurve& load, const ForceCurve& wanted, double end) {
    return worstDifference(load, wanted, 0.01, end) / wanted.at(end);
}

void pinned(const ValidationSettings& settings, ValidationExperiment& e) {
    const std::vector<Pinned> cases{{0.75, 1.5}, {0.83, 0.8}, {0.95, 0.5}};
    Diagram diagram{"tips pinned", "indentation / R", "force / (B/R²)", false, false, {}, {}};
    std::vector<std::string> names;
    std::vector<ForceCurve> wanted;
    std::vector<double> ends;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const auto [phiBar, mu] = cases[i];
        wanted.push_back(
            reference(settings, text("T2_typeII_pinned_Phi%.2f.csv", phiBar), "indent_over_R", "fR2_over_B", true));
        ends.push_back(endOfPinning(settings, phiBar));
        names.push_back(text("Φ/2π = %.2f, μ = %.1f", phiBar, mu));
        const SimulationCase c = onStickingCylinder(phiBar, mu, 31, ends[i] + 0.01);
        e.commands.push_back(c.command());
        const ForceCurve load = measureCurves(settings, e, c).loading;
        diagram.lines.push_back(solid(wanted[i], names[i], static_cast<int>(i)));
        diagram.lines.push_back(markers(load, 0.01, ends[i], 30, "", static_cast<int>(i)));
        const double error = differenceWhilePinned(load, wanted[i], ends[i]);
        e.checks.push_back({names[i] + ", tips pinned: largest difference of the force, 31 arcs", error, 0.0, error,
                            "force at the end", 0.03, "third order in 1/N; the turning tip needs short arcs", false});
    }
    e.diagrams.push_back(diagram);
    if (!settings.quick)
        e.diagrams.push_back(convergenceStudy(
            "tips pinned: largest difference over the force at the end", "arcs of the shell N", {7, 15, 31, 61}, names,
            0.03, [&](std::size_t i, double n) {
                const SimulationCase c =
                    onStickingCylinder(cases[i].phiBar, cases[i].mu, static_cast<int>(n), ends[i] + 0.01);
                return differenceWhilePinned(measureCurves(settings, e, c).loading, wanted[i], ends[i]);
            }));
}

SimulationCase roll(const Rolling& r, int elements, double fixedDt = 0.0) {
    return onStickingCylinder(r.phiBar, r.mu, elements,
                              std::min(r.indentation() + kBeyond, kCrownTouches * seated(r.phiBar)), fixedDt);
}

/// Displacement and force of the unfolding. At mu = 0.5 the crown touches 0.35 % of R beyond the solved unfolding, and
/// the force falls by less than collapseLoad() asks for: half a per cent counts there.
std::pair<double, double> unfolding(const ForceCurve& load, const Rolling& r) {
    constexpr double kFalls = 0.005;
    const std::pair<double, double> found = collapseLoad(load);
    const bool crownEndsIt = r.indentation() + kBeyond > kCrownTouches * seated(r.phiBar);
    if (!std::isnan(found.second) || !crownEndsIt || load.f.empty())
        return found;
    const auto top = std::max_element(load.f.begin(), load.f.end());
    if (load.f.back() > (1.0 - kFalls) * *top)
        return found;
    return {load.d[static_cast<std::size_t>(top - load.f.begin())], *top};
}

/// Force over height of the crown, where all opening angles share one curve.
Diagram rolling(const std::vector<Rolling>& cases, const std::vector<ForceCurve>& loads) {
    Diagram diagram{"tips rolling on the cylinder until they slip",
                    "height of the crown over the cylinder's top / R",
                    "force / (B/R²)",
                    false,
                    false,
                    {},
                    {}};
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const int colour = static_cast<int>(i);
        PlotLine simulated{text("μ = %.1f, Φ/2π = %.3g, 31 arcs", cases[i].mu, cases[i].phiBar),
                           {},
                           {},
                           PlotLine::Style::Reference,
                           colour};
        const double collapse = unfolding(loads[i], cases[i]).first;
        for (std::size_t k = 0; k < loads[i].d.size() && loads[i].d[k] < collapse + 0.02; ++k)
            if (loads[i].f[k] < 1.1 * cases[i].force && loads[i].f[k] > -1.0) { // without the spikes after the collapse
                simulated.x.push_back(-2.0 * math::cos(M_PI * cases[i].phiBar) - loads[i].d[k]);
                simulated.y.push_back(loads[i].f[k]);
            }
        diagram.lines.push_back(simulated);
        diagram.lines.push_back({"", {cases[i].crown - 1.0}, {cases[i].force}, PlotLine::Style::Points, colour});
    }
    return diagram;
}

} // namespace

void shellOnCylinderStuck(const ValidationSettings& settings, ValidationExperiment& e) {
    e.about = "Beyond μ* the tips stick (Type II): the shell turns over its pinned tips, lies down on the cylinder and "
              "rolls, until the friction at the contact reaches μ and it unfolds abruptly. The rolling branch does not "
              "depend on Φ. Solved: the branch with pinned tips, and the force at which the contact slips for three μ "
              "(large points). Simulated: 20 µm thick, 5 mm/s. The unfolding force is the maximum before the force "
              "first falls "
              "by 2 %; the following spikes of twice that size are dynamics.";
    pinned(settings, e);
    const std::vector<Rolling> cases = table(settings);
    std::vector<ForceCurve> loads;
    std::vector<std::string> names;
    for (const Rolling& r : cases) {
        names.push_back(text("μ = %.1f", r.mu));
        e.commands.push_back(roll(r, 31).command());
        if (settings.quick && r.mu > 0.2)
            break;
        loads.push_back(measureCurves(settings, e, roll(r, 31)).loading);
        e.checks.push_back(checkAgainst(text("unfolding force, μ = %.1f, Φ/2π = %.3g, 31 arcs", r.mu, r.phiBar),
                                        unfolding(loads.back(), r).second, r.force, 0.03,
                                        "the contact rolls from arc to arc, first order in 1/N"));
    }
    if (settings.quick)
        return;
    e.diagrams.push_back(rolling(cases, loads));
    e.diagrams.push_back(convergenceStudy(
        "unfolding force", "arcs of the shell N", {7, 15, 31, 45}, names, 0.03, [&](std::size_t i, double n) {
            const ForceCurve load = measureCurves(settings, e, roll(cases[i], static_cast<int>(n))).loading;
            return unfolding(load, cases[i]).second / cases[i].force - 1.0;
        }));
    names.pop_back(); // at mu = 0.5 the crown touches 0.2 % of R after the unfolding: too close for large steps
    e.diagrams.push_back(convergenceStudy("unfolding force against a fixed time step, 31 arcs, 5 mm/s", "time step, ms",
                                          {2, 5, 10, 20}, names, 0.03, [&](std::size_t i, double ms) {
                                              const ForceCurve load =
                                                  measureCurves(settings, e, roll(cases[i], 31, 1e-3 * ms)).loading;
                                              return collapseLoad(load).second / cases[i].force - 1.0;
                                          }));
}

} // namespace supercircle::validation
