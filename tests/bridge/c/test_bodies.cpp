// Bodies and shells made from definitions of C, and what their refusals say.

#include "bridge/c/include/supercircle.h"
#include "plugin/api/include/supercircle/definitions.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

sc_world gameWorld(double unitsPerMetre = 1.0) {
    sc_world_def def;
    sc_world_def_init(&def);
    def.quality = SC_QUALITY_GAME;
    def.units_per_metre = unitsPerMetre;
    sc_world w{};
    REQUIRE(sc_world_create(&def, &w) == SC_OK);
    return w;
}

sc_body_def bodyDef(int shape, int type = SC_BODY_DYNAMIC) {
    sc_body_def def;
    sc_body_def_init(&def);
    def.shape = shape;
    def.type = type;
    return def;
}

sc_body make(sc_world w, const sc_body_def& def, const std::vector<sc_point>& points = {}) {
    sc_body b{};
    INFO(sc_error());
    REQUIRE(sc_body_create(w, &def, nullptr, points.empty() ? nullptr : points.data(),
                           static_cast<std::int32_t>(points.size()), &b) == SC_OK);
    return b;
}

bool mentions(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_CASE("bodies by definition move as those of a scene's text, to the bit", "[c]") {
    const sc_world byText = gameWorld(), byCall = gameWorld();
    REQUIRE(sc_world_add(byText, R"({"schema": "supercircle-scene/1", "body": [
        {"fixture": [{"edge": {"vertex1": {"x": -20, "y": 0}, "vertex2": {"x": 20, "y": 0}}}]},
        {"type": 2, "position": {"x": 1, "y": 2}, "angle": 0.3, "linearVelocity": {"x": 0.5, "y": -1},
         "angularVelocity": 2, "linearDamping": 0.1, "fixture": [{"density": 2, "friction": 0.5, "restitution": 0.3,
         "polygon": {"vertices": {"x": [-0.3, 0.3, 0.3, -0.3], "y": [-0.2, -0.2, 0.2, 0.2]}}}]},
        {"type": 2, "position": {"x": -2, "y": 1}, "fixture": [{"circle": {"center": 0, "radius": 0.4}}]},
        {"type": 2, "position": {"x": 4, "y": 1}, "fixedRotation": true, "fixture": [{"polygon": {"vertices":
         {"x": [0, 1, 0], "y": [0, 0, 1]}}}]}]})",
                         -1) == SC_OK);
    make(byCall, bodyDef(SC_SHAPE_LINE, SC_BODY_STATIC), {{-20.0, 0.0}, {20.0, 0.0}});
    sc_body_def box = bodyDef(SC_SHAPE_BOX);
    box.position = {1.0, 2.0};
    box.angle = 0.3;
    box.velocity = {0.5, -1.0};
    box.spin = 2.0;
    box.linear_damping = 0.1;
    box.density = 2.0;
    box.friction = 0.5;
    box.restitution = 0.3;
    box.width = 0.6;
    box.height = 0.4;
    make(byCall, box);
    sc_body_def circle = bodyDef(SC_SHAPE_CIRCLE);
    circle.position = {-2.0, 1.0};
    circle.radius = 0.4;
    make(byCall, circle);
    sc_body_def wedge = bodyDef(SC_SHAPE_POLYGON);
    wedge.position = {4.0, 1.0};
    wedge.fixed_rotation = 1;
    make(byCall, wedge, {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}});
    for (int i = 0; i < 120; ++i)
        for (const sc_world w : {byText, byCall})
            REQUIRE(sc_world_step(w, 1.0 / 60.0, nullptr) == SC_OK);
    sc_body first[4], second[4];
    REQUIRE(sc_world_bodies(byText, first, 4) == 4);
    REQUIRE(sc_world_bodies(byCall, second, 4) == 4);
    for (int i = 0; i < 4; ++i) {
        sc_body_state a{}, b{};
        REQUIRE(sc_body_state_of(byText, first[i], &a) == SC_OK);
        REQUIRE(sc_body_state_of(byCall, second[i], &b) == SC_OK);
        INFO("body " << i);
        CHECK(a.centre.x == b.centre.x);
        CHECK(a.centre.y == b.centre.y);
        CHECK(a.angle == b.angle);
        CHECK(a.spin == b.spin);
        CHECK(a.mass == b.mass);
        CHECK(a.inertia == b.inertia);
    }
    sc_world_destroy(byText);
    sc_world_destroy(byCall);
}

