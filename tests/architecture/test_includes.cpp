#include "elementary_calls.h"
#include "hidden_includes.h"
#include "includes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

using supercircle::architecture::checkIncludes;
using supercircle::architecture::decidesNumbers;
using supercircle::architecture::machineDependentCall;
using supercircle::architecture::Offence;
namespace fs = std::filesystem;

namespace {

std::vector<std::string> readLines(const fs::path& path) {
    std::ifstream in(path);
    REQUIRE(in);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);)
        lines.push_back(line);
    return lines;
}

/// Paths from the project root of all sources of the project's own folders, sorted.
std::vector<std::string> sources() {
    const fs::path top = SC_SOURCE_DIR;
    std::vector<std::string> found;
    for (const char* folder : {"supercircle", "bridge", "plugin", "examples", "tests"}) {
        if (!fs::exists(top / folder))
            continue;
        for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
            const std::string extension = entry.path().extension().string();
            if (entry.is_regular_file() && (extension == ".h" || extension == ".hpp" || extension == ".cpp"))
                found.push_back(fs::relative(entry.path(), top).generic_string());
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

/// Folders from the project root that hold files, and those above them; not what tools leave behind, and not the
/// numbered cases of recordings, which their README names together.
std::set<fs::path> foldersWithFiles() {
    const fs::path top = SC_SOURCE_DIR;
    std::set<fs::path> found;
    for (const char* folder : {"supercircle", "bridge", "plugin", "examples", "scenes", "tests"}) {
        if (!fs::exists(top / folder))
            continue;
        for (auto entry = fs::recursive_directory_iterator(top / folder); entry != fs::end(entry); ++entry) {
            const std::string name = entry->path().filename().string();
            if (entry->is_directory() &&
                (name[0] == '.' || name.rfind("__", 0) == 0 || name.rfind("case_", 0) == 0 || name == "node_modules"))
                entry.disable_recursion_pending();
            else if (entry->is_regular_file())
                for (fs::path f = fs::relative(entry->path(), top).parent_path(); f.has_parent_path();
                     f = f.parent_path())
                    found.insert(f);
        }
    }
    return found;
}

bool offends(const std::string& file, const std::string& line) {
    return !checkIncludes(file, {line}).empty();
}

} // namespace

TEST_CASE("includes follow the arrows of the architecture", "[architecture]") {
    const std::vector<std::string> files = sources();
    REQUIRE(files.size() > 10); // the test looks in the right place
    for (const std::string& file : files) {
        for (const Offence& o : checkIncludes(file, readLines(fs::path(SC_SOURCE_DIR) / file)))
            FAIL_CHECK(o.file << ":" << o.line << ": " << o.why);
    }
}

TEST_CASE("headers bring what precompiled headers would hide", "[architecture]") {
    const fs::path top = SC_SOURCE_DIR;
    supercircle::architecture::Files files;
    for (const std::string& file : sources())
        if (fs::path(file).extension() != ".cpp")
            files.emplace(file, readLines(top / file));
    for (const auto& [file, lines] : files) // those of tests and examples are compiled with what they need
        if (file.rfind("tests/", 0) != 0 && file.rfind("examples/", 0) != 0)
            for (const auto& [header, name] : supercircle::architecture::hiddenIncludes(file, files))
                FAIL_CHECK(file << " uses " << name << " and does not include <" << header << ">");
    // The list is that of the build.
    std::string text;
    for (const std::string& line : readLines(top / "plugin/cmake/Modules.cmake"))
        text += line + " ";
    const std::size_t from = text.find("target_precompile_headers(${name} PRIVATE"), to = text.find(')', from);
    REQUIRE(from != std::string::npos);
    const std::set<std::string> known = supercircle::architecture::headersWithKnownNames();
    int listed = 0;
    for (std::size_t at = text.find('<', from); at < to; at = text.find('<', at + 1), ++listed) {
        const std::string header = text.substr(at + 1, text.find('>', at) - at - 1);
        INFO(header);
        CHECK(known.count(header) == 1);
    }
    CHECK(listed > 20);
}

TEST_CASE("a hidden include is found through the project's own headers", "[architecture]") {
    const supercircle::architecture::Files files = {
        {"a/own.h", {"#include <vector>"}},
        {"a/good.h", {"#include \"a/own.h\"", "std::vector<int> v; // std::map", "std::pair<int, int> p;"}},
        {"a/bad.h",
         {"#include <string>", "std::optional<std::string> x;", "std::string_view y;", "Eigen::VectorXd z;"}},
        {"a/longer.h", {"std::optional_thing x; my::std::vector y;"}}};
    using Hidden = std::map<std::string, std::string>;
    CHECK(supercircle::architecture::hiddenIncludes("a/good.h", files).empty());
    CHECK(supercircle::architecture::hiddenIncludes("a/longer.h", files).empty());
    CHECK(supercircle::architecture::hiddenIncludes("a/bad.h", files) ==
          Hidden{{"optional", "std::optional"}, {"Eigen/Core", "Eigen::"}});
}

TEST_CASE("no folder holds more than twenty sources", "[architecture]") {
    std::map<std::string, int> count;
    for (const std::string& file : sources())
        if (fs::path(file).extension() == ".cpp")
            ++count[fs::path(file).parent_path().generic_string()];
    for (const auto& [folder, sourcesIn] : count) {
        INFO(folder);
        CHECK((sourcesIn <= 20 || folder == "supercircle/effects/entries")); // one file an effect
    }
}

TEST_CASE("each folder has a line in the nearest README above it", "[architecture]") {
    const fs::path top = SC_SOURCE_DIR;
    const std::set<fs::path> folders = foldersWithFiles();
    REQUIRE(folders.size() > 100);
    for (const fs::path& folder : folders) {
        fs::path above = folder.parent_path();
        while (!above.empty() && !fs::exists(top / above / "README.md"))
            above = above.parent_path();
        INFO(folder.generic_string() << " in " << (above / "README.md").generic_string());
        std::string text;
        for (const std::string& line : readLines(top / above / "README.md"))
            text += line + "\n";
        CHECK(text.find(fs::relative(folder, above).generic_string() + "/") != std::string::npos);
    }
}

TEST_CASE("sources are globbed by sc_glob alone, which fails where nothing matches", "[architecture]") {
    const fs::path top = SC_SOURCE_DIR;
    int lists = 0;
    for (const char* folder : {"supercircle", "bridge", "plugin", "examples", "tests"})
        for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
            const std::string name = entry.path().filename().string();
            if (name != "CMakeLists.txt" && entry.path().extension() != ".cmake")
                continue;
            ++lists;
            for (const std::string& line : readLines(entry.path()))
                if (line.find("file(GLOB") != std::string::npos && name != "Modules.cmake")
                    FAIL_CHECK(entry.path().string() << ": " << line);
        }
    CHECK(lists > 5);
}

