// The JSON Schema (for editors and other tools) says the same as the loader.

#include "tests/plugin/scene/loader/support.h"
#include "tests/support/json.h"
#include "tests/support/schema.h"
#include "tests/support/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

using namespace scenetest;
using nlohmann::json;

namespace {

/// Errors of the schema, empty if it accepts.
std::string schemaErrors(const json& document) {
    return test::schemaErrors("plugin/scene/scene.schema.json", document);
}

/// Every property name anywhere in a schema, without deprecated ones.
void collectKeys(const json& schema, std::vector<std::string>& keys) {
    if (schema.is_object() && schema.contains("properties"))
        for (const auto& item : schema["properties"].items())
            if (!item.value().is_object() || !item.value().value("deprecated", false))
                keys.push_back(item.key());
    if (schema.is_structured())
        for (const auto& child : schema)
            collectKeys(child, keys);
}

} // namespace

TEST_CASE("the schema accepts every scene and the R.U.B.E. sample") {
    for (const std::string& name : sceneNames()) {
        INFO(name);
        CHECK(schemaErrors(test::jsonOf(scenePath(name))) == "");
    }
    CHECK(schemaErrors(test::jsonOf(std::string(SC_SOURCE_DIR) + "/tests/plugin/scene/loader/rube_sample.json")) == "");
}

TEST_CASE("every level is accepted by loader and schema, and so is the one in the guide") {
    std::vector<std::string> levels;
    for (const auto& entry : std::filesystem::directory_iterator(std::string(SC_SOURCE_DIR) + "/scenes/games"))
        levels.push_back(entry.path().string());
    std::sort(levels.begin(), levels.end());
    CHECK(levels.size() >= 9); // three games of three levels
    for (const std::string& path : levels) {
        INFO(path);
        CHECK(loaded(path).game.has_value());
        CHECK(schemaErrors(test::jsonOf(path)) == "");
    }
    const std::string guide = test::contentOf(std::string(SC_SOURCE_DIR) + "/docs/how-to/levels.md");
    const std::size_t begin = guide.find("```json\n") + 8;
    const std::string first = guide.substr(begin, guide.find("```", begin) - begin);
    CHECK(loadedText(first).game.has_value());
    CHECK(schemaErrors(test::parseJson(first)) == "");
}

TEST_CASE("schema and loader refuse the same files") {
    const char* files[] = {
        R"([])",
        R"({"schema": "supercircle-scene/2"})",
        R"({"duraton": 1})",
        R"({"duration": -1})",
        R"({"duration": "long"})",
        R"({"duration": {"param": 3}})",
        R"({"duration": {"param": "a", "expr": "1"}})",
        R"({"lengthScale": 0})",
        R"({"gravity": 9.81})",
        R"({"gravity": {"x": 0}})",
        R"({"parameters": {"a": {}}})",
        R"({"parameters": {"2a": {"value": 1}}})",
        R"({"parameters": {"a": {"value": 1, "integer": 1}}})",
        R"({"constants": {"a": "b"}})",
        R"({"shell": {}})",
        R"({"shell": [{"thickness": 0}]})",
        R"({"shell": [{"thickness": -1}]})",
        R"({"shell": [{"mu": -1}]})",
        R"({"shell": [{"elements": 0}]})",
        R"({"shell": [{"elements": 1.5}]})",
        R"({"shell": [{"radius": "endless", "length": 1}]})",
        R"({"shell": [{"phi_bar": 1.5}]})",
        R"({"shell": [{"colour": "red"}]})",
        R"({"hold": [{}]})",
        R"({"shell": [{"name": "a"}], "hold": [{"shell": "a", "arc_fraction": 2}]})",
        R"({"shell": [{"name": "a"}], "hold": [{"shell": "a", "kind": "glue"}]})",
        R"({"drop": {"shell": {}}})",
        R"({"drop": {"shell": {"position": 0}, "x_min": 0, "x_max": 1}})",
        R"({"protocol": {}})",
        R"({"protocol": {"segments": [{}]}})",
        R"({"protocol": {"segments": [{"hold": -1}]}})",
        R"({"protocol": {"segments": [{"hold": 1, "settle": 1}]}})",
        R"({"body": [{"name": "p", "type": 1}], "protocol": {"body": "p", "segments": [{"speed_m_s": 1}]}})",
        R"({"body": [{"name": "p", "type": 1}], "protocol": {"body": "p", "segments": [{"speed_m_s": 1, "stop_when": {}}]}})",
        R"({"body": [{"name": "p", "type": 1}], "protocol": {"body": "p", "segments": [{"speed_m_s": 0, "stop_when": {"time": 1}}]}})",
        R"({"protocol": {"segments": [{"repeat": 1.5, "segments": []}]}})",
        R"({"body": [{"type": 3}]})",
        R"({"body": [{"fixture": [{}]}]})",
        R"({"body": [{"fixture": [{"circle": {"radius": 0}}]}]})",
        R"({"body": [{"fixture": [{"circle": {"radius": 1}, "edge": {}}]}]})",
        R"({"body": [{"fixture": [{"polygon": {"vertices": {"x": [0, 1], "y": [0, 1]}}}]}]})",
        R"({"body": [{"fixture": [{"polygon": {"vertices": {"x": [0,1,2,3,4,5,6,7,8], "y": [0,1,2,3,4,5,6,7,8]}}}]}]})",
        R"({"body": [{}, {}], "joint": [{"type": "glue", "bodyA": 0, "bodyB": 1}]})",
        R"({"body": [{}, {}], "joint": [{"type": "weld", "bodyA": 0}]})",
        R"({"body": [{"angle": "12"}]})",
        R"({"protocol": {"segments": [], "moves": []}})",
        R"({"protocol": {"segments": [], "zero_at_touch": true, "zero_at_first_contact": true}})",
        R"({"protocol": {"segments": [{"repeat": 1, "segments": [], "moves": []}]}})",
        R"({"body": [{"name": "p", "type": 1}], "protocol": {"body": "p", "segments": [{"travel": 1, "speed_m_s": 1, "stop_when": {"time": 1}}]}})",
        R"({"drop": {"shell": {}, "x_min": 0, "x_max": 1, "together": 2, "batch_size": 2}})",
        R"({"shell": [{"name": "a"}], "hold": [{"shell": "a", "base": "machine"}]})",
        R"({"shell": [{"name": "a"}], "hold": [{"shell": "a", "base": "fixed", "on_machine": false}]})",
        R"({"numerics": {"dt_max": 0}})",
        R"({"report": {"kind": "pie"}})",
        R"({"game": []})",
        R"({"game": {"kind": "chess", "actor": "a", "part": [{"name": "p"}]}, "body": [{"name": "a", "type": 2}]})",
        R"({"game": {"kind": "egg_drop", "actor": "a", "part": [{"name": "p"}]}, "body": [{"name": "a", "type": 2}]})",
        R"({"game": {"kind": "lander", "actor": "a", "part": [{"name": "p"}]}, "body": [{"name": "a", "type": 2}]})",
        R"({"game": {"kind": "egg_drop", "actor": "a", "heights": [1], "part": []}, "body": [{"name": "a", "type": 2}]})",
        R"({"game": {"kind": "egg_drop", "actor": "a", "heights": [], "part": [{"name": "p"}]}, "body": [{"name": "a", "type": 2}]})",
        R"({"game": {"kind": "egg_drop", "actor": "a", "heights": [0], "part": [{"name": "p"}]}, "body": [{"name": "a", "type": 2}]})",
        R"({"game": {"kind": "egg_drop", "actor": "a", "heights": [1], "part": [{"name": "p", "colour": "red"}]}, "body": [{"name": "a", "type": 2}]})",
    };
    for (const char* text : files) {
        INFO(text);
        std::vector<Problem> problems;
        CHECK_FALSE(loadText(text, "bad.json", {}, problems));
        CHECK(schemaErrors(test::parseJson(text)) != "");
    }
}

