// The meaning of the parts of a scene file.

#include "tests/plugin/scene/loader/support.h"

using namespace scenetest;
using step::BodyType;
using step::JointKind;
using step::ShapeKind;

TEST_CASE("a R.U.B.E. export loads unchanged") {
    std::vector<Problem> problems;
    const auto scene = load(std::string(SC_SOURCE_DIR) + "/tests/plugin/scene/loader/rube_sample.json", {}, problems);
    INFO(say(problems));
    REQUIRE(scene);
    // Seven keys without effect, and no duration.
    CHECK(problems.size() == 8);
    CHECK(scene->name == "rube_sample");
    const auto& world = scene->rigid;
    CHECK(world.gravity == rod::Vec2(0, -10));
    CHECK(world.lengthScale == 1.0);
    REQUIRE(world.bodies.size() == 3);
    const auto& ground = world.bodies[0];
    CHECK(ground.type == BodyType::Static);
    REQUIRE(ground.fixtures.size() == 2);
    CHECK(ground.fixtures[0].shape == ShapeKind::Loop); // a chain that returns to its first vertex
    CHECK(ground.fixtures[0].vertices.size() == 4);
    CHECK(ground.fixtures[1].shape == ShapeKind::Chain);
    CHECK(ground.fixtures[1].twoSided);
    CHECK(ground.fixtures[1].vertices[1] == rod::Vec2(-9, 10));
}

TEST_CASE("b2dJson's hex floats are the bits of a float") {
    const Scene s = loadedText(R"({"body": [{"angle": "3FC90FDB", "position": {"x": "41200000", "y": "BF000000"}}]})");
    CHECK(s.rigid.bodies[0].angle == static_cast<double>(1.57079637f));
    CHECK(s.rigid.bodies[0].position == rod::Vec2(10, -0.5));
}

TEST_CASE("bodies, fixtures and joints of an export keep their values") {
    const Scene s = loaded(std::string(SC_SOURCE_DIR) + "/tests/plugin/scene/loader/rube_sample.json");
    const auto& box = s.rigid.bodies[1];
    CHECK(box.type == BodyType::Dynamic);
    CHECK(box.bullet);
    CHECK(box.position == rod::Vec2(0, 10));
    CHECK(box.linearVelocity == rod::Vec2(1, -2));
    CHECK(box.linearDamping == static_cast<double>(0.1f));
    REQUIRE(box.massData);
    CHECK(box.massData->mass == 1.0);
    const auto& f = box.fixtures.at(0);
    CHECK(f.filterCategoryBits == 2);
    CHECK(f.filterMaskBits == 65533);
    CHECK(f.filterGroupIndex == -1);
    CHECK(f.restitution == static_cast<double>(0.1f));
    CHECK(f.vertices.size() == 4);
    const auto& wheel = s.rigid.bodies[2];
    CHECK(wheel.fixedRotation);
    CHECK(wheel.fixtures.at(0).sensor);
    CHECK(wheel.fixtures.at(0).radius == 0.4);
    REQUIRE(s.rigid.joints.size() == 3);
    const auto& axle = s.rigid.joints[0];
    CHECK(axle.kind == JointKind::Revolute);
    CHECK(axle.bodyA == 1);
    CHECK(axle.bodyB == 2);
    CHECK(axle.maxMotorForce == 10.0);
    CHECK(axle.upperLimit == 0.75);
    CHECK(s.rigid.joints[1].kind == JointKind::Distance);
    CHECK(s.rigid.joints[1].length == 3.0);
    CHECK(s.rigid.joints[1].frequency == 4.0);
    CHECK(s.rigid.joints[2].localAxisA == rod::Vec2(0, 1)); // a direction: made unit
    CHECK(s.rigid.joints[2].maxMotorForce == 7.0);
}

TEST_CASE("polygons come out counter-clockwise") {
    const Scene s =
        loadedText(R"({"body": [{"fixture": [{"polygon": {"vertices": {"x": [0,0,1,1], "y": [0,1,1,0]}}}]}]})");
    const auto& v = s.rigid.bodies[0].fixtures[0].vertices;
    double area = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i)
        area += 0.5 * rod::cross(v[i], v[(i + 1) % v.size()]);
    CHECK(area == 1.0);
}

