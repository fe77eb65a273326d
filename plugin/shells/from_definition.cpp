#include "plugin/shells/from_definition.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace supercircle {

double shellLength(const ShellDef& d) {
    return d.length != 0.0 ? d.length : 2.0 * M_PI * d.phi_bar * d.radius;
}

namespace {

std::string checkNumbers(const ShellDef& d) {
    const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
    if (d.elements < 1 || d.elements > 4096)
        return "elements must lie between 1 and 4096";
    if (!positive(d.thickness) || !positive(d.width) || !positive(d.density) || !positive(d.young_modulus))
        return "thickness, width, density and young_modulus must be positive and finite";
    if (!(d.mu >= 0.0) || !std::isfinite(d.mu))
        return "mu must be finite and not negative";
    if (d.length == 0.0 && !(positive(d.phi_bar) && d.phi_bar <= 1.0 && positive(d.radius)))
        return "without a length, radius must be positive and phi_bar lie in (0, 1]";
    if (std::isnan(d.radius) || d.radius == 0.0)
        return "radius must not be zero";
    if (!positive(shellLength(d)))
        return "length must be positive and finite";
    for (double x : {d.position.x, d.position.y, d.angle, d.velocity.x, d.velocity.y, d.spin})
        if (!std::isfinite(x))
            return "position, angle, velocity and spin must be finite";
    if (!(d.tip_refinement >= 0.01 && d.tip_refinement <= 100.0))
        return "tip_refinement must lie between 0.01 and 100";
    const auto count = static_cast<std::size_t>(d.elements);
    if ((!d.natural_curvature.empty() && d.natural_curvature.size() != count) ||
        (!d.curvature.empty() && d.curvature.size() != count))
        return "natural_curvature and curvature need one value per element (" + std::to_string(d.elements) + ")";
    return {};
}

} // namespace

std::string fromDefinition(const ShellDef& d, RodFromDefinition& out) {
    if (std::string why = checkNumbers(d); !why.empty())
        return why;
    const auto count = static_cast<std::size_t>(d.elements);
    rod::RodDefinition& r = out.definition;
    r.length = shellLength(d);
    r.thickness = d.thickness;
    r.linearMass = d.density * d.width * d.thickness;
    r.bendingModulus = bendingModulus(d);
    r.closed = d.closed;
    if (d.tip_refinement != 1.0)
        r.elementLength = rod::gradedLengths(r.length, d.elements, d.tip_refinement);
    r.naturalCurvature = d.natural_curvature;
    if (r.naturalCurvature.empty())
        r.naturalCurvature.assign(count, std::isinf(d.radius) ? 0.0 : 1.0 / d.radius);
    if (std::string why = rod::validate(r); !why.empty())
        return why;
    std::vector<double> curvature = d.curvature.empty() ? r.naturalCurvature : d.curvature;
    if (d.closed && d.curvature.empty()) // the round ring: natural curvature may differ, the welded shape may not
        curvature.assign(count, 2.0 * M_PI / r.length);
    // Finite numbers whose energies are not would spoil the books of everybody.
    constexpr double kMost = 1e30; // J, and far beyond any world
    const double size = std::hypot(d.velocity.x, d.velocity.y) + std::abs(d.spin) * r.length;
    double bend = 0.0;
    for (const auto* list : std::initializer_list<const std::vector<double>*>{&r.naturalCurvature, &d.curvature})
        for (const double k : *list)
            bend = std::max(bend, std::abs(k));
    if (!(r.linearMass * r.length * size * size < kMost) || !(r.bendingModulus * r.length * bend * bend < kMost) ||
        !(std::hypot(d.position.x, d.position.y) < 1e12))
        return "the shell is too far away, too heavy, too fast or too strongly bent for its energy to be a number";
    const rod::RodModel model(r);
    // An element that turns more than once lies upon itself; a million turns would take memory without end to draw.
    constexpr double kMostTurn = 8.0 * M_PI;
    for (int i = 0; i < d.elements; ++i)
        for (const double k : {r.naturalCurvature[static_cast<std::size_t>(i)], curvature[static_cast<std::size_t>(i)]})
            if (!(std::abs(k) * model.elementLength(i) <= kMostTurn))
                return "natural_curvature, curvature and radius may turn an element by 8 pi at most: element " +
                       std::to_string(i) + " would turn by " + std::to_string(k * model.elementLength(i)) + " rad";
    out.q.setZero(model.dofs());
    out.v.setZero(model.dofs());
    for (int i = 0; i < d.elements; ++i) {
        out.q[model.dofOfElement(i)] = curvature[static_cast<std::size_t>(i)];
    }
    out.q[model.dofX()] = d.position.x;
    out.q[model.dofY()] = d.position.y;
    out.q[model.dofTheta()] = d.angle;
    out.v[model.dofX()] = d.velocity.x;
    out.v[model.dofY()] = d.velocity.y;
    out.v[model.dofTheta()] = d.spin;
    return {};
}

} // namespace supercircle
