// Worlds of the C interface: the bits of the C++ API, threads, and what happens across the border.

#include "bridge/box2d/box2d_port.h"
#include "bridge/c/include/supercircle.h"
#include "bridge/c/include/supercircle_box2d.h"
#include "plugin/api/include/supercircle/scene.hpp"

#include <atomic>
#include <box2d/box2d.h>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace {

constexpr double kUnits = 52.1;

std::string scene(const std::string& name) {
    std::ifstream in(std::string(SC_SOURCE_DIR) + "/scenes/" + name + ".json");
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

const char* const kPlateAndBall = R"({"schema": "supercircle-scene/1", "body": [
    {"name": "plate", "type": 1, "position": {"x": 0, "y": -0.01}, "fixture": [{"polygon": {"vertices":
      {"x": [-0.3, 0.3, 0.3, -0.3], "y": [-0.01, -0.01, 0.01, 0.01]}}}]},
    {"name": "ball", "type": 2, "position": {"x": 0.005, "y": 0.09}, "fixture": [{"density": 3,
      "circle": {"center": {"x": 0, "y": 0}, "radius": 0.01}}]}]})";

sc_world makeWorld(const char* bodies = kPlateAndBall) {
    sc_world_def def;
    sc_world_def_init(&def);
    def.units_per_metre = kUnits;
    sc_world w{};
    REQUIRE(sc_world_create(&def, &w) == SC_OK);
    REQUIRE(sc_world_add(w, bodies, -1) == SC_OK);
    return w;
}

sc_shell makeShell(sc_world w, double x, double y, int elements = 8) {
    sc_shell_def def;
    sc_shell_def_init(&def);
    def.position = {x, y};
    def.elements = elements;
    sc_shell s{};
    REQUIRE(sc_shell_create(w, &def, nullptr, nullptr, 0, &s) == SC_OK);
    return s;
}

} // namespace

TEST_CASE("a scene played through C has the bits of the C++ API", "[c]") {
    const std::string text = scene("two_shells");
    b2World world({0.0F, 0.0F});
    const auto attachment = supercircle::bridge::attach(world, {kUnits});
    supercircle::Shells shells(attachment);
    auto loaded = supercircle::load_scene_text(text, "two_shells", shells);
    REQUIRE(loaded);

    sc_world_def def;
    sc_world_def_init(&def);
    REQUIRE(sc_scene_world_def(text.c_str(), -1, &def) == SC_OK);
    def.units_per_metre = kUnits;
    sc_world w{};
    sc_scene played{};
    REQUIRE(sc_world_create(&def, &w) == SC_OK);
    REQUIRE(sc_scene_load(w, text.c_str(), -1, nullptr, nullptr, 1, &played) == SC_OK);
    for (int i = 0; i < 30; ++i) {
        const auto frame = loaded->pre_step(1.0 / 60.0);
        REQUIRE(frame.failure.empty());
        world.Step(static_cast<float>(frame.advanced), 8, 3);
        attachment->stepped(frame.advanced);
        loaded->post_step().or_fail();
        sc_frame mine{};
        REQUIRE(sc_scene_step(played, 1.0 / 60.0, &mine) == SC_OK);
        REQUIRE(mine.energy_gained == 0.0);
        REQUIRE(sc_world_hash(w) == shells.hash());
    }
    CHECK(sc_scene_travel(played) == loaded->travel());
    CHECK(sc_scene_force(played) == loaded->force());
    CHECK(sc_world_destroy(w) == SC_OK);
    CHECK(sc_scene_step(played, 0.1, nullptr) == SC_STALE);
}

