// Springs and dry friction of joints, and observations.

#include "tests/plugin/scene/loader/support.h"
#include "tests/support/text.h"

#include <filesystem>

using namespace scenetest;
using step::JointDefinition;

namespace {

std::string sceneWith(const std::string& joint, const std::string& more = "") {
    return R"({"schema": "supercircle-scene/1", "duration": 1, "body": [{"name": "a"}, {"name": "b", "type": 2}], "joint": [{)" +
           joint + R"(, "bodyA": 0, "bodyB": 1}])" + more + "}";
}

std::string errorOf(const std::string& text) {
    const auto errors = refused(text);
    INFO(say(errors));
    REQUIRE(errors.size() == 1);
    return errors.front().toString();
}

} // namespace

TEST_CASE("springs and friction of joints load with their units") {
    const JointDefinition slide =
        loadedText(sceneWith(R"("type": "prismatic", "spring": {"stiffness_N_m": 40, "cubic_1_m2": -3,
                                "viscosity_N_s_m": 0.5, "rest_m": 0.1},
                                "friction": {"coefficient": 0.2, "normal_force_N": 10})"))
            .rigid.joints[0];
    CHECK(slide.spring.stiffness == 40.0);
    CHECK(slide.spring.cubic == -3.0);
    CHECK(slide.spring.viscosity == 0.5);
    CHECK(slide.spring.rest == 0.1);
    CHECK(slide.friction.sliding == 2.0);
    CHECK(slide.friction.sticking == 2.0);
    const JointDefinition hinge =
        loadedText(sceneWith(R"("type": "revolute", "spring": {"stiffness_N_m_rad": 4, "rest_rad": 1},
                                "friction": {"torque_N_m": 0.2, "static_torque_N_m": 0.3})"))
            .rigid.joints[0];
    CHECK(hinge.spring.stiffness == 4.0);
    CHECK(hinge.spring.rest == 1.0);
    CHECK(hinge.friction.sliding == 0.2);
    CHECK(hinge.friction.sticking == 0.3);
    CHECK(isMechanism(loadedText(sceneWith(R"("type": "distance", "spring": {"stiffness_N_m": 4})"))));
    CHECK_FALSE(isMechanism(loadedText(sceneWith(R"("type": "revolute")"))));
}

TEST_CASE("misplaced springs and friction are refused with the place") {
    CHECK_THAT(errorOf(sceneWith(R"("type": "weld", "spring": {"stiffness_N_m": 4})")),
               Catch::Contains("/joint/0/spring") && Catch::Contains("takes none"));
    CHECK_THAT(errorOf(sceneWith(R"("type": "distance", "friction": {"coefficient": 0.1, "normal_force_N": 1})")),
               Catch::Contains("/joint/0/friction"));
    CHECK_THAT(errorOf(sceneWith(R"("type": "revolute", "spring": {"stiffness_N_m": 4})")),
               Catch::Contains("stiffness_N_m_rad"));
    CHECK_THAT(errorOf(sceneWith(R"("type": "revolute", "friction": {"torque_N_m": 2, "static_torque_N_m": 1})")),
               Catch::Contains("below that of sliding"));
}

TEST_CASE("observations name what exists") {
    const auto with = [](const std::string& o) {
        return sceneWith(R"("type": "revolute")", R"(, "observe": [)" + o + "]");
    };
    const Observation o =
        loadedText(
            with(R"({"name": "tip", "of": "body", "body": "b", "local_point_m": {"x": 0, "y": 1}, "quantity": "vx"})"))
            .observe.at(0);
    CHECK(o.target == "b");
    CHECK(o.local.y == 1.0);
    CHECK(o.quantity == Observation::Quantity::Vx);
    CHECK_THAT(errorOf(with(R"({"name": "tip", "of": "body", "body": "c", "quantity": "x"})")),
               Catch::Contains("no body named \"c\""));
    CHECK_THAT(errorOf(with(R"({"name": "f", "of": "machine", "quantity": "force"})")),
               Catch::Contains("has no machine"));
    CHECK_THAT(errorOf(with(R"({"name": "f", "of": "body", "body": "b", "quantity": "force"})")),
               Catch::Contains("only a machine"));
}

TEST_CASE("an unknown kind is the only error: the keys that depend on it are not judged") {
    const auto with = [](const std::string& o) {
        return sceneWith(R"("type": "revolute")", R"(, "observe": [)" + o + "]");
    };
    CHECK_THAT(errorOf(with(R"({"name": "f", "of": "hold", "hold": "left", "quantity": "force"})")),
               Catch::Contains("/observe/0/of: unknown value \"hold\""));
    CHECK_THAT(errorOf(with(R"({"name": "f", "quantity": "force"})")), Catch::Contains("\"of\" is missing"));
    CHECK_THAT(errorOf(sceneWith(R"("type": "slider", "friction": {"coefficient": 0.1, "normal_force_N": 1})")),
               Catch::Contains("/joint/0/type: unknown value \"slider\""));
    CHECK_THAT(errorOf(R"({"schema": "supercircle-scene/1", "game": {"kind": "chess"}})"),
               Catch::Contains("/game/kind: unknown value \"chess\""));
}

TEST_CASE("the scenes for experiments load, and observe something") {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(std::string(SC_SOURCE_DIR) + "/scenes/experiments")) {
        std::vector<Problem> problems;
        const auto scene = load(entry.path().string(), {}, problems);
        INFO(say(problems));
        REQUIRE(scene);
        CHECK(problems.empty());
        CHECK_FALSE(scene->observe.empty());
        ++count;
    }
    CHECK(count == 10);
}

TEST_CASE("loads are read, and are released from a state of rest only", "[scene]") {
    std::vector<scene::Problem> problems;
    const auto loaded = [&](const std::string& rest) {
        problems.clear();
        return scene::loadText(R"({"schema": "supercircle-scene/1", "duration": 1, "shell": [{"name": "s"}], )" + rest +
                                   "}",
                               "s.json", {}, problems);
    };
    const auto good = loaded(R"("start": "at_rest", "load": [{"shell": "s", "arc_fraction": 1,
        "force_N": {"x": 1, "y": -2}, "moment_N_m": 3, "released": true}])");
    REQUIRE(good);
    REQUIRE(good->loads.size() == 1);
    CHECK(good->starts_at_rest);
    CHECK(good->loads[0].force.y == -2.0);
    CHECK(good->loads[0].moment == 3.0);
    CHECK(good->loads[0].released);
    CHECK_FALSE(loaded(R"("load": [{"shell": "s", "released": true}])"));
    CHECK(problems.front().expected == R"("start": "at_rest")");
    CHECK_FALSE(loaded(R"("load": [{"shell": "S"}])"));
    CHECK(problems.front().nearest == "s");
}
