#include "plugin/pages/sensitivity/sensitivity_page.h"

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/colour_map.h"
#include "plugin/graphics/page_builder.h"
#include "plugin/graphics/plot.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/graphics/theme.h"
#include "plugin/recording/table/rounded.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace supercircle::cli {

namespace {

using record::fixed;
using record::rounded;

using graphics::AxisRange;
using graphics::Canvas;
using graphics::Colour;
using graphics::Plot;
using graphics::PlotStyle;
using sensitivity::Quality;
using sensitivity::RunSensitivity;
using sensitivity::Sensitivities;
namespace theme = graphics::theme;

constexpr double kWidth = 1180.0, kHeight = 520.0; // px

/// Distinguishable colours (P. Tol's "bright" and "muted" schemes), strongest effect first.
constexpr std::array kColours = {Colour::hex(0x4477AA), Colour::hex(0xEE6677), Colour::hex(0x228833),
                                 Colour::hex(0xCCBB44), Colour::hex(0xAA3377), Colour::hex(0x66CCEE),
                                 Colour::hex(0x882255), Colour::hex(0x999933), Colour::hex(0x332288),
                                 Colour::hex(0x44AA99), Colour::hex(0xDDCC77), Colour::hex(0x88CCEE)};

struct Curve {
    std::size_t column = 0;
    std::vector<double> force; ///< change for the column's scale, N; NaN: not usable
    double most = 0.0;
};

/// Effect of each column on the force, strongest first, without those below noise.
std::vector<Curve> curvesOf(const Sensitivities& s, const RunSensitivity& run) {
    std::vector<Curve> curves;
    for (std::size_t c = 0; c < s.columns.size(); ++c) {
        if (run.quality[c].belowNoise || !run.quality[c].failure.empty())
            continue;
        const auto at = static_cast<Eigen::Index>(c);
        Curve curve{c, {}, 0.0};
        for (Eigen::Index i = 0; i < run.force.rows(); ++i) {
            curve.force.push_back(run.usable(i, at) ? run.force(i, at) * s.columns[c].scale
                                                    : std::numeric_limits<double>::quiet_NaN());
            if (std::isfinite(curve.force.back()))
                curve.most = std::max(curve.most, std::abs(curve.force.back()));
        }
        curves.push_back(std::move(curve));
    }
    std::stable_sort(curves.begin(), curves.end(), [](const Curve& a, const Curve& b) { return a.most > b.most; });
    return curves;
}

/// Force above; below it the change for each parameter by its scale.
void drawRun(Canvas& canvas, const Sensitivities& s, const RunSensitivity& run) {
    const std::vector<double>& time = run.base.readings.time;
    const std::vector<Curve> curves = curvesOf(s, run);
    double peak = 0.0;
    AxisRange force{0.0, 0.0}, change{0.0, 0.0};
    for (const double f : run.base.readings.force) {
        force = {std::min(force.lo, f), std::max(force.hi, f)};
        peak = std::max(peak, std::abs(f));
    }
    for (const Curve& c : curves)
        for (const double v : c.force)
            if (std::isfinite(v))
                change = {std::min(change.lo, v), std::max(change.hi, v)};
    const AxisRange span = graphics::padded({time.front(), time.back()}, 0.01);
    const graphics::DisplayUnit unit = graphics::readableUnit(peak, "N");
    const graphics::DisplayUnit fine = graphics::readableUnit(std::max(-change.lo, change.hi), "N");

    const Plot upper({90.0, 20.0, 790.0, 130.0}, span, graphics::padded(force, 0.05));
    PlotStyle style;
    style.x = {"", 1.0};
    style.y = {"force (" + unit.text + ")", unit.factor};
    style.yTicks = 4;
    upper.drawFrame(canvas, style);
    canvas.pushClip(upper.area);
    upper.drawLine(canvas, time, run.base.readings.force, {theme::ink, 1.4});
    canvas.popClip();

    const Plot lower({90.0, 190.0, 790.0, 270.0}, span, graphics::padded(change, 0.05));
    style.x = {"time (s)", 1.0};
    style.y = {"change (" + fine.text + ")", fine.factor};
    style.yTicks = 7;
    lower.drawFrame(canvas, style);
    canvas.pushClip(lower.area);
    for (std::size_t i = curves.size(); i-- > 0;)
        lower.drawLine(canvas, time, curves[i].force, {kColours[i % kColours.size()], 1.6});
    canvas.popClip();

    double y = 36.0;
    canvas.text({905.0, y - 8.0}, "change of the force for", {theme::labelSize, theme::muted});
    for (std::size_t i = 0; i < curves.size(); ++i) {
        y += 32.0;
        const sensitivity::Column& c = s.columns[curves[i].column];
        canvas.line({905.0, y - 4.0}, {929.0, y - 4.0}, {kColours[i % kColours.size()], 2.6});
        canvas.text({937.0, y}, c.name, {theme::labelSize, theme::ink});
        canvas.text({937.0, y + 13.0}, "+" + rounded(c.scale, 3) + (c.unit == "1" ? "" : " " + c.unit),
                    {theme::tickSize, theme::muted});
    }
}

/// Matrix of cosines between columns, without those below noise everywhere.
void drawSimilarity(Canvas& canvas, const Sensitivities& s, const Eigen::MatrixXd& cosines,
                    const std::vector<Eigen::Index>& shown) {
    constexpr double kCell = 46.0, kLeft = 190.0, kTop = 20.0;
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const double y = kTop + kCell * static_cast<double>(i);
        canvas.text({kLeft - 10.0, y + 0.62 * kCell}, s.columns[static_cast<std::size_t>(shown[i])].name,
                    {theme::labelSize, theme::ink, graphics::Anchor::End});
        canvas.text(
            {kLeft + kCell * (static_cast<double>(i) + 0.62), kTop + kCell * static_cast<double>(shown.size()) + 10.0},
            s.columns[static_cast<std::size_t>(shown[i])].name,
            {theme::labelSize, theme::ink, graphics::Anchor::End, false, -60.0});
        for (std::size_t j = 0; j < shown.size(); ++j) {
            const double v = cosines(shown[i], shown[j]);
            const double x = kLeft + kCell * static_cast<double>(j);
            canvas.rectangle({x, y, kCell - 2.0, kCell - 2.0}, {.fill = graphics::signedColour(v)});
            canvas.text({x + 0.48 * kCell, y + 0.6 * kCell}, fixed(v, 2),
                        {theme::tickSize, std::abs(v) > 0.6 ? theme::paper : theme::ink, graphics::Anchor::Middle});
        }
    }
}

