// What a running world shows and sounds: the experiment of two shells, which snaps.

#include "bridge/box2d/box2d_port.h"
#include "bridge/box2d/include/supercircle/box2d.hpp"
#include "plugin/api/include/supercircle/scene.hpp"
#include "plugin/graphics/live/live_picture.h"
#include "plugin/graphics/live/live_sound.h"

#include <box2d/box2d.h>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;

namespace {

struct Running {
    explicit Running(const std::string& scene, const std::vector<std::pair<std::string, double>>& parameters = {},
                     double units = 52.1)
        : attachment(bridge::attach(world, {units})), shells(attachment),
          player(*load_scene(std::string(SC_SOURCE_DIR) + "/scenes/" + scene + ".json", shells, {parameters, 1})) {}
    void step() {
        const FrameReport frame = player.pre_step(1.0 / 60.0);
        REQUIRE(frame.failure.empty());
        world.Step(static_cast<float>(frame.advanced), 8, 3);
        attachment->stepped(frame.advanced);
        player.post_step().or_fail();
        watch.frame(shells);
        sound.frame(shells);
    }
    b2World world{b2Vec2(0.0F, 0.0F)};
    bridge::Attachment attachment;
    Shells shells;
    ScenePlayer player;
    live::SnapWatch watch;
    live::SoundWatch sound;
};

double distance(const picture::Point& a, const picture::Point& b) {
    return std::hypot(a.x - b.x, a.y - b.y);
}

} // namespace

TEST_CASE("the lines of a picture have the length and the stored energy of their shells", "[live]") {
    Running run("two_shells");
    for (int i = 0; i < 150; ++i)
        run.step();
    const auto pictures = live::shellsOf(run.shells, 1.0, 1e-6);
    const auto handles = run.shells.shells();
    REQUIRE(pictures.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        const picture::Shell& s = pictures[i];
        const auto state = run.shells.state(handles[i]);
        REQUIRE(state);
        REQUIRE(s.line.size() == s.energy.size());
        double length = 0.0, energy = 0.0;
        for (std::size_t k = 1; k < s.line.size(); ++k) {
            const double piece = distance(s.line[k - 1], s.line[k]);
            length += piece;
            energy += 0.5 * piece * (s.energy[k - 1] + s.energy[k]);
        }
        CHECK(length == Approx(state->length).epsilon(1e-3)); // chords: (8/3) tolerance / arrow of an arc of 1e-6 m
        // Blending between elements keeps the integral up to what the two ends lose: half an element of sixteen, where
        // there is little energy.
        CHECK(energy == Approx(state->stored_energy).epsilon(0.01));
        const auto tip = run.shells.section(handles[i], 1.0);
        CHECK(distance(s.line.back(), {tip->position.x, tip->position.y}) < 1e-12);
        CHECK(s.thickness == 0.0005);
    }
}

TEST_CASE("a picture between two frames lies between them", "[live]") {
    Running run("two_shells", {{"speed", 0.05}});
    for (int i = 0; i < 5; ++i)
        run.step();
    const auto before = live::shellsOf(run.shells, 0.0, 1e-5), after = live::shellsOf(run.shells, 1.0, 1e-5);
    const auto half = live::shellsOf(run.shells, 0.5, 1e-5);
    const auto& upper = half.back().line;
    CHECK(distance(before.back().line.front(), after.back().line.front()) > 1e-4); // 0.83 mm a frame
    CHECK(upper.front().y == Approx(0.5 * (before.back().line.front().y + after.back().line.front().y)).margin(1e-5));
}

TEST_CASE("bodies are told apart by their role, and disabled ones are not shown", "[live]") {
    Running run("stack30", {{"shells", 1}});
    std::vector<step::BodyOutline> outlines;
    run.attachment->everything(outlines);
    const auto bodies = live::bodiesOf(*run.attachment, outlines);
    REQUIRE(bodies.size() == 4); // floor, two walls, plate
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(bodies[i].role == (i < 3 ? picture::Role::Still : picture::Role::Driven));
        CHECK(bodies[i].solid);
        CHECK(bodies[i].points.size() == 4);
    }
    CHECK(bodies[0].id == bodies[2].id);
    run.attachment->bodyOf(bodies[3].id)->SetEnabled(false);
    CHECK(live::bodiesOf(*run.attachment, outlines).size() == 3);
}

TEST_CASE("a snap is shown with its energy, and is by far the loudest of the experiment", "[live][sound]") {
    Running run("two_shells", {{"phi_bar", 0.9}, {"mu", 0.1}});
    (void)run.sound.make(run.shells, 0.0);
    double before = 0.0, after = 0.0, released = 0.0;
    int last = 0;
    bool begun = false;
    for (int i = 0; i < 300 && (last == 0 || i < last + 6); ++i) {
        run.step();
        for (const SnapEndEvent& s : run.shells.events().snap_end)
            released = std::max(released, s.energy_released);
        double sum = 0.0;
        for (const float x : run.sound.make(run.shells, 1.0 / 60.0)) {
            CHECK(std::abs(x) < 1.0F);
            sum += static_cast<double>(x) * static_cast<double>(x);
        }
        begun = begun || !run.shells.events().snap_begin.empty();
        double& loudest = begun ? after : before; // of a frame
        loudest = std::max(loudest, sum);
        if (released > 0.0 && last == 0)
            last = i;
    }
    REQUIRE(released > 0.01); // 18 mJ
    CHECK(after > 10.0 * before);
    const auto marks = run.watch.at(run.shells);
    REQUIRE_FALSE(marks.empty());
    double shown = 0.0;
    for (const picture::SnapMark& m : marks)
        shown = std::max(shown, m.released);
    CHECK(shown == released);
}

TEST_CASE("a world that nobody listens to keeps nothing, and one at rest is silent", "[live][sound]") {
    Running run("two_shells", {{"phi_bar", 0.9}, {"mu", 0.1}});
    for (int i = 0; i < 20; ++i)
        run.step();
    CHECK_FALSE(run.sound.on());
    CHECK(run.sound.make(run.shells, 0.5).size() == 24000);
    for (const float x : run.sound.make(run.shells, 0.5)) // no step since
        REQUIRE(x == 0.0F);
}
