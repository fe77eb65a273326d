#include "examples/testbed/testbed.h"

#include "examples/games/frame/run.h"
#include "examples/games/frame/window.h"
#include "examples/testbed/layers.h"
#include "examples/testbed/panel.h"
#include "plugin/graphics/cairo_picture.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

namespace supercircle::testbed {

namespace {

using frame::Input;
namespace look = frame::look;

constexpr double kLeft = 290.0;  ///< px, panel
constexpr double kRight = 340.0; ///< px, curves

/// The part of a parameter's range that a slider shows: wide ranges end at ten times the value.
std::pair<double, double> usefulRange(const scene::Parameter& p) {
    const double low = std::isfinite(p.min) ? p.min : p.value - 2.0 * std::abs(p.value) - 1.0;
    const double high = std::isfinite(p.max) ? p.max : p.value + 2.0 * std::abs(p.value) + 1.0;
    return {low, std::min(high, std::max(10.0 * std::abs(p.value), low + 1e-9))};
}

class Testbed {
public:
    explicit Testbed(const Arguments& a) : arguments_(a), scene_(a) {}
    std::string open() {
        if (std::string why = scene_.open(); !why.empty())
            return why;
        fit(false);
        if (!arguments_.show.empty())
            if (const std::string word = layers_.set(arguments_.show); !word.empty())
                return "--show: there is no layer \"" + word + "\"";
        if (!arguments_.record.empty())
            record(arguments_.record);
        return {};
    }
    /// One picture (made only if visible): panels and, unless paused, as many steps as the speed asks for.
    void turn(Input& input, graphics::Point mouse, double wheel, bool visible, double width, double height) {
        camera_.resize(width - kRight, height, kLeft);
        panels_.begin(width, height, mouse, input.buttonHeld(), wheel);
        keys(input);
        panel(height);
        if (!panels_.wantsMouse() || scene_.world().dragging())
            drag(input);
        due_ += paused_ ? (single_ ? 1.0 : 0.0) : static_cast<double>(speed_);
        for (single_ = false; due_ >= 1.0; due_ -= 1.0) {
            scene_.step();
            recorder_.motion(scene_.world());
        }
        if (visible || recorder_.running()) {
            list_.clear();
            picture::ListCanvas canvas(list_, width, height);
            draw(canvas, width, height);
            panels_.end();
            if (recorder_.running()) {
                graphics::CairoCanvas picture(width, height, 1.0);
                paint(picture);
                recorder_.picture(picture);
            }
        } else {
            panels_.skip();
        }
        if (restart_) {
            restart_ = false;
            message_ = scene_.open();
        }
        input.forget();
    }
    /// The last visible picture.
    [[nodiscard]] const picture::DrawList& list() const { return list_; }
    /// The same with its panels.
    void paint(graphics::CairoCanvas& canvas) {
        graphics::draw(canvas, list_);
        panels_.draw(canvas);
    }
    void paintPanels(graphics::CairoCanvas& canvas) { panels_.draw(canvas); }
    /// The sound of the steps since the last call, `seconds` of it.
    [[nodiscard]] std::span<const float> sound(double seconds) { return scene_.world().sound(seconds); }
    [[nodiscard]] frame::Camera& camera() { return camera_; }
    [[nodiscard]] TestbedScene& scene() { return scene_; }
    [[nodiscard]] bool wantsMouse() const { return panels_.wantsMouse(); }
    [[nodiscard]] bool quit() const { return quit_; }
    [[nodiscard]] bool paused() const { return paused_; }
    void stopRecording() { recorder_.stop(); }

private:
    void fit(bool shellsOnly) {
        Point lower, upper;
        scene_.extent(lower, upper, shellsOnly);
        camera_.fit(lower, upper);
    }
    void keys(const Input& input);
    void drag(const Input& input);
    void panel(double height);
    void sliders();
    void buttons();
    void draw(picture::ListCanvas& canvas, double width, double height);
    void record(const std::string& film) { message_ = recorder_.start(film, arguments_.width, arguments_.height); }

