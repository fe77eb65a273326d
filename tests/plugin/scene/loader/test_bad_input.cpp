// Every error in a file gets a message with its position and a hint how to correct it.

#include "tests/plugin/scene/loader/support.h"
#include "tests/support/text.h"

#include <filesystem>
#include <fstream>

#include <sys/stat.h>
#include <unistd.h>

using namespace scenetest;

namespace {

/// The only error of a text.
Problem only(const std::string& text, const std::vector<Override>& overrides = {}) {
    const auto errors = refused(text, overrides);
    INFO(say(errors));
    REQUIRE(errors.size() == 1);
    return errors.front();
}

/// A scene of one shell with one more member.
std::string shellWith(const std::string& member) {
    return "{\"shell\": [{\"name\": \"a\", \"radius\": 0.02, " + member + "}], \"duration\": 1}";
}

} // namespace

TEST_CASE("a missing file, a directory and an empty file are named") {
    std::vector<Problem> problems;
    CHECK_FALSE(load("/nowhere/at/all.json", {}, problems));
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].toString() == "/nowhere/at/all.json: there is no such file");
    problems.clear();
    CHECK_FALSE(load(SC_SOURCE_DIR, {}, problems));
    REQUIRE(problems.size() == 1);
    CHECK(contains(problems[0].what, "directory"));
    problems.clear();
    CHECK_FALSE(load("", {}, problems));
    CHECK(problems.size() == 1);
    const std::string empty = std::string(SC_BINARY_DIR) + "/empty_scene.json";
    std::ofstream(empty).close();
    problems.clear();
    CHECK_FALSE(load(empty, {}, problems));
    std::filesystem::remove(empty);
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].toString() == empty + ":1:1: the file is empty; expected a JSON object");
    CHECK(contains(only("  \n\n ").what, "empty"));
}

TEST_CASE("syntax errors stand at their line and column") {
    struct Case {
        const char* text;
        int line, column;
    };
    const Case cases[] = {
        {"{\n  \"duration\": }", 2, 15},                // a value is missing
        {"{\n  \"duration\" 3\n}", 2, 14},              // the colon is missing
        {"{\n \"a\": 1,\n}", 3, 1},                     // trailing comma
        {"{\n// comment\n}", 2, 1},                     // comments are not JSON
        {"{\"name\": \"x\"} {}", 1, 15},                // something after the end
        {"{\"name\": tru}", 1, 13},                     // broken literal
        {"{\"duration\": 1", 1, 15},                    // the end is missing
        {"{\"\xC3\xA4\xC3\xB6\": 1, \"x\": !}", 1, 16}, // columns count characters, not bytes
        {"{'a': 1}", 1, 2},
        {"{\"duration\": 01}", 1, 15},
        {"{\"duration\": +1}", 1, 14},
        {"{\"duration\": NaN}", 1, 14},
        {"{\"duration\" true}", 1, 13},
        {"{\"a\": 1 \"b\": 2}", 1, 9},
        {"{\"a\": [1, 2 false]}", 1, 13},
        {"{\"a\": 1, 2: 3}", 1, 10},
        {"{\"duration\": -Infinity}", 1, 15},
    };
    for (const Case& c : cases) {
        INFO(c.text);
        const Problem p = only(c.text);
        INFO(p.toString());
        CHECK(p.line == c.line);
        CHECK(p.column == c.column);
    }
}

TEST_CASE("numbers beyond double precision are refused where they stand") {
    const Problem p = only("{\n  \"duration\": 1e999\n}");
    CHECK(p.line == 2);
    CHECK(p.column == 15);
    CHECK(contains(p.what, "1e999"));
    CHECK(only("{\"numerics\": {\"dt_max\": -1e999}}").column == 25);
}

