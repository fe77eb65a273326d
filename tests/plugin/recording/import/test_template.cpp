// experiment.json beside the runs: what is null is named, and what is filled in can be loaded.

#include "tests/plugin/recording/import/support.h"

#include "plugin/recording/experiment/load.h"
#include "plugin/recording/import/template.h"
#include "tests/support/json.h"

#include <nlohmann/json.hpp>

using namespace importingtest;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

// two thirds of a circle above a cylinder of its radius: its tips touch first, after 1 mm. Contact is detected at 1 %
// of the force range (30 um at 2 N/mm), in the next row (25 um).
constexpr double radius = 0.02, thickness = 0.5e-3;
const char* const specimen = R"({"arc_length_m": 0.0837758, "natural_curvature_1_m": 50.0, "thickness_m": 0.0005,
    "width_m": 0.01, "young_modulus_Pa": 2.2e9, "linear_mass_kg_m": 0.0057})";

importing::Description described(const importing::TemplateOptions& options) {
    const auto all = read(exported());
    REQUIRE(all);
    auto d = importing::describe(*all, options);
    INFO(d.error());
    REQUIRE(d);
    return *d;
}

std::string joined(const std::vector<std::string>& lines) {
    std::string all;
    for (const std::string& l : lines)
        all += l + "\n";
    return all;
}

std::string refusal(const importing::TemplateOptions& options) {
    const auto all = read(exported());
    REQUIRE(all);
    const auto d = importing::describe(*all, options);
    CHECK_FALSE(d);
    return d.error();
}

} // namespace

TEST_CASE("unknown values are null and listed", "[importing]") {
    const auto d = described({});
    const std::string todo = joined(d.todo);
    for (const char* pointer : {"/protocol: ", "/specimens/0/arc_length_m: ", "/specimens/0/thickness_m: m",
                                "/obstacles: ", "/friction/coefficient: "})
        CHECK_THAT(todo, Contains(pointer));
    CHECK_THAT(joined(d.assumed), Contains("/gravity_m_s2: [0.0,-9.81]") && Contains("/initial_gap_unc_m: 0.0001"));
    // the checker requires exactly these fields
    std::vector<scene::Problem> problems;
    CHECK_FALSE(experiment::loadText(d.json, "experiment.json", problems));
    for (const scene::Problem& p : problems) {
        INFO(p.toString());
        CHECK_THAT(todo, Contains(p.pointer + ":"));
    }
}

TEST_CASE("every null is refused until it is filled in", "[importing]") {
    for (const std::string& protocol : importing::protocols()) {
        if (protocol == "free_scene" || protocol == "scene") // about angles; described by a scene
            continue;
        const auto d = described({protocol, {}});
        std::vector<scene::Problem> problems;
        CHECK_FALSE(experiment::loadText(d.json, "experiment.json", problems));
        for (const scene::Problem& p : problems) {
            INFO(protocol << ": " << p.toString());
            if (p.severity == scene::Problem::Severity::Error)
                CHECK_THAT(joined(d.todo), Contains(p.pointer));
        }
    }
}

TEST_CASE("protocol and specimen complete it", "[importing]") {
    const Folder folder;
    const std::string file = folder.write("specimen.json", specimen);
    auto d = described({"shell_on_rigid_cylinder", file});
    CHECK_THAT(joined(d.remarks), Contains("bending modulus of specimen A is E w h^3 / 12 = 0.0002292"));
    Json own = {{"specimens", Json::array({test::parseJson(specimen)})},
                {"obstacles", Json::array({{{"radius_m", radius}}})},
                {"friction", {{"coefficient", 0.3}}}};
    d = described({"shell_on_rigid_cylinder", folder.write("own.json", test::jsonText(own))});
    INFO(joined(d.todo));
    CHECK(d.todo.empty());
    // the centre line of a tip at (R sin 120, -1.5 R) below the apex touches at R + h/2 from the cylinder's axis
    const double tip = radius * std::sin(2.0 * M_PI / 3.0), reach = radius + 0.5 * thickness;
    const Json json = test::parseJson(d.json);
    CHECK(json["specimens"][0]["clamp"]["initial_point_m"][1].get<double>() ==
          Approx(std::sqrt(reach * reach - tip * tip) + 1.5 * radius + 1e-3).margin(0.06e-3));
    std::vector<scene::Problem> problems;
    const auto loaded = experiment::loadText(d.json, "experiment.json", problems);
    INFO((problems.empty() ? "" : problems[0].toString()));
    REQUIRE(loaded);
    CHECK(loaded->specimens[0].bendingModulus.value == Approx(2.2e9 * 0.01 * std::pow(thickness, 3) / 12.0));
    CHECK(loaded->runs[0].driveTime.size() == 5);
}

