// Pinning: a straight strip, clamped upright, pressed lengthwise on a rough floor (experiment E6).

#include "plugin/lab/validation/experiments.h"
#include "plugin/lab/validation/reference_table.h"

#include <cmath>

namespace supercircle::validation {

namespace {

// Natural curvature times length, which selects the side of buckling. It lowers the first loads by about
// 0.002 / (curvature of the clamp). With half of it, the impact of the sudden start lets the tip slip before the strip
// bends.
constexpr double kImperfection = 0.002;

SimulationCase pinned(double mu, double travel, int elements, double fixedDt = 0.0) {
    SimulationCase c{"pinning", thin(5e-5), fixedDt};
    c.parameters.insert(c.parameters.end(), {{"mu", mu},
                                             {"travel_over_L", travel},
                                             {"speed", 1e-4},
                                             {"imperfection", kImperfection},
                                             {"elements", static_cast<double>(elements)}});
    return c;
}

/// Strain at which the force leaves the smooth branch (19 to 25 B/L^2): the tip has slipped. NaN: never.
double slipAt(const ForceCurve& load) {
    for (std::size_t i = 0; i < load.f.size(); ++i)
        if (load.d[i] > 0.01 && load.d[i] < load.d.back() - 1e-9 && (load.f[i] < 15.0 || load.f[i] > 30.0))
            return load.d[i];
    return std::nan("");
}

} // namespace

void pinning(const ValidationSettings& settings, ValidationExperiment& e) {
    e.about = "The strip (L = 100 mm, 50 µm thin) buckles at once; its tip sticks until the ratio of the forces there "
              "reaches μ, then slips. Pressed at 0.1 mm/s; 31 arcs. Beyond μ of about 0.36 the tip lies down before it "
              "slips.";
    const ForceCurve wanted = reference(settings, "T7_pinned_branch_coarse.csv", "eps", "V_L2_over_B", true);
    Diagram diagram{"force until the tip slips", "shortening / L", "force / (B/L²)", false, false, {}, {}};
    diagram.lines.push_back(solid(wanted, "tip stuck (solved)", 0));
    const ReferenceTable t(settings.data, "T7_slip_table_coarse.csv");
    std::vector<std::string> names;
    for (std::size_t i = 0; i < t.rows(); ++i) {
        const double mu = t.at(i, "mu"), slip = t.at(i, "eps_slip");
        if (settings.quick && i > 0)
            break;
        names.push_back(text("μ = %.1f", mu));
        const SimulationCase c = pinned(mu, 1.05 * slip + 0.01, 31);
        e.commands.push_back(c.command());
        const ForceCurve load = measureCurves(settings, e, c).loading;
        const double found = slipAt(load);
        PlotLine simulated = markers(load, 0.005, found - 0.001, 12, text("μ = %.1f", mu), static_cast<int>(i) + 1);
        diagram.lines.push_back(simulated);
        diagram.lines.push_back({"",
                                 {slip, slip},
                                 {wanted.at(slip) - 1.2, wanted.at(slip) + 0.3},
                                 PlotLine::Style::Dashed,
                                 static_cast<int>(i) + 1});
        e.checks.push_back(checkAgainst(text("shortening at which the tip slips, μ = %.1f, 31 arcs", mu), found, slip,
                                        0.02, "goes as μ², so 1 % of μ; the imperfection takes about 0.2 % of μ"));
    }
    if (!settings.quick) {
        const SimulationCase stuck = pinned(0.4, 0.325, 31);
        e.commands.push_back(stuck.command());
        const ForceCurve load = measureCurves(settings, e, stuck).loading;
        const bool never = std::isnan(slipAt(load));
        e.checks.push_back({"μ = 0.4: the tip does not slip before it lies flat (0 = it does not)", never ? 0.0 : 1.0,
                            0.0, never ? 0.0 : 1.0, "1", 0.5, "the ratio of the forces ends at 0.356", false});
        const double error = worstDifference(load, wanted, 0.015, 0.32) / wanted.top();
        e.checks.push_back({"μ = 0.4: largest difference of the force, 31 arcs", error, 0.0, error, "largest force",
                            0.005, "third order in 1/N", false});
        diagram.lines.push_back(markers(load, 0.01, 0.32, 25, "μ = 0.4, never slips", 4));
    }
    e.diagrams.push_back(diagram);
    if (settings.quick)
        return;
    names.pop_back(); // two friction coefficients are enough here
    e.diagrams.push_back(convergenceStudy("shortening at which the tip slips", "arcs of the strip N", {7, 15, 31},
                                          names, 0.02, [&](std::size_t i, double n) {
                                              const double mu = t.at(i, "mu"), slip = t.at(i, "eps_slip");
                                              const SimulationCase c =
                                                  pinned(mu, 1.3 * slip + 0.01, static_cast<int>(n));
                                              return slipAt(measureCurves(settings, e, c).loading) / slip - 1.0;
                                          }));
    e.diagrams.push_back(convergenceStudy("the same against a fixed time step, 31 arcs, 0.1 mm/s", "time step, ms",
                                          {5, 10, 20, 40}, names, 0.02, [&](std::size_t i, double ms) {
                                              const double mu = t.at(i, "mu"), slip = t.at(i, "eps_slip");
                                              const SimulationCase c = pinned(mu, 1.3 * slip + 0.01, 31, 1e-3 * ms);
                                              return slipAt(measureCurves(settings, e, c).loading) / slip - 1.0;
                                          }));
}

} // namespace supercircle::validation
