// supercircle-view: a scene in a window.

#include "plugin/cli/command_line.h"
#include "plugin/cli/subcommands.h"

#include <memory>

namespace supercircle::cli {

namespace {

std::function<int()> describeView(CLI::App& app) {
    auto arguments = std::make_shared<ViewArguments>(); // the options write into it
    ViewArguments& a = *arguments;
    app.add_option("scene", a.scene, "scene file (JSON)")->required()->type_name("SCENE.json");
    addParameters(app, a.parameters);
    app.add_flag("--game", a.game, "game quality instead of laboratory quality");
    app.add_flag("--headless", a.headless, "no window: simulate, write the picture, exit");
    app.add_option("--frames", a.frames, "steps of 1/60 s, headless")
        ->check(CLI::Range(1, 1000000).description(""))
        ->type_name("N")
        ->capture_default_str();
    app.add_option("--png", a.png, "the last picture, headless")->type_name("FILE");
    app.add_option("--wav", a.wav, "the sound, headless")->type_name("FILE");
    app.add_option("--script", a.script, "timed inputs (docs/how-to/levels.md)")->type_name("FILE.json");
    app.add_option("--show", a.show, "layers: curvature, energy, contacts, slip, proxies, boxes; with commas")
        ->type_name("NAMES");
    app.add_option("--record", a.record, "film of the pictures; the motion goes beside it as .csv")
        ->type_name("FILE.mp4");
    return [arguments] { return cli::view(*arguments); };
}

} // namespace

} // namespace supercircle::cli

int main(int argc, char** argv) {
    using namespace supercircle::cli;
    return runPlainProgram(argc, argv, "supercircle view", "Watch a scene in a window: sliders, layers, live curves",
                           describeView);
}
