#include "plugin/recording/experiment/free_scene.h"

#include "plugin/recording/experiment/scene_specimens.h"
#include "plugin/scene/loader/loader.h"
#include "plugin/scene/loader/shipped.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace supercircle::experiment {

namespace {

const Channel kForce{"force", "N", "force_N", 1.0, 1.0};
const Channel kAngle{"angle", "deg", "angle_deg", kDegrees, 1.0};
const Channel kAngleRad{"angle", "rad", "angle_rad", 1.0, 1.0};
const Channel kX{"x", "mm", "x_mm", 1e3, 1.0};
const Channel kY{"y", "mm", "y_mm", 1e3, 1.0};

/// The scene with the nominal parameters of a run.
Result<scene::Scene> nominalScene(const Experiment& e, const Run& run, const std::string& path,
                                  std::vector<scene::Problem>& problems) {
    std::vector<scene::Override> overrides;
    std::vector<const std::vector<SceneParameter>*> lists = {&e.scene->parameters, &run.parameters};
    if (run.specimen >= 0)
        lists.insert(lists.begin() + 1, &e.scene->specimens[static_cast<std::size_t>(run.specimen)].parameters);
    for (const auto* list : lists)
        for (const SceneParameter& p : *list)
            overrides.push_back({p.name, p.stated.value});
    return scene::loadText(e.scene->text, path, overrides, problems);
}

void takeWords(const scene::Scene& s, std::vector<SceneParameter>& parameters) {
    for (SceneParameter& p : parameters)
        for (const scene::Parameter& known : s.parameters)
            if (known.name == p.name) {
                p.unit = known.unit;
                p.about = known.about;
            }
}

/// What of a scene with shells cannot be simulated in an experiment.
template <class Complain>
void judgeShells(const scene::Scene& s, const Complain& complain) {
    if (s.drop)
        complain("dropped shells lie otherwise in every run", "shells at stated places");
    if (!s.rigid.joints.empty())
        complain("joints of bodies beside shells are not simulated in experiments", "a scene without \"joint\"");
    for (const step::BodyDefinition& b : s.rigid.bodies)
        if (b.type == step::BodyType::Dynamic)
            complain(
                "the body \"" + b.name +
                    "\" can be pushed: Box2D would move it in single precision, whose noise hides what a fit asks for",
                "bodies at rest or moved by the machine");
        else if (b.type == step::BodyType::Kinematic && (!s.protocol || b.name != s.protocol->body))
            complain("the body \"" + b.name + "\" moves, but not with the machine", "a body of type 0");
    std::vector<std::string> names;
    for (const ShellDef& d : s.shells) {
        if (d.name.empty() || std::find(names.begin(), names.end(), d.name) != names.end())
            complain(d.name.empty() ? "a shell has no name" : "two shells are named \"" + d.name + "\"",
                     "a name for each shell");
        names.push_back(d.name);
    }
}

/// A shell of a scene as a specimen, for scales and effects.
Specimen specimenOf(const ShellDef& d) {
    Specimen s;
    s.id = d.name;
    s.length = d.length > 0.0 ? d.length : 2.0 * 3.14159265358979323846 * d.phi_bar * d.radius;
    s.naturalCurvature.value = !d.natural_curvature.empty() ? d.natural_curvature.front() : 1.0 / d.radius;
    s.thickness.value = d.thickness;
    s.width = d.width;
    s.youngModulus = d.young_modulus;
    s.bendingModulus.value = bending_modulus(d);
    s.linearMass.value = d.density * d.width * d.thickness;
    for (const PointMassDef& m : d.mass_at) // it swings as slowly as a rod of that mass
        s.linearMass.value += m.mass / s.length;
    return s;
}

void takeShells(Experiment& e, const scene::Scene& s) {
    for (const ShellDef& d : s.shells)
        e.specimens.push_back(specimenOf(d));
    for (Marker& m : e.markers)
        for (std::size_t i = 0; i < e.specimens.size(); ++i)
            if (e.specimens[i].id == m.body)
                m.specimen = i;
}

const std::string& nameOf(effects::Key key) {
    return std::find_if(effects::catalog().begin(), effects::catalog().end(),
                        [key](const effects::Effect& e) { return e.key == key; })
        ->name;
}

/// What experiments leave out of a scene, so that a number of it would change nothing.
void judgeWhatActs(const scene::Scene& s, const auto& complain) {
    for (const effects::Setting& effect : s.effects) {
        if (effect.key == effects::Key::Gravity || effect.key == effects::Key::Misalignment)
            continue; // they are in the scene's gravity and bodies already
        const std::string& name = nameOf(effect.key);
        complain("the effect \"" + name + "\" of the scene does not act in an experiment",
                 "a scene without it, and --effect " + name + ":... of replay; diagnose and calibrate try effects");
    }
    if (!s.shells.empty())
        return;
    const std::vector<step::BodyDefinition>& bodies = s.rigid.bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto id = static_cast<std::int32_t>(i);
        const bool held = std::any_of(s.rigid.joints.begin(), s.rigid.joints.end(),
                                      [&](const step::JointDefinition& j) { return j.bodyA == id || j.bodyB == id; });
        const bool others = std::any_of(bodies.begin(), bodies.end(), [&](const step::BodyDefinition& b) {
            return &b != &bodies[i] && !b.fixtures.empty();
        });
        if (bodies[i].type == step::BodyType::Dynamic && !held && others && !bodies[i].fixtures.empty())
            complain("the body \"" + bodies[i].name +
                         "\" hangs on no joint, and bodies do not touch each other in an "
                         "experiment without shells",
                     "a joint, such as a prismatic one with \"friction\" for what slides");
    }
}