TEST_CASE("long files are named", "[architecture]") {
    for (const std::string& file : sources()) {
        const std::size_t lines = readLines(fs::path(SC_SOURCE_DIR) / file).size();
        if (lines > 500)
            WARN(file << " has " << lines << " lines: split it where two ideas live together");
    }
}

TEST_CASE("the include checker reports file and line", "[architecture]") {
    const auto offences = checkIncludes("supercircle/coulomb/law.cpp", {"// a comment", "#include <vector>", "",
                                                                        "  #  include \"supercircle/rod/arc.h\"",
                                                                        "int x;", "#include <box2d/box2d.h>"});
    REQUIRE(offences.size() == 2);
    CHECK(offences[0].file == "supercircle/coulomb/law.cpp");
    CHECK(offences[0].line == 4);
    CHECK(offences[0].why.find("supercircle/rod/arc.h") != std::string::npos);
    CHECK(offences[1].line == 6);
}

TEST_CASE("the include checker lets lawful lines pass", "[architecture]") {
    CHECK_FALSE(offends("supercircle/rod/arc.h", "#include <Eigen/Core>"));
    CHECK_FALSE(offends("supercircle/contact/detection.h", "#include \"supercircle/contact/geometry.h\""));
    CHECK_FALSE(offends("supercircle/contact/geometry.h", "#include \"supercircle/rod/arc.h\""));
    CHECK_FALSE(offends("supercircle/effects/laws/drag.cpp", "#include \"supercircle/rod/kinematics.h\""));
    CHECK_FALSE(offends("supercircle/step/world.cpp", "#include \"supercircle/coulomb/solver.h\""));
    CHECK_FALSE(offends("bridge/box2d/box2d_port.cpp", "#include <box2d/box2d.h>"));
    CHECK_FALSE(offends("plugin/api/include/supercircle/shells.hpp", "#include \"definitions.hpp\""));
    CHECK_FALSE(offends("plugin/api/include/supercircle/shells.hpp", "#include \"supercircle/definitions.hpp\""));
    CHECK_FALSE(offends("plugin/api/include/supercircle/shells.hpp", "#include <string>"));
    CHECK_FALSE(offends("plugin/scene/loader/loader.cpp", "#include <nlohmann/json.hpp>"));
    CHECK_FALSE(offends("plugin/graphics/png.cpp", "#include <cairo.h>"));
    CHECK_FALSE(offends("plugin/graphics/png.cpp", "#include <cairo/cairo.h>"));
    CHECK_FALSE(offends("plugin/cli/run/run.cpp", "#include \"bridge/box2d/lab_world.h\""));
    CHECK_FALSE(offends("plugin/cli/main.cpp", "#include <unistd.h>"));
    CHECK_FALSE(
        offends("plugin/identification/diagnosis/estimation/fit.cpp", "#include \"plugin/recording/table/rounded.h\""));
    CHECK_FALSE(offends("tests/bridge/test_port.cpp", "#include <box2d/box2d.h>"));
    CHECK_FALSE(offends("examples/games/frame/view.h", "#include \"plugin/graphics/canvas.h\""));
    CHECK_FALSE(offends("examples/games/frame/window_glfw.cpp", "#include <GLFW/glfw3.h>"));
    CHECK_FALSE(offends("supercircle/rod/arc.cpp", "// #include <box2d/box2d.h>"));
}

