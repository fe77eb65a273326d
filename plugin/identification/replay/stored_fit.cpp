#include "plugin/identification/replay/stored_fit.h"

#include "plugin/recording/table/files.h"
#include "plugin/recording/table/json_text.h"
#include "plugin/recording/table/text.h"
#include "supercircle/support/hash.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace supercircle::replay {

namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const Section& s) {
    return {{"thickness_m", s.thickness}, {"width_m", s.width}, {"bending_modulus_N_m2", s.bendingModulus}};
}

Json jsonOf(const StoredFit& fit) {
    Json parameters = Json::object(), effects = Json::array();
    for (const auto& [name, value] : fit.parameters)
        parameters[name] = value;
    for (const effects::Setting& s : fit.effects) {
        effects.push_back({{"key", effects::catalog()[static_cast<std::size_t>(s.key)].name}});
        effects.back().update(replay::jsonOf(s));
    }
    Json json = {{"label", fit.label},
                 {"drawn", fit.drawn},
                 {"parameters", parameters},
                 {"effects", effects},
                 {"section", jsonOf(fit.section)}};
    if (!fit.unrepeatable.empty())
        json["unrepeatable"] = fit.unrepeatable;
    return json;
}

double numberIn(const Json& object, const char* key) {
    return object.is_object() && object.contains(key) && object[key].is_number() ? object[key].get<double>() : 0.0;
}

std::string textIn(const Json& object, const char* key) {
    return object.is_object() && object.contains(key) && object[key].is_string() ? object[key].get<std::string>()
                                                                                 : std::string();
}

/// Reads an effect; returns what is wrong.
std::string read(const Json& json, effects::Setting& out) {
    const std::string key = textIn(json, "key");
    const effects::Effect* effect = effects::find(key);
    if (effect == nullptr)
        return effects::unknownEffect(key);
    out = effects::off(*effect);
    for (const auto& [name, value] : json.items()) {
        std::string why;
        if (value.is_string() && name != "key")
            why = effects::set(out, name, value.get_ref<const std::string&>());
        else if (value.is_number())
            why = effects::set(out, name, value.get<double>());
        if (!why.empty())
            return key + ": " + why;
    }
    return {};
}

/// Reads a fit; returns what is wrong.
std::string read(const Json& json, StoredFit& out) {
    out.label = textIn(json, "label");
    out.unrepeatable = textIn(json, "unrepeatable");
    if (!json.is_object() || out.label.empty() || !json.contains("parameters") || !json.contains("effects"))
        return "a fit without label, parameters or effects";
    out.drawn = json.contains("drawn") && json["drawn"] == true;
    for (const auto& [name, value] : json["parameters"].items()) {
        if (!value.is_number())
            return "parameter " + name + " is no number";
        out.parameters.emplace_back(name, value.get<double>());
    }
    for (const Json& effect : json["effects"]) {
        out.effects.emplace_back();
        if (std::string why = read(effect, out.effects.back()); !why.empty())
            return why;
    }
    const Json section = json.contains("section") ? json["section"] : Json();
    out.section = {numberIn(section, "thickness_m"), numberIn(section, "width_m"),
                   numberIn(section, "bending_modulus_N_m2")};
    return {};
}

/// By what a value is multiplied in another section; 1: it stays.
double factorOf(const std::string& unit, effects::Slot slot, double thickness, double width) {
    if (slot == effects::Slot::Material && unit == "1/m")
        return 1.0 / thickness;
    if (slot == effects::Slot::Contact && unit == "N/m")
        return width;
    if (slot == effects::Slot::Contact && unit == "m/N")
        return 1.0 / width;
    return 1.0;
}

/// Whether an effect is a defect of one specimen.
bool isDefect(effects::Key key) {
    return key == effects::Key::LocalDamage || key == effects::Key::NaturalCurvatureDefect ||
           key == effects::Key::StiffnessGradient;
}

} // namespace

std::string checkSumOf(const experiment::Experiment& e) {
    std::string runs;
    for (const experiment::Run& run : e.runs) {
        runs += run.file + '\n';
        std::vector<const std::vector<double>*> columns = {&run.readings.time,     &run.readings.displacement,
                                                           &run.readings.force,    &run.driveTime,
                                                           &run.driveDisplacement, &run.markers.time};
        for (const std::vector<std::vector<double>>* tracks : {&run.markers.x, &run.markers.y})
            for (const std::vector<double>& track : *tracks)
                columns.push_back(&track);
        for (const std::vector<double>* column : columns) {
            for (const double v : *column) {
                record::appendNumber(runs, v);
                runs += ' ';
            }
            runs += '\n';
        }
    }
    char text[24];
    std::snprintf(text, sizeof text, "%016llx",
                  static_cast<unsigned long long>(
                      checkSum(runs, checkSum(e.scene ? e.scene->text : std::string(), checkSum(e.text)))));
    return text;
}

Section sectionOf(const experiment::Experiment& e, const Parameters& p) {
    if (e.specimens.empty())
        return {};
    const SpecimenParameters& first = p.specimens.front();
    return {first.thickness, e.specimens.front().width, first.bendingModulus};
}