void judgeScene(const Experiment& e, const scene::Scene& s, const std::string& path,
                std::vector<scene::Problem>& problems) {
    const auto complain = [&](const std::string& what, const std::string& expected, const std::string& near = {}) {
        scene::Problem p;
        p.file = path;
        p.what = what;
        p.expected = expected;
        p.nearest = near;
        problems.push_back(std::move(p));
    };
    const bool free = e.protocol == Protocol::FreeScene;
    if (free && (!s.shells.empty() || s.drop || s.protocol))
        complain("a free scene has rigid bodies only: no shells, no \"drop\", no \"protocol\"", "bodies on joints");
    else if (s.shells.empty() && s.protocol && s.protocol->body.empty())
        complain("the machine of the scene moves no body", "a \"protocol\" with a \"body\"");
    else if (!s.shells.empty() || s.drop)
        judgeShells(s, complain);
    judgeWhatActs(s, complain);
    std::vector<std::string> names;
    for (const step::BodyDefinition& b : s.rigid.bodies)
        if (s.shells.empty())
            names.push_back(b.name);
    for (const ShellDef& d : s.shells)
        names.push_back(d.name);
    const auto need = [&](const std::string& name) {
        if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
            complain(s.shells.empty() ? "there is no body \"" + name + "\", whose pose is recorded"
                                      : "there is no shell \"" + name + "\", whose motion is recorded",
                     {}, nearestName(name, names));
    };
    if (e.scene->observation.of == scene::Observation::Of::Body)
        need(e.scene->observation.target);
    for (const FurtherChannel& c : e.scene->further)
        if (c.observation.of == scene::Observation::Of::Body)
            need(c.observation.target);
    for (const Marker& m : e.markers)
        need(m.body);
}

} // namespace

const Channel& channel(const Experiment& e) {
    return e.scene ? e.scene->channel : kForce;
}

const std::vector<FurtherChannel>& furtherChannels(const Experiment& e) {
    static const std::vector<FurtherChannel> kNone;
    return e.scene ? e.scene->further : kNone;
}

std::vector<Channel> columnsOf(const Experiment& e) {
    if (e.scene && e.scene->observe.empty() && e.scene->observation.quantity == scene::Observation::Quantity::Angle)
        return {kAngle, kAngleRad};
    return {channel(e)};
}

