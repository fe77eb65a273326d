// Pictures of a sweep with one panel per set of parameters: histograms and force curves.

#include "plugin/pages/sweep/sweep_figures.h"

#include "plugin/graphics/plot.h"
#include "plugin/graphics/theme.h"
#include "plugin/lab/sweep/statistics.h"
#include "plugin/pages/run/key_labels.h"
#include "plugin/pages/sweep/sweep_layout.h"

#include <algorithm>
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

constexpr Colour kWorkingDistance = Colour::hex(0x3f9b5b),
                 kDissipation = Colour::hex(0x3b76c2); // the paper's green and blue

constexpr double kTitleLine = 14.0; ///< px

/// Title of a panel: the value of the abscissa, then those of the group; wrapped between values.
std::vector<std::string> titleOf(const SweepGroup& g, std::size_t i, const std::string& x, double width, double size) {
    std::string rest = (x.empty() ? "" : parameterLabel(x) + " = " + shortNumber(g.x[i]));
    rest += (rest.empty() || g.label.empty() ? "" : ", ") + g.label;
    std::vector<std::string> lines = {""};
    while (!rest.empty()) {
        const std::size_t comma = rest.find(", ");
        const std::string value = rest.substr(0, comma);
        rest = comma == std::string::npos ? "" : rest.substr(comma + 2);
        std::string& line = lines.back();
        const std::string longer = line.empty() ? value : line + ", " + value;
        if (line.empty() || graphics::textWidth(longer, size) <= width)
            line = longer;
        else
            lines.push_back(value);
    }
    return lines;
}

/// Panels in rows (groups) and columns (abscissa), each below its title.
struct Panels {
    std::vector<SweepGroup> groups;
    std::vector<std::vector<std::vector<std::string>>> titles; ///< lines, by group and point
    std::size_t columns = 0;
    double width = 0.0, height = 0.0; ///< of a panel, px
    double size = 0.0;                ///< of the titles' letters
    double head = 0.0;                ///< height of the title lines beyond the first

    Panels(const sweep::SweepDefinition& sweep, double cellWidth, double cellHeight, double letters)
        : groups(groupsOf(sweep)), width(cellWidth), height(cellHeight), size(letters) {
        for (const SweepGroup& g : groups) {
            columns = std::max(columns, g.sets.size());
            titles.emplace_back();
            for (std::size_t i = 0; i < g.sets.size(); ++i) {
                titles.back().push_back(titleOf(g, i, sweep.x, width - 66.0, size));
                head = std::max(head, kTitleLine * (static_cast<double>(titles.back().back().size()) - 1.0));
            }
        }
    }
    /// Without the title lines above the last one.
    [[nodiscard]] Rect cell(std::size_t row, std::size_t column) const {
        return {8.0 + width * static_cast<double>(column), 8.0 + head + (height + head) * static_cast<double>(row),
                width, height};
    }
    /// Centred on the axes, whose middle is shifted by `aside` from that of the panel.
    void drawTitle(Canvas& canvas, std::size_t row, std::size_t column, double aside) const {
        const std::vector<std::string>& lines = titles[row][column];
        const Rect at = cell(row, column);
        for (std::size_t k = 0; k < lines.size(); ++k)
            canvas.text(
                {at.x + 0.5 * at.width + aside, at.y + 13.0 - kTitleLine * static_cast<double>(lines.size() - 1 - k)},
                lines[k], {size, theme::ink, Anchor::Middle});
    }
    [[nodiscard]] double totalWidth() const { return width * static_cast<double>(columns) + 16.0; }
    [[nodiscard]] double totalHeight() const { return (height + head) * static_cast<double>(groups.size()) + 16.0; }
};

