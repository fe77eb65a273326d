#include "examples/games/frame/input.h"

#include "examples/games/frame/game_world.h"
#include "plugin/scene/loader/reader.h"

#include <algorithm>
#include <cmath>

namespace supercircle::frame {

Script Script::load(const std::string& path, std::string& error) {
    std::vector<scene::Problem> problems;
    Script script;
    const auto text = scene::readFile(path, problems);
    const auto document =
        text ? scene::parseDocument(*text, path, problems) : Result<scene::Document>::failure(text.error());
    if (document) {
        scene::Scope scope;
        scene::Context context{*document, problems, scope};
        if (document->root().kind() != scene::Node::Kind::Array)
            context.error(document->root(), "", "a script is a list of inputs", "[ ... ]");
        int number = 0;
        for (const scene::Node& node : document->root().children()) {
            scene::ObjectReader reader(context, node, "/" + std::to_string(number++));
            Event e;
            reader.require("t", "a time, s");
            e.t = reader.number("t", 0.0, scene::notNegative);
            const std::vector<std::pair<const char*, Event::Kind>> words{
                {"key", Event::Kind::Key}, {"down", Event::Kind::Down}, {"up", Event::Kind::Up}};
            int count = 0;
            for (const auto& [word, kind] : words)
                if (reader.find(word)) {
                    e.kind = kind;
                    e.text = reader.string(word, "");
                    ++count;
                }
            if (reader.find("mouse")) {
                const Eigen::Vector2d to = reader.vector("mouse", Eigen::Vector2d::Zero());
                e.kind = Event::Kind::Mouse;
                e.to = {to.x(), to.y()};
                e.over = reader.number("over", 0.0, scene::notNegative);
                ++count;
            }
            if (reader.find("button")) {
                const std::vector<std::string> kinds{"down", "up", "click"};
                e.kind = Event::Kind::Button;
                e.text = kinds[reader.choice("button", kinds, 2)];
                ++count;
            }
            reader.finish();
            if (count != 1)
                context.error(node, reader.pointer(), std::to_string(count) + " inputs in one line of the script",
                              "one of key, down, up, mouse, button");
            script.events_.push_back(e);
        }
        std::stable_sort(script.events_.begin(), script.events_.end(),
                         [](const Event& a, const Event& b) { return a.t < b.t; });
    }
    for (const scene::Problem& p : problems)
        error += (error.empty() ? "" : "\n") + p.toString();
    return script;
}

void Script::play(std::uint64_t frame, Input& input) {
    const double now = static_cast<double>(frame) * kStep;
    for (const std::string& key : keysUp_)
        input.keyUp(key);
    keysUp_.clear();
    if (buttonUp_)
        input.buttonUp();
    buttonUp_ = false;
    if (gliding_) {
        const double part = std::clamp((now - glide_.t) / std::max(glide_.over, 1e-9), 0.0, 1.0);
        input.moveMouse({from_.x + part * (glide_.to.x - from_.x), from_.y + part * (glide_.to.y - from_.y)});
        gliding_ = part < 1.0;
    }
    for (; next_ < events_.size() && events_[next_].t <= now + 1e-9; ++next_) {
        const Event& e = events_[next_];
        if (e.kind == Event::Kind::Key || e.kind == Event::Kind::Down)
            input.keyDown(e.text);
        if (e.kind == Event::Kind::Key)
            keysUp_.push_back(e.text);
        if (e.kind == Event::Kind::Up)
            input.keyUp(e.text);
        if (e.kind == Event::Kind::Mouse) {
            gliding_ = e.over > 0.0;
            from_ = input.mouse();
            glide_ = e;
            if (!gliding_)
                input.moveMouse(e.to);
        }
        if (e.kind == Event::Kind::Button && e.text == "up")
            input.buttonUp();
        if (e.kind == Event::Kind::Button && e.text != "up")
            input.buttonDown();
        buttonUp_ = buttonUp_ || (e.kind == Event::Kind::Button && e.text == "click");
    }
}

} // namespace supercircle::frame
