// Shells: making, pose, state.

#include "bridge/c/world.h"
#include "supercircle/step/world.h"
#include "supercircle/support/elementary.h"

#include <algorithm>

using namespace supercircle::c;
using supercircle::ShellDef;
using supercircle::ShellHandle;
using supercircle::ShellPose;
using supercircle::ShellSection;
using supercircle::ShellState;

namespace {

constexpr int32_t kMostElements = 100000;

std::vector<double> numbers(const double* first, int32_t count, const char* what) {
    if (first == nullptr && count == 0)
        return {};
    if (count < 0 || count > kMostElements || first == nullptr)
        refuse(SC_BAD_INPUT, std::string(what) + ": null, or the count is negative or above 100000");
    return {first, first + count};
}

/// One curvature for all elements stands for as many.
std::vector<double> curvatures(const double* first, int32_t count, int32_t elements) {
    std::vector<double> out = numbers(first, count, "the natural curvature");
    if (count == 1 && elements > 1 && elements <= kMostElements)
        out.assign(static_cast<std::size_t>(elements), out.front());
    return out;
}

ShellDef definition(const sc_shell_def* def) {
    const sc_shell_def d = versioned(def, sc_shell_def_init, sizeof(sc_shell_def), "sc_shell_def_init");
    if (d.elements > kMostElements)
        refuse(SC_BAD_INPUT, "a shell has at most 100000 elements");
    ShellDef out;
    out.elements = d.elements;
    out.closed = d.closed != 0;
    out.position = in(d.position);
    out.angle = d.angle;
    out.phi_bar = d.opening;
    out.radius = d.radius;
    out.length = d.length;
    out.thickness = d.thickness;
    out.width = d.width;
    out.density = d.density;
    out.young_modulus = d.young_modulus;
    out.mu = d.friction;
    out.damping_ratio = d.damping_ratio;
    out.tip_refinement = d.tip_refinement;
    out.velocity = in(d.velocity);
    out.spin = d.spin;
    out.user_data = d.user_data;
    out.category = bits16(d.category, "the category");
    out.mask = bits16(d.mask, "the mask");
    out.group = group16(d.group);
    out.friction_material = d.material;
    return out;
}

/// Chords that keep an arc within the tolerance, as Shells::draw has them.
int chords(double curvature, double length, double tolerance) {
    const double angle = std::abs(curvature) * length;
    if (!(angle > 0.0))
        return 1;
    const double half = supercircle::math::acos(std::clamp(1.0 - tolerance * std::abs(curvature), 0.0, 1.0));
    return static_cast<int>(std::clamp(std::ceil(0.5 * angle / std::max(half, 1e-9)), 1.0, 4096.0));
}

/// What a definition begins with.
void fill(sc_shell_def& def, const ShellDef& d) {
    def = {};
    def.size = sizeof def;
    def.elements = d.elements;
    def.opening = d.phi_bar;
    def.radius = d.radius;
    def.thickness = d.thickness;
    def.width = d.width;
    def.density = d.density;
    def.young_modulus = d.young_modulus;
    def.friction = d.mu;
    def.damping_ratio = d.damping_ratio;
    def.tip_refinement = d.tip_refinement;
    def.category = d.category;
    def.mask = d.mask;
}

} // namespace

void sc_shell_def_init(sc_shell_def* def) {
    if (def != nullptr)
        fill(*def, ShellDef{});
}

sc_status sc_shell_def_scaled_init(sc_shell_def* def, double radius, double mass, double opening, double stiffness) {
    return shielded([&] {
        given(def, "the definition");
        for (const auto& [number, what] :
             {std::pair{radius, "the radius"}, {mass, "the mass"}, {stiffness, "the stiffness"}})
            if (!(number > 0.0 && std::isfinite(number)))
                refuse(SC_BAD_INPUT, std::string(what) + " must be a finite number above 0");
        if (!(opening > 0.0 && opening <= 1.0))
            refuse(SC_BAD_INPUT, "the opening (angle / 2 pi) must be above 0 and at most 1");
        fill(*def, supercircle::scaled_shell(radius, mass, opening, stiffness));
    });
}

