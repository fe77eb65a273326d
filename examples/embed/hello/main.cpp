// Box2D's own "hello world" (a crate falls on the ground) with a shell. Lines marked `// +` are the additions.

#include <box2d/box2d.h>
#include <cstdio>
#include <supercircle/box2d.hpp>  // +
#include <supercircle/shells.hpp> // +

int main() {
    b2World world(b2Vec2(0.0f, -10.0f));

    b2BodyDef groundDef;
    groundDef.position.Set(0.0f, -10.0f);
    b2PolygonShape groundBox;
    groundBox.SetAsBox(50.0f, 10.0f);
    world.CreateBody(&groundDef)->CreateFixture(&groundBox, 0.0f);

    b2BodyDef crateDef;
    crateDef.type = b2_dynamicBody;
    crateDef.position.Set(0.0f, 4.0f);
    b2Body* crate = world.CreateBody(&crateDef);
    b2PolygonShape crateBox;
    crateBox.SetAsBox(0.5f, 0.5f);
    b2FixtureDef crateFixture;
    crateFixture.shape = &crateBox;
    crateFixture.density = 1.0f;
    crateFixture.friction = 0.3f;
    crate->CreateFixture(&crateFixture);

    supercircle::Shells shells(supercircle::bridge::attach(world)); // +
    shells.set_quality(supercircle::Quality::Game).or_fail();       // +
    auto def = supercircle::scaled_shell(1.0, 2.0);                 // + radius 1 m, mass 2 kg
    def.position = {3.0, 4.0};                                      // +
    const auto shell = shells.create(def);                          // +

    const float dt = 1.0f / 60.0f;
    for (int frame = 0; frame < 120; ++frame) {
        const auto report = shells.pre_step(dt);               // +
        world.Step(static_cast<float>(report.advanced), 8, 3); // + was: world.Step(dt, 8, 3)
        shells.post_step().or_fail();                          // +
        if (frame % 10 != 0)
            continue;
        std::printf("t %4.2f  crate %5.2f %5.2f", frame / 60.0, static_cast<double>(crate->GetPosition().x),
                    static_cast<double>(crate->GetPosition().y));
        const auto pose = shells.pose(*shell);                                          // +
        std::printf("  shell %5.2f %5.2f  stored %.3f J", pose->start.x, pose->start.y, // +
                    pose->bending_energy);                                              // +
        std::printf("\n");
    }
    return 0;
}
