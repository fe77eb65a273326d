#include "examples/games/frame/run.h"

#include "examples/games/frame/session.h"
#include "examples/games/frame/window.h"
#include "plugin/graphics/cairo_picture.h"
#include "plugin/graphics/sound/wav.h"

#include <CLI/CLI.hpp>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>

namespace supercircle::frame {

namespace {

struct Arguments {
    std::string level = "1", png, wav, script, expect;
    bool headless = false, help = false, cost = false;
    int frames = 36000, width = 1280, height = 720;
};

constexpr int kInterrupted = 130;
std::atomic<bool> interrupted{false};

void onInterrupt(int signal) {
    interrupted = true;
    std::signal(signal, SIG_DFL); // a second one ends the program at once
}

const char* text(GameResult v) {
    return v == GameResult::Won ? "won" : v == GameResult::Lost ? "lost" : "playing";
}

/// Reads the command line; the exit code, or -1 to continue.
int parse(int argc, char** argv, const Program& program, Arguments& a) {
    CLI::App app{program.title + ", a game with flexible shells", program.name};
    app.failure_message(CLI::FailureMessage::simple);
    app.add_option("level", a.level, "number of the level, or a file (docs/how-to/levels.md)")->capture_default_str();
    app.add_flag("--headless", a.headless, "no window: play the script, write the picture, end");
    app.add_option("--frames", a.frames, "how many steps of 1/60 s at most, headless")->check(CLI::Range(0, 1000000));
    app.add_option("--png", a.png, "file for the last picture, headless");
    app.add_option("--wav", a.wav, "file for the sound, headless");
    app.add_option("--script", a.script, "file of timed inputs (JSON)");
    app.add_option("--expect", a.expect, "end with 0 exactly if the game does so")
        ->check(CLI::IsMember({"won", "lost", "playing"}));
    app.add_option("--width", a.width, "px")->check(CLI::Range(320, 8192));
    app.add_option("--height", a.height, "px")->check(CLI::Range(240, 8192));
    app.add_flag("--keys", a.help, "show the card of keys from the start");
    app.add_flag("--cost", a.cost, "print processor time per step");
    app.footer("Exit codes: 0 done (as expected); 1 ended otherwise; 2 bad input; 3 the simulation could not go on;\n"
               "4 the picture could not be written; 130 interrupted.");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? 0 : 2;
    }
    return -1;
}

int playHeadless(Session& session, Script& script, const Arguments& a, const Program& program) {
    Input input;
    int frames = 0;
    const auto over = [&] { return session.game().result() != GameResult::Playing || !session.failure().empty(); };
    std::vector<float> samples;
    const auto listen = [&] {
        if (a.wav.empty())
            return;
        const auto more = session.sound(kStep);
        samples.insert(samples.end(), more.begin(), more.end());
    };
    listen();
    for (; frames < a.frames && !over() && !session.quit() && !interrupted; ++frames) {
        script.play(static_cast<std::uint64_t>(frames), input);
        session.step(input);
        listen();
    }
    for (int i = 0; i < 20 && session.failure().empty() && session.game().result() != GameResult::Playing; ++i) {
        session.step(input); // so that the picture shows the result
        listen();
    }
    if (const std::string why = a.wav.empty() ? "" : writeWav(a.wav, samples); !why.empty()) {
        std::fprintf(stderr, "%s\n", why.c_str());
        return 4;
    }
    if (!a.png.empty()) {
        picture::DrawList list;
        picture::ListCanvas canvas(list, a.width, a.height);
        session.draw(canvas, a.width, a.height);
        if (const std::string why = writePng(a.png, list, a.width, a.height); !why.empty()) {
            std::fprintf(stderr, "%s\n", why.c_str());
            return 4;
        }
    }
    const Game& game = session.game();
    std::printf("%s %zu: %s after %d steps, %d points, state %016llx%s%s\n", program.name.c_str(), session.level() + 1,
                text(game.result()), frames, game.score(),
                static_cast<unsigned long long>(session.world().shells().hash()), game.reason().empty() ? "" : ": ",
                game.reason().c_str());
    if (const b2Body* actor = session.world().body(session.world().game().actor); actor != nullptr) {
        const Point at = session.world().position(*actor), v = session.world().velocity(*actor);
        std::printf("  %s: at %.4f, %.4f m, %.4f, %.4f m/s\n", session.world().game().actor.c_str(), at.x, at.y, v.x,
                    v.y);
    }
    for (const StatusEntry& s : game.status(session.world()))
        std::printf("  %s: %s\n", s.name.c_str(), s.value.c_str());
    if (a.cost)
        std::printf("processor time per step: mean %.2f ms, worst %.2f ms\n", session.world().meanCost(),
                    session.world().worstCost());
    if (!session.failure().empty()) {
        std::fprintf(stderr, "%s\n", session.failure().c_str());
        return 3;
    }
    if (interrupted)
        return kInterrupted;
    return a.expect.empty() || a.expect == text(game.result()) ? 0 : 1;
}

int playWindow(Session& session, Script& script, const Arguments& a, const Program& program) {
    Window window;
    if (const std::string why = window.open(a.width, a.height, program.title); !why.empty()) {
        std::fprintf(stderr, "%s\n", why.c_str());
        return 2;
    }
    Input input;
    std::uint64_t scripted = 0;
    double last = window.seconds();
    picture::DrawList list;
    while (!session.quit() && !interrupted) {
        if (!window.poll(input, [&](graphics::Point p) { return session.camera().world(p); }))
            break;
        const Pointer& pointer = window.pointer();
        if (pointer.wheel != 0.0)
            session.camera().zoom(pointer.wheel > 0.0 ? 1.15 : 1.0 / 1.15, pointer.at);
        session.camera().pan(pointer.dragX, pointer.dragY);
        const double now = window.seconds();
        if (!a.script.empty()) { // one step per picture
            script.play(scripted++, input);
            session.step(input);
        } else {
            session.advance(now - last, input);
        }
        last = now;
        list.clear();
        picture::ListCanvas canvas(list, window.width(), window.height());
        session.draw(canvas, window.width(), window.height());
        window.show(list);
    }
    std::printf("%s %zu: %s, %d points, dragged %d times\n", program.name.c_str(), session.level() + 1,
                text(session.game().result()), session.game().score(), session.world().dragCount());
    return !session.failure().empty() ? 3 : interrupted ? kInterrupted : 0;
}

} // namespace