TEST_CASE("a hundred worlds step on two threads, each as it would alone", "[c]") {
    const auto run = [](std::uint64_t& hash) { // Catch's macros are for one thread
        sc_world_def def;
        sc_world_def_init(&def);
        def.quality = SC_QUALITY_GAME;
        def.units_per_metre = kUnits;
        sc_shell_def shell;
        sc_shell_def_init(&shell);
        shell.position.y = 0.04;
        shell.elements = 8;
        sc_world w{};
        sc_shell s{};
        bool done = sc_world_create(&def, &w) == SC_OK && sc_world_add(w, kPlateAndBall, -1) == SC_OK &&
                    sc_shell_create(w, &shell, nullptr, nullptr, 0, &s) == SC_OK;
        for (int i = 0; i < 10; ++i)
            done = done && sc_world_step(w, 1.0 / 60.0, nullptr) == SC_OK;
        hash = done ? sc_world_hash(w) : 0;
        sc_world_destroy(w);
    };
    std::uint64_t alone = 0;
    run(alone);
    REQUIRE(alone != 0);
    std::vector<std::uint64_t> hashes(100);
    const auto half = [&](std::size_t first) {
        for (std::size_t i = first; i < hashes.size(); i += 2)
            run(hashes[i]);
    };
    std::thread other(half, 1);
    half(0);
    other.join();
    for (const std::uint64_t h : hashes)
        REQUIRE(h == alone);
}

TEST_CASE("the status of a call that returns a number or a text is told", "[c]") {
    CHECK(std::isnan(sc_world_time({12345})));
    CHECK(sc_error_status() == SC_STALE);
    CHECK(sc_error_status() == SC_STALE); // asking changes nothing
    CHECK(sc_picture_svg(makeWorld(), nullptr) == nullptr);
    CHECK(sc_error_status() == SC_BAD_INPUT);
    CHECK(sc_effects() != nullptr);
    CHECK(sc_error_status() == SC_OK);
}

TEST_CASE("a second thread in a world is told that it is busy", "[c]") {
    const sc_world w = makeWorld();
    makeShell(w, 0.0, 0.05);
    std::atomic<bool> over{false}, failed{false};
    std::thread stepping([&] {
        while (!over) {
            const sc_status s = sc_world_step(w, 1e-3, nullptr);
            failed = failed || (s != SC_OK && s != SC_BUSY);
        }
    });
    sc_point gravity{};
    while (sc_world_gravity(w, &gravity) != SC_BUSY) // the other one is inside nearly always
        std::this_thread::yield();
    CHECK(std::string(sc_error()).find("another thread") != std::string::npos);
    over = true;
    stepping.join();
    CHECK_FALSE(failed);
    CHECK(sc_world_destroy(w) == SC_OK);
}

TEST_CASE("handles of another kind, of another world and of what was destroyed are stale", "[c]") {
    const sc_world a = makeWorld(), b = makeWorld();
    const sc_shell s = makeShell(a, 0.0, 0.05);
    sc_hold hold{};
    REQUIRE(sc_hold_create(a, s, 0.5, SC_HOLD_CLAMP, SC_BASE_FIXED, &hold) == SC_OK);
    sc_shell_state state{};
    CHECK(sc_shell_state_of(b, s, &state) == SC_STALE);
    CHECK(sc_shell_state_of(a, {hold.id}, &state) == SC_STALE);
    CHECK(sc_shell_state_of(a, {0}, &state) == SC_STALE);
    CHECK(sc_shell_state_of({s.id}, s, &state) == SC_STALE);
    REQUIRE(sc_shell_destroy(a, s) == SC_OK);
    CHECK(sc_hold_valid(a, hold) == 0); // it went with its shell
    CHECK(sc_hold_destroy(a, hold) == SC_STALE);
    sc_body ball{};
    REQUIRE(sc_body_find(a, "ball", &ball) == SC_OK);
    sc_mouse_joint grab{};
    REQUIRE(sc_body_grab(a, {0.005, 0.09}, 0.0, &grab) == SC_OK);
    REQUIRE(sc_body_destroy(a, ball) == SC_OK);
    CHECK(sc_mouse_joint_move(a, grab, {0.0, 0.0}) == SC_STALE);
    CHECK(sc_body_valid(a, ball) == 0);
    CHECK(sc_world_destroy(a) == SC_OK);
    CHECK(sc_shell_valid(a, s) == 0);
    CHECK(sc_world_destroy(b) == SC_OK);
}