TEST_CASE("broken UTF-8, zero bytes and a cut-off text are refused") {
    CHECK(contains(only("{\"name\": \"\xE2\x82\"}").what, "UTF-8"));
    CHECK(contains(only("{\"name\": \"abc\xE2").what, "UTF-8"));
    CHECK(contains(only("{\"name\": \"\xFF\"}").what, "UTF-8"));
    CHECK(contains(only(std::string("{\"duration\": 1}\0 trailing", 25)).what, "zero byte"));
    // What is printed stays printable: the broken bytes are not repeated.
    CHECK_FALSE(contains(only("{\"name\": \"\xFF\"}").toString(), "\xFF"));
    // A byte order mark is harmless.
    loadedText("\xEF\xBB\xBF{\"duration\": 1}");
}

TEST_CASE("a file of millions of values is refused before it takes the memory") {
    std::string text = "{\"a\": [";
    for (std::size_t i = 0; i < maxValues; ++i)
        text += "1,";
    const Problem p = only(text + "1]}");
    CHECK(contains(p.what, "too many values"));
    CHECK(p.pointer == "/a");
}

TEST_CASE("nesting beyond the limit is a message, not a crash") {
    for (const int depth : {200, 100000, 2000000}) {
        const auto n = static_cast<std::size_t>(depth);
        CHECK(contains(only("{\"x\": " + std::string(n, '[') + std::string(n, ']') + "}").what, "nested too deeply"));
        CHECK(contains(only(std::string(n, '[')).what, "nested too deeply"));
    }
    std::string segments;
    for (int i = 0; i < 1000; ++i)
        segments += "{\"repeat\": 2, \"segments\": [";
    CHECK(contains(only("{\"protocol\": {\"segments\": [" + segments).what, "nested too deeply"));
    CHECK_FALSE(refused("{\"constants\": {\"a\": {\"expr\": \"" + std::string(100000, '(') + "\"}}}").empty());
    CHECK_FALSE(refused("{\"constants\": {\"a\": {\"expr\": \"" + std::string(1999, '(') + "\"}}}").empty());
}

TEST_CASE("duplicate keys are refused, with the place of the second") {
    const Problem p = only("{\n  \"shell\": [ { \"mu\": 0.1,\n \"mu\": 0.2 } ]\n}");
    CHECK(p.line == 3);
    CHECK(p.column == 2);
    CHECK(p.pointer == "/shell/0/mu");
    CHECK(contains(p.what, "duplicate key \"mu\""));
}

TEST_CASE("the whole file must be an object") {
    CHECK(contains(only("[]").expected, "object"));
    CHECK(contains(only("3").what, "a number"));
    CHECK(contains(only("null").what, "null"));
}

TEST_CASE("an unknown key is reported with the nearest known one") {
    const Problem p = only("{\n  \"shell\": [\n    { \"thicknes\": 0.001 } ],\n  \"duration\": 1\n}");
    CHECK(p.toString() == "text.json:3:7: /shell/0/thicknes: unknown key \"thicknes\"; did you mean \"thickness\"?");
    CHECK(only("{\"duraton\": 1}").nearest == "duration");
    CHECK(only("{\"Duration\": 1}").nearest == "duration");
    CHECK(only("{\"gravity\": {\"x\": 0, \"y\": 0, \"z\": 0}}").pointer == "/gravity/z");
    CHECK(only("{\"qqqqqqqqqqqq\": 1}").nearest.empty());
    CHECK(only("{\"a/b~c\": 1}").pointer == "/a~1b~0c");
    CHECK(only("{\"parameters\": {\"a\": {\"value\": 1, \"mim\": 0}}}").nearest == "min");
    CHECK(only("{\"body\": [{\"fixture\": [{\"circle\": {\"radius\": 1}, \"frictoin\": 1}]}]}").nearest == "friction");
    CHECK(only("{\"protocol\": {\"segments\": [{\"hold\": 1, \"stop_wen\": {}}]}}").pointer ==
          "/protocol/segments/0/stop_wen");
}

TEST_CASE("every problem of a file is reported, not only the first") {
    const auto errors = refused("{\"duration\": -1, \"shell\": [{\"mu\": -1, \"width\": \"wide\"}, 3], \"foo\": 1,"
                                " \"report\": {\"kind\": \"stak\"}, \"numerics\": {\"dt_max\": 0}}");
    INFO(say(errors));
    CHECK(errors.size() == 7);
}

