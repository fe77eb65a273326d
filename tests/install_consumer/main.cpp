// A program on the installed package: a shell falls into a Box2D world and comes to rest on the ground, and an
// installed scene plays. Exit code 0: success.

#include <box2d/box2d.h>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <supercircle/box2d.hpp>
#include <supercircle/box2d_draw.hpp>
#include <supercircle/scene.hpp>
#include <supercircle/shells.hpp>

namespace {

int failures = 0;

void expect(bool holds, const char* what) {
    if (!holds) {
        std::printf("FAILED: %s\n", what);
        ++failures;
    }
}

void fall() {
    b2World world(b2Vec2(0.0f, -9.81f));
    b2BodyDef groundDef;
    b2PolygonShape box;
    box.SetAsBox(20.0f, 1.0f, b2Vec2(0.0f, -1.0f), 0.0f);
    b2Body* ground = world.CreateBody(&groundDef);
    ground->CreateFixture(&box, 0.0f);
    const auto attached = supercircle::bridge::attach(world);
    attached.set_name(*ground, "ground");
    supercircle::Shells shells(attached);
    shells.set_quality(supercircle::Quality::Game).or_fail();
    auto def = supercircle::scaled_shell(1.0, 2.0);
    def.position = {0.0, 2.0}; // a bowl
    const auto shell = shells.create(def);
    expect(static_cast<bool>(shell), "the shell is made");
    for (int i = 0; i < 240; ++i) {
        const auto report = shells.pre_step(1.0 / 60.0);
        expect(report.failure.empty(), "the step succeeds");
        world.Step(static_cast<float>(report.advanced), 8, 3);
        shells.post_step().or_fail();
    }
    // A bowl lies on its middle: both tips one chord height above the ground, R (1 - cos(phi)) = 1.707 m when
    // undeformed; its own weight opens it a little.
    const auto pose = shells.pose(*shell);
    expect(pose && pose->start.y > 1.4 && pose->start.y < 1.8, "the shell rests on the ground");
    expect(!shells.create(supercircle::scaled_shell(-1.0, 1.0)), "a bad definition fails");
    expect(attached.error_count() == 0, "no bad numbers reached the world");
}

void play() {
    b2World world(b2Vec2(0.0f, 0.0f));
    supercircle::Shells shells(supercircle::bridge::attach(world, {52.1}));
    expect(!supercircle::load_scene("no such file.json", shells), "a missing scene fails");
    const auto loaded = supercircle::load_scene(SCENE, shells, {{{"time", 0.2}}, 1});
    if (!loaded)
        std::printf("%s\n", loaded.error().c_str());
    expect(static_cast<bool>(loaded), "the installed scene loads");
    if (!loaded)
        return;
    int frames = 0;
    for (auto scene = *loaded; !scene.finished() && frames < 100; ++frames) {
        const auto report = scene.pre_step(1.0 / 60.0);
        if (report.advanced > 0.0)
            world.Step(static_cast<float>(report.advanced), 8, 3);
        scene.post_step().or_fail();
    }
    expect(std::abs(shells.time() - 0.2) < 0.02 && world.GetBodyCount() > 0, "the scene plays to its end");
}

} // namespace

int main() {
    fall();
    play();
    std::printf(failures == 0 ? "all checks pass\n" : "%d failures\n", failures);
    return failures == 0 ? 0 : 1;
}
