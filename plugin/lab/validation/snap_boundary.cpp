// The boundary between smooth snap-fit (Type I) and abrupt snap-fit (Type II) on a rigid cylinder.
//
// Equation (1) of the supplement gives the friction coefficient mu* at which a tip sticks at infinitesimal indentation.
// The simulation presses by d = 0.005 R and compares the slip of the tip with 0.002 d; bisection in mu finds the
// boundary. Just below mu* the slip over d is (mu* - mu)^2 / (c d), so the criterion is biased by 0.001 in mu. Two
// indentations remove the bias: mu* = 2 mu(d / 4) - mu(d). Steps of 10 ms, thickness and even numbers of arcs: decision
// 0171. The classification by force (peak above 1.5 B/R^2) is compared with the solved boundary of no re-stick.

#include "plugin/lab/validation/experiments.h"
#include "plugin/lab/validation/reference_table.h"
#include "plugin/lab/validation/theory.h"
#include "plugin/lab/validation/tip_slip.h"

#include <cmath>

namespace supercircle::validation {

namespace {

constexpr double kStep = 1e-2;
constexpr double kIndentation = 0.005; // over R

SimulationCase snapped(double phiBar, double mu, int elements, double indentation, double fixedDt) {
    SimulationCase c{"shell_on_cylinder", thin(kThin)};
    c.parameters.insert(c.parameters.end(), {{"phi_bar", phiBar},
                                             {"mu", mu},
                                             {"elements", static_cast<double>(elements)},
                                             {"speed", 0.04 * indentation}, // 48 steps of 10 ms
                                             {"travel_over_R", indentation}});
    c.loadingOnly = true;
    c.frames = 1.0; // s; the first and the last frame are enough
    c.fixedDt = fixedDt;
    return c;
}

double onset(const ValidationSettings& settings, ValidationExperiment& e, double phiBar, int elements,
             double indentation = kIndentation, double fixedDt = kStep) {
    const double theory = boundaryOnCylinder(phiBar);
    return bisect(0.7 * theory, 1.5 * theory, 12, [&](double mu) {
        const SimulationCase c = snapped(phiBar, mu, elements, indentation, fixedDt);
        return tipSlip(simulate(settings, e, c).recording, Support::Cylinder) <= 0.002 * indentation * kR;
    });
}

/// The onset extrapolated to zero indentation.
double onsetAtZero(const ValidationSettings& settings, ValidationExperiment& e, double phiBar, int elements) {
    return 2.0 * onset(settings, e, phiBar, elements, 0.25 * kIndentation) - onset(settings, e, phiBar, elements);
}

double byForce(const ValidationSettings& settings, ValidationExperiment& e, double phiBar, int elements) {
    const double theory = boundaryOnCylinder(phiBar);
    return bisect(0.7 * theory, 1.3 * theory, 9, [&](double mu) {
        SimulationCase c{"shell_on_cylinder", thin(kThin)};
        c.parameters.insert(
            c.parameters.end(),
            {{"phi_bar", phiBar}, {"mu", mu}, {"elements", static_cast<double>(elements)}, {"speed", 0.02}});
        c.loadingOnly = true;
        c.untilForce = 1.5;
        return measureCurves(settings, e, c).loading.top() >= 1.5;
    });
}

void convergenceOfSnap(const ValidationSettings& settings, ValidationExperiment& e, const std::vector<double>& angles) {
    Diagram elements{"error of μ* (d → 0) against the number of arcs",
                     "arcs of the shell N",
                     "| error of μ* |, %",
                     true,
                     true,
                     0.5,
                     {}};
    int colour = 0;
    for (const double phiBar : angles) {
        for (const bool odd : {false, true}) {
            PlotLine line{text("Φ/2π = %.2f", phiBar) + (odd ? ", N odd" : ", N even"),
                          {},
                          {},
                          odd ? PlotLine::Style::Points : PlotLine::Style::Connected,
                          colour};
            for (const int n : {8, 16, 32, 62}) {
                const double error = onsetAtZero(settings, e, phiBar, n - odd) / boundaryOnCylinder(phiBar) - 1.0;
                if (std::abs(error) > 0.4) // no boundary found in the range of the bisection
                    continue;
                line.x.push_back(n - odd);
                line.y.push_back(100.0 * std::abs(error));
            }
            elements.lines.push_back(line);
        }
        ++colour;
    }
    e.diagrams.push_back(elements);
    Diagram step{"error of μ* (d = 0.005 R) against the time step, 31 arcs",
                 "time step, ms",
                 "| error of μ* |, %",
                 true,
                 true,
                 0.5,
                 {}};
    colour = 0;
    for (const double phiBar : angles) {
        PlotLine line{text("Φ/2π = %.2f", phiBar), {}, {}, PlotLine::Style::Connected, colour++};
        for (const double dt : {2.5e-3, 5e-3, 1e-2, 2e-2, 4e-2}) {
            line.x.push_back(1e3 * dt);
            line.y.push_back(
                100.0 * std::abs(onset(settings, e, phiBar, 31, kIndentation, dt) / boundaryOnCylinder(phiBar) - 1.0));
        }
        step.lines.push_back(line);
    }
    e.diagrams.push_back(step);
}

} // namespace

void snapBoundary(const ValidationSettings& settings, ValidationExperiment& e) {
    e.about =
        "A thin shell (h = 20 µm, so h/R = 0.1 %) is pressed on a rigid cylinder of its own radius. μ* is the friction "
        "coefficient at which its tips stop slipping at first contact: slip below 0.002 d at an indentation "
        "d = 0.005 R, found by bisection to 0.02 %. Theory: eq. (1) to (4) of the supplement. The criterion is biased "
        "by −0.001 in μ (slip over d goes as (μ* − μ)²/d); “d → 0” removes the bias with a second indentation, d/4. "
        "The boundary by force (peak above 1.5 B/R²) also counts shells that slip a little, stick again and coil up.";
    e.commands.push_back(snapped(0.83, 0.48, 31, kIndentation, kStep).command());
    const std::vector<double> angles = settings.quick ? std::vector<double>{0.75, 0.83}
                                                      : std::vector<double>{0.65, 0.70, 0.75, 0.80, 0.83, 0.85, 0.90};
    Diagram map{"boundary between Type I (below) and Type II (above)",
                "opening angle Φ/2π",
                "friction coefficient μ",
                false,
                true,
                {},
                {}};
    PlotLine theory{"eq. (1)–(4)", {}, {}, PlotLine::Style::Reference, 0};
    for (double p = 0.64; p <= 0.9051; p += 0.005) {
        theory.x.push_back(p);
        theory.y.push_back(boundaryOnCylinder(p));
    }
    PlotLine coarse{"onset of slip (d → 0), 15 arcs", {}, {}, PlotLine::Style::Points, 2}, fine = coarse,
                                                                                           force = coarse;
    fine.name = "onset of slip (d → 0), 31 arcs";
    fine.colour = 1;
    force.name = "by force, 31 arcs";
    force.colour = 3;
    for (const double phiBar : angles) {
        const double wanted = boundaryOnCylinder(phiBar);
        for (const int n : {31, 32, 15, 16}) {
            const double rest = onsetAtZero(settings, e, phiBar, n);
            const bool isFine = n > 20;
            if (n == 31 || n == 15) {
                PlotLine& line = isFine ? fine : coarse;
                line.x.push_back(phiBar);
                line.y.push_back(rest);
            }
            Check c =
                checkAgainst(text("μ* at Φ/2π = %.2f, d → 0, %d arcs", phiBar, n), rest, wanted, isFine ? 0.005 : 0.02,
                             isFine ? "at most 0.25 % at 16 arcs, mostly thickness: 0.2 %"
                                    : "at most 0.25 %, mostly thickness: 0.2 %");
            c.knownDeviation = n == 15 && phiBar < 0.66; // the middle arc couples the halves
            if (c.knownDeviation)
                c.reason = "the middle arc of an odd number couples the halves: one tip sticks while the other slips";
            e.checks.push_back(c);
        }
        Check raw =
            checkAgainst(text("μ* at Φ/2π = %.2f, d = 0.005 R, 31 arcs", phiBar), onset(settings, e, phiBar, 31),
                         wanted, 0.005, "the criterion is biased by −0.001 in μ, 0.3 % at 0.85");
        raw.knownDeviation = phiBar > 0.875;
        if (raw.knownDeviation)
            raw.reason = "the criterion is biased by −0.001 in μ, which is 1.1 % of this μ*; see d → 0";
        e.checks.push_back(raw);
    }
    map.lines = {theory, fine, coarse};
    if (!settings.quick) {
        const ReferenceTable strip(settings.data, "T1_boundary_nonlinear_share.csv");
        PlotLine restick{"no re-stick (solved)", {}, {}, PlotLine::Style::Dashed, 3};
        for (std::size_t i = 0; i < strip.rows(); ++i) {
            const double phiBar = strip.at(i, "Phi_over_2pi"), wanted = strip.at(i, "mu_no_restick_cylinder");
            restick.x.push_back(phiBar);
            restick.y.push_back(wanted);
            force.x.push_back(phiBar);
            force.y.push_back(byForce(settings, e, phiBar, 31));
            e.checks.push_back(checkAgainst(
                text("μ at Φ/2π = %.2f where a peak above 1.5 B/R² begins, 31 arcs", phiBar), force.y.back(), wanted,
                {}, "against the solved boundary below which a slipping tip does not stick again"));
        }
        map.lines.push_back(restick);
        map.lines.push_back(force);
    }
    e.diagrams.push_back(map);
    e.remarks.push_back(
        "An odd number of arcs couples the two halves of the shell through its middle arc, which the clamp holds at "
        "one "
        "point; in the continuum the halves are independent. Then one tip may stick where the other slips: no boundary "
        "is found at 0.65 with 15 arcs and at 0.75 with 7 arcs. Even numbers have no such coupling and agree with the "
        "theory to 0.6 % with 8 arcs for angles up to 0.75.");
    e.remarks.push_back(
        "The remaining error at 0.65 comes from thickness: 1.1, 0.56, 0.22 % for 100, 50, 20 µm (friction acts h/2 "
        "beside the centre line). Time steps shorter than the vibration periods of the shell resolve its vibrations: "
        "for μ > 1 the tip may then lift off and land elsewhere, as in Painlevé's problem (2.5 ms at 0.65).");
    if (!settings.quick)
        convergenceOfSnap(settings, e, {0.65, 0.75, 0.90});
}

} // namespace supercircle::validation
