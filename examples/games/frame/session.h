#pragma once
// A level that is being played: pause, single step, slow motion, restart, pictures; for windows and headless runs.

#include "examples/games/frame/game.h"

namespace supercircle::frame {

class Session {
public:
    Session(const Program& program, std::vector<std::string> levels) : program_(&program), levels_(std::move(levels)) {}

    /// Loads level `index`; empty, or the error.
    std::string open(std::size_t index);
    /// One step of 1/60 s with what `input` holds (and the common keys: pause, restart ...).
    void step(Input& input);
    /// Makes the steps that are due after some real time, s.
    void advance(double seconds, Input& input);
    void draw(picture::ListCanvas& canvas, double width, double height);

    [[nodiscard]] Camera& camera() { return camera_; }
    [[nodiscard]] const GameWorld& world() const { return *world_; }
    [[nodiscard]] const Game& game() const { return *game_; }
    [[nodiscard]] const std::string& failure() const { return failure_; }
    [[nodiscard]] bool quit() const { return quit_; }
    [[nodiscard]] bool paused() const { return paused_; }
    [[nodiscard]] std::size_t level() const { return index_; }
    void showHelp(bool on) { help_ = on; }
    /// The sound of the steps since the last call, `seconds` of it.
    [[nodiscard]] std::span<const float> sound(double seconds) { return world_->sound(seconds); }

private:
    bool frameKeys(Input& input);
    void drag(const Input& input);
    const Program* program_;
    std::vector<std::string> levels_;
    std::size_t index_ = 0;
    std::shared_ptr<GameWorld> world_;
    std::unique_ptr<Game> game_;
    Camera camera_;
    std::string failure_;
    double due_ = 0.0, alpha_ = 1.0;
    bool paused_ = false, slow_ = false, help_ = false, quit_ = false, single_ = false;
};

} // namespace supercircle::frame