/// `value` with `unc` (a half-width), `std` or `std_log`.
Stated readStated(Object& object) {
    Stated out;
    out.value = object.number("value", scene::anyNumber);
    const bool normal = object.find("std").has_value(), logNormal = object.find("std_log").has_value();
    if (normal + logNormal + object.find("unc").has_value() > 1) {
        object.error(logNormal ? "std_log" : "std", "two things are said of its uncertainty",
                     R"("unc" (half-width of an interval), "std" (normal) or "std_log" (log-normal))");
        return out;
    }
    out.halfWidth = object.number("unc", 0.0, scene::notNegative);
    if (normal)
        out.halfWidth = Stated::kDeviations * object.number("std", 0.0, scene::notNegative);
    if (logNormal) {
        out.halfWidth = Stated::kDeviations * std::abs(out.value) * object.number("std_log", 0.0, scene::notNegative);
        if (!(out.value > 0.0))
            object.error("std_log", "the logarithm of the stated value does not exist", "a value above 0, or \"std\"");
    }
    if (out.halfWidth > 0.0)
        out.prior = normal ? Prior::Normal : logNormal ? Prior::LogNormal : Prior::Interval;
    return out;
}

std::vector<SceneParameter> readSceneParameters(Context& context, Object& object, const std::string& key) {
    std::vector<SceneParameter> all;
    const std::optional<Node> node = object.find(key);
    if (!node)
        return all;
    const std::string pointer = object.pointerTo(key);
    if (node->kind() != Node::Kind::Object) {
        context.error(*node, pointer, "not an object", "{\"NAME\": {\"value\": 1, \"unc\": 0.1}, ...}");
        return all;
    }
    for (const Node& child : node->children()) {
        const std::string at = pointer + "/" + child.key();
        if (child.kind() != Node::Kind::Object) {
            all.push_back({child.key(), {numberAt(context, child, at, scene::anyNumber), 0.0}, {}, {}});
            continue;
        }
        Object stated(context, child, at);
        all.push_back({child.key(), readStated(stated), {}, {}});
        stated.finish();
    }
    return all;
}

FreeScene readFreeScene(Context& context, Object& top) {
    FreeScene s;
    s.file = top.text("scene");
    s.parameters = readSceneParameters(context, top, "scene_parameters");
    if (const std::optional<Node> node = top.required("observed", "an object")) {
        Object observed(context, *node, top.pointerTo("observed"));
        if (observed.valid()) {
            s.observation.target = observed.text("body");
            const std::vector<std::string> quantities = {"angle", "x", "y"}; // as Observation::Quantity
            const std::size_t quantity = observed.choice("quantity", quantities) % quantities.size();
            s.observation.quantity = static_cast<scene::Observation::Quantity>(quantity);
            s.channel = quantity == 0 ? kAngle : quantity == 1 ? kX : kY;
            s.zero.halfWidth = quantity == 0 ? observed.number("zero_unc_deg", 0.0, scene::notNegative) / kDegrees
                                             : 1e-3 * observed.number("zero_unc_mm", 0.0, scene::notNegative);
        }
        observed.finish();
    }
    return s;
}

std::vector<Bowstring> readStrings(Context& context, Object& top) {
    std::vector<Bowstring> all;
    if (!top.find("strings"))
        return all;
    for (const ArrayItem& place : top.array("strings", false)) {
        Object object(context, place);
        if (!object.valid())
            continue;
        Bowstring s;
        s.arcFraction = object.number("arc_fraction", {0.0, 1.0, false});
        s.point = object.pair("to_point_m");
        s.carriedBy =
            object.choice("carried_by", {"ground", "machine_head"}) == 1 ? Carrier::Crosshead : Carrier::Ground;
        object.finish();
        all.push_back(s);
    }
    return all;
}

/// /drive: which column drives the scene, and what it drives.
void readSceneDrive(Context& context, Object& top, FreeScene& s) {
    const std::optional<Node> node = top.find("drive");
    if (!node)
        return;
    Object drive(context, *node, top.pointerTo("drive"));
    if (!drive.valid())
        return;
    s.driveColumn = drive.text("column", "");
    s.driveParameter = drive.text("parameter", "");
    double perUnit = 1.0;
    if (s.driveParameter.empty() && !s.driveColumn.empty()) {
        perUnit = 0.0;
        for (const Unit& u : unitsOf(scene::Observation::Quantity::Travel))
            if (s.driveColumn.ends_with(std::string("_") + u.name))
                perUnit = u.perUnit;
        if (perUnit == 0.0)
            drive.error("column", "the column \"" + s.driveColumn + "\" names no unit",
                        "a name that ends with _mm, _m or _um");
    }
    s.driveScale = drive.number("scale", 1.0, scene::anyNumber) / std::max(perUnit, 1e-300);
    if (s.driveColumn.empty() && s.driveParameter.empty())
        drive.error("column", "nothing says what is driven", "\"column\", \"parameter\" or both");
    drive.finish();
}

