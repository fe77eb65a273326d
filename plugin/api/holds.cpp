// Holds, mouse joints and forces: what acts on one shell alone.

#include "plugin/api/limits.h"
#include "plugin/api/shells_impl.h"
#include "plugin/api/snapshot_fields.h"
#include "supercircle/step/applied_forces.h"
#include "supercircle/step/sleep.h"

namespace supercircle {

namespace {

bool isPossible(const TargetDef& d) {
    return limits::position(d.position) && limits::velocity(d.velocity, d.spin) && limits::angle(d.angle);
}

} // namespace

Result<HoldHandle> Shells::create_hold(ShellHandle shell, double arc_fraction, HoldKind kind, HoldBase base) {
    using R = Result<HoldHandle>;
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return R::failure(kNoSuchShell);
        if (!isFraction(arc_fraction))
            return R::failure(kBadFraction);
        if (kind != HoldKind::Pin && kind != HoldKind::Clamp)
            return R::failure("a hold is a pin or a clamp");
        if (base != HoldBase::Fixed && base != HoldBase::Moving)
            return R::failure("the base of a hold is fixed or moving");
        step::wake(impl_->world, static_cast<std::size_t>(i));
        step::Rod& rod = impl_->rod(i);
        step::Hold h;
        h.s = arc_fraction * rod.model.definition().length;
        h.clamped = kind == HoldKind::Clamp;
        h.onCrosshead = base == HoldBase::Moving;
        const rod::MaterialPoint at = rod::locate(rod.model, h.s);
        h.target.point = rod.kin.point(at);
        h.target.angle = rod.kin.angle(at);
        h.key = impl_->world.nextPart++;
        rod.holds.push_back(h);
        const HoldHandle made{rod.key, h.key, impl_->worldId};
        impl_->recorder.record(Call::CreateHold, shell, arc_fraction, kind, base, made);
        return R(made);
    });
}

Status Shells::set_target(HoldHandle hold, const TargetDef& to) {
    return impl_->change([&] {
        const auto found = impl_->find(hold, &step::Rod::holds);
        if (!found.constraint)
            return refused(kNoSuchConstraint);
        if (found.constraint->onCrosshead)
            return refused("this hold is attached to the crosshead: the velocity of the crosshead moves it");
        if (!isPossible(to))
            return refused("position and angle must be finite and within 1e12 (m, rad), velocity and spin within 1e9");
        step::wake(impl_->world, found.index);
        setPendingTarget(to, found.constraint->target);
        impl_->recorder.record(Call::SetHoldTarget, hold, to);
        return done();
    });
}

Result<TargetDef> Shells::target(HoldHandle hold) const {
    const auto found = impl_->find(hold, &step::Rod::holds);
    if (!found.constraint)
        return Result<TargetDef>::failure(kNoSuchConstraint);
    const step::Pose p = step::poseAfter(impl_->world, *found.constraint, 0.0);
    return TargetDef{point(p.point), p.angle, point(p.velocity), p.spin};
}

Result<Reaction> Shells::reaction(HoldHandle hold) const {
    const auto found = impl_->find(hold, &step::Rod::holds);
    if (!found.constraint)
        return Result<Reaction>::failure(kNoSuchConstraint);
    return Reaction{point(found.constraint->reaction), found.constraint->reactionTorque};
}

namespace {

/// Removes a constraint from its rod's list.
template <class Handle, class Constraint>
Status destroyConstraint(auto& impl, Handle handle, std::vector<Constraint> step::Rod::*list, Call call) {
    return impl.change([&] {
        const auto found = impl.find(handle, list);
        if (!found.constraint)
            return refused(kNoSuchConstraint);
        step::wake(impl.world, found.index);
        auto& all = found.rod->*list;
        all.erase(all.begin() + (found.constraint - all.data()));
        impl.recorder.record(call, handle);
        return done();
    });
}

} // namespace

Status Shells::set_max_force(HoldHandle hold, double force) {
    return impl_->change([&] {
        const auto found = impl_->find(hold, &step::Rod::holds);
        if (!found.constraint)
            return refused(kNoSuchConstraint);
        if (!(force >= 0.0) || !std::isfinite(force))
            return refused("the largest force must be finite and not negative (0: any)");
        found.constraint->maxForce = force;
        impl_->recorder.record(Call::SetHoldMaxForce, hold, force);
        return done();
    });
}

Status Shells::destroy(HoldHandle hold) {
    return destroyConstraint(*impl_, hold, &step::Rod::holds, Call::DestroyHold);
}

