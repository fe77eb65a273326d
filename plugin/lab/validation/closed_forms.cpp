// Sliding, rolling and rocking against closed forms.

#include "plugin/lab/validation/experiments.h"
#include "plugin/lab/validation/reference_table.h"
#include "supercircle/rod/arc.h"
#include "supercircle/support/elementary.h"

#include <cmath>

namespace supercircle::validation {

namespace {

constexpr double kG = 9.81;

rod::Vec2 startOf(const record::Frame& f) {
    return {f.shells.front().start[0], f.shells.front().start[1]};
}

/// Acceleration down an incline over g of a shell that stands on its tips and slides.
double slide(const ValidationSettings& settings, ValidationExperiment& e, double mu, double degrees,
             double fixedDt = 0.0) {
    SimulationCase c{"ramp", {{"mu", mu}, {"angle", degrees * M_PI / 180.0}, {"time", 0.6}, {"phi_bar", 0.5}}};
    c.frames = 0.01;
    c.fixedDt = fixedDt;
    e.commands.push_back(c.command());
    const record::Recording r = simulate(settings, e, c).recording;
    const auto distance = [&](double t) {
        std::size_t i = 0;
        while (i + 1 < r.frames.size() && r.frames[i].time < t - 1e-9)
            ++i;
        return std::pair{r.frames[i].time, (startOf(r.frames[i]) - startOf(r.frames.front())).norm()};
    };
    const auto [t1, x1] = distance(0.1); // a parabola through three points
    const auto [t2, x2] = distance(0.35);
    const auto [t3, x3] = distance(0.59);
    return 2.0 * ((x3 - x1) / (t3 - t1) - (x2 - x1) / (t2 - t1)) / (t3 - t2) / kG;
}

scene::Scene onFloor(double mu, ShellDef shell, double duration) {
    scene::Scene s;
    s.rigid.gravity = {0.0, -kG};
    s.rigid.lengthScale = 52.1;
    step::BodyDefinition floor;
    floor.name = "floor";
    step::FixtureDefinition plate;
    plate.vertices = {{-2.0, -0.1}, {2.0, -0.1}, {2.0, 0.0}, {-2.0, 0.0}};
    plate.friction = mu;
    floor.fixtures.push_back(plate);
    s.rigid.bodies.push_back(floor);
    shell.mu = mu;
    s.shells.push_back(shell);
    s.duration = duration;
    s.report.R = kR;
    s.report.sample_dt = duration / 2000.0;
    return s;
}

ShellDef stiffRing() {
    ShellDef d;
    d.name = "ring";
    d.closed = true;
    d.length = 2.0 * M_PI * kR;
    d.radius = kR;
    d.elements = 15;
    // Thin, because friction acts h/2 outside the mass (0.9 % of x* for the paper's 0.5 mm). A thousand times as stiff
    // as the paper's shell, because the closed forms neglect bending.
    d.thickness = 2e-5;
    d.young_modulus *= 1e3 * math::pow(5e-4 / d.thickness, 2);
    return d;
}

/// Where a ring thrown along a floor with v0 and no spin stops slipping: x* g / v0^2.
double rollingFrom(const ValidationSettings& settings, ValidationExperiment& e, double mu, double fixedDt) {
    const double v0 = 0.5, slipTime = 0.5 * v0 / (mu * kG); // half of the speed is lost
    ShellDef d = stiffRing();
    d.position = {-kR, kR + 0.5 * d.thickness + 1e-8};
    d.angle = -0.5 * M_PI;
    d.velocity = {v0, 0.0};
    scene::Scene s = onFloor(mu, d, 1.6 * slipTime);
    s.name = "thrown ring";
    const record::Recording r = simulate(settings, e, s, fixedDt).recording;
    // velocity of the centre from the mean of all nodes
    std::vector<double> t, x;
    for (const record::Frame& f : r.frames) {
        rod::Vec2 at = startOf(f), sum = at;
        double angle = f.shells.front().angle;
        const double l = d.length / d.elements;
        for (std::size_t i = 0; i + 1 < f.shells.front().curvature.size(); ++i) {
            const rod::Arc arc{at, angle, static_cast<double>(f.shells.front().curvature[i]), l};
            at = arc.pointAt(l);
            angle = arc.angleAt(l);
            sum += at;
        }
        t.push_back(f.time);
        x.push_back(sum.x() / d.elements);
    }
    // slipping: x = x0 + v0 t - mu g t^2 / 2; rolling: straight. Meet: fit the straight line from the last third.
    const std::size_t n = t.size(), a = n * 4 / 5;
    const double speed = (x[n - 1] - x[a]) / (t[n - 1] - t[a]);
    // x* where the parabola has this slope
    const double meeting = (v0 - speed) / (mu * kG);
    const double offset = x[n - 1] - x[0] - speed * (t[n - 1] - t[0]);
    return (offset + speed * meeting) * kG / (v0 * v0);
}

/// omega^2 R / g of the frictionless rocking of a stiff shell on its back.
double rocking(const ValidationSettings& settings, ValidationExperiment& e, double phiBar, double wanted,
               double stepsPerPeriod) {
    ShellDef d;
    d.name = "cradle";
    d.phi_bar = phiBar;
    d.elements = 15;
    d.young_modulus *= 1e3;
    const double tilt = 0.02;
    // opening upwards: runs to the right through its lowest point
    d.position = {kR * math::sin(tilt), kR + 0.5 * d.thickness + 1e-8 - kR * math::cos(tilt)};
    d.angle = tilt;
    const double period = 2.0 * M_PI / std::sqrt(wanted * kG / kR);
    scene::Scene s = onFloor(0.0, d, 10.0 * period);
    s.name = "rocking shell";
    s.report.sample_dt = period / 200.0;
    const record::Recording r = simulate(settings, e, s, period / stepsPerPeriod).recording;
    // times at which the angle of the first end passes its mean, upwards
    double mean = 0.0;
    for (const record::Frame& f : r.frames)
        mean += f.shells.front().angle / static_cast<double>(r.frames.size());
    std::vector<double> crossings;
    for (std::size_t i = 1; i < r.frames.size(); ++i) {
        const double p = r.frames[i - 1].shells.front().angle - mean, q = r.frames[i].shells.front().angle - mean;
        if (p < 0.0 && q >= 0.0)
            crossings.push_back(r.frames[i - 1].time - p / (q - p) * (r.frames[i].time - r.frames[i - 1].time));
    }
    if (crossings.size() < 3)
        return std::nan("");
    const double found = (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
    const double omega = 2.0 * M_PI / found;
    return omega * omega * kR / kG;
}

} // namespace

void closedForms(const ValidationSettings& settings, ValidationExperiment& e) {
    e.about =
        "A half circle standing on its tips slides down an incline; a stiff closed ring is thrown along a rough floor "
        "until it rolls; stiff shells rock on a frictionless floor. Gravity 9.81 m/s². Rows of the table about rigid "
        "discs, bouncing balls, belts and rods with restitution concern no shell and are left out (contact is "
        "inelastic here).";
    const ReferenceTable t(settings.data, "T8_closed_forms.csv");
    std::vector<std::string> rocks;
    std::vector<std::pair<double, double>> cradles;
    Diagram rock{
        "rocking of a stiff shell on its back, no friction", "opening angle Φ/2π", "ω² R / g", false, false, {}, {}};
    rock.lines = {{"closed form", {}, {}, PlotLine::Style::Dashed, 0}, {"15 arcs", {}, {}, PlotLine::Style::Points, 1}};
    for (std::size_t i = 0; i < t.rows(); ++i) {
        const double p = t.at(i, "p1"), wanted = t.at(i, "closed_form");
        if (t.label(i) == "incline_accel_over_g")
            e.checks.push_back(checkAgainst(text("sliding down %g°, μ = %.2f: acceleration / g", t.at(i, "p2"), p),
                                            slide(settings, e, p, t.at(i, "p2")), wanted, 0.005,
                                            "the scene's incline is rounded to single precision by Box2D, 1e-7"));
        else if (t.label(i) == "roll_x_star*g/v0^2_ring")
            e.checks.push_back(checkAgainst(text("thrown ring, μ = %.2f: distance until it rolls, x* g / v₀²", p),
                                            rollingFrom(settings, e, p, 0.0), wanted, 0.005,
                                            "15 arcs; h/R = 0.1 % between friction and mass"));
        else if (t.label(i) == "rock_omega2_R_over_g_frictionless") {
            const double found = rocking(settings, e, p, wanted, 400.0);
            e.checks.push_back(checkAgainst(text("rocking, Φ/2π = %.2f: ω² R / g", p), found, wanted, 0.005,
                                            "second order in the time step; amplitude 0.02 rad"));
            rocks.push_back(text("Φ/2π = %.2f", p));
            cradles.emplace_back(p, wanted);
            rock.lines[0].x.push_back(p);
            rock.lines[0].y.push_back(wanted);
            rock.lines[1].x.push_back(p);
            rock.lines[1].y.push_back(found);
        }
    }
    e.diagrams.push_back(rock);
    if (!settings.quick)
        e.diagrams.push_back(convergenceStudy(
            "error of ω² against the time step", "steps per period", {50, 100, 200, 400, 800}, rocks, 0.005,
            [&](std::size_t i, double steps) {
                return rocking(settings, e, cradles[i].first, cradles[i].second, steps) / cradles[i].second - 1.0;
            }));
}

} // namespace supercircle::validation
