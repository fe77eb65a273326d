// Struts and arches, by the static solver of one rod (no time stepping, no contact).

#include "plugin/lab/validation/experiments.h"
#include "plugin/lab/validation/reference_table.h"
#include "supercircle/rod/equilibrium.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace supercircle::validation {

namespace {

using rod::Vec2;

rod::RodModel unitRod(int elements, double length, double curvature) {
    rod::RodDefinition d;
    d.length = length;
    d.thickness = 1e-3 * length;
    d.linearMass = 1.0;
    d.bendingModulus = 1.0;
    d.naturalCurvature.assign(static_cast<std::size_t>(elements), curvature);
    return rod::RodModel(d);
}

rod::Equilibrium solve(const rod::RodModel& model, const rod::EquilibriumProblem& problem,
                       const Eigen::VectorXd& from) {
    rod::Equilibrium e = rod::solveEquilibrium(model, problem, from);
    if (!e.converged())
        throw std::runtime_error("static solver: " + e.failure);
    return e;
}

/// Load over deflection of a pinned strut, at the shortenings of the table.
struct Strut {
    std::vector<double> load, deflection;
};

Strut buckle(ValidationExperiment& e, const ReferenceTable& t, int elements) {
    const rod::RodModel model = unitRod(elements, 1.0, 0.0);
    Eigen::VectorXd q = Eigen::VectorXd::Zero(model.dofs());
    q.head(elements).setConstant(-0.1); // a small bend selects the side
    Strut out;
    for (const double shortening : t.column("end_shortening_over_L")) {
        rod::EquilibriumProblem problem;
        problem.supports = {rod::pin(0.0, Vec2::Zero()), rod::pin(1.0, Vec2(1.0 - shortening, 0.0))};
        const rod::Equilibrium found = solve(model, problem, q);
        ++e.runs;
        q = found.q;
        out.load.push_back(-found.reactions[1].force.x() / (M_PI * M_PI));
        out.deflection.push_back(q[model.dofY()]);
    }
    return out;
}

double worstLoad(const ReferenceTable& t, const Strut& s, double steepest) {
    double worst = 0.0;
    for (std::size_t i = 0; i < t.rows(); ++i)
        if (t.at(i, "tip_slope_deg") <= steepest)
            worst = std::max(worst, std::abs(s.load[i] / t.at(i, "P_over_Pcr") - 1.0));
    return worst;
}

void struts(const ValidationSettings& settings, ValidationExperiment& e) {
    const ReferenceTable t(settings.data, "T6_euler_pinned.csv");
    const Strut s = buckle(e, t, 31);
    e.diagrams.push_back({"Euler's strut, pinned ends, 31 arcs",
                          "deflection of the middle / L",
                          "load / critical load",
                          false,
                          false,
                          {},
                          {{"elliptic integrals", t.column("mid_deflection_over_L"), t.column("P_over_Pcr"),
                            PlotLine::Style::Reference, 0},
                           {"static solver", s.deflection, s.load, PlotLine::Style::Points, 1}}});
    const double error = worstLoad(t, s, 165.5);
    e.checks.push_back({"post-buckling load up to end slopes of 165°, 31 arcs", error, 0.0, error, "value", 0.005,
                        "1.5 % at 15 arcs where the loop's crown has a radius of 1.4 arcs; second order", false});
}

/// A stress-free arch of unit radius, its crown pushed down; symmetric by the holds on the crown.
struct Arch {
    rod::RodModel model;
    bool clamped;
    double half;

    Arch(int elements, double halfAngle, bool clampedFeet)
        : model(unitRod(elements, 2.0 * halfAngle, -1.0)), clamped(clampedFeet), half(halfAngle) {}

