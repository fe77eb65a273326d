#include "plugin/pages/run/page.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "plugin/graphics/axis.h"
#include "plugin/graphics/page_parts.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/pages/run/figures.h"
#include "plugin/pages/run/motion_data.h"
#include "plugin/pages/run/words.h"

namespace supercircle::report {

namespace {

using record::Recording;

constexpr std::size_t motionBudget = 5'000'000; ///< bytes of the page for the player
constexpr std::size_t mostEvents = 400;

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
    return "<div class=\"grid\"><section><h2>Energy books over time</h2><div class=\"scroll wide\">\n" +
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
    const std::vector<std::size_t> frames = keptFrames(recording, motionBudget);
    const std::vector<KeyView> views = keyViews(recording);
    const auto start = std::lower_bound(frames.begin(), frames.end(), views.front().frame) - frames.begin();
    std::string html = R"(<section><h2>Motion</h2>
<div><canvas id="stage" role="img" aria-label="The motion; controls below"></canvas></div>
<div class="controls">
<button id="play" type="button" aria-pressed="false">Play</button>
<button id="back" type="button" aria-label="One frame back">&#9664;&#xFE0E;</button>
<button id="forward" type="button" aria-label="One frame forward">&#9654;&#xFE0E;</button>
<input id="scrub" type="range" min="0" max="1" step="any" value="0" aria-label="Time">
</div>
<div class="controls">
<label>phase <select id="phase"></select></label>
<label>speed <select id="speed">
<option value="0.1">0.1×</option><option value="0.25">0.25×</option>
<option value="0.5">0.5×</option><option value="1" selected>1×</option><option value="2">2×</option>
<option value="5">5×</option><option value="10">10×</option></select></label>
<label><input id="showContacts" type="checkbox"> contact forces</label>
<label><input id="colourBend" type="checkbox"> curvature</label>
<button id="fit" type="button">Fit</button>
</div>
<dl class="readout">
<div><dt>time</dt><dd id="rTime">–</dd></div><div><dt>displacement</dt><dd id="rMove">–</dd></div>
<div><dt>force</dt><dd id="rForce">–</dd></div><div><dt>bending</dt><dd id="rBend">–</dd></div>
<div><dt>contacts</dt><dd id="rContacts">–</dd></div>
</dl>
<div class="key"><i id="keyBar"></i><span id="keyText"></span>
<span id="keyContacts" hidden>contact forces: dark sticks, orange slips; length grows with the square root</span></div>
<p class="hint"><kbd>space</kbd> play &nbsp; <kbd>←</kbd> <kbd>→</kbd> one frame, with <kbd>shift</kbd> ten &nbsp; 
<kbd>ctrl</kbd> + wheel zooms, drag moves &nbsp; click a curve to go there)";
    if (frames.size() < recording.frames.size())
        html += " &nbsp; (" + std::to_string(frames.size()) + " of " + std::to_string(recording.frames.size()) +
                " frames; all are in trajectory.json)";
    std::string data = motionJson(recording, frames);
    data.insert(data.size() - 1, ",\"start\":" + std::to_string(start));
    return html + "</p>\n<noscript><p>The player needs JavaScript; the pictures below do not.</p></noscript>\n" +
           "<script type=\"application/json\" id=\"motion\">" + data + "</script></section>\n";
}

