// The port on a world that belongs to the user.

#include "bridge/box2d/box2d_port.h"

#include <box2d/box2d.h>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace supercircle;
using namespace supercircle::step;

namespace {

b2Body* addBox(b2World& world, b2BodyType type, const b2Vec2& at, float half = 0.5F, float density = 1.0F) {
    b2BodyDef def;
    def.type = type;
    def.position = at;
    b2Body* body = world.CreateBody(&def);
    b2PolygonShape shape;
    shape.SetAsBox(half, half);
    body->CreateFixture(&shape, density);
    return body;
}

/// Calls the port from inside the locked world.
class CallbackCaller : public b2ContactListener {
public:
    CallbackCaller(bridge::Box2dPort& port, b2World& world) : port_(port), world_(world) {}
    void BeginContact(b2Contact*) override {
        ++calls;
        locked = world_.IsLocked();
        port_.applyImpulse(target, Vec2(0.0, 1.0), 0.0);
        port_.drive(plate, Vec2(0.5, 0.5), 0.0, Vec2::Zero(), 0.0);
        BodyState s;
        readable = port_.state(target, s) && s.velocity.y() < 0.0;
        std::vector<BodyOutline> out;
        port_.query({Vec2(-10, -10), Vec2(10, 10)}, out);
        found = out.size();
    }
    BodyId target = 0;
    BodyId plate = 0;
    int calls = 0;
    bool locked = false;
    bool readable = false;
    std::size_t found = 0;

private:
    bridge::Box2dPort& port_;
    b2World& world_;
};

} // namespace

TEST_CASE("attaching requires a finite and positive scale", "[bridge]") {
    b2World world({0.0F, -10.0F});
    CHECK_THROWS_AS(bridge::attach(world, {0.0}), std::invalid_argument);
    CHECK_THROWS_AS(bridge::attach(world, {std::nan("")}), std::invalid_argument);
    CHECK(bridge::attach(world, {2.0})->gravity() == Vec2(0.0, -5.0));
}

TEST_CASE("ids survive changes of other bodies and end with their body", "[bridge]") {
    b2World world({0.0F, 0.0F});
    b2Body* a = addBox(world, b2_dynamicBody, {0, 0});
    b2Body* b = addBox(world, b2_dynamicBody, {3, 0});
    b2Body* c = addBox(world, b2_dynamicBody, {6, 0});
    auto port = bridge::attach(world);
    const BodyId idA = port->idOf(*a);
    const BodyId idB = port->idOf(*b);
    const BodyId idC = port->idOf(*c);
    CHECK(idA == 1);
    CHECK(idB == 2);
    CHECK(idC == 3);
    port->setName(*b, "bee");
    CHECK(port->find("bee") == idB);

    world.DestroyBody(b);
    BodyState s;
    CHECK_FALSE(port->state(idB, s));
    CHECK(port->find("bee") == 0);
    CHECK(port->bodyOf(idB) == nullptr);
    CHECK(port->bodyOf(idC) == c);
    port->applyImpulse(idB, Vec2(1.0, 0.0), 0.0);
    CHECK(port->errorCount() == 1);

    // The block allocator hands b's address to the next body.
    b2Body* d = addBox(world, b2_dynamicBody, {3, 0});
    CHECK(d == b);
    const BodyId idD = port->idOf(*d);
    CHECK(idD > idC);
    CHECK_FALSE(port->state(idB, s));
    CHECK(port->idOf(*a) == idA);
    CHECK(port->idOf(*c) == idC);
}