TEST_CASE("of many errors the first twenty are reported and the others counted, in linear time") {
    std::string many = "{\"schema\": \"supercircle-scene/1\"";
    for (int i = 0; i < 200000; ++i)
        many += ",\"k" + std::to_string(i) + "\":1";
    auto errors = refused(many + "}");
    REQUIRE(errors.size() == 21);
    CHECK(errors[19].pointer == "/k19");
    CHECK(errors[20].toString() == "text.json: and 199980 more errors");
    std::string twice = "{\"a\": 1";
    for (int i = 0; i < 200000; ++i)
        twice += ",\"a\":1";
    CHECK(refused(twice + "}").size() == 20);
    std::string shells;
    for (int i = 0; i < 21; ++i)
        shells += i == 0 ? "{\"mu\": -1}" : ", {\"mu\": -1}";
    errors = refused("{\"shell\": [" + shells + "]}");
    REQUIRE(errors.size() == 21);
    CHECK(errors[20].what == "and 1 more error");
}

TEST_CASE("devices, pipes and files without end are refused unopened") {
    const auto why = [](const std::string& path) {
        std::vector<Problem> problems;
        CHECK_FALSE(load(path, {}, problems));
        REQUIRE(problems.size() == 1);
        return problems[0].what;
    };
    CHECK(contains(why("/dev/zero"), "this is a device"));
    CHECK(contains(why("/dev/null"), "this is a device"));
    const std::string folder = std::filesystem::temp_directory_path().string();
    const std::string pipe = folder + "/supercircle_pipe_" + std::to_string(::getpid());
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    CHECK(contains(why(pipe), "this is a pipe")); // opening it would wait for a writer
    std::filesystem::remove(pipe);
    const std::string sparse = folder + "/supercircle_sparse_" + std::to_string(::getpid());
    std::ofstream(sparse).close();
    std::filesystem::resize_file(sparse, std::uintmax_t{1} << 33);
    CHECK(contains(why(sparse), "larger than 64 MiB"));
    std::filesystem::remove(sparse);
}

TEST_CASE("impossible shells are refused") {
    struct Case {
        const char* member;
        const char* pointer;
    };
    const Case cases[] = {
        {"\"thickness\": -0.001", "/shell/0/thickness"},
        {"\"thickness\": 0", "/shell/0/thickness"},
        {"\"length\": -1", "/shell/0/length"},
        {"\"length\": 0", "/shell/0/length"},
        {"\"width\": 0", "/shell/0/width"},
        {"\"density\": 0", "/shell/0/density"},
        {"\"young_modulus\": -2", "/shell/0/young_modulus"},
        {"\"mu\": -0.1", "/shell/0/mu"},
        {"\"elements\": 0", "/shell/0/elements"},
        {"\"tip_refinement\": 0", "/shell/0/tip_refinement"},
        {"\"tip_refinement\": 200", "/shell/0/tip_refinement"},
        {"\"elements\": 2.5", "/shell/0/elements"},
        {"\"elements\": -3", "/shell/0/elements"},
        {"\"elements\": 1000000000", "/shell/0/elements"},
        {"\"elements\": 1e300", "/shell/0/elements"},
        {"\"elements\": 1", "/shell/0/elements"}, // of 270 degrees
        {"\"elements\": 2", "/shell/0/elements"},
        {"\"phi_bar\": 0", "/shell/0/phi_bar"},
        {"\"phi_bar\": 1.2", "/shell/0/phi_bar"},
        {"\"phi_bar\": 0.9999", "/shell/0"}, // ends overlap
        {"\"thickness\": 0.05", "/shell/0"}, // thicker than the shell is wide
        {"\"position\": [0, 1]", "/shell/0/position"},
        {"\"position\": {\"x\": 1}", "/shell/0/position"},
        {"\"position\": {\"x\": 1, \"y\": true}", "/shell/0/position/y"},
        {"\"category\": 70000", "/shell/0/category"},
        {"\"natural_curvature\": [1, 2, 3]", "/shell/0/natural_curvature"},
        {"\"closed\": 1", "/shell/0/closed"},
        {"\"closed\": true, \"curvature\": 10", "/shell/0"},
        {"\"length\": 0.0001", "/shell/0"}, // thicker than long // the ends do not meet
        {"\"mu\": null", "/shell/0/mu"},
        {"\"mu\": \"0.3\"", "/shell/0/mu"},
        {"\"mu\": [0.3]", "/shell/0/mu"},
        {"\"angle\": {}", "/shell/0/angle"},
        {"\"angle\": {\"param\": 3}", "/shell/0/angle/param"},
        {"\"angle\": {\"param\": \"x\", \"expr\": \"1\"}", "/shell/0/angle"},
    };
    for (const Case& c : cases) {
        INFO(c.member);
        const Problem p = only(shellWith(c.member));
        INFO(p.toString());
        CHECK(p.pointer == c.pointer);
        CHECK(p.line == 1);
        CHECK_FALSE(p.expected.empty());
    }
    CHECK(only("{\"shell\": [{\"radius\": \"infinit\", \"length\": 1}]}").nearest == "infinite");
    CHECK(contains(only("{\"shell\": [{\"radius\": \"infinite\"}]}").what, "without \"length\""));
}