std::string table(const Sensitivities& s, const RunSensitivity& run) {
    std::string html = "<table><tr><th>parameter</th><th>step</th><th>signal / noise</th><th>two-step error</th>"
                       "<th>remarks</th></tr>";
    for (std::size_t c = 0; c < s.columns.size(); ++c) {
        const Quality& q = run.quality[c];
        std::string remarks = q.failure.empty() ? "" : graphics::escaped(q.failure);
        const auto remark = [&](bool is, const std::string& words) {
            if (is)
                remarks += (remarks.empty() ? "" : "; ") + words;
        };
        remark(q.belowNoise && q.failure.empty(), "below the solver noise");
        remark(q.oneSided, "one-sided");
        remark(q.changesJumps, "shifts jumps by up to " + fixed(q.jumpShift, 1) + " samples, or adds or removes some");
        html += "<tr><td>" + graphics::escaped(s.columns[c].name) + "</td><td>" + rounded(q.step, 3) + " " +
                graphics::escaped(s.columns[c].unit) + "</td><td>" + fixed(q.signal, 1) + "</td><td>" +
                (q.belowNoise ? "" : fixed(100.0 * q.twoStepError, 1) + " %") + "</td><td>" + remarks + "</td></tr>";
    }
    return html + "</table>";
}

std::string landmarkRows(const Sensitivities& s, const RunSensitivity& run) {
    std::string html = "<table><tr><th>landmark</th><th>value</th>";
    for (const sensitivity::Column& c : s.columns)
        html += "<th>" + graphics::escaped(c.name) + "</th>";
    html += "</tr>";
    for (std::size_t i = 0; i < run.landmarks.names.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        html += "<tr><td>" + graphics::escaped(run.landmarks.names[i]) + "</td><td>" +
                rounded(run.landmarks.values[i], 4) + " " + run.landmarks.units[i] + "</td>";
        for (std::size_t c = 0; c < s.columns.size(); ++c) {
            const auto at = static_cast<Eigen::Index>(c);
            const double d = run.landmarkJacobian(row, at) * s.columns[c].scale;
            const double e = run.landmarkError(row, at) * s.columns[c].scale;
            html += "<td>" + (!(std::abs(d) > e) ? std::string("·") : rounded(d, 2)) + "</td>";
        }
        html += "</tr>";
    }
    return html + "</table>";
}

