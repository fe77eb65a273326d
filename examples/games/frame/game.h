#pragma once
// What a game is, and the program around it: derive from Game, hand a Program to run() from main().

#include "examples/games/frame/input.h"
#include "examples/games/frame/stage.h"
#include "examples/games/frame/view.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::frame {

enum class Verdict { Playing, Won, Lost };

/// The player's hand.
struct Grip {
    bool allowed = true;
    double reach = 0.0;          ///< m, how near to a shell one has to click; 0: some pixels
    double strength = 0.0;       ///< N, 0: as strong as Box2D's mouse
    double shellFrequency = 5.0; ///< Hz, of a shell on the hand's spring
    double bodyFrequency = 5.0;  ///< Hz, of a body on it
};

class Game {
public:
    virtual ~Game() = default;
    /// Before the first step of a level. Empty, or why the level cannot be played.
    virtual std::string start(Stage& stage) = 0;
    /// Before each step: what the player wants.
    virtual void control(Stage& stage, const Input& input) = 0;
    /// After each step: what came of it.
    virtual void judge(Stage& stage) = 0;
    /// The whole picture but the frame of words around it.
    virtual void draw(const Stage& stage, const View& view, double alpha) const = 0;

    [[nodiscard]] virtual std::vector<Status> status(const Stage& stage) const = 0;
    [[nodiscard]] virtual std::string hint(const Stage& stage) const = 0;
    [[nodiscard]] virtual std::vector<std::pair<std::string, std::string>> help() const = 0;
    /// How the mouse takes hold of shells and bodies.
    [[nodiscard]] virtual Grip grip() const { return {}; }

    [[nodiscard]] Verdict verdict() const { return verdict_; }
    [[nodiscard]] const std::string& reason() const { return reason_; } ///< one sentence about the verdict
    [[nodiscard]] int score() const { return score_; }

protected:
    void end(Verdict verdict, std::string reason, int score) {
        if (verdict_ != Verdict::Playing)
            return;
        verdict_ = verdict;
        reason_ = std::move(reason);
        score_ = score;
    }

private:
    Verdict verdict_ = Verdict::Playing;
    std::string reason_;
    int score_ = 0;
};

struct Program {
    std::string name;                ///< of the program and the kind of its levels
    std::string title;               ///< for people
    std::vector<std::string> levels; ///< scene files, relative to the project's scenes/games
    std::function<std::unique_ptr<Game>()> make;
};

/// The program. Options: LEVEL (1 ... or a file), --headless, --frames N, --png FILE, --script FILE, --expect
/// won|lost|playing. Exit codes: 0 done as expected; 1 ended otherwise; 2 bad input; 3 the simulation could not go on;
/// 4 a picture could not be written.
int run(int argc, char** argv, const Program& program);

} // namespace supercircle::frame
