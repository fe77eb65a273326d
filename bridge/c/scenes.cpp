// Scenes and fragments of scenes.

#include "bridge/box2d/box2d_port.h"
#include "bridge/c/include/supercircle_box2d.h"
#include "bridge/c/scene_text.h"
#include "bridge/c/world.h"
#include "supercircle/step/world.h"

using namespace supercircle::c;
using supercircle::SceneOptions;
using supercircle::ScenePlayer;
using supercircle::ShellHandle;
namespace scene = supercircle::scene;

namespace {

/// A world is found by its scene's handle.
struct InScene {
    explicit InScene(sc_scene s) : world(worldSlot(s.id), 0), played(world->scenes.find(s.id)) {
        if (played == nullptr)
            refuse(SC_STALE, "the scene handle is null or stale");
    }
    Inside world;
    PlayedScene* played;
};

template <class R, class F>
R valueOf(sc_scene s, R otherwise, F&& work) noexcept {
    return valued(otherwise, [&] {
        InScene in(s);
        R out = otherwise;
        inside(in.world, [&](World& x) { out = work(x, *in.played); });
        return out;
    });
}
template <class F>
const char* textOfScene(sc_scene s, F&& work) noexcept {
    return text([&] {
        InScene in(s);
        return std::string(work(*in.played));
    });
}

void refuseWhole(const scene::Scene& s) {
    const char* what = s.drop ? "drop" : s.protocol ? "protocol" : s.game ? "game" : nullptr;
    if (what != nullptr)
        refuse(SC_BAD_INPUT,
               std::string("a fragment has no \"") + what + "\"; sc_scene_load plays whole scenes, leave it out here");
    if (!s.loads.empty() || s.starts_at_rest)
        refuse(SC_BAD_INPUT, "a fragment has neither \"load\" nor \"start\"; use sc_force_create");
}

/// Creates what a fragment has; the shells made so far are appended. Bodies come last: they are not taken back.
void populate(World& x, const scene::Scene& s, std::vector<ShellHandle>& made) {
    for (const supercircle::ShellDef& d : s.shells) {
        const auto shell = x.shells.create(d);
        if (!shell)
            refuse(SC_BAD_INPUT, "shell \"" + d.name + "\": " + shell.error());
        made.push_back(*shell);
        supercircle::step::setEffectSettings(x.shells.world(), x.shells.size() - 1,
                                             supercircle::effects::settingsFor(s.effects, d.name));
    }
    for (const supercircle::HoldDef& h : s.holds)
        for (std::size_t i = 0; i < s.shells.size(); ++i)
            if (s.shells[i].name == h.shell) {
                const auto hold = x.shells.create_hold(made[i], h.arc_fraction, h.kind, h.base);
                if (!hold)
                    refuse(SC_BAD_INPUT, "hold on \"" + h.shell + "\": " + hold.error());
                break;
            }
    supercircle::step::RigidWorldDefinition rigid = s.rigid;
    rigid.gravity = x.attachment->gravity();
    if (const std::string why = x.attachment->build(rigid); !why.empty())
        refuse(SC_BAD_INPUT, why);
}

} // namespace

sc_status sc_world_add(sc_world w, const char* json, int32_t bytes) {
    return use(w, [&](World& x) {
        x.requireUnlocked();
        supercircle::FrameReport report;
        const scene::Scene s = readScene(textOf(json, bytes, "the scene"), "fragment", {}, &report.note, x.scale);
        refuseWhole(s);
        std::vector<ShellHandle> made;
        try {
            populate(x, s, made);
        } catch (const Refusal& e) {
            for (const ShellHandle& h : made)
                (void)x.shells.destroy(h);
            throw Refusal(e.status, e.why);
        }
        x.report = reportJson(report);
    });
}

const char* sc_scene_check(const char* json, int32_t bytes, const char* file) {
    return text([&] { return problemsJson(textOf(json, bytes, "the scene"), fileName(file)); });
}

sc_status sc_scene_world_def(const char* json, int32_t bytes, sc_world_def* def) {
    return shielded([&] {
        (void)versioned(def, sc_world_def_init, sizeof(sc_world_def), "sc_world_def_init");
        const scene::Scene s = readScene(textOf(json, bytes, "the scene"), "scene");
        def->gravity = {s.rigid.gravity.x(), s.rigid.gravity.y()};
        def->units_per_metre = s.rigid.lengthScale;
    });
}

sc_status sc_scene_load(sc_world w, const char* json, int32_t bytes, const char* file, const char* parameters,
                        uint64_t seed, sc_scene* out) {
    return use(w, [&](World& x) {
        given(out, "the result");
        x.requireUnlocked();
        const std::string text = textOf(json, bytes, "the scene"), name = fileName(file);
        SceneOptions options;
        options.parameters = parametersOf(parameters);
        options.seed = seed;
        PlayedScene played;
        supercircle::FrameReport report;
        played.parameters = parametersJson(readScene(text, name, options.parameters, &report.note));
        const auto player = supercircle::load_scene_text(text, name, x.shells, options);
        played.player = std::make_shared<ScenePlayer>(done(player));
        const std::uint64_t id = x.scenes.add(std::move(played));
        if (id == 0)
            refuse(SC_REFUSED, "there are a million scenes already");
        x.report = reportJson(report);
        *out = {id};
    });
}

int32_t sc_scene_valid(sc_scene s) {
    return valueOf(s, int32_t{0}, [](World&, PlayedScene&) { return int32_t{1}; });
}

sc_status sc_scene_step(sc_scene s, double dt, sc_frame* out) {
    return shielded([&] {
        InScene in(s);
        inside(in.world, [&](World& x) {
            sc_frame frame{};
            step(x, dt, out != nullptr ? *out : frame, in.played->player.get());
        });
    });
}

sc_status sc_scene_pre_step(sc_scene s, double dt, sc_frame* out) {
    return shielded([&] {
        InScene in(s);
        inside(in.world, [&](World& x) {
            sc_frame frame{};
            preStep(x, dt, out != nullptr ? *out : frame, in.played->player.get());
        });
    });
}

int32_t sc_scene_finished(sc_scene s) {
    return counted([&] { return InScene(s).played->player->finished() ? 1 : 0; });
}

const char* sc_scene_phase(sc_scene s) {
    return textOfScene(s, [](PlayedScene& p) { return p.player->phase(); });
}

const char* sc_scene_name(sc_scene s) {
    return textOfScene(s, [](PlayedScene& p) { return p.player->name(); });
}

const char* sc_scene_parameters(sc_scene s) {
    return textOfScene(s, [](PlayedScene& p) { return p.parameters; });
}

int32_t sc_scene_shells(sc_scene s, sc_shell* out, int32_t capacity) {
    return counted([&] {
        requireBuffer(out, capacity);
        InScene in(s);
        std::vector<ShellHandle> alive;
        for (const ShellHandle& h : in.played->player->shells())
            if (in.world->shells.valid(h))
                alive.push_back(h);
        return copyOut(alive, out, capacity, [&](const ShellHandle& h) { return in.world->out(h); });
    });
}

double sc_scene_travel(sc_scene s) {
    return valueOf(s, std::nan(""), [](World&, PlayedScene& p) { return p.player->travel(); });
}

double sc_scene_force(sc_scene s) {
    return valueOf(s, std::nan(""), [](World&, PlayedScene& p) { return p.player->force(); });
}

sc_status sc_scene_destroy(sc_scene s) {
    return shielded([&] {
        InScene in(s);
        in.world->scenes.remove(s.id);
    });
}
