// Holds, grabs and forces: what acts on one shell alone.

#include "plugin/api/limits.h"
#include "plugin/api/shells_impl.h"
#include "plugin/api/snapshot_fields.h"
#include "supercircle/step/applied_forces.h"
#include "supercircle/step/sleep.h"

namespace supercircle {

namespace {

bool possible(const DriveDef& d) {
    return limits::place(d.position) && limits::velocity(d.velocity, d.spin) && limits::angle(d.angle);
}

} // namespace

Result<HoldHandle> Shells::hold(ShellHandle shell, double arc_fraction, HoldKind kind, bool on_machine) {
    using R = Result<HoldHandle>;
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return R::failure(kNoSuchShell);
        if (!isFraction(arc_fraction))
            return R::failure(kBadFraction);
        if (kind != HoldKind::Pin && kind != HoldKind::Clamp)
            return R::failure("a hold is a pin or a clamp");
        step::wake(impl_->world, static_cast<std::size_t>(i));
        step::Rod& rod = impl_->rod(i);
        step::Hold h;
        h.s = arc_fraction * rod.model.definition().length;
        h.clamped = kind == HoldKind::Clamp;
        h.onMachine = on_machine;
        const rod::Place at = rod::locate(rod.model, h.s);
        h.target.point = rod.kin.point(at);
        h.target.angle = rod.kin.angle(at);
        h.key = impl_->world.nextPart++;
        rod.holds.push_back(h);
        const HoldHandle made{rod.key, h.key, impl_->tag};
        impl_->recorder.record(Call::Hold, shell, arc_fraction, kind, on_machine, made);
        return R(made);
    });
}

Outcome Shells::drive(HoldHandle hold, const DriveDef& to) {
    return impl_->change([&] {
        const auto found = impl_->find(hold, &step::Rod::holds);
        if (!found.part)
            return refused(kNoSuchPart);
        if (found.part->onMachine)
            return refused("this hold is carried by the machine: set_machine_velocity moves it");
        if (!possible(to))
            return refused("position and angle must be finite and within 1e12 (m, rad), velocity and spin within 1e9");
        step::wake(impl_->world, found.index);
        setGoal(to, found.part->target);
        impl_->recorder.record(Call::DriveHold, hold, to);
        return done();
    });
}

Result<DriveDef> Shells::target(HoldHandle hold) const {
    const auto found = impl_->find(hold, &step::Rod::holds);
    if (!found.part)
        return Result<DriveDef>::failure(kNoSuchPart);
    const step::Pose p = step::poseAfter(impl_->world, *found.part, 0.0);
    return DriveDef{point(p.point), p.angle, point(p.velocity), p.spin};
}

Result<Reaction> Shells::reaction(HoldHandle hold) const {
    const auto found = impl_->find(hold, &step::Rod::holds);
    if (!found.part)
        return Result<Reaction>::failure(kNoSuchPart);
    return Reaction{point(found.part->reaction), found.part->reactionTorque};
}

namespace {

/// Takes a part out of its rod's list.
template <class Handle, class Part>
Outcome removePart(auto& impl, Handle handle, std::vector<Part> step::Rod::*list, Call call) {
    return impl.change([&] {
        const auto found = impl.find(handle, list);
        if (!found.part)
            return refused(kNoSuchPart);
        step::wake(impl.world, found.index);
        auto& parts = found.rod->*list;
        parts.erase(parts.begin() + (found.part - parts.data()));
        impl.recorder.record(call, handle);
        return done();
    });
}

} // namespace

Outcome Shells::release(HoldHandle hold) {
    return removePart(*impl_, hold, &step::Rod::holds, Call::ReleaseHold);
}

