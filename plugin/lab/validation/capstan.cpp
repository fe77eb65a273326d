// Capstan: a stiff rope around a rough cylinder.
//
// The rope is a naturally straight rod, pinned at both ends and wrapped around a half or a quarter of a cylinder. The
// cylinder rotates and drags the rope into a static equilibrium. The two reactions are the tensions T1 and T2, their
// directions the asymptotes. For the measured T1 the theory gives
//     T2 (cos p2 - mu sin p2) = T1 (cos p1 + mu sin p1) exp(mu (theta - p1 - p2)),   cos p_i = 1 - B / (2 T_i R^2),
// where p_i is the angle from the asymptote to the point where the rod leaves the cylinder. The slack of the rope sets
// the tension before rotation.

#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/lab/validation/experiments.h"
#include "plugin/lab/validation/reference_table.h"
#include "supercircle/step/stepper.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace supercircle::validation {

namespace {

using rod::Vec2;

/// T2 / T1 of a rope of stiffness b = B / (T1 R^2) over the angle theta between the asymptotes.
double ratio(double mu, double theta, double b) {
    if (b <= 0.0)
        return math::exp(mu * theta);
    const double p1 = math::acos(1.0 - 0.5 * b);
    double out = math::exp(mu * theta);
    for (int i = 0; i < 200; ++i) { // a contraction: p2 depends weakly on T2
        const double p2 = math::acos(1.0 - 0.5 * b / out);
        out = (math::cos(p1) + mu * math::sin(p1)) * math::exp(mu * (theta - p1 - p2)) /
              (math::cos(p2) - mu * math::sin(p2));
    }
    return out;
}

struct Rope {
    double mu = 0.0, wrap = 0.0; ///< rad
    double slack = 0.0;          ///< initial radius of the wrapped part over R, less one
    int elements = 60;
    double dt = 5e-4; ///< s
};

struct Tensions {
    double t1 = 0.0, t2 = 0.0, theta = 0.0; ///< B/R^2, B/R^2, rad: means over the second half of the run
    [[nodiscard]] double stiffness() const { return 1.0 / t1; }
    [[nodiscard]] double wanted(double mu) const { return ratio(mu, theta, stiffness()); }
    [[nodiscard]] double error(double mu) const { return t2 / t1 / wanted(mu) - 1.0; }
};

/// Initial shape: around a circle slightly larger than the cylinder, with straight ends.
ShellDef initialRope(const Rope& rope) {
    ShellDef d;
    d.name = "rope";
    d.thickness = 2e-5;
    d.density = 1270.0 * math::pow(d.thickness / 5e-4, 2);
    d.radius = std::numeric_limits<double>::infinity();
    d.mu = rope.mu;
    d.elements = rope.elements;
    const double around = kR * (1.0 + rope.slack), span = 2.5 * kR;
    d.length = 2.0 * span + rope.wrap * around;
    const double l = d.length / rope.elements;
    for (int i = 0; i < rope.elements; ++i) { // fraction of the arc that lies on the circle
        const double from = std::max(i * l, span), to = std::min((i + 1) * l, d.length - span);
        d.curvature.push_back(std::max(0.0, to - from) / l / around);
    }
    d.position = {0.0, -around}; // the middle lies under the cylinder, its tangent to the right
    return d;
}

Vec2 reactionOf(const step::World& w, std::size_t hold) {
    return w.rods.front().holds[hold].reaction;
}

Tensions drag(const ValidationSettings& settings, ValidationExperiment& e, const Rope& rope) {
    step::RigidWorldDefinition world;
    world.gravity.setZero();
    world.lengthScale = 52.1;
    step::BodyDefinition cylinder;
    cylinder.name = "cylinder";
    cylinder.type = step::BodyType::Kinematic;
    cylinder.angularVelocity = -0.1; // rad/s, 2 mm/s on the surface: drags the rope away from its second end
    step::FixtureDefinition disc;
    disc.shape = step::ShapeKind::Circle;
    const ShellDef d = initialRope(rope);
    disc.radius = kR - 0.5 * d.thickness;
    disc.friction = rope.mu;
    cylinder.fixtures.push_back(disc);
    world.bodies.push_back(cylinder);
    std::string error;
    const std::shared_ptr<step::HostWorld> host = settings.host(world, error);
    if (!host)
        throw std::runtime_error("capstan: " + error);
    Shells shells(host);
    shells.stepper().settings().fixedDt = rope.dt;
    const auto made = shells.create(d);
    if (!made || !shells.create_hold(*made, 0.0, HoldKind::Pin) || !shells.create_hold(*made, 1.0, HoldKind::Pin))
        throw std::runtime_error("capstan: " + made.error());
    ++e.runs;
    // The contact points move from arc to arc (1 to 2 % of the ratio), so the second half of the run is averaged.
    const double unit = bending_modulus(d) / (kR * kR), duration = 0.4;
    Vec2 first = Vec2::Zero(), second = Vec2::Zero();
    double weight = 0.0;
    while (shells.time() < duration) {
        const FrameReport r = shells.pre_step(rope.dt);
        if (!r.failure.empty())
            throw std::runtime_error("capstan: " + r.failure);
        host->step(r.advanced);
        shells.post_step().or_fail();
        if (shells.time() > 0.5 * duration) {
            first += reactionOf(shells.world(), 0);
            second += reactionOf(shells.world(), 1);
            weight += 1.0;
        }
    }
    Tensions out;
    out.t1 = first.norm() / weight / unit;
    out.t2 = second.norm() / weight / unit;
    out.theta = math::atan2(rod::cross(-first, second), -first.dot(second));
    if (out.theta < 0.0)
        out.theta += 2.0 * M_PI;
    return out;
}

} // namespace

