// The laboratory from C: its numbers are those of the program's functions, its answers JSON, and it can be cancelled.

#include "bridge/box2d/lab_world.h"
#include "bridge/c/include/supercircle_lab.h"
#include "plugin/lab/session/run_scene.h"
#include "plugin/scene/loader/loader.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <unistd.h>

using Json = nlohmann::json;

namespace {

const std::string kScenes = std::string(SC_SOURCE_DIR) + "/scenes/";
const std::string kCase = std::string(SC_TEST_DATA) + "/recordings/baseline/case_101/experiment.json";

using Call = const char* (*)(const char*, sc_lab_progress, void*);

Json ask(Call call, const Json& request, sc_lab_progress progress = nullptr, void* context = nullptr) {
    const char* answer = call(request.dump().c_str(), progress, context);
    INFO(sc_lab_error());
    REQUIRE(answer != nullptr);
    CHECK(sc_lab_status() == SC_OK);
    return Json::parse(answer);
}

std::string refusal(Call call, const char* request) {
    REQUIRE(call(request, nullptr, nullptr) == nullptr);
    CHECK(sc_lab_status() == SC_BAD_INPUT);
    return sc_lab_error();
}

int32_t cancelAtOnce(void* context, double fraction, const char* stage) {
    *static_cast<bool*>(context) = fraction >= 0.0 && fraction <= 1.0 && stage != nullptr;
    return 1;
}

} // namespace

TEST_CASE("a run asked for in JSON has the numbers of the laboratory", "[c][lab]") {
    const Json answer =
        ask(sc_lab_run,
            {{"file", kScenes + "two_shells.json"}, {"parameters", {{"travel_over_R", 0.2}}}, {"pictures", true}});
    CHECK(answer["status"] == "done");
    CHECK(answer["pictures"]["curve"].get<std::string>().find("<svg") == 0);
    std::vector<supercircle::scene::Problem> problems;
    const auto scene = supercircle::scene::load(kScenes + "two_shells.json", {{"travel_over_R", 0.2}}, problems);
    REQUIRE(scene);
    std::string why;
    const auto result = supercircle::lab::runScene(*scene, supercircle::bridge::makeWorld(scene->rigid, why), {});
    const std::vector<double>* force = result.recording.series.find("force_N");
    REQUIRE(force != nullptr);
    CHECK(answer["series"]["force_N"].get<std::vector<double>>() == *force); // to the last bit, through the text
}

TEST_CASE("ensembles of stacks are diagnosed", "[c][lab]") {
    namespace fs = std::filesystem;
    const fs::path folder = fs::temp_directory_path() / ("sc_ensembles_" + std::to_string(::getpid()));
    fs::create_directories(folder);
    const auto table = [&](const char* name, double shift) {
        std::ofstream out(folder / name);
        out << "height\n";
        for (int k = 0; k < 12; ++k)
            out << shift + 0.1 * std::sin(7.0 * k + shift) << "\n";
    };
    table("recorded.csv", 9.0);
    table("nominal.csv", 8.0);
    table("sticky.csv", 9.0);
    const std::string file = (folder / "stacks.json").string();
    std::ofstream(file) << R"({"schema": "stack-ensembles/1", "recorded": "recorded.csv", "nominal": "nominal.csv",
        "effects": [{"label": "adhesion", "file": "sticky.csv"}], "quantities": ["height"]})";
    const Json answer = ask(sc_lab_diagnose, {{"file", file}});
    CHECK(answer["diagnosis"]["verdict"] == "identified"); // ten standard deviations, and the same ones again
    CHECK(answer["diagnosis"]["effects"][0]["label"] == "adhesion");
    fs::remove(folder / "sticky.csv");
    CHECK(refusal(sc_lab_diagnose, Json{{"file", file}}.dump().c_str()).find("sticky.csv") != std::string::npos);
    fs::remove_all(folder);
}