Result<GrabHandle> Shells::grab(ShellHandle shell, const GrabDef& d) {
    using R = Result<GrabHandle>;
    return impl_->change([&] {
        const int i = impl_->find(shell);
        if (i < 0)
            return R::failure(kNoSuchShell);
        if (!isFraction(d.arc_fraction))
            return R::failure(kBadFraction);
        if (!limits::place(d.target))
            return R::failure(limits::kTooFar);
        if (!(d.frequency > 0.0) || !(d.frequency < limits::kFastest))
            return R::failure("frequency must be positive and below 1e9 Hz");
        if (!(d.damping_ratio >= 0.0) || !(d.damping_ratio < limits::kFastest))
            return R::failure("damping_ratio must not be negative, and below 1e9");
        if (!(d.max_force >= 0.0) || !limits::impulse(impl_->rod(i).model, {d.max_force, 0.0}, 0.0))
            return R::failure("max_force must be finite and not negative (0: mass times 1000 m/s^2), and not move the "
                              "shell beyond all numbers");
        const double mass = impl_->rod(i).model.mass(), omega = 2.0 * M_PI * d.frequency;
        step::Grab g;
        g.stiffness = mass * omega * omega;
        g.damping = 2.0 * mass * d.damping_ratio * omega;
        g.s = d.arc_fraction * impl_->rod(i).model.definition().length;
        g.target = vec(d.target);
        g.maxForce = d.max_force > 0.0 ? d.max_force : 1000.0 * mass;
        g.key = impl_->world.nextPart++;
        step::wake(impl_->world, static_cast<std::size_t>(i));
        impl_->rod(i).grabs.push_back(g);
        const GrabHandle made{impl_->rod(i).key, g.key, impl_->tag};
        impl_->recorder.record(Call::Grab, shell, d, made);
        return R(made);
    });
}

Outcome Shells::move(GrabHandle grab, Point target) {
    return impl_->change([&] {
        const auto found = impl_->find(grab, &step::Rod::grabs);
        if (!found.part)
            return refused(kNoSuchPart);
        if (!limits::place(target))
            return refused(limits::kTooFar);
        if (found.part->target != vec(target))
            step::wake(impl_->world, found.index);
        found.part->target = vec(target);
        impl_->recorder.record(Call::MoveGrab, grab, target);
        return done();
    });
}

Result<Reaction> Shells::reaction(GrabHandle grab) const {
    const auto found = impl_->find(grab, &step::Rod::grabs);
    if (!found.part)
        return Result<Reaction>::failure(kNoSuchPart);
    return Reaction{point(found.part->force), 0.0};
}

Outcome Shells::release(GrabHandle grab) {
    return removePart(*impl_, grab, &step::Rod::grabs, Call::ReleaseGrab);
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
        const ForceHandle made{rod.key, key, m.tag};
        m.recorder.record(once ? Call::ApplyForce : Call::AddForce, shell, arc_fraction, force, torque, made);
        return R(made);
    });
}

Result<ForceHandle> Shells::add_force(ShellHandle shell, double arc_fraction, Point force, double torque) {
    return impl_->addForce(shell, arc_fraction, force, torque, false);
}

Outcome Shells::set_force(ForceHandle handle, Point force, double torque) {
    return impl_->change([&] {
        const auto found = impl_->find(handle, &step::Rod::forces);
        if (!found.part)
            return refused(kNoSuchPart);
        if (!limits::impulse(found.rod->model, force, torque))
            return refused(limits::kTooStrong);
        step::wake(impl_->world, found.index);
        found.part->force = vec(force);
        found.part->torque = torque;
        impl_->recorder.record(Call::SetForce, handle, force, torque);
        return done();
    });
}

Outcome Shells::release(ForceHandle handle) {
    return removePart(*impl_, handle, &step::Rod::forces, Call::ReleaseForce);
}

Outcome Shells::apply_force(ShellHandle shell, double arc_fraction, Point force, double torque) {
    const auto added = impl_->addForce(shell, arc_fraction, force, torque, true);
    return added ? done() : refused(added.error());
}

Outcome Shells::apply_torque(ShellHandle shell, double arc_fraction, double torque) {
    return apply_force(shell, arc_fraction, {}, torque);
}

Outcome Shells::apply_impulse(ShellHandle shell, double arc_fraction, Point impulse, double angular_impulse) {
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
        step::kickRod(impl_->world, static_cast<std::size_t>(i), arc_fraction * impl_->rod(i).model.definition().length,
                      vec(impulse), angular_impulse);
        impl_->recorder.record(Call::ApplyImpulse, shell, arc_fraction, impulse, angular_impulse);
        return done();
    });
}

bool Shells::valid(HoldHandle handle) const {
    return impl_->find(handle, &step::Rod::holds).part != nullptr;
}
bool Shells::valid(GrabHandle handle) const {
    return impl_->find(handle, &step::Rod::grabs).part != nullptr;
}
bool Shells::valid(ForceHandle handle) const {
    return impl_->find(handle, &step::Rod::forces).part != nullptr;
}

} // namespace supercircle