StoredFit storedFit(const experiment::Experiment& e, const Parameters& p) {
    StoredFit fit;
    for (const ParameterInfo& info : parameterList(e))
        fit.parameters.emplace_back(info.name, get(p, e, info.name).value_or(info.stated.value));
    fit.effects = p.effects;
    fit.section = sectionOf(e, p);
    return fit;
}

Json jsonOf(const effects::Setting& s) {
    Json json = {{"shell", s.shell}};
    const effects::Effect& effect = effects::catalog()[static_cast<std::size_t>(s.key)];
    for (std::size_t i = 0; i < effect.parameters.size(); ++i)
        if (const effects::Parameter& p = effect.parameters[i]; !p.choices.empty())
            json[p.name] = p.choices[static_cast<std::size_t>(s.values[i])];
        else if (std::isfinite(s.values[i]))
            json[p.name] = s.values[i];
    return json;
}

Json jsonOf(const StoredFits& fits) {
    Json all = Json::array();
    for (const StoredFit& fit : fits.fits)
        all.push_back(jsonOf(fit));
    return {{"experiment_checksum", fits.checkSum}, {"fits", all}};
}

Result<StoredFits> readStoredFits(const std::string& file) {
    using Failed = Result<StoredFits>;
    const auto text = record::readText(file);
    if (!text)
        return Failed::failure(text.error());
    const Json json = record::tryParseJson(*text);
    if (json.is_discarded() || !json.is_object() || textIn(json, "schema").rfind("supercircle-diagnosis/", 0) != 0)
        return Failed::failure(file + ": this is no diagnosis.json");
    if (!json.contains("replay") || !json["replay"].is_object() || !json["replay"].contains("fits"))
        return Failed::failure(file + ": it has no fits (\"replay\"); diagnose the experiment again");
    StoredFits out;
    out.checkSum = textIn(json["replay"], "experiment_checksum");
    for (const Json& fit : json["replay"]["fits"]) {
        out.fits.emplace_back();
        if (const std::string why = read(fit, out.fits.back()); !why.empty())
            return Failed::failure(file + ": /replay/fits/" + std::to_string(out.fits.size() - 1) + ": " + why);
    }
    if (out.fits.empty())
        return Failed::failure(file + ": /replay/fits is empty; diagnose the experiment again");
    return out;
}

Result<StoredFit> fitCalled(const StoredFits& fits, const std::string& label) {
    const auto found = std::find_if(fits.fits.begin(), fits.fits.end(),
                                    [&](const StoredFit& f) { return label.empty() ? f.drawn : f.label == label; });
    if (found == fits.fits.end()) {
        std::vector<std::string> labels;
        std::string all;
        for (const StoredFit& f : fits.fits) {
            labels.push_back(f.label);
            all += (all.empty() ? "" : ", ") + f.label;
        }
        return Result<StoredFit>::failure("no fit is called \"" + label + "\"; there are " + all +
                                          didYouMean(label, labels));
    }
    return *found;
}

std::string setTo(const StoredFit& fit, const experiment::Experiment& e, Parameters& p) {
    if (!fit.unrepeatable.empty())
        return fit.label + ": " + fit.unrepeatable;
    for (const auto& [name, value] : fit.parameters)
        if (std::string why = set(p, e, name, value); !why.empty())
            return why;
    p.effects = fit.effects;
    return checkEffects(p, e);
}

Result<CarriedLaw> carriedTo(const Section& to, const StoredFit& fit) {
    using Failed = Result<CarriedLaw>;
    if (!fit.unrepeatable.empty())
        return Failed::failure(fit.label + ": " + fit.unrepeatable);
    const Section& from = fit.section;
    const double thickness = from.thickness > 0.0 && to.thickness > 0.0 ? to.thickness / from.thickness : 1.0;
    double width = 1.0;
    if (from.width > 0.0 && to.width > 0.0)
        width = to.width / from.width;
    else if (from.bendingModulus > 0.0 && to.bendingModulus > 0.0)
        width = to.bendingModulus / from.bendingModulus / (thickness * thickness * thickness);
    CarriedLaw out;
    for (effects::Setting s : fit.effects) {
        const effects::Effect& effect = effects::catalog()[static_cast<std::size_t>(s.key)];
        if (isDefect(s.key)) {
            out.notes.push_back(effect.name + " is a defect of one specimen and is not carried");
            continue;
        }
        s.shell = "all";
        for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
            const double factor = factorOf(effect.parameters[i].unit, effect.slot, thickness, width);
            if (factor == 1.0 || !std::isfinite(s.values[i]) || s.values[i] == effect.parameters[i].off)
                continue;
            s.values[i] *= factor;
            char note[160];
            std::snprintf(note, sizeof note, "%s: %s is %.4g times as large in this section", effect.name.c_str(),
                          effect.parameters[i].name.c_str(), factor);
            out.notes.emplace_back(note);
        }
        if (effect.slot == effects::Slot::Apparatus || effect.slot == effects::Slot::Sensor)
            out.notes.push_back(effect.name + " belongs to the testing machine: it holds on the same one only");
        out.effects.push_back(std::move(s));
    }
    if (out.effects.empty())
        return Failed::failure(fit.label + " has no law to carry" +
                               (out.notes.empty() ? std::string() : ": " + out.notes.front()));
    return out;
}

} // namespace supercircle::replay
