// T1: where smooth snap-fit (Type I) gives way to abrupt (Type II), on a rigid cylinder.
//
// Equation (1) of the supplement says when a tip sticks at infinitesimal indentation. So the experiment is tiny: press
// by d = 0.005 R and look whether the tip has slipped by more than 0.002 d. Bisection on mu then finds the boundary.
// What was learnt on the way:
// - The criterion itself lies low by sqrt(0.002 c d): just below mu* a tip slips only until d is about (mu* - mu) / c,
// so
//   its slip over d is (mu* - mu)^2 / (c d). In mu that is 0.001 at d = 0.005 R for every angle: nothing at 0.75, 1.2 %
//   where mu* itself is 0.0966 (0.90). Two indentations, four apart, take it away: mu* = 2 mu(d / 4) - mu(d).
// - Steps of 10 ms, about the longest period of the shell, make backward Euler a static solver. Short steps follow the
//   vibrations of the sudden start, and for mu > 1 (angles up to 0.75) these let the tip lift off and land elsewhere
//   (more than one impulse then satisfies the law, as in Painleve's problem): the tip has then "slipped".
// - Friction acts at the surface, h/2 beside the centre line: 0.001 rad in the friction angle at h/R = 0.26 %, that is
//   0.56 % in mu at 0.65. Proportional to h (1.12 / 0.56 / 0.22 % for 100 / 50 / 20 um).
// - An odd number of arcs couples the two halves through the middle arc, which the clamp holds at one point only. In
//   the continuum they are strangers. So with 15 arcs there is a band of mu in which one tip sticks while the other
//   slips (from -10 % upwards at 0.65, which never ends; -5 to 0 % at 0.70; none at 0.80 and beyond); with 16 there is
//   none, and even 8 arcs meet the theory to 1 % for angles up to 0.83.
// - A classification by force (does the peak pass 1.5 B/R^2?) asks something else: shells that slip a little, stick
//   again and still coil up count as Type II. It is compared with the solved boundary of no re-stick.

#include "plugin/lab/validation/experiments.h"
#include "plugin/lab/validation/reference.h"
#include "plugin/lab/validation/slip.h"
#include "plugin/lab/validation/theory.h"

#include <cmath>