TEST_CASE("a body that cannot be is refused, and none is made", "[c]") {
    const sc_world w = gameWorld();
    const std::vector<sc_point> two{{0.0, 0.0}, {1.0, 0.0}}, same{{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
    const auto refused = [&](sc_body_def def, const std::vector<sc_point>& points, const std::string& words) {
        sc_body b{};
        const sc_point* first = points.empty() ? nullptr : points.data();
        CHECK(sc_body_create(w, &def, "b", first, static_cast<std::int32_t>(points.size()), &b) == SC_BAD_INPUT);
        INFO(sc_error());
        CHECK(mentions(sc_error(), words));
        CHECK(b.id == 0);
    };
    refused(bodyDef(SC_SHAPE_BOX), {}, "width and a height");
    refused(bodyDef(SC_SHAPE_CIRCLE), {}, "radius");
    refused(bodyDef(SC_SHAPE_CIRCLE), two, "no points");
    refused(bodyDef(SC_SHAPE_POLYGON), {}, "needs its points");
    refused(bodyDef(SC_SHAPE_POLYGON), two, "3 to 8");
    refused(bodyDef(SC_SHAPE_POLYGON), same, "units_per_metre");
    refused(bodyDef(SC_SHAPE_LINE), two, "static");
    refused(bodyDef(SC_SHAPE_LINE, SC_BODY_STATIC), {{0.0, 0.0}}, "at least 2");
    refused(bodyDef(SC_SHAPE_LINE, SC_BODY_STATIC), {{0.0, 0.0}, {kNan, 0.0}}, "finite");
    refused(bodyDef(4), {}, "shape");
    refused(bodyDef(SC_SHAPE_BOX, 3), {}, "type");
    sc_body_def def = bodyDef(SC_SHAPE_CIRCLE);
    def.radius = 1.0;
    for (double sc_body_def::*member :
         {&sc_body_def::angle, &sc_body_def::spin, &sc_body_def::density, &sc_body_def::friction,
          &sc_body_def::restitution, &sc_body_def::radius, &sc_body_def::linear_damping, &sc_body_def::gravity_scale}) {
        sc_body_def bad = def;
        bad.*member = kNan;
        refused(bad, {}, "");
    }
    def.category = 0x10000;
    refused(def, {}, "16 bits");
    def.size = 0;
    refused(def, {}, "sc_body_def_init");
    CHECK(sc_world_bodies(w, nullptr, 0) == 0);
    sc_world_destroy(w);
}

TEST_CASE("a scaled definition is that of C++", "[c]") {
    sc_shell_def def;
    REQUIRE(sc_shell_def_scaled_init(&def, 1.5, 3.0, 0.6, 2.0) == SC_OK);
    const supercircle::ShellDef same = supercircle::scaled_shell(1.5, 3.0, 0.6, 2.0);
    CHECK(def.radius == same.radius);
    CHECK(def.opening == same.phi_bar);
    CHECK(def.thickness == same.thickness);
    CHECK(def.width == same.width);
    CHECK(def.density == same.density);
    CHECK(def.young_modulus == same.young_modulus);
    CHECK(def.size == static_cast<std::int32_t>(sizeof def));
    const sc_world w = gameWorld();
    sc_shell shell{};
    sc_shell_state state{};
    REQUIRE(sc_shell_create(w, &def, nullptr, nullptr, 0, &shell) == SC_OK);
    REQUIRE(sc_shell_state_of(w, shell, &state) == SC_OK);
    CHECK(state.mass == Approx(3.0).epsilon(1e-12)); // a product of roundings
    for (const double bad : {0.0, -1.0, kNan, std::numeric_limits<double>::infinity()}) {
        CHECK(sc_shell_def_scaled_init(&def, bad, 1.0, 0.5, 1.0) == SC_BAD_INPUT);
        CHECK(sc_shell_def_scaled_init(&def, 1.0, bad, 0.5, 1.0) == SC_BAD_INPUT);
        CHECK(sc_shell_def_scaled_init(&def, 1.0, 1.0, bad, 1.0) == SC_BAD_INPUT);
        CHECK(sc_shell_def_scaled_init(&def, 1.0, 1.0, 0.5, bad) == SC_BAD_INPUT);
    }
    CHECK(def.radius == 1.5);
    CHECK(sc_shell_def_scaled_init(nullptr, 1.0, 1.0, 0.5, 1.0) == SC_BAD_INPUT);
    sc_world_destroy(w);
}

TEST_CASE("a fragment has the scale of its world, and no remark about its end", "[c]") {
    const char* const small = R"({"schema": "supercircle-scene/1", "body": [{"name": "crate", "type": 2, "fixture": [
        {"polygon": {"vertices": {"x": [-0.002, 0.002, 0.002, -0.002], "y": [-0.002, -0.002, 0.002, 0.002]}}}]}]})";
    const sc_world fine = gameWorld(52.1), coarse = gameWorld(1.0);
    CHECK(sc_world_add(fine, small, -1) == SC_OK);
    CHECK(mentions(sc_world_report(fine), R"("note":"")"));
    CHECK(sc_world_add(coarse, small, -1) == SC_BAD_INPUT); // 4 mm are below Box2D's tolerance
    sc_world_destroy(fine);
    sc_world_destroy(coarse);
}

TEST_CASE("refusals of C name nothing of the C++ API", "[c]") {
    const sc_world w = gameWorld();
    sc_shell_def def;
    sc_shell_def_init(&def);
    sc_shell shell{};
    REQUIRE(sc_shell_create(w, &def, nullptr, nullptr, 0, &shell) == SC_OK);
    sc_joint_def joint;
    sc_joint_def_init(&joint);
    joint.shell = shell;
    sc_hold hold{};
    sc_body body{};
    sc_joint made{};
    sc_frame frame{};
    const auto refused = [](sc_status status) {
        const std::string why = sc_error();
        INFO(why);
        CHECK(status != SC_OK);
        CHECK(!why.empty());
        for (const char* const name :
             {"::", "phi_bar", "mu ", "arc_fraction", "create_", "set_", "pre_step", "_catalog", "host"})
            CHECK(!mentions(why, name));
    };
    refused(sc_joint_create(w, &joint, &made));
    refused(sc_hold_create(w, shell, 2.0, SC_HOLD_PIN, SC_BASE_FIXED, &hold));
    refused(sc_shell_set_effect(w, shell, R"({"key": "planar_drg"})"));
    refused(sc_shell_remove_effect(w, shell, "planar_drg"));
    refused(sc_body_find(w, "nobody", &body));
    refused(sc_crosshead_attach(w, "nobody"));
    refused(sc_world_step(w, 1e6, &frame));
    refused(sc_world_step(w, 1e-15, &frame));
    def.friction = -1.0;
    refused(sc_shell_create(w, &def, nullptr, nullptr, 0, &shell));
    CHECK(sc_world_set_quality(w, SC_QUALITY_LABORATORY) == SC_OK);
    refused(sc_world_set_frame_budget(w, 100));
    sc_world_destroy(w);
}