void drawHistogram(Canvas& canvas, const Rect& cell, const std::vector<double>& values, const Colour& colour) {
    const sweep::Statistics s = sweep::statisticsOf(values);
    const Rect area{cell.x + 34.0, cell.y + 22.0, cell.width - 46.0, cell.height - 48.0};
    if (s.n < 2 || !(s.deviation > 0.0)) {
        canvas.text({area.x, area.y + 20.0}, s.n == 0 ? "no runs" : "no spread", {theme::tickSize, theme::muted});
        return;
    }
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    const double sigma = s.madSigma > 0.0 ? s.madSigma : s.deviation;
    const AxisRange range{std::min(*least, s.mean - 3.2 * sigma), std::max(*most, s.mean + 3.2 * sigma)};
    const double bins = std::clamp(std::round(1.5 * std::sqrt(static_cast<double>(s.n))) + 3.0, 6.0, 30.0);
    const double width = range.span() / bins;
    std::vector<double> counts(static_cast<std::size_t>(bins), 0.0);
    for (const double v : values)
        counts[std::min(counts.size() - 1, static_cast<std::size_t>((v - range.lo) / width))] += 1.0;
    const double unit = 1.0 / (static_cast<double>(s.n) * width);
    const auto gauss = [&](double x) {
        return std::exp(-0.5 * std::pow((x - s.mean) / sigma, 2)) / (sigma * std::sqrt(2.0 * std::acos(-1.0)));
    };
    const double top = 1.08 * std::max(unit * *std::max_element(counts.begin(), counts.end()), gauss(s.mean));
    const Plot plot(area, range, {0.0, top});
    const graphics::Ticks ticks = graphics::niceTicks(range, 5);
    for (const double v : ticks.values) {
        const double x = plot.at(v, 0.0).x;
        canvas.line({x, area.bottom()}, {x, area.bottom() + 4.0}, {theme::axis, 1.0});
        canvas.text({x, area.bottom() + 17.0}, ticks.label(v), {11.0, theme::muted, Anchor::Middle});
    }
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const double from = range.lo + width * static_cast<double>(i);
        const Point a = plot.at(from, unit * counts[i]), b = plot.at(from + width, 0.0);
        if (counts[i] > 0.0)
            canvas.rectangle({a.x, a.y, b.x - a.x, b.y - a.y},
                             {.fill = colour.alpha(0.55), .stroke = graphics::Stroke{colour, 0.8}});
    }
    std::vector<Point> curve;
    for (int i = 0; i <= 80; ++i) {
        const double x = range.lo + range.span() * i / 80.0;
        curve.push_back(plot.at(x, gauss(x)));
    }
    canvas.path(curve, false, {.stroke = graphics::Stroke{theme::ink, 1.4}});
    canvas.line({area.x, area.bottom()}, {area.right(), area.bottom()}, {theme::axis, 1.0});
    const std::string p = std::isfinite(s.normality) ? ", p " + shortNumber(s.normality, "%.2f") : "";
    canvas.text({area.right(), area.y + 4.0}, "n " + std::to_string(s.n) + p, {10.5, theme::muted, Anchor::End});
}

/// Ranges of displacement and force. Forces ring after a snap, far beyond what the specimen carries: one point in a
/// thousand may lie outside.
std::pair<AxisRange, AxisRange> rangesOf(const std::vector<sweep::RunRecord>& runs) {
    double distance = 0.0, turn = 0.0;
    std::vector<double> forces;
    for (const sweep::RunRecord& run : runs)
        for (const sweep::CurveBranch& branch : run.branches) {
            for (const double d : branch.displacement)
                distance = std::max(distance, d);
            forces.insert(forces.end(), branch.force.begin(), branch.force.end());
            turn = std::max(turn, branch.force.empty() ? 0.0 : branch.force.back());
        }
    if (forces.empty())
        return {};
    std::sort(forces.begin(), forces.end());
    const std::size_t outside = forces.size() / 1000;
    return {{0.0, distance}, {std::min(0.0, forces[outside]), std::max(turn, forces[forces.size() - 1 - outside])}};
}

void drawBranches(Canvas& canvas, const Plot& plot, const sweep::RunRecord& run, bool bold) {
    const std::size_t cycles = std::max<std::size_t>(1, run.branches.size() / 2);
    for (std::size_t i = 0; i < run.branches.size(); ++i) {
        const double age = cycles > 1 ? static_cast<double>(i / 2) / static_cast<double>(cycles - 1) : 0.0;
        const Colour colour = i % 2 == 0 ? theme::loading : theme::unloading; // later cycles fade
        plot.drawLine(canvas, run.branches[i].displacement, run.branches[i].force,
                      {colour.alpha(bold ? 1.0 - 0.65 * age : 0.16), bold ? 1.7 : 0.9});
    }
}

} // namespace

