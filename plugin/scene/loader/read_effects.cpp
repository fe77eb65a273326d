#include "plugin/scene/loader/sections.h"
#include "supercircle/support/names.h"

#include <algorithm>

namespace supercircle::scene {

namespace {

/// One entry of "effects"; false after a report.
bool readEffect(Context& context, const ArrayItem& place, const Scene& scene, effects::Setting& out) {
    ObjectReader reader(context, place.node, place.pointer);
    const std::size_t start = context.errors();
    std::vector<std::string> names;
    for (const effects::Effect& e : effects::catalog())
        names.push_back(e.name);
    if (!reader.require("key", "the name of an effect"))
        return false;
    const std::size_t index = reader.choice("key", names, names.size());
    if (index >= names.size())
        return false;
    const effects::Effect& effect = effects::catalog()[index];
    if (effects::actsOnMechanisms(effect) && !effects::actsOnShells(effect)) {
        context.error(*reader.find("key"), reader.pointerTo("key"),
                      effect.name + " acts on the rigid bodies of a free scene (replay, sensitivity, diagnose)",
                      "an effect on shells, contacts, apparatus or sensor");
        return false;
    }
    out = effects::off(effect);
    const auto complain = [&](const std::string& key, const std::string& why) {
        if (!why.empty())
            context.error(*reader.find(key), reader.pointerTo(key), why);
    };
    if (reader.find("shell")) {
        const std::string shell = reader.string("shell", "all");
        complain("shell", effects::set(out, "shell", shell));
        std::vector<std::string> known{"all"};
        for (const ShellDef& d : scene.shells)
            known.push_back(d.name);
        if (std::find(known.begin(), known.end(), shell) == known.end())
            context.error(*reader.find("shell"), reader.pointerTo("shell"), "there is no shell named \"" + shell + "\"",
                          "the name of a shell, or \"all\"", nearestName(shell, known));
    }
    for (const effects::Parameter& p : effect.parameters) {
        const std::optional<Node> node = reader.find(p.name);
        if (!node)
            continue;
        const std::size_t before = context.errors();
        if (node->kind() == Node::Kind::String) {
            const std::string value = reader.string(p.name, "");
            if (context.errors() == before)
                complain(p.name, effects::set(out, p.name, value));
        } else {
            const double value = reader.number(p.name, p.off);
            if (context.errors() == before)
                complain(p.name, effects::set(out, p.name, value));
        }
    }
    reader.finish();
    return context.errors() == start;
}

/// Displaces and tilts what is attached to the crosshead.
void misalign(const effects::ApparatusModel& a, Scene& scene) {
    if (a.offset == 0.0 && a.tilt == 0.0)
        return;
    std::vector<std::string> moved;
    for (const HoldDef& h : scene.holds)
        if (h.base == HoldBase::Moving && std::find(moved.begin(), moved.end(), h.shell) == moved.end())
            moved.push_back(h.shell);
    for (ShellDef& d : scene.shells)
        if (std::find(moved.begin(), moved.end(), d.name) != moved.end()) {
            d.position.x += a.offset;
            d.angle += a.tilt;
        }
    if (!scene.protocol || scene.protocol->body.empty())
        return;
    for (step::BodyDefinition& b : scene.rigid.bodies)
        if (b.name == scene.protocol->body) {
            b.position.x() += a.offset;
            b.angle += a.tilt;
        }
}

} // namespace

void readEffects(Context& context, ObjectReader& top, Scene& scene) {
    for (const ArrayItem& place : top.array("effects")) {
        effects::Setting setting;
        if (readEffect(context, place, scene, setting))
            scene.effects.push_back(std::move(setting));
    }
    if (scene.effects.empty())
        return;
    if (const std::string why = effects::validate(scene.effects); !why.empty())
        context.error(*top.find("effects"), "/effects", why);
    const effects::Model common = effects::modelFor(scene.effects, "all");
    scene.rigid.gravity += common.gravity;
    misalign(common.apparatus, scene);
}

} // namespace supercircle::scene
