// Valid experiments: every field in SI units.

#include "tests/plugin/recording/experiment/support.h"

#include <cmath>

using namespace experimenttest;
using experiment::Carrier;
using experiment::ClampPlace;
using experiment::ObstacleKind;
using experiment::Protocol;

TEST_CASE("a shell on a cylinder is read field by field", "[experiment]") {
    const auto loaded = experiment::load(baseline(101));
    INFO(loaded.error());
    REQUIRE(loaded);
    const experiment::Experiment& e = *loaded;
    CHECK(e.protocol == Protocol::ShellOnRigidCylinder);
    CHECK(e.gravity.y == -9.81);
    REQUIRE(e.specimens.size() == 1);
    const experiment::Specimen& s = e.specimens[0];
    CHECK(s.id == "A");
    CHECK(s.length == 0.09047786842338604);
    CHECK(s.naturalCurvature.value == 1.0 / 0.0192);
    CHECK(s.naturalCurvature.halfWidth == Approx(0.005 / 0.0192).epsilon(1e-12)); // stated relative, held absolute
    CHECK(s.thickness.value == 5e-4);
    CHECK(s.thickness.halfWidth == 1e-5);
    CHECK(s.bendingModulus.lower() == Approx(0.94 * 0.0002291666666666667).epsilon(1e-12));
    CHECK(s.stretchModulus == 11000.0);
    CHECK(s.clamp.where == ClampPlace::Middle);
    CHECK(s.clamp.carriedBy == Carrier::Crosshead);
    CHECK(s.clamp.arcPosition == 0.04523893421169302);
    CHECK(s.clamp.initialPoint.y == 0.0466529);
    CHECK(s.clamp.initialTangentAngle == Approx(M_PI).epsilon(1e-15));
    REQUIRE(e.obstacles.size() == 1);
    CHECK(e.obstacles[0].kind == ObstacleKind::Cylinder);
    CHECK(e.obstacles[0].radius == Approx(0.01895).epsilon(1e-12));
    CHECK(e.friction.value == 0.3);
    CHECK(e.friction.halfWidth == 0.05);
    CHECK(e.initialGapHalfWidth == 5e-5);
    CHECK(e.sensors.forceZeroWindow == 0.5);
    CHECK(e.markers.size() == 6);
    CHECK(e.markers[5].arcFraction == 0.98);
    REQUIRE(e.runs.size() == 1);
    const experiment::Run& run = e.runs[0];
    CHECK(run.driveDisplacement == std::vector<double>{0.0, 0.0, 0.024, 0.0, 0.0});
    CHECK(run.readings.time.size() == 650);
    CHECK(run.readings.displacement[325] == Approx(0.024).epsilon(1e-12)); // 13 s, millimetres in the file
    CHECK(run.markers.time.size() == 130);
    REQUIRE(run.markers.x.size() == 6);
    CHECK(run.markers.x[0][0] == Approx(0.0147468).epsilon(1e-12));
}

TEST_CASE("the other protocols are read", "[experiment]") {
    const auto two = experiment::load(baseline(103));
    REQUIRE(two);
    CHECK(two->protocol == Protocol::TwoShells);
    CHECK(two->specimens[0].clamp.carriedBy == Carrier::Ground);
    CHECK(two->specimens[1].clamp.carriedBy == Carrier::Crosshead);
    CHECK(two->markers[4].specimen == 1);
    const auto strip = experiment::load(baseline(104));
    REQUIRE(strip);
    CHECK(strip->specimens[0].clamp.where == ClampPlace::FirstEnd);
    CHECK(strip->obstacles[0].kind == ObstacleKind::Plane);
    const auto arch = experiment::load(baseline(106));
    REQUIRE(arch);
    CHECK(arch->specimens[0].clamp.where == ClampPlace::None);
    CHECK(arch->obstacles[1].carriedBy == Carrier::Crosshead);
    CHECK(arch->obstacles[1].normal.y == -1.0);
    for (const int number : {102, 105})
        CHECK(experiment::load(baseline(number)));
}

TEST_CASE("the description alone can be read", "[experiment]") {
    std::vector<scene::Problem> problems;
    const auto e = experiment::loadText(contentOf(baseline(101)), "e.json", problems);
    REQUIRE(e);
    CHECK(problems.empty());
    CHECK(e->runs[0].readings.time.empty());
}

TEST_CASE("a run may have its specimen mounted end for end", "[experiment]") {
    const std::string path = std::string(SC_TEST_DATA) + "/recordings/baseline/case_101/experiment.json";
    std::ifstream in(path);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    const std::string key = "\"sampling_hz\"";
    REQUIRE(text.find(key) != text.npos);
    const auto with = [&](const std::string& value) {
        std::string changed = text;
        return changed.insert(changed.find(key), "\"specimen_turned\": " + value + ", ");
    };
    std::vector<scene::Problem> problems;
    CHECK_FALSE(experiment::loadText(text, path, problems)->runs[0].specimenReversed);
    CHECK(experiment::loadText(with("true"), path, problems)->runs[0].specimenReversed);
    CHECK(problems.empty());
    CHECK_FALSE(experiment::loadText(with("1"), path, problems));
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].pointer == "/runs/0/specimen_turned");
}

TEST_CASE("runs have names of their own, whatever their files are called", "[experiment]") {
    experiment::Experiment e;
    const auto named = [&](const std::vector<std::string>& files) {
        e.runs.clear();
        for (const std::string& file : files) {
            e.runs.emplace_back();
            e.runs.back().file = file;
        }
        return experiment::runNames(e, false);
    };
    using Names = std::vector<std::string>;
    CHECK(named({"run_1.csv", "data/run_2.csv"}) == Names{"run_1", "run_2"});
    CHECK(experiment::runNames(e, true) == Names{"run_1.csv", "run_2.csv"});
    CHECK(named({"slow/a.csv", "fast/a.csv", "b.csv"}) == Names{"slow_a", "fast_a", "b"}); // results lie in one folder
    CHECK(experiment::runNames(e, true) == Names{"slow/a.csv", "fast/a.csv", "b.csv"});
    CHECK(named({"a.csv", "a.csv", "a.csv"}) == Names{"a", "a_2", "a_3"}); // a recording used three times
    CHECK(named({"a.csv", "a.csv", "a_2.csv"}) == Names{"a", "a_2", "a_2_2"});
}