TEST_CASE("the include checker catches every kind of offence", "[architecture]") {
    const auto mustOffend = [](const std::string& file, const std::string& line) {
        INFO(file << " with " << line);
        CHECK(offends(file, line));
    };
    // the judge of the diagnosis shares nothing with it
    mustOffend("tests/reference_simulator/rod.cpp", "#include \"supercircle/rod/arc.h\"");
    mustOffend("tests/blind_benchmark/scoring/scores.cpp", "#include \"plugin/identification/diagnosis/result.h\"");
    mustOffend("tests/reference_simulator/contact.h", "#include \"bridge/box2d/units.h\"");
    // the core knows Eigen and the standard library
    mustOffend("supercircle/rod/arc.h", "#include <box2d/b2_math.h>");
    mustOffend("supercircle/rod/arc.h", "#include <nlohmann/json.hpp>");
    mustOffend("supercircle/step/world.cpp", "#include <spdlog/spdlog.h>");
    mustOffend("supercircle/step/world.cpp", "#include <unistd.h>");
    mustOffend("supercircle/step/world.cpp", "#include \"bridge/box2d/box2d_port.h\"");
    mustOffend("supercircle/step/world.cpp", "#include \"plugin/api/include/supercircle/definitions.hpp\"");
    mustOffend("supercircle/step/world.cpp", "#include <supercircle/shells.hpp>");
    mustOffend("plugin/new_file.h", "#include \"supercircle/rod/arc.h\"");
    // its folders stand in an order
    mustOffend("supercircle/rod/arc.h", "#include \"supercircle/contact/geometry.h\"");
    mustOffend("supercircle/contact/detection.cpp", "#include \"supercircle/rod/kinematics.h\"");
    mustOffend("supercircle/contact/detection.cpp", "#include \"supercircle/coulomb/problem.h\"");
    mustOffend("supercircle/coulomb/law.h", "#include \"supercircle/contact/geometry.h\"");
    mustOffend("supercircle/effects/laws/drag.h", "#include \"supercircle/coulomb/problem.h\"");
    mustOffend("supercircle/effects/laws/drag.h", "#include \"supercircle/step/world.h\"");
    // Box2D behind the bridge
    mustOffend("bridge/box2d/box2d_port.h", "#include \"plugin/api/shells_impl.h\"");
    mustOffend("bridge/box2d/box2d_port.h", "#include \"bridge/box2d3/outlines.h\"");
    mustOffend("bridge/box2d/box2d_port.h", "#include <nlohmann/json.hpp>");
    mustOffend("plugin/lab/session/run_scene.cpp", "#include <box2d/box2d.h>");
    mustOffend("plugin/cli/view/view.cpp", "#include <Box2D/Box2D.h>");
    mustOffend("plugin/lab/session/run_scene.cpp", "#include \"bridge/box2d/lab_world.h\"");
    // the public headers stand alone
    mustOffend("plugin/api/include/supercircle/shells.hpp", "#include \"supercircle/step/port.h\"");
    mustOffend("plugin/api/include/supercircle/shells.hpp", "#include <Eigen/Core>");
    mustOffend("plugin/api/include/supercircle/shells.hpp", "#include <nlohmann/json_fwd.hpp>");
    mustOffend("plugin/api/include/supercircle/shells.hpp", "#include \"plugin/scene/loader/scene.h\"");
    // libraries stay where they belong
    mustOffend("plugin/scene/loader/loader.h", "#include <nlohmann/json.hpp>");
    mustOffend("plugin/lab/session/run_scene.cpp", "#include <nlohmann/json.hpp>");
    mustOffend("plugin/scene/loader/loader.cpp", "#include <cairo.h>");
    mustOffend("plugin/lab/session/run_scene.cpp", "#include <muParser.h>");
    mustOffend("plugin/recording/table/csv.cpp", "#include <CLI/CLI.hpp>");
    mustOffend("plugin/identification/diagnosis/estimation/fit.cpp", "#include \"plugin/lab/session/run_scene.h\"");
    mustOffend("plugin/identification/diagnosis/estimation/fit.cpp", "#include \"supercircle/step/world.h\"");
    mustOffend("examples/game.cpp", "#include \"supercircle/step/world.h\"");
    mustOffend("examples/games/egg_drop/main.cpp", "#include <GLFW/glfw3.h>");
    mustOffend("examples/games/frame/window.h", "#include <GLFW/glfw3.h>");
    mustOffend("examples/games/frame/stage.cpp", "#include \"supercircle/step/world.h\"");
    // a header in a sub-folder of a module is private to the module
    mustOffend("supercircle/step/world.cpp", "#include \"supercircle/contact/detection/closest.h\"");
    mustOffend("plugin/pages/diagnosis/diagnose_page.cpp",
               "#include \"plugin/identification/diagnosis/estimation/sandwich.h\"");
    mustOffend("plugin/bench/bench.cpp", "#include \"plugin/cli/sweep/sweep_work.h\"");
    // paths from the root
    mustOffend("supercircle/rod/arc.cpp", "#include \"arc.h\"");
    mustOffend("supercircle/rod/arc.cpp", "#include \"../rod/arc.h\"");
}