TEST_CASE("messages say the remedy: bodies by index, types by word, angles in degrees") {
    const Problem joint =
        only("{\"body\": [{}], \"joint\": [{\"type\": \"weld\", \"bodyA\": 0, \"bodyB\": 1}], \"duration\": 1}");
    CHECK(joint.pointer == "/joint/0/bodyB");
    CHECK(joint.what == "there is no body 1");
    CHECK(contains(joint.expected, "counts from 0 and has 1 item"));
    CHECK(contains(only("{\"body\": [{\"type\": \"static\"}]}").expected, "0 (static)"));
    CHECK_FALSE(refused("{\"joint\": [{\"type\": \"weld\"}]}").empty());
    std::vector<Problem> problems;
    REQUIRE(loadText(shellWith("\"angle\": 180"), "text.json", {}, problems));
    REQUIRE(problems.size() == 1);
    CHECK(contains(problems[0].what, "angles are in rad"));
}

TEST_CASE("a very thin shell loads with a note of what it costs") {
    std::vector<Problem> problems;
    REQUIRE(loadText(shellWith("\"thickness\": 2e-6"), "text.json", {}, problems));
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].pointer == "/shell/0/thickness");
    CHECK(problems[0].what ==
          "a thickness of 1/10000 of the radius takes about 10 times the steps of a shell of 1/1000");
    problems.clear();
    REQUIRE(loadText(shellWith("\"thickness\": 2e-5"), "text.json", {}, problems));
    CHECK(problems.empty());
}

TEST_CASE("a very thick shell loads with a note of what a thin rod leaves out") {
    std::vector<Problem> problems;
    REQUIRE(loadText(shellWith("\"thickness\": 0.006, \"phi_bar\": 0.5"), "text.json", {}, problems));
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].pointer == "/shell/0/thickness");
    CHECK(contains(problems[0].what, "a thickness of 0.3 of the radius, more than 0.2"));
    problems.clear();
    REQUIRE(
        loadText(shellWith("\"thickness\": {\"expr\": \"0.2*0.02\"}, \"phi_bar\": 0.5"), "text.json", {}, problems));
    CHECK(problems.empty());
}