/// An entry of /channels, with zero and noise in the unit of its column.
FurtherChannel readChannel(Context& context, Object& object) {
    FurtherChannel c;
    c.observe = object.text("observe");
    c.channel.column = object.text("column");
    c.channel.unit = object.text("unit", "");
    c.channel.sign = object.number("sign", 1.0, {-1.0, 1.0, false});
    if (std::abs(c.channel.sign) != 1.0)
        object.error("sign", "a sign of " + std::to_string(c.channel.sign), "1 or -1");
    c.channel.weight = object.number("weight", 1.0, scene::notNegative);
    c.noise = object.number("noise_std", 0.0, scene::notNegative);
    if (const std::optional<Node> node = object.find("zero")) {
        Object zero(context, *node, object.pointerTo("zero"));
        if (zero.valid())
            c.zero = {zero.number("value", 0.0, scene::anyNumber), zero.number("unc", 0.0, scene::notNegative)};
        zero.finish();
    }
    return c;
}

FreeScene readScene(Context& context, Object& top, Sensors& sensors) {
    FreeScene s;
    s.file = top.text("scene");
    s.parameters = readSceneParameters(context, top, "scene_parameters");
    readSceneDrive(context, top, s);
    readSpecimensOf(s, context, top);
    for (const ArrayItem& place : top.array("channels", true)) {
        Object object(context, place);
        if (!object.valid())
            continue;
        FurtherChannel c = readChannel(context, object);
        if (!s.observe.empty()) {
            object.finish();
            s.further.push_back(std::move(c));
            continue;
        }
        if (c.channel.weight == 0.0)
            object.error("weight", "the first channel has no weight", "a number above 0, or another channel first");
        s.observe = std::move(c.observe);
        s.channel = std::move(c.channel);
        s.zero = c.zero;
        sensors.forceNoise = c.noise;
        object.finish();
    }
    return s;
}

/// The scene file: beside the experiment, or a shipped one, which is named without an ending. Empty: there is none.
std::string pathOf(const Experiment& e) {
    if (namesShipped(*e.scene))
        return scene::shippedScene(e.scene->file);
    return (std::filesystem::path(e.file).parent_path() / e.scene->file).string();
}

