#include "plugin/api/from_definition.h"

#include "plugin/api/limits.h"

#include <algorithm>
#include <cmath>

namespace supercircle {

double shellLength(const ShellDef& d) {
    return d.length != 0.0 ? d.length : 2.0 * M_PI * d.phi_bar * d.radius;
}

namespace {

Status checkNumbers(const ShellDef& d) {
    const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
    if (d.elements < limits::kFewestElements || d.elements > limits::kMostElements)
        return Status::failure("elements must lie between " + std::to_string(limits::kFewestElements) + " and " +
                               std::to_string(limits::kMostElements) +
                               ": one or two arcs cannot bend where they are pressed");
    if (!positive(d.thickness) || !positive(d.width) || !positive(d.density) || !positive(d.young_modulus))
        return Status::failure("thickness, width, density and young_modulus must be positive and finite");
    if (!limits::friction(d.mu))
        return Status::failure(limits::kBadFriction);
    if (!limits::damping(d.damping_ratio))
        return Status::failure(limits::kBadDamping);
    if (d.length == 0.0 && !(positive(d.phi_bar) && d.phi_bar <= 1.0 && positive(d.radius)))
        return Status::failure("without a length, radius must be positive and the opening angle over 2 pi in (0, 1]");
    if (std::isnan(d.radius) || d.radius == 0.0)
        return Status::failure("radius must not be zero");
    if (!positive(shellLength(d)))
        return Status::failure("length must be positive and finite");
    for (double x : {d.position.x, d.position.y, d.angle, d.velocity.x, d.velocity.y, d.spin})
        if (!std::isfinite(x))
            return Status::failure("position, angle, velocity and spin must be finite");
    if (!(d.tip_refinement >= 0.01 && d.tip_refinement <= 100.0))
        return Status::failure("tip_refinement must lie between 0.01 and 100");
    if (d.mass_at.size() > limits::kMostPointMasses)
        return Status::failure("more than " + std::to_string(limits::kMostPointMasses) + " point masses on a shell");
    for (const PointMassDef& m : d.mass_at)
        if (!(m.arc_fraction >= 0.0 && m.arc_fraction <= 1.0))
            return Status::failure("the arc fraction of a point mass must lie between 0 and 1");
    const auto count = static_cast<std::size_t>(d.elements);
    if ((!d.natural_curvature.empty() && d.natural_curvature.size() != count) ||
        (!d.curvature.empty() && d.curvature.size() != count))
        return Status::failure("natural_curvature and curvature need one value per element (" +
                               std::to_string(d.elements) + ")");
    return {};
}

} // namespace

Result<RodFromDefinition> fromDefinition(const ShellDef& d) {
    using Made = Result<RodFromDefinition>;
    if (const Status checked = checkNumbers(d); !checked)
        return Made::failure(checked.error());
    RodFromDefinition out;
    const auto count = static_cast<std::size_t>(d.elements);
    rod::RodDefinition& r = out.definition;
    r.length = shellLength(d);
    r.thickness = d.thickness;
    r.linearMass = d.density * d.width * d.thickness;
    r.bendingModulus = bending_modulus(d);
    r.closed = d.closed;
    for (const PointMassDef& m : d.mass_at)
        if (m.mass != 0.0 || m.inertia != 0.0)
            r.pointMasses.push_back({m.arc_fraction * r.length, m.mass, m.inertia});
    if (d.tip_refinement != 1.0)
        r.elementLength = rod::gradedLengths(r.length, d.elements, d.tip_refinement);
    r.naturalCurvature = d.natural_curvature;
    if (r.naturalCurvature.empty())
        r.naturalCurvature.assign(count, std::isinf(d.radius) ? 0.0 : 1.0 / d.radius);
    if (std::string why = rod::validate(r); !why.empty())
        return Made::failure(std::move(why));
    std::vector<double> curvature = d.curvature.empty() ? r.naturalCurvature : d.curvature;
    if (d.closed && d.curvature.empty()) // the round ring: natural curvature may differ, the welded shape may not
        curvature.assign(count, 2.0 * M_PI / r.length);
    if (const Status sized = limits::shell(r); !sized)
        return Made::failure(sized.error());
    double bend = 0.0;
    for (const double k : curvature)
        bend = std::max(bend, std::abs(k));
    if (!limits::motion(r, d.velocity, d.spin) || !(r.bendingModulus * r.length * bend * bend < limits::kMostEnergy) ||
        !limits::position(d.position) || !limits::angle(d.angle))
        return Made::failure(
            "the shell is too far away, too fast or too strongly curved: its energy would not be finite");
    const rod::RodModel model(r);
    for (const auto* list : {&r.naturalCurvature, &curvature})
        if (const Status turned = limits::turns(model, *list); !turned)
            return Made::failure(turned.error());
    if (const Status closes = limits::ring(model, curvature); d.closed && !closes)
        return Made::failure(closes.error());
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
    return out;
}

} // namespace supercircle
