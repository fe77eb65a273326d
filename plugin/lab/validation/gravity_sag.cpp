// Heavy cantilevers, and vibrations of circular arcs, both by time stepping.

#include "plugin/lab/validation/experiments.h"
#include "plugin/lab/validation/reference_table.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace supercircle::validation {

namespace {

double summary(const record::Recording& r, const std::string& key) {
    for (const auto& [name, value] : r.summary)
        if (name == key)
            return std::get<double>(value);
    return std::nan("");
}

SimulationCase hang(double gamma, double c, int elements) {
    return {"cantilever", {{"gamma", gamma}, {"c", c}, {"elements", static_cast<double>(elements)}}};
}

struct Cantilever {
    double c;
    const char* file;
};

/// Distance of the tip from its reference position, over L.
double tipError(const ValidationSettings& settings, ValidationExperiment& e, const ReferenceTable& t, std::size_t row,
                int elements, rod::Vec2* where = nullptr) {
    const SimulationCase c = hang(t.at(row, "Gamma"), t.at(row, "c_kappa0L"), elements);
    const record::Recording r = simulate(settings, e, c).recording;
    const rod::Vec2 tip(summary(r, "tip_x_over_L"), -summary(r, "tip_y_over_L"));
    if (where != nullptr)
        *where = tip;
    return (tip - rod::Vec2(t.at(row, "x_tip_over_L"), t.at(row, "drop_tip_over_L"))).norm();
}

void cantilevers(const ValidationSettings& settings, ValidationExperiment& e) {
    Diagram diagram{"heavy cantilevers: position of the tip, 15 arcs",
                    "Γ = λ g L³ / B",
                    "drop of the tip / L",
                    true,
                    false,
                    {},
                    {}};
    const std::array<Cantilever, 3> all{{{1.0, "T4_cantilever_c+1.000.csv"},
                                         {0.0, "T4_cantilever_straight_coarse.csv"},
                                         {-1.0, "T4_cantilever_c-1.000.csv"}}};
    std::vector<std::string> names;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const ReferenceTable t(settings.data, all[k].file);
        const int colour = static_cast<int>(k);
        names.push_back(text("κ₀L = %g", all[k].c));
        diagram.lines.push_back({names[k] + (t.rows() < 10 ? " (five solved points)" : ""), t.column("Gamma"),
                                 t.column("drop_tip_over_L"),
                                 t.rows() < 10 ? PlotLine::Style::Dashed : PlotLine::Style::Reference, colour});
        PlotLine simulated{"", {}, {}, PlotLine::Style::Points, colour};
        double worst = 0.0, heavy = 0.0;
        for (std::size_t i = 0; i < t.rows(); ++i) {
            const double gamma = t.at(i, "Gamma");
            if (gamma > 101.0 || (t.rows() > 10 && i % 5 != 0))
                continue;
            rod::Vec2 tip;
            const double error = tipError(settings, e, t, i, 15, &tip);
            (gamma > 50.0 ? heavy : worst) = std::max(gamma > 50.0 ? heavy : worst, error);
            simulated.x.push_back(gamma);
            simulated.y.push_back(tip.y());
        }
        diagram.lines.push_back(simulated);
        e.checks.push_back({names[k] + ", Γ up to 50: distance of the tip from the reference, 15 arcs", worst, 0.0,
                            worst, "L", 0.002, "the clamp's boundary layer is Γ^(-1/2) L: two arcs at Γ = 50", false});
        e.checks.push_back({names[k] + ", Γ = 100: distance of the tip from the reference, 15 arcs", heavy, 0.0, heavy,
                            "L", 0.003, "1.5 arcs", false});
    }
    e.diagrams.push_back(diagram);
    if (settings.quick)
        return;
    e.diagrams.push_back(convergenceStudy("distance of the tip from the reference over L, Γ = 100", "arcs of the rod N",
                                          {7, 15, 31, 61}, names, 0.003, [&](std::size_t k, double n) {
                                              const ReferenceTable t(settings.data, all[k].file);
                                              for (std::size_t i = 0; i < t.rows(); ++i)
                                                  if (std::abs(t.at(i, "Gamma") - 100.0) < 0.5)
                                                      return tipError(settings, e, t, i, static_cast<int>(n));
                                              return std::nan("");
                                          }));
}

/// Dominant angular frequency of a signal near `guess`: maximum of the Hann-windowed Fourier sum.
double frequency(const std::vector<double>& t, const std::vector<double>& x, double guess) {
    const double length = t.back() - t.front();
    double mean = 0.0;
    for (const double v : x)
        mean += v / static_cast<double>(x.size());
    const auto strength = [&](double omega) {
        double cosine = 0.0, sine = 0.0;
        for (std::size_t i = 0; i < t.size(); ++i) {
            const double window = 0.5 - 0.5 * math::cos(2.0 * M_PI * (t[i] - t.front()) / length);
            cosine += window * (x[i] - mean) * math::cos(omega * t[i]);
            sine += window * (x[i] - mean) * math::sin(omega * t[i]);
        }
        return cosine * cosine + sine * sine;
    };
    double low = 0.9 * guess, high = 1.1 * guess;
    const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
    for (int i = 0; i < 60; ++i) {
        const double a = high - golden * (high - low), b = low + golden * (high - low);
        (strength(a) > strength(b) ? high : low) = strength(a) > strength(b) ? b : a;
    }
    return 0.5 * (low + high);
}