Result<MouseJointHandle> Shells::create_mouse_joint(ShellHandle shell, const MouseJointDef& d) {
    using R = Result<MouseJointHandle>;
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return R::failure(kNoSuchShell);
        if (!isFraction(d.arc_fraction))
            return R::failure(kBadFraction);
        if (!limits::position(d.target))
            return R::failure(limits::kTooFar);
        if (!(d.frequency > 0.0) || !(d.frequency < limits::kFastest))
            return R::failure("frequency must be positive and below 1e9 Hz");
        if (!(d.damping_ratio >= 0.0) || !(d.damping_ratio < limits::kFastest))
            return R::failure("damping_ratio must not be negative, and below 1e9");
        if (!(d.max_force >= 0.0) || !limits::impulse(impl_->rod(i).model, {d.max_force, 0.0}, 0.0))
            return R::failure(
                "max_force must be finite and not negative (0: mass times 1000 m/s^2), and the velocity it "
                "causes must be finite");
        const double mass = impl_->rod(i).model.mass(), omega = 2.0 * M_PI * d.frequency;
        step::MouseJoint g;
        g.stiffness = mass * omega * omega;
        g.damping = 2.0 * mass * d.damping_ratio * omega;
        g.s = d.arc_fraction * impl_->rod(i).model.definition().length;
        g.target = vec(d.target);
        g.maxForce = d.max_force > 0.0 ? d.max_force : 1000.0 * mass;
        g.key = impl_->world.nextPart++;
        step::wake(impl_->world, static_cast<std::size_t>(i));
        impl_->rod(i).mouseJoints.push_back(g);
        const MouseJointHandle made{impl_->rod(i).key, g.key, impl_->worldId};
        impl_->recorder.record(Call::CreateMouseJoint, shell, d, made);
        return R(made);
    });
}

Status Shells::set_target(MouseJointHandle joint, Point target) {
    return impl_->change([&] {
        const auto found = impl_->find(joint, &step::Rod::mouseJoints);
        if (!found.constraint)
            return refused(kNoSuchConstraint);
        if (!limits::position(target))
            return refused(limits::kTooFar);
        if (found.constraint->target != vec(target))
            step::wake(impl_->world, found.index);
        found.constraint->target = vec(target);
        impl_->recorder.record(Call::SetMouseJointTarget, joint, target);
        return done();
    });
}

Result<Reaction> Shells::reaction(MouseJointHandle joint) const {
    const auto found = impl_->find(joint, &step::Rod::mouseJoints);
    if (!found.constraint)
        return Result<Reaction>::failure(kNoSuchConstraint);
    return Reaction{point(found.constraint->force), 0.0};
}

Status Shells::destroy(MouseJointHandle joint) {
    return destroyConstraint(*impl_, joint, &step::Rod::mouseJoints, Call::DestroyMouseJoint);
}

Result<ForceHandle> Shells::Impl::addForce(ShellHandle shell, double arc_fraction, Point force, double torque,
                                           bool once) {
    using R = Result<ForceHandle>;
    Impl& m = *this;
    return change([&] {
        const int i = m.find(shell);
        if (i < 0)
            return R::failure(kNoSuchShell);
        if (!isFraction(arc_fraction))
            return R::failure(kBadFraction);
        if (!limits::impulse(m.rod(i).model, force, torque))
            return R::failure(limits::kTooStrong);
        step::wake(m.world, static_cast<std::size_t>(i));
        step::Rod& rod = m.rod(i);
        const std::uint32_t key = m.world.nextPart++;
        rod.forces.push_back({arc_fraction * rod.model.definition().length, vec(force), torque, once, key});
        const ForceHandle made{rod.key, key, m.worldId};
        m.recorder.record(once ? Call::ApplyForce : Call::CreateForce, shell, arc_fraction, force, torque, made);
        return R(made);
    });
}

Result<ForceHandle> Shells::create_force(ShellHandle shell, double arc_fraction, Point force, double torque) {
    return impl_->addForce(shell, arc_fraction, force, torque, false);
}

Status Shells::set_force(ForceHandle handle, Point force, double torque) {
    return impl_->change([&] {
        const auto found = impl_->find(handle, &step::Rod::forces);
        if (!found.constraint)
            return refused(kNoSuchConstraint);
        if (!limits::impulse(found.rod->model, force, torque))
            return refused(limits::kTooStrong);
        step::wake(impl_->world, found.index);
        found.constraint->force = vec(force);
        found.constraint->torque = torque;
        impl_->recorder.record(Call::SetForce, handle, force, torque);
        return done();
    });
}

Status Shells::destroy(ForceHandle handle) {
    return destroyConstraint(*impl_, handle, &step::Rod::forces, Call::DestroyForce);
}

Status Shells::apply_force(ShellHandle shell, double arc_fraction, Point force, double torque) {
    const auto added = impl_->addForce(shell, arc_fraction, force, torque, true);
    return added ? done() : refused(added.error());
}

Status Shells::apply_torque(ShellHandle shell, double arc_fraction, double torque) {
    return apply_force(shell, arc_fraction, {}, torque);
}

Status Shells::apply_impulse(ShellHandle shell, double arc_fraction, Point impulse, double angular_impulse) {
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return refused(kNoSuchShell);
        if (!isFraction(arc_fraction))
            return refused(kBadFraction);
        if (!limits::impulse(impl_->rod(i).model, impulse, angular_impulse))
            return refused(limits::kTooStrong);
        if (impl_->rod(i).quarantined)
            return refused("the shell is quarantined: it does not move any more");
        step::applyImpulse(impl_->world, static_cast<std::size_t>(i),
                           arc_fraction * impl_->rod(i).model.definition().length, vec(impulse), angular_impulse);
        impl_->recorder.record(Call::ApplyImpulse, shell, arc_fraction, impulse, angular_impulse);
        return done();
    });
}

bool Shells::valid(HoldHandle handle) const {
    return impl_->find(handle, &step::Rod::holds).constraint != nullptr;
}
bool Shells::valid(MouseJointHandle handle) const {
    return impl_->find(handle, &step::Rod::mouseJoints).constraint != nullptr;
}
bool Shells::valid(ForceHandle handle) const {
    return impl_->find(handle, &step::Rod::forces).constraint != nullptr;
}

} // namespace supercircle
