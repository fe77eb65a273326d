// Worlds: making, settings, and what is read of them as a whole.

#include "bridge/c/world.h"

using namespace supercircle::c;
using supercircle::CrushPolicy;
using supercircle::EnergyBalance;
using supercircle::Point;
using supercircle::Quality;
using supercircle::Recovery;
using supercircle::RecoverySettings;
using supercircle::SleepSettings;

void sc_world_def_init(sc_world_def* def) {
    if (def == nullptr)
        return;
    *def = {};
    def->size = sizeof *def;
    def->threads = 1;
    def->velocity_iterations = 8;
    def->position_iterations = 3;
    def->gravity = {0.0, -9.81};
    def->units_per_metre = 1.0;
}

sc_status sc_world_create(const sc_world_def* def, sc_world* out) {
    return shielded([&] { given(out, "the result") = enlist(def, nullptr); });
}

sc_status sc_world_destroy(sc_world w) {
    return shielded([&] { strike(w); });
}

int32_t sc_world_valid(sc_world w) {
    return validIn(w, [](World&) { return true; });
}

sc_status sc_world_set_quality(sc_world w, int32_t quality) {
    return use(w, [&](World& x) {
        requireChoice(quality, 2, "quality");
        done(x.shells.set_quality(static_cast<Quality>(quality)));
    });
}

int32_t sc_world_quality(sc_world w) {
    return countIn(w, [&](World& x) { return static_cast<int32_t>(x.shells.quality()); });
}

sc_status sc_world_set_frame_budget(sc_world w, uint64_t work) {
    return use(w, [&](World& x) { done(x.shells.set_frame_budget(work), SC_REFUSED); });
}

sc_status sc_world_set_crush_policy(sc_world w, int32_t policy) {
    return use(w, [&](World& x) {
        requireChoice(policy, 3, "policy");
        done(x.shells.set_crush_policy(static_cast<CrushPolicy>(policy)));
    });
}

sc_status sc_world_set_recovery(sc_world w, const sc_recovery* to) {
    return use(w, [&](World& x) {
        const sc_recovery& r = given(to, "the settings");
        done(x.shells.set_recovery({r.release != 0 ? Recovery::Release : Recovery::Stay, r.after}));
    });
}

sc_status sc_world_recovery(sc_world w, sc_recovery* out) {
    return use(w, [&](World& x) {
        const RecoverySettings r = x.shells.recovery();
        given(out, "the result") = {r.policy == Recovery::Release ? 1 : 0, 0, r.after};
    });
}

sc_status sc_world_set_threads(sc_world w, int32_t threads) {
    return use(w, [&](World& x) { done(x.shells.set_threads(threads)); });
}

sc_status sc_world_set_gravity(sc_world w, sc_point gravity) {
    return use(w, [&](World& x) {
        requireFinite(gravity, "gravity");
        if (std::abs(gravity.x) > 1e6 || std::abs(gravity.y) > 1e6)
            refuse(SC_BAD_INPUT, "gravity is above 1e6 m/s^2");
        x.box2d->SetGravity({static_cast<float>(gravity.x * x.scale), static_cast<float>(gravity.y * x.scale)});
    });
}

sc_status sc_world_gravity(sc_world w, sc_point* out) {
    return use(w, [&](World& x) {
        const b2Vec2 g = x.box2d->GetGravity();
        given(out, "the result") = {static_cast<double>(g.x) / x.scale, static_cast<double>(g.y) / x.scale};
    });
}

sc_status sc_world_set_sleep(sc_world w, const sc_sleep* to) {
    return use(w, [&](World& x) {
        const sc_sleep& s = given(to, "the settings");
        done(x.shells.set_sleep({s.automatic != 0, s.drift, s.delay}));
    });
}

sc_status sc_world_sleep(sc_world w, sc_sleep* out) {
    return use(w, [&](World& x) {
        const SleepSettings s = x.shells.sleep_settings();
        given(out, "the result") = {s.automatic ? 1 : 0, 0, s.drift, s.delay};
    });
}

sc_status sc_world_set_friction(sc_world w, uint32_t a, uint32_t b, double friction) {
    return use(w, [&](World& x) {
        requireFinite(friction, "the friction coefficient");
        done(friction < 0.0 ? x.shells.reset_friction(a, b) : x.shells.set_friction(a, b, friction));
    });
}

sc_status sc_world_shift_origin(sc_world w, sc_point origin) {
    return use(w, [&](World& x) { done(x.shells.shift_origin(in(origin))); });
}

double sc_world_time(sc_world w) {
    return valueIn(w, std::nan(""), [](World& x) { return x.shells.time(); });
}

uint64_t sc_world_hash(sc_world w) {
    return valueIn(w, uint64_t{0}, [](World& x) { return x.shells.hash(); });
}

sc_status sc_world_energy(sc_world w, sc_energy* out) {
    return use(w, [&](World& x) {
        const EnergyBalance e = x.shells.energy_balance();
        given(out, "the result") = {e.kinetic,   e.bending,   e.gravity,
                                    e.added,     e.work,      e.friction,
                                    e.impact,    e.numerical, e.position_correction,
                                    e.injected,  e.effects,   e.damping,
                                    e.to_bodies, e.residual};
    });
}

int32_t sc_world_shells(sc_world w, sc_shell* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        return copyOut(x.shells.shells(), out, capacity, [&](const auto& h) { return x.out(h); });
    });
}

sc_status sc_world_find_shell(sc_world w, const char* name, sc_shell* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        const std::string wanted = nameOf(name, "the name");
        const supercircle::ShellHandle found = x.shells.find(wanted);
        if (found.null())
            refuse(SC_BAD_INPUT, "there is no shell called \"" + wanted + "\"");
        *out = x.out(found);
    });
}