TEST_CASE("no number that is simulated or recorded comes from a function that depends on the machine",
          "[architecture]") {
    int looked = 0;
    for (const std::string& file : sources()) {
        if (!decidesNumbers(file))
            continue;
        ++looked;
        const bool own = file.find("supercircle/support/elementary") == 0 || file == "supercircle/support/trig.h";
        int number = 0;
        for (const std::string& line : readLines(fs::path(SC_SOURCE_DIR) / file)) {
            ++number;
            const std::string call = machineDependentCall(line, own);
            // Names of members of the project.
            if (call.empty() || (call == "log" && line.find("log() const") != std::string::npos))
                continue;
            FAIL_CHECK(file << ":" << number << ": " << call << ": take it from supercircle/support/elementary.h");
        }
    }
    CHECK(looked > 200);
}

TEST_CASE("the search for functions that depend on the machine finds every way to write them", "[architecture]") {
    for (const char* line :
         {"x = std::sin(a);", "x = ::sin(a);", "x = sin(a);", "return cos(a);", "x = -pow(a, 2);", "f(std::exp);",
          "y = a.array().exp();", "y = a.pow(2);", "x = std::hypot(a, b);", "x = sinf(a);", "x = std::pow(a,",
          "x = log(", "#include <complex>", "std::normal_distribution<double> d;", "x = Eigen::numext::hypot(a, b);",
          "const Eigen::Rotation2Dd r(a);"}) {
        INFO(line);
        CHECK_FALSE(machineDependentCall(line, false).empty());
    }
    for (const char* line : {"x = math::sin(a);", "// std::sin(a)", "x = 1; // exp(-x)", "e.law = \"exp(-x)\";",
                             "x = std::sqrt(a) + std::fmod(a, b);", "asinine(a);", "x.sine(a);", "CallLog log() const;",
                             "double tan(double angle);", "x = std::ldexp(a, 2) + std::remainder(a, b);"}) {
        INFO(line);
        CHECK(machineDependentCall(line, false).empty());
    }
    CHECK(machineDependentCall("return expm1(x);", true).empty());
    CHECK_FALSE(machineDependentCall("return std::expm1(x);", true).empty());
}