/// Finds what the channel observes, and whether the scene is driven.
void takeObservation(Experiment& e, const scene::Scene& s, const std::string& path,
                     std::vector<scene::Problem>& problems) {
    FreeScene& own = *e.scene;
    const auto any = [&](auto has) { return std::any_of(s.rigid.joints.begin(), s.rigid.joints.end(), has); };
    if (e.gravityOfScene)
        e.gravity = {s.rigid.gravity.x(), s.rigid.gravity.y()};
    own.turns = any([](const step::JointDefinition& j) { return j.kind == step::JointKind::Revolute; });
    own.clamps =
        std::any_of(s.holds.begin(), s.holds.end(), [](const HoldDef& h) { return h.kind == HoldKind::Clamp; });
    own.rubs =
        any([](const step::JointDefinition& j) { return j.friction.sticking > 0.0; }) ||
        (!s.shells.empty() && (s.shells.size() > 1 || std::any_of(s.rigid.bodies.begin(), s.rigid.bodies.end(),
                                                                  [](const auto& b) { return !b.fixtures.empty(); })));
    if (own.observe.empty())
        return;
    const auto complain = [&](const std::string& pointer, const std::string& what, const std::string& expected,
                              const std::string& nearest = {}) {
        scene::Problem p;
        p.file = e.file;
        p.pointer = pointer;
        p.what = what;
        p.expected = expected;
        p.nearest = nearest;
        problems.push_back(std::move(p));
    };
    std::vector<std::string> names;
    for (const scene::Observation& o : s.observe)
        names.push_back(o.name);
    const auto take = [&](std::size_t index, const std::string& observe, scene::Observation& observation, Channel& c,
                          Stated& zero) {
        const std::string pointer = "/channels/" + std::to_string(index);
        const auto at = std::find(names.begin(), names.end(), observe);
        if (at == names.end()) {
            complain(pointer + "/observe", "the scene " + path + " observes no \"" + observe + "\"",
                     names.empty() ? "a scene with \"observe\"" : "", nearestName(observe, names));
            return false;
        }
        observation = s.observe[static_cast<std::size_t>(at - names.begin())];
        if (const std::string why = setChannel(observe, observation, c, zero); !why.empty())
            complain(pointer, why, "a unit at the end of \"column\", or \"unit\"");
        return true;
    };
    if (!take(0, own.observe, own.observation, own.channel, own.zero))
        return;
    e.sensors.forceNoise /= own.channel.perUnit;
    std::vector<std::string> seen = {own.observe};
    for (std::size_t k = 0; k < own.further.size(); ++k) {
        FurtherChannel& c = own.further[k];
        if (!take(k + 1, c.observe, c.observation, c.channel, c.zero))
            continue;
        c.noise /= c.channel.perUnit;
        if (std::find(seen.begin(), seen.end(), c.observe) != seen.end())
            complain("/channels/" + std::to_string(k + 1) + "/observe", "\"" + c.observe + "\" is compared twice",
                     "one channel for each observation");
        seen.push_back(c.observe);
    }
    own.driven = s.protocol.has_value() || !own.driveParameter.empty();
    std::vector<std::string> parameters;
    for (const scene::Parameter& known : s.parameters) {
        parameters.push_back(known.name);
        if (known.name == own.driveParameter)
            own.driveUnit = known.unit;
    }
    if (!own.driveParameter.empty() &&
        std::find(parameters.begin(), parameters.end(), own.driveParameter) == parameters.end())
        complain("/drive/parameter", "the scene " + path + " has no parameter \"" + own.driveParameter + "\"", {},
                 nearestName(own.driveParameter, parameters));
    if (!own.driveParameter.empty() && s.loads.empty())
        complain("/drive/parameter", "the scene " + path + " has no load that it could change",
                 "a scene with \"load\"");
    if (!own.driveParameter.empty() && s.protocol)
        complain("/drive/parameter", "the scene " + path + " has a machine, which is what drives it",
                 "a scene without \"protocol\", or a drive without \"parameter\"");
    for (std::size_t i = 0; i < e.runs.size(); ++i)
        if (own.driveColumn.empty() && e.runs[i].driveDisplacement.empty() == own.driven)
            complain("/runs/" + std::to_string(i),
                     own.driven ? "the scene has a machine, the run no drive"
                                : "the scene has no machine that is driven",
                     own.driven ? "drive_time_s and drive_displacement_mm, or a \"drive\" with a column"
                                : "a run without drive_time_s");
}

bool readSceneFile(Experiment& e, std::vector<scene::Problem>& problems) {
    const std::string path = pathOf(e);
    if (path.empty()) {
        scene::Problem p;
        p.file = e.file;
        p.pointer = "/scene";
        p.what = "no scene \"" + e.scene->file + "\" comes with the program";
        p.expected = "one of " + scene::shippedNames() + ", or a file NAME.json";
        problems.push_back(std::move(p));
        return false;
    }
    const auto text = scene::readFile(path, problems);
    if (!text)
        return false;
    e.scene->text = *text;
    bool known = false;
    for (Run& run : e.runs) {
        std::vector<scene::Problem> found;
        const auto scene = nominalScene(e, run, path, found);
        if (scene) {
            if (&run == &e.runs.front()) {
                takeObservation(e, *scene, path, found);
                takeShells(e, *scene);
                known = std::none_of(found.begin(), found.end(), [](const scene::Problem& p) {
                    return p.severity == scene::Problem::Severity::Error && p.pointer.starts_with("/channels");
                });
            }
            judgeScene(e, *scene, path, found);
            takeWords(*scene, e.scene->parameters);
            takeWords(*scene, run.parameters);
            for (SceneSpecimen& s : e.scene->specimens)
                takeWords(*scene, s.parameters);
        }
        std::erase_if(found, [](const scene::Problem& p) { return p.severity == scene::Problem::Severity::Note; });
        problems.insert(problems.end(), found.begin(), found.end());
        if (!found.empty())
            break; // the other runs have the same problem
    }
    return known;
}

} // namespace supercircle::experiment
