// Effects given by a scene and by calls are the same physics.

#include "bridge/box2d/include/supercircle/box2d.hpp"
#include "plugin/api/include/supercircle/scene.hpp"
#include "plugin/api/include/supercircle/shells.hpp"
#include "tests/support/folder.h"

#include <box2d/box2d.h>

using namespace supercircle;

namespace {

std::string scene(const std::string& effects) {
    return R"({"schema": "supercircle-scene/1", "lengthScale": 52.1, "gravity": {"x": 0, "y": -9.81},
        "body": [{"name": "floor", "type": 0, "fixture": [{"friction": 0.4, "restitution": 0.2,
                  "polygon": {"vertices": {"x": [-1, 1, 1, -1], "y": [-0.2, -0.2, 0, 0]}}}]}],
        "shell": [{"name": "a", "position": {"x": 0, "y": 0.03}, "angle": 3.0, "phi_bar": 0.6},
                  {"name": "b", "position": {"x": 0.08, "y": 0.03}, "angle": 3.3, "phi_bar": 0.6}],
        "effects": [)" +
           effects + R"(], "duration": 0.3})";
}

struct Played {
    b2World world{b2Vec2(0.0F, 0.0F)};
    Shells shells{bridge::attach(world, {52.1})};
    void play(ScenePlayer player) {
        while (!player.finished()) {
            const FrameReport r = player.pre_step(1.0 / 60.0);
            REQUIRE(r.failure.empty());
            CHECK(player.pre_step(0.0).failure.empty()); // a pause ends no phase
            world.Step(static_cast<float>(r.advanced), 8, 3);
            player.post_step().or_fail();
        }
    }
};

} // namespace

TEST_CASE("effects by calls give the motion of effects by scene bit for bit", "[player]") {
    const test::Folder folder;
    const std::string with =
        folder.write("with.json", scene(R"({"key": "plasticity", "My_over_B_1_m": 5, "hardening": "kinematic"},
                 {"key": "viscoelastic_bending", "law": "standard_linear_solid", "branch_over_B": 0.3, "tau_s": 0.02},
                 {"key": "planar_drag", "f_N_m": 0.01, "shell": "b"}, {"key": "wear", "change": 0.5})"));
    const std::string without = folder.write("without.json", scene(""));
    Played byScene, byCalls, plain;
    const auto a = load_scene(with, byScene.shells), b = load_scene(without, byCalls.shells),
               c = load_scene(without, plain.shells);
    REQUIRE(a);
    REQUIRE(b);
    REQUIRE(c);
    Shells& s = byCalls.shells;
    REQUIRE(s.set_effects(all_shells, "plasticity", {{"My_over_B_1_m", 5}, {"hardening", "kinematic"}}));
    REQUIRE(s.set_effects(all_shells, "viscoelastic_bending",
                          {{"law", "standard_linear_solid"}, {"branch_over_B", 0.3}, {"tau_s", 0.02}}));
    REQUIRE(s.set_effects(s.find("b"), "planar_drag", {{"f_N_m", 0.01}}));
    REQUIRE(s.set_effects(all_shells, "wear", {{"change", 0.5}}));
    byScene.play(*a);
    byCalls.play(*b);
    plain.play(*c);
    for (const char* name : {"a", "b"}) {
        const auto pose = [&](Played& p) { return *p.shells.pose(p.shells.find(name)); };
        CHECK(pose(byScene).start.x == pose(byCalls).start.x);
        CHECK(pose(byScene).angle == pose(byCalls).angle);
        CHECK(pose(byScene).curvature == pose(byCalls).curvature);
        CHECK(pose(byScene).curvature != pose(plain).curvature);
        CHECK(byScene.shells.effects(byScene.shells.find(name))->size() == (std::string(name) == "a" ? 3U : 4U));
    }
}