    [[nodiscard]] rod::Equilibrium push(double drop, const Eigen::VectorXd& from) const {
        rod::EquilibriumProblem problem;
        const Vec2 right(math::sin(half), math::cos(half)), left(-right.x(), right.y());
        problem.supports = {
            rod::pin(0.0, left), rod::pin(2.0 * half, right), {half, true, true, true, {0.0, 1.0 - drop}}};
        if (clamped) {
            problem.supports[0] = rod::clamp(0.0, left, half);
            problem.supports[1] = rod::clamp(2.0 * half, right, -half);
        }
        return solve(model, problem, from);
    }
};

ForceCurve curveOf(ValidationExperiment& e, const ForceCurve& wanted, double degrees, bool clamped, int elements,
                   double& end) {
    const Arch arch(elements, degrees * M_PI / 180.0, clamped);
    end = 0.97 * *std::max_element(wanted.d.begin(), wanted.d.end()); // where the branch turns back
    ForceCurve out;
    Eigen::VectorXd q = rod::naturalShape(arch.model, Vec2(0.0, 1.0), 0.0);
    for (int i = 0; i <= 25; ++i) {
        const double drop = end * i / 25.0;
        const rod::Equilibrium found = arch.push(drop, q);
        ++e.runs;
        q = found.q;
        out.d.push_back(drop);
        out.f.push_back(-found.reactions[2].force.y());
    }
    return out;
}

double worst(const ForceCurve& simulated, const ForceCurve& wanted) {
    double most = 0.0;
    for (std::size_t i = 0; i < simulated.d.size(); ++i)
        most = std::max(most, std::abs(simulated.f[i] - wanted.at(simulated.d[i])));
    double largest = 0.0;
    for (const double d : simulated.d)
        largest = std::max(largest, std::abs(wanted.at(d)));
    return most / largest;
}

} // namespace

void statics(const ValidationSettings& settings, ValidationExperiment& e) {
    e.about =
        "The rod's statics alone: an inextensible strut beyond its critical load, and stress-free circular arches "
        "whose crown is pushed down (symmetric branch, radius 1). The moment under a point load is a steep zigzag, "
        "which arcs of constant curvature resolve slowly: second order, but with a large factor.";
    struts(settings, e);
    std::vector<std::string> names;
    std::vector<std::pair<double, bool>> arches;
    std::vector<ForceCurve> wanted;
    Diagram deep{"semicircular arches, 61 arcs", "drop of the crown / R", "load / (B/R²)", false, false, {}, {}};
    Diagram shallow = deep;
    shallow.title = "arches of 60°, 61 arcs";
    for (const double degrees : {90.0, 30.0})
        for (const bool clamped : {false, true}) {
            const std::string name = text("half angle %g°, ", degrees) + (clamped ? "clamped" : "pinned");
            arches.emplace_back(degrees, clamped);
            names.push_back(name);
            wanted.push_back(reference(settings,
                                       text("T6_arch_%s_half%.1fdeg.csv", clamped ? "clamped" : "pinned", degrees),
                                       "crown_drop_over_R", "P_R2_over_B"));
            double end = 0.0;
            const ForceCurve fine = curveOf(e, wanted.back(), degrees, clamped, 61, end);
            Diagram& diagram = degrees > 45.0 ? deep : shallow;
            diagram.lines.push_back(solid(wanted.back(), name, clamped ? 1 : 0));
            diagram.lines.push_back({"", fine.d, fine.f, PlotLine::Style::Points, clamped ? 1 : 0});
            e.checks.push_back({"arch, " + name + ": largest difference of the load, 61 arcs",
                                worst(fine, wanted.back()), 0.0, worst(fine, wanted.back()), "largest load", 0.01,
                                "the moment under the point load is a zigzag: second order with a large factor",
                                false});
        }
    e.diagrams.push_back(deep);
    e.diagrams.push_back(shallow);
    if (settings.quick)
        return;
    e.diagrams.push_back(convergenceStudy(
        "arches: largest difference over the largest load", "arcs N", {7, 15, 31, 61}, names, 0.01,
        [&](std::size_t i, double n) {
            double end = 0.0;
            return worst(curveOf(e, wanted[i], arches[i].first, arches[i].second, static_cast<int>(n), end), wanted[i]);
        }));
    const ReferenceTable t(settings.data, "T6_euler_pinned.csv");
    e.diagrams.push_back(convergenceStudy("strut: largest relative error of the load", "arcs N", {7, 15, 31, 61},
                                          {"end slopes up to 90°", "up to 165°"}, 0.005, [&](std::size_t i, double n) {
                                              return worstLoad(t, buckle(e, t, static_cast<int>(n)),
                                                               i == 0 ? 90.5 : 165.5);
                                          }));
}

} // namespace supercircle::validation
