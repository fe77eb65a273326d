// Queries and zones.

#include "bridge/c/world.h"

using namespace supercircle::c;
using supercircle::Box;
using supercircle::ClosestPoint;
using supercircle::RayHit;
using supercircle::ShellHandle;

namespace {

int32_t copyShells(World& x, const std::vector<ShellHandle>& found, sc_shell* out, int32_t capacity) {
    return copyOut(found, out, capacity, [&](const ShellHandle& h) { return x.out(h); });
}

} // namespace

int32_t sc_ray_cast(sc_world w, sc_point from, sc_point to, uint32_t mask, sc_hit* result, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(result, capacity);
        const auto hits = x.shells.ray_cast_all(in(from), in(to), bits16(mask, "the mask"));
        return copyOut(done(hits), result, capacity, [&](const RayHit& h) {
            return sc_hit{x.out(h.shell), out(h.point), out(h.normal), h.fraction, h.arc_fraction, 0.0};
        });
    });
}

sc_status sc_closest_point(sc_world w, sc_shell only, sc_point to, double max_distance, uint32_t mask, sc_hit* result) {
    return use(w, [&](World& x) {
        given(result, "the result");
        requireFinite(to, "the point");
        if (!(max_distance >= 0.0))
            refuse(SC_BAD_INPUT, "the largest distance must be 0 or more, or infinite");
        const auto found = only.id != 0 ? x.shells.closest_point(x.in(only), in(to))
                                        : x.shells.closest_point(in(to), max_distance, bits16(mask, "the mask"));
        const ClosestPoint& p = done(found, SC_REFUSED);
        *result = {x.out(p.shell), out(p.point), out(p.normal), 0.0, p.arc_fraction, p.distance};
    });
}

int32_t sc_overlap_point(sc_world w, sc_point at, uint32_t mask, sc_shell* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        const auto found = x.shells.overlap_point(in(at), bits16(mask, "the mask"));
        return copyShells(x, done(found), out, capacity);
    });
}

int32_t sc_overlap_box(sc_world w, sc_point lower, sc_point upper, uint32_t mask, sc_shell* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        const auto found = x.shells.overlap_box({in(lower), in(upper)}, bits16(mask, "the mask"));
        return copyShells(x, done(found), out, capacity);
    });
}

int32_t sc_overlap_circle(sc_world w, sc_point centre, double radius, uint32_t mask, sc_shell* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        const auto found = x.shells.overlap_circle(in(centre), radius, bits16(mask, "the mask"));
        return copyShells(x, done(found), out, capacity);
    });
}

sc_status sc_zone_create(sc_world w, sc_point lower, sc_point upper, sc_zone* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        Zone zone;
        zone.box = Box{in(lower), in(upper)};
        done(x.shells.overlap_box(zone.box)); // refuses a box that is none; who is in it enters at the next step
        const std::uint64_t id = x.zones.add(std::move(zone));
        if (id == 0)
            refuse(SC_REFUSED, "there are a million zones already");
        *out = {id};
    });
}

int32_t sc_zone_valid(sc_world w, sc_zone z) {
    return validIn(w, [&](World& x) { return x.zones.find(z.id) != nullptr; });
}

int32_t sc_zone_shells(sc_world w, sc_zone z, sc_shell* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        const Zone* zone = x.zones.find(z.id);
        if (zone == nullptr)
            refuse(SC_STALE, "the zone handle is null or stale");
        return copyShells(x, zone->inside, out, capacity);
    });
}

sc_status sc_zone_destroy(sc_world w, sc_zone z) {
    return use(w, [&](World& x) {
        if (x.zones.find(z.id) == nullptr)
            refuse(SC_STALE, "the zone handle is null or stale");
        x.zones.remove(z.id);
    });
}