sc_status sc_shell_create_bent(sc_world w, const sc_shell_def* def, const char* name, const double* natural_curvature,
                               int32_t count, const double* curvature, int32_t curvature_count, sc_shell* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        ShellDef d = definition(def);
        if (name != nullptr)
            d.name = nameOf(name, "the name");
        d.natural_curvature = curvatures(natural_curvature, count, d.elements);
        d.curvature = numbers(curvature, curvature_count, "the curvature");
        *out = x.out(done(x.shells.create(d)));
    });
}

sc_status sc_shell_create(sc_world w, const sc_shell_def* def, const char* name, const double* natural_curvature,
                          int32_t count, sc_shell* out) {
    return sc_shell_create_bent(w, def, name, natural_curvature, count, nullptr, 0, out);
}

int32_t sc_shell_fits(sc_world w, const sc_shell_def* def) {
    return countIn(w, [&](World& x) { return done(x.shells.fits(definition(def))) ? 1 : 0; });
}

sc_status sc_shell_destroy(sc_world w, sc_shell s) {
    return use(w, [&](World& x) { done(x.shells.destroy(x.in(s)), SC_REFUSED); });
}

int32_t sc_shell_valid(sc_world w, sc_shell s) {
    return validIn(w, [&](World& x) {
        const ShellHandle* h = x.shellNames.find(s.id);
        return h != nullptr && x.shells.valid(*h);
    });
}

int32_t sc_shell_curvatures(sc_world w, sc_shell s, double alpha, sc_target* first_end, double* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        requireFinite(alpha, "alpha");
        const ShellHandle h = x.in(s);
        const auto pose = alpha == 1.0 ? x.shells.pose(h) : x.shells.pose(h, alpha);
        const ShellPose& p = done(pose);
        if (first_end != nullptr) {
            const auto end = x.shells.section(h, 0.0);
            const ShellSection& moving = done(end);
            *first_end = {{p.start.x, p.start.y}, p.angle, {moving.velocity.x, moving.velocity.y}, moving.spin};
        }
        return copyOut(p.curvature, out, capacity, [](double k) { return k; });
    });
}

int32_t sc_shell_polyline(sc_world w, sc_shell s, double tolerance, sc_point* out, int32_t capacity) {
    return countIn(w, [&](World& x) {
        requireBuffer(out, capacity);
        if (!(tolerance > 0.0 && std::isfinite(tolerance)))
            refuse(SC_BAD_INPUT, "the tolerance must be a positive number of metres");
        const ShellHandle h = x.in(s);
        const std::vector<ShellHandle> order = x.shells.shells(); // that of the rods
        const auto index = static_cast<std::size_t>(std::find(order.begin(), order.end(), h) - order.begin());
        int32_t n = 0;
        const auto add = [&](const supercircle::rod::Vec2& p) {
            if (n < capacity)
                out[n] = {p.x(), p.y()};
            ++n;
        };
        for (const supercircle::rod::Arc& arc : x.shells.world().rods[index].kin.arcs()) {
            if (n == 0)
                add(arc.pointAt(0.0));
            const int pieces = chords(arc.curvature, arc.length, tolerance);
            for (int i = 1; i <= pieces; ++i)
                add(arc.pointAt(arc.length * i / pieces));
        }
        return n;
    });
}

sc_status sc_shell_state_of(sc_world w, sc_shell s, sc_shell_state* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        const ShellHandle h = x.in(s);
        const auto state = x.shells.state(h);
        const ShellState& m = done(state);
        const bool asleep = done(x.shells.asleep(h));
        *out = {m.length,
                m.mass,
                {m.centre.x, m.centre.y},
                {m.momentum.x, m.momentum.y},
                m.angular_momentum,
                m.kinetic_energy,
                m.stored_energy,
                m.max_surface_strain,
                {m.box.lower.x, m.box.lower.y},
                {m.box.upper.x, m.box.upper.y},
                m.quarantined ? 1 : 0,
                asleep ? 1 : 0};
    });
}

sc_status sc_shell_section(sc_world w, sc_shell s, double arc, sc_section* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        const auto section = x.shells.section(x.in(s), arc);
        const ShellSection& c = done(section);
        *out = {{c.position.x, c.position.y},
                {c.tangent.x, c.tangent.y},
                c.angle,
                {c.velocity.x, c.velocity.y},
                c.spin,
                c.curvature,
                c.natural_curvature,
                c.bending_moment,
                c.surface_strain,
                c.energy_density};
    });
}