void capstan(const ValidationSettings& settings, ValidationExperiment& e) {
    e.about = "A naturally straight rod, pinned at both ends, is wrapped around a rotating cylinder that drags it (20 "
              "µm thick, "
              "60 arcs). The two reactions are the tensions T₁ (slack side) and T₂, their directions the asymptotes, θ "
              "apart. "
              "Stiffness keeps the rope off the first and last part of the cylinder, so it holds less than Euler's "
              "exp(μθ): T₂(cos φ₂ − μ sin φ₂) = T₁(cos φ₁ + μ sin φ₁) exp(μ(θ − φ₁ − φ₂)).";
    const ReferenceTable t(settings.data, "T8_capstan.csv");
    double worst = 0.0;
    for (std::size_t i = 0; i < t.rows(); ++i)
        worst = std::max(worst, std::abs(ratio(t.at(i, "mu"), M_PI * t.at(i, "theta_over_pi"), t.at(i, "B_over_T1R2")) /
                                             t.at(i, "T2_over_T1") -
                                         1.0));
    e.checks.push_back({"the formula as implemented against the table, 31 rows", worst, 0.0, worst, "value", 1e-6,
                        "the table has nine digits", false});
    Diagram over{"effect of stiffness: T₂/T₁ below Euler's exp(μθ)",
                 "stiffness B / (T₁ R²)",
                 "T₂/T₁ over exp(μθ)",
                 false,
                 false,
                 {},
                 {}};
    int colour = 0;
    for (const double wrap : {0.5 * M_PI, M_PI})
        for (const double mu : {0.2, 0.35, 0.5}) {
            if (settings.quick && (mu < 0.3 || mu > 0.4))
                continue;
            const std::string name = text("μ = %.2f, wrapped over %g°", mu, wrap * 180.0 / M_PI);
            PlotLine simulated{"", {}, {}, PlotLine::Style::Points, colour},
                theory{name, {}, {}, PlotLine::Style::Reference, colour};
            ++colour;
            double most = 0.0;
            for (const double slack : {0.001, 0.002, 0.004, 0.008}) {
                if (settings.quick && slack != 0.002)
                    continue;
                const Tensions p = drag(settings, e, {mu, wrap, slack});
                const double euler = math::exp(mu * p.theta);
                simulated.x.push_back(p.stiffness());
                simulated.y.push_back(p.t2 / p.t1 / euler);
                theory.x.push_back(p.stiffness());
                theory.y.push_back(p.wanted(mu) / euler);
                most = std::max(most, std::abs(p.error(mu)));
                if (slack == 0.002)
                    e.checks.push_back(checkAgainst(
                        text("T₂/T₁, μ = %.2f, θ = %.1f°, B/(T₁R²) = %.3f", mu, p.theta * 180.0 / M_PI, p.stiffness()),
                        p.t2 / p.t1, p.wanted(mu), 0.015, "the contact points move from arc to arc, 1 to 2 %"));
            }
            if (!settings.quick)
                e.checks.push_back({name + ": largest error of T₂/T₁ over four tensions", most, 0.0, most, "value",
                                    0.015, "the contact points move from arc to arc, 1 to 2 %", false});
            over.lines.push_back(theory);
            over.lines.push_back(simulated);
        }
    e.diagrams.push_back(over);
    if (settings.quick)
        return;
    const std::vector<std::string> names{"μ = 0.20, 180°", "μ = 0.35, 180°"};
    e.diagrams.push_back(convergenceStudy(
        "error of T₂/T₁", "arcs of the rope N", {15, 30, 60, 90}, names, 0.01, [&](std::size_t i, double n) {
            const double mu = i == 0 ? 0.2 : 0.35;
            return drag(settings, e, {mu, M_PI, 0.002, static_cast<int>(n)}).error(mu);
        }));
    e.diagrams.push_back(convergenceStudy("error of T₂/T₁ against the time step, 60 arcs", "time step, ms",
                                          {0.5, 1, 2, 4}, names, 0.01, [&](std::size_t i, double ms) {
                                              const double mu = i == 0 ? 0.2 : 0.35;
                                              return drag(settings, e, {mu, M_PI, 0.002, 60, 1e-3 * ms}).error(mu);
                                          }));
}

} // namespace supercircle::validation
