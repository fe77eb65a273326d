#include "plugin/recording/experiment/scene_specimens.h"

#include "plugin/recording/experiment/free_scene.h"
#include "supercircle/support/names.h"

#include <algorithm>
#include <cmath>

namespace supercircle::experiment {

namespace {

std::vector<std::string> idsOf(const FreeScene& scene) {
    std::vector<std::string> ids;
    for (const SceneSpecimen& s : scene.specimens)
        ids.push_back(s.id);
    return ids;
}

const SceneParameter* findIn(const std::vector<SceneParameter>& all, const std::string& name) {
    const auto at = std::find_if(all.begin(), all.end(), [&](const SceneParameter& p) { return p.name == name; });
    return at == all.end() ? nullptr : &*at;
}

void readSpecimens(FreeScene& scene, Context& context, Object& top) {
    for (const ArrayItem& place : top.array("specimens", true)) {
        Object object(context, place);
        if (!object.valid())
            continue;
        SceneSpecimen s;
        s.id = object.text("id");
        s.parameters = readSceneParameters(context, object, "parameters");
        const std::vector<std::string> before = idsOf(scene);
        // Parameters are named NAME.ID, and set by NAME.ID=VALUE.
        if (object.find("id") && (s.id.empty() || s.id.find_first_of(".:= ") != std::string::npos))
            object.error("id", "\"" + s.id + "\" is no name", "letters, digits, _ and -");
        else if (std::find(before.begin(), before.end(), s.id) != before.end())
            object.error("id", "there are two specimens \"" + s.id + "\"", "a name for each specimen");
        object.finish();
        scene.specimens.push_back(std::move(s));
    }
}

/// `{"std": {"scale": s}}`, `{"std_rel": {"scale": s}}` or `{"std": 0}`. @return scale of tau
double readScale(Context& context, Object& object, const SceneParameter& common) {
    const char* const forms = R"("std_rel": {"scale": 0.05}, "std": {"scale": 1e-5} or "std": 0)";
    const bool relative = object.find("std_rel").has_value();
    const char* const key = relative ? "std_rel" : "std";
    const std::optional<Node> node = object.find(key);
    if (!node || (relative && object.find("std"))) {
        object.error(key, node ? "\"std\" stands beside it" : "nothing is said of its scatter", forms);
        return 0.0;
    }
    if (node->kind() != Node::Kind::Object) {
        if (numberAt(context, *node, object.pointerTo(key), scene::anyNumber) != 0.0 || relative)
            object.error(key, "the scale of the scatter is not stated", forms);
        return 0.0;
    }
    Object stated(context, *node, object.pointerTo(key));
    const double scale = stated.number("scale", scene::positive);
    stated.finish();
    if (relative && common.stated.value == 0.0)
        object.error(key, "the stated value of \"" + common.name + "\" is 0", "\"std\" with a scale in its unit");
    return scale * (relative ? std::abs(common.stated.value) : 1.0);
}

void readBatch(FreeScene& scene, Context& context, Object& top, const Node& batch) {
    const std::string pointer = top.pointerTo("batch");
    if (batch.kind() != Node::Kind::Object) {
        context.error(batch, pointer, "not an object", R"({"NAME": {"std_rel": {"scale": 0.05}}, ...})");
        return;
    }
    if (scene.specimens.empty())
        top.error("batch", "there are no specimens that could differ", "\"specimens\", and \"specimen\" in each run");
    std::vector<std::string> names;
    for (const SceneParameter& p : scene.parameters)
        names.push_back(p.name);
    for (const Node& child : batch.children()) {
        const std::string name = child.key(), at = pointer + "/" + name;
        if (name == "about")
            continue;
        const SceneParameter* common = findIn(scene.parameters, name);
        if (common == nullptr) {
            context.error(child, at, "no scene_parameters say the mean of \"" + name + "\"",
                          "a name of scene_parameters", nearestName(name, names));
            continue;
        }
        for (const SceneSpecimen& s : scene.specimens)
            if (findIn(s.parameters, name) != nullptr)
                context.error(child, at, "specimen \"" + s.id + "\" states \"" + name + "\" itself",
                              "parameters that no specimen states");
        Object object(context, child, at);
        if (object.valid())
            scene.batch.push_back({name, readScale(context, object, *common)});
        object.finish();
    }
}

} // namespace

void readSpecimensOf(FreeScene& scene, Context& context, Object& top) {
    if (top.find("specimens"))
        readSpecimens(scene, context, top);
    if (const std::optional<Node> batch = top.find("batch"))
        readBatch(scene, context, top, *batch);
}

int readSpecimenOfRun(Object& object, const Run& run, const FreeScene& scene) {
    const std::vector<std::string> ids = idsOf(scene);
    const std::string id = object.text("specimen", "");
    for (const BatchParameter& b : scene.batch)
        if (findIn(run.parameters, b.name) != nullptr)
            object.error("parameters", "\"" + b.name + "\" belongs to the specimens, as \"batch\" says",
                         "parameters of this run alone");
    const auto at = std::find(ids.begin(), ids.end(), id);
    if (at != ids.end())
        return static_cast<int>(at - ids.begin());
    if (!id.empty())
        object.error("specimen", "there is no specimen \"" + id + "\"", ids.empty() ? "an entry of /specimens" : "",
                     nearestName(id, ids));
    else if (!ids.empty())
        object.error("specimen", "it is not said which specimen this run has", "an id of /specimens");
    return -1;
}

void noteUnusedSpecimens(const Experiment& e, Object& top) {
    for (std::size_t s = 0; s < e.scene->specimens.size(); ++s)
        if (std::none_of(e.runs.begin(), e.runs.end(),
                         [&](const Run& run) { return run.specimen == static_cast<int>(s); }))
            top.note("specimens", "no run has specimen \"" + e.scene->specimens[s].id + "\"");
}

} // namespace supercircle::experiment
