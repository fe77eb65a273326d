#include "plugin/identification/diagnosis/stored_fits.h"

#include "plugin/recording/table/text.h"
#include "supercircle/support/hash.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace supercircle::diagnosis {

namespace {

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
        for (const std::vector<std::vector<double>>* tracks : {&run.readings.further, &run.markers.x, &run.markers.y})
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

Section sectionOf(const experiment::Experiment& e, const replay::Parameters& p) {
    if (e.specimens.empty())
        return {};
    const replay::SpecimenParameters& first = p.specimens.front();
    return {first.thickness, e.specimens.front().width, first.bendingModulus};
}

StoredFit storedFit(const experiment::Experiment& e, const replay::Parameters& p) {
    StoredFit fit;
    for (const replay::ParameterInfo& info : replay::parameterList(e))
        fit.parameters.emplace_back(info.name, replay::get(p, e, info.name).value_or(info.stated.value));
    fit.effects = p.effects;
    fit.section = sectionOf(e, p);
    return fit;
}

StoredFits storedFitsOf(const ReplayModel& model, const experiment::Experiment& experiment, const Diagnosis& d) {
    StoredFits out{checkSumOf(experiment), {}};
    const auto add = [&](const std::string& label, const ParameterPoint& point, bool drawn) {
        replay::Parameters parameters;
        std::string why = model.withoutParameters(point);
        if (const std::string wrong = model.parametersAt(point, parameters); why.empty())
            why = wrong;
        StoredFit fit = storedFit(experiment, parameters);
        fit.label = label;
        fit.drawn = drawn;
        fit.unrepeatable = why;
        out.fits.push_back(std::move(fit));
    };
    for (const FittedEffect& e : d.effects)
        add(e.label, e.point, d.improved && &e == &d.effects.front());
    for (const LearnedLaw& law : d.learned)
        add(law.label, law.point, false);
    add(kNothing, d.baseline, !d.improved);
    return out;
}

std::vector<std::string> assignmentsOf(const std::vector<effects::Setting>& all) {
    std::vector<std::string> out;
    for (const effects::Setting& s : all) {
        const effects::Effect& effect = effects::catalog()[static_cast<std::size_t>(s.key)];
        if (s.shell != "all")
            out.push_back(effect.name + ":shell=" + s.shell);
        if (!s.channel.empty())
            out.push_back(effect.name + ":channel=" + s.channel);
        for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
            const effects::Parameter& p = effect.parameters[i];
            std::string text = effect.name + ":" + p.name + "=";
            if (!p.choices.empty())
                text += p.choices[static_cast<std::size_t>(s.values[i])];
            else if (std::isfinite(s.values[i]))
                record::appendNumber(text, s.values[i]);
            else
                continue;
            out.push_back(text);
        }
    }
    return out;
}

std::string readAssignments(const std::vector<std::string>& texts, std::vector<effects::Setting>& out) {
    for (const std::string& text : texts)
        if (const std::string why = effects::add(out, text); !why.empty())
            return text + ": " + why;
    return {};
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

std::string setTo(const StoredFit& fit, const experiment::Experiment& e, replay::Parameters& p) {
    if (!fit.unrepeatable.empty())
        return fit.label + ": " + fit.unrepeatable;
    for (const auto& [name, value] : fit.parameters)
        if (std::string why = replay::set(p, e, name, value); !why.empty())
            return why;
    p.effects = fit.effects;
    return replay::checkEffects(p, e);
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

} // namespace supercircle::diagnosis
