#pragma once
// What the testbed can draw into a scene.

#include "examples/games/frame/view.h"
#include "examples/testbed/testbed_scene.h"

namespace supercircle::testbed {

/// The check boxes; names as in layers().
struct Layers {
    bool curvature = false; ///< shells coloured by their change of curvature (blue: opened, red: closed)
    bool energy = true;     ///< shells coloured by stored energy per length
    bool contacts = true;   ///< impulses of the contacts as lines
    bool slip = false;      ///< contacts: green sticks, red slips
    bool proxies = false;   ///< Box2D edges that stand for shells
    bool boxes = false;     ///< boxes of shells and fixtures
    /// Sets the named ones alone; the name that is not known, or empty.
    std::string set(const std::string& names);
    [[nodiscard]] std::vector<std::pair<const char*, bool*>> all();
};

void drawScene(TestbedScene& scene, const frame::View& view, const Layers& layers, double alpha);

/// Live curves at the right of the picture.
void drawCurves(const TestbedScene& scene, frame::Canvas& canvas, const graphics::Rect& area);

} // namespace supercircle::testbed
