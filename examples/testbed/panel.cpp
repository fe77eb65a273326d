#include "examples/testbed/panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace supercircle::testbed {

namespace {

const char* const kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"; ///< as Cairo's here; else ImGui's own

struct Target {
    graphics::CairoCanvas::Pixels pixels;
    const unsigned char* glyphs;
    int glyphsWidth, glyphsHeight;
};

double channel(ImU32 colour, int shift) {
    return static_cast<double>((colour >> shift) & 255U);
}

/// Twice the signed area of a, b, p.
double side(const ImVec2& a, const ImVec2& b, double x, double y) {
    const double ax = static_cast<double>(a.x), ay = static_cast<double>(a.y);
    return (static_cast<double>(b.x) - ax) * (y - ay) - (static_cast<double>(b.y) - ay) * (x - ax);
}

/// Which of two triangles owns a pixel centre that lies exactly on their common edge.
bool owns(const ImVec2& a, const ImVec2& b) {
    return a.y > b.y || (a.y == b.y && a.x < b.x);
}

void blend(const Target& t, int x, int y, const double rgba[4]) {
    auto* pixel =
        reinterpret_cast<std::uint32_t*>(t.pixels.data + static_cast<std::ptrdiff_t>(y) * t.pixels.stride) + x;
    const double a = rgba[3] / 255.0;
    std::uint32_t out = 0;
    for (int c = 0; c < 4; ++c) { // blue, green, red, alpha
        const double old = static_cast<double>((*pixel >> (8 * c)) & 255U), full = c < 3 ? rgba[2 - c] : 255.0;
        out |= static_cast<std::uint32_t>(std::lround(old + a * (full - old))) << (8 * c);
    }
    *pixel = out;
}

/// Pixel centres inside the triangle and the clip box; colours and texture between the corners, barycentric.
void triangle(const Target& t, ImDrawVert v[3], const ImVec4& clip) {
    if (side(v[0].pos, v[1].pos, static_cast<double>(v[2].pos.x), static_cast<double>(v[2].pos.y)) < 0.0)
        std::swap(v[1], v[2]);
    const double area = side(v[0].pos, v[1].pos, static_cast<double>(v[2].pos.x), static_cast<double>(v[2].pos.y));
    if (!(area > 0.0))
        return;
    const auto low = [](float a, float b, float c, float limit) {
        return static_cast<int>(std::floor(std::max(std::min({a, b, c}), limit)));
    };
    const auto high = [](float a, float b, float c, float limit) {
        return static_cast<int>(std::ceil(std::min(std::max({a, b, c}), limit)));
    };
    const int x0 = std::max(0, low(v[0].pos.x, v[1].pos.x, v[2].pos.x, clip.x));
    const int y0 = std::max(0, low(v[0].pos.y, v[1].pos.y, v[2].pos.y, clip.y));
    const int x1 = std::min(t.pixels.width, high(v[0].pos.x, v[1].pos.x, v[2].pos.x, clip.z));
    const int y1 = std::min(t.pixels.height, high(v[0].pos.y, v[1].pos.y, v[2].pos.y, clip.w));
    const bool own[3] = {owns(v[1].pos, v[2].pos), owns(v[2].pos, v[0].pos), owns(v[0].pos, v[1].pos)};
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
            const double px = x + 0.5, py = y + 0.5;
            const double w[3] = {side(v[1].pos, v[2].pos, px, py), side(v[2].pos, v[0].pos, px, py),
                                 side(v[0].pos, v[1].pos, px, py)};
            bool inside = true;
            for (int i = 0; i < 3; ++i)
                inside = inside && (w[i] > 0.0 || (w[i] == 0.0 && own[i]));
            if (!inside)
                continue;
            double rgba[4] = {0, 0, 0, 0}, u = 0.0, s = 0.0;
            for (int i = 0; i < 3; ++i) {
                const double k = w[i] / area;
                rgba[0] += k * channel(v[i].col, IM_COL32_R_SHIFT);
                rgba[1] += k * channel(v[i].col, IM_COL32_G_SHIFT);
                rgba[2] += k * channel(v[i].col, IM_COL32_B_SHIFT);
                rgba[3] += k * channel(v[i].col, IM_COL32_A_SHIFT);
                u += k * static_cast<double>(v[i].uv.x);
                s += k * static_cast<double>(v[i].uv.y);
            }
            const int gx = std::clamp(static_cast<int>(u * t.glyphsWidth), 0, t.glyphsWidth - 1);
            const int gy = std::clamp(static_cast<int>(s * t.glyphsHeight), 0, t.glyphsHeight - 1);
            rgba[3] *= static_cast<double>(t.glyphs[gy * t.glyphsWidth + gx]) / 255.0;
            if (rgba[3] > 0.0)
                blend(t, x, y, rgba);
        }
}

