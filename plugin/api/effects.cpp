// Effects of shells by key and parameter names, as scenes give them.

#include "plugin/api/snapshot_fields.h"

#include <algorithm>

namespace supercircle {

namespace {

using effects::Effect;
using effects::Setting;
using Settings = std::vector<Setting>;

EffectInfo infoOf(const Effect& e) {
    EffectInfo info{e.name, static_cast<EffectSlot>(e.slot), e.about, e.law, effects::actsOnShells(e), {}};
    Setting on = effects::off(e);
    effects::setTypical(on);
    for (std::size_t i = 0; i < e.parameters.size(); ++i) {
        const effects::Parameter& p = e.parameters[i];
        info.parameters.push_back({p.name, p.unit, p.about, on.values[i], p.off, p.min, p.max, p.isSwitch, p.choices});
    }
    return info;
}

/// Why the effect cannot be given to shells; empty if it can.
std::string notOnShells(const Effect& e) {
    if (effects::actsOnShells(e))
        return {};
    const std::string what = "effect " + e.name + " does not act on shells: ";
    if (e.key == effects::Key::Gravity)
        return what + "set the gravity of the host world (b2World::SetGravity)";
    if (e.slot == effects::Slot::Apparatus || e.slot == effects::Slot::Sensor)
        return what + "it belongs to the testing machine; give it in a scene (supercircle-lab, supercircle-identify)";
    return what + "it acts on rigid bodies of a recorded experiment (supercircle-identify replay)";
}

std::string unknown(const std::string& key) {
    return effects::unknownEffect(key) + " (the catalogue of effects describes all of them)";
}

/// Reads a definition; the error names the nearest key or parameter.
Result<Setting> read(const EffectDef& definition) {
    const Effect* effect = effects::find(definition.key);
    if (effect == nullptr)
        return Result<Setting>::failure(unknown(definition.key));
    if (std::string why = notOnShells(*effect); !why.empty())
        return Result<Setting>::failure(std::move(why));
    Setting setting = effects::off(*effect);
    bool switched = false;
    for (const EffectValue& v : definition.parameters) {
        std::string why = v.name == "shell" ? "effect " + effect->name +
                                                  ": the shell is the first argument of the call, not a parameter"
                          : v.choice.empty() ? effects::set(setting, v.name, v.number)
                                             : effects::set(setting, v.name, v.choice);
        if (!why.empty())
            return Result<Setting>::failure(std::move(why));
        switched = switched || std::any_of(effect->parameters.begin(), effect->parameters.end(),
                                           [&](const effects::Parameter& p) { return p.isSwitch && p.name == v.name; });
    }
    if (!switched)
        effects::setTypical(setting);
    if (std::string why = effects::validate({setting}); !why.empty())
        return Result<Setting>::failure(std::move(why));
    return setting;
}

void erase(Settings& list, effects::Key key) {
    std::erase_if(list, [key](const Setting& s) { return s.key == key; });
}

/// Puts the setting where the effect stood; one that is off leaves no trace.
void replace(Settings& list, const Setting& setting) {
    const auto same = [&](const Setting& s) { return s.key == setting.key; };
    const auto at = std::find_if(list.begin(), list.end(), same) - list.begin();
    erase(list, setting.key);
    if (!effects::isOff(setting))
        list.insert(list.begin() + at, setting);
}

EffectDef definitionOf(const Setting& setting) {
    const Effect& e = effects::catalog()[static_cast<std::size_t>(setting.key)];
    EffectDef d{e.name, {}};
    for (std::size_t i = 0; i < e.parameters.size(); ++i) {
        const effects::Parameter& p = e.parameters[i];
        const double v = setting.values[i];
        if (p.choices.empty())
            d.parameters.emplace_back(p.name, v);
        else
            d.parameters.emplace_back(p.name, p.choices[static_cast<std::size_t>(v)]);
    }
    return d;
}

} // namespace

const std::vector<EffectInfo>& effect_catalog() {
    static const std::vector<EffectInfo> all = [] {
        std::vector<EffectInfo> list;
        for (const Effect& e : effects::catalog())
            list.push_back(infoOf(e));
        return list;
    }();
    return all;
}

/// Applies a change to the lists of effects that the target means.
template <class Change>
Status Shells::Impl::changeEffects(const EffectTarget& target, Change changeList) {
    std::vector<std::size_t> rods;
    if (target.all) {
        for (std::size_t i = 0; i < world.rods.size(); ++i)
            rods.push_back(i);
        changeList(effectsOfNew);
    } else if (const int i = find(target.shell); i >= 0) {
        rods.push_back(static_cast<std::size_t>(i));
    } else {
        return refused(kNoSuchShell);
    }
    for (const std::size_t i : rods) {
        Settings list = world.rods[i].effects.settings;
        changeList(list);
        step::setEffectSettings(world, i, std::move(list));
    }
    return done();
}

Status Shells::set_effects(EffectTarget target, const std::string& key, const std::vector<EffectValue>& parameters) {
    return impl_->change([&] {
        const Result<Setting> setting = read({key, parameters});
        if (!setting)
            return refused(setting.error());
        Status changed = impl_->changeEffects(target, [&](Settings& list) { replace(list, *setting); });
        if (changed)
            impl_->recorder.record(Call::SetEffect, target, key, parameters);
        return changed;
    });
}

Status Shells::replace_effects(EffectTarget target, const std::vector<EffectDef>& definitions) {
    return impl_->change([&] {
        Settings all;
        for (const EffectDef& d : definitions) {
            const Result<Setting> setting = read(d);
            if (!setting)
                return refused(setting.error());
            if (!effects::isOff(*setting))
                all.push_back(*setting);
        }
        if (std::string why = effects::validate(all); !why.empty())
            return refused(std::move(why));
        Status changed = impl_->changeEffects(target, [&](Settings& list) { list = all; });
        if (changed)
            impl_->recorder.record(Call::ReplaceEffects, target, definitions);
        return changed;
    });
}

Status Shells::remove_effect(EffectTarget target, const std::string& key) {
    return impl_->change([&] {
        const Effect* effect = effects::find(key);
        if (effect == nullptr)
            return refused(unknown(key));
        Status changed = impl_->changeEffects(target, [&](Settings& list) { erase(list, effect->key); });
        if (changed)
            impl_->recorder.record(Call::RemoveEffect, target, key);
        return changed;
    });
}

Result<std::vector<EffectDef>> Shells::effects(ShellHandle shell) const {
    const int i = impl_->find(shell);
    if (i < 0)
        return Result<std::vector<EffectDef>>::failure(kNoSuchShell);
    std::vector<EffectDef> out;
    for (const Setting& s : impl_->rod(i).effects.settings)
        out.push_back(definitionOf(s));
    return out;
}

} // namespace supercircle