namespace supercircle::validation {

namespace {

constexpr double kR = 0.0192, kThin = 2e-5, kStep = 1e-2;
constexpr double kIndentation = 0.005; // over R

Case touch(double phiBar, double mu, int elements, double indentation, double fixedDt) {
    Case c{"shell_on_cylinder", thin(kThin)};
    c.parameters.insert(c.parameters.end(), {{"phi_bar", phiBar},
                                             {"mu", mu},
                                             {"elements", static_cast<double>(elements)},
                                             {"speed", 0.04 * indentation}, // 48 steps of 10 ms
                                             {"travel_over_R", indentation}});
    c.loadingOnly = true;
    c.frames = 1.0; // only the first and the last are wanted
    c.fixedDt = fixedDt;
    return c;
}

double onset(const Settings& settings, Experiment& e, double phiBar, int elements, double indentation = kIndentation,
             double fixedDt = kStep) {
    const double theory = boundaryOnCylinder(phiBar);
    return bisect(0.7 * theory, 1.5 * theory, 12, [&](double mu) {
        const Case c = touch(phiBar, mu, elements, indentation, fixedDt);
        return slipOfTips(play(settings, e, c).recording, Ground::Cylinder) <= 0.002 * indentation * kR;
    });
}

/// The onset for vanishing indentation.
double onsetAtRest(const Settings& settings, Experiment& e, double phiBar, int elements) {
    return 2.0 * onset(settings, e, phiBar, elements, 0.25 * kIndentation) - onset(settings, e, phiBar, elements);
}

double byForce(const Settings& settings, Experiment& e, double phiBar, int elements) {
    const double theory = boundaryOnCylinder(phiBar);
    return bisect(0.7 * theory, 1.3 * theory, 9, [&](double mu) {
        Case c{"shell_on_cylinder", thin(kThin)};
        c.parameters.insert(
            c.parameters.end(),
            {{"phi_bar", phiBar}, {"mu", mu}, {"elements", static_cast<double>(elements)}, {"speed", 0.02}});
        c.loadingOnly = true;
        c.untilForce = 1.5;
        return legs(settings, e, c).load.top() >= 1.5;
    });
}

void convergence(const Settings& settings, Experiment& e, const std::vector<double>& angles) {
    Panel elements{"error of μ* (d → 0) against the number of arcs",
                   "arcs of the shell N",
                   "| error of μ* |, %",
                   true,
                   true,
                   0.5,
                   {}};
    int colour = 0;
    for (const double phiBar : angles) {
        for (const bool odd : {false, true}) {
            Line line{text("Φ/2π = %.2f", phiBar) + (odd ? ", N odd" : ", N even"),
                      {},
                      {},
                      odd ? Line::Style::Points : Line::Style::Connected,
                      colour};
            for (const int n : {8, 16, 32, 62}) {
                const double error = onsetAtRest(settings, e, phiBar, n - odd) / boundaryOnCylinder(phiBar) - 1.0;
                if (std::abs(error) > 0.4) // no boundary found in the range of the bisection
                    continue;
                line.x.push_back(n - odd);
                line.y.push_back(100.0 * std::abs(error));
            }
            elements.lines.push_back(line);
        }
        ++colour;
    }
    e.panels.push_back(elements);
    Panel step{"error of μ* (d = 0.005 R) against the time step, 31 arcs",
               "time step, ms",
               "| error of μ* |, %",
               true,
               true,
               0.5,
               {}};
    colour = 0;
    for (const double phiBar : angles) {
        Line line{text("Φ/2π = %.2f", phiBar), {}, {}, Line::Style::Connected, colour++};
        for (const double dt : {2.5e-3, 5e-3, 1e-2, 2e-2, 4e-2}) {
            line.x.push_back(1e3 * dt);
            line.y.push_back(
                100.0 * std::abs(onset(settings, e, phiBar, 31, kIndentation, dt) / boundaryOnCylinder(phiBar) - 1.0));
        }
        step.lines.push_back(line);
    }
    e.panels.push_back(step);
}

} // namespace

void boundary(const Settings& settings, Experiment& e) {
    e.about =
        "A thin shell (h = 20 µm, so h/R = 0.1 %) is pressed on a rigid cylinder of its own radius. μ* is where "
        "its tips stop slipping at first contact: slip below 0.002 d at an indentation d = 0.005 R, found by "
        "bisection to 0.02 %. Theory: eq. (1) to (4) of the supplement. The criterion itself lies low by 0.001 in "
        "μ (slip over d goes as (μ* − μ)²/d); “d → 0” takes that away with a second indentation, d/4. Beside it "
        "the boundary told by force (peak above 1.5 B/R²), which also counts shells that slip a little, stick "
        "again and coil up.";
    e.commands.push_back(touch(0.83, 0.48, 31, kIndentation, kStep).command());
    const std::vector<double> angles = settings.quick ? std::vector<double>{0.75, 0.83}
                                                      : std::vector<double>{0.65, 0.70, 0.75, 0.80, 0.83, 0.85, 0.90};
    Panel map{"boundary between Type I (below) and Type II (above)",
              "opening angle Φ/2π",
              "friction coefficient μ",
              false,
              true,
              {},
              {}};
    Line theory{"eq. (1)–(4)", {}, {}, Line::Style::Reference, 0};
    for (double p = 0.64; p <= 0.9051; p += 0.005) {
        theory.x.push_back(p);
        theory.y.push_back(boundaryOnCylinder(p));
    }
    Line coarse{"onset of slip (d → 0), 15 arcs", {}, {}, Line::Style::Points, 2}, fine = coarse, force = coarse;
    fine.name = "onset of slip (d → 0), 31 arcs";
    fine.colour = 1;
    force.name = "by force, 31 arcs";
    force.colour = 3;
    for (const double phiBar : angles) {
        const double wanted = boundaryOnCylinder(phiBar);
        for (const int n : {31, 32, 15, 16}) {
            const double rest = onsetAtRest(settings, e, phiBar, n);
            const bool isFine = n > 20;
            if (n == 31 || n == 15) {
                Line& line = isFine ? fine : coarse;
                line.x.push_back(phiBar);
                line.y.push_back(rest);
            }
            Check c = against(text("μ* at Φ/2π = %.2f, d → 0, %d arcs", phiBar, n), rest, wanted, isFine ? 0.005 : 0.02,
                              isFine ? "arcs are stiff in second order, at worst 1.1 % at 16; thickness adds 0.2 %"
                                     : "second order in 1/N: four times the error of 31 arcs");
            c.open = n == 15 && phiBar < 0.66; // the middle arc couples the halves
            if (c.open)
                c.why = "the middle arc of an odd number couples the halves: one tip sticks while the other slips";
            e.checks.push_back(c);
        }
        Check raw = against(text("μ* at Φ/2π = %.2f, d = 0.005 R, 31 arcs", phiBar), onset(settings, e, phiBar, 31),
                            wanted, 0.005, "the criterion lies low by 0.001 in μ, 0.3 % at 0.85");
        raw.open = phiBar > 0.875;
        if (raw.open)
            raw.why = "the criterion lies low by 0.001 in μ, which is 1.1 % of this μ*; see d → 0";
        e.checks.push_back(raw);
    }
    map.lines = {theory, fine, coarse};
    if (!settings.quick) {
        const Table strip(settings.data, "T1_boundary_nonlinear_share.csv");
        Line restick{"no re-stick (solved)", {}, {}, Line::Style::Dashed, 3};
        for (std::size_t i = 0; i < strip.rows(); ++i) {
            const double phiBar = strip.at(i, "Phi_over_2pi"), wanted = strip.at(i, "mu_no_restick_cylinder");
            restick.x.push_back(phiBar);
            restick.y.push_back(wanted);
            force.x.push_back(phiBar);
            force.y.push_back(byForce(settings, e, phiBar, 31));
            e.checks.push_back(against(text("μ at Φ/2π = %.2f where a peak above 1.5 B/R² begins, 31 arcs", phiBar),
                                       force.y.back(), wanted, {},
                                       "against the solved boundary below which a slipping tip does not stick again"));
        }
        map.lines.push_back(restick);
        map.lines.push_back(force);
    }
    e.panels.push_back(map);
    e.remarks.push_back(
        "An odd number of arcs couples the two halves of the shell through its middle arc, which the "
        "clamp holds at one point; in the continuum they are strangers. Then one tip may stick where the "
        "other slips: at 0.65 no boundary is found with 15 arcs, none at 0.75 with 7. Even numbers are "
        "free of it and meet the theory to 0.6 % with 8 arcs for angles up to 0.75.");
    e.remarks.push_back(
        "What is left at 0.65 is thickness: 1.1, 0.56, 0.22 % for 100, 50, 20 µm (friction acts h/2 beside "
        "the centre line). Time steps shorter than the shell's vibrations follow them: for μ > 1 the tip "
        "may then lift off and land elsewhere, as in Painlevé's problem (2.5 ms at 0.65).");
    if (!settings.quick)
        convergence(settings, e, {0.65, 0.75, 0.90});
}

} // namespace supercircle::validation
