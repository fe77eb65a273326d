#include "plugin/identification/replay/parameters.h"

#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace supercircle::replay {

namespace {

using experiment::Experiment;
using experiment::Specimen;
using experiment::Stated;

/// A property of specimens: name, storage, stated value.
struct Property {
    const char* name;
    const char* unit;
    const char* about;
    double SpecimenParameters::*value;
    Stated Specimen::*stated;
    bool positive;
};

const Property kProperties[] = {
    {"bending_modulus", "N m^2", "bending modulus B = E w h^3 / 12", &SpecimenParameters::bendingModulus,
     &Specimen::bendingModulus, true},
    {"natural_curvature", "1/m", "curvature of the unloaded specimen", &SpecimenParameters::naturalCurvature,
     &Specimen::naturalCurvature, false},
    {"thickness", "m", "thickness for contacts", &SpecimenParameters::thickness, &Specimen::thickness, true},
    {"linear_mass", "kg/m", "mass per length", &SpecimenParameters::linearMass, &Specimen::linearMass, true},
};

Stated exact(double value, double halfWidth = 0.0) {
    return {value, halfWidth};
}

/// Axial compliance of a strip pressed lengthwise, m/N.
double stretch(const Experiment& e) {
    if (e.protocol != experiment::Protocol::StripOnRigidFloor || e.specimens.empty() ||
        e.specimens.front().stretchModulus <= 0.0)
        return 0.0;
    return e.specimens.front().length / e.specimens.front().stretchModulus;
}

/// A property of the set-up.
struct Surrounding {
    const char* name;
    const char* unit;
    const char* about;
    double& (*value)(Parameters&);
    Stated (*stated)(const Experiment&);
    bool notNegative;
    double most = std::numeric_limits<double>::infinity();
};

const Surrounding kSurroundings[] = {
    {"friction", "1", "friction coefficient of all contacts", [](Parameters& p) -> double& { return p.friction; },
     [](const Experiment& e) { return e.friction; }, true},
    {"gap_shift", "m", "the crosshead stands this much higher at displacement 0 than stated",
     [](Parameters& p) -> double& { return p.gapShift; },
     [](const Experiment& e) { return exact(0.0, e.initialGapHalfWidth); }, false},
    {"gravity_x", "m/s^2", "gravity, positive to the right", [](Parameters& p) -> double& { return p.gravity.x; },
     [](const Experiment& e) { return exact(e.gravity.x); }, false},
    {"gravity_y", "m/s^2", "gravity, positive upwards", [](Parameters& p) -> double& { return p.gravity.y; },
     [](const Experiment& e) { return exact(e.gravity.y); }, false},
    {"contact_arm", "1", "where contact forces act on the section: 0 centre line, 1 surface",
     [](Parameters& p) -> double& { return p.contactArm; }, [](const Experiment&) { return exact(0.0); }, true, 1.0},
    {"series_compliance", "m/N", "compliance in series with the specimen",
     [](Parameters& p) -> double& { return p.seriesCompliance; }, [](const Experiment&) { return exact(0.0); }, true},
    {"touch_compliance", "m/N", "compliance of each contact, with the axial compliance of a strip pressed lengthwise",
     [](Parameters& p) -> double& { return p.touchCompliance; }, [](const Experiment& e) { return exact(stretch(e)); },
     true},
};

/// The values that a name sets, and their valid range.
struct Target {
    std::vector<double*> values;
    bool positive = false;
    bool notNegative = false;
    double most = std::numeric_limits<double>::infinity();
};

/// Whether scenes have it: what else surrounds a specimen is in the scene itself.
bool ofScene(const Surrounding& s, const Experiment& e) {
    const std::string name = s.name;
    return name.rfind("gravity", 0) == 0 || (name == "series_compliance" && !experiment::isMechanism(e) &&
                                             e.scene->driven && !experiment::drivesLoad(e));
}

/// "NAME", "NAME.B" of specimen B, or "NAME_run2" of a run.
std::string nameOf(const SceneValue& v, const Experiment& e) {
    return v.specimen >= 0 ? v.name + "." + e.scene->specimens[static_cast<std::size_t>(v.specimen)].id
                           : v.name + (v.run < 0 ? "" : "_run" + std::to_string(v.run + 1));
}

/// Name of the zero of a further channel.
std::string zeroOf(const experiment::FurtherChannel& c) {
    return "reading_zero." + c.observe;
}

Target findInScene(Parameters& p, const Experiment& e, const std::string& name) {
    for (SceneValue& v : p.scene)
        if (nameOf(v, e) == name)
            return {{&v.value}};
    for (const Surrounding& s : kSurroundings)
        if (name == s.name && ofScene(s, e))
            return {{&s.value(p)}, false, s.notNegative};
    if (name == "reading_zero")
        return {{&p.readingZero}};
    for (std::size_t k = 0; k < e.scene->further.size() && k < p.furtherZero.size(); ++k)
        if (name == zeroOf(e.scene->further[k]))
            return {{&p.furtherZero[k]}};
    return {};
}

const char* unitOf(scene::Observation::Quantity quantity) {
    constexpr const char* kUnits[] = {"rad", "m", "m", "rad/s", "m/s", "m/s", "rad/s^2", "m/s^2", "m/s^2", "N", "m"};
    return kUnits[static_cast<std::size_t>(quantity)];
}

/// Calls `add` with each parameter of a scene, its run or -1, its specimen or -1, and whether it is of the batch.
template <class Add>
void forEachOfScene(const Experiment& e, const Add& add) {
    const experiment::FreeScene& scene = *e.scene;
    for (const experiment::SceneParameter& s : scene.parameters)
        add(s, -1, -1, false);
    for (std::size_t k = 0; k < scene.specimens.size(); ++k) {
        for (const experiment::SceneParameter& s : scene.specimens[k].parameters)
            add(s, -1, static_cast<int>(k), false);
        for (const experiment::BatchParameter& b : scene.batch)
            for (const experiment::SceneParameter& s : scene.parameters)
                if (b.scale > 0.0 && s.name == b.name)
                    add(s, -1, static_cast<int>(k), true);
    }
    for (std::size_t r = 0; r < e.runs.size(); ++r)
        for (const experiment::SceneParameter& s : e.runs[r].parameters)
            add(s, static_cast<int>(r), -1, false);
}

/// Names, units and intervals of a scene, in the order of Parameters::scene.
std::vector<ParameterInfo> sceneList(const Experiment& e) {
    std::vector<ParameterInfo> all;
    forEachOfScene(e, [&](const experiment::SceneParameter& s, int run, int specimen, bool ofBatch) {
        std::string of = run >= 0        ? ", of run " + std::to_string(run + 1)
                         : specimen >= 0 ? ", of specimen " + e.scene->specimens[static_cast<std::size_t>(specimen)].id
                                         : std::string();
        of += ofBatch ? ": the common value unless it is set" : "";
        all.push_back({nameOf({s.name, run, 0.0, specimen}, e), s.unit.empty() ? "1" : s.unit, s.about + of,
                       ofBatch ? exact(s.stated.value) : s.stated, specimen, ofBatch, run >= 0, run});
    });
    for (const Surrounding& s : kSurroundings)
        if (ofScene(s, e))
            all.push_back({s.name, s.unit, s.about, s.stated(e)});
    all.push_back({"reading_zero", unitOf(e.scene->observation.quantity), "reading at pose zero", e.scene->zero, -1,
                   false, true});
    for (const experiment::FurtherChannel& c : e.scene->further)
        all.push_back({zeroOf(c), unitOf(c.observation.quantity), "the same of " + c.observe, c.zero, -1, false, true});
    return all;
}

Target find(Parameters& p, const Experiment& e, const std::string& name) {
    if (e.scene)
        return findInScene(p, e, name);
    for (const Surrounding& s : kSurroundings)
        if (name == s.name)
            return {{&s.value(p)}, false, s.notNegative, s.most};
    for (const Property& property : kProperties)
        for (std::size_t i = 0; i < p.specimens.size(); ++i)
            if (name == property.name) {
                Target all{{}, property.positive, false};
                for (SpecimenParameters& s : p.specimens)
                    all.values.push_back(&(s.*property.value));
                return all;
            } else if (i < e.specimens.size() && name == property.name + ("." + e.specimens[i].id)) {
                return {{&(p.specimens[i].*property.value)}, property.positive, false};
            }
    return {};
}

} // namespace

