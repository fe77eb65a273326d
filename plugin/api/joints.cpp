// Pins, welds and tethers.

#include "plugin/api/limits.h"
#include "plugin/api/snapshot_fields.h"
#include "supercircle/step/applied_forces.h"
#include "supercircle/step/carry_along.h"
#include "supercircle/step/sleep.h"
#include "supercircle/support/trig.h"

namespace supercircle {

namespace {

step::Vec2 toLocal(const step::Vec2& v, double angle) {
    const double c = math::cos(angle), s = math::sin(angle);
    return {c * v.x() + s * v.y(), -s * v.x() + c * v.y()};
}

Status checkDefinition(const JointDef& d) {
    if (d.kind != JointKind::Pin && d.kind != JointKind::Weld && d.kind != JointKind::Tether)
        return refused("a joint is a pin, a weld or a tether");
    if (!isFraction(d.arc_fraction) || !isFraction(d.other_fraction))
        return refused(kBadFraction);
    if (!limits::position(d.point))
        return refused(limits::kTooFar);
    if (!(d.length >= 0.0) || !(d.length < limits::kFarthest))
        return refused("length must not be negative (0: the present distance), and below 1e12 m");
    if (!d.other.null() && d.body != 0)
        return refused("a joint has one other end: a shell or a body, not both");
    if (d.other.null() && d.body == 0 && d.kind != JointKind::Tether)
        return refused("a pin or weld needs a shell or a body at its other end; a hold attaches a shell to the world");
    return {};
}

} // namespace

step::Link* Shells::Impl::findLink(JointHandle h) {
    if (h.null() || h.world != worldId)
        return nullptr;
    for (step::Link& l : world.links)
        if (l.key == h.generation)
            return &l;
    return nullptr;
}

void Shells::Impl::wake(const step::Link& link) {
    if (const int a = step::rodIndex(world, link.rodA); a >= 0)
        step::wake(world, static_cast<std::size_t>(a));
    if (const int b = link.end == step::LinkEnd::Rod ? step::rodIndex(world, link.rodB) : -1; b >= 0)
        step::wake(world, static_cast<std::size_t>(b));
}

Result<JointHandle> Shells::create_joint(const JointDef& d) {
    using R = Result<JointHandle>;
    return impl_->change([&] {
        if (const Status checked = checkDefinition(d); !checked)
            return R::failure(checked.error());
        const int a = impl_->find(d.shell), b = d.other.null() ? -1 : impl_->find(d.other);
        if (a < 0 || (!d.other.null() && b < 0))
            return R::failure(kNoSuchShell);
        step::BodyState body;
        if (d.body != 0 && (!impl_->port || !impl_->port->state(d.body, body)))
            return R::failure("there is no such body");
        const step::Rod& rodA = impl_->rod(a);
        const bool tether = d.kind == JointKind::Tether;
        step::Link l;
        l.kind = tether                     ? step::LinkKind::Tether
                 : d.kind == JointKind::Pin ? step::LinkKind::Pin
                                            : step::LinkKind::Weld;
        l.end = b >= 0 ? step::LinkEnd::Rod : d.body != 0 ? step::LinkEnd::Body : step::LinkEnd::World;
        l.collide = tether || d.collide_connected;
        l.rodA = rodA.key;
        l.sA = d.arc_fraction * rodA.model.definition().length;
        const rod::MaterialPoint atA = rod::locate(rodA.model, l.sA);
        const step::Vec2 pointA = rodA.kin.point(atA);
        step::Vec2 far = tether ? vec(d.point) : pointA;
        double angleB = 0.0;
        if (b >= 0) {
            const step::Rod& rodB = impl_->rod(b);
            l.rodB = rodB.key;
            l.sB = d.other_fraction * rodB.model.definition().length;
            if (a == b && l.sA == l.sB)
                return R::failure("a point of a shell cannot be joined to itself");
            const rod::MaterialPoint atB = rod::locate(rodB.model, l.sB);
            angleB = rodB.kin.angle(atB);
            if (tether)
                far = rodB.kin.point(atB);
            l.local = toLocal(far - rodB.kin.point(atB), angleB);
        } else if (d.body != 0) {
            l.body = d.body;
            angleB = body.angle;
            l.local = toLocal(far - body.centre, angleB);
        }
        l.angle = rodA.kin.angle(atA) - angleB;
        l.target.point = far;
        const double apart = (far - pointA).norm();
        l.length = l.goal = d.length > 0.0 ? d.length : apart;
        if (tether && !(l.length >= apart * (1.0 - 1e-9)))
            return R::failure("the tether is shorter than the present distance of " + std::to_string(apart) +
                              " m: make it that long, then shorten its largest length");
        if (tether && !(l.length > 0.0))
            return R::failure("a tether between two points in the same place needs a length");
        l.key = impl_->world.nextPart++;
        if (d.body != 0 && impl_->advanced == 0.0) // else the host is still at the start of the frame
            step::meetBody(impl_->world, d.body, body);
        impl_->world.links.push_back(l);
        impl_->wake(l);
        impl_->world.range.clear(); // the pair may not collide any more
        const JointHandle made{0, l.key, impl_->worldId};
        impl_->recorder.record(Call::CreateJoint, d, made);
        return R(made);
    });
}

Status Shells::set_target(JointHandle joint, const TargetDef& to) {
    return impl_->change([&] {
        step::Link* l = impl_->findLink(joint);
        if (!l)
            return refused(kNoSuchConstraint);
        if (l->end != step::LinkEnd::World)
            return refused("only tethers to the world have a target");
        if (!limits::position(to.position) || !limits::velocity(to.velocity))
            return refused("position must be finite and within 1e12 m, velocity within 1e9 m/s");
        setPendingTarget({to.position, 0.0, to.velocity, 0.0}, l->target);
        impl_->wake(*l);
        impl_->recorder.record(Call::SetJointTarget, joint, to);
        return done();
    });
}

Result<TargetDef> Shells::target(JointHandle joint) const {
    const step::Link* l = impl_->findLink(joint);
    if (!l)
        return Result<TargetDef>::failure(kNoSuchConstraint);
    if (l->end != step::LinkEnd::World)
        return Result<TargetDef>::failure("only tethers to the world have a target");
    const step::Pose p = step::poseAfter(impl_->world, l->target, 0.0);
    return TargetDef{point(p.point), 0.0, point(p.velocity), 0.0};
}

Status Shells::set_max_length(JointHandle joint, double length, double rate) {
    return impl_->change([&] {
        step::Link* l = impl_->findLink(joint);
        if (!l)
            return refused(kNoSuchConstraint);
        if (l->kind != step::LinkKind::Tether)
            return refused("only tethers have a length");
        if (!(length > 0.0) || !(length < limits::kFarthest) || !(rate > 0.0) || !(rate < limits::kFastest))
            return refused("length and rate must be positive, and below 1e12 m and 1e9 m/s");
        l->goal = length;
        l->reel = rate;
        impl_->wake(*l);
        impl_->recorder.record(Call::SetMaxLength, joint, length, rate);
        return done();
    });
}

Status Shells::set_max_force(JointHandle joint, double force) {
    return impl_->change([&] {
        step::Link* l = impl_->findLink(joint);
        if (!l)
            return refused(kNoSuchConstraint);
        if (!(force >= 0.0) || !std::isfinite(force))
            return refused("the largest force must be finite and not negative (0: any)");
        l->maxForce = force;
        impl_->recorder.record(Call::SetJointMaxForce, joint, force);
        return done();
    });
}

Result<double> Shells::length(JointHandle joint) const {
    const step::Link* l = impl_->findLink(joint);
    if (!l)
        return Result<double>::failure(kNoSuchConstraint);
    if (l->kind != step::LinkKind::Tether)
        return Result<double>::failure("only tethers have a length");
    return l->length;
}

Result<Reaction> Shells::reaction(JointHandle joint) const {
    const step::Link* l = impl_->findLink(joint);
    if (!l)
        return Result<Reaction>::failure(kNoSuchConstraint);
    return Reaction{point(l->force), l->torque};
}

Status Shells::destroy(JointHandle joint) {
    return impl_->change([&] {
        step::Link* l = impl_->findLink(joint);
        if (!l)
            return refused(kNoSuchConstraint);
        impl_->wake(*l);
        impl_->world.links.erase(impl_->world.links.begin() + (l - impl_->world.links.data()));
        impl_->world.range.clear(); // the pair may collide again
        impl_->recorder.record(Call::DestroyJoint, joint);
        return done();
    });
}

bool Shells::valid(JointHandle handle) const {
    return impl_->findLink(handle) != nullptr;
}

} // namespace supercircle