using Files = std::vector<record::NamedText>;

/// A drawing as SVG text; the PNG is added to `files`. Empty after an error, which is in `error`.
template <class Draw>
std::string picture(const std::string& name, double width, double height, const std::string& label, Draw&& draw,
                    Files& files, std::string& error) {
    graphics::CairoCanvas png(width, height, 1.5);
    draw(png);
    auto pixels = png.png();
    if (!pixels) {
        error = name + ".png: " + pixels.error();
        return {};
    }
    files.emplace_back(name + ".png", *std::move(pixels));
    graphics::SvgCanvas svg(width, height, name, label);
    draw(svg);
    return "<div class=\"scroll wide\">" + svg.finish() + "</div>";
}

} // namespace

Result<Files> sensitivityPages(const SensitivityStudy& study) {
    const Sensitivities& s = study.result;
    Files files;
    std::string error;
    graphics::PageBuilder page("Sensitivities of " + study.experiment.file);
    page.plainTables().introduction("<p>" + graphics::escaped(study.experiment.description) + "</p>");
    for (std::size_t r = 0; r < s.runs.size() && error.empty(); ++r) {
        const RunSensitivity& run = s.runs[r];
        if (run.base.readings.time.empty())
            continue;
        const std::string name = study.runName(r);
        page.section(name,
                     picture(
                         name + "_sensitivity", kWidth, kHeight, "effect of each parameter on the force of " + name,
                         [&](Canvas& canvas) { drawRun(canvas, s, run); }, files, error) +
                         table(s, run) + "<h3>Landmarks, and their change for each parameter by its scale</h3>" +
                         "<div class=\"scroll wide\">" + landmarkRows(s, run) + "</div>");
    }
    std::vector<Eigen::Index> shown;
    const Eigen::MatrixXd cosines = sensitivity::similarity(s);
    for (Eigen::Index c = 0; c < cosines.rows(); ++c)
        if (cosines(c, c) > 0.0)
            shown.push_back(c);
    const double side = 46.0 * static_cast<double>(shown.size());
    page.section("Similarity",
                 "<p>Cosine between the effects of two parameters on the "
                 "force: 1 or -1 means that one can compensate the other.</p>" +
                     picture(
                         "similarity", 210.0 + side, 170.0 + side, "similarity of parameters",
                         [&](Canvas& canvas) { drawSimilarity(canvas, s, cosines, shown); }, files, error) +
                     "<p>" + std::to_string(s.simulations) + " simulations with " +
                     std::to_string(study.resolution.elements) + " elements a specimen.</p>");
    if (!error.empty())
        return Result<Files>::failure(error);
    files.emplace_back("sensitivity.html", page.html());
    return files;
}

} // namespace supercircle::cli