TEST_CASE("address reuse between two calls is noticed", "[bridge]") {
    b2World world({0.0F, 0.0F});
    std::vector<b2Body*> bodies;
    for (int i = 0; i < 5; ++i)
        bodies.push_back(addBox(world, b2_dynamicBody, {3.0F * static_cast<float>(i), 0.0F}));
    auto port = bridge::attach(world);
    std::vector<BodyId> ids;
    for (const b2Body* b : bodies)
        ids.push_back(port->idOf(*b));
    std::vector<BodyOutline> out;
    SECTION("the youngest body gets an old body's address") {
        world.DestroyBody(bodies[1]);
        b2Body* fresh = addBox(world, b2_dynamicBody, {50, 0});
        REQUIRE(fresh == bodies[1]);
        CHECK(port->idOf(*fresh) == 6);
        CHECK(port->bodyOf(ids[1]) == nullptr);
        CHECK(port->bodyOf(ids[4]) == bodies[4]);
    }
    SECTION("a body with other properties gets the youngest body's address") {
        world.DestroyBody(bodies[4]);
        b2Body* fresh = addBox(world, b2_dynamicBody, {50, 0}, 0.25F);
        REQUIRE(fresh == bodies[4]);
        port->query({Vec2(-100, -100), Vec2(100, 100)}, out);
        CHECK(port->idOf(*fresh) == 6);
        CHECK(port->bodyOf(ids[4]) == nullptr);
    }
    SECTION("a pair of addresses is swapped") {
        world.DestroyBody(bodies[4]);
        world.DestroyBody(bodies[3]);
        b2Body* first = addBox(world, b2_dynamicBody, {50, 0});
        b2Body* second = addBox(world, b2_dynamicBody, {60, 0}, 0.25F);
        REQUIRE(first == bodies[3]);
        REQUIRE(second == bodies[4]);
        port->query({Vec2(-100, -100), Vec2(100, 100)}, out);
        CHECK(port->idOf(*second) > 5);
        CHECK(port->bodyOf(ids[4]) == nullptr);
        CHECK(port->bodyOf(ids[2]) == bodies[2]);
    }
    SECTION("an equal body is distinguished if the destruction was announced") {
        port->notifyDestroyed(*bodies[4]);
        world.DestroyBody(bodies[4]);
        b2Body* fresh = addBox(world, b2_dynamicBody, {50, 0});
        REQUIRE(fresh == bodies[4]);
        CHECK(port->bodyOf(ids[4]) == nullptr);
        CHECK(port->idOf(*fresh) > 5);
    }
    SECTION("an additional fixture or a new mass changes no id") {
        b2CircleShape circle;
        circle.m_radius = 0.2F;
        bodies[4]->CreateFixture(&circle, 1.0F);
        bodies[2]->SetType(b2_staticBody);
        port->query({Vec2(-100, -100), Vec2(100, 100)}, out);
        for (std::size_t i = 0; i < bodies.size(); ++i)
            CHECK(port->idOf(*bodies[i]) == ids[i]);
        CHECK(out.size() == 6);
    }
}

TEST_CASE("two-sided and one-sided single edges keep their sides", "[bridge]") {
    b2World world({0.0F, 0.0F});
    b2BodyDef def;
    def.position = {10.0F, 0.0F};
    b2Body* ground = world.CreateBody(&def);
    b2EdgeShape two;
    two.SetTwoSided({0, 0}, {1, 0});
    ground->CreateFixture(&two, 0.0F);
    b2EdgeShape one;
    one.SetOneSided({-1, 1}, {0, 1}, {1, 1}, {2, 2});
    ground->CreateFixture(&one, 0.0F);
    auto port = bridge::attach(world, {10.0});
    std::vector<BodyOutline> out;
    port->everything(out);
    REQUIRE(out.size() == 2);
    CHECK(out[0].local.kind == contact::OutlineKind::Segment);
    CHECK(out[0].local.points[1] == Vec2(0.1, 0.0));
    CHECK(out[1].local.kind == contact::OutlineKind::OneSided);
    CHECK(out[1].local.key == 1);
    CHECK(out[1].local.joinedStart);
    CHECK(out[1].local.joinedEnd);
    CHECK(out[1].local.points[0] == Vec2(0.1, 0.1)); // reversed: solid on the right
    CHECK(out[1].local.neighbourStart == Vec2(0.2, 0.2));
    CHECK(out[1].local.neighbourEnd == Vec2(-0.1, 0.1));
}

