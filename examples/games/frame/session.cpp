#include "examples/games/frame/session.h"

#include <algorithm>

namespace supercircle::frame {

std::string Session::open(std::size_t index) {
    auto world = GameWorld::load(levels_[index]);
    if (!world)
        return world.error();
    if ((*world)->game().kind != program_->name)
        return levels_[index] + ": /game/kind: this is no level of " + program_->name;
    auto game = program_->make();
    if (std::string why = game->start(**world); !why.empty())
        return levels_[index] + ": " + why;
    world_ = *world;
    game_ = std::move(game);
    index_ = index;
    failure_.clear();
    due_ = 0.0;
    alpha_ = 1.0;
    camera_.fit(world_->game().viewLower, world_->game().viewUpper);
    return {};
}

/// Keys every game has. True if the level was opened anew.
bool Session::frameKeys(Input& input) {
    quit_ = quit_ || input.pressed("escape");
    if (input.pressed("p"))
        paused_ = !paused_;
    if (input.pressed("m"))
        slow_ = !slow_;
    if (input.pressed("h"))
        help_ = !help_;
    if (input.pressed("home"))
        camera_.home();
    single_ = paused_ && input.pressed(".");
    const bool next = input.pressed("n") && index_ + 1 < levels_.size();
    if (!input.pressed("r") && !next)
        return false;
    input.forget();
    failure_ = open(next ? index_ + 1 : index_);
    return true;
}

void Session::drag(const Input& input) {
    const DragSettings drag = game_->dragSettings();
    if (!drag.allowed)
        return;
    if (input.clicked())
        world_->startDrag(input.mouse(), drag.reach > 0.0 ? drag.reach : 14.0 / camera_.scale(), drag.strength,
                          drag.shellFrequency, drag.bodyFrequency);
    if (world_->dragging())
        world_->moveMouse(input.mouse());
    if (!input.buttonHeld() && world_->dragging())
        world_->releaseMouse();
}

void Session::step(Input& input) {
    const bool anew = frameKeys(input);
    if (!anew && failure_.empty() && (!paused_ || single_)) {
        drag(input);
        if (game_->result() == GameResult::Playing)
            game_->beforeStep(*world_, input);
        const FrameReport report = world_->step();
        failure_ = report.failure;
        if (failure_.empty() && game_->result() == GameResult::Playing)
            game_->afterStep(*world_);
    }
    input.forget();
}

void Session::advance(double seconds, Input& input) {
    due_ += std::min(seconds, 0.1) * (slow_ ? 0.25 : 1.0);
    bool stepped = false;
    for (; due_ >= kStep; due_ -= kStep) {
        step(input);
        stepped = true;
    }
    if (paused_ && !stepped)
        due_ = std::max(due_, 0.0);
    alpha_ = paused_ ? 1.0 : due_ / kStep;
}

void Session::draw(picture::ListCanvas& canvas, double width, double height) {
    camera_.resize(width, height);
    const View view(canvas, camera_, width, height);
    view.background();
    game_->draw(*world_, view, alpha_);
    view.drag(*world_);
    view.snaps(*world_);
    std::string hint = paused_ ? "Paused. P: go on, . (dot): one step" : game_->hint(*world_);
    if (slow_)
        hint = "[slow motion] " + hint;
    drawStrips(view, program_->title + " " + std::to_string(index_ + 1) + ": " + world_->game().title,
               game_->status(*world_), hint, "H: help");
    if (const std::string& why = world_->report().why; !why.empty())
        canvas.text({18.0, height - look::bottom - 8.0}, why, {.size = 11.0, .colour = look::muted});
    if (!failure_.empty())
        drawCard(view, "Stopped", {failure_, "R: again"}, look::bad);
    else if (game_->result() == GameResult::Won)
        drawCard(view, "Won: " + std::to_string(game_->score()) + " points",
                 {game_->reason(), index_ + 1 < levels_.size() ? "N: next level   R: again" : "R: again   Esc: quit"},
                 look::good);
    else if (game_->result() == GameResult::Lost)
        drawCard(view, "Lost", {game_->reason(), "R: again"}, look::bad);
    if (help_) {
        auto keys = game_->help();
        const std::vector<std::pair<std::string, std::string>> common{{"P  .", "pause, one step"},
                                                                      {"M", "slow motion"},
                                                                      {"R  N", "again, next level"},
                                                                      {"wheel, right drag, Home", "zoom, move, reset"},
                                                                      {"H  Esc", "help, quit"}};
        keys.insert(keys.end(), common.begin(), common.end());
        drawHelp(view, keys);
    }
}

} // namespace supercircle::frame
