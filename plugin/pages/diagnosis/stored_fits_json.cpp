#include "plugin/pages/diagnosis/stored_fits_json.h"

#include "plugin/recording/table/files.h"
#include "plugin/recording/table/json_text.h"

#include <nlohmann/json.hpp>

namespace supercircle::cli {

namespace {

using Json = nlohmann::ordered_json;
using diagnosis::StoredFit;
using diagnosis::StoredFits;

Json jsonOf(const diagnosis::Section& s) {
    return {{"thickness_m", s.thickness}, {"width_m", s.width}, {"bending_modulus_N_m2", s.bendingModulus}};
}

Json jsonOf(const StoredFit& fit) {
    Json parameters = Json::object();
    for (const auto& [name, value] : fit.parameters)
        parameters[name] = value;
    Json json = {{"label", fit.label},
                 {"drawn", fit.drawn},
                 {"parameters", parameters},
                 {"effects", diagnosis::assignmentsOf(fit.effects)},
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
    std::vector<std::string> effects;
    for (const Json& effect : json["effects"]) {
        if (!effect.is_string())
            return "an effect is not written as \"KEY:NAME=VALUE\"; diagnose the experiment again";
        effects.push_back(effect.get<std::string>());
    }
    if (std::string why = diagnosis::readAssignments(effects, out.effects); !why.empty())
        return why;
    const Json section = json.contains("section") ? json["section"] : Json();
    out.section = {numberIn(section, "thickness_m"), numberIn(section, "width_m"),
                   numberIn(section, "bending_modulus_N_m2")};
    return {};
}

} // namespace

std::string storedFitsJson(const StoredFits& fits) {
    Json all = Json::array();
    for (const StoredFit& fit : fits.fits)
        all.push_back(jsonOf(fit));
    return record::jsonText({{"experiment_checksum", fits.checkSum}, {"fits", all}});
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

Result<Taken> takeFit(const std::string& file, const std::string& label, bool carried, const experiment::Experiment& e,
                      replay::Parameters& parameters) {
    using Failed = Result<Taken>;
    const auto fits = readStoredFits(file);
    if (!fits)
        return Failed::failure(fits.error());
    const auto fit = diagnosis::fitCalled(*fits, label);
    if (!fit)
        return Failed::failure(file + ": " + fit.error());
    Taken out{fit->label, {}};
    std::string why;
    if (!carried) {
        if (fits->checkSum != diagnosis::checkSumOf(e))
            return Failed::failure(file + " is of other recordings or another description than " + e.file +
                                   "; diagnose this experiment, or carry the law alone");
        why = diagnosis::setTo(*fit, e, parameters);
    } else {
        auto law = diagnosis::carriedTo(diagnosis::sectionOf(e, parameters), *fit);
        if (!law)
            return Failed::failure(file + ": " + law.error());
        out.notes = law->notes;
        parameters.effects = std::move(law->effects);
        why = replay::checkEffects(parameters, e);
    }
    if (!why.empty())
        return Failed::failure(file + ": " + why);
    return out;
}

} // namespace supercircle::cli
