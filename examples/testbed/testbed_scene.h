#pragma once
// The scene of the testbed and its operations, without drawing.

#include "examples/games/frame/game_world.h"
#include "examples/testbed/testbed.h"
#include "plugin/graphics/cairo_canvas.h"

#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::testbed {

/// One value a step, for the live curves.
struct Curves {
    std::vector<double> time, travel, force;                ///< s, m, N
    std::vector<double> kinetic, bending, friction, losses; ///< J; losses: impact and numerical
};

/// Records a film of the pictures (with ffmpeg) and a table of the motion.
class Recorder {
public:
    ~Recorder() { stop(); }
    /// `film` ends in .mp4; the table has the same name with .csv. Empty, or what is not recorded and why.
    std::string start(const std::string& film, int width, int height);
    void stop();
    [[nodiscard]] bool running() const { return film_ != nullptr || table_.is_open(); }
    void picture(const graphics::CairoCanvas& canvas);
    void motion(const frame::GameWorld& world);

private:
    FILE* film_ = nullptr;
    int width_ = 0, height_ = 0;
    std::ofstream table_;
};

class TestbedScene {
public:
    explicit TestbedScene(const Arguments& arguments) : arguments_(arguments), parameters_(arguments.parameters) {}
    /// Loads the scene with the present parameters; empty, or the error.
    std::string open();
    void step();
    void set(const std::string& parameter, double value); ///< takes effect with the next open()
    void save();
    void restore();
    [[nodiscard]] bool saved() const { return saved_.has_value(); }
    /// Pushes everything away from a point (m).
    void pushAway(Point at);

    [[nodiscard]] frame::GameWorld& world() { return *world_; }
    [[nodiscard]] const frame::GameWorld& world() const { return *world_; }
    [[nodiscard]] const Curves& curves() const { return curves_; }
    [[nodiscard]] const std::string& failure() const { return failure_; }
    /// Wall time of each stage of the step, ms per frame, smoothed.
    [[nodiscard]] const std::vector<std::pair<std::string, double>>& profile() const { return profile_; }
    /// A box around everything, or around the shells alone.
    void extent(Point& lower, Point& upper, bool shellsOnly = false) const;

private:
    struct Saved {
        Snapshot shells;
        std::vector<std::array<double, 6>> bodies; ///< x, y, angle, vx, vy, spin; in Box2D's units
    };
    void measure();
    Arguments arguments_;
    std::vector<std::pair<std::string, double>> parameters_;
    std::shared_ptr<frame::GameWorld> world_;
    Curves curves_;
    std::string failure_;
    std::vector<std::pair<std::string, double>> profile_;
    std::vector<double> stageTimes_;
    std::optional<Saved> saved_;
};

} // namespace supercircle::testbed