    Arguments arguments_;
    TestbedScene scene_;
    PanelContext panels_;
    picture::DrawList list_;
    frame::Camera camera_;
    Layers layers_;
    Recorder recorder_;
    std::string message_;
    std::map<std::string, double> edited_;                    ///< what the sliders show
    std::map<std::string, std::pair<double, double>> ranges_; ///< of the sliders
    float speed_ = 1.0F;
    double due_ = 0.0;
    bool paused_ = false, single_ = false, restart_ = false, quit_ = false;
};

void Testbed::keys(const Input& input) {
    quit_ = quit_ || input.pressed("escape");
    if (input.pressed("p") || input.pressed("space"))
        paused_ = !paused_;
    single_ = single_ || input.pressed(".");
    restart_ = restart_ || input.pressed("r");
    if (input.pressed("home") || input.pressed("f"))
        fit(input.pressed("f"));
    if (input.pressed("b"))
        scene_.pushAway(input.mouse());
    if (input.pressed("s"))
        scene_.save();
    if (input.pressed("l"))
        scene_.restore();
}

void Testbed::drag(const Input& input) {
    frame::GameWorld& world = scene_.world();
    if (input.clicked())
        world.startDrag(input.mouse(), 14.0 / camera_.scale());
    if (world.dragging())
        world.moveMouse(input.mouse());
    if (!input.buttonHeld() && world.dragging())
        world.releaseMouse();
}

/// One slider for every parameter of the scene; letting go of it starts the scene again with the new value.
void Testbed::sliders() {
    for (const scene::Parameter& p : scene_.world().scene().parameters) {
        auto& [low, high] = ranges_.try_emplace(p.name, usefulRange(p)).first->second;
        low = std::min(low, p.value);
        high = std::max(high, p.value);
        double& value = edited_.try_emplace(p.name, p.value).first->second;
        ImGui::AlignTextToFramePadding();
        ImGui::TextUnformatted((p.name + (p.unit == "1" ? "" : ", " + p.unit)).c_str());
        ImGui::SameLine(125.0F);
        ImGui::SetNextItemWidth(135.0F);
        if (ImGui::SliderScalar(("##" + p.name).c_str(), ImGuiDataType_Double, &value, &low, &high,
                                p.integer ? "%.0f" : "%.4g"))
            scene_.set(p.name, p.integer ? std::round(value) : value);
        if (ImGui::IsItemDeactivatedAfterEdit())
            restart_ = true;
        if (ImGui::IsItemHovered() && !p.about.empty())
            ImGui::SetTooltip("%s", p.about.c_str());
    }
}

void Testbed::buttons() {
    const ImVec2 size(82.0F, 0.0F);
    if (ImGui::Button(paused_ ? "Go on (P)" : "Pause (P)", size))
        paused_ = !paused_;
    ImGui::SameLine();
    if (ImGui::Button("Step (.)", size))
        single_ = paused_ = true;
    ImGui::SameLine();
    if (ImGui::Button("Again (R)", size))
        restart_ = true;
    if (ImGui::Button("Save (S)", size))
        scene_.save();
    ImGui::SameLine();
    if (ImGui::Button("Load (L)", size))
        scene_.restore();
    ImGui::SameLine();
    if (ImGui::Button(recorder_.running() ? "Stop rec." : "Record", size)) {
        if (recorder_.running())
            recorder_.stop();
        else
            record(std::filesystem::path(arguments_.scene).stem().string() + ".mp4");
    }
    ImGui::SetNextItemWidth(150.0F);
    ImGui::SliderFloat("speed", &speed_, 0.05F, 4.0F, "%.2f", ImGuiSliderFlags_Logarithmic);
}

void Testbed::panel(double height) {
    ImGui::SetNextWindowPos({0.0F, static_cast<float>(look::top)});
    ImGui::SetNextWindowSize({static_cast<float>(kLeft), static_cast<float>(height - look::top - look::bottom)});
    ImGui::Begin("testbed", nullptr, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
    buttons();
    ImGui::Separator();
    sliders();
    ImGui::Separator();
    int column = 0;
    for (const auto& [name, on] : layers_.all()) {
        if (column++ % 2 == 1)
            ImGui::SameLine(140.0F);
        ImGui::Checkbox(name, on);
    }
    ImGui::Separator();
    double sum = 0.0;
    for (const auto& entry : scene_.profile())
        sum += entry.second;
    ImGui::Text("one frame: %.2f ms in the shells' step", sum);
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {4.0F, 0.0F}); // bars as high as their words
    for (const auto& [name, ms] : scene_.profile()) {
        char text[32];
        std::snprintf(text, sizeof text, "%.3f ms", ms);
        ImGui::ProgressBar(sum > 0.0 ? static_cast<float>(ms / sum) : 0.0F, {150.0F, ImGui::GetTextLineHeight()}, "");
        ImGui::SameLine();
        ImGui::Text("%s %s", name.c_str(), text);
    }
    ImGui::PopStyleVar();
    ImGui::End();
}

void Testbed::draw(picture::ListCanvas& canvas, double width, double height) {
    const frame::View view(canvas, camera_, width, height);
    view.background();
    canvas.pushClip({kLeft, look::top, width - kLeft - kRight, height - look::top - look::bottom});
    drawScene(scene_, view, layers_, 1.0);
    canvas.popClip();
    drawCurves(scene_, canvas,
               {width - kRight + 6.0, look::top + 10.0, kRight - 16.0, height - look::top - look::bottom - 20.0});
    frame::GameWorld& world = scene_.world();
    std::vector<frame::StatusEntry> status{{"phase", world.player().phase()},
                                           {"shells", std::to_string(world.shells().size())},
                                           {"time", frame::number(world.shells().time(), 2) + " s"}};
    if (world.scene().protocol) {
        status.push_back({"travel", frame::number(1e3 * world.player().travel(), 2) + " mm"});
        status.push_back({"force", frame::number(world.player().force(), 3) + " N"});
    }
    const std::string trouble = !scene_.failure().empty() ? scene_.failure() : message_;
    drawStrips(view, world.scene().name, status,
               !trouble.empty()
                   ? trouble
                   : "Drag shells and bodies; B: push away from the mouse; wheel, right drag, F (shells), Home "
                     "(all): camera; Esc: quit");
}

bool interrupted(const Arguments& a) {
    return a.interrupt != nullptr && *a.interrupt;
}

int headless(Testbed& testbed, const Arguments& a, frame::Script& script) {
    Input input;
    std::vector<float> samples;
    if (!a.wav.empty())
        (void)testbed.sound(0.0); // from the first step on
    bool last = false;
    for (int i = 0; !last && !testbed.quit() && testbed.scene().failure().empty(); ++i) {
        last = i + 1 >= a.frames || interrupted(a);
        script.play(static_cast<std::uint64_t>(i), input);
        testbed.turn(input, testbed.camera().pixel(input.mouse()), 0.0, last, a.width, a.height);
        if (!a.wav.empty()) {
            const auto more = testbed.sound(frame::kStep);
            samples.insert(samples.end(), more.begin(), more.end());
        }
        if (!last)
            continue;
        std::string why = a.wav.empty() ? "" : frame::writeWav(a.wav, samples);
        if (why.empty() && !a.png.empty()) {
            graphics::CairoCanvas canvas(a.width, a.height, 1.0);
            testbed.paint(canvas);
            why = frame::writePng(a.png, canvas);
        }
        if (!why.empty()) {
            std::fprintf(stderr, "%s\n", why.c_str());
            return 4;
        }
    }
    testbed.stopRecording();
    const frame::GameWorld& world = testbed.scene().world();
    std::printf("%s: %.4f s, %zu shells, state %016llx\n", world.scene().name.c_str(), world.shells().time(),
                world.shells().size(), static_cast<unsigned long long>(world.shells().hash()));
    if (!testbed.scene().failure().empty())
        std::fprintf(stderr, "%s\n", testbed.scene().failure().c_str());
    return !testbed.scene().failure().empty() ? 3 : interrupted(a) ? 130 : 0;
}

int windowed(Testbed& testbed, const Arguments& a, frame::Script& script) {
    frame::Window window;
    if (const std::string why = window.open(a.width, a.height, "Supercircle: " + testbed.scene().world().scene().name);
        !why.empty()) {
        std::fprintf(stderr, "%s\n", why.c_str());
        return 2;
    }
    Input input;
    for (std::uint64_t i = 0; !testbed.quit() && !interrupted(a); ++i) {
        if (!window.poll(input, [&](graphics::Point p) { return testbed.camera().world(p); }))
            break;
        if (!a.script.empty())
            script.play(i, input);
        const frame::Pointer& pointer = window.pointer();
        if (pointer.wheel != 0.0 && !testbed.wantsMouse())
            testbed.camera().zoom(pointer.wheel > 0.0 ? 1.15 : 1.0 / 1.15, pointer.at);
        testbed.camera().pan(pointer.dragX, pointer.dragY);
        testbed.turn(input, pointer.at, pointer.wheel, true, window.width(), window.height());
        graphics::CairoCanvas panels(window.width(), window.height(), 1.0, graphics::CairoCanvas::Ground::Transparent);
        testbed.paintPanels(panels);
        window.show(testbed.list(), &panels);
    }
    std::printf("%s: %.4f s%s\n", testbed.scene().world().scene().name.c_str(), testbed.scene().world().shells().time(),
                testbed.paused() ? ", paused" : "");
    testbed.stopRecording();
    return interrupted(a) ? 130 : 0;
}

} // namespace

int view(const Arguments& a) {
    std::string error;
    frame::Script script = a.script.empty() ? frame::Script{} : frame::Script::load(a.script, error);
    Testbed testbed(a);
    if (error.empty())
        error = testbed.open();
    if (!error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return 2;
    }
    return a.headless ? headless(testbed, a, script) : windowed(testbed, a, script);
}

} // namespace supercircle::testbed
