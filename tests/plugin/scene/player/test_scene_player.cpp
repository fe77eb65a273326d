// Scenes in the caller's loop: the same numbers as in the laboratory, and the host's own bodies stay.

#include "bridge/box2d/box2d_port.h"
#include "plugin/api/include/supercircle/scene.hpp"
#include "supercircle/step/world.h"
#include "tests/support/fake_host.h"

#include <algorithm>
#include <box2d/box2d.h>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;
using Catch::Contains;

namespace {

const std::string kScenes = std::string(SC_SOURCE_DIR) + "/scenes/";

struct PlayedWorld {
    b2World world{b2Vec2(0.0F, -1.0F)};
    Shells shells{bridge::attach(world, {52.1})};
    double largestForce = 0.0, largestTravel = 0.0; ///< N, m

    void play(ScenePlayer scene, int frames) {
        for (int i = 0; i < frames && !scene.finished(); ++i) {
            const FrameReport r = scene.pre_step(1.0 / 60.0);
            REQUIRE(r.failure.empty());
            if (r.advanced > 0.0)
                world.Step(static_cast<float>(r.advanced), 8, 3);
            REQUIRE(scene.post_step());
            largestForce = std::max(largestForce, scene.force());
            largestTravel = std::max(largestTravel, scene.travel());
        }
    }
};

} // namespace

TEST_CASE("a scene with a protocol plays to the end of its segments", "[player]") {
    PlayedWorld s;
    const auto scene = load_scene(kScenes + "shell_on_cylinder.json", s.shells, {{{"speed", 0.02}, {"mu", 0.2}}, 1});
    REQUIRE(scene);
    CHECK(s.world.GetGravity() == b2Vec2(0.0F, 0.0F)); // the scene's
    CHECK(s.world.GetBodyCount() == 1);
    CHECK(scene->shells().size() == 1);
    CHECK(scene->name() == "shell_on_cylinder");
    CHECK(scene->phase() == "load 1");
    s.play(*scene, 400);
    CHECK(scene->finished());
    CHECK(scene->phase() == "done");
    CHECK(std::abs(scene->travel()) < 1e-9); // there and back, frames cut where the segments end
    // Solved reference T2 at Phi_bar 0.75, mu 0.2: 0.0825 B/R^2, 1 % for thickness and 15 arcs, sampled once a frame.
    const double B = bending_modulus(ShellDef{}), R = ShellDef{}.radius;
    CHECK(s.largestForce * R * R / B == Approx(0.0825).epsilon(0.015));
}

TEST_CASE("shells of a scene are dropped in turn, then the protocol starts", "[player]") {
    PlayedWorld s;
    const auto scene =
        load_scene(kScenes + "stack30.json", s.shells, {{{"shells", 3}, {"max_force", 0.2}, {"plate_speed", 0.05}}, 5});
    REQUIRE(scene);
    CHECK(s.shells.size() == 0);
    s.play(*scene, 20);
    CHECK(s.shells.size() == 1);
    CHECK(scene->phase() == "drop 1");
    s.play(*scene, 2000);
    CHECK(scene->finished());
    CHECK(scene->shells().size() == 3);
    CHECK(s.largestForce >= 0.2); // the force that turns the plate back
    CHECK(s.largestForce < 0.5);
    CHECK(s.largestTravel > 0.0);
    CHECK(s.largestTravel < 6.0 * 0.0192); // travel counts from the first contact
    CHECK(std::abs(scene->travel()) < 1e-9);
    CHECK(s.shells.world().counters.crossings == 0);
}

TEST_CASE("a scene that cannot be loaded leaves nothing behind", "[player]") {
    PlayedWorld s;
    const auto missing = load_scene(kScenes + "no_such.json", s.shells);
    CHECK_FALSE(missing);
    CHECK_THAT(missing.error(), Contains("no_such.json"));
    const auto unknown = load_scene(kScenes + "ramp.json", s.shells, {{{"mue", 0.1}}, 1});
    CHECK_FALSE(unknown);
    CHECK_THAT(unknown.error(), Contains("mue") && Contains("did you mean \"mu\"?"));
    CHECK(s.world.GetBodyCount() == 0);

    Shells alone(nullptr);
    const auto nowhere = load_scene(kScenes + "ramp.json", alone);
    CHECK_FALSE(nowhere);
    CHECK_THAT(nowhere.error(), Contains("no host world"));
    CHECK(alone.size() == 0);

    Shells unable(std::make_shared<test::FakeHost>());
    const auto refused = load_scene(kScenes + "ramp.json", unable);
    CHECK_FALSE(refused);
    CHECK_THAT(refused.error(), Contains("cannot be given bodies"));
    CHECK(unable.size() == 0);
}

TEST_CASE("a scene is added to the bodies of the world", "[player]") {
    PlayedWorld s;
    b2BodyDef mine;
    mine.type = b2_dynamicBody;
    mine.position.Set(0.0F, 1000.0F);
    b2Body* body = s.world.CreateBody(&mine);
    b2CircleShape ball;
    ball.m_radius = 1.0F;
    body->CreateFixture(&ball, 1.0F);
    const auto scene = load_scene(kScenes + "ramp.json", s.shells, {{{"time", 0.1}}, 1});
    REQUIRE(scene);
    CHECK(s.world.GetBodyCount() == 2);
    s.play(*scene, 30);
    CHECK(scene->finished());
    CHECK(s.shells.time() == Approx(0.1).epsilon(1e-9));
    CHECK(body->GetPosition().y < 1000.0F); // it fell meanwhile
}
