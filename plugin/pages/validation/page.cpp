#include "plugin/graphics/axis.h"
#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/page_parts.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/lab/validation/play.h"
#include "plugin/lab/validation/validation.h"
#include "plugin/pages/validation/panel.h"
#include "plugin/recording/table/text.h"

#include <cmath>

namespace supercircle::validation {

namespace {

using report::escaped;

constexpr std::string_view kStyle = R"css(
td.pass { color: #1a7f37; font-weight: 600; } td.miss { color: #c8452d; font-weight: 600; }
td.open { color: #9a6700; font-weight: 600; } td.none { color: #57606a; }
section + section { margin-top: 18px; } section > p { max-width: 100ch; } .wide > svg { min-width: 900px; }
pre { background: var(--ground); border: 1px solid var(--line); border-radius: 7px; padding: 8px 12px; overflow-x: auto;
  font: 12px/1.5 ui-monospace, Menlo, Consolas, monospace; max-height: 180px; }
.failure { color: #c8452d; font-weight: 600; }
)css";

struct Count {
    int judged = 0, passed = 0, open = 0;
};

Count countOf(const Experiment& e) {
    Count n;
    for (const Check& c : e.checks)
        if (c.target) {
            ++n.judged;
            n.passed += c.pass() ? 1 : 0;
            n.open += !c.pass() && c.open ? 1 : 0;
        }
    return n;
}

/// Largest error over its target, and whose it is.
const Check* worstOf(const Experiment& e) {
    const Check* worst = nullptr;
    const auto ratio = [](const Check& c) { return std::isfinite(c.error) ? std::abs(c.error) / *c.target : 1e300; };
    for (const Check& c : e.checks)
        if (c.target && (worst == nullptr || ratio(c) > ratio(*worst)))
            worst = &c;
    return worst;
}

std::string percent(double value) {
    return std::isfinite(value) ? text("%.2f %%", 100.0 * value) : "none found";
}

std::string verdictCell(const Check& c) {
    if (!c.target)
        return "<td class=\"none\">shown</td>";
    if (c.pass())
        return "<td class=\"pass\">met</td>";
    return c.open ? "<td class=\"open\">missed, understood</td>" : "<td class=\"miss\">missed</td>";
}

void addChecks(std::string& out, const Experiment& e) {
    out += "<div class=\"scroll long\"><table><tr><th>figure</th><th class=\"n\">ours</th><th class=\"n\">solved</th>"
           "<th class=\"n\">error</th><th>of</th><th class=\"n\">aimed at</th><th></th><th>why this target, or why "
           "missed</th></tr>\n";
    for (const Check& c : e.checks) {
        const bool difference = c.wanted == 0.0;
        out += "<tr><td>" + escaped(c.what) + "</td><td class=\"n\">" +
               (difference ? "" : report::significant(c.measured, 5)) + "</td><td class=\"n\">" +
               (difference ? "" : report::significant(c.wanted, 5)) + "</td><td class=\"n\">" + percent(c.error) +
               "</td><td class=\"u\">" + escaped(c.of) + "</td><td class=\"n\">" +
               (c.target ? percent(*c.target) : "") + "</td>" + verdictCell(c) + "<td>" + escaped(c.why) +
               "</td></tr>\n";
    }
    out += "</table></div>\n";
}

void addExperiment(std::string& out, const Experiment& e) {
    out += "<section id=\"" + escaped(e.id) + "\"><h2>" + escaped(e.id) + ": " + escaped(e.title) + "</h2>\n";
    if (!e.failure.empty())
        out += "<p class=\"failure\">could not be finished: " + escaped(e.failure) + "</p>\n";
    out += "<p>" + escaped(e.about) + "</p>\n";
    if (!e.panels.empty()) {
        const FigureSize size = figureSize(e);
        report::SvgCanvas canvas(size.width, size.height, "figure-" + e.id, e.title);
        drawFigure(canvas, e);
        out += "<div class=\"scroll wide\">" + canvas.finish() + "</div>\n";
    }
    for (const std::string& r : e.remarks)
        out += "<p>" + escaped(r) + "</p>\n";
    addChecks(out, e);
    out += "<p class=\"hint\">" + std::to_string(e.runs) + " simulations, " + text("%.1f s", e.seconds) +
           ". This section alone: <code>supercircle validate --filter " + escaped(e.id) + "</code>" +
           (e.commands.empty() ? "" : "; single runs of it:") + "</p>\n";
    if (!e.commands.empty()) {
        out += "<pre>";
        for (const std::string& c : e.commands)
            out += escaped(c) + "\n";
        out += "</pre>\n";
    }
    out += "</section>\n";
}

void addOverview(std::string& out, const std::vector<Experiment>& all) {
    out += "<section><h2>Overview</h2><div class=\"scroll\"><table><tr><th>experiment</th><th></th>"
           "<th class=\"n\">targets met</th><th>worst figure, by its target</th><th class=\"n\">error</th>"
           "<th class=\"n\">aimed at</th><th class=\"n\">runs</th><th class=\"n\">time</th></tr>\n";
    for (const Experiment& e : all) {
        const Count n = countOf(e);
        const Check* worst = worstOf(e);
        const bool good = n.passed == n.judged && e.failure.empty();
        const std::string shade = good ? "pass" : n.passed + n.open == n.judged && e.failure.empty() ? "open" : "miss";
        out += "<tr><td class=\"k\"><a href=\"#" + escaped(e.id) + "\">" + escaped(e.id) + "</a></td><td>" +
               escaped(e.title) + "</td><td class=\"n " + shade + "\">" + std::to_string(n.passed) + " of " +
               std::to_string(n.judged) + "</td><td>" + (worst != nullptr ? escaped(worst->what) : "") +
               "</td><td class=\"n\">" + (worst != nullptr ? percent(worst->error) : "") + "</td><td class=\"n\">" +
               (worst != nullptr ? percent(*worst->target) : "") + "</td><td class=\"n\">" + std::to_string(e.runs) +
               "</td><td class=\"n\">" + text("%.1f s", e.seconds) + "</td></tr>\n";
    }
    out += "</table></div></section>\n";
}

std::string page(const std::vector<Experiment>& all, const Settings& settings) {
    Count n;
    double seconds = 0.0;
    for (const Experiment& e : all) {
        const Count one = countOf(e);
        n.judged += one.judged;
        n.passed += one.passed;
        n.open += one.open;
        seconds += e.seconds;
    }
    std::string out = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
                      "content=\"width=device-width, initial-scale=1\"><title>Supercircle: validation</title><style>";
    out += report::pageStyle();
    out += kStyle;
    out +=
        "</style></head><body><main>\n<header><h1>The laboratory against solved references</h1><p>Points are "
        "simulations by the stepper that plays every scene (its contact, friction and time stepping included, unless "
        "a section says otherwise); lines are solved by shooting, elliptic integrals or closed forms, for zero "
        "thickness and to 1e-5. Forces are in B/R², lengths in R.</p><p>" +
        std::to_string(n.passed) + " of " + std::to_string(n.judged) + " targets met, " + std::to_string(n.open) +
        " missed for a reason that is understood and stated. " + text("%.0f s", seconds) +
        " of computing in all. Made by <code>supercircle validate" + (settings.quick ? " --quick" : "") +
        "</code>.</p></header>\n<div class=\"grid\">\n";
    addOverview(out, all);
    for (const Experiment& e : all)
        addExperiment(out, e);
    return out + "</div></main></body></html>\n";
}

void addJson(std::string& out, const Experiment& e) {
    const auto member = [&](const char* name) -> std::string& { return (((out += ", \"") += name) += "\": "); };
    out += "    {\"id\": ";
    record::appendJsonString(out, e.id);
    record::appendJsonString(member("title"), e.title);
    record::appendJsonNumber(member("seconds"), e.seconds);
    member("runs") += std::to_string(e.runs);
    record::appendJsonString(member("failure"), e.failure);
    member("commands") += '[';
    for (std::size_t i = 0; i < e.commands.size(); ++i)
        record::appendJsonString(out += i == 0 ? "" : ", ", e.commands[i]);
    out += "],\n     \"checks\": [";
    for (std::size_t i = 0; i < e.checks.size(); ++i) {
        const Check& c = e.checks[i];
        record::appendJsonString(out += i == 0 ? "\n      {\"what\": " : ",\n      {\"what\": ", c.what);
        record::appendJsonNumber(member("measured"), c.measured);
        record::appendJsonNumber(member("wanted"), c.wanted);
        record::appendJsonNumber(member("error"), c.error);
        record::appendJsonString(member("relative_to"), c.of);
        record::appendJsonNumber(member("target"), c.target ? *c.target : std::nan(""));
        member("pass") += c.target ? (c.pass() ? "true" : "false") : "null";
        member("understood") += c.open ? "true" : "false";
        record::appendJsonString(member("why"), c.why);
        out += '}';
    }
    out += "]}";
}

std::string json(const std::vector<Experiment>& all, const Settings& settings) {
    std::string out = "{\n  \"schema\": \"supercircle-validation/1\",\n  \"quick\": ";
    out += settings.quick ? "true" : "false";
    out += ",\n  \"experiments\": [\n";
    for (std::size_t i = 0; i < all.size(); ++i) {
        out += i == 0 ? "" : ",\n";
        addJson(out, all[i]);
    }
    return out + "\n  ]\n}\n";
}

} // namespace

record::Result<std::vector<record::NamedText>> files(const std::vector<Experiment>& all, const Settings& settings) {
    using Files = record::Result<std::vector<record::NamedText>>;
    Files out;
    for (const Experiment& e : all) {
        if (e.panels.empty())
            continue;
        const FigureSize size = figureSize(e);
        report::CairoCanvas canvas(size.width, size.height, 1.0);
        drawFigure(canvas, e);
        auto png = canvas.png();
        if (!png)
            return Files::fail(e.id + ": " + png.error);
        out.value.emplace_back("validation-" + e.id + ".png", std::move(png.value));
    }
    out.value.emplace_back("validation.json", json(all, settings));
    out.value.emplace_back("validation.html", page(all, settings));
    return out;
}

} // namespace supercircle::validation
