// Shells that are taken out of the motion, and the question that keeps new ones from overlapping others.

#include "plugin/api/from_definition.h"
#include "plugin/api/shells_impl.h"
#include "plugin/api/snapshot_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle {

const char* message(QuarantineReason reason) {
    switch (reason) {
    case QuarantineReason::Runaway:
        return "one of its elements curled up to more than a circle";
    case QuarantineReason::Crushed:
        return "given motions left it no room";
    case QuarantineReason::NotFinite:
        break;
    }
    return "its numbers were not finite";
}

Status Shells::set_recovery(const RecoverySettings& settings) {
    return impl_->change([&] {
        if (settings.policy != Recovery::Stay && settings.policy != Recovery::Release)
            return refused("the policy must be Stay or Release");
        if (!(settings.after >= 0.0) || !std::isfinite(settings.after))
            return refused("the time after which shells are released must be finite and not negative");
        impl_->stepper.settings().recoverAfter =
            settings.policy == Recovery::Release ? settings.after : std::numeric_limits<double>::infinity();
        impl_->recorder.record(Call::SetRecovery, settings);
        return done();
    });
}

RecoverySettings Shells::recovery() const {
    const double after = impl_->stepper.settings().recoverAfter;
    return std::isinf(after) ? RecoverySettings{} : RecoverySettings{Recovery::Release, after};
}

namespace {

/// Outlines of the host near a curve, in the world's frame.
std::vector<contact::Outline> outlinesNear(const step::Port& port, const contact::RodCurve& curve) {
    step::Box box;
    box.lower.setConstant(std::numeric_limits<double>::infinity());
    box.upper = -box.lower;
    for (const rod::Arc& a : curve.arcs)
        for (const rod::Vec2& p : {a.start, a.pointAt(a.length)}) { // an arc lies within its length of its ends
            box.lower = box.lower.cwiseMin(p - rod::Vec2::Constant(a.length));
            box.upper = box.upper.cwiseMax(p + rod::Vec2::Constant(a.length));
        }
    std::vector<step::BodyOutline> pieces;
    port.query(box, pieces);
    std::vector<contact::Outline> outlines;
    step::BodyState state;
    for (const step::BodyOutline& piece : pieces)
        if (port.state(piece.body, state) && state.centre.allFinite() && std::isfinite(state.angle))
            outlines.push_back(step::placed(piece, state.centre, state.angle));
    return outlines;
}

} // namespace

Result<bool> Shells::fits(const ShellDef& definition) const {
    if (impl_->gone)
        return Result<bool>::failure(kMovedFrom);
    return Impl::withoutExceptions([&] {
        const Result<RodFromDefinition> made = fromDefinition(definition);
        if (!made)
            return Result<bool>::failure(made.error());
        step::World alone;
        step::Rod& rod = alone.rods[step::addRod(alone, made->definition, made->q, made->v, definition.mu)];
        rod.category = definition.category;
        rod.mask = definition.mask;
        rod.group = definition.group;
        std::vector<contact::RodCurve> curves(1 + impl_->world.rods.size());
        step::toCurve(rod, rod.kin, curves[0]);
        for (std::size_t i = 0; i < impl_->world.rods.size(); ++i)
            step::toCurve(impl_->world.rods[i], impl_->world.rods[i].kin, curves[1 + i]);
        std::vector<contact::Outline> outlines;
        if (impl_->port)
            outlines = outlinesNear(*impl_->port, curves[0]);
        std::vector<contact::Crossing> crossings;
        contact::findCrossings(curves, outlines, crossings);
        return Result<bool>(std::none_of(crossings.begin(), crossings.end(),
                                         [](const contact::Crossing& c) { return c.rodA == 0 || c.rodB == 0; }));
    });
}

} // namespace supercircle