namespace {

std::string write(const std::string& path, const std::string& bytes) {
    std::ofstream out(path, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    return out ? "" : path + ": cannot be written";
}

} // namespace

std::string writePng(const std::string& path, graphics::CairoCanvas& canvas) {
    const auto png = canvas.png();
    return png ? write(path, *png) : png.error();
}

std::string writePng(const std::string& path, const picture::DrawList& list, int width, int height) {
    graphics::CairoCanvas canvas(width, height, 1.0);
    graphics::draw(canvas, list);
    return writePng(path, canvas);
}

std::string writeWav(const std::string& path, const std::vector<float>& samples) {
    return write(path, sound::wav(samples));
}

int run(int argc, char** argv, const Program& program) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
        std::signal(signal, onInterrupt);
    Arguments a;
    if (const int code = parse(argc, argv, program, a); code >= 0)
        return code;
    std::vector<std::string> levels;
    for (const std::string& level : program.levels)
        levels.push_back(std::string(SC_SCENES_DIR) + "/games/" + level);
    std::size_t first = 0;
    if (a.level.find_first_not_of("0123456789") == std::string::npos && a.level.size() < 4) {
        first = static_cast<std::size_t>(std::stoul("0" + a.level));
        if (first < 1 || first > levels.size()) {
            std::fprintf(stderr, "there are levels 1 to %zu\n", levels.size());
            return 2;
        }
        --first;
    } else {
        levels = {a.level};
    }
    std::string error;
    Script script = a.script.empty() ? Script{} : Script::load(a.script, error);
    Session session(program, levels);
    if (error.empty())
        error = session.open(first);
    if (!error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return 2;
    }
    session.showHelp(a.help);
    return a.headless ? playHeadless(session, script, a, program) : playWindow(session, script, a, program);
}

} // namespace supercircle::frame
