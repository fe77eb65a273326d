#include "includes.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <optional>
#include <string_view>

namespace supercircle::architecture {

namespace {

/// What one folder may include: paths from the project root (folders end in '/'), and libraries by their prefix.
struct Rule {
    std::string_view folder;
    std::vector<std::string_view> paths;
    std::vector<std::string_view> libraries;        ///< in every file
    std::vector<std::string_view> privateLibraries; ///< in .cpp files only
    bool system = false;                            ///< C and POSIX headers such as <unistd.h>
};

const std::vector<Rule>& rules() {
    // The first folder that fits decides. What stands in none of them (tests, docs) is free.
    static const std::vector<Rule> kRules = {
        {"supercircle/rod/", {"supercircle/rod/"}, {"Eigen/"}, {}},
        {"supercircle/parallel/", {"supercircle/parallel/"}, {}, {}},
        {"supercircle/contact/",
         {"supercircle/contact/", "supercircle/parallel/", "supercircle/rod/arc.h"},
         {"Eigen/"},
         {}},
        {"supercircle/coulomb/", {"supercircle/coulomb/", "supercircle/parallel/"}, {"Eigen/"}, {}},
        {"supercircle/effects/", {"supercircle/effects/", "supercircle/rod/", "supercircle/contact/"}, {"Eigen/"}, {}},
        {"supercircle/step/", {"supercircle/"}, {"Eigen/", "tbb/"}, {}},
        {"supercircle/", {}, {"Eigen/"}, {}},
        {"bridge/box3/", // the headers of the two Box2Ds do not go together
         {"bridge/box3/", "bridge/include/supercircle/box2d3.hpp", "supercircle/"},
         {"Eigen/", "box2d/"},
         {}},
        {"bridge/", {"bridge/", "supercircle/", "plugin/include/supercircle/draw.hpp"}, {"Eigen/", "box2d/"}, {}},
        {"plugin/include/", {"plugin/include/"}, {}, {}},
        {"plugin/scene/",
         {"plugin/include/", "plugin/scene/", "supercircle/"},
         {"Eigen/"},
         {"nlohmann/", "muParser"},
         true},
        {"plugin/record/",
         {"plugin/include/", "plugin/record/", "supercircle/"},
         {"Eigen/"},
         {"nlohmann/", "muParser"},
         true},
        {"plugin/report/",
         {"plugin/include/", "plugin/report/", "plugin/record/", "plugin/scene/", "plugin/lab/", "supercircle/"},
         {"Eigen/"},
         {"nlohmann/", "muParser", "cairo"},
         true},
        {"plugin/validation/",
         {"plugin/include/", "plugin/validation/", "plugin/report/", "plugin/record/", "plugin/scene/", "plugin/lab/",
          "plugin/shells/", "supercircle/"},
         {"Eigen/"},
         {},
         true},
        {"plugin/experiment/", {"plugin/include/", "plugin/experiment/", "plugin/scene/", "plugin/record/"}, {}, {}},
        {"plugin/replay/",
         {"plugin/include/", "plugin/replay/", "plugin/experiment/", "plugin/scene/", "supercircle/"}, // free scenes
         {"Eigen/"},
         {}},
        {"plugin/importing/",
         {"plugin/include/", "plugin/importing/", "plugin/experiment/", "plugin/record/", "plugin/scene/"},
         {"Eigen/"},
         {"nlohmann/"}},
        {"plugin/sensitivity/",
         {"plugin/include/", "plugin/sensitivity/", "plugin/experiment/", "plugin/replay/"},
         {"Eigen/", "tbb/"},
         {}},
        {"plugin/diagnosis/",
         {"plugin/include/", "plugin/diagnosis/", "plugin/experiment/", "plugin/replay/", "plugin/record/",
          "supercircle/effects/effect.h", "supercircle/effects/spline.h", "supercircle/parallel/"},
         {"Eigen/", "boost/math/"},
         {}},
        {"plugin/calibration/",
         {"plugin/include/", "plugin/calibration/", "plugin/diagnosis/", "plugin/experiment/", "plugin/record/",
          "supercircle/step/parallel.h"},
         {"Eigen/"},
         {}},
        {"plugin/sweep/",
         {"plugin/include/", "plugin/sweep/", "plugin/scene/", "plugin/record/"},
         {},
         {"nlohmann/", "sqlite3.h", "boost/math/"},
         true},
        // The verb `view` starts the testbed, which lives on the games' frame.
        {"plugin/cli/",
         {"plugin/", "bridge/", "supercircle/", "examples/testbed/testbed.h"},
         {"Eigen/", "CLI/"},
         {"nlohmann/", "muParser"},
         true},
        {"plugin/",
         {"plugin/include/", "plugin/scene/", "plugin/record/", "plugin/player/", "plugin/lab/", "plugin/shells/",
          "supercircle/"},
         {"Eigen/", "tbb/"},
         {},
         true},
        // Games see the public headers and their frame; the frame draws with report's canvas and reads levels with the
        // scenes' reader, so that a level is checked like any scene and a window shows what a PNG file has.
        {"examples/frame/",
         {"examples/frame/", "plugin/include/", "plugin/report/", "plugin/scene/", "bridge/"},
         {"Eigen/", "box2d/"},
         {"CLI/", "GLFW/", "GL/"},
         true},
        // The testbed looks inside the step: contacts, timings.
        {"examples/testbed/",
         {"examples/testbed/", "examples/frame/", "plugin/include/", "plugin/report/", "bridge/", "supercircle/step/"},
         {"Eigen/", "box2d/"},
         {"imgui"},
         true},
        {"examples/", {"examples/", "plugin/include/", "bridge/"}, {"Eigen/", "box2d/"}, {}, true},
        // The second simulator, which judges the first, shares nothing with it.
        {"tests/oracle/", {"tests/oracle/"}, {"Eigen/"}, {"nlohmann/", "catch2/"}, true},
    };
    return kRules;
}

bool startsWith(std::string_view text, std::string_view prefix) {
    return text.substr(0, prefix.size()) == prefix;
}

bool endsWith(std::string_view text, std::string_view suffix) {
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
    return startsWith(path, "supercircle/") && endsWith(path, ".hpp") &&
           path.find('/', std::string_view("supercircle/").size()) == std::string_view::npos;
}

std::string checkProjectPath(const Rule& rule, const std::string& path) {
    if (startsWithOneOf(path, rule.paths))
        return {};
    const bool seesPublic = startsWithOneOf("plugin/include/", rule.paths);
    if (seesPublic && isPublicHeader(path))
        return {};
    std::string allowed;
    for (const std::string_view p : rule.paths)
        allowed += (allowed.empty() ? "" : ", ") + std::string(p);
    return "from the project, " + std::string(rule.folder) + " may include only " +
           (allowed.empty() ? std::string("nothing") : allowed);
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
        if (endsWith(file, ".cpp"))
            return {};
        return "this library stays private: .cpp files only";
    }
    const bool library = path.find('/') != std::string::npos && !startsWith(path, "sys/");
    // cairo, muParser and imgui are the libraries whose headers look like those of the system.
    if (!library && !startsWithOneOf(path, {"cairo", "muParser", "imgui"}) && rule.system && endsWith(path, ".h"))
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
        if (rule.folder == "plugin/include/") // the public headers are also copied elsewhere as one folder
            return {};
        return "includes are written from the project root";
    }
    return checkLibrary(rule, file, include.path);
}

} // namespace

std::vector<Offence> checkIncludes(const std::string& file, const std::vector<std::string>& lines) {
    std::vector<Offence> offences;
    const auto rule =
        std::find_if(rules().begin(), rules().end(), [&](const Rule& r) { return startsWith(file, r.folder); });
    if (rule == rules().end())
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
