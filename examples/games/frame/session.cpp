#include "examples/games/frame/session.h"

#include <algorithm>

namespace supercircle::frame {

std::string Session::open(std::size_t index) {
    auto stage = Stage::load(levels_[index]);
    if (!stage)
        return stage.error();
    if ((*stage)->game().kind != program_->name)
        return levels_[index] + ": /game/kind: this is no level of " + program_->name;
    auto game = program_->make();
    if (std::string why = game->start(**stage); !why.empty())
        return levels_[index] + ": " + why;
    stage_ = *stage;
    game_ = std::move(game);
    index_ = index;
    failure_.clear();
    due_ = 0.0;
    alpha_ = 1.0;
    camera_.fit(stage_->game().viewLower, stage_->game().viewUpper);
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

void Session::hand(const Input& input) {
    const Grip grip = game_->grip();
    if (!grip.allowed)
        return;
    if (input.clicked())
        stage_->take(input.mouse(), grip.reach > 0.0 ? grip.reach : 14.0 / camera_.scale(), grip.strength,
                     grip.shellFrequency, grip.bodyFrequency);
    if (stage_->holding())
        stage_->moveHand(input.mouse());
    if (!input.buttonHeld() && stage_->holding())
        stage_->letGo();
}

void Session::step(Input& input) {
    const bool anew = frameKeys(input);
    if (!anew && failure_.empty() && (!paused_ || single_)) {
        hand(input);
        if (game_->verdict() == Verdict::Playing)
            game_->control(*stage_, input);
        const FrameReport report = stage_->step();
        failure_ = report.failure;
        if (failure_.empty() && game_->verdict() == Verdict::Playing)
            game_->judge(*stage_);
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

void Session::draw(Canvas& canvas, double width, double height) {
    camera_.resize(width, height);
    const View view(canvas, camera_, width, height);
    view.background();
    game_->draw(*stage_, view, alpha_);
    view.hand(*stage_);
    std::string hint = paused_ ? "Paused. P: go on, . (dot): one step" : game_->hint(*stage_);
    if (slow_)
        hint = "[slow motion] " + hint;
    drawStrips(view, program_->title + " " + std::to_string(index_ + 1) + ": " + stage_->game().title,
               game_->status(*stage_), hint, "H: help");
    if (!failure_.empty())
        drawCard(view, "Stopped", {failure_, "R: again"}, look::bad);
    else if (game_->verdict() == Verdict::Won)
        drawCard(view, "Won: " + std::to_string(game_->score()) + " points",
                 {game_->reason(), index_ + 1 < levels_.size() ? "N: next level   R: again" : "R: again   Esc: quit"},
                 look::good);
    else if (game_->verdict() == Verdict::Lost)
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
