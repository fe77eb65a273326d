// Numbers of a sweep against its parameters, and cycle by cycle.

#include "plugin/pages/sweep/sweep_figures.h"

#include "plugin/graphics/plot.h"
#include "plugin/graphics/theme.h"
#include "plugin/lab/sweep/statistics.h"
#include "plugin/pages/run/key_labels.h"
#include "plugin/pages/sweep/sweep_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supercircle::pages {

namespace {

using graphics::Anchor;
using graphics::AxisRange;
using graphics::Canvas;
using graphics::Colour;
using graphics::Plot;
using graphics::PlotStyle;
using graphics::Point;
using graphics::Rect;
namespace theme = graphics::theme;

/// Height over R of thirty circles in hexagonal packing (paper, supplement): the limit of H0/R for closed shells.
const double kHexagonal = 2.0 + 6.0 * std::sqrt(3.0);

struct MeanMark {
    double x = 0.0, mean = 0.0, spread = 0.0, error = 0.0;
};

struct TrendCurve {
    std::string label;
    Colour colour;
    std::vector<MeanMark> marks;
};

AxisRange rangeOf(const std::vector<TrendCurve>& curves, double level) {
    AxisRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const TrendCurve& c : curves)
        for (const MeanMark& m : c.marks)
            range = {std::min(range.lo, m.mean - m.spread), std::max(range.hi, m.mean + m.spread)};
    if (std::isfinite(level))
        range = {std::min(range.lo, level), std::max(range.hi, level)};
    if (range.lo > 0.0 && range.lo < 0.6 * range.hi) // close to zero: show zero
        range.lo = 0.0;
    return range.lo == 0.0 ? AxisRange{0.0, 1.06 * range.hi} : graphics::padded(range, 0.07);
}

void drawCurve(Canvas& canvas, const Plot& plot, const TrendCurve& curve, double shift) {
    std::vector<Point> line;
    for (const MeanMark& m : curve.marks) {
        Point p = plot.at(m.x, m.mean);
        p.x += shift;
        line.push_back(p);
        const double top = plot.at(m.x, m.mean + m.spread).y, bottom = plot.at(m.x, m.mean - m.spread).y;
        const double high = plot.at(m.x, m.mean + m.error).y, low = plot.at(m.x, m.mean - m.error).y;
        canvas.line({p.x, top}, {p.x, bottom}, {curve.colour.alpha(0.55), 1.2});
        canvas.line({p.x - 3.5, top}, {p.x + 3.5, top}, {curve.colour.alpha(0.55), 1.2});
        canvas.line({p.x - 3.5, bottom}, {p.x + 3.5, bottom}, {curve.colour.alpha(0.55), 1.2});
        canvas.line({p.x, high}, {p.x, low}, {curve.colour, 4.0});
    }
    canvas.path(line, false, {.stroke = graphics::Stroke{curve.colour, 1.6}});
    for (const Point& p : line)
        canvas.circle(p, 4.2, {.fill = curve.colour, .stroke = graphics::Stroke{theme::paper, 1.2}});
}

void drawCurves(Canvas& canvas, const Rect& area, const std::vector<TrendCurve>& curves, const PlotStyle& style,
                double level, const std::string& levelText) {
    std::vector<double> xs;
    for (const TrendCurve& c : curves)
        for (const MeanMark& m : c.marks)
            xs.push_back(m.x);
    if (xs.empty())
        return;
    const auto [least, most] = std::minmax_element(xs.begin(), xs.end());
    const Plot plot(area, graphics::padded({*least, *most}, 0.06), rangeOf(curves, level));
    plot.drawFrame(canvas, style);
    if (std::isfinite(level)) {
        const double y = plot.at(0.0, level).y;
        canvas.line({area.x, y}, {area.right(), y}, {theme::muted, 1.2, {6.0, 4.0}});
        canvas.text({area.x + 8.0, y - 6.0}, levelText, {theme::tickSize, theme::muted});
    }
    for (std::size_t i = 0; i < curves.size(); ++i) // shifted, so that bars do not hide each other
        drawCurve(canvas, plot, curves[i],
                  3.0 * (static_cast<double>(i) - 0.5 * static_cast<double>(curves.size() - 1)));
}

constexpr double kLegendRow = 18.0;