std::string tiles(const Recording& recording) {
    struct Tile {
        const char *key, *label;
        double factor;
        const char* unit;
    };
    static constexpr std::array<Tile, 10> wanted{{{"peak_force_N", "largest force", 1.0, "N"},
                                                  {"delta_max_over_R", "working distance Δmax", 1.0, "R"},
                                                  {"eta", "dissipated share η", 1.0, ""},
                                                  {"snap_fits", "snap-fits", 1.0, ""},
                                                  {"H0_over_R", "height of the pile H₀", 1.0, "R"},
                                                  {"peak_force_R2_over_B", "largest force", 1.0, "B/R²"},
                                                  {"pull_force_R2_over_B", "largest pull", 1.0, "B/R²"},
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
            html += row(plainName(key), shown(value), unitOf(key), key);
    return html + "</tbody></table></div></section>\n";
}

std::string parametersTable(const Recording& recording) {
    if (recording.parameters.empty())
        return {};
    std::string html = std::string("<section><h2>Parameters</h2><div class=\"scroll\">") + tableHead;
    for (std::size_t i = 0; i < recording.parameters.size(); ++i) {
        const auto& [name, value] = recording.parameters[i];
        std::string unit = i < recording.parameterUnits.size() ? recording.parameterUnits[i] : parameterUnit(name);
        html += row(plainName(name), asTyped(value), unit == "1" ? "" : unit, name);
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
    std::string html = "<section><h2>Energy books at the end</h2><div class=\"scroll\"><table><thead><tr><th>book</th>"
                       "<th class=\"n\">mJ</th><th class=\"n\">";
    html += work ? "% of the work put in" : "% of the largest";
    html += "</th></tr></thead><tbody>\n";
    for (const auto& [name, value] : recording.energy) {
        const std::string share = whole > 0.0 ? significant(100.0 * value / whole, 3) : std::string("–");
        html += "<tr><td>" + escaped(plainName(name)) + "</td><td class=\"n\">" + significant(1e3 * value) +
                "</td><td class=\"n\">" + share + "</td></tr>\n";
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
                "</td><td class=\"n\">" + significant(cycle.eta) + "</td><td class=\"n\">" +
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
        std::string kind = event.kind == "snap_fit" ? "snap-fit " + std::to_string(++snaps) : plainName(event.kind);
        if (i >= mostEvents)
            continue;
        html += "<tr data-time=\"";
        appendFixed(html, event.time, 6);
        html += "\"><td class=\"n\">" + significant(event.time) + "</td><td class=\"n\">" +
                significant(1e3 * event.displacement) + "</td><td class=\"n\">" + significant(event.force, 3) +
                "</td><td class=\"k\">" + escaped(kind) + "</td><td>" + escaped(event.text) + "</td></tr>\n";
    }
    html += "</tbody></table></div>";
    if (recording.events.size() > mostEvents)
        html += "<p class=\"hint\">The first " + std::to_string(mostEvents) + " of " +
                std::to_string(recording.events.size()) + "; all are in trajectory.json.</p>";
    return html + "</section>\n";
}

/// Sections side by side where there is room.
std::string side(const char* kind, const std::string& left, const std::string& right) {
    if (left.empty() && right.empty())
        return {};
    return std::string("<div class=\"grid") + (left.empty() || right.empty() ? "" : kind) + "\">\n" + left + right +
           "</div>\n";
}

} // namespace

std::string pageHtml(const Recording& recording) {
    const std::string title = recording.scene.empty() ? "Run" : recording.scene;
    std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                       "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>";
    html += escaped(title) + " – Supercircle</title>\n<style>";
    html += pageStyle();
    html += "</style>\n</head>\n<body>\n<main>\n<header><h1>" + escaped(title) + "</h1>\n<p>";
    html += escaped(sentence(recording)) + "</p>\n";
    if (!recording.about.empty())
        html += "<p class=\"about\">" + escaped(recording.about) + "</p>\n";
    html += "</header>\n" + tiles(recording);
    html += side(" pair", playerSection(recording), forceSection(recording));
    html += viewsSection(recording);
    html += energySection(recording);
    html += side(" halves", resultsTable(recording), side("", parametersTable(recording), energyTable(recording)));
    html += side(" halves", cyclesTable(recording), eventsTable(recording));
    html += "<footer>Data: series.csv (every sample), trajectory.json (every frame), summary.json (the numbers "
            "above).</footer>\n</main>\n<script>";
    html += pageScript();
    return html + "</script>\n</body>\n</html>\n";
}

} // namespace supercircle::report
