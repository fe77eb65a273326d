// Holds, joints and lasting forces.

#include "bridge/c/world.h"

using namespace supercircle::c;
using supercircle::HoldBase;
using supercircle::HoldHandle;
using supercircle::HoldKind;
using supercircle::JointDef;
using supercircle::JointKind;
using supercircle::TargetDef;

namespace {

TargetDef targetOf(const sc_target* to) {
    const sc_target& t = given(to, "the target");
    return {in(t.position), t.angle, in(t.velocity), t.spin};
}

sc_target targetOut(const TargetDef& t) {
    return {out(t.position), t.angle, out(t.velocity), t.spin};
}

/// Valid in the tables of C and in the library.
template <class Handle>
bool lives(World& x, Names<Handle>& names, std::uint64_t id) {
    const Handle* h = names.find(id);
    return h != nullptr && x.shells.valid(*h);
}

} // namespace

sc_status sc_hold_create(sc_world w, sc_shell s, double arc, int32_t kind, int32_t base, sc_hold* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        requireChoice(kind, 2, "the kind of a hold");
        requireChoice(base, 2, "the base of a hold");
        *out =
            x.out(done(x.shells.create_hold(x.in(s), arc, static_cast<HoldKind>(kind), static_cast<HoldBase>(base))));
    });
}

int32_t sc_hold_valid(sc_world w, sc_hold h) {
    return validIn(w, [&](World& x) { return lives(x, x.holdNames, h.id); });
}

sc_status sc_hold_set_target(sc_world w, sc_hold h, const sc_target* to) {
    return use(w, [&](World& x) { done(x.shells.set_target(x.in(h), targetOf(to))); });
}

sc_status sc_hold_target(sc_world w, sc_hold h, sc_target* out) {
    return use(w, [&](World& x) { given(out, "the result") = targetOut(done(x.shells.target(x.in(h)))); });
}

sc_status sc_hold_reaction(sc_world w, sc_hold h, sc_reaction* result) {
    return use(w, [&](World& x) { given(result, "the result") = out(done(x.shells.reaction(x.in(h)))); });
}

sc_status sc_hold_set_max_force(sc_world w, sc_hold h, double force) {
    return use(w, [&](World& x) { done(x.shells.set_max_force(x.in(h), force)); });
}

sc_status sc_hold_destroy(sc_world w, sc_hold h) {
    return use(w, [&](World& x) { done(x.shells.destroy(x.in(h)), SC_REFUSED); });
}

void sc_joint_def_init(sc_joint_def* def) {
    if (def == nullptr)
        return;
    *def = {};
    def->size = sizeof *def;
    def->kind = SC_JOINT_WELD;
    def->arc_fraction = 0.5;
    def->other_fraction = 0.5;
}

sc_status sc_joint_create(sc_world w, const sc_joint_def* def, sc_joint* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        const sc_joint_def d = versioned(def, sc_joint_def_init, sizeof(sc_joint_def), "sc_joint_def_init");
        requireChoice(d.kind, 3, "the kind of a joint");
        JointDef j;
        j.kind = static_cast<JointKind>(d.kind);
        j.shell = x.in(d.shell);
        j.arc_fraction = d.arc_fraction;
        if (d.other.id != 0)
            j.other = x.in(d.other);
        j.other_fraction = d.other_fraction;
        j.body = d.body.id != 0 ? x.idOf(d.body) : 0;
        j.point = in(d.point);
        j.length = d.length;
        j.collide_connected = d.collide_connected != 0;
        *out = x.out(done(x.shells.create_joint(j)));
    });
}

int32_t sc_joint_valid(sc_world w, sc_joint j) {
    return validIn(w, [&](World& x) { return lives(x, x.jointNames, j.id); });
}

sc_status sc_joint_set_target(sc_world w, sc_joint j, const sc_target* to) {
    return use(w, [&](World& x) { done(x.shells.set_target(x.in(j), targetOf(to))); });
}

sc_status sc_joint_target(sc_world w, sc_joint j, sc_target* out) {
    return use(w, [&](World& x) { given(out, "the result") = targetOut(done(x.shells.target(x.in(j)))); });
}

sc_status sc_joint_set_max_length(sc_world w, sc_joint j, double length, double rate) {
    return use(w, [&](World& x) { done(x.shells.set_max_length(x.in(j), length, rate)); });
}

double sc_joint_length(sc_world w, sc_joint j) {
    return valueIn(w, std::nan(""), [&](World& x) { return done(x.shells.length(x.in(j))); });
}

sc_status sc_joint_reaction(sc_world w, sc_joint j, sc_reaction* result) {
    return use(w, [&](World& x) { given(result, "the result") = out(done(x.shells.reaction(x.in(j)))); });
}

sc_status sc_joint_set_max_force(sc_world w, sc_joint j, double force) {
    return use(w, [&](World& x) { done(x.shells.set_max_force(x.in(j), force)); });
}

sc_status sc_joint_destroy(sc_world w, sc_joint j) {
    return use(w, [&](World& x) { done(x.shells.destroy(x.in(j)), SC_REFUSED); });
}

sc_status sc_force_create(sc_world w, sc_shell s, double arc, sc_point force, double torque, sc_force* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        *out = x.out(done(x.shells.create_force(x.in(s), arc, in(force), torque)));
    });
}

int32_t sc_force_valid(sc_world w, sc_force f) {
    return validIn(w, [&](World& x) { return lives(x, x.forceNames, f.id); });
}

sc_status sc_force_set(sc_world w, sc_force f, sc_point force, double torque) {
    return use(w, [&](World& x) { done(x.shells.set_force(x.in(f), in(force), torque)); });
}

sc_status sc_force_destroy(sc_world w, sc_force f) {
    return use(w, [&](World& x) { done(x.shells.destroy(x.in(f)), SC_REFUSED); });
}
