#pragma once
// Ten scenes that ask more of a frame than a game can pay: presses, blows, fast walls, crowds. They show what the frame
// budget does (docs/how-to/game_quality_and_frame_budget.md).

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/port.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace supercircle::cli {

/// A scene of Quality::Game under way.
struct FrameLevel {
    std::shared_ptr<step::HostWorld> host;
    std::unique_ptr<Shells> shells;
    std::function<void(int frame)> before; ///< what its player does before a frame; empty: nothing
};

struct FrameScene {
    std::string name;
    int frames = 120;
    double frame = 1.0 / 60.0; ///< s
    std::function<FrameLevel()> make;
};

std::vector<FrameScene> frameScenes();

} // namespace supercircle::cli