/// Places of the entries beside `left`, in rows that end before `right`.
std::vector<Point> legendPlaces(const std::vector<TrendCurve>& curves, double left, double right, double y) {
    std::vector<Point> places;
    double x = left;
    for (const TrendCurve& c : curves) {
        const double width = 46.0 + graphics::textWidth(c.label, theme::labelSize);
        if (!c.label.empty() && x > left && x + width - 18.0 > right) {
            x = left;
            y += kLegendRow;
        }
        places.push_back({x, y});
        x += c.label.empty() ? 0.0 : width;
    }
    return places;
}

void drawLegend(Canvas& canvas, const std::vector<TrendCurve>& curves, const std::vector<Point>& places) {
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const auto [x, y] = places[i];
        if (curves[i].label.empty())
            continue;
        canvas.line({x, y - 4.0}, {x + 22.0, y - 4.0}, {curves[i].colour, 2.4});
        canvas.text({x + 28.0, y}, curves[i].label, {theme::labelSize, theme::ink});
    }
}

/// The limit holds for thirty shells in the paper's box.
bool asManyAsInThePaper(const sweep::SweepDefinition& sweep) {
    for (const sweep::ParameterValue& s : sweep.parameterValues(0))
        if (s.first == "shells" || s.first == "width")
            return false;
    return true;
}

std::vector<TrendCurve> trendsOf(const sweep::SweepDefinition& sweep, const sweep::RunTable& table,
                                 const std::string& quantity, const std::string& only) {
    std::vector<TrendCurve> curves;
    for (const SweepGroup& g : groupsOf(sweep)) {
        if (!only.empty() && g.label != only)
            continue;
        TrendCurve curve{g.label, g.colour, {}};
        for (std::size_t i = 0; i < g.sets.size(); ++i) {
            const sweep::Statistics s = sweep::statisticsOf(sweep::valuesOf(table, g.sets[i], table.column(quantity)));
            if (s.n > 0)
                curve.marks.push_back({g.x[i], s.mean, s.madSigma, s.n > 1 ? s.standardError : 0.0});
        }
        curves.push_back(std::move(curve));
    }
    return curves;
}

} // namespace

std::vector<std::string> mainQuantities(const sweep::RunTable& table) {
    static constexpr std::array kMainQuantities = {"H0_over_R",
                                                   "delta_max_over_R",
                                                   "dissipation_ratio",
                                                   "snap_fits",
                                                   "max_force_drop_R2_over_B",
                                                   "max_energy_release_R_over_B",
                                                   "energy_friction_J",
                                                   "plate_work_J",
                                                   "peak_force_R2_over_B",
                                                   "pull_off_force_R2_over_B",
                                                   "tip_x_over_L",
                                                   "tip_y_over_L",
                                                   "creep_speed_m_s"};
    // Stacks are squeezed to one force: their peak force carries no information.
    const bool stack = table.column("H0_over_R") < table.columns.size();
    std::vector<std::string> names;
    for (const char* name : kMainQuantities) {
        const std::size_t column = table.column(name);
        if (column == table.columns.size() || (stack && std::string(name).find("_force_") != std::string::npos))
            continue;
        double least = std::numeric_limits<double>::infinity(), most = -least;
        for (const sweep::Row& row : table.rows)
            if (const double v = row.number(column); std::isfinite(v) && row.status == "done") {
                least = std::min(least, v);
                most = std::max(most, v);
            }
        if (least < most)
            names.emplace_back(name);
    }
    return names;
}

SweepFigure trendFigure(const sweep::SweepDefinition& sweep, const sweep::RunTable& table, const std::string& quantity,
                        const std::string& only) {
    SweepFigure figure;
    figure.name = quantity;
    figure.title = quantityLabel(quantity) + (only.empty() ? "" : ", " + only);
    figure.caption = "Mean with its standard error (thick) and the spread of single runs, 1.4826 MAD (thin).";
    figure.width = 620.0;
    const std::vector<TrendCurve> curves = trendsOf(sweep, table, quantity, only);
    const std::vector<Point> places = legendPlaces(curves, 80.0, 610.0, 24.0);
    const double top = 16.0 + (places.empty() ? 24.0 : places.back().y);
    figure.height = 390.0 + top;
    figure.draw = [curves, places, top, x = parameterLabel(sweep.x), y = quantityLabel(quantity),
                   height = quantity == "H0_over_R" && asManyAsInThePaper(sweep)](Canvas& canvas) {
        PlotStyle style;
        style.x = {x, 1.0};
        style.y = {y, 1.0};
        drawLegend(canvas, curves, places);
        drawCurves(canvas, {80.0, top, 520.0, 330.0}, curves, style,
                   height ? kHexagonal : std::numeric_limits<double>::quiet_NaN(),
                   "hexagonal packing of circles, 2 + 6√3");
    };
    return figure;
}

