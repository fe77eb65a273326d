// Shells: what is changed after they are made.

#include "bridge/c/world.h"

using namespace supercircle::c;
using supercircle::FilterDef;
using supercircle::MaterialDef;
using supercircle::ShellHandle;

sc_status sc_shell_teleport(sc_world w, sc_shell s, sc_point position, double angle) {
    return use(w, [&](World& x) {
        const ShellHandle h = x.in(s);
        requireFinite(position, "the position");
        requireFinite(angle, "the angle");
        done(x.shells.teleport(h, in(position), angle), SC_REFUSED);
    });
}

sc_status sc_shell_set_velocity(sc_world w, sc_shell s, sc_point velocity, double spin) {
    return use(w, [&](World& x) { done(x.shells.set_velocity(x.in(s), in(velocity), spin)); });
}

sc_status sc_shell_set_material(sc_world w, sc_shell s, const sc_material* change) {
    return use(w, [&](World& x) {
        const sc_material& c = given(change, "the change");
        MaterialDef d;
        const auto set = [](std::optional<double>& to, double value) {
            if (!std::isnan(value))
                to = value;
        };
        set(d.mu, c.friction);
        set(d.young_modulus, c.young_modulus);
        set(d.density, c.density);
        set(d.damping_ratio, c.damping_ratio);
        done(x.shells.set_material(x.in(s), d));
    });
}

sc_status sc_shell_set_natural_curvature(sc_world w, sc_shell s, const double* curvature, int32_t count) {
    return use(w, [&](World& x) {
        if (count < 1 || count > 100000)
            refuse(SC_BAD_INPUT, "the count must be 1 or the number of elements");
        MaterialDef d;
        d.natural_curvature.emplace(&given(curvature, "the curvature"), curvature + count);
        done(x.shells.set_material(x.in(s), d));
    });
}

sc_status sc_shell_set_friction_material(sc_world w, sc_shell s, uint32_t material) {
    return use(w, [&](World& x) { done(x.shells.set_friction_material(x.in(s), material)); });
}

sc_status sc_shell_set_filter(sc_world w, sc_shell s, const sc_filter* filter) {
    return use(w, [&](World& x) {
        const sc_filter& f = given(filter, "the filter");
        const FilterDef d{bits16(f.category, "the category"), bits16(f.mask, "the mask"), group16(f.group)};
        done(x.shells.set_filter(x.in(s), d));
    });
}

sc_status sc_shell_filter(sc_world w, sc_shell s, sc_filter* out) {
    return use(w, [&](World& x) {
        const FilterDef f = done(x.shells.filter(x.in(s)));
        given(out, "the result") = {f.category, f.mask, f.group, 0};
    });
}

sc_status sc_shell_set_awake(sc_world w, sc_shell s, int32_t awake) {
    return use(w, [&](World& x) {
        const ShellHandle h = x.in(s);
        done(awake != 0 ? x.shells.wake(h) : x.shells.sleep(h), SC_REFUSED);
    });
}

const char* sc_shell_name(sc_world w, sc_shell s) {
    return textIn(w, [&](World& x) { return done(x.shells.name(x.in(s))); });
}

sc_status sc_shell_set_name(sc_world w, sc_shell s, const char* name) {
    return use(w, [&](World& x) { done(x.shells.set_name(x.in(s), nameOf(name, "the name"))); });
}

sc_status sc_shell_user_data(sc_world w, sc_shell s, uint64_t* out) {
    return use(w, [&](World& x) { given(out, "the result") = done(x.shells.user_data(x.in(s))); });
}

sc_status sc_shell_set_user_data(sc_world w, sc_shell s, uint64_t data) {
    return use(w, [&](World& x) { done(x.shells.set_user_data(x.in(s), data)); });
}

sc_status sc_shell_apply_force(sc_world w, sc_shell s, double arc, sc_point force, double torque) {
    return use(w, [&](World& x) { done(x.shells.apply_force(x.in(s), arc, in(force), torque)); });
}

sc_status sc_shell_apply_impulse(sc_world w, sc_shell s, double arc, sc_point impulse, double angular) {
    return use(w, [&](World& x) { done(x.shells.apply_impulse(x.in(s), arc, in(impulse), angular)); });
}
