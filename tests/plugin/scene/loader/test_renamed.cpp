// Keys of version 0.1: each still loads, means the same, and gets a note that names its successor.

#include "tests/plugin/scene/loader/support.h"

using namespace scenetest;

namespace {

struct OldKey {
    const char* file;      ///< with the old key
    const char* both;      ///< with the old and the new key
    const char* pointer;   ///< of the old key
    const char* old;       ///< the key
    const char* successor; ///< as the note says it
};

/// A protocol of one body with these members.
#define PROTOCOL(members)                                                                                              \
    R"({"body": [{"name": "p", "type": 1}], "protocol": {"body": "p", )" members                                       \
    "}, \"schema\": \"supercircle-scene/1\"}"
#define DROP(members) R"({"drop": {"shell": {}, "x_min": 0, "x_max": 1, )" members R"(}, "duration": 1})"
#define HOLD(members) R"({"shell": [{"name": "a"}], "duration": 1, "hold": [{"shell": "a", )" members "}]}"

const OldKey oldKeys[] = {
    {PROTOCOL(R"("moves": [{"hold": 1}])"), PROTOCOL(R"("moves": [{"hold": 1}], "segments": [])"), "/protocol/moves",
     "moves", "\"segments\""},
    {PROTOCOL(R"("segments": [{"repeat": 3, "moves": [{"hold": 1}]}])"),
     PROTOCOL(R"("segments": [{"repeat": 3, "moves": [{"hold": 1}], "segments": []}])"), "/protocol/segments/0/moves",
     "moves", "\"segments\""},
    {PROTOCOL(R"("segments": [{"travel": 0.1, "stop_when": {"time": 1}}])"),
     PROTOCOL(R"("segments": [{"travel": 0.1, "speed_m_s": 0.1, "stop_when": {"time": 1}}])"),
     "/protocol/segments/0/travel", "travel", "\"speed_m_s\""},
    {PROTOCOL(R"("segments": [{"speed_m_s": 0.1, "until": {"time": 1}}])"),
     PROTOCOL(R"("segments": [{"speed_m_s": 0.1, "until": {"time": 1}, "stop_when": {"time": 1}}])"),
     "/protocol/segments/0/until", "until", "\"stop_when\""},
    {PROTOCOL(R"("segments": [], "zero_at_touch": true)"),
     PROTOCOL(R"("segments": [], "zero_at_touch": true, "zero_at_first_contact": true)"), "/protocol/zero_at_touch",
     "zero_at_touch", "\"zero_at_first_contact\""},
    {PROTOCOL(R"("segments": [], "touch_gap": 1e-4)"),
     PROTOCOL(R"("segments": [], "touch_gap": 1e-4, "approach_gap": 1e-4)"), "/protocol/touch_gap", "touch_gap",
     "\"approach_gap\""},
    {DROP(R"("together": 3)"), DROP(R"("together": 3, "batch_size": 3)"), "/drop/together", "together",
     "\"batch_size\""},
    {HOLD(R"("on_machine": false)"), HOLD(R"("on_machine": false, "base": "fixed")"), "/hold/0/on_machine",
     "on_machine", "\"base\": \"moving\""},
};

} // namespace

TEST_CASE("every old key loads with one note that names its successor") {
    for (const OldKey& k : oldKeys) {
        INFO(k.file);
        std::vector<Problem> problems;
        const auto scene = loadText(k.file, "text.json", {}, problems);
        INFO(say(problems));
        REQUIRE(scene);
        REQUIRE(problems.size() == 1);
        CHECK(problems[0].severity == Problem::Severity::Note);
        CHECK(problems[0].pointer == k.pointer);
        CHECK(problems[0].line == 1);
        CHECK(problems[0].what == "\"" + std::string(k.old) + "\" is called " + k.successor + " since 0.2");
    }
}

TEST_CASE("an old key beside its successor is an error") {
    for (const OldKey& k : oldKeys) {
        INFO(k.both);
        const auto errors = refused(k.both);
        INFO(say(errors));
        REQUIRE(errors.size() == 1);
        CHECK(errors[0].pointer == k.pointer);
        CHECK(contains(errors[0].what, "both \"" + std::string(k.old) + "\" and \""));
        CHECK(contains(errors[0].expected, "alone"));
    }
}

TEST_CASE("old keys mean what their successors mean") {
    const Scene old = loadedText(R"({"shell": [{"name": "a"}], "hold": [{"shell": "a", "on_machine": true}],
      "drop": {"shell": {}, "x_min": 0, "x_max": 1, "together": 4},
      "protocol": {"zero_at_touch": true, "touch_gap": 2e-5, "moves": [
        {"repeat": 2, "cycle": true, "moves": [{"travel": 0.5, "until": {"force": 5}}, {"travel": -0.5, "until": {"time": 1}}]}]}})");
    const Protocol& p = *old.protocol;
    CHECK(p.zero_at_first_contact);
    CHECK(p.approach_gap == 2e-5);
    REQUIRE(p.segments.size() == 4);
    CHECK(p.segments[0].speed == 0.5);
    CHECK(p.segments[0].stop_when.force == 5.0);
    CHECK(p.segments[3].stop_when.time == 1.0);
    CHECK(p.segments[3].cycle == 2);
    CHECK(old.drop->batch_size == 4);
    CHECK(old.holds[0].base == HoldBase::Moving);
}

TEST_CASE("a key of 0.1 that stands in several places gets one note a file") {
    std::vector<Problem> problems;
    REQUIRE(loadText(PROTOCOL(R"("moves": [{"repeat": 100, "moves": [{"travel": 1, "until": {"time": 1}}]},
                                {"travel": -1, "until": {"time": 1}}])"),
                     "text.json", {}, problems));
    INFO(say(problems));
    CHECK(problems.size() == 3); // moves, travel, until
}

TEST_CASE("messages point at the old key where it stands, and suggest only new ones") {
    CHECK(refused(PROTOCOL(R"("moves": [{"travel": 0, "until": {"time": 1}}])"))[0].pointer ==
          "/protocol/moves/0/travel");
    CHECK(refused(PROTOCOL(R"("moves": [{"travel": 1, "until": {"time": 0}}])"))[0].pointer ==
          "/protocol/moves/0/until/time");
    CHECK(refused(PROTOCOL(R"("segments": [], "zero_at_tuch": true)"))[0].nearest != "zero_at_touch");
    CHECK_FALSE(contains(refused(DROP(R"("togehter": 3)"))[0].toString(), "\"together\""));
}

TEST_CASE("a parameter is also found under its former name, with a note") {
    const std::string text =
        R"({"parameters": {"batch_size": {"value": 1, "max": 9, "formerly": "together"}}, "duration": {"param": "batch_size"}})";
    std::vector<Problem> problems;
    const auto scene = loadText(text, "text.json", {{"together", 5}}, problems);
    INFO(say(problems));
    REQUIRE(scene);
    CHECK(scene->duration == 5.0);
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].what == "\"together\" is called \"batch_size\" since 0.2");
    CHECK(contains(refused(text, {{"together", 50}})[0].what, "out of range"));
    CHECK(
        contains(refused(R"({"parameters": {"a": {"value": 1, "formerly": "b"}}, "duration": {"param": "b"}})")[0].what,
                 "no parameter or constant")); // in the file itself only the present name
}
