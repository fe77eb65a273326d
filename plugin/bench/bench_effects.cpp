// The picture of the effects page: a shell pushed over a cylinder and pulled back (scenes/effects.json), with and
// without each effect of the catalogue; `supercircle bench --filter effects`.

#include "plugin/bench/bench.h"
#include "plugin/bench/bench_scene_run.h"
#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/plot.h"
#include "plugin/graphics/theme.h"
#include "plugin/recording/table/files.h"
#include "supercircle/effects/effect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace supercircle::cli {

namespace {

namespace theme = graphics::theme;

/// The scene parameter of an effect, with a clearly visible value.
struct ShownEffect {
    const char* key;
    const char* parameter;
    double value;
    const char* size;
};
constexpr std::array kShown = {
    ShownEffect{"viscoelastic_bending", "viscosity", 0.15, "eta / B = 0.15 s"},
    ShownEffect{"nonlinear_elasticity", "knee", 15.0, "softening, knee 15 1/m"},
    ShownEffect{"plasticity", "yield", 8.0, "M_y / B = 8 1/m"},
    ShownEffect{"local_damage", "stiffness_drop", 0.9, "B - 90 % at one place"},
    ShownEffect{"natural_curvature_defect", "flattening", -10.0, "- 10 1/m at one place"},
    ShownEffect{"stiffness_gradient", "gradient", 0.5, "thickness +- 50 % to the ends"},
    ShownEffect{"softening_over_time", "softening", 0.25, "B - 25 %, within 5 s"},
    ShownEffect{"static_friction_excess", "static_ratio", 3.0, "mu_s / mu_k = 3: shows after rests"},
    ShownEffect{"rate_dependent_friction", "stribeck", -0.5, "- 50 % when fast"},
    ShownEffect{"wear", "wear_change", 0.8, "+ 80 % in the end"},
    ShownEffect{"adhesion", "attraction", 8.0, "8 N/m"},
    ShownEffect{"contact_compliance", "contact_give", 0.002, "2 mm/N"},
    ShownEffect{"planar_drag", "drag", 0.15, "0.15 N/m"},
    ShownEffect{"gravity", "sideways", 10.0, "10 m/s^2, sideways: a light shell"},
    ShownEffect{"machine_compliance", "machine_stiffness", 60.0, "60 N/m"},
    ShownEffect{"backlash", "play", 0.001, "1 mm"},
    ShownEffect{"misalignment", "offset", 0.002, "2 mm"},
    ShownEffect{"sensor_drift", "drift", 0.02, "20 mN, within 5 s"},
    ShownEffect{"sensor_gain", "gain_error", 0.15, "+ 15 %"},
    ShownEffect{"sensor_delay", "delay", 0.3, "0.3 s"},
};

struct ForceCurve {
    std::vector<double> displacement, force; ///< m, N
};

constexpr std::size_t kAcross = 4;
constexpr double kPanelWidth = 220.0, kPanelHeight = 130.0, kLeft = 46.0, kTop = 64.0, kGapX = 54.0, kGapY = 66.0;
constexpr double kWidth = kLeft + kAcross * (kPanelWidth + kGapX);
constexpr double kHeight = kTop + (kShown.size() + kAcross - 1) / kAcross * (kPanelHeight + kGapY);

std::string simulate(const std::vector<std::string>& parameters, ForceCurve& curve) {
    lab::RunResult out;
    if (std::string why = runBenchmarkScene("effects", parameters, {}, out); !why.empty())
        return why;
    if (out.status != lab::RunStatus::Done)
        return "interrupted";
    const auto column = [&](const char* name) { return out.recording.series.find(name); };
    const std::vector<double>*x = column("displacement_m"), *y = column("force_N");
    if (x == nullptr || y == nullptr)
        return "the scene of the effects records no force";
    curve = {*x, *y};
    return {};
}

graphics::AxisRange extent(const std::vector<double>& values) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    return values.empty() ? graphics::AxisRange{0.0, 0.0} : graphics::AxisRange{*least, *most};
}

void drawPanel(graphics::Canvas& canvas, std::size_t i, const ForceCurve& without, const ForceCurve& with) {
    const double x = kLeft + (kPanelWidth + kGapX) * static_cast<double>(i % kAcross);
    const double y = kTop + (kPanelHeight + kGapY) * static_cast<double>(i / kAcross);
    const graphics::AxisRange usual = extent(without.force), now = extent(with.force),
                              travel = extent(without.displacement), travelNow = extent(with.displacement);
    // A defect jumps into its shape at the start: force peaks that would compress the rest of the curve.
    const double reach = 0.4 * usual.span();
    const graphics::AxisRange force{std::min(usual.lo, std::max(now.lo, usual.lo - reach)),
                                    std::max(usual.hi, std::min(now.hi, usual.hi + reach))};
    const graphics::AxisRange across{std::min(travel.lo, travelNow.lo), std::max(travel.hi, travelNow.hi)};
    const graphics::Plot plot({x, y, kPanelWidth, kPanelHeight}, graphics::padded(across, 0.03),
                              graphics::padded(force, 0.06));
    graphics::PlotStyle style;
    style.x = {"", 1e3};
    style.y = {"", 1e3};
    style.xTicks = 5;
    style.yTicks = 4;
    plot.drawFrame(canvas, style);
    canvas.pushClip(plot.area);
    plot.drawLine(canvas, without.displacement, without.force, {theme::muted, 1.4});
    plot.drawLine(canvas, with.displacement, with.force, {theme::unloading, 1.8});
    canvas.popClip();
    canvas.text({x, y - 20.0}, kShown[i].key, {theme::labelSize, theme::ink, graphics::Anchor::Start, true});
    canvas.text({x, y - 6.0}, kShown[i].size, {theme::tickSize, theme::muted});
}

/// Empty, or why there is no picture.
std::string draw(graphics::Canvas& canvas, std::vector<double>& milliseconds) {
    canvas.text({kLeft, 22.0},
                "Force (mN) over displacement (mm): a shell pushed over a cylinder and pulled back, with the effect "
                "(blue) and without (grey)",
                {theme::labelSize, theme::ink});
    ForceCurve without;
    if (std::string why = simulate({}, without); !why.empty())
        return why;
    for (std::size_t i = 0; i < kShown.size(); ++i) {
        ForceCurve with;
        std::string why;
        const std::string parameter = std::string(kShown[i].parameter) + "=" + std::to_string(kShown[i].value);
        milliseconds.push_back(timed([&] { why = simulate({parameter}, with); }));
        if (!why.empty())
            return std::string(kShown[i].key) + ": " + why;
        drawPanel(canvas, i, without, with);
    }
    return {};
}

} // namespace

void addEffectsPicture(std::vector<Benchmark>& all) {
    Benchmark b;
    b.names = {"effects"};
    b.onRequest = true;
    const auto files = std::make_shared<std::vector<record::NamedText>>();
    b.measure = [files](const auto&, const auto& done) {
        graphics::CairoCanvas canvas(kWidth, kHeight, 1.5);
        std::vector<double> milliseconds;
        if (std::string why = draw(canvas, milliseconds); !why.empty())
            return why;
        const auto png = canvas.png();
        if (!png)
            return png.error();
        files->push_back({"effects.png", *png});
        done(summarise("effects", std::move(milliseconds)));
        return std::string();
    };
    b.finish = writesPictures(files, "effects.png");
    all.push_back(std::move(b));
}

} // namespace supercircle::cli
