// Events of the last step in one list, in the order of time.

#include "bridge/c/world.h"

#include <algorithm>

using namespace supercircle::c;
using supercircle::ContactPoint;
using supercircle::EventSettings;
using supercircle::FrameEvents;

namespace {

sc_event event(int kind, double time) {
    sc_event e{};
    e.kind = kind;
    e.time = time;
    return e;
}

class Collector {
public:
    explicit Collector(World& w) : w_(w) {}

    std::vector<sc_event> all() {
        const FrameEvents& f = w_.shells.events();
        addContacts(f);
        addSnaps(f);
        addFaults(f);
        list_.insert(list_.end(), w_.zoneEvents.begin(), w_.zoneEvents.end());
        std::stable_sort(list_.begin(), list_.end(),
                         [](const sc_event& a, const sc_event& b) { return a.time < b.time; });
        return std::move(list_);
    }

private:
    sc_event& at(int kind, double time, const ContactPoint& p) {
        sc_event& e = list_.emplace_back(event(kind, time));
        e.a = w_.out(p.a);
        e.b = w_.out(p.b);
        e.body = w_.outBody(p.body);
        e.arc_a = p.fraction_a;
        e.arc_b = p.fraction_b;
        e.point = out(p.point);
        e.normal = out(p.normal);
        return e;
    }
    void addContacts(const FrameEvents& f) {
        for (const auto& c : f.contact_begin)
            at(SC_CONTACT_BEGIN, c.time, c.at).approach_speed = c.approach_speed;
        for (const auto& c : f.contact_end)
            at(SC_CONTACT_END, c.time, c.at);
        for (const auto& i : f.impulses) {
            sc_event& e = at(SC_IMPULSE, i.time, i.at);
            e.normal_impulse = i.normal_impulse;
            e.friction_impulse = i.friction_impulse;
            e.peak_force = i.peak_force;
        }
    }
    void addSnaps(const FrameEvents& f) {
        for (const auto& s : f.snap_begin) {
            sc_event& e = list_.emplace_back(event(SC_SNAP_BEGIN, s.time));
            e.a = w_.out(s.shell);
            e.energy_released = s.energy_before - s.energy;
        }
        for (const auto& s : f.snap_end) {
            sc_event& e = list_.emplace_back(event(SC_SNAP_END, s.time));
            e.a = w_.out(s.shell);
            e.energy_released = s.energy_released;
            e.kinetic_peak = s.kinetic_peak;
        }
    }
    void addFaults(const FrameEvents& f) {
        for (const auto& q : f.quarantined) {
            sc_event& e = list_.emplace_back(event(SC_QUARANTINED, q.time));
            e.a = w_.out(q.shell);
            e.reason = static_cast<int32_t>(q.reason);
        }
        for (const auto& c : f.crushed) {
            sc_event& e = list_.emplace_back(event(SC_CRUSHED, c.time));
            e.a = w_.out(c.shell);
            e.body = w_.outBody(c.body);
            e.hold = w_.out(c.hold);
        }
        for (const auto& b : f.broke) {
            sc_event& e = list_.emplace_back(event(SC_BROKE, b.time));
            e.a = w_.out(b.shell);
            e.hold = w_.out(b.hold);
            e.joint = w_.out(b.joint);
            e.force = out(b.force);
        }
        for (const auto& o : f.overlapping) {
            sc_event& e = list_.emplace_back(event(SC_OVERLAP, o.time));
            e.a = w_.out(o.a);
            e.b = w_.out(o.b);
            e.body = w_.outBody(o.body);
        }
        for (const auto& h : f.hold_blocked) {
            sc_event& e = list_.emplace_back(event(SC_HOLD_BLOCKED, h.time));
            e.a = w_.out(h.shell);
            e.hold = w_.out(h.hold);
            e.body = w_.outBody(h.body);
            e.reason = h.stopped ? 1 : 0;
        }
    }

    World& w_;
    std::vector<sc_event> list_;
};

} // namespace

int32_t sc_world_events(sc_world w, sc_event* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        return copyOut(Collector(x).all(), out, capacity, [](const sc_event& e) { return e; });
    });
}

sc_status sc_world_set_event_settings(sc_world w, const sc_event_settings* to) {
    return use(w, [&](World& x) {
        const sc_event_settings& s = given(to, "the settings");
        done(x.shells.set_event_settings({s.impulse_threshold, s.snap_energy, s.snap_time}));
    });
}

sc_status sc_world_event_settings(sc_world w, sc_event_settings* out) {
    return use(w, [&](World& x) {
        const EventSettings& s = x.shells.event_settings();
        given(out, "the result") = {s.impulse_threshold, s.snap_energy, s.snap_time};
    });
}
