// The testbed without a window: panels drawn into pixels, scenes saved, restored, changed, bombed and recorded.

#ifdef SC_HAS_TESTBED

#include "examples/testbed/bed.h"
#include "examples/testbed/layers.h"
#include "examples/testbed/panel.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <imgui.h>

using namespace supercircle;
using namespace supercircle::testbed;

namespace {

const std::string kScenes = std::string(SC_SOURCE_DIR) + "/scenes/";

Bed openBed(const std::string& scene) {
    Arguments a;
    a.scene = kScenes + scene;
    Bed bed(a);
    REQUIRE(bed.open().empty());
    return bed;
}

} // namespace

TEST_CASE("the panels' rasteriser covers every pixel of a rectangle once", "[testbed]") {
    PanelContext panels;
    report::CairoCanvas canvas(64, 64, 1.0);
    panels.begin(64, 64, {-1, -1}, false, 0.0);
    // Two half-transparent triangles: a pixel of their common edge drawn twice or never would show.
    ImGui::GetBackgroundDrawList()->AddRectFilled({10.0F, 20.0F}, {43.0F, 53.0F}, IM_COL32(255, 0, 0, 128));
    panels.draw(canvas);
    const report::CairoCanvas::Pixels p = canvas.pixels();
    int inside = 0, wrong = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            std::uint32_t pixel = 0;
            std::memcpy(&pixel, p.data + static_cast<std::ptrdiff_t>(y) * p.stride + 4 * static_cast<std::ptrdiff_t>(x),
                        4);
            const bool in = x >= 10 && x < 43 && y >= 20 && y < 53;
            inside += in ? 1 : 0;
            wrong += (pixel & 0xffffffU) == (in ? 0xff7f7fU : 0xffffffU) ? 0 : 1; // 255 (1 - 128/255)
        }
    CHECK(inside == 33 * 33);
    CHECK(wrong == 0);
}

TEST_CASE("a click reaches a check box of a panel", "[testbed]") {
    PanelContext panels;
    report::CairoCanvas canvas(200, 100, 1.0);
    bool on = false;
    for (int frame = 0; frame < 6; ++frame) {
        panels.begin(200, 100, {25, 25}, frame == 2 || frame == 3, 0.0);
        ImGui::SetNextWindowPos({0.0F, 0.0F});
        ImGui::Begin("panel", nullptr, ImGuiWindowFlags_NoTitleBar);
        ImGui::SetCursorPos({15.0F, 15.0F});
        ImGui::Checkbox("on", &on);
        ImGui::End();
        panels.draw(canvas);
        if (frame > 1)
            CHECK(panels.wantsMouse());
    }
    CHECK(on);
}

TEST_CASE("a saved scene goes on as it did", "[testbed]") {
    Bed bed = openBed("two_shells.json");
    for (int i = 0; i < 20; ++i)
        bed.step();
    bed.save();
    for (int i = 0; i < 20; ++i)
        bed.step();
    const std::uint64_t first = bed.stage().shells().hash();
    bed.restore();
    CHECK(bed.stage().shells().time() == Approx(20.0 / 60.0));
    for (int i = 0; i < 20; ++i)
        bed.step();
    CHECK(bed.failure().empty());
    CHECK(bed.stage().shells().hash() == first);
    CHECK(bed.curves().force.back() > 0.0);
}

TEST_CASE("a parameter counts from the next start on, and must be in its range", "[testbed]") {
    Bed bed = openBed("two_shells.json");
    bed.set("mu", 0.1);
    CHECK(bed.stage().scene().parameters[1].value == 0.35);
    REQUIRE(bed.open().empty());
    CHECK(bed.stage().scene().parameters[1].value == 0.1);
    bed.set("mu", -1.0);
    CHECK(bed.open().find("mu") != std::string::npos);
}

TEST_CASE("a bomb drives things away", "[testbed]") {
    Bed bed = openBed("hello.json");
    for (int i = 0; i < 3; ++i)
        bed.step();
    const Shells& shells = bed.stage().shells();
    const ShellHandle over = shells.find("over");
    const Point before = shells.measure(over)->momentum;
    const Point at = shells.measure(over)->centre;
    bed.bomb({at.x + 1.0, at.y});
    CHECK(shells.measure(over)->momentum.x < before.x);
    for (int i = 0; i < 60; ++i)
        bed.step();
    CHECK(bed.failure().empty());
}

TEST_CASE("layers are named, and unknown names are returned", "[testbed]") {
    Layers layers;
    CHECK(layers.set("energy,slip").empty());
    CHECK(layers.energy);
    CHECK_FALSE(layers.contacts);
    CHECK(layers.set("energy,colour") == "colour");
    CHECK(testbed::layers().size() == layers.all().size());
}

TEST_CASE("the motion is recorded as a table", "[testbed]") {
    Bed bed = openBed("two_shells.json");
    Recorder recorder;
    const std::string film = std::string(SC_BINARY_DIR) + "/recorded.mp4";
    (void)recorder.start(film, 64, 64); // without ffmpeg it says that only the table is written
    REQUIRE(recorder.running());
    for (int i = 0; i < 5; ++i) {
        bed.step();
        recorder.motion(bed.stage());
        recorder.picture(report::CairoCanvas(64, 64, 1.0));
    }
    recorder.stop();
    std::ifstream in(std::string(SC_BINARY_DIR) + "/recorded.csv");
    int lines = 0;
    for (std::string line; std::getline(in, line);)
        ++lines;
    CHECK(lines == 1 + 5 * 2); // two shells
}

#endif