SweepFigure cyclesFigure(const sweep::SweepDefinition& sweep, const sweep::RunTable& table) {
    struct CyclePanel {
        std::string label;
        std::vector<TrendCurve> curves;
    };
    static constexpr std::array kLabels = {"working distance, Δmax (R)", "dissipation ratio, η", "snap-fits",
                                           "dissipated (mJ)"};
    const auto value = [](const record::Cycle& c, std::size_t which) {
        return which == 0   ? c.delta_max_over_R
               : which == 1 ? c.dissipation_ratio
               : which == 2 ? static_cast<double>(c.snap_fits)
                            : 1e3 * c.dissipated_J;
    };
    std::vector<CyclePanel> panels;
    const std::vector<SweepGroup> groups = groupsOf(sweep);
    for (std::size_t which = 0; which < kLabels.size(); ++which) {
        CyclePanel panel{kLabels[which], {}};
        for (const SweepGroup& g : groups)
            for (std::size_t i = 0; i < g.sets.size(); ++i) {
                const double share =
                    g.sets.size() > 1 ? static_cast<double>(i) / static_cast<double>(g.sets.size() - 1) : 0.0;
                TrendCurve curve{parameterLabel(sweep.x) + " = " + shortNumber(g.x[i]) +
                                     (g.label.empty() ? "" : ", " + g.label),
                                 groups.size() == 1 ? Colour{0.15 + 0.7 * share, 0.35, 0.75 - 0.55 * share, 1.0}
                                                    : g.colour.alpha(1.0 - 0.6 * share),
                                 {}};
                for (std::size_t cycle = 0;; ++cycle) {
                    std::vector<double> values;
                    for (const sweep::Row& row : table.rows)
                        if (row.set == g.sets[i] && row.status == "done" && row.cycles.size() > cycle)
                            values.push_back(value(row.cycles[cycle], which));
                    if (values.empty())
                        break;
                    const sweep::Statistics s = sweep::statisticsOf(values);
                    curve.marks.push_back(
                        {static_cast<double>(cycle + 1), s.mean, s.madSigma, s.n > 1 ? s.standardError : 0.0});
                }
                panel.curves.push_back(std::move(curve));
            }
        panels.push_back(std::move(panel));
    }
    SweepFigure figure;
    const bool several = std::any_of(panels.front().curves.begin(), panels.front().curves.end(),
                                     [](const TrendCurve& c) { return c.marks.size() > 1; });
    if (!several)
        return figure;
    figure.name = "cycles";
    figure.title = "Cycle by cycle";
    figure.caption =
        "Mean over the runs of a set with its standard error (thick) and the spread of single runs (thin).";
    figure.width = 1180.0;
    figure.height = 800.0;
    std::size_t most = 0;
    for (const TrendCurve& c : panels.front().curves)
        most = std::max(most, c.marks.size());
    figure.draw = [panels, most](Canvas& canvas) {
        drawLegend(canvas, panels.front().curves, legendPlaces(panels.front().curves, 80.0, 1170.0, 24.0));
        for (std::size_t p = 0; p < panels.size(); ++p) {
            PlotStyle style;
            style.x = {"cycle", 1.0};
            style.xTicks = static_cast<int>(std::clamp<std::size_t>(most, 2, 10)); // whole numbers
            style.y = {panels[p].label, 1.0};
            const Rect area{80.0 + 590.0 * static_cast<double>(p % 2), 44.0 + 380.0 * static_cast<double>(p / 2), 490.0,
                            310.0};
            drawCurves(canvas, area, panels[p].curves, style, std::numeric_limits<double>::quiet_NaN(), "");
        }
    };
    return figure;
}

} // namespace supercircle::pages