TEST_CASE("names must be known and unique") {
    const std::string shells = "{\"shell\": [{\"name\": \"upper\"}], \"duration\": 1, ";
    const Problem p = only(shells + "\"hold\": [{\"shell\": \"uper\"}]}");
    CHECK(p.pointer == "/hold/0/shell");
    CHECK(p.nearest == "upper");
    CHECK(contains(only("{\"hold\": [{}]}").what, "\"shell\" is missing"));
    CHECK(only(shells + "\"hold\": [{\"shell\": \"upper\", \"kind\": \"clmap\"}]}").nearest == "clamp");
    CHECK(only(shells + "\"hold\": [{\"shell\": \"upper\", \"arc_fraction\": 1.5}]}").pointer ==
          "/hold/0/arc_fraction");
    CHECK(contains(only("{\"shell\": [{\"name\": \"a\"}, {\"name\": \"a\"}]}").what, "already a shell named \"a\""));
    const std::string plate = "{\"body\": [{\"name\": \"plate\", \"type\": 1}, {\"name\": \"rock\"}], ";
    const std::string segments = "\"segments\": [{\"speed_m_s\": 1, \"stop_when\": {\"time\": 1}}]}}";
    CHECK(only(plate + "\"protocol\": {\"body\": \"plat\", " + segments).nearest == "plate");
    CHECK(contains(only(plate + "\"protocol\": {\"body\": \"rock\", " + segments).what, "not kinematic"));
    CHECK(contains(only("{\"protocol\": {" + segments).what, "nothing is attached"));
}

TEST_CASE("impossible protocols are refused") {
    const auto protocol = [](const std::string& segments) {
        return "{\"body\": [{\"name\": \"p\", \"type\": 1}], \"protocol\": {\"body\": \"p\", \"segments\": [" +
               segments + "]}}";
    };
    CHECK(contains(only(protocol("{}")).what, "a segment of no kind"));
    CHECK(contains(only(protocol("{\"speed_m_s\": 1, \"hold\": 2}")).what, "several kinds"));
    CHECK(contains(only(protocol("{\"speed_m_s\": 1}")).what, "\"stop_when\" is missing"));
    CHECK(contains(only(protocol("{\"speed_m_s\": 1, \"stop_when\": {}}")).what, "never end"));
    CHECK(contains(only(protocol("{\"speed_m_s\": 0, \"stop_when\": {\"time\": 1}}")).what, "does not move"));
    CHECK(only(protocol("{\"speed_m_s\": 1, \"stop_when\": {\"time\": 0}}")).pointer ==
          "/protocol/segments/0/stop_when/time");
    CHECK(only(protocol("{\"hold\": -1}")).pointer == "/protocol/segments/0/hold");
    CHECK(only(protocol("{\"repeat\": -1, \"segments\": []}")).pointer == "/protocol/segments/0/repeat");
    CHECK(only(protocol("{\"repeat\": 1.5, \"segments\": []}")).pointer == "/protocol/segments/0/repeat");
    CHECK(contains(only(protocol("{\"repeat\": 2}")).what, "\"segments\" is missing"));
    CHECK(only(protocol("{\"repeat\": 3, \"segments\": [{\"hold\": -1}]}")).pointer ==
          "/protocol/segments/0/segments/0/hold");
    CHECK(contains(only(protocol("{\"repeat\": 2, \"cycle\": true, \"segments\": [{\"repeat\": 1, \"cycle\": true, "
                                 "\"segments\": []}]}"))
                       .what,
                   "cycles inside a cycle"));
    // Nested repeats multiply: their product is bounded. Empty ones need no memory, but time.
    std::string nested = "{\"hold\": 1}";
    for (int i = 0; i < 8; ++i)
        nested = "{\"repeat\": 1000, \"segments\": [" + nested + "]}";
    CHECK(contains(only(protocol(nested)).what, "too many segments"));
    std::string empty;
    for (int i = 0; i < 8; ++i)
        empty = "{\"repeat\": 100000, \"segments\": [" + empty + "]}";
    loadedText(protocol(empty));
    CHECK(only("{\"protocol\": {\"direction\": 0, \"segments\": []}}").pointer == "/protocol/direction");
}

