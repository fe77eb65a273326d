#pragma once
// Input of the player, from a window or from a script.

#include "plugin/api/include/supercircle/definitions.hpp"

#include <set>
#include <string>
#include <vector>

namespace supercircle::frame {

/// Keys are called "left", "right", "up", "down", "space", "enter", "escape", "home", "a" .. "z", "0" .. "9", ".".
class Input {
public:
    [[nodiscard]] bool held(const std::string& key) const { return held_.count(key) > 0; }
    /// Went down since the last step.
    [[nodiscard]] bool pressed(const std::string& key) const { return pressed_.count(key) > 0; }
    [[nodiscard]] bool buttonHeld() const { return button_; }
    [[nodiscard]] bool clicked() const { return clicked_; }   ///< went down since the last step
    [[nodiscard]] bool released() const { return released_; } ///< went up since the last step
    [[nodiscard]] Point mouse() const { return mouse_; }      ///< m, in the world

    void keyDown(const std::string& key) {
        held_.insert(key);
        pressed_.insert(key);
    }
    void keyUp(const std::string& key) { held_.erase(key); }
    void buttonDown() { button_ = clicked_ = true; }
    void buttonUp() {
        released_ = released_ || button_;
        button_ = false;
    }
    void moveMouse(Point to) { mouse_ = to; }
    /// After a step: clears the events of that step.
    void forget() {
        pressed_.clear();
        clicked_ = released_ = false;
    }

private:
    std::set<std::string> held_, pressed_;
    bool button_ = false, clicked_ = false, released_ = false;
    Point mouse_{};
};

/// Timed inputs from a JSON file (docs/how-to/levels.md): a list of
///   {"t": s, "key": name}  {"t": s, "down": name}  {"t": s, "up": name}
///   {"t": s, "mouse": {"x": m, "y": m}, "over": s}  {"t": s, "button": "down" | "up" | "click"}
class Script {
public:
    /// `error` gets one line per problem, file:line:column; empty after success.
    static Script load(const std::string& path, std::string& error);
    /// Applies the inputs that are due at the start of step number `frame` (of 1/60 s).
    void play(std::uint64_t frame, Input& input);
    /// Whether all inputs were applied.
    [[nodiscard]] bool done() const { return next_ >= events_.size() && !gliding_; }

private:
    struct Event {
        double t = 0.0;
        enum class Kind { Key, Down, Up, Mouse, Button } kind = Kind::Key;
        std::string text;
        Point to{};
        double over = 0.0;
    };
    std::vector<Event> events_;
    std::size_t next_ = 0;
    std::vector<std::string> keysUp_; ///< of "key": down for one step
    bool buttonUp_ = false, gliding_ = false;
    Point from_{};
    Event glide_{};
};

} // namespace supercircle::frame