bool holdsIn(const SceneValue& v, const Experiment& e, std::size_t run) {
    return v.specimen >= 0 ? v.specimen == e.runs[run].specimen && std::isfinite(v.value)
                           : v.run < 0 || static_cast<std::size_t>(v.run) == run;
}

Parameters nominal(const Experiment& e) {
    Parameters p;
    for (const Specimen& s : e.specimens)
        p.specimens.push_back(
            {s.bendingModulus.value, s.naturalCurvature.value, s.thickness.value, s.linearMass.value});
    p.gravity = e.gravity;
    if (e.scene) {
        forEachOfScene(e, [&](const experiment::SceneParameter& s, int run, int specimen, bool ofBatch) {
            p.scene.push_back(
                {s.name, run, ofBatch ? std::numeric_limits<double>::quiet_NaN() : s.stated.value, specimen});
        });
        p.readingZero = e.scene->zero.value;
        for (const experiment::FurtherChannel& c : e.scene->further)
            p.furtherZero.push_back(c.zero.value);
        return p;
    }
    p.friction = e.friction.value;
    p.touchCompliance = stretch(e);
    return p;
}

std::vector<ParameterInfo> parameterList(const Experiment& e) {
    if (e.scene)
        return sceneList(e);
    std::vector<ParameterInfo> all;
    for (const Property& property : kProperties)
        if (!e.specimens.empty())
            all.push_back({property.name, property.unit, property.about, e.specimens.front().*property.stated});
    for (const Surrounding& s : kSurroundings)
        all.push_back({s.name, s.unit, s.about, s.stated(e)});
    for (const Specimen& specimen : e.specimens)
        for (const Property& property : kProperties)
            if (e.specimens.size() > 1)
                all.push_back({property.name + ("." + specimen.id), property.unit,
                               std::string(property.about) + ", of specimen " + specimen.id,
                               specimen.*property.stated});
    return all;
}