void style() {
    ImGui::StyleColorsDark();
    ImGuiStyle& s = ImGui::GetStyle();
    s.WindowRounding = s.FrameRounding = s.GrabRounding = 3.0F;
    s.AntiAliasedLines = s.AntiAliasedFill = s.AntiAliasedLinesUseTex = false;
    s.FrameBorderSize = 1.0F;
    s.WindowPadding = {14.0F, 10.0F};
    s.ItemSpacing = {8.0F, 5.0F};
    const auto set = [&](ImGuiCol which, unsigned rgb, float alpha = 1.0F) {
        s.Colors[which] = {static_cast<float>((rgb >> 16) & 255U) / 255.0F,
                           static_cast<float>((rgb >> 8) & 255U) / 255.0F, static_cast<float>(rgb & 255U) / 255.0F,
                           alpha};
    };
    set(ImGuiCol_WindowBg, 0x1d232d);
    set(ImGuiCol_Text, 0xe9edf2);
    set(ImGuiCol_Border, 0x3a4452);
    set(ImGuiCol_FrameBg, 0x151a22);
    set(ImGuiCol_FrameBgHovered, 0x2a3442);
    set(ImGuiCol_FrameBgActive, 0x34445a);
    set(ImGuiCol_Button, 0x2c3a4d);
    set(ImGuiCol_ButtonHovered, 0x38506e);
    set(ImGuiCol_ButtonActive, 0x456890);
    set(ImGuiCol_SliderGrab, 0x6fb4ff);
    set(ImGuiCol_SliderGrabActive, 0xa9d2ff);
    set(ImGuiCol_CheckMark, 0x6fb4ff);
    set(ImGuiCol_PlotHistogram, 0x6fb4ff);
    set(ImGuiCol_PopupBg, 0x1d232d);
}

} // namespace

PanelContext::PanelContext() {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    std::error_code ignored;
    if (std::filesystem::exists(kFont, ignored))
        io.Fonts->AddFontFromFileTTF(kFont, 13.0F);
    io.Fonts->GetTexDataAsAlpha8(&glyphs_, &glyphsWidth_, &glyphsHeight_);
    io.Fonts->SetTexID(nullptr);
    style();
}

PanelContext::~PanelContext() {
    ImGui::DestroyContext();
}

void PanelContext::begin(double width, double height, graphics::Point mouse, bool button, double wheel) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
    io.DeltaTime = 1.0F / 60.0F; // scripts must not depend on the clock
    io.MousePos = {static_cast<float>(mouse.x), static_cast<float>(mouse.y)};
    io.MouseDown[0] = button;
    io.MouseWheel = static_cast<float>(wheel);
    ImGui::NewFrame();
}

bool PanelContext::wantsMouse() const {
    return ImGui::GetIO().WantCaptureMouse;
}

void PanelContext::skip() {
    ImGui::EndFrame();
}

void PanelContext::end() {
    ImGui::Render();
}

void PanelContext::draw(const graphics::CairoCanvas& picture) {
    const ImDrawData* data = ImGui::GetDrawData();
    const Target target{picture.pixels(), glyphs_, glyphsWidth_, glyphsHeight_};
    if (target.pixels.data == nullptr)
        return;
    for (int n = 0; n < data->CmdListsCount; ++n) {
        const ImDrawList& list = *data->CmdLists[n];
        for (const ImDrawCmd& cmd : list.CmdBuffer)
            for (unsigned i = 0; i + 2 < cmd.ElemCount; i += 3) {
                ImDrawVert v[3];
                for (unsigned k = 0; k < 3; ++k)
                    v[k] = list.VtxBuffer[static_cast<int>(cmd.VtxOffset +
                                                           list.IdxBuffer[static_cast<int>(cmd.IdxOffset + i + k)])];
                triangle(target, v, cmd.ClipRect);
            }
    }
    picture.markDirty();
}

} // namespace supercircle::testbed