TEST_CASE("corners that are straight to seven digits are left out of a polygon") {
    for (const char* y : {"0.0000001", "-0.0000001", "0"}) {
        const std::string text =
            std::string(R"({"body": [{"fixture": [{"polygon": {"vertices": {"x": [0,1,2,2,0], "y": [0,)") + y +
            ",0,1,1]}}}]}]}";
        CHECK(loadedText(text).rigid.bodies[0].fixtures[0].vertices.size() == 4);
    }
}

TEST_CASE("small shapes are accepted when lengthScale makes them large enough for Box2D") {
    const std::string square = R"("body": [{"fixture": [{"polygon": {"vertices":
        {"x": [0, 0.001, 0.001, 0], "y": [0, 0, 0.001, 0.001]}}}]}]})";
    loadedText("{\"lengthScale\": 52.1, " + square);
    CHECK(contains(refused("{" + square)[0].expected, "lengthScale"));
}

TEST_CASE("absent values are the definitions' own defaults") {
    const Scene s = loadedText(R"({"shell": [{}], "duration": 1})");
    const ShellDef d;
    CHECK(s.shells[0].radius == d.radius);
    CHECK(s.shells[0].young_modulus == d.young_modulus);
    CHECK(s.shells[0].elements == d.elements);
    CHECK(s.shells[0].tip_refinement == 1.0);
    CHECK(loadedText(R"({"shell": [{"tip_refinement": 3}], "duration": 1})").shells[0].tip_refinement == 3.0);
    CHECK(s.numerics.dt_max == Numerics{}.dt_max);
    CHECK(s.rigid.gravity == step::RigidWorldDefinition{}.gravity);
    CHECK(s.name == "text");
}

TEST_CASE("shells: straight strips, one curvature for all, rings") {
    const Scene s = loadedText(R"({"shell": [
        {"radius": "infinite", "length": 0.1, "position": 0},
        {"radius": "infinite", "length": 0.1, "elements": 4, "natural_curvature": 3, "curvature": [1, 2, 3, 4]},
        {"closed": true, "elements": 30}], "duration": 1})");
    CHECK(std::isinf(s.shells[0].radius));
    CHECK(s.shells[1].natural_curvature == std::vector<double>(4, 3.0));
    CHECK(s.shells[1].curvature == std::vector<double>{1, 2, 3, 4});
    CHECK(s.shells[2].phi_bar == 1.0);
}

TEST_CASE("segments are unrolled and cycles numbered") {
    const Scene s = loadedText(R"({
      "parameters": {"n": {"value": 3, "integer": true}},
      "body": [{"name": "p", "type": 1}],
      "protocol": {"body": "p", "direction": {"x": 3, "y": -4}, "segments": [
        {"settle": 2},
        {"repeat": {"param": "n"}, "cycle": true, "segments": [
          {"speed_m_s": 0.5, "stop_when": {"force": 5, "time": 9}},
          {"repeat": 2, "segments": [{"hold": 1}]},
          {"speed_m_s": -0.5, "stop_when": {"displacement": 0}}]},
        {"speed_m_s": 1, "loading": false, "stop_when": {"time": 1}}]}})");
    const Protocol& p = *s.protocol;
    CHECK(p.direction.x == Approx(0.6).epsilon(1e-15));
    CHECK(p.direction.y == Approx(-0.8).epsilon(1e-15));
    REQUIRE(p.segments.size() == 1 + 3 * 4 + 1);
    CHECK(p.segments[0].kind == ProtocolSegment::Kind::Settle);
    CHECK(p.segments[0].cycle == 0);
    for (int n = 0; n < 3; ++n) {
        const ProtocolSegment* m = &p.segments[static_cast<std::size_t>(1 + 4 * n)];
        CHECK(m[0].cycle == n + 1);
        CHECK(m[3].cycle == n + 1);
        CHECK(m[0].loading);
        CHECK(m[0].stop_when.force == 5.0);
        CHECK(std::isnan(m[0].stop_when.displacement));
        CHECK(m[1].kind == ProtocolSegment::Kind::Hold);
        CHECK(m[2].stop_when.time == 1.0);
        CHECK_FALSE(m[3].loading);
        CHECK(m[3].stop_when.displacement == 0.0);
    }
    CHECK_FALSE(p.segments.back().loading);
    CHECK(p.segments.back().cycle == 0);
}