namespace {

/// What a channel of a scene observes; 0: the first one.
const scene::Observation& observationOf(const Experiment& e, std::size_t channel) {
    return channel == 0 ? e.scene->observation : e.scene->further[channel - 1].observation;
}

/// Index of the channel that a sensor belongs to; nothing if there is none.
std::optional<std::size_t> channelOf(const effects::Setting& s, const Experiment& e) {
    if (s.channel.empty())
        return 0;
    const auto& further = experiment::furtherChannels(e);
    for (std::size_t k = 0; k < further.size(); ++k)
        if (further[k].observe == s.channel)
            return k + 1;
    return std::nullopt;
}

/// Why a sensor acts on no channel; empty: it does.
std::string channelProblem(const effects::Setting& s, const Experiment& e) {
    if (channelOf(s, e))
        return {};
    std::vector<std::string> names;
    for (const experiment::FurtherChannel& c : experiment::furtherChannels(e))
        names.push_back(c.observe);
    return s.channel == experiment::channel(e).name
               ? "sensor effects act on the first channel, " + s.channel + ", without \"channel\""
               : "there is no channel \"" + s.channel + "\" beside the first one" + didYouMean(s.channel, names);
}

/// Whether an effect depends on times, speeds or rests, which a table does not record.
bool needsClock(effects::Key key) {
    switch (key) {
    case effects::Key::ViscoelasticBending:
    case effects::Key::SofteningOverTime:
    case effects::Key::StaticFrictionExcess:
    case effects::Key::RateDependentFriction:
    case effects::Key::RateAndStateFriction:
    case effects::Key::SensorDrift:
    case effects::Key::SensorDelay:
        return true;
    default:
        return false;
    }
}

} // namespace

bool acts(const Experiment& experiment, effects::Key key, std::size_t channel) {
    const bool mechanism = experiment::isMechanism(experiment);
    if (experiment::isTable(experiment) && needsClock(key))
        return false;
    switch (key) {
    case effects::Key::BearingFriction:
        return mechanism && experiment.scene->turns;
    case effects::Key::AirDrag: // rods that are moved slowly feel none
        return mechanism || experiment::isFree(experiment);
    case effects::Key::GuideFriction:
    case effects::Key::NonlinearSpring:
        return mechanism;
    case effects::Key::StaticFrictionExcess:
    case effects::Key::RateDependentFriction:
    case effects::Key::RateAndStateFriction:
    case effects::Key::Wear:
        return !experiment.scene || experiment.scene->rubs;
    case effects::Key::Adhesion:
    case effects::Key::ContactCompliance:
        return !experiment.scene || (!mechanism && experiment.scene->rubs);
    case effects::Key::Backlash:
    case effects::Key::MachineCompliance:
    case effects::Key::SupportSettlement:
    case effects::Key::Misalignment:
        return !experiment::isFree(experiment) && !experiment::drivesLoad(experiment) &&
               (!mechanism || key == effects::Key::Backlash);
    case effects::Key::ClampCompliance:
        return experiment.scene ? experiment.scene->clamps
                                : std::any_of(experiment.specimens.begin(), experiment.specimens.end(),
                                              [](const experiment::Specimen& s) {
                                                  return s.clamp.where != experiment::ClampPlace::None;
                                              });
    case effects::Key::SensorDrift:
        return !experiment.scene || observationOf(experiment, channel).of == scene::Observation::Of::Machine;
    case effects::Key::Gravity:
    case effects::Key::SensorGain:
    case effects::Key::SensorDelay:
        return true;
    default:
        return !mechanism;
    }
}

