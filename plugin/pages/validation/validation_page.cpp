#include "plugin/pages/validation/validation_page.h"

#include "plugin/graphics/axis.h"
#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/page_builder.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/lab/validation/simulation.h"
#include "plugin/lab/validation/validation.h"
#include "plugin/pages/validation/diagram.h"
#include "plugin/recording/table/text.h"

#include <cmath>

namespace supercircle::pages {

using validation::Check;
using validation::text;
using validation::ValidationExperiment;
using validation::ValidationSettings;

// Generated from validation.css (plugin/cmake/EmbedText.cmake).
extern const std::string_view kValidationCss;

namespace {

using graphics::escaped;

struct Count {
    int judged = 0, passed = 0, knownDeviations = 0;
};

Count countOf(const ValidationExperiment& e) {
    Count n;
    for (const Check& c : e.checks)
        if (c.target) {
            ++n.judged;
            n.passed += c.pass() ? 1 : 0;
            n.knownDeviations += !c.pass() && c.knownDeviation ? 1 : 0;
        }
    return n;
}

/// The check with the largest error over its target.
const Check* worstOf(const ValidationExperiment& e) {
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
    return c.knownDeviation ? "<td class=\"open\">missed, known reason</td>" : "<td class=\"miss\">missed</td>";
}

void addChecks(std::string& out, const ValidationExperiment& e) {
    out += "<div class=\"scroll long\"><table><tr><th>quantity</th><th class=\"n\">simulated</th><th "
           "class=\"n\">solved</th>"
           "<th class=\"n\">error</th><th>of</th><th class=\"n\">target</th><th></th><th>reason of the target or of "
           "the miss</th></tr>\n";
    for (const Check& c : e.checks) {
        const bool difference = c.reference == 0.0;
        out += "<tr><td>" + escaped(c.description) + "</td><td class=\"n\">" +
               (difference ? "" : graphics::significant(c.measured, 5)) + "</td><td class=\"n\">" +
               (difference ? "" : graphics::significant(c.reference, 5)) + "</td><td class=\"n\">" + percent(c.error) +
               "</td><td class=\"u\">" + escaped(c.relativeTo) + "</td><td class=\"n\">" +
               (c.target ? percent(*c.target) : "") + "</td>" + verdictCell(c) + "<td>" + escaped(c.reason) +
               "</td></tr>\n";
    }
    out += "</table></div>\n";
}

void addExperiment(std::string& out, const ValidationExperiment& e) {
    out += "<section id=\"" + escaped(e.id) + "\"><h2>" + escaped(e.id) + ": " + escaped(e.title) + "</h2>\n";
    if (!e.failure.empty())
        out += "<p class=\"failure\">could not be finished: " + escaped(e.failure) + "</p>\n";
    out += "<p>" + escaped(e.about) + "</p>\n";
    if (!e.diagrams.empty()) {
        const FigureSize size = figureSize(e);
        graphics::SvgCanvas canvas(size.width, size.height, "figure-" + e.id, e.title);
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

void addOverview(std::string& out, const std::vector<ValidationExperiment>& all) {
    out += "<section><h2>Overview</h2><div class=\"scroll\"><table><tr><th>experiment</th><th></th>"
           "<th class=\"n\">targets met</th><th>largest error over its target</th><th class=\"n\">error</th>"
           "<th class=\"n\">target</th><th class=\"n\">runs</th><th class=\"n\">time</th></tr>\n";
    for (const ValidationExperiment& e : all) {
        const Count n = countOf(e);
        const Check* worst = worstOf(e);
        const bool allMet = n.passed == n.judged && e.failure.empty();
        const std::string shade = allMet                                                          ? "pass"
                                  : n.passed + n.knownDeviations == n.judged && e.failure.empty() ? "open"
                                                                                                  : "miss";
        out += "<tr><td class=\"k\"><a href=\"#" + escaped(e.id) + "\">" + escaped(e.id) + "</a></td><td>" +
               escaped(e.title) + "</td><td class=\"n " + shade + "\">" + std::to_string(n.passed) + " of " +
               std::to_string(n.judged) + "</td><td>" + (worst != nullptr ? escaped(worst->description) : "") +
               "</td><td class=\"n\">" + (worst != nullptr ? percent(worst->error) : "") + "</td><td class=\"n\">" +
               (worst != nullptr ? percent(*worst->target) : "") + "</td><td class=\"n\">" + std::to_string(e.runs) +
               "</td><td class=\"n\">" + text("%.1f s", e.seconds) + "</td></tr>\n";
    }
    out += "</table></div></section>\n";
}

std::string page(const std::vector<ValidationExperiment>& all, const ValidationSettings& settings) {
    Count n;
    double seconds = 0.0;
    for (const ValidationExperiment& e : all) {
        const Count one = countOf(e);
        n.judged += one.judged;
        n.passed += one.passed;
        n.knownDeviations += one.knownDeviations;
        seconds += e.seconds;
    }
    graphics::PageBuilder page("Simulations against solved references");
    page.title("Supercircle: validation");
    page.style(kValidationCss);
    page.introduction(
        "<p>Points are simulations by the stepper of every scene, with its contact, friction and time stepping, unless "
        "a "
        "section says otherwise. Lines are solved by shooting, elliptic integrals or closed forms, for zero thickness "
        "and to 1e-5. Forces are in B/R², lengths in R.</p>\n<p>" +
        std::to_string(n.passed) + " of " + std::to_string(n.judged) + " targets met, " +
        std::to_string(n.knownDeviations) + " missed for a known reason that is stated. " + text("%.0f s", seconds) +
        " of computing in all. Made by <code>supercircle validate" + (settings.quick ? " --quick" : "") +
        "</code>.</p>\n");
    std::string sections;
    addOverview(sections, all);
    for (const ValidationExperiment& e : all)
        addExperiment(sections, e);
    page.add("<div class=\"grid\">\n" + sections + "</div>\n");
    return page.html();
}

void addJson(std::string& out, const ValidationExperiment& e) {
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
        record::appendJsonString(out += i == 0 ? "\n      {\"description\": " : ",\n      {\"description\": ",
                                 c.description);
        record::appendJsonNumber(member("measured"), c.measured);
        record::appendJsonNumber(member("reference"), c.reference);
        record::appendJsonNumber(member("error"), c.error);
        record::appendJsonString(member("relative_to"), c.relativeTo);
        record::appendJsonNumber(member("target"), c.target ? *c.target : std::nan(""));
        member("pass") += c.target ? (c.pass() ? "true" : "false") : "null";
        member("known_deviation") += c.knownDeviation ? "true" : "false";
        record::appendJsonString(member("reason"), c.reason);
        out += '}';
    }
    out += "]}";
}

std::string json(const std::vector<ValidationExperiment>& all, const ValidationSettings& settings) {
    std::string out = "{\n  \"schema\": \"supercircle-validation/2\",\n  \"quick\": ";
    out += settings.quick ? "true" : "false";
    out += ",\n  \"experiments\": [\n";
    for (std::size_t i = 0; i < all.size(); ++i) {
        out += i == 0 ? "" : ",\n";
        addJson(out, all[i]);
    }
    return out + "\n  ]\n}\n";
}

} // namespace

Result<std::vector<record::NamedText>> validationFiles(const std::vector<ValidationExperiment>& all,
                                                       const ValidationSettings& settings) {
    using Files = Result<std::vector<record::NamedText>>;
    std::vector<record::NamedText> out;
    for (const ValidationExperiment& e : all) {
        if (e.diagrams.empty())
            continue;
        const FigureSize size = figureSize(e);
        graphics::CairoCanvas canvas(size.width, size.height, 1.0);
        drawFigure(canvas, e);
        auto png = canvas.png();
        if (!png)
            return Files::failure(e.id + ": " + png.error());
        out.emplace_back("validation_" + e.id + ".png", *std::move(png));
    }
    out.emplace_back("validation.json", json(all, settings));
    out.emplace_back("validation.html", page(all, settings));
    return out;
}

} // namespace supercircle::pages