TEST_CASE("impossible bodies are refused before Box2D aborts on them") {
    const auto fixture = [](const std::string& shape) {
        return "{\"body\": [{\"fixture\": [{" + shape + "}]}], \"duration\": 1}";
    };
    const auto polygon = [&](const std::string& x, const std::string& y) {
        return fixture("\"polygon\": {\"vertices\": {\"x\": [" + x + "], \"y\": [" + y + "]}}");
    };
    CHECK(contains(only(polygon("0,2,1,1", "0,0,0.5,2")).what, "not convex")); // a dart
    CHECK(contains(only(polygon("0,1,0,1", "0,1,1,0")).what, "not convex"));   // a bow tie
    CHECK(contains(only(polygon("0,0.59,-0.95,0.95,-0.59", "1,-0.81,0.31,0.31,-0.81")).what,
                   "not convex"));                                       // a pentagram
    CHECK(contains(only(polygon("0,1,2", "0,1,2")).what, "not convex")); // a line
    CHECK(contains(only(polygon("0,1", "0,1")).what, "2 vertices"));
    CHECK(contains(only(polygon("0,1e5,0", "0,0,1e5")).what, "too far out"));
    CHECK(contains(only("{\"body\": [{\"position\": {\"x\": 1e9, \"y\": 0}}]}").what, "too far out"));
    CHECK(contains(only(polygon("1,0.9,0.6,0.2,-0.2,-0.6,-0.9,-1,0", "0,0.4,0.8,0.9,0.9,0.8,0.4,0,-1")).what,
                   "9 vertices"));
    CHECK(contains(only(polygon("0,1,2,1", "0,0,0,5e-6")).what, "area")); // corners turn, but hold nothing
    CHECK(contains(only(polygon("0,1,1,1", "0,0,0,1")).what, "coincide"));
    CHECK(contains(only(polygon("0,0.001,0.001", "0,0,0.001")).what, "coincide")); // below Box2D's tolerance at scale 1
    CHECK(contains(only(polygon("0,1,1", "0,0")).what, "3 x but 2 y"));
    CHECK(contains(only(fixture("\"density\": 1")).what, "without a shape"));
    CHECK(contains(only(fixture("\"circle\": {\"radius\": 1}, \"loop\": {}")).what, "several shapes"));
    CHECK(contains(only(fixture("\"circle\": {}")).what, "\"radius\" is missing"));
    CHECK(only(fixture("\"circle\": {\"radius\": 0}")).pointer == "/body/0/fixture/0/circle/radius");
    CHECK(contains(only(fixture("\"chain\": {\"vertices\": {\"x\": [1], \"y\": [1]}}")).what, "1 vertices"));
    CHECK(contains(only(fixture("\"chain\": {\"vertices\": {\"x\": [1,1], \"y\": [1,1]}}")).what, "coincide"));
    CHECK(only("{\"body\": [{\"type\": 3}]}").pointer == "/body/0/type");
    CHECK(only("{\"body\": [{\"type\": \"dynamic\"}]}").pointer == "/body/0/type");
    CHECK(
        contains(only("{\"body\": [{},{}], \"joint\": [{\"type\": \"weld\", \"bodyA\": 0, \"bodyB\": 2}]}").what, "2"));
    CHECK(contains(only("{\"body\": [{},{}], \"joint\": [{\"type\": \"weld\", \"bodyA\": 1, \"bodyB\": 1}]}").what,
                   "does not join"));
    CHECK(only("{\"body\": [{},{}], \"joint\": [{\"type\": \"welt\", \"bodyA\": 1, \"bodyB\": 0}]}").nearest == "weld");
    CHECK(only("{\"lengthScale\": 0}").pointer == "/lengthScale");
    CHECK(only("{\"gravity\": {\"x\": 0, \"y\": \"7F800000\"}}").pointer == "/gravity/y"); // infinity in hex
    CHECK(only("{\"gravity\": {\"x\": 0, \"y\": \"10\"}}").pointer == "/gravity/y");
    CHECK(only("{\"gravity\": 9.81}").pointer == "/gravity");
}

