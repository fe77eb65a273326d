#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "plugin/recording/table/files.h"
#include "plugin/recording/table/reader.h"
#include "plugin/recording/table/writer.h"
#include "tests/plugin/recording/table/example.h"
#include "tests/support/folder.h"

using namespace supercircle;
using namespace supercircle::record;

TEST_CASE("a trajectory reads back and is written the same again") {
    const Recording recording = test::smallRecording();
    const std::string text = trajectoryJson(recording);
    const auto back = parseTrajectory(text, "t.json");
    REQUIRE(back.error().empty());
    CHECK(trajectoryJson(*back) == text);
    const Recording& r = *back;
    CHECK(r.scene == recording.scene);
    CHECK(r.keyFrames == recording.keyFrames);
    REQUIRE(r.frames.size() == 2);
    CHECK(std::isnan(r.frames[0].force));
    CHECK(r.frames[1].time == recording.frames[1].time); // exact
    CHECK(r.frames[1].phase == "load 1");
    REQUIRE(r.frames[1].shells.size() == 2);
    CHECK(r.frames[1].shells[0].curvature == recording.frames[1].shells[0].curvature); // floats, exact
    CHECK(r.frames[1].shells[0].start[1] == Approx(1.0 / 3.0).epsilon(6e-8));          // rounded to float: 2^-24
    CHECK(r.frames[1].contacts[0].slips);
    CHECK(r.outlines[1].driven);
    CHECK(r.outlines[2].kind == OutlineInfo::Kind::Circle);
    CHECK(r.shells[1].closed);
    CHECK(r.events[0].text == "1 over 2");
}

TEST_CASE("a summary reads back and is written the same again") {
    const Recording recording = test::smallRecording();
    const auto text = summaryJson(recording);
    REQUIRE(text);
    Recording back;
    REQUIRE(parseSummary(*text, "s.json", back));
    CHECK(summaryJson(back).value() == *text);
    CHECK(back.parameters == recording.parameters);
    CHECK(back.energy == recording.energy);
    CHECK(back.cycles.size() == 2);
    REQUIRE(back.summary.size() == recording.summary.size());
    for (std::size_t i = 0; i < back.summary.size(); ++i)
        CHECK(back.summary[i].first == recording.summary[i].first); // order kept
    CHECK(std::get<std::int64_t>(back.summary[1].second) == std::int64_t{1} << 62);
    CHECK(std::get<double>(back.summary[2].second) == 1.0 / 3.0);
    CHECK(std::get<double>(back.summary[3].second) == 5.0); // still a double
    CHECK(text->find("\"missing\": null") != std::string::npos);
    CHECK(text->find("\"endless\": null") != std::string::npos);
}

TEST_CASE("an empty recording makes valid files") {
    const Recording empty;
    CHECK(summaryJson(empty).value() == "{}\n");
    CHECK(parseTrajectory(trajectoryJson(empty), "t").error().empty());
    Recording back;
    CHECK(parseSummary("{}", "s", back));
}

TEST_CASE("a key that appears twice is refused") {
    Recording r;
    r.summary = {{"mu", 1.0}, {"mu", 2.0}};
    CHECK_THAT(summaryJson(r).error(), Catch::Contains("'mu' appears twice"));
    r.summary = {{"energy", 1.0}};
    CHECK_FALSE(summaryJson(r));
}

TEST_CASE("damaged trajectories are refused with their place") {
    const std::string text = trajectoryJson(test::smallRecording());
    CHECK(parseTrajectory("{\n \"schema\": }", "t.json").error() == "t.json:2:12: not valid JSON");
    CHECK_THAT(parseTrajectory("[]", "t.json").error(), Catch::Contains("expected an object, got array"));
    CHECK_THAT(parseTrajectory("{\"schema\":\"other\"}", "t.json").error(), Catch::Contains("/schema"));
    CHECK_FALSE(parseTrajectory(text.substr(0, text.size() / 2), "t.json"));
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string copy = text;
        copy.replace(copy.find(from), from.size(), to);
        return parseTrajectory(copy, "t.json").error();
    };
    CHECK_THAT(changed("\"phase\":1", "\"phase\":9"), Catch::Contains("/frames/1/phase"));
    CHECK_THAT(changed("\"closed\":false", "\"closed\":3"),
               Catch::Contains("/shells/0/closed: expected true or false"));
    CHECK_THAT(changed("\"R_m\"", "\"S_m\""), Catch::Contains("no 'R_m'"));
}

TEST_CASE("a directory of files is read back as one recording") {
    const test::Folder own;
    const std::string& folder = own.path;
    const Recording recording = test::smallRecording();
    REQUIRE(writeFiles(recording, folder));
    const auto back = readFiles(folder);
    REQUIRE(back.error().empty());
    REQUIRE(writeFiles(*back, folder + "/again"));
    for (const char* name : {"summary.json", "series.csv", "trajectory.json"})
        CHECK(readText(folder + "/" + name).value() == readText(folder + "/again/" + name).value());
    std::filesystem::remove(folder + "/trajectory.json");
    CHECK_THAT(readFiles(folder).error(), Catch::Contains("trajectory.json"));
}
