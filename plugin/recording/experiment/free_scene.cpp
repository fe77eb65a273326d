#include "plugin/recording/experiment/free_scene.h"

#include "plugin/scene/loader/loader.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace supercircle::experiment {

namespace {

constexpr double kDegrees = 180.0 / 3.14159265358979323846;
constexpr Channel kForce{"force", "N", "force_N", 1.0};
constexpr Channel kAngle{"angle", "deg", "angle_deg", kDegrees};
constexpr Channel kAngleRad{"angle", "rad", "angle_rad", 1.0};
constexpr Channel kX{"x", "mm", "x_mm", 1e3};
constexpr Channel kY{"y", "mm", "y_mm", 1e3};

/// The scene with the nominal parameters of a run.
Result<scene::Scene> nominalScene(const Experiment& e, const Run& run, const std::string& path,
                                  std::vector<scene::Problem>& problems) {
    std::vector<scene::Override> overrides;
    for (const auto* list : {&e.scene->parameters, &run.parameters})
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
    if (!s.shells.empty() || s.drop || s.protocol)
        complain("a free scene has rigid bodies only: no shells, no \"drop\", no \"protocol\"",
                 "freely moving bodies on joints");
    std::vector<std::string> names;
    for (const step::BodyDefinition& b : s.rigid.bodies)
        names.push_back(b.name);
    const auto need = [&](const std::string& body) {
        if (std::find(names.begin(), names.end(), body) == names.end())
            complain("there is no body \"" + body + "\", whose pose is recorded", {}, nearestName(body, names));
    };
    need(e.scene->body);
    for (const Marker& m : e.markers)
        need(m.body);
}

} // namespace

const Channel& channel(const Experiment& e) {
    if (!e.scene)
        return kForce;
    return e.scene->quantity == Quantity::Angle ? kAngle : e.scene->quantity == Quantity::X ? kX : kY;
}

std::vector<Channel> columnsOf(const Experiment& e) {
    if (e.scene && e.scene->quantity == Quantity::Angle)
        return {kAngle, kAngleRad};
    return {channel(e)};
}

std::vector<SceneParameter> readSceneParameters(Context& context, Object& object, const std::string& key) {
    std::vector<SceneParameter> all;
    const Node* node = object.find(key);
    if (node == nullptr)
        return all;
    const std::string pointer = object.pointerTo(key);
    if (node->kind != Node::Kind::Object) {
        context.error(*node, pointer, "not an object", "{\"NAME\": {\"value\": 1, \"unc\": 0.1}, ...}");
        return all;
    }
    for (const Node& child : node->children) {
        const std::string at = pointer + "/" + child.key;
        if (child.kind != Node::Kind::Object) {
            all.push_back({child.key, {numberAt(context, child, at, scene::anyNumber), 0.0}, {}, {}});
            continue;
        }
        Object stated(context, child, at);
        const double value = stated.number("value", scene::anyNumber);
        all.push_back({child.key, {value, stated.number("unc", 0.0, scene::notNegative)}, {}, {}});
        stated.finish();
    }
    return all;
}

FreeScene readFreeScene(Context& context, Object& top) {
    FreeScene s;
    s.file = top.text("scene");
    s.parameters = readSceneParameters(context, top, "scene_parameters");
    if (const Node* node = top.required("observed", "an object")) {
        Object observed(context, *node, top.pointerTo("observed"));
        if (observed.valid()) {
            s.body = observed.text("body");
            s.quantity = static_cast<Quantity>(observed.choice("quantity", {"angle", "x", "y"}));
            s.zeroHalfWidth = s.quantity == Quantity::Angle
                                  ? observed.number("zero_unc_deg", 0.0, scene::notNegative) / kDegrees
                                  : 1e-3 * observed.number("zero_unc_mm", 0.0, scene::notNegative);
        }
        observed.finish();
    }
    return s;
}

std::vector<Bowstring> readStrings(Context& context, Object& top) {
    std::vector<Bowstring> all;
    if (top.find("strings") == nullptr)
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

void readSceneFile(Experiment& e, std::vector<scene::Problem>& problems) {
    const std::string path = (std::filesystem::path(e.file).parent_path() / e.scene->file).string();
    const auto text = scene::readFile(path, problems);
    if (!text)
        return;
    e.scene->text = *text;
    for (Run& run : e.runs) {
        std::vector<scene::Problem> found;
        const auto scene = nominalScene(e, run, path, found);
        if (scene) {
            judgeScene(e, *scene, path, found);
            takeWords(*scene, e.scene->parameters);
            takeWords(*scene, run.parameters);
        }
        std::erase_if(found, [](const scene::Problem& p) { return p.severity == scene::Problem::Severity::Note; });
        problems.insert(problems.end(), found.begin(), found.end());
        if (!found.empty())
            return; // the other runs have the same problem
    }
}

} // namespace supercircle::experiment
