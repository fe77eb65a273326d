#include "plugin/cli/input.h"

#include "bridge/box2d/lab_world.h"
#include "plugin/scene/loader/document.h"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace supercircle::cli {

namespace {

/// Kind of a file that is no scene, by its schema or by keys that scenes do not have. Empty if it may be a scene; the
/// loader then reports its problems.
std::string otherKind(const scene::Node& root) {
    const std::optional<scene::Node> schema = root.find("schema");
    const std::string name = schema ? schema->text() : "";
    const auto startsWith = [&](const char* prefix) { return name.rfind(prefix, 0) == 0; };
    if (startsWith("supercircle-scene/"))
        return {};
    if (startsWith("rod-recordings/"))
        return "an experiment (schema \"" + name + "\")";
    if (startsWith("supercircle-sweep/"))
        return "a sweep (schema \"" + name + "\")";
    const bool rigid = root.find("body") || root.find("shell") || root.find("drop");
    if (rigid || schema)
        return {};
    if (root.find("runs") && root.find("specimens"))
        return "an experiment";
    if (root.find("scene") && (root.find("sweep") || root.find("parameters")))
        return "a sweep";
    return {};
}

} // namespace

bool readOverrides(const std::vector<std::string>& parameters, std::vector<scene::Override>& overrides,
                   const char* option) {
    for (const std::string& p : parameters) {
        const std::size_t eq = p.find('=');
        double value = 0.0;
        const char* first = p.data() + (eq == std::string::npos ? 0 : eq + 1);
        const char* last = p.data() + p.size();
        if (first < last && *first == '+')
            ++first;
        const auto [end, error] = std::from_chars(first, last, value);
        if (eq == std::string::npos || eq == 0 || error != std::errc{} || end != last || !std::isfinite(value)) {
            std::fprintf(stderr, "%s %s: expected NAME=VALUE with a finite number, for example mu=0.35\n", option,
                         p.c_str());
            return false;
        }
        overrides.push_back({p.substr(0, eq), value});
    }
    return true;
}

std::optional<Input> loadScene(const std::string& file, const std::vector<std::string>& parameters, bool quiet,
                               bool mechanisms) {
    std::vector<scene::Override> overrides;
    if (!readOverrides(parameters, overrides))
        return std::nullopt;
    std::vector<scene::Problem> problems;
    const auto text = scene::readFile(file, problems);
    if (text) {
        std::vector<scene::Problem> ignored; // the loader reports them again
        const auto document = scene::parseDocument(*text, file, ignored);
        if (const std::string kind = document ? otherKind(document->root()) : ""; !kind.empty()) {
            const bool experiment = kind.find("experiment") != std::string::npos;
            std::fprintf(stderr, "%s:1:1: /schema: this is %s, not a scene; %s\n", file.c_str(), kind.c_str(),
                         experiment ? "`supercircle replay` simulates one whose \"schema\" says rod-recordings/1"
                                    : "`supercircle sweep` runs one whose \"schema\" says supercircle-sweep/1");
            return std::nullopt;
        }
    }
    auto loaded =
        text ? scene::loadText(*text, file, overrides, problems) : Result<scene::Scene>::failure(text.error());
    for (const scene::Problem& p : problems) {
        const bool note = p.severity == scene::Problem::Severity::Note;
        if (!note || !quiet)
            std::fprintf(stderr, "%s%s\n", note ? "note: " : "", p.toString().c_str());
    }
    if (!loaded)
        return std::nullopt;
    if (mechanisms && scene::isMechanism(*loaded))
        return Input{*std::move(loaded), nullptr};
    std::string why;
    std::shared_ptr<step::HostWorld> host = bridge::makeWorld(loaded->rigid, why);
    if (!host) {
        std::fprintf(stderr, "%s: %s\n", file.c_str(), why.c_str());
        return std::nullopt;
    }
    return Input{*std::move(loaded), std::move(host)};
}

std::string schemaOf(const std::string& file) {
    std::vector<scene::Problem> ignored; // the loader of the file reports them
    const auto text = scene::readFile(file, ignored);
    if (!text)
        return "";
    const auto document = scene::parseDocument(*text, file, ignored);
    const std::optional<scene::Node> schema = document ? document->root().find("schema") : std::nullopt;
    return schema ? schema->text() : "";
}

} // namespace supercircle::cli