TEST_CASE("a query returns what is near, not what Box2D's enlarged boxes touch", "[bridge]") {
    b2World world({0.0F, 0.0F});
    addBox(world, b2_staticBody, {0, 0});
    b2Body* far = addBox(world, b2_dynamicBody, {5, 0});
    auto port = bridge::attach(world);
    std::vector<BodyOutline> out;
    port->query({Vec2(0.55, -1.0), Vec2(0.58, 1.0)}, out); // the fat box reaches 0.61, the skin 0.51
    CHECK(out.empty());
    port->query({Vec2(0.4, -1.0), Vec2(4.6, 1.0)}, out);
    REQUIRE(out.size() == 2);
    CHECK(out[0].body == 1);
    CHECK(out[1].body == port->idOf(*far));
    out.clear();
    far->SetTransform({20, 0}, 0.0F);
    port->query({Vec2(19, -1.0), Vec2(21, 1.0)}, out);
    CHECK(out.size() == 1);
}

TEST_CASE("invalid numbers never reach Box2D", "[bridge]") {
    b2World world({0.0F, -10.0F});
    b2Body* body = addBox(world, b2_dynamicBody, {0, 0});
    b2Body* plate = addBox(world, b2_kinematicBody, {5, 0});
    auto port = bridge::attach(world, {52.1});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const BodyId id = port->idOf(*body);
    const BodyId idPlate = port->idOf(*plate);
    port->applyImpulse(id, Vec2(nan, 0.0), 0.0);
    port->applyImpulse(id, Vec2(0.0, 0.0), INFINITY);
    port->applyImpulse(id, Vec2(1e300, 0.0), 0.0);
    port->drive(idPlate, Vec2(0.0, nan), 0.0, Vec2::Zero(), 0.0);
    port->drive(idPlate, Vec2(0.0, 0.0), nan, Vec2::Zero(), 0.0);
    port->drive(idPlate, Vec2(0.0, 1e30), 0.0, Vec2::Zero(), 0.0);
    std::vector<BodyOutline> out;
    port->query({Vec2(nan, 0.0), Vec2(1.0, 1.0)}, out);
    CHECK(out.empty());
    CHECK(port->errorCount() == 7);
    BodyState lost;
    lost.centre = Vec2(nan, 0.0);
    port->put(idPlate, lost); // as from a damaged checkpoint
    CHECK(port->lastError().find("put: ") == 0);
    CHECK(plate->GetPosition() == b2Vec2(5.0F, 0.0F));
    port->drive(id, Vec2::Zero(), 0.0, Vec2::Zero(), 0.0);
    CHECK(port->errorCount() == 9);
    CHECK(port->lastError().find("kinematic") != std::string::npos);
    CHECK(body->GetLinearVelocity() == b2Vec2(0.0F, 0.0F));
    world.Step(0.01F, 8, 3);
    CHECK(std::isfinite(body->GetPosition().y));
}

TEST_CASE("inside a callback reading works and writing is deferred", "[bridge]") {
    b2World world({0.0F, -10.0F});
    addBox(world, b2_staticBody, {0, 0});
    b2Body* falling = addBox(world, b2_dynamicBody, {0, 1.3F});
    b2Body* plate = addBox(world, b2_kinematicBody, {8, 0});
    auto port = bridge::attach(world);
    CallbackCaller caller(*port, world);
    caller.target = port->idOf(*falling);
    caller.plate = port->idOf(*plate);
    world.SetContactListener(&caller);
    for (int i = 0; i < 100 && caller.calls == 0; ++i)
        world.Step(0.01F, 8, 3);
    REQUIRE(caller.calls == 1);
    CHECK(caller.locked);
    CHECK(caller.readable);
    CHECK(caller.found == 3);
    CHECK(plate->GetPosition() == b2Vec2(8.0F, 0.0F));
    const float before = falling->GetLinearVelocity().y;
    BodyState s;
    REQUIRE(port->state(caller.target, s)); // the first call after the step does the deferred work
    CHECK(s.velocity.y() == Approx(static_cast<double>(before) + 1.0 / s.mass).epsilon(1e-6));
    CHECK(plate->GetPosition() == b2Vec2(0.5F, 0.5F));
}
