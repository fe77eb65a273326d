// In a Box2D world, too, what happens far away changes no bit of what is here.

#include "bridge/box2d/include/supercircle/box2d.hpp"
#include "plugin/api/include/supercircle/shells.hpp"

#include <box2d/box2d.h>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;

namespace {

struct Level {
    Level(Quality quality, double scale)
        : L(static_cast<float>(scale)), world({0.0F, -9.81F * L}), port(bridge::attach(world, {scale})), shells(port) {
        shells.set_quality(quality).or_fail();
        box(0.0F, -0.5F, 40.0F, 0.5F, b2_staticBody);
    }
    b2Body* box(float x, float y, float halfX, float halfY, b2BodyType type) {
        b2BodyDef d;
        d.type = type;
        d.position.Set(L * x, L * y);
        b2Body* b = world.CreateBody(&d);
        b2PolygonShape s;
        s.SetAsBox(L * halfX, L * halfY);
        b2FixtureDef f;
        f.shape = &s;
        f.density = 30.0F / (L * L);
        f.friction = 0.6F;
        b->CreateFixture(&f);
        return b;
    }
    ShellHandle bumper(double x, double y, double angle) {
        ShellDef d = scaled_shell(0.35, 0.4, 0.5, 60.0);
        d.elements = 10;
        d.angle = angle;
        d.position = {x, y};
        return shells.create(d).value();
    }
    void frame() {
        const FrameReport r = shells.pre_step(1.0 / 60.0);
        REQUIRE(r.failure.empty());
        world.Step(static_cast<float>(r.advanced), 8, 3);
        shells.post_step().or_fail();
    }

    float L;
    b2World world;
    bridge::Attachment port;
    Shells shells;
};

/// Two bumpers, a crate on them, another one on the floor beside them.
void addNear(Level& level, std::vector<ShellHandle>& made, std::vector<b2Body*>& crates) {
    made = {level.bumper(0.0, 0.5, 0.3), level.bumper(0.3, 1.2, 2.0)};
    crates = {level.box(0.1F, 2.0F, 0.3F, 0.2F, b2_dynamicBody), level.box(0.9F, 0.25F, 0.2F, 0.2F, b2_dynamicBody)};
}

} // namespace

TEST_CASE("shells and crates far away change no bit of those here", "[box2d][islands]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    Level alone(quality, scale), crowded(quality, scale);
    std::vector<ShellHandle> here, there, far;
    std::vector<b2Body*> cratesHere, cratesThere;
    addNear(alone, here, cratesHere);
    addNear(crowded, there, cratesThere);
    far = {crowded.bumper(20.0, 0.6, 1.0), crowded.bumper(20.1, 1.4, 0.2), crowded.bumper(-15.0, 3.0, 0.0)};
    b2Body* farCrate = crowded.box(20.0F, 2.5F, 0.3F, 0.2F, b2_dynamicBody);
    for (int i = 0; i < 150; ++i) {
        if (i % 10 == 4)
            crowded.shells.apply_impulse(far[1], 0.5, {0.3 * (i % 3 - 1), 0.5}).or_fail();
        if (i == 70)
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