/// Frequency of a mode of a naturally curved arc, from a run of some twenty periods after a small disturbance of its
/// curvature, over sqrt(B / lambda) / R^2. `mode` from 0.
double vibrate(const ValidationSettings& settings, ValidationExperiment& e, double phiBar, bool clamped, int mode,
               int elements, double wanted, double stepsPerPeriod = 400.0) {
    scene::Scene s;
    s.name = "vibrating arc";
    s.rigid.gravity.setZero();
    ShellDef d;
    d.name = "arc";
    d.phi_bar = phiBar;
    d.elements = elements;
    for (int i = 0; i < elements; ++i) {
        const double z = (i + 0.5) / elements,
                     taper = clamped ? (1.0 - z) * (1.0 - z) : math::pow(math::sin(M_PI * z), 2);
        // nodes of the bending moment as in the mode
        const double shape = taper * math::cos((mode + (clamped && mode > 0 ? 0.3 : 0.0)) * M_PI * z);
        d.curvature.push_back((1.0 + 1e-3 * shape) / d.radius);
    }
    const double unit = std::sqrt(bending_modulus(d) / (d.density * d.width * d.thickness)) / (kR * kR);
    const double period = 2.0 * M_PI / (wanted * unit);
    s.shells.push_back(d);
    if (clamped)
        s.holds.push_back({"arc", 0.0, HoldKind::Clamp, HoldBase::Fixed});
    s.duration = 20.0 * period;
    s.report.R = kR;
    s.report.sample_dt = std::max(1e-4, period / 40.0);
    const record::Recording r = simulate(settings, e, s, period / stepsPerPeriod).recording;
    std::vector<double> t, x;
    const std::size_t probe = clamped ? 0 : static_cast<std::size_t>(mode == 1 ? elements / 4 : elements / 2);
    for (const record::Frame& f : r.frames) {
        t.push_back(f.time);
        x.push_back(static_cast<double>(f.shells.front().curvature[probe]));
    }
    return frequency(t, x, wanted * unit) / unit;
}

void vibrations(const ValidationSettings& settings, ValidationExperiment& e) {
    const ReferenceTable t(settings.data, "T4_frequencies_arc_share.csv");
    struct Mode {
        std::string name;
        double phiBar, wanted;
        bool clamped;
        int mode;
    };
    std::vector<Mode> modes;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < t.rows(); ++i)
        for (int mode = 0; mode < 2; ++mode) {
            const double phiBar = t.at(i, "Phi_over_2pi");
            const bool clamped = t.at(i, "bc(0 free-free,1 clamped-free)") == 1.0;
            if (phiBar < 0.4)
                continue; // nearly straight: covered by the cantilevers
            modes.push_back(
                {text("Φ/2π = %.2f, ", phiBar) + (clamped ? "clamped–free" : "free–free") + text(", mode %d", mode + 1),
                 phiBar, t.at(i, text("omega%d_R2_sqrt(lambda/B)", mode + 1)), clamped, mode});
        }
    for (const Mode& m : modes) {
        names.push_back(m.name);
        e.checks.push_back(checkAgainst("frequency, " + m.name + ", 15 arcs",
                                        vibrate(settings, e, m.phiBar, m.clamped, m.mode, 15, m.wanted), m.wanted, 0.01,
                                        "Rayleigh quotients converge from above, second order: below 1 % at 15 arcs"));
        if (settings.quick && names.size() == 2)
            return;
    }
    const std::vector<std::string> some{names[0], names[1], names[2]};
    e.diagrams.push_back(convergenceStudy(
        "frequencies of free vibrations", "arcs N", {7, 15, 31, 61}, some, 0.01, [&](std::size_t k, double n) {
            const Mode& m = modes[k];
            return vibrate(settings, e, m.phiBar, m.clamped, m.mode, static_cast<int>(n), m.wanted) / m.wanted - 1.0;
        }));
    e.diagrams.push_back(convergenceStudy(
        "frequencies against the time step, 31 arcs", "steps per period", {50, 100, 200, 400, 800}, some, 0.01,
        [&](std::size_t k, double steps) {
            const Mode& m = modes[k];
            return vibrate(settings, e, m.phiBar, m.clamped, m.mode, 31, m.wanted, steps) / m.wanted - 1.0;
        }));
}

} // namespace

void gravitySag(const ValidationSettings& settings, ValidationExperiment& e) {
    e.about =
        "Rods clamped horizontally swing until they come to rest (scene `cantilever`). Naturally curved arcs, bent by "
        "one part in a thousand, vibrate freely; their frequency is read from about twenty periods.";
    e.commands.push_back(hang(100.0, 0.0, 15).command());
    cantilevers(settings, e);
    vibrations(settings, e);
}

} // namespace supercircle::validation