SweepFigure histogramFigure(const sweep::SweepDefinition& sweep, const sweep::RunTable& table,
                            const std::string& quantity) {
    const Panels panels(sweep, 196.0, 156.0, theme::tickSize);
    std::vector<std::vector<std::vector<double>>> values;
    for (const SweepGroup& g : panels.groups) {
        values.emplace_back();
        for (const std::size_t set : g.sets)
            values.back().push_back(sweep::valuesOf(table, set, table.column(quantity)));
    }
    SweepFigure figure;
    figure.name = "histograms_" + quantity;
    figure.title = "Histograms of " + quantityLabel(quantity);
    figure.caption = "Lines: Gaussians of the mean and 1.4826 MAD. n: runs; p: Anderson-Darling test of the hypothesis "
                     "that runs are Gaussian (one panel in twenty falls below 0.05 even if all are).";
    figure.width = panels.totalWidth();
    figure.height = panels.totalHeight();
    figure.draw = [panels, values,
                   colour = quantity == "dissipation_ratio" ? kDissipation : kWorkingDistance](Canvas& canvas) {
        for (std::size_t row = 0; row < panels.groups.size(); ++row)
            for (std::size_t i = 0; i < panels.groups[row].sets.size(); ++i) {
                const Rect cell = panels.cell(row, i);
                panels.drawTitle(canvas, row, i, 11.0);
                drawHistogram(canvas, cell, values[row][i], colour);
            }
    };
    return figure;
}

SweepFigure forceFigure(const sweep::SweepDefinition& sweep, const std::vector<std::vector<sweep::RunRecord>>& curves) {
    const bool few = curves.size() <= 4;
    const Panels panels(sweep, few ? 440.0 : 300.0, few ? 340.0 : 240.0, theme::labelSize);
    SweepFigure figure;
    figure.name = "force_curves";
    figure.title = "Force against displacement";
    figure.caption = "Loading red, unloading blue; the first seed bold (later cycles fade), other seeds thin.";
    figure.width = panels.totalWidth();
    figure.height = panels.totalHeight();
    const bool any = std::any_of(curves.begin(), curves.end(), [](const auto& runs) {
        return std::any_of(runs.begin(), runs.end(), [](const sweep::RunRecord& r) { return !r.branches.empty(); });
    });
    if (!any)
        return {};
    figure.draw = [panels, curves](Canvas& canvas) {
        for (std::size_t row = 0; row < panels.groups.size(); ++row)
            for (std::size_t i = 0; i < panels.groups[row].sets.size(); ++i) {
                const std::vector<sweep::RunRecord>& runs = curves[panels.groups[row].sets[i]];
                const auto [distance, force] = rangesOf(runs);
                const Rect cell = panels.cell(row, i);
                panels.drawTitle(canvas, row, i, 25.0);
                if (!(distance.hi > 0.0) || !(force.span() > 0.0))
                    continue;
                const Plot plot({cell.x + 62.0, cell.y + 24.0, cell.width - 74.0, cell.height - 74.0},
                                {0.0, 1.03 * distance.hi}, graphics::padded(force, 0.04));
                PlotStyle style;
                const graphics::DisplayUnit length = graphics::readableUnit(distance.hi, "m");
                const graphics::DisplayUnit newton = graphics::readableUnit(std::max(-force.lo, force.hi), "N");
                style.x = {"displacement (" + length.text + ")", length.factor};
                style.y = {"force (" + newton.text + ")", newton.factor};
                style.xTicks = 6;
                style.yTicks = 6;
                plot.drawFrame(canvas, style);
                canvas.pushClip(plot.area);
                for (std::size_t k = runs.size(); k-- > 0;)
                    drawBranches(canvas, plot, runs[k], k == 0);
                canvas.popClip();
            }
    };
    return figure;
}

} // namespace supercircle::pages