TEST_CASE("other blocks are checked") {
    CHECK(contains(only("{\"schema\": \"supercircle-scene/2\"}").expected, "supercircle-scene/1"));
    CHECK(only("{\"report\": {\"kind\": \"stck\"}}").nearest == "stack");
    CHECK(contains(only("{\"numerics\": {\"dt_max\": 0.001, \"dt_min\": 0.01}}").what, "empty"));
    CHECK(contains(only("{\"drop\": {\"shell\": {}, \"x_min\": 1, \"x_max\": 0}}").what, "empty"));
    CHECK(contains(only("{\"drop\": {\"shell\": {}, \"x_min\": 1}}").what, "\"x_max\" is missing"));
    CHECK(only("{\"drop\": {\"shell\": {\"position\": 0}, \"x_min\": 0, \"x_max\": 1}}").pointer ==
          "/drop/shell/position");
    CHECK(only("{\"drop\": {\"shell\": {}, \"x_min\": 0, \"x_max\": 1, \"count\": 0}}").pointer == "/drop/count");
    CHECK(only("{\"shell\": {}}").expected == "an array");
}

TEST_CASE("no cut and no flipped byte of a valid file crashes the loader") {
    std::vector<Problem> problems;
    const std::string text = test::contentOf(scenePath("squeeze"));
    REQUIRE(text.size() > 1000);
    const std::size_t end = text.rfind('}');
    for (std::size_t n = 0; n <= end; n += 3) {
        problems.clear();
        CHECK_FALSE(loadText(text.substr(0, n), "cut.json", {}, problems));
        REQUIRE_FALSE(problems.empty());
        CHECK(problems.front().line > 0);
    }
    std::uint32_t random = 12345; // a linear congruential generator: the same damage on every system
    const auto next = [&] { return random = random * 1664525u + 1013904223u, random >> 8; };
    for (int i = 0; i < 3000; ++i) {
        std::string damaged = text;
        for (int k = 0; k < 1 + i % 3; ++k)
            damaged[next() % damaged.size()] = static_cast<char>(next() & 0xff);
        problems.clear();
        const auto scene = loadText(damaged, "damaged.json", {}, problems);
        CHECK(bool(scene) != anyError(problems));
    }
}

TEST_CASE("errors in a level are reported at their positions") {
    const auto errors = refused(R"({
  "body": [{"name": "craft", "type": 2}, {"name": "pad", "type": 0}],
  "game": {"kind": "lander", "actor": "kraft", "service": "craft", "limt": 3, "part": [{"name": "leg", "colour": "red"}],
    "goal": {"lower": {"x": 1, "y": 0}, "upper": {"x": 0, "y": 1}}}})");
    const std::string all = say(errors);
    INFO(all);
    CHECK(errors.size() == 5);
    CHECK(contains(all, "3:39: /game/actor: there is no body named \"kraft\""));
    CHECK(contains(all, "did you mean \"craft\"?"));
    CHECK(contains(all, "/game/service: the body \"craft\" is of another type; expected \"type\": 0"));
    CHECK(contains(all, "unknown key \"limt\""));
    CHECK(contains(all, "did you mean \"limit\"?"));
    CHECK(contains(all, "/game/part/0/colour: this is not a colour"));
    CHECK(contains(all, "4:13: /game/goal: the area is empty"));
}

TEST_CASE("a level names its bodies, and each fault of it is one message") {
    const auto errors = refused(R"({
  "body": [{"type": 2}, {"type": 1}],
  "game": {"kind": "egg_drop", "actor": "", "carrier": "", "heights": "high", "part": 3}})");
    const std::string all = say(errors);
    INFO(all);
    CHECK(errors.size() == 4); // bodies without a name are not named ""
    for (const char* key : {"actor", "carrier", "heights", "part"})
        CHECK(contains(all, std::string("/game/") + key + ": "));
}

TEST_CASE("an unknown accuracy is named with those there are") {
    const Problem p = only(shellWith("\"mu\": 0.1").insert(1, R"("numerics": {"accuracy": "exakt"}, )"));
    CHECK(contains(p.toString(), "/numerics/accuracy"));
    CHECK(contains(p.toString(), R"(one of "exact", "standard", "fast")"));
}
