#pragma once
// Base class of games and their program: derive from Game and pass a Program to run() in main().

#include "examples/games/frame/game_world.h"
#include "examples/games/frame/input.h"
#include "examples/games/frame/view.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::frame {

enum class GameResult { Playing, Won, Lost };

/// How the mouse drags shells and bodies.
struct DragSettings {
    bool allowed = true;
    double reach = 0.0;          ///< m, largest distance of a click from a shell; 0: some pixels
    double strength = 0.0;       ///< largest force, N; 0: as Box2D's mouse joint
    double shellFrequency = 5.0; ///< Hz, of a shell on the spring of the mouse joint
    double bodyFrequency = 5.0;  ///< Hz, of a body on it
};

class Game {
public:
    virtual ~Game() = default;
    /// Before the first step of a level. Empty, or why the level cannot be played.
    virtual std::string start(GameWorld& world) = 0;
    /// Before each step: applies the input.
    virtual void beforeStep(GameWorld& world, const Input& input) = 0;
    /// After each step: updates score and result.
    virtual void afterStep(GameWorld& world) = 0;
    /// The picture without title, status and hint.
    virtual void draw(const GameWorld& world, const View& view, double alpha) const = 0;

    [[nodiscard]] virtual std::vector<StatusEntry> status(const GameWorld& world) const = 0;
    [[nodiscard]] virtual std::string hint(const GameWorld& world) const = 0;
    [[nodiscard]] virtual std::vector<std::pair<std::string, std::string>> help() const = 0;
    [[nodiscard]] virtual DragSettings dragSettings() const { return {}; }

    [[nodiscard]] GameResult result() const { return result_; }
    [[nodiscard]] const std::string& reason() const { return reason_; } ///< of the result, one sentence
    [[nodiscard]] int score() const { return score_; }

protected:
    void end(GameResult result, std::string reason, int score) {
        if (result_ != GameResult::Playing)
            return;
        result_ = result;
        reason_ = std::move(reason);
        score_ = score;
    }

private:
    GameResult result_ = GameResult::Playing;
    std::string reason_;
    int score_ = 0;
};

struct Program {
    std::string name;                ///< of the program and the kind of its levels
    std::string title;               ///< for people
    std::vector<std::string> levels; ///< scene files, relative to the project's scenes/games
    std::function<std::unique_ptr<Game>()> make;
};

/// The program. Options: LEVEL (1 ... or a file), --headless, --frames N, --png FILE, --wav FILE, --script FILE,
/// --expect won|lost|playing. Exit codes: 0 done as expected; 1 ended otherwise; 2 bad input; 3 the simulation could
/// not go on; 4 a picture could not be written; 130 interrupted (SIGINT, SIGTERM), after the picture and the result.
int run(int argc, char** argv, const Program& program);

} // namespace supercircle::frame
