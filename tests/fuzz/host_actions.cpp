#include "tests/fuzz/host_actions.h"

namespace supercircle::fuzz {

namespace {

constexpr int kMostBodies = 12;

} // namespace

b2Body* addBody(b2World& world, ByteSource& bytes, b2BodyType type, const b2Vec2& at, float halfWidth,
                float halfHeight) {
    b2BodyDef def;
    def.type = type;
    def.position = at;
    b2Body* body = world.CreateBody(&def);
    if (body == nullptr) // the world is locked
        return nullptr;
    if (bytes.chance(60)) {
        b2CircleShape disc;
        disc.m_radius = halfWidth;
        body->CreateFixture(&disc, 1.0F);
    } else {
        b2PolygonShape box;
        box.SetAsBox(halfWidth, halfHeight);
        body->CreateFixture(&box, 1.0F);
    }
    return body;
}

b2Body* someBody(b2World& world, ByteSource& bytes) {
    const int n = world.GetBodyCount();
    b2Body* b = world.GetBodyList();
    for (int k = n > 0 ? static_cast<int>(bytes.below(static_cast<std::uint32_t>(n))) : 0; k > 0 && b; --k)
        b = b->GetNext();
    return b;
}

void changeWorld(b2World& world, const bridge::Attachment& attachment, ByteSource& bytes) {
    if (world.IsLocked())
        return;
    b2Body* b = someBody(world, bytes);
    const auto f = [&](double reach) { return static_cast<float>(reach * (bytes.below(2001) / 1000.0 - 1.0)); };
    switch (bytes.below(11)) {
    case 0:
    case 1:
        if (world.GetBodyCount() < kMostBodies) {
            b2Body* made =
                addBody(world, bytes, static_cast<b2BodyType>(bytes.below(3)), {f(4.0), 2.0F + f(2.0)}, 0.2F, 0.3F);
            if (made && bytes.chance(128))
                attachment.set_name(*made, "plate");
        }
        break;
    case 2:
        if (b) {
            if (bytes.chance(128))
                attachment.notify_destroyed(*b);
            world.DestroyBody(b);
        }
        break;
    case 3:
        if (b)
            b->SetTransform({f(6.0), f(6.0)}, f(3.0)); // teleport
        break;
    case 4:
        if (b)
            b->SetLinearVelocity({f(200.0), f(200.0)});
        break;
    case 5:
        if (b)
            b->SetType(static_cast<b2BodyType>(bytes.below(3)));
        break;
    case 6:
        world.SetGravity({f(100.0), f(400.0)});
        break;
    case 7:
        if (b)
            b->SetEnabled(bytes.chance(180));
        break;
    case 8:
        if (b && b->GetFixtureList())
            b->DestroyFixture(b->GetFixtureList());
        break;
    case 9:
        if (b)
            b->SetTransform({f(6.0) * 1e5F, f(6.0) * 1e5F}, 0.0F); // far away
        break;
    default:
        if (b)
            b->SetAwake(bytes.chance(128));
        break;
    }
}

} // namespace supercircle::fuzz
