// Grip: a shell of the cylinder's own radius: does it pull itself in, and does it resist being pulled off?

#include "plugin/lab/validation/experiments.h"
#include "plugin/lab/validation/reference_table.h"
#include "plugin/lab/validation/theory.h"
#include "plugin/lab/validation/tip_slip.h"
#include "supercircle/support/elementary.h"

#include <cmath>

namespace supercircle::validation {

namespace {

constexpr double kClearance = 6e-4; ///< m, by which the cylinder is smaller in the pull-off test

SimulationCase gripped(double phiBar, double mu, int elements) {
    SimulationCase c{"shell_on_cylinder", thin(kThin)};
    c.parameters.insert(
        c.parameters.end(),
        {{"phi_bar", phiBar}, {"mu", mu}, {"elements", static_cast<double>(elements)}, {"speed", 0.005}});
    return c;
}

/// Displacement at which the force changes sign, looking from `from` on; NaN if it does not.
double zeroOf(const ForceCurve& leg, double from, double to) {
    for (std::size_t i = 1; i < leg.d.size(); ++i) {
        const double low = std::min(leg.d[i - 1], leg.d[i]), high = std::max(leg.d[i - 1], leg.d[i]);
        if (low > from && high < to && leg.f[i - 1] * leg.f[i] <= 0.0 && leg.f[i - 1] != leg.f[i])
            return leg.d[i - 1] - leg.f[i - 1] * (leg.d[i] - leg.d[i - 1]) / (leg.f[i] - leg.f[i - 1]);
    }
    return std::nan("");
}

/// A seated shell is pulled off: smallest mu at which its tips stick. Criterion of snap_boundary.
double pullStick(const ValidationSettings& settings, ValidationExperiment& e, double phiBar, double wanted,
                 int elements) {
    const auto onset = [&](double d) {
        return bisect(0.7 * wanted, 1.5 * wanted, 12, [&](double mu) {
            SimulationCase c = gripped(phiBar, mu, elements);
            c.parameters.back().value = 0.04 * d;
            c.loadingOnly = true;
            c.frames = 1.0;
            c.fixedDt = 1e-2;
            scene::Scene s = load(settings, c);
            // Seated on a slightly smaller cylinder and lifted until only the tips touch it. On a cylinder of the
            // shell's own radius the flanks touch at once and carry part of the load.
            double& radius = s.rigid.bodies.front().fixtures.front().radius;
            radius -= kClearance;
            const double phi = M_PI * phiBar, touching = radius + 0.5 * kThin + 1e-8;
            const double lift =
                -kR * math::cos(phi) - std::sqrt(touching * touching - math::pow(kR * math::sin(phi), 2));
            s.shells.front().position = {0.0, kR + lift};
            scene::ProtocolSegment& segment = s.protocol->segments.front();
            s.protocol->direction = {0.0, 1.0};
            segment.stop_when.displacement = d * kR;
            s.report.sample_dt = 1.0;
            return tipSlip(simulate(settings, e, s, 1e-2).recording, Support::Cylinder) <= 0.002 * d * kR;
        });
    };
    return 2.0 * onset(0.00125) - onset(0.005);
}

/// Theory of sticking, for a cylinder of radius alpha R: the shell pulled off has the mirrored friction cone.
double pullTheory(double phiBar, double alpha) {
    const double phi = M_PI * phiBar;
    return math::tan(math::asin(math::sin(phi) / alpha) - math::atan(tipRatio(phi)));
}

void pullingOff(const ValidationSettings& settings, ValidationExperiment& e, Diagram& diagram) {
    const ReferenceTable t(settings.data, "T9_gripfit_alpha1.csv");
    diagram.lines.push_back({"above: tips stick when pulled off (solved, own radius)", t.column("Phi_over_2pi"),
                             t.column("mu_pull_stick"), PlotLine::Style::Dashed, 2});
    PlotLine smaller{"the same on 0.97 R", {}, {}, PlotLine::Style::Reference, 1};
    for (double p = 0.6; p < 0.9051; p += 0.01) {
        smaller.x.push_back(p);
        smaller.y.push_back(pullTheory(p, 1.0 - kClearance / kR));
    }
    diagram.lines.push_back(smaller);
    PlotLine simulated{"onset of slip, 32 arcs", {}, {}, PlotLine::Style::Points, 1};
    for (const double phiBar : {0.60, 0.65, 0.70, 0.75, 0.80, 0.85, 0.90}) {
        if (settings.quick && phiBar != 0.75)
            continue;
        const double wanted = pullTheory(phiBar, 1.0 - kClearance / kR);
        const double found = pullStick(settings, e, phiBar, wanted, 32);
        simulated.x.push_back(phiBar);
        simulated.y.push_back(found);
        e.checks.push_back(checkAgainst(text("μ at which tips stick when pulled off, Φ/2π = %.2f, 32 arcs", phiBar),
                                        found, wanted, 0.01, "as in snap_boundary; solved for a cylinder of 0.97 R"));
    }
    diagram.lines.push_back(simulated);
}

/// Tip angle from the cylinder's top at which the crosshead force vanishes: pi/2 + atan(mu) pushing, pi/2 - atan(mu)
/// pulling, since then the contact force points straight down at the tip.
void neutral(const ValidationSettings& settings, ValidationExperiment& e) {
    const ReferenceTable t(settings.data, "T2_summary_share.csv");
    for (std::size_t i = 0; i < t.rows(); ++i) {
        const double phiBar = t.at(i, "Phi_over_2pi"), mu = t.at(i, "mu");
        if (phiBar < 0.6 || (settings.quick && (phiBar < 0.7 || mu < 0.1)))
            continue;
        const double seated = -2.0 * math::cos(M_PI * phiBar);
        const MeasuredCurves run = measureCurves(settings, e, gripped(phiBar, mu, 31));
        e.commands.push_back(gripped(phiBar, mu, 31).command());
        const std::string name = text("Φ/2π = %.2f, μ = %.2f: indentation where the force vanishes, ", phiBar, mu);
        const double push = t.at(i, "D_f0_load"), pull = t.at(i, "D_f0_pull");
        e.checks.push_back(checkAgainst(name + "pushing", zeroOf(run.loading, 0.02 * seated, 0.97 * seated), push, 0.01,
                                        "the position of the tip decides, not the force"));
        e.checks.push_back(checkAgainst(name + "pulling", zeroOf(run.unloading, 0.02 * seated, 0.94 * seated), pull,
                                        0.01, "as pushing"));
    }
}

/// Smallest mu at which a shell pushed to 98.5 % of the full travel still resists, against the theory for the tip angle
/// reached: the force vanishes at the angle pi / 2 + atan(mu) from the top.
void pullingIn(const ValidationSettings& settings, ValidationExperiment& e, Diagram& diagram) {
    const ReferenceTable t(settings.data, "T9_gripfit_alpha1.csv");
    diagram.lines.push_back({"below: pulls itself in (solved)", t.column("Phi_over_2pi"),
                             t.column("mu_snap(=tan(phi-pi/2))"), PlotLine::Style::Reference, 0});
    PlotLine simulated{"the same, 32 arcs", {}, {}, PlotLine::Style::Points, 0};
    for (const double phiBar : {0.60, 0.65, 0.70}) { // deeper ones are of Type II at such friction
        const double wanted = math::tan(M_PI * (phiBar - 0.5));
        const double found = bisect(0.5 * wanted, 1.2 * wanted, 8, [&](double mu) {
            SimulationCase c = gripped(phiBar, mu, 32);
            c.parameters.push_back({"travel_over_R", -0.985 * 2.0 * math::cos(M_PI * phiBar)});
            c.loadingOnly = true;
            const ForceCurve load = measureCurves(settings, e, c).loading;
            return load.at(load.d.back() - 1e-4) > 0.0;
        });
        SimulationCase c = gripped(phiBar, found, 32);
        c.parameters.push_back({"travel_over_R", -0.985 * 2.0 * math::cos(M_PI * phiBar)});
        c.loadingOnly = true;
        c.frames = 1.0;
        const lab::RunResult out = simulate(settings, e, c);
        const auto& tip = out.recording.frames.back().shells.front().start;
        const double psi = math::atan2(std::abs(tip[0]), tip[1]);
        simulated.x.push_back(phiBar);
        simulated.y.push_back(found);
        e.checks.push_back(checkAgainst(
            text("μ below which a shell pulls itself in at 98.5 %% of the full travel, Φ/2π = %.2f", phiBar), found,
            math::tan(psi - 0.5 * M_PI), 0.01,
            "theory for the tip angle reached, slightly below φ; bisection to 0.3 %"));
    }
    diagram.lines.push_back(simulated);
}

} // namespace

void grip(const ValidationSettings& settings, ValidationExperiment& e) {
    e.about = "A shell on a cylinder of its own radius. The crosshead force vanishes where the force at the tip points "
              "straight up or down: at the tip angle π/2 + atan μ pushing and π/2 − atan μ pulling. So a pushed shell "
              "pulls itself in (f < 0) if μ < tan(φ − π/2) (simulated at 98.5 % of the full travel, where the tip "
              "angle is slightly below "
              "φ). Pulled off, its tips first stick if μ > tan(φ₀ − atan(Cxy/Cxx)): "
              "measured by the onset of slip as in snap_boundary, on a cylinder of 0.97 R, since on one of the shell's "
              "own radius the "
              "flanks touch it at once and carry part of the load.";
    Diagram diagram{"snap-fit and stick-fit", "opening angle Φ/2π", "friction coefficient μ", false, false, {}, {}};
    neutral(settings, e);
    if (!settings.quick)
        pullingIn(settings, e, diagram);
    pullingOff(settings, e, diagram);
    e.diagrams.push_back(diagram);
}

} // namespace supercircle::validation
