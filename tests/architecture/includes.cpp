#include "includes.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <optional>
#include <string_view>

namespace supercircle::architecture {

namespace {

/// What one module may include. A module is a folder with sources; the first module that fits a file decides. Paths are
/// written from the project root; those that end in '/' are folders.
struct Rule {
    std::string_view folder;
    std::vector<std::string_view> paths;            ///< beside the module itself
    std::vector<std::string_view> libraries;        ///< in every file, by their prefix
    std::vector<std::string_view> privateLibraries; ///< in .cpp files only
    bool system = false;                            ///< C and POSIX headers such as <unistd.h>
};

const std::vector<Rule>& rules() {
    static const std::vector<Rule> kRules = {
        {"supercircle/support/", {}, {"Eigen/"}, {}},
        {"supercircle/rod/", {"supercircle/support/"}, {"Eigen/"}, {}},
        {"supercircle/contact/", {"supercircle/support/", "supercircle/rod/arc.h"}, {"Eigen/"}, {}},
        {"supercircle/coulomb/", {"supercircle/support/"}, {"Eigen/"}, {}},
        {"supercircle/effects/", {"supercircle/support/", "supercircle/rod/", "supercircle/contact/"}, {"Eigen/"}, {}},
        {"supercircle/step/", {"supercircle/"}, {"Eigen/", "tbb/"}, {}},

        // The headers of the two Box2Ds do not go together.
        {"bridge/box2d/", {"supercircle/", "plugin/api/include/"}, {"Eigen/", "box2d/"}, {}},
        {"bridge/box2d3/", {"supercircle/", "plugin/api/include/"}, {"Eigen/", "box2d/"}, {}},

        {"bridge/c/include/", {}, {}, {}, true},
        {"bridge/c/lab/", {"supercircle/", "plugin/", "bridge/"}, {"Eigen/", "nlohmann/"}, {}},
        // C: on the public headers, the scene reader and the SVG writer; a polyline comes from the core's arcs.
        {"bridge/c/",
         {"supercircle/", "plugin/api/include/", "plugin/scene/loader/", "plugin/graphics/", "bridge/box2d/"},
         {"Eigen/", "box2d/", "nlohmann/json_fwd.hpp"},
         {"nlohmann/"}},

        {"plugin/api/include/", {"supercircle/support/result.h"}, {}, {}}, // the one core header of the public ones
        {"plugin/api/", {"supercircle/"}, {"Eigen/"}, {}},
        {"plugin/scene/loader/", {"plugin/api/include/", "supercircle/"}, {"Eigen/"}, {"nlohmann/", "muParser"}, true},
        {"plugin/scene/player/", {"plugin/api/include/", "plugin/scene/loader/", "supercircle/"}, {"Eigen/"}, {}},
        {"plugin/recording/table/", {"supercircle/support/"}, {"nlohmann/json_fwd.hpp"}, {"nlohmann/"}, true},
        {"plugin/recording/experiment/",
         {"plugin/api/include/", "plugin/scene/loader/", "plugin/recording/table/", "supercircle/support/"},
         {},
         {}},
        {"plugin/recording/import/",
         {"plugin/scene/loader/", "plugin/recording/experiment/", "plugin/recording/table/", "supercircle/support/"},
         {"Eigen/"},
         {"nlohmann/"}},
        // Draw list and samples from plain data; `live` reads them from a running world.
        {"plugin/graphics/picture/", {"plugin/graphics/", "supercircle/support/"}, {}, {}},
        {"plugin/graphics/sound/", {"supercircle/support/"}, {}, {}},
        {"plugin/graphics/live/",
         {"plugin/graphics/picture/", "plugin/graphics/sound/", "plugin/graphics/", "plugin/api/include/",
          "supercircle/"},
         {"Eigen/"},
         {}},
        {"plugin/graphics/",
         {"plugin/graphics/picture/", "plugin/recording/table/", "supercircle/support/"},
         {},
         {"cairo"},
         true},
        {"plugin/lab/session/",
         {"plugin/api/include/", "plugin/api/snapshot_archive.h", "plugin/api/snapshot_counts.h", "plugin/scene/",
          "plugin/recording/table/", "supercircle/"},
         {"Eigen/"},
         {},
         true},
        {"plugin/lab/sweep/",
         {"plugin/scene/loader/", "plugin/recording/table/", "supercircle/support/"},
         {},
         {"nlohmann/", "sqlite3.h", "boost/math/"},
         true},
        {"plugin/lab/validation/",
         {"plugin/api/include/", "plugin/scene/", "plugin/lab/session/", "plugin/recording/table/", "supercircle/"},
         {"Eigen/"},
         {},
         true},
        {"plugin/identification/replay/",
         {"plugin/recording/experiment/", "plugin/scene/loader/", "plugin/api/from_definition.h", "supercircle/"},
         {"Eigen/"},
         {}},
        {"plugin/identification/sensitivity/",
         {"plugin/identification/replay/", "plugin/recording/experiment/", "supercircle/support/"},
         {"Eigen/", "tbb/"},
         {}},
        {"plugin/identification/diagnosis/",
         {"plugin/identification/replay/", "plugin/recording/", "plugin/scene/loader/formula.h",
          "supercircle/effects/effect.h", "supercircle/support/"},
         {"Eigen/", "boost/math/"},
         {}},
        {"plugin/identification/calibration/",
         {"plugin/identification/diagnosis/", "plugin/recording/", "supercircle/support/",
          "supercircle/step/parallel.h"},
         {"Eigen/"},
         {}},
        {"plugin/pages/run/",
         {"plugin/graphics/", "plugin/lab/session/", "plugin/recording/table/", "supercircle/support/"},
         {},
         {"nlohmann/", "cairo"},
         true},
        {"plugin/pages/sweep/",
         {"plugin/graphics/", "plugin/lab/sweep/", "plugin/recording/table/", "plugin/pages/run/",
          "supercircle/support/"},
         {},
         {}},
        {"plugin/pages/validation/",
         {"plugin/graphics/", "plugin/lab/validation/", "plugin/recording/table/", "supercircle/support/"},
         {},
         {}},
        {"plugin/pages/import/",
         {"plugin/graphics/", "plugin/recording/import/", "plugin/recording/table/", "supercircle/support/"},
         {},
         {}},
        {"plugin/pages/replay/",
         {"plugin/graphics/", "plugin/identification/replay/", "plugin/recording/", "supercircle/support/"},
         {},
         {"nlohmann/"}},
        {"plugin/pages/sensitivity/",
         {"plugin/graphics/", "plugin/identification/sensitivity/", "plugin/recording/", "supercircle/support/"},
         {},
         {}},
        {"plugin/pages/diagnosis/",
         {"plugin/graphics/", "plugin/identification/diagnosis/", "plugin/recording/", "plugin/scene/loader/",
          "supercircle/support/"},
         {},
         {"nlohmann/"}},
        // The subcommand `view` starts the testbed, which lives on the games' framework.
        {"plugin/cli/",
         {"plugin/", "bridge/box2d/", "supercircle/", "examples/testbed/testbed.h"},
         {"Eigen/", "CLI/"},
         {"nlohmann/", "muParser"},
         true},
        {"plugin/bench/", {"plugin/", "bridge/box2d/", "supercircle/"}, {"Eigen/"}, {"nlohmann/"}, true},
        {"plugin/", {}, {}, {}},
        // Games see the public headers and their framework; the framework draws with the canvas of the pages and reads
        // levels with the scenes' reader, so that a level is checked like any scene and a window shows what a PNG has.
        {"examples/games/frame/",
         {"plugin/api/include/", "plugin/graphics/", "plugin/scene/loader/", "bridge/box2d/"},
         {"Eigen/", "box2d/"},
         {"CLI/", "GLFW/", "GL/"},
         true},
        // The testbed looks inside the step: contacts, timings.
        {"examples/testbed/",
         {"examples/games/frame/", "plugin/api/include/", "plugin/graphics/", "bridge/box2d/", "supercircle/step/"},
         {"Eigen/", "box2d/"},
         {"imgui"},
         true},
        {"examples/", {"examples/", "plugin/api/include/", "bridge/box2d/include/"}, {"Eigen/", "box2d/"}, {}, true},
        // The second simulator, which judges the first, shares nothing with it.
        {"tests/reference_simulator/",
         {"tests/blind_benchmark/"},
         {"Eigen/", "nlohmann/json_fwd.hpp"},
         {"nlohmann/", "catch2/"},
         true},
        {"tests/blind_benchmark/", {"tests/reference_simulator/"}, {"Eigen/"}, {"nlohmann/", "catch2/"}, true},
    };
    return kRules;
}

bool startsWith(std::string_view text, std::string_view prefix) {
    return text.substr(0, prefix.size()) == prefix;
}

bool hasSuffix(std::string_view text, std::string_view suffix) {
    return text.size() >= suffix.size() && text.substr(text.size() - suffix.size()) == suffix;
}

bool startsWithOneOf(std::string_view text, const std::vector<std::string_view>& prefixes) {
    return std::any_of(prefixes.begin(), prefixes.end(), [&](std::string_view p) { return startsWith(text, p); });
}

struct Include {
    std::string path;
    bool quoted = false;
};

std::optional<Include> parse(std::string_view line) {
    std::size_t i = 0;
    const auto skipBlanks = [&] {
        while (i < line.size() && (line[i] == ' ' || line[i] == '\t'))
            ++i;
    };
    skipBlanks();
    if (i >= line.size() || line[i] != '#')
        return std::nullopt;
    ++i;
    skipBlanks();
    if (!startsWith(line.substr(i), "include"))
        return std::nullopt;
    i += std::string_view("include").size();
    skipBlanks();
    if (i >= line.size() || (line[i] != '<' && line[i] != '"'))
        return std::nullopt;
    const bool quoted = line[i] == '"';
    const std::size_t end = line.find(quoted ? '"' : '>', i + 1);
    if (end == std::string_view::npos)
        return std::nullopt;
    return Include{std::string(line.substr(i + 1, end - i - 1)), quoted};
}

bool isProjectPath(std::string_view path) {
    return startsWithOneOf(path, {"supercircle/", "plugin/", "bridge/", "examples/", "tests/"});
}

/// Headers of the C++ standard library have neither a dot nor a slash in their names.
bool isStandard(const Include& include) {
    return !include.quoted && include.path.find_first_of("./") == std::string::npos;
}

/// Users reach the public headers as "supercircle/NAME.hpp"; those of the core end in .h.
bool isPublicHeader(std::string_view path) {
    return startsWith(path, "supercircle/") && hasSuffix(path, ".hpp") &&
           path.find('/', std::string_view("supercircle/").size()) == std::string_view::npos;
}

/// The module a file belongs to: its folder, null outside of all.
const Rule* moduleOf(std::string_view file) {
    for (const Rule& r : rules())
        if (startsWith(file, r.folder))
            return &r;
    return nullptr;
}

/// Headers in a sub-folder of a module are private to it; the public headers of `include/` are no such sub-folder.
bool isPrivate(const Rule& module, std::string_view path) {
    const std::string_view rest = path.substr(module.folder.size());
    return rest.find('/') != std::string_view::npos && !hasSuffix(module.folder, "include/") &&
           !startsWith(rest, "include/") && module.folder != "examples/";
}

std::string checkProjectPath(const Rule& rule, const std::string& path) {
    if (startsWith(path, rule.folder))
        return {};
    if (startsWith(rule.folder, "supercircle/") && isPublicHeader(path))
        return "the core does not know the public headers";
    const bool seesPublic =
        startsWith(rule.folder, "plugin/api/") || startsWithOneOf("plugin/api/include/", rule.paths);
    if (seesPublic && isPublicHeader(path))
        return {};
    if (startsWithOneOf(path, rule.paths)) {
        const Rule* module = moduleOf(path);
        if (module != nullptr && isPrivate(*module, path))
            return "this header is private to " + std::string(module->folder);
        return {};
    }
    std::string allowed;
    for (const std::string_view p : rule.paths)
        allowed += (allowed.empty() ? "" : ", ") + std::string(p);
    return "from the project, " + std::string(rule.folder) + " may include only " +
           (allowed.empty() ? std::string("itself") : allowed);
}

std::string checkLibrary(const Rule& rule, const std::string& file, const std::string& path) {
    std::string lower = path;
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (startsWith(lower, "box2d") && !startsWithOneOf("box2d/", rule.libraries))
        return "Box2D is included by bridge/ and examples/ only";
    if (startsWithOneOf(path, rule.libraries))
        return {};
    if (startsWithOneOf(path, rule.privateLibraries)) {
        if (hasSuffix(file, ".cpp"))
            return {};
        return "this library stays private: .cpp files only";
    }
    const bool library = path.find('/') != std::string::npos && !startsWith(path, "sys/");
    // cairo, muParser and imgui are the libraries whose headers look like those of the system.
    if (!library && !startsWithOneOf(path, {"cairo", "muParser", "imgui"}) && rule.system && hasSuffix(path, ".h"))
        return {};
    return std::string(rule.folder) + " may not use this library";
}

std::string check(const Rule& rule, const std::string& file, const Include& include) {
    if (isStandard(include))
        return {};
    if (include.path.find("..") != std::string::npos)
        return "includes are written from the project root, without ..";
    if (isProjectPath(include.path))
        return checkProjectPath(rule, include.path);
    if (include.quoted && include.path.find('/') == std::string::npos) {
        if (hasSuffix(rule.folder, "/include/")) // public headers are also copied elsewhere as one folder
            return {};
        return "includes are written from the project root";
    }
    return checkLibrary(rule, file, include.path);
}

} // namespace

std::vector<Offence> checkIncludes(const std::string& file, const std::vector<std::string>& lines) {
    std::vector<Offence> offences;
    const Rule* rule = moduleOf(file);
    if (rule == nullptr)
        return offences;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::optional<Include> include = parse(lines[i]);
        if (!include)
            continue;
        const std::string why = check(*rule, file, *include);
        if (!why.empty())
            offences.push_back({file, static_cast<int>(i) + 1, "includes " + include->path + ": " + why});
    }
    return offences;
}

} // namespace supercircle::architecture
