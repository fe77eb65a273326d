// The scenes of the live page hold for ten seconds: nothing is quarantined, no energy comes from nowhere.

#include "bridge/c/include/supercircle.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace {

const std::filesystem::path kPlayScenes = std::filesystem::path(SC_SOURCE_DIR) / "scenes/play";

std::string textOf(const std::filesystem::path& file) {
    std::ostringstream out;
    out << std::ifstream(file).rdbuf();
    return out.str();
}

struct Playing {
    sc_world world{};
    sc_scene scene{};
    explicit Playing(const std::string& text, const char* parameters = nullptr) {
        sc_world_def def;
        sc_world_def_init(&def);
        REQUIRE(sc_scene_world_def(text.c_str(), -1, &def) == SC_OK);
        def.quality = SC_QUALITY_GAME;
        REQUIRE(sc_world_create(&def, &world) == SC_OK);
        const sc_status loaded = sc_scene_load(world, text.c_str(), -1, "play", parameters, 1, &scene);
        INFO(sc_error());
        REQUIRE(loaded == SC_OK);
    }
    Playing(const Playing&) = delete;
    Playing& operator=(const Playing&) = delete;
    ~Playing() { sc_world_destroy(world); }
};

/// Largest force while the press goes down, over B / R^2.
double peakOverUnit(double opening, double friction) {
    const std::string parameters =
        "{\"phi_bar\": " + std::to_string(opening) + ", \"mu\": " + std::to_string(friction) + "}";
    Playing p(textOf(kPlayScenes / "snap.json"), parameters.c_str());
    double peak = 0.0;
    while (!sc_scene_finished(p.scene) && std::string(sc_scene_phase(p.scene)).find("unload") == std::string::npos) {
        REQUIRE(sc_scene_step(p.scene, 1.0 / 60.0, nullptr) == SC_OK);
        peak = std::max(peak, sc_scene_force(p.scene));
    }
    const double h = 0.0005 / 0.0192, density = 0.02 / (2.0 * M_PI * 0.75 * h),
                 young = 4.0 * 2.2e9 / 0.0192 * density / 1270;
    return peak / (young * h * h * h / 12.0);
}

} // namespace

TEST_CASE("every scene of the live page plays ten seconds", "[c][play]") {
    int scenes = 0;
    for (const auto& file : std::filesystem::directory_iterator(kPlayScenes)) {
        CAPTURE(file.path().filename().string());
        const std::string text = textOf(file.path());
        CHECK(std::string(sc_scene_check(text.c_str(), -1, nullptr)) == "[]");
        Playing p(text);
        for (int i = 0; i < 600 && !sc_scene_finished(p.scene); ++i) {
            sc_frame frame;
            REQUIRE(sc_scene_step(p.scene, 1.0 / 60.0, &frame) == SC_OK);
            REQUIRE(frame.quarantined == 0);
            REQUIRE(frame.energy_gained == 0.0);
        }
        ++scenes;
    }
    CHECK(scenes == 12);
}

TEST_CASE("the shell of the live page changes its type at equation (1)", "[c][play]") {
    // Smooth peaks stay below 0.4 B / R^2 and abrupt ones pass 3: a tip that sticks rolls the shell up. The boundary is
    // that of a shell without thickness; h / R = 0.026 moves it by about 0.01 in mu, a tenth of it at an opening of
    // 0.9.
    for (const double opening : {0.8, 0.85, 0.9}) {
        const double phi = M_PI * opening, c = std::cos(phi), s = std::sin(phi);
        const double ratio = (0.5 - 1.5 * c * c + c - phi * s * c) / (0.5 * phi - 1.5 * s * c + phi * c * c);
        const double boundary = std::tan(M_PI - phi + std::atan(ratio));
        CAPTURE(opening, boundary);
        CHECK(peakOverUnit(opening, 0.8 * boundary) < 1.0);
        CHECK(peakOverUnit(opening, 1.2 * boundary) > 1.0);
    }
}
