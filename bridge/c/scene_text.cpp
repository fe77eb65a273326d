#include "bridge/c/scene_text.h"

#include "bridge/box2d/rigid_check.h"
#include "bridge/c/json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace supercircle::c {

namespace {

/// The first thing in a valid scene that Box2D would answer by aborting the process. It has no place in the text.
std::vector<scene::Problem> hostProblems(const scene::Scene& s, const std::string& file) {
    std::string why = bridge::checkDefinition(s.rigid);
    if (why.empty())
        return {};
    scene::Problem p;
    p.file = file;
    p.what = std::move(why);
    return {p};
}

/// Appends all problems to `problems`; fails with the text of the errors if there is one.
Result<scene::Scene> load(const std::string& text, const std::string& file,
                          const std::vector<std::pair<std::string, double>>& parameters,
                          std::vector<scene::Problem>& problems, std::optional<double> fragmentOf = {}) {
    std::vector<scene::Override> overrides;
    for (const auto& [name, value] : parameters)
        overrides.push_back({name, value});
    auto loaded = scene::loadText(text, file, overrides, problems, fragmentOf);
    if (!loaded)
        return loaded;
    const std::vector<scene::Problem> more = hostProblems(*loaded, file);
    problems.insert(problems.end(), more.begin(), more.end());
    return more.empty() ? std::move(loaded) : Result<scene::Scene>::failure(scene::errorText(more));
}

} // namespace

std::string fileName(const char* file) {
    return file != nullptr ? nameOf(file, "the file name") : "scene";
}

std::vector<std::pair<std::string, double>> parametersOf(const char* json) {
    std::vector<std::pair<std::string, double>> out;
    if (json == nullptr)
        return out;
    const Json all = parsed(json, "the parameters");
    if (!all.is_object())
        refuse(SC_BAD_INPUT, "parameters are a JSON object of numbers, such as {\"mu\": 0.35}");
    for (const auto& [name, value] : all.items()) {
        if (!value.is_number())
            refuse(SC_BAD_INPUT, "the parameter \"" + name + "\" is not a number");
        out.emplace_back(name, value.get<double>());
    }
    return out;
}

scene::Scene readScene(const std::string& text, const std::string& file,
                       const std::vector<std::pair<std::string, double>>& parameters, std::string* notes,
                       std::optional<double> fragmentOf) {
    std::vector<scene::Problem> problems;
    auto loaded = load(text, file, parameters, problems, fragmentOf);
    if (!loaded)
        refuse(SC_BAD_INPUT, loaded.error());
    for (const scene::Problem& p : problems)
        if (notes != nullptr)
            *notes += (notes->empty() ? "" : "\n") + p.toString();
    return *std::move(loaded);
}

std::string problemsJson(const std::string& text, const std::string& file) {
    std::vector<scene::Problem> problems;
    (void)load(text, file, {}, problems);
    Json all = Json::array();
    for (const scene::Problem& p : problems)
        all.push_back({{"line", p.line},
                       {"column", p.column},
                       {"pointer", p.pointer},
                       {"what", p.what},
                       {"expected", p.expected},
                       {"nearest", p.nearest},
                       {"note", p.severity == scene::Problem::Severity::Note},
                       {"text", p.toString()}});
    return written(all);
}

std::string parametersJson(const scene::Scene& scene) {
    Json all = Json::array();
    const auto bound = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
    for (const scene::Parameter& p : scene.parameters)
        all.push_back({{"name", p.name},
                       {"value", p.value},
                       {"min", bound(p.min)},
                       {"max", bound(p.max)},
                       {"unit", p.unit},
                       {"about", p.about}});
    return written(all);
}

} // namespace supercircle::c