TEST_CASE("schema and loader accept the same files") {
    const char* files[] = {
        R"({})",
        R"({"about": "nothing", "duration": {"expr": "2*pi", "about": "one turn"}})",
        R"({"gravity": 0, "body": [{"position": 0, "angle": "3FC90FDB"}]})",
        R"({"parameters": {"about": "parameters", "a": {"value": {"expr": "1+1"}, "min": 0}}, "constants": {"b": {"value": 3}}})",
        R"({"shell": [{"radius": "infinite", "length": 0.1, "natural_curvature": 2, "curvature": 1}]})",
        R"({"shell": [{"elements": 3, "natural_curvature": [1, 2, {"expr": "2"}]}]})",
        R"({"protocol": {"segments": [{"repeat": 2, "cycle": true, "segments": [{"settle": 1}, {"hold": 0}]}]}})",
        R"({"parameters": {"a": {"value": 1, "formerly": "b"}}})",
        R"({"shell": [{"name": "a"}], "hold": [{"shell": "a", "base": "moving"}, {"shell": "a", "arc_fraction": 0, "base": "fixed"}]})",
        R"({"body": [{"name": "p", "type": 1}], "protocol": {"body": "p", "zero_at_first_contact": true, "approach_gap": 1, "segments": [{"speed_m_s": 1, "stop_when": {"time": 1}}]}})",
        R"({"body": [{"name": "p", "type": 1}], "protocol": {"body": "p", "zero_at_touch": true, "touch_gap": 1, "moves": [{"travel": 1, "until": {"time": 1}}, {"repeat": 1, "moves": []}]}})",
        R"({"drop": {"shell": {}, "x_min": 0, "x_max": 1, "together": 2}})",
        R"({"shell": [{"name": "a"}], "hold": [{"shell": "a", "on_machine": true}]})",
        R"({"body": [{"name": "a", "type": 2}], "game": {"kind": "egg_drop", "actor": "a", "heights": [1], "part": [{"name": "p", "colour": "#aAbb09"}]}})",
        R"({"body": [{"fixture": [{"loop": {"vertices": {"x": [0, 1, 1], "y": [0, 0, 1]}}}]}]})",
    };
    for (const char* text : files) {
        INFO(text);
        loadedText(text);
        CHECK(schemaErrors(test::parseJson(text)) == "");
    }
}

TEST_CASE("the guide names every key of the schema, and its first scene loads") {
    // The section "game" has a page of its own.
    const std::string guide = test::contentOf(std::string(SC_SOURCE_DIR) + "/docs/reference/scene_format.md") +
                              test::contentOf(std::string(SC_SOURCE_DIR) + "/docs/reference/level_format.md");
    std::vector<std::string> keys;
    collectKeys(test::jsonOf(std::string(SC_SOURCE_DIR) + "/plugin/scene/scene.schema.json"), keys);
    CHECK(keys.size() > 100);
    for (const std::string& key : keys) {
        INFO(key);
        CHECK((contains(guide, "`" + key + "`") || contains(guide, "\"" + key + "\"")));
    }
    const std::size_t begin = guide.find("```json\n") + 8;
    const std::string first = guide.substr(begin, guide.find("```", begin) - begin);
    loadedText(first);
    CHECK(schemaErrors(test::parseJson(first)) == "");
}
