#include "plugin/pages/run/run_page.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "plugin/graphics/axis.h"
#include "plugin/graphics/page_builder.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/pages/run/figures.h"
#include "plugin/pages/run/key_labels.h"
#include "plugin/pages/run/motion_data.h"

namespace supercircle::pages {

using namespace graphics;

// Generated from player.js and player.html (plugin/cmake/EmbedText.cmake).
extern const std::string_view kPlayerJs, kPlayerHtml;

namespace {

using record::Recording;

constexpr std::size_t kMotionBudget = 5'000'000; ///< bytes of the page for the player
constexpr std::size_t kMostEvents = 400;

std::string plotAttribute(const PlotFrame& plot) {
    std::string text = " data-plot=\"";
    for (const double value :
         {plot.area.x, plot.area.y, plot.area.width, plot.area.height, plot.x.lo, plot.x.hi, plot.y.lo, plot.y.hi}) {
        appendFixed(text, value, 9);
        text += ' ';
    }
    text.back() = '"';
    return text;
}

/// Puts the figure's frame on its <svg> element, for the player's markers.
std::string withPlot(std::string svg, const PlotFrame& plot) {
    return svg.insert(svg.find(" viewBox"), plotAttribute(plot));
}

std::string forceSection(const Recording& recording) {
    SvgCanvas canvas(720.0, 780.0, "force-figure", "Force against displacement");
    const auto plot = drawForce(canvas, recording, {0.0, 0.0, 720.0, 780.0});
    if (!plot)
        return {};
    canvas.raw("<circle id=\"force-marker\" r=\"6\" fill=\"#1b1f24\" stroke=\"#ffffff\" stroke-width=\"2\" "
               "visibility=\"hidden\"/>\n");
    return "<section><h2>Force against displacement</h2><div class=\"scroll\">\n" + withPlot(canvas.finish(), *plot) +
           "</div></section>\n";
}

std::string energySection(const Recording& recording) {
    SvgCanvas canvas(1180.0, 520.0, "energy-figure", "Energy over time");
    const auto plot = drawEnergy(canvas, recording, {0.0, 0.0, 1180.0, 520.0});
    if (!plot)
        return {};
    canvas.raw("<g id=\"energy-marker\" visibility=\"hidden\"><path d=\"M0 ");
    std::string line;
    appendFixed(line, plot->area.y);
    line += "V";
    appendFixed(line, plot->area.bottom());
    canvas.raw(line + "\" stroke=\"#1b1f24\" stroke-width=\"1.2\" stroke-dasharray=\"3 3\"/></g>\n");
    return "<div class=\"grid\"><section><h2>Energy balance over time</h2><div class=\"scroll wide\">\n" +
           withPlot(canvas.finish(), *plot) + "</div></section></div>\n";
}

std::string viewsSection(const Recording& recording) {
    const std::vector<KeyView> views = keyViews(recording);
    if (views.empty())
        return {};
    std::vector<std::size_t> frames;
    for (const KeyView& view : views)
        frames.push_back(view.frame);
    const View view = viewOf(recording, frames);
    const double scale = largestBendingEnergy(recording);
    const double height = std::clamp(376.0 * view.y.span() / view.x.span(), 120.0, 560.0) + 72.0;
    std::string html = "<div class=\"grid\"><section><h2>Configurations</h2><div class=\"views\">\n";
    for (const KeyView& key : views) {
        SvgCanvas canvas(400.0, height, "view-" + key.id, key.title);
        drawConfiguration(canvas, recording, key.frame, view, scale, {0.0, 0.0, 400.0, height}, key.title);
        html += "<div>" + canvas.finish() + "</div>\n";
    }
    html += "</div>";
    if (scale > 0.0 && !recording.shells.empty()) {
        SvgCanvas canvas(560.0, 56.0, "colour-bar", "Colour scale of the bending energy");
        drawColourBar(canvas, scale, {0.0, 0.0, 560.0, 56.0});
        html += "<div class=\"bar\">" + canvas.finish() + "</div>";
    }
    return html + "<p class=\"hint\">Shells are drawn with their true thickness and round ends; one scale for all "
                  "pictures.</p></section></div>\n";
}

std::string playerSection(const Recording& recording) {
    if (recording.frames.empty())
        return {};
    const std::vector<std::size_t> frames = keptFrames(recording, kMotionBudget);
    const std::vector<KeyView> views = keyViews(recording);
    const auto start = std::lower_bound(frames.begin(), frames.end(), views.front().frame) - frames.begin();
    const std::string thinned = frames.size() < recording.frames.size()
                                    ? " &nbsp; (" + std::to_string(frames.size()) + " of " +
                                          std::to_string(recording.frames.size()) +
                                          " frames; all are in trajectory.json)"
                                    : "";
    std::string data = motionJson(recording, frames);
    data.insert(data.size() - 1, ",\"start\":" + std::to_string(start));
    return fillTemplate(kPlayerHtml, {{"thinned", thinned}, {"motion", data}});
}

std::string tiles(const Recording& recording) {
    struct Tile {
        const char *key, *label;
        double factor;
        const char* unit;
    };
    static constexpr std::array<Tile, 10> wanted{{{"peak_force_N", "largest force", 1.0, "N"},
                                                  {"delta_max_over_R", "working distance Δmax", 1.0, "R"},
                                                  {"dissipation_ratio", "dissipation ratio η", 1.0, ""},
                                                  {"snap_fits", "snap-fits", 1.0, ""},
                                                  {"H0_over_R", "height of the pile H₀", 1.0, "R"},
                                                  {"peak_force_R2_over_B", "largest force", 1.0, "B/R²"},
                                                  {"pull_off_force_R2_over_B", "pull-off force", 1.0, "B/R²"},
                                                  {"tip_x_over_L", "tip, across", 1.0, "L"},
                                                  {"tip_y_over_L", "tip, down", 1.0, "L"},
                                                  {"energy_residual_relative", "energy residual", 1.0, ""}}};
    std::string html;
    int count = 0;
    for (const Tile& tile : wanted) {
        const double value = summaryNumber(recording, tile.key);
        if (!std::isfinite(value) || count == 6)
            continue;
        const bool whole = value == std::round(value) && std::abs(value) < 1e6 && tile.unit[0] == '\0';
        html += "<div class=\"tile\"><b>" + (whole ? std::to_string(std::lround(value)) : significant(value, 3));
        html += std::string(" <small>") + tile.unit + "</small></b><span>" + tile.label + "</span></div>\n";
        ++count;
    }
    return html.empty() ? html : "<div class=\"tiles\">\n" + html + "</div>\n";
}

std::string row(const std::string& label, const std::string& value, const std::string& unit, const std::string& key) {
    return "<tr><td>" + escaped(label) + "</td><td class=\"n\">" + escaped(value) + "</td><td class=\"u\">" +
           escaped(unit) + "</td><td><code>" + escaped(key) + "</code></td></tr>\n";
}

constexpr const char* tableHead = "<table><thead><tr><th>quantity</th><th class=\"n\">value</th><th>unit</th>"
                                  "<th class=\"code\">key</th></tr></thead><tbody>\n";

std::string resultsTable(const Recording& recording) {
    if (recording.summary.empty())
        return {};
    std::string html = std::string("<section><h2>Results</h2><div class=\"scroll\">") + tableHead;
    for (const auto& [key, value] : recording.summary)
        if (key != "scene")
            html += row(keyLabel(key), valueText(value), keyUnit(key), key);
    for (const auto& [key, seconds] : recording.timing)
        html += row(keyLabel(key), valueText(seconds), keyUnit(key), key);
    return html + "</tbody></table></div></section>\n";
}

std::string parametersTable(const Recording& recording) {
    if (recording.parameters.empty())
        return {};
    std::string html = std::string("<section><h2>Parameters</h2><div class=\"scroll\">") + tableHead;
    for (std::size_t i = 0; i < recording.parameters.size(); ++i) {
        const auto& [name, value] = recording.parameters[i];
        std::string unit = i < recording.parameterUnits.size() ? recording.parameterUnits[i] : parameterUnit(name);
        html += row(keyLabel(name), trimmed(value), unit == "1" ? "" : unit, name);
    }
    return html + "</tbody></table></div></section>\n";
}

std::string energyTable(const Recording& recording) {
    if (recording.energy.empty())
        return {};
    double whole = 0.0;
    bool work = false;
    for (const auto& [name, value] : recording.energy)
        if (name.rfind("work", 0) == 0 && value > 0.0) {
            whole = value;
            work = true;
        }
    if (!work)
        for (const auto& [name, value] : recording.energy)
            if (std::isfinite(value))
                whole = std::max(whole, std::abs(value));
    std::string html =
        "<section><h2>Energy balance at the end</h2><div class=\"scroll\"><table><thead><tr><th>term</th>"
        "<th class=\"n\">mJ</th><th class=\"n\">";
    html += work ? "% of the work put in" : "% of the largest";
    html += "</th></tr></thead><tbody>\n";
    for (const auto& [name, value] : recording.energy) {
        const std::string percent = whole > 0.0 ? significant(100.0 * value / whole, 3) : std::string("–");
        html += "<tr><td>" + escaped(keyLabel(name)) + "</td><td class=\"n\">" + significant(1e3 * value) +
                "</td><td class=\"n\">" + percent + "</td></tr>\n";
    }
    return html + "</tbody></table></div></section>\n";
}

std::string cyclesTable(const Recording& recording) {
    if (recording.cycles.size() < 2)
        return {};
    std::string html = "<section><h2>Cycles</h2><div class=\"scroll\"><table><thead><tr><th>cycle</th><th class=\"n\">"
                       "Δmax / R</th><th class=\"n\">η</th><th class=\"n\">snap-fits</th><th class=\"n\">dissipated "
                       "(mJ)</th></tr></thead><tbody>\n";
    int number = 0;
    for (const auto& cycle : recording.cycles)
        html += "<tr><td>" + std::to_string(++number) + "</td><td class=\"n\">" + significant(cycle.delta_max_over_R) +
                "</td><td class=\"n\">" + significant(cycle.dissipation_ratio) + "</td><td class=\"n\">" +
                std::to_string(cycle.snap_fits) + "</td><td class=\"n\">" + significant(1e3 * cycle.dissipated_J) +
                "</td></tr>\n";
    return html + "</tbody></table></div></section>\n";
}

std::string eventsTable(const Recording& recording) {
    if (recording.events.empty())
        return {};
    std::string html = "<section><h2>Events</h2><div class=\"scroll long\"><table><thead><tr><th class=\"n\">time "
                       "(s)</th><th class=\"n\">displacement (mm)</th><th class=\"n\">force (N)</th><th>event</th>"
                       "<th></th></tr></thead><tbody>\n";
    int snaps = 0;
    for (std::size_t i = 0; i < recording.events.size(); ++i) {
        const auto& event = recording.events[i];
        std::string kind = event.kind == "snap_fit" ? "snap-fit " + std::to_string(++snaps) : keyLabel(event.kind);
        if (i >= kMostEvents)
            continue;
        html += "<tr data-time=\"";
        appendFixed(html, event.time, 6);
        html += "\"><td class=\"n\">" + significant(event.time) + "</td><td class=\"n\">" +
                significant(1e3 * event.displacement) + "</td><td class=\"n\">" + significant(event.force, 3) +
                "</td><td class=\"k\">" + escaped(kind) + "</td><td>" + escaped(event.text) + "</td></tr>\n";
    }
    html += "</tbody></table></div>";
    if (recording.events.size() > kMostEvents)
        html += "<p class=\"hint\">The first " + std::to_string(kMostEvents) + " of " +
                std::to_string(recording.events.size()) + "; all are in trajectory.json.</p>";
    return html + "</section>\n";
}

/// Sections side by side where there is room.
std::string sideBySide(const char* kind, const std::string& left, const std::string& right) {
    if (left.empty() && right.empty())
        return {};
    return std::string("<div class=\"grid") + (left.empty() || right.empty() ? "" : kind) + "\">\n" + left + right +
           "</div>\n";
}

} // namespace

std::string runPage(const Recording& recording) {
    const std::string heading = recording.scene.empty() ? "Run" : recording.scene;
    PageBuilder page(heading);
    page.title(heading + " – Supercircle");
    page.introduction("<p>" + escaped(summarySentence(recording)) + "</p>\n");
    if (!recording.about.empty())
        page.introduction("<p class=\"about\">" + escaped(recording.about) + "</p>\n");
    page.add(tiles(recording));
    page.add(sideBySide(" pair", playerSection(recording), forceSection(recording)));
    page.add(viewsSection(recording));
    page.add(energySection(recording));
    page.add(sideBySide(" halves", resultsTable(recording),
                        sideBySide("", parametersTable(recording), energyTable(recording))));
    page.add(sideBySide(" halves", cyclesTable(recording), eventsTable(recording)));
    page.add("<footer>Data: series.csv (every sample), trajectory.json (every frame), summary.json (the numbers "
             "above).</footer>\n");
    page.script(kPlayerJs);
    return page.html();
}

} // namespace supercircle::pages
