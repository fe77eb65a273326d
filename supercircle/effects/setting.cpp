#include "supercircle/effects/effect.h"

#include "supercircle/support/names.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace supercircle::effects {

namespace {

std::string text(double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.10g", value);
    return buffer;
}

const Effect& effectOf(const Setting& s) {
    return catalog()[static_cast<std::size_t>(s.key)];
}

std::string bounds(const Parameter& p) {
    if (!p.choices.empty()) {
        std::string all;
        for (const std::string& w : p.choices)
            all += (all.empty() ? "" : ", ") + w;
        return "one of " + all;
    }
    return "a number from " + text(p.min) + " to " + text(p.max) + (p.unit == "1" ? "" : " " + p.unit);
}

/// Empty, or that there is no such parameter.
std::string findParameter(const Effect& effect, std::string_view name, std::size_t& index) {
    std::vector<std::string> names{effect.slot == Slot::Sensor ? "channel" : "shell"};
    std::string all;
    for (index = 0; index < effect.parameters.size(); ++index) {
        const std::string& known = effect.parameters[index].name;
        if (known == name)
            return {};
        names.push_back(known);
        all += (all.empty() ? "" : ", ") + known;
    }
    return "effect " + effect.name + " has no parameter \"" + std::string(name) + "\"; expected one of " + all +
           didYouMean(name, names);
}

} // namespace

const char* name(Slot slot) {
    static const char* const names[] = {"material", "load", "contact", "apparatus", "sensor"};
    return names[static_cast<std::size_t>(slot)];
}

const Effect* find(std::string_view label) {
    for (const Effect& e : catalog())
        if (e.name == label)
            return &e;
    return nullptr;
}

Setting off(const Effect& effect) {
    Setting s;
    s.key = effect.key;
    for (const Parameter& p : effect.parameters)
        s.values.push_back(p.off);
    return s;
}

void setTypical(Setting& setting) {
    const Effect& effect = effectOf(setting);
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
        const Parameter& p = effect.parameters[i];
        if (!p.isSwitch)
            continue;
        setting.values[i] = p.typical;
        if (effect.check != nullptr && !effect.check(setting.values).empty())
            setting.values[i] = p.off; // belongs to another law
    }
}

std::string unknownEffect(std::string_view label) {
    std::vector<std::string> names;
    std::string all;
    for (const Effect& e : catalog()) {
        names.push_back(e.name);
        all += (all.empty() ? "" : ", ") + e.name;
    }
    return "there is no effect \"" + std::string(label) + "\"; expected one of " + all + didYouMean(label, names);
}

std::string set(Setting& setting, std::string_view parameter, double value) {
    const Effect& effect = effectOf(setting);
    std::size_t i = 0;
    if (std::string why = findParameter(effect, parameter, i); !why.empty())
        return why;
    const Parameter& p = effect.parameters[i];
    const bool whole = p.choices.empty() || value == std::floor(value);
    if (std::isnan(value) || value < p.min || value > p.max || !whole || (std::isinf(value) && value != p.off))
        return "effect " + effect.name + ": " + p.name + " = " + text(value) + " is out of range; expected " +
               bounds(p);
    setting.values[i] = value;
    return {};
}

std::string set(Setting& setting, std::string_view parameter, std::string_view value) {
    const Effect& effect = effectOf(setting);
    if (parameter == "shell") {
        if (!effect.perShell && value != "all")
            return "effect " + effect.name + " acts on all shells; it cannot be given to one of them";
        setting.shell = value;
        return {};
    }
    if (parameter == "channel" && effect.slot == Slot::Sensor) {
        setting.channel = value;
        return {};
    }
    std::size_t i = 0;
    if (std::string why = findParameter(effect, parameter, i); !why.empty())
        return why;
    const Parameter& p = effect.parameters[i];
    for (std::size_t k = 0; k < p.choices.size(); ++k)
        if (p.choices[k] == value)
            return set(setting, parameter, static_cast<double>(k));
    double number = 0.0;
    const auto read = std::from_chars(value.data(), value.data() + value.size(), number);
    if (!p.choices.empty() || value.empty() || read.ec != std::errc() || read.ptr != value.data() + value.size())
        return "effect " + effect.name + ": " + p.name + " = \"" + std::string(value) + "\"; expected " + bounds(p) +
               didYouMean(value, p.choices);
    return set(setting, parameter, number);
}