TEST_CASE("a world goes back to a saved state, with its handles, and lives in another one", "[c]") {
    const sc_world w = makeWorld();
    const sc_shell s = makeShell(w, 0.0, 0.05);
    const auto steps = [](sc_world x, int n) {
        for (int i = 0; i < n; ++i)
            REQUIRE(sc_world_step(x, 1.0 / 240.0, nullptr) == SC_OK);
    };
    steps(w, 5);
    std::vector<std::uint8_t> saved(static_cast<std::size_t>(sc_world_save(w, nullptr, 0)));
    REQUIRE(sc_world_save(w, saved.data(), static_cast<std::int32_t>(saved.size())) > 0);
    const std::uint64_t hash = sc_world_hash(w);
    sc_body ball{};
    sc_body_state before{}, after{};
    REQUIRE(sc_body_find(w, "ball", &ball) == SC_OK);
    REQUIRE(sc_body_state_of(w, ball, &before) == SC_OK);
    steps(w, 5);
    const sc_shell later = makeShell(w, 0.2, 0.05);
    REQUIRE(sc_world_restore(w, saved.data(), static_cast<std::int32_t>(saved.size())) == SC_OK);
    CHECK(sc_world_hash(w) == hash);
    CHECK(sc_shell_valid(w, s) == 1);
    CHECK(sc_shell_valid(w, later) == 0);
    REQUIRE(sc_body_state_of(w, ball, &after) == SC_OK);
    CHECK(after.centre.y == before.centre.y);
    CHECK(after.velocity.y == before.velocity.y);

    const sc_world other = makeWorld();
    REQUIRE(sc_world_restore(other, saved.data(), static_cast<std::int32_t>(saved.size())) == SC_OK);
    CHECK(sc_world_hash(other) == hash);
    sc_shell there{};
    CHECK(sc_world_shells(other, &there, 1) == 1);
    CHECK(sc_shell_valid(other, there) == 1);
    saved[saved.size() / 2] ^= 1;
    CHECK(sc_world_restore(other, saved.data(), static_cast<std::int32_t>(saved.size())) == SC_BAD_INPUT);
    CHECK(sc_world_hash(other) == hash);
    sc_world_destroy(w);
    sc_world_destroy(other);
}

TEST_CASE("zones, events and texts tell what happened", "[c]") {
    const sc_world w = makeWorld();
    const sc_shell s = makeShell(w, 0.0, 0.02); // its tips are a millimetre above the plate
    sc_zone zone{};
    REQUIRE(sc_zone_create(w, {-0.1, -0.1}, {0.1, 0.1}, &zone) == SC_OK);
    bool entered = false, touched = false, left = false;
    for (int i = 0; i < 60; ++i) {
        if (i == 50)
            REQUIRE(sc_shell_teleport(w, s, {0.2, 0.02}, 3.14) == SC_OK);
        REQUIRE(sc_world_step(w, 1.0 / 240.0, nullptr) == SC_OK);
        sc_event events[16];
        const std::int32_t n = sc_world_events(w, events, 16);
        for (std::int32_t k = 0; k < std::min(n, 16); ++k) {
            entered = entered || (events[k].kind == SC_ZONE_ENTER && events[k].zone.id == zone.id);
            left = left || (events[k].kind == SC_ZONE_LEAVE && events[k].a.id == s.id);
            touched = touched || (events[k].kind == SC_CONTACT_BEGIN && sc_body_valid(w, events[k].body) == 1);
        }
    }
    CHECK(entered);
    CHECK(touched);
    CHECK(left);
    CHECK(sc_zone_shells(w, zone, nullptr, 0) == 0);
    CHECK(std::string(sc_world_report(w)).find("\"failure\":\"\"") != std::string::npos);
    CHECK(std::string(sc_effects()).find("planar_drag") != std::string::npos);
    CHECK(sc_world_add(w, "{\"schema\": \"supercircle-scene/1\", \"bodi\": [], \"shel\": []}", -1) == SC_BAD_INPUT);
    CHECK(std::string(sc_error()).find("did you mean \"body\"") != std::string::npos);
    CHECK(std::string(sc_error()).find("did you mean \"shell\"") != std::string::npos); // all of them
    sc_world_destroy(w);
}

