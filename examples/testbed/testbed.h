#pragma once
// The testbed behind `supercircle view`: a scene in a window, with sliders for its parameters, drawings of contacts and
// stresses, and live curves of forces and energies.

#include <atomic>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::testbed {

struct Arguments {
    std::string scene;
    std::vector<std::pair<std::string, double>> parameters;
    bool game = false;     ///< game quality instead of the laboratory's
    bool headless = false; ///< no window: play, write the picture, end
    int frames = 300;      ///< steps of 1/60 s, headless
    std::string png;       ///< file for the last picture, headless
    std::string wav;       ///< file for the sound, headless
    std::string script;    ///< timed inputs (docs/how-to/levels.md)
    std::string show;      ///< what is drawn at the start: names of the check boxes, with commas
    std::string record;    ///< begins with a recording into this file (.mp4) and the trajectory beside it (.csv)
    int width = 1280, height = 720;
    const std::atomic<bool>* interrupt = nullptr; ///< set from outside: end after the current step, keep what is done
};

/// Names for Arguments::show.
const std::vector<std::string>& layers();

/// Exit codes as of the subcommands: 0, 2 bad input, 3 the simulation could not go on, 4 output could not be written,
/// 130 interrupted.
int view(const Arguments& arguments);

} // namespace supercircle::testbed