TEST_CASE("a slip of the pen is named beside what it leaves out", "[importing]") {
    const Folder folder;
    for (const auto& [meant, written] : {std::pair{"thickness_m", "thicknes_m"},
                                         {"thickness_m", "thickness_mm"},
                                         {"arc_length_m", "arc_lenght_m"},
                                         {"arc_length_m", "length_m"}}) {
        Json one = test::parseJson(specimen);
        one[written] = one[meant];
        one.erase(meant);
        INFO(written);
        // as the file of one specimen, and as one of several in a description of the experiment
        for (const Json& own : {one, Json{{"specimens", Json::array({one})}}}) {
            const auto d = described({"shell_on_rigid_cylinder", folder.write("own.json", test::jsonText(own))});
            CHECK_THAT(joined(d.todo), Contains("/specimens/0/" + std::string(meant) + ": ") &&
                                           Contains("is it what is called \"" + std::string(written) + "\" there?"));
            CHECK(joined(d.todo).find("called \"young") == std::string::npos);
        }
    }
}

TEST_CASE("the upper plate above an arch is derived", "[importing]") {
    const Folder folder;
    const Json own = {{"specimens", Json::array({test::parseJson(specimen)})}, {"friction", {{"coefficient", 0.3}}}};
    const auto d = described({"arch_between_plates", folder.write("own.json", test::jsonText(own))});
    // the centre line of 240 degrees is R (1 - cos 120) high
    CHECK(test::parseJson(d.json)["obstacles"][1]["point_m"][1].get<double>() ==
          Approx(1.5 * radius + thickness + 1e-3).margin(0.06e-3));
    CHECK(d.todo.empty());
}

TEST_CASE("a bad specimen file is refused with its position", "[importing]") {
    const Folder folder;
    CHECK_THAT(refusal({"two_shels", {}}),
               Contains("there is no protocol \"two_shels\"") && Contains("did you mean \"two_shells\"?"));
    CHECK_THAT(refusal({{}, folder.path + "/none.json"}), Contains("there is no such file"));
    CHECK_THAT(refusal({{}, folder.write("a.json", "{\n  \"arc_length_m\": 0,1\n}")}),
               Contains("a.json:2:21: ") && Contains("unexpected number"));
    CHECK_THAT(refusal({{}, folder.write("a.json", "[1, 2]")}), Contains("a.json:1:1: this is no JSON object"));
    CHECK_THAT(refusal({"two_shells", folder.write("a.json", R"({"protocol": "arch_between_plates"})")}),
               Contains("/protocol: this is \"arch_between_plates\", but --protocol says \"two_shells\""));
    CHECK_THAT(refusal({"two_shells", folder.write("a.json", R"({"specimens": [1, 2]})")}),
               Contains("this is no part of an experiment"));
}

TEST_CASE("numbers beyond double and deep nesting in a specimen file are refused with their place", "[importing]") {
    const Folder folder;
    CHECK_THAT(refusal({{}, folder.write("a.json", "[1e400]")}), Contains("a.json:1:2: ") && Contains("overflow"));
    CHECK_THAT(refusal({{}, folder.write("a.json", "{\"arc_length_m\": -1e999}")}), Contains("a.json:1:18: "));
    const std::string deep = "{\"a\": " + std::string(100000, '[') + std::string(100000, ']') + "}";
    CHECK_THAT(refusal({{}, folder.write("a.json", deep)}), Contains("nested too deeply"));
    CHECK_THAT(refusal({{}, "/dev/zero"}), Contains("this is a device"));
}

TEST_CASE("values for another number of runs are not used", "[importing]") {
    const Folder folder;
    const auto d = described({{}, folder.write("a.json", R"({"runs": [{"file": "a"}, {"file": "b"}]})")});
    CHECK(test::parseJson(d.json)["runs"].size() == 1);
    CHECK_THAT(joined(d.remarks), Contains("there are 2, here 1"));
}

TEST_CASE("sizes in the header of an export are those of the specimen", "[importing]") {
    const auto all = read("Breite [mm]: 12,5\nThickness: 0.5 mm\n" + exported());
    REQUIRE(all);
    auto d = importing::describe(*all, {});
    REQUIRE(d);
    const Json json = Json::parse(d->json);
    CHECK(json["specimens"][0]["width_m"].get<double>() == Approx(0.0125));
    CHECK(json["specimens"][0]["thickness_m"].get<double>() == Approx(0.0005));
    CHECK_THAT(joined(d->remarks), Contains("/specimens/0/width_m is 0.0125, from line 1 of the export"));
}

TEST_CASE("a shipped scene of a mechanism is found by its name, and lies beside the experiment", "[importing]") {
    std::string swing = "time_s,angle_deg\n";
    for (int i = 0; i < 200; ++i)
        swing += std::to_string(0.02 * i) + "," + std::to_string(30.0 * std::cos(9.0 * 0.02 * i)) + "\n";
    const auto all = read(swing);
    REQUIRE(all);
    importing::TemplateOptions options;
    options.sceneFile = "pendulum";
    const auto named = importing::describe(*all, options);
    INFO(named.error());
    REQUIRE(named);
    options.sceneFile = std::string(SC_SOURCE_DIR) + "/scenes/pendulum.json";
    const auto byPath = importing::describe(*all, options);
    REQUIRE(byPath);
    CHECK(named->json == byPath->json);
    REQUIRE(named->files.size() == 1);
    CHECK(named->files == byPath->files);
    options.sceneFile = "pendulm";
    CHECK_FALSE(importing::describe(*all, options));
}
