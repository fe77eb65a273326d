#pragma once
// Helpers of the scene tests.

#include "plugin/scene/loader/loader.h"
#include "supercircle/rod/arc.h"

#include <catch2/catch.hpp>
#include <string>
#include <vector>

namespace scenetest {

using namespace supercircle;
using namespace supercircle::scene;

inline std::string scenePath(const std::string& name) {
    return std::string(SC_SOURCE_DIR) + "/scenes/" + name + ".json";
}

inline const std::vector<std::string>& sceneNames() {
    static const std::vector<std::string> names = {"stack30", "shell_on_cylinder", "two_shells", "cantilever",
                                                   "squeeze", "pinning",           "ramp"};
    return names;
}

inline std::string say(const std::vector<Problem>& problems) {
    std::string text;
    for (const Problem& p : problems)
        text += p.toString() + "\n";
    return text;
}

/// Loads; fails the test unless it succeeds.
inline Scene loaded(const std::string& path, const std::vector<Override>& overrides = {}) {
    std::vector<Problem> problems;
    auto scene = load(path, overrides, problems);
    INFO(say(problems));
    REQUIRE(scene);
    return *scene;
}

inline Scene loadedText(const std::string& text, const std::vector<Override>& overrides = {}) {
    std::vector<Problem> problems;
    auto scene = loadText(text, "text.json", overrides, problems);
    INFO(say(problems));
    REQUIRE(scene);
    return *scene;
}

/// Loads; fails the test unless it fails. The errors.
inline std::vector<Problem> refused(const std::string& text, const std::vector<Override>& overrides = {}) {
    std::vector<Problem> problems;
    const auto scene = loadText(text, "text.json", overrides, problems);
    INFO(text);
    REQUIRE_FALSE(scene);
    std::vector<Problem> errors;
    for (const Problem& p : problems)
        if (p.severity == Problem::Severity::Error)
            errors.push_back(p);
    REQUIRE_FALSE(errors.empty());
    return errors;
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// Point and tangent angle of an undeformed shell of uniform curvature at arc length s from its middle.
struct Uniform {
    rod::Arc arc;
    double half = 0.0; ///< half the length
    double r = 0.0;    ///< half the thickness

    explicit Uniform(const ShellDef& d) {
        const double length = d.length > 0.0 ? d.length : 2.0 * M_PI * d.phi_bar * d.radius;
        arc.start = {d.position.x, d.position.y};
        arc.angle = d.angle;
        arc.curvature = d.natural_curvature.empty() ? 1.0 / d.radius : d.natural_curvature.front();
        arc.length = length;
        half = 0.5 * length;
        r = 0.5 * d.thickness;
    }
    [[nodiscard]] rod::Vec2 at(double fraction) const { return arc.pointAt((2.0 * fraction - 1.0) * half); }
};

} // namespace scenetest