TEST_CASE("a sweep, a check, an import and a replay answer in JSON", "[c][lab]") {
    const Json sweep = ask(sc_lab_sweep, {{"sweep",
                                           {{"schema", "supercircle-sweep/1"},
                                            {"scene", "two_shells.json"},
                                            {"grid", {{"mu", {0.1, 0.35}}}},
                                            {"fixed", {{"travel_over_R", 0.1}}}}},
                                          {"file", kScenes + "here.json"},
                                          {"jobs", 2}});
    REQUIRE(sweep["runs"].size() == 2);
    CHECK(sweep["runs"][1]["parameters"]["mu"] == 0.35);
    CHECK(sweep["runs"][1]["status"] == "done");

    CHECK(ask(sc_lab_check, {{"file", kScenes + "ramp.json"}})["valid"] == true);
    CHECK(ask(sc_lab_check, {{"file", kCase}})["kind"] == "experiment");
    const Json bad = ask(sc_lab_check, {{"scene", {{"shel", Json::array()}}}});
    CHECK(bad["valid"] == false);
    CHECK(bad["problems"][0]["nearest"] == "shell");

    const Json imported =
        ask(sc_lab_import, {{"files", {std::string(SC_SOURCE_DIR) + "/examples/import/shell_on_cylinder.csv"}}});
    CHECK(imported["files"].contains("experiment.json"));
    const Json replay = ask(sc_lab_replay, {{"file", kCase}, {"fidelity", "coarse"}});
    CHECK(replay["status"] == "done");
    CHECK(replay["curves"][0]["simulated"].size() == replay["curves"][0]["recorded"].size());
}

TEST_CASE("files may come in the request, as texts or bytes", "[c][lab]") {
    const auto text = [](const std::filesystem::path& file) {
        std::ifstream in(file, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    Json content;
    for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(kCase).parent_path()))
        content["memory/" + file.path().filename().string()] = text(file.path());
    const Json request = {{"file", "memory/experiment.json"}, {"fidelity", "coarse"}, {"content", content}};
    const Json here = ask(sc_lab_replay, request),
               there = ask(sc_lab_replay, {{"file", kCase}, {"fidelity", "coarse"}});
    CHECK(here["curves"] == there["curves"]);
    bool told = false; // work for a watcher is done in another thread
    CHECK(ask(sc_lab_check, {{"file", "memory/experiment.json"}, {"content", content}}, cancelAtOnce, &told)["valid"] ==
          true);

    // "Kraft" with an umlaut of Windows-1252, which no JSON text can hold.
    const Json imported =
        ask(sc_lab_import,
            {{"files", {"pr\u00fcfung.csv"}},
             {"specimen", "specimen.json"},
             {"content",
              {{"pr\u00fcfung.csv",
                {{"base64", "WmVpdCBbc107V2VnIFttbV07S3LkZnQgW05dCjA7MDswCjE7MTsxCjI7MjsyCjM7MzszCjQ7NDs0CjU7NTs1"}}},
               {"specimen.json", text(std::string(SC_SOURCE_DIR) + "/examples/import/specimen.json")}}}});
    CHECK(imported["account"].get<std::string>().find("Windows-1252") != std::string::npos);
    CHECK(imported["files"].contains("run_1.csv"));
    CHECK(ask(sc_lab_check, {{"file", kCase}})["valid"] == true); // what came in a request is gone with it

    for (const char* wrong :
         {R"({"base64": "AB"})", R"({"base64": "A*=="})", R"({"bytes": "AAAA"})", "3", R"({"base64": "A==="})"})
        CHECK(refusal(sc_lab_import, (R"({"files": ["a"], "content": {"a": )" + std::string(wrong) + "}}").c_str())
                  .find("content") != std::string::npos);
}

TEST_CASE("work is cancelled from the caller's thread", "[c][lab]") {
    bool told = false;
    CHECK(ask(sc_lab_run, {{"file", kScenes + "stack30.json"}}, cancelAtOnce, &told)["status"] == "cancelled");
    CHECK(told);
    told = false;
    CHECK(ask(sc_lab_diagnose, {{"file", kCase}, {"jobs", 1}}, cancelAtOnce, &told)["status"] == "cancelled");
    CHECK(told);
}

TEST_CASE("requests that make no sense are refused with a sentence", "[c][lab]") {
    for (const Call call : {sc_lab_run, sc_lab_sweep, sc_lab_import, sc_lab_replay, sc_lab_diagnose, sc_lab_check})
        for (const char* request : {static_cast<const char*>(nullptr), "", "[]", "{\"file\": 3}", "{}", "\xff"})
            CHECK(refusal(call, request).size() > 10);
    const std::string deep = "{\"scene\": {\"a\": " + std::string(100000, '[') + std::string(100000, ']') + "}}";
    CHECK(refusal(sc_lab_run, deep.c_str()).find("deep") != std::string::npos);
    CHECK(refusal(sc_lab_run, "{\"scen\": {}}").find("did you mean \"scene\"") != std::string::npos);
    CHECK(refusal(sc_lab_run, "{\"scene\": {}, \"seed\": -1}").find("\"seed\"") != std::string::npos);
    CHECK(refusal(sc_lab_replay, "{\"file\": \"/nowhere/experiment.json\"}").find("nowhere") != std::string::npos);
}
