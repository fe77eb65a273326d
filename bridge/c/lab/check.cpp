// Checks scenes, sweeps and experiments without running them.

#include "bridge/box2d/lab_world.h"
#include "bridge/c/lab/request.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/lab/session/run_scene.h"
#include "plugin/lab/sweep/definition.h"
#include "plugin/recording/experiment/load.h"
#include "plugin/scene/loader/document.h"
#include "plugin/scene/loader/loader.h"

using namespace supercircle::c;
namespace experiment = supercircle::experiment;
namespace lab = supercircle::lab;
namespace scene = supercircle::scene;
namespace sweep = supercircle::sweep;

namespace {

using Problems = std::vector<scene::Problem>;

scene::Problem problem(const std::string& file, const std::string& what) {
    scene::Problem p;
    p.file = file;
    p.what = what;
    return p;
}

std::string schemaOf(const std::string& text) {
    Problems ignored; // the reader of that kind reports them
    const auto document = scene::parseDocument(text, "", ignored);
    const auto schema = document ? document->root().find("schema") : std::nullopt;
    return schema ? schema->text() : "";
}

Json checkScene(const std::string& text, const std::string& file, const Request& r, Problems& problems) {
    std::vector<scene::Override> overrides;
    for (const auto& [name, value] : r.numbers("parameters"))
        overrides.push_back({name, value});
    const auto loaded = scene::loadText(text, file, overrides, problems);
    if (!loaded)
        return {};
    const bool mechanism = scene::isMechanism(*loaded);
    if (!mechanism) {
        std::string why;
        std::shared_ptr<supercircle::step::HostWorld> host = supercircle::bridge::makeWorld(loaded->rigid, why);
        const std::atomic<bool> interrupt{true}; // only a session can tell whether the start is free of overlaps
        lab::RunOptions options;
        options.interrupt = &interrupt;
        options.keepFrames = false;
        const lab::RunResult out = host ? lab::runScene(*loaded, host, options) : lab::RunResult{};
        if (!host || out.status == lab::RunStatus::BadScene)
            problems.push_back(problem(file, host ? out.message : why));
    }
    Json parameters = Json::object();
    for (const scene::Parameter& p : loaded->parameters)
        parameters[p.name] = {{"value", p.value},
                              {"min", numberJson(p.min)},
                              {"max", numberJson(p.max)},
                              {"unit", p.unit},
                              {"about", p.about}};
    return {{"name", loaded->name},
            {"about", loaded->about},
            {"shells", loaded->shells.size()},
            {"dropped", loaded->drop ? loaded->drop->count : 0},
            {"bodies", loaded->rigid.bodies.size()},
            {"mechanism", mechanism},
            {"parameters", parameters}};
}

Json checkSweep(const std::string& text, const std::string& file, Problems& problems) {
    const auto loaded = sweep::loadText(text, file, problems);
    const auto sceneText =
        loaded ? scene::readFile(loaded->scene, problems) : supercircle::Result<std::string>::failure("no sweep");
    if (!sceneText)
        return {};
    for (std::size_t set = 0; set < loaded->sets.size(); ++set)
        try {
            (void)startable(*sceneText, loaded->scene, loaded->parameterValues(set));
        } catch (const Refusal& e) {
            problems.push_back(problem(file, sweep::keyOf(loaded->parameterValues(set)) + ": " + e.why));
        }
    return {{"name", loaded->name},
            {"sets", loaded->sets.size()},
            {"seeds", loaded->seeds.size()},
            {"varied", loaded->names}};
}

Json checkExperiment(const std::string& file, Problems& problems) {
    const auto loaded = experiment::load(file, problems);
    if (!loaded)
        return {};
    Json runs = Json::array(), parameters = Json::object();
    for (const experiment::Run& run : loaded->runs)
        runs.push_back({{"file", run.file}, {"samples", run.readings.time.size()}});
    const supercircle::replay::Parameters values = supercircle::replay::nominal(*loaded);
    for (const auto& p : supercircle::replay::parameterList(*loaded))
        parameters[p.name] = {{"value", supercircle::replay::get(values, *loaded, p.name).value_or(0.0)},
                              {"uncertainty", p.stated.halfWidth},
                              {"unit", p.unit},
                              {"about", p.about}};
    return {{"protocol", experiment::name(loaded->protocol)},
            {"runs", runs},
            {"markers", loaded->markers.size()},
            {"free", experiment::isFree(*loaded)},
            {"parameters", parameters}};
}

Json problemsJson(const Problems& problems) {
    Json out = Json::array();
    for (const scene::Problem& p : problems)
        out.push_back({{"file", p.file},
                       {"line", p.line},
                       {"column", p.column},
                       {"pointer", p.pointer},
                       {"what", p.what},
                       {"expected", p.expected},
                       {"nearest", p.nearest},
                       {"note", p.severity == scene::Problem::Severity::Note},
                       {"text", p.toString()}});
    return out;
}

} // namespace

const char* sc_lab_check(const char* request, sc_lab_progress progress, void* context) {
    return answer([&] {
        const Request r(request, {"scene", "file", "parameters", "content"});
        const supercircle::TextsInMemory content(r.content());
        const auto source = sceneText(r);
        return watched(progress, context, [&](Watch&) {
            const auto& [text, file] = source;
            const std::string schema = schemaOf(text);
            const bool isExperiment = schema.rfind("rod-recordings/", 0) == 0;
            const bool isSweep = schema.rfind("supercircle-sweep/", 0) == 0;
            if (isExperiment && r.has("scene"))
                refuse(SC_BAD_INPUT, "an experiment is checked with its recordings: give its \"file\" alone");
            Problems problems;
            Json found = isExperiment ? checkExperiment(file, problems)
                         : isSweep    ? checkSweep(text, file, problems)
                                      : checkScene(text, file, r, problems);
            return Json{{"kind", isExperiment ? "experiment"
                                 : isSweep    ? "sweep"
                                              : "scene"},
                        {"valid", !scene::anyError(problems)},
                        {"problems", problemsJson(problems)},
                        {"content", std::move(found)}};
        });
    });
}
