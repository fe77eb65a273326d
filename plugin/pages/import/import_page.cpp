#include "plugin/pages/import/import_page.h"

#include "plugin/graphics/page_builder.h"
#include "plugin/graphics/plot.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/graphics/theme.h"
#include "plugin/recording/table/rounded.h"
#include "plugin/recording/table/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace supercircle::cli {

namespace {

using graphics::AxisRange;
using graphics::Canvas;
using graphics::Plot;
using graphics::PlotStyle;
using importing::ImportedRun;
using importing::Quantity;
using importing::Signals;
using importing::Source;
using record::fixed;
namespace theme = graphics::theme;

constexpr double kWidth = 1180.0, kHeight = 300.0; // px

/// A channel over x, with marks where rows were left out.
void drawChannel(Canvas& canvas, double left, const std::vector<double>& x, const std::vector<double>& y,
                 const PlotStyle& style, const std::vector<double>& lost, const graphics::Colour& colour) {
    const Plot plot({left, 20.0, 460.0, 220.0}, graphics::rangeOf({&x}), graphics::rangeOf({&y}));
    plot.drawFrame(canvas, style);
    canvas.pushClip(plot.area);
    for (const double at : lost) {
        const double px = plot.at(at, plot.y.lo).x;
        canvas.line({px, plot.area.y}, {px, plot.area.bottom()}, {theme::unloading, 1.0});
    }
    plot.drawLine(canvas, x, y, {colour, 1.4});
    canvas.popClip();
}

struct Shown {
    Quantity quantity;
    const char* label; ///< without a unit
    const char* unit;  ///< of SI; a prefix makes it readable
};

/// The two most telling channels.
std::vector<Shown> shownOf(const Signals& s) {
    std::vector<Shown> all;
    for (const Shown& c : {Shown{Quantity::Displacement, "displacement", "m"}, Shown{Quantity::Force, "force", "N"},
                           Shown{Quantity::Angle, "angle", "deg"}})
        if (s.find(c.quantity) != nullptr && all.size() < 2)
            all.push_back(c);
    return all;
}

/// Label and factor of an axis: "force (kN)".
graphics::AxisStyle axisOf(const Shown& c, const std::vector<double>& values) {
    if (c.quantity == Quantity::Angle)
        return {std::string(c.label) + " (deg)", 180.0 / M_PI};
    const AxisRange range = graphics::rangeOf({&values});
    const auto unit = graphics::readableUnit(std::max(std::abs(range.lo), std::abs(range.hi)), c.unit);
    return {std::string(c.label) + " (" + unit.text + ")", unit.factor};
}

std::string picture(const Signals& s, const std::vector<double>& x, const char* xLabel, const std::vector<double>& lost,
                    const std::string& id, const graphics::Colour& colour) {
    graphics::SvgCanvas svg(kWidth, kHeight, id, "values over " + std::string(xLabel));
    double left = 80.0;
    for (const Shown& c : shownOf(s)) {
        PlotStyle style;
        style.x = {xLabel, 1.0};
        const std::vector<double>& y = *s.find(c.quantity);
        style.y = axisOf(c, y);
        drawChannel(svg, left, x, y, style, lost, colour);
        left += 570.0;
    }
    return "<div class=\"scroll wide\">" + svg.finish() + "</div>";
}

std::string decisionTable(const std::vector<importing::Decision>& decisions) {
    if (decisions.empty())
        return {};
    std::string html = "<table><tr><th>question</th><th>decided</th><th>next</th><th>odds</th><th>option</th></tr>";
    for (const importing::Decision& d : decisions)
        html += "<tr><td>" + graphics::escaped(d.question) + "</td><td>" + graphics::escaped(d.answer) + "</td><td>" +
                graphics::escaped(d.runnerUp) + "</td><td>" +
                (d.odds > 0.0 ? (d.odds > 1e3 ? "&gt; 1000" : fixed(d.odds, d.odds < 10.0 ? 1 : 0)) + " : 1"
                              : std::string("stated or a rule")) +
                "</td><td>" + graphics::escaped(d.option) + "</td></tr>";
    return html + "</table>";
}

std::string remarkList(const std::vector<importing::Remark>& remarks) {
    std::string html = "<ul>";
    for (const importing::Remark& r : remarks)
        html += "<li>" + std::string(importing::word(r.kind)) + ": " +
                (r.line > 0 ? "line " + std::to_string(r.line) + ": " : "") + graphics::escaped(r.what) + "</li>";
    return html + "</ul>";
}

std::string sourceSection(const Source& s, std::size_t number) {
    std::vector<double> lines(s.raw.line.begin(), s.raw.line.end());
    const std::vector<double> lost(s.table.lostLines.begin(), s.table.lostLines.end());
    return "<p>" + std::to_string(s.rows) + " rows were read, " + std::to_string(s.lost) +
           " were left out (marked).</p>" +
           picture(s.raw, lines, "line of the file", lost, "raw" + std::to_string(number), theme::ink) +
           decisionTable(s.table.layout.decisions) + remarkList(s.table.remarks);
}

std::string runSection(const ImportedRun& run, std::size_t number) {
    return picture(run.signals, *run.signals.find(Quantity::Time), run.atRest ? "point, from 0" : "time (s)", {},
                   "run" + std::to_string(number), theme::loading) +
           decisionTable(run.signals.decisions) + remarkList(run.remarks);
}

/// With all digits: the command gives the same bits.
std::string exact(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
}

} // namespace

std::string importPage(const importing::Imported& all, const std::string& command) {
    std::string again = command;
    if (all.sources.size() == 1 && all.runs.size() == 1) { // options count for every file and specimen
        const importing::Table& t = all.sources[0].table;
        const Signals& s = all.runs[0].signals;
        std::string columns;
        for (std::size_t c = 0; c < t.headings.size(); ++c) {
            const importing::Heading& h = t.headings[c];
            const bool plain = t.channelOf[c] >= 0 && h.marker.empty() && h.quantity != Quantity::Counter;
            columns += (c == 0 ? "" : ",") + (plain ? importing::name(h.quantity) + ("[" + h.unit.name + "]") : "-");
        }
        const bool marked =
            std::any_of(t.headings.begin(), t.headings.end(), [](const auto& h) { return !h.marker.empty(); });
        again += marked ? "" : " --columns " + record::shellQuoted(columns);
        again += std::string(" --displacement ") + (s.displacementTurned ? "negative" : "positive");
        if (s.find(Quantity::Force) != nullptr)
            again += std::string(" --force ") + (s.forceTurned ? "negative" : "positive") + " --force-zero " +
                     exact(s.forceTurned ? -all.runs[0].forceZero : all.runs[0].forceZero);
    }
    graphics::PageBuilder page("Import");
    page.plainTables().introduction("<p><b>" + graphics::escaped(importing::worst(all)) + "</b></p><p><code>" +
                                    graphics::escaped(again) + "</code></p>");
    for (std::size_t i = 0; i < all.sources.size(); ++i) {
        const Source& s = all.sources[i];
        page.section(s.file + (s.table.specimen.empty() ? "" : ", " + s.table.specimen), sourceSection(s, i + 1));
        for (std::size_t k = 0; k < all.runs.size(); ++k)
            if (all.runs[k].source == i)
                page.section(all.runs[k].file, runSection(all.runs[k], k + 1));
    }
    return page.html();
}

} // namespace supercircle::cli