bool isOff(const Setting& setting) {
    const Effect& effect = effectOf(setting);
    for (std::size_t i = 0; i < effect.parameters.size(); ++i)
        if (effect.parameters[i].isSwitch && setting.values[i] != effect.parameters[i].off)
            return false;
    return true;
}

std::string add(std::vector<Setting>& settings, std::string_view textOf) {
    const std::size_t colon = textOf.find(':'), equals = textOf.find('=');
    const std::string_view label = textOf.substr(0, colon);
    const Effect* effect = find(label);
    if (effect == nullptr)
        return unknownEffect(label);
    if (colon == std::string_view::npos || equals == std::string_view::npos || equals < colon)
        return "\"" + std::string(textOf) + "\" is not of the form KEY:NAME=VALUE";
    auto it = std::find_if(settings.begin(), settings.end(), [&](const Setting& s) { return s.key == effect->key; });
    if (it == settings.end())
        it = settings.insert(settings.end(), off(*effect));
    return set(*it, textOf.substr(colon + 1, equals - colon - 1), textOf.substr(equals + 1));
}

std::string validate(const std::vector<Setting>& settings) {
    for (std::size_t i = 0; i < settings.size(); ++i) {
        const Effect& effect = effectOf(settings[i]);
        if (effect.check != nullptr)
            if (std::string why = effect.check(settings[i].values); !why.empty())
                return "effect " + effect.name + ": " + why;
        for (std::size_t k = 0; k < i; ++k)
            if (settings[k].key == settings[i].key && !effect.repeatable &&
                settings[k].channel == settings[i].channel &&
                (settings[k].shell == settings[i].shell || settings[k].shell == "all" || settings[i].shell == "all"))
                return "effect " + effect.name + " is given twice" +
                       (settings[i].channel.empty() ? "" : " to channel \"" + settings[i].channel + "\"") +
                       (settings[i].shell == "all" ? "" : " to shell \"" + settings[i].shell + "\"");
    }
    return {};
}

SensorModel sensorOf(const std::vector<Setting>& settings, std::string_view channel) {
    Model model;
    for (const Setting& s : settings)
        if (!isOff(s) && effectOf(s).slot == Slot::Sensor && s.channel == channel)
            effectOf(s).apply(s.values, model);
    return model.sensor;
}

Model modelFor(const std::vector<Setting>& settings, std::string_view shell) {
    Model model;
    for (const Setting& s : settings)
        if (!isOff(s) && s.channel.empty() && (s.shell == "all" || s.shell == shell))
            effectOf(s).apply(s.values, model);
    return model;
}

bool actsOnMechanisms(const Effect& effect) {
    return effect.key == Key::BearingFriction || effect.key == Key::AirDrag || effect.key == Key::GuideFriction ||
           effect.key == Key::NonlinearSpring;
}

bool actsOnShells(const Effect& effect) {
    return effect.slot != Slot::Apparatus && effect.slot != Slot::Sensor && effect.key != Key::Gravity &&
           (!actsOnMechanisms(effect) || effect.key == Key::AirDrag);
}

std::vector<Setting> settingsFor(const std::vector<Setting>& settings, std::string_view shell) {
    std::vector<Setting> out;
    for (const Setting& s : settings)
        if (!isOff(s) && actsOnShells(effectOf(s)) && (s.shell == "all" || s.shell == shell)) {
            out.push_back(s);
            out.back().shell = "all";
        }
    return out;
}

std::vector<std::string> shellsNamed(const std::vector<Setting>& settings) {
    std::vector<std::string> names;
    for (const Setting& s : settings)
        if (s.shell != "all")
            names.push_back(s.shell);
    return names;
}

} // namespace supercircle::effects
