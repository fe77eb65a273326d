// Exports of R.U.B.E. and b2dJson: what absent keys mean, every kind of joint, project files.

#include "tests/plugin/scene/loader/support.h"

using namespace scenetest;
using step::BodyType;
using step::JointKind;

namespace {

const std::string square = R"("polygon": {"vertices": {"x": [-1, 1, 1, -1], "y": [-1, -1, 1, 1]}})";

/// An export with a static and three dynamic bodies and these joints.
std::string withJoints(const std::string& joints) {
    return R"({"gravity": {"x": 0, "y": -10}, "duration": 1, "body": [
        {"name": "beam", "type": 0, "position": {"x": 0, "y": 5}, "awake": true},
        {"name": "lamp", "type": 2, "position": {"x": 1, "y": 4}, "awake": true},
        {"name": "left", "type": 2, "awake": true}, {"name": "right", "type": 2, "awake": true}],
        "joint": [)" +
           joints + "]}";
}

std::vector<Problem> notesOf(const std::string& text) {
    std::vector<Problem> problems;
    REQUIRE(loadText(text, "text.json", {}, problems));
    return problems;
}

} // namespace

TEST_CASE("what an export leaves out is zero") {
    const Scene s = loadedText(R"({"duration": 1, "body": [
        {"type": 2, "fixture": [{)" +
                               square + R"(}]}, {"type": 2, "awake": true}],
        "joint": [{"type": "distance", "bodyA": 0, "bodyB": 1}]})");
    const auto& body = s.rigid.bodies[0];
    CHECK(s.rigid.gravity == rod::Vec2(0, 0));
    CHECK_FALSE(body.awake);
    CHECK(s.rigid.bodies[1].awake);
    CHECK(body.allowSleep); // written only if false
    CHECK(body.active);
    CHECK(body.gravityScale == 1.0);
    CHECK_FALSE(body.massData);
    const auto& f = body.fixtures[0];
    CHECK(f.density == 0.0);
    CHECK(f.friction == 0.0);
    CHECK(f.restitution == 0.0);
    CHECK_FALSE(f.sensor);
    CHECK(f.filterCategoryBits == 1);
    CHECK(f.filterMaskBits == 65535);
    CHECK(s.rigid.joints[0].length == 0.0);
}

TEST_CASE("what a scene with a schema leaves out keeps its defaults") {
    const Scene s = loadedText(R"({"schema": "supercircle-scene/1", "duration": 1, "body": [
        {"type": 2, "fixture": [{)" +
                               square + R"(}]}, {}], "joint": [{"type": "distance", "bodyA": 0, "bodyB": 1}]})");
    CHECK(s.rigid.gravity == step::RigidWorldDefinition{}.gravity);
    CHECK(s.rigid.bodies[0].awake);
    CHECK(s.rigid.bodies[0].fixtures[0].density == 1.0);
    CHECK(s.rigid.bodies[0].fixtures[0].friction == 0.2);
    CHECK(s.rigid.joints[0].length == 1.0);
    // Shells alone are no export.
    CHECK(loadedText(R"({"shell": [{}], "duration": 1})").rigid.gravity == step::RigidWorldDefinition{}.gravity);
}

TEST_CASE("an export with shells stays an export, and a note says so") {
    const std::string text =
        R"({"gravity": 0, "duration": 1, "shell": [{}], "body": [{"fixture": [{)" + square + "}]}]}";
    CHECK(loadedText(text).rigid.bodies[0].fixtures[0].friction == 0.0);
    const auto notes = notesOf(text);
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].pointer == "/body");
    CHECK(contains(notes[0].what, "supercircle-scene/1"));
    CHECK(notesOf(R"({"duration": 1, "body": [{}]})").empty()); // a plain export needs none
}

TEST_CASE("an export's world that forbids sleep forbids it to every body") {
    const Scene s = loadedText(R"({"allowSleep": false, "duration": 1, "body": [{"type": 2}, {"type": 2}]})");
    CHECK_FALSE(s.rigid.bodies[0].allowSleep);
    CHECK_FALSE(s.rigid.bodies[1].allowSleep);
    CHECK(notesOf(R"({"allowSleep": true, "duration": 1, "body": [{}]})").empty());
}

TEST_CASE("images, custom properties and paths of an export pass in silence") {
    CHECK(notesOf(R"({"duration": 1, "image": [{"file": "a.png"}], "customProperties": [], "collisionbitplanes": {},
        "body": [{"path": "a/b", "fixture": [{"path": "c", "circle": {"radius": 1}, "customProperties": []}]}, {}],
        "joint": [{"type": "weld", "bodyA": 0, "bodyB": 1, "path": "d"}]})")
              .empty());
}

TEST_CASE("a rope is a distance joint with a largest length") {
    const Scene s = loadedText(withJoints(R"({"name": "rope", "type": "rope", "bodyA": 0, "bodyB": 1, "anchorA": 0,
        "anchorB": {"x": 0.5, "y": 0}, "maxLength": "40400000"})"));
    const auto& j = s.rigid.joints[0];
    CHECK(j.kind == JointKind::Distance);
    CHECK(j.enableLimit);
    CHECK(j.lowerLimit == 0.0);
    CHECK(j.upperLimit == 3.0);
    CHECK(j.frequency == 0.0);
    CHECK(j.anchorB == rod::Vec2(0.5, 0));
    CHECK(contains(refused(withJoints(R"({"type": "rope", "bodyA": 0, "bodyB": 1})"))[0].what, "\"maxLength\""));
}