std::size_t freeNumbers(const Experiment& experiment) {
    const std::vector<ParameterInfo> all = parameterList(experiment);
    return static_cast<std::size_t>(std::count_if(
        all.begin(), all.end(), [](const ParameterInfo& p) { return p.stated.halfWidth > 0.0 && !p.ofBatch; }));
}

std::string checkEffects(const Parameters& parameters, const Experiment& experiment) {
    for (const effects::Setting& s : parameters.effects)
        if (std::string why = channelProblem(s, experiment); !why.empty())
            return why;
        else if (!effects::isOff(s) && !acts(experiment, s.key, channelOf(s, experiment).value_or(0)))
            return "effect " + effects::catalog()[static_cast<std::size_t>(s.key)].name +
                   (experiment::isTable(experiment) && needsClock(s.key)
                        ? " needs the times of the rows, which a table does not have"
                    : experiment::isMechanism(experiment) ? " has nothing to act on in this scene of rigid bodies"
                    : experiment::isFree(experiment)      ? " has nothing to act on in this scene without a machine"
                    : s.key == effects::Key::AirDrag
                        ? " acts where shells or bodies move freely, which this experiment is not about"
                        : " acts only on the rigid bodies of a scene, which this experiment is not");
    std::vector<std::string> known;
    for (const Specimen& s : experiment.specimens)
        known.push_back(s.id);
    for (const std::string& shell : effects::shellsNamed(parameters.effects))
        if (std::find(known.begin(), known.end(), shell) == known.end()) {
            return "there is no specimen \"" + shell + "\"" + didYouMean(shell, known);
        }
    return effects::validate(parameters.effects);
}

std::string set(Parameters& parameters, const Experiment& experiment, const std::string& name, double value) {
    if (name.find(':') != std::string::npos) {
        char number[32];
        std::snprintf(number, sizeof number, "%.17g", value);
        return effects::add(parameters.effects, name + "=" + number);
    }
    const Target target = find(parameters, experiment, name);
    if (target.values.empty()) {
        std::vector<std::string> names;
        std::string all;
        for (const ParameterInfo& info : parameterList(experiment)) {
            names.push_back(info.name);
            all += (all.empty() ? "" : ", ") + info.name;
        }
        return "there is no parameter \"" + name + "\"; expected one of " + all + didYouMean(name, names);
    }
    char shown[32];
    std::snprintf(shown, sizeof shown, "%.10g", value);
    if (!std::isfinite(value) || (target.positive && value <= 0.0) || (target.notNegative && value < 0.0) ||
        value > target.most)
        return "parameter " + name + ": " + shown + " is out of range; expected a finite number" +
               (target.positive      ? " > 0"
                : target.notNegative ? " >= 0"
                                     : "") +
               (std::isfinite(target.most) ? " and at most 1" : "");
    for (double* v : target.values)
        *v = value;
    return {};
}

std::optional<double> get(const Parameters& parameters, const Experiment& experiment, const std::string& name) {
    if (const std::size_t colon = name.find(':'); colon != std::string::npos) {
        const effects::Effect* effect = effects::find(name.substr(0, colon));
        for (std::size_t i = 0; effect != nullptr && i < effect->parameters.size(); ++i)
            if (effect->parameters[i].name == name.substr(colon + 1)) {
                for (const effects::Setting& s : parameters.effects)
                    if (s.key == effect->key)
                        return s.values[i];
                return effect->parameters[i].off;
            }
        return std::nullopt;
    }
    Parameters copy = parameters;
    const Target target = find(copy, experiment, name);
    if (target.values.empty())
        return std::nullopt;
    if (experiment.scene && std::isnan(*target.values.front())) // of the batch: the common value
        return get(parameters, experiment, name.substr(0, name.rfind('.')));
    return *target.values.front();
}

} // namespace supercircle::replay
