// In a Box2D world, too, what happens far away changes no bit of what is here.

#include "tests/bridge/box2d/game_world.h"

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

struct IslandLevel : GameWorld {
    IslandLevel(Quality quality, double scale)
        : GameWorld(quality, {.scale = scale, .density = 30.0F, .friction = 0.6F}) {
        floor();
    }
};

/// Two bumpers, a crate on them, another one on the floor beside them.
void addNear(IslandLevel& level, std::vector<ShellHandle>& made, std::vector<b2Body*>& crates) {
    made = {level.bumper({0.0, 0.5}, 0.3), level.bumper({0.3, 1.2}, 2.0)};
    crates = {level.box(0.1F, 2.0F, 0.3F, 0.2F, b2_dynamicBody), level.box(0.9F, 0.25F, 0.2F, 0.2F, b2_dynamicBody)};
}

} // namespace

TEST_CASE("shells and crates far away change no bit of those here", "[box2d][islands]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    IslandLevel alone(quality, scale), crowded(quality, scale);
    std::vector<ShellHandle> here, there, far;
    std::vector<b2Body*> cratesHere, cratesThere;
    addNear(alone, here, cratesHere);
    addNear(crowded, there, cratesThere);
    far = {crowded.bumper({20.0, 0.6}, 1.0), crowded.bumper({20.1, 1.4}, 0.2), crowded.bumper({-15.0, 3.0}, 0.0)};
    b2Body* farCrate = crowded.box(20.0F, 2.5F, 0.3F, 0.2F, b2_dynamicBody);
    for (int i = 0; i < 100; ++i) {
        if (i % 10 == 4)
            crowded.shells.apply_impulse(far[1], 0.5, {0.3 * (i % 3 - 1), 0.5}).or_fail();
        if (i == 50)
            farCrate->ApplyLinearImpulseToCenter({0.0F, 3.0F * static_cast<float>(scale)}, true);
        alone.frame();
        crowded.frame();
        CAPTURE(i, static_cast<int>(quality), scale);
        for (std::size_t k = 0; k < here.size(); ++k) {
            const ShellPose a = alone.shells.pose(here[k]).value(), b = crowded.shells.pose(there[k]).value();
            REQUIRE((a.start.x == b.start.x && a.start.y == b.start.y));
            REQUIRE(a.angle == b.angle);
            REQUIRE(a.curvature == b.curvature);
        }
        for (std::size_t k = 0; k < cratesHere.size(); ++k) {
            REQUIRE(cratesHere[k]->GetPosition() == cratesThere[k]->GetPosition());
            REQUIRE(cratesHere[k]->GetAngle() == cratesThere[k]->GetAngle());
            REQUIRE(cratesHere[k]->GetLinearVelocity() == cratesThere[k]->GetLinearVelocity());
        }
    }
}