TEST_CASE("what would end the process is refused", "[c]") {
    const sc_world w = makeWorld();
    const sc_shell s = makeShell(w, 0.0, 0.05);
    sc_body ball{};
    REQUIRE(sc_body_find(w, "ball", &ball) == SC_OK);
    const sc_status added =
        sc_world_add(w, R"({"schema": "supercircle-scene/1", "body": [{"name": "dust", "type": 2, "position":
        {"x": 0.2, "y": 0.2}, "fixture": [{"density": 0.1, "circle": {"center":
        {"x": 0, "y": 0}, "radius": 0.001}}]}]})",
                     -1);
    INFO(sc_error());
    REQUIRE(added == SC_OK);
    sc_body dust{};
    REQUIRE(sc_body_find(w, "dust", &dust) == SC_OK);
    CHECK(sc_body_apply_impulse(w, dust, {0.0, 1e4}, {1.2, 0.2}) == SC_BAD_INPUT);
    CHECK(sc_body_set_pose(w, ball, {1e300, 0.0}, 0.0) == SC_BAD_INPUT);
    CHECK(sc_body_set_velocity(w, ball, {0.0, 0.0}, NAN) == SC_BAD_INPUT);
    const std::string deep(100000, '[');
    CHECK(sc_shell_set_effects(w, s, deep.c_str()) == SC_BAD_INPUT);
    CHECK(sc_world_add(w, deep.c_str(), -1) == SC_BAD_INPUT);
    sc_scene scene{};
    CHECK(sc_scene_load(w, "{}", -1, nullptr, deep.c_str(), 1, &scene) == SC_BAD_INPUT);
    CHECK(sc_world_step(w, 1.0 / 240.0, nullptr) == SC_OK);
    CHECK(sc_world_destroy(w) == SC_OK);
}

TEST_CASE("shells live in the b2World of a C++ host", "[c]") {
    b2World host({0.0F, static_cast<float>(-9.81 * kUnits)});
    b2BodyDef bodyDef;
    b2Body* body = host.CreateBody(&bodyDef);
    b2PolygonShape box;
    box.SetAsBox(10.0F, 0.1F);
    body->CreateFixture(&box, 0.0F);
    sc_world_def def;
    sc_world_def_init(&def);
    def.units_per_metre = kUnits;
    sc_world w{};
    REQUIRE(sc_world_attach(&host, &def, &w) == SC_OK);
    sc_body floor{};
    REQUIRE(sc_body_of(w, body, &floor) == SC_OK);
    CHECK(sc_body_pointer(w, floor) == body);
    const sc_shell s = makeShell(w, 0.0, 0.05);
    CHECK(sc_world_step(w, 0.01, nullptr) == SC_REFUSED);
    for (int i = 0; i < 60; ++i) {
        sc_frame frame{};
        REQUIRE(sc_world_pre_step(w, 1.0 / 120.0, &frame) == SC_OK);
        host.Step(static_cast<float>(frame.advanced), 8, 3);
        REQUIRE(sc_world_post_step(w) == SC_OK);
    }
    sc_shell_state state{};
    REQUIRE(sc_shell_state_of(w, s, &state) == SC_OK);
    CHECK(state.lower.y > 0.0019 - 1e-4); // it lies on the box, whose top is at 0.1 units
    CHECK(state.centre.y < 0.03);
    CHECK(sc_world_destroy(w) == SC_OK);
}