TEST_CASE("a motor joint reads either name of its offset, and its correction factor") {
    const Scene s = loadedText(withJoints(R"(
        {"type": "motor", "bodyA": 0, "bodyB": 1, "anchorA": {"x": 1, "y": 2}, "correctionFactor": 0.8, "maxForce": 7},
        {"type": "motor", "bodyA": 0, "bodyB": 1, "linearOffset": {"x": 3, "y": 4}, "anchorA": 0, "refAngle": 0.5},
        {"type": "motor", "bodyA": 0, "bodyB": 1, "linearOffset": 0, "anchorA": {"x": 1, "y": 2}})"));
    CHECK(s.rigid.joints[0].anchorA == rod::Vec2(1, 2));
    CHECK(s.rigid.joints[0].correctionFactor == 0.8);
    CHECK(s.rigid.joints[0].maxMotorForce == 7.0);
    CHECK(s.rigid.joints[1].anchorA == rod::Vec2(3, 4));
    CHECK(s.rigid.joints[1].refAngle == 0.5);
    CHECK(s.rigid.joints[1].correctionFactor == 0.3); // Box2D's
    CHECK(s.rigid.joints[2].anchorA == rod::Vec2(0, 0));
    CHECK(refused(withJoints(R"({"type": "motor", "bodyA": 0, "bodyB": 1, "correctionFactor": 2})"))[0].pointer ==
          "/joint/0/correctionFactor");
}

TEST_CASE("pulley, gear and mouse joints load") {
    const Scene s = loadedText(withJoints(R"(
        {"type": "gear", "bodyA": 2, "bodyB": 3, "joint1": 1, "joint2": 2, "ratio": -2},
        {"type": "revolute", "bodyA": 0, "bodyB": 2}, {"type": "prismatic", "bodyA": 0, "bodyB": 3},
        {"type": "pulley", "bodyA": 1, "bodyB": 2, "groundAnchorA": {"x": -1, "y": 9}, "groundAnchorB": 0,
         "lengthA": 2, "lengthB": 3, "ratio": 1},
        {"type": "mouse", "bodyA": 0, "bodyB": 1, "target": {"x": 2, "y": 4}, "anchorB": {"x": 1, "y": 4},
         "maxForce": 50, "frequency": 5, "dampingRatio": 0.7})"));
    const auto& gear = s.rigid.joints[0];
    CHECK(gear.kind == JointKind::Gear);
    CHECK(gear.joint1 == 1);
    CHECK(gear.joint2 == 2);
    CHECK(gear.ratio == -2.0);
    const auto& pulley = s.rigid.joints[3];
    CHECK(pulley.kind == JointKind::Pulley);
    CHECK(pulley.groundAnchorA == rod::Vec2(-1, 9));
    CHECK(pulley.lengthA + pulley.ratio * pulley.lengthB == 5.0);
    const auto& mouse = s.rigid.joints[4];
    CHECK(mouse.kind == JointKind::Mouse);
    CHECK(mouse.target == rod::Vec2(2, 4));
    CHECK(mouse.maxMotorForce == 50.0);
}

TEST_CASE("joints on which Box2D would abort are refused with their place") {
    const auto message = [](const std::string& joints) { return refused(withJoints(joints))[0].toString(); };
    const std::string gear = R"({"type": "gear", "bodyA": 2, "bodyB": 3, "joint1": 1, "joint2": 2, "ratio": 1})";
    const std::string hinge = R"({"type": "revolute", "bodyA": 0, "bodyB": 2})";
    CHECK(contains(message(gear + "," + hinge + R"(,{"type": "weld", "bodyA": 0, "bodyB": 3})"), "another type"));
    CHECK(contains(message(gear + "," + hinge + R"(,{"type": "revolute", "bodyA": 3, "bodyB": 0})"), "not dynamic"));
    CHECK(contains(message(gear + "," + hinge + "," + hinge), "to itself"));
    CHECK(contains(message(gear + "," + hinge), "/joint/0/joint2"));
    CHECK(contains(message(R"({"type": "pulley", "bodyA": 1, "bodyB": 2})"), "no ratio"));
    CHECK(contains(message(R"({"type": "mouse", "bodyA": 0, "bodyB": 1, "maxForce": 1})"), "no spring"));
}

TEST_CASE("a R.U.B.E. project is named, not taken apart") {
    const auto errors = refused(R"({"collisionbitplanes": {"names": []}, "customPropertyDefs": [],
        "metaworld": {"gravity": 0, "metabody": [{"angle": 0}]}})");
    REQUIRE(errors.size() == 1);
    CHECK(contains(errors[0].what, "R.U.B.E. project"));
    CHECK(contains(errors[0].expected, "export it as JSON"));
}
