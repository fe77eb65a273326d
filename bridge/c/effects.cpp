// Effects as JSON, with the keys that scenes use.

#include "bridge/c/json.h"
#include "bridge/c/world.h"

#include <nlohmann/json.hpp>

using namespace supercircle::c;
using supercircle::EffectDef;
using supercircle::EffectInfo;
using supercircle::EffectParameter;
using supercircle::EffectTarget;
using supercircle::EffectValue;

namespace {

EffectDef definition(const Json& entry) {
    if (!entry.is_object() || !entry.contains("key") || !entry["key"].is_string())
        refuse(SC_BAD_INPUT,
               "an effect is an object with a \"key\", such as {\"key\": \"planar_drag\", \"f_N_m\": 0.2}");
    EffectDef d;
    d.key = entry["key"].get<std::string>();
    for (const auto& [name, value] : entry.items()) {
        if (name == "key")
            continue;
        if (value.is_number())
            d.parameters.emplace_back(name, value.get<double>());
        else if (value.is_string())
            d.parameters.emplace_back(name, value.get<std::string>());
        else
            refuse(SC_BAD_INPUT, d.key + ": " + name + " is neither a number nor a text");
    }
    return d;
}

EffectTarget target(World& x, sc_shell s) {
    return s.id == 0 ? EffectTarget(supercircle::all_shells) : EffectTarget(x.in(s));
}

Json parameterJson(const EffectParameter& p) {
    Json json = {{"name", p.name},
                 {"unit", p.unit},
                 {"about", p.about},
                 {"default", p.default_value},
                 {"neutral", p.neutral_value},
                 {"lowest", p.lowest},
                 {"highest", p.highest},
                 {"switch", p.is_switch}};
    if (!p.choices.empty())
        json["choices"] = p.choices;
    return json;
}

std::string catalogJson() {
    static constexpr const char* kSlots[] = {"material", "load", "contact", "apparatus", "sensor"};
    Json all = Json::array();
    for (const EffectInfo& e : supercircle::effect_catalog()) {
        Json parameters = Json::array();
        for (const EffectParameter& p : e.parameters)
            parameters.push_back(parameterJson(p));
        all.push_back({{"key", e.key},
                       {"slot", kSlots[static_cast<int>(e.slot)]},
                       {"about", e.about},
                       {"law", e.law},
                       {"acts_on_shells", e.acts_on_shells},
                       {"parameters", parameters}});
    }
    return written(all);
}

} // namespace

const char* sc_effects(void) {
    return text([] { return catalogJson(); });
}

sc_status sc_shell_set_effects(sc_world w, sc_shell s, const char* json) {
    return use(w, [&](World& x) {
        const Json list = parsed(json, "the effects");
        if (!list.is_array())
            refuse(SC_BAD_INPUT, "a list of effects is expected, such as [{\"key\": \"plasticity\"}]");
        std::vector<EffectDef> all;
        for (const Json& entry : list)
            all.push_back(definition(entry));
        done(x.shells.replace_effects(target(x, s), all));
    });
}

sc_status sc_shell_set_effect(sc_world w, sc_shell s, const char* json) {
    return use(w, [&](World& x) {
        const EffectDef d = definition(parsed(json, "the effect"));
        done(x.shells.set_effects(target(x, s), d.key, d.parameters));
    });
}

sc_status sc_shell_remove_effect(sc_world w, sc_shell s, const char* key) {
    return use(w, [&](World& x) { done(x.shells.remove_effect(target(x, s), nameOf(key, "the key"))); });
}

const char* sc_shell_effects(sc_world w, sc_shell s) {
    return textIn(w, [&](World& x) {
        const auto effects = x.shells.effects(x.in(s));
        Json all = Json::array();
        for (const EffectDef& d : done(effects)) {
            Json entry = {{"key", d.key}};
            for (const EffectValue& v : d.parameters)
                entry[v.name] = v.choice.empty() ? Json(v.number) : Json(v.choice);
            all.push_back(std::move(entry));
        }
        return written(all);
    });
}
