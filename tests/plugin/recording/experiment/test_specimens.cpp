// Several specimens of an experiment with a scene: what is read, and what is refused.

#include "tests/plugin/recording/experiment/support.h"
#include "tests/support/json.h"
#include "tests/support/schema.h"

#include <nlohmann/json.hpp>

using namespace experimenttest;
using Catch::Matchers::Contains;
using nlohmann::json;

namespace {

json valid() {
    return json::parse(R"({"schema": "rod-recordings/1", "protocol": "scene", "scene": "mass_on_spring",
        "scene_parameters": {"frequency": {"value": 2, "unc": 0.1}, "damping_ratio": 0.01, "cubic": 0},
        "specimens": [{"id": "a", "parameters": {"mass": {"value": 0.5, "unc": 0.01}}},
                      {"id": "b", "parameters": {"mass": 0.6}}],
        "batch": {"frequency": {"std_rel": {"scale": 0.05}}, "cubic": {"std": {"scale": 3}}, "damping_ratio": {"std": 0}},
        "channels": [{"observe": "position", "column": "y_mm"}],
        "runs": [{"file": "1.csv", "specimen": "b"}, {"file": "2.csv", "specimen": "a"}]})");
}

Result<experiment::Experiment> loaded(const json& document, std::string& problems) {
    const Folder folder;
    for (const char* file : {"1.csv", "2.csv"})
        folder.write(file, "time_s,y_mm\n0,50\n0.1,20\n0.2,-30\n0.3,-50\n0.4,0\n");
    std::vector<scene::Problem> found;
    auto experiment = experiment::load(folder.write("experiment.json", test::jsonText(document)), found);
    for (const scene::Problem& p : found)
        problems += p.toString() + "\n";
    return experiment;
}

std::string problemsOf(const json& document) {
    std::string problems;
    CHECK_FALSE(loaded(document, problems));
    return problems;
}

bool schemaAccepts(const json& document) {
    return test::schemaErrors("plugin/recording/experiment/experiment.schema.json", document).empty();
}

} // namespace

TEST_CASE("runs name their specimen, and a batch states the scale of its scatter", "[experiment][specimens]") {
    std::string problems;
    const auto e = loaded(valid(), problems);
    INFO(problems);
    REQUIRE(e);
    CHECK(problems.empty());
    CHECK(schemaAccepts(valid()));
    const experiment::FreeScene& scene = *e->scene;
    REQUIRE(scene.specimens.size() == 2);
    CHECK(scene.specimens[0].id == "a");
    CHECK(scene.specimens[0].parameters.front().stated.halfWidth == 0.01);
    CHECK(scene.specimens[1].parameters.front().unit == "kg"); // as the scene says
    REQUIRE(scene.batch.size() == 3);
    CHECK(scene.batch[0].scale == 3.0); // json sorts the names: cubic, damping_ratio, frequency
    CHECK(scene.batch[1].scale == 0.0);
    CHECK(scene.batch[2].scale == Approx(0.1)); // relative to 2 Hz
    CHECK(e->runs[0].specimen == 1);
    CHECK(e->runs[1].specimen == 0);
    CHECK(e->specimens.empty()); // those are strips
}

TEST_CASE("specimens that do not fit are refused with the remedy", "[experiment][specimens]") {
    const auto changed = [](const char* pointer, const json& value, bool schemaToo = false) {
        json document = valid();
        document[json::json_pointer(pointer)] = value;
        INFO(pointer);
        CHECK((!schemaToo || !schemaAccepts(document)));
        return problemsOf(document);
    };
    CHECK_THAT(changed("/runs/0/specimen", "c"), Contains("/runs/0/specimen") && Contains("no specimen \"c\""));
    CHECK_THAT(changed("/specimens/1/id", "a"), Contains("two specimens \"a\""));
    CHECK_THAT(changed("/specimens/1/id", "b.1", true), Contains("is no name"));
    CHECK_THAT(changed("/specimens/0/parameters/mas", 1), Contains("mas") && Contains("mass"));
    CHECK_THAT(changed("/batch/frequenzy", {{"std", 0}}),
               Contains("/batch/frequenzy") && Contains("did you mean \"frequency\""));
    CHECK_THAT(changed("/batch/frequency", {{"std", 0.1}}, true), Contains("scale"));
    CHECK_THAT(changed("/batch/frequency", json::object(), true), Contains("\"std\": 0"));
    CHECK_THAT(changed("/batch/frequency", {{"std_rel", {{"scale", -1}}}}, true), Contains("/batch/frequency/std_rel"));
    CHECK_THAT(changed("/batch/cubic", {{"std_rel", {{"scale", 0.1}}}}),
               Contains("the stated value of \"cubic\" is 0"));
    CHECK_THAT(changed("/batch/mass", {{"std", 0}}), Contains("/batch/mass"));
    CHECK_THAT(changed("/runs/0/parameters", {{"frequency", 2.1}}), Contains("belongs to the specimens"));
    json document = valid();
    document["runs"][0].erase("specimen");
    CHECK_THAT(problemsOf(document), Contains("which specimen this run has"));
    document = valid();
    document.erase("specimens");
    CHECK_THAT(problemsOf(document), Contains("no specimens that could differ"));
}

TEST_CASE("a specimen without runs is noted", "[experiment][specimens]") {
    json document = valid();
    document["runs"][1]["specimen"] = "b";
    std::string problems;
    CHECK(loaded(document, problems));
    CHECK_THAT(problems, Contains("no run has specimen \"a\""));
}
