#include "plugin/pages/sweep/sweep_page.h"

#include "plugin/pages/sweep/sweep_figures.h"
#include "plugin/pages/sweep/sweep_layout.h"
#include "plugin/recording/table/rounded.h"

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/page_parts.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/lab/sweep/statistics.h"

#include <algorithm>
#include <cmath>

namespace supercircle::cli {

namespace {

using report::escaped;

/// Runs whose curves are shown per set.
constexpr std::size_t kCurves = 20;

/// The paper's figure a picture answers (sweeps of stacks over opening angle and friction).
std::string paperFigure(const std::string& name) {
    if (name == "H0_over_R")
        return " Paper: figure 3(c).";
    if (name == "force_curves")
        return " Paper: figure 4 (opening angles 0.75 and 0.97).";
    if (name == "delta_max_over_R")
        return " Paper: figures 5(a) and 5(c).";
    if (name == "eta")
        return " Paper: figures 5(b) and 5(d).";
    if (name.rfind("histograms_", 0) == 0)
        return " Paper: figure 2 of the supplement.";
    return "";
}

bool asInThePaper(const sweep::Definition& sweep, const sweep::Table& table) {
    return sweep.x == "phi_bar" && table.column("H0_over_R") < table.columns.size();
}

std::vector<SweepFigure> figuresOf(const sweep::Definition& sweep, const sweep::Table& table, sweep::Store& store,
                                   std::string& error) {
    std::vector<SweepFigure> figures;
    const std::vector<std::string> numbers = headlines(table);
    if (sweep.sets.size() > 1)
        for (const std::string& quantity : numbers)
            figures.push_back(trendFigure(sweep, table, quantity));
    if (sweep.sets.size() <= 60) {
        for (const std::string& quantity : numbers)
            if (quantity == "delta_max_over_R" || quantity == "eta")
                figures.push_back(histogramFigure(sweep, table, quantity));
        std::vector<std::vector<sweep::RunResult>> curves;
        for (std::size_t set = 0; set < sweep.sets.size() && error.empty(); ++set) {
            auto some = sweep::curvesOf(sweep, set, store, kCurves);
            error = some.error;
            curves.push_back(std::move(some.value));
        }
        if (error.empty())
            figures.push_back(forceFigure(sweep, curves));
        figures.push_back(cyclesFigure(sweep, table));
    }
    figures.erase(std::remove_if(figures.begin(), figures.end(), [](const SweepFigure& f) { return !f.draw; }),
                  figures.end());
    return figures;
}

std::string section(const std::string& title, const std::string& body) {
    return body.empty() ? "" : "<div class=\"grid\"><section><h2>" + title + "</h2>" + body + "</section></div>";
}

std::string svgOf(const SweepFigure& f) {
    report::SvgCanvas canvas(f.width, f.height, "figure-" + f.name, f.title);
    f.draw(canvas);
    return canvas.finish();
}

/// Mean ± standard error, median and spread of the headline numbers, set by set.
std::string statisticsTable(const sweep::Definition& sweep, const sweep::Table& table) {
    const std::vector<std::string> numbers = headlines(table);
    if (numbers.empty())
        return {};
    std::string html = "<div class=\"scroll\"><table><tr>";
    for (const std::string& name : sweep.names)
        html += "<th>" + escaped(parameterLabel(name)) + "</th>";
    html += "<th>runs</th>";
    for (const std::string& name : numbers)
        html += "<th>" + escaped(quantityLabel(name)) + "</th>";
    html += "</tr>";
    for (std::size_t set = 0; set < sweep.sets.size(); ++set) {
        html += "<tr>";
        for (const double v : sweep.sets[set])
            html += "<td>" + shortNumber(v) + "</td>";
        std::size_t runs = 0;
        std::string cells;
        for (const std::string& name : numbers) {
            const sweep::Statistics s = sweep::statisticsOf(sweep::valuesOf(table, set, table.column(name)));
            runs = std::max(runs, s.n);
            cells += s.n == 0 ? "<td></td>"
                              : "<td>" + shortNumber(s.mean) +
                                    (s.n > 1 ? " ± " + shortNumber(s.standardError, "%.2g") + "<br><small>median " +
                                                   shortNumber(s.median) + ", spread " +
                                                   shortNumber(s.sigmaMad, "%.2g") + "</small>"
                                             : "") +
                                    "</td>";
        }
        html += "<td>" + std::to_string(runs) + "</td>" + cells + "</tr>";
    }
    return html + "</table></div><p>Mean ± standard error of the mean; spread: 1.4826 MAD, the standard deviation of "
                  "single runs if they are Gaussian. All numbers: statistics.csv, results.csv.</p>";
}

std::string failedTable(const sweep::Definition& sweep, const sweep::Table& table) {
    std::string html;
    for (const sweep::Row& row : table.rows)
        if (row.status != "done")
            html += "<tr><td>" + escaped(sweep::keyOf(sweep.settings(row.set))) + "</td><td>" +
                    std::to_string(row.seed) + "</td><td>" + row.status + ": " + escaped(row.message) +
                    "</td><td><code>" + escaped(sweep::commandOf(sweep, row.set, row.seed)) + "</code></td></tr>";
    return html.empty() ? html
                        : "<table><tr><th>parameters</th><th>seed</th><th>what happened</th><th>again alone</th></tr>" +
                              html + "</table>";
}

/// What the laboratory itself watches, over all runs.
std::string healthText(const sweep::Table& table) {
    double crossings = 0.0, penetration = 0.0, residual = 0.0, cpu = 0.0;
    std::size_t good = 0;
    for (const sweep::Row& row : table.rows) {
        good += row.status == "done" ? 1 : 0;
        cpu += row.cpu;
        if (const double v = row.number(table.column("crossings")); std::isfinite(v))
            crossings += v;
        if (const double v = row.number(table.column("penetration_max_over_h")); std::isfinite(v))
            penetration = std::max(penetration, v);
        if (const double v = std::abs(row.number(table.column("energy_residual_relative"))); std::isfinite(v))
            residual = std::max(residual, v);
    }
    const double runs = std::max<double>(1.0, static_cast<double>(table.rows.size()));
    return "<p>" + std::to_string(table.rows.size()) + " runs, " + std::to_string(table.rows.size() - good) +
           " of them not good; " + shortNumber(crossings) + " crossings of shells, largest penetration " +
           shortNumber(penetration, "%.2g") + " of a thickness, largest energy residual " +
           shortNumber(residual, "%.1e") + ". Processor time: " + record::duration(cpu) + " in all, " +
           shortNumber(cpu / runs, "%.3g") + " s a run (timings.csv).</p>";
}

std::string pageOf(const sweep::Definition& sweep, const sweep::Table& table, const std::vector<SweepFigure>& figures) {
    std::string html = "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + escaped(sweep.name) +
                       "</title><style>" + std::string(report::pageStyle()) +
                       "table{border-collapse:collapse;font-size:14px}td,th{padding:3px 14px 3px 0;text-align:left;"
                       "vertical-align:top;font-variant-numeric:tabular-nums}small{color:var(--muted)}</style></head>"
                       "<body><main><header><h1>" +
                       escaped(sweep.name) + "</h1><p>" + escaped(sweep.about) + "</p>" + healthText(table) +
                       "</header>";
    html += section("Runs that failed", failedTable(sweep, table));
    const bool paper = asInThePaper(sweep, table);
    std::string pair; // narrow figures share a line
    const auto flush = [&] {
        if (!pair.empty())
            html += "<div class=\"grid halves\">" + pair + "</div>";
        pair.clear();
    };
    for (const SweepFigure& f : figures) {
        const bool narrow = f.width < 700.0;
        const std::string one = "<section><h2>" + escaped(f.title) + "</h2><div class=\"scroll" +
                                (narrow ? "" : " wide") + "\">" + svgOf(f) + "</div><p>" + escaped(f.caption) +
                                (paper ? paperFigure(f.name) : "") + "</p></section>";
        if (!narrow)
            flush();
        pair += one;
        if (!narrow) {
            html += "<div class=\"grid\">" + pair + "</div>";
            pair.clear();
        }
    }
    flush();
    html += section("Statistics", statisticsTable(sweep, table));
    return html + "</main></body></html>\n";
}

} // namespace

record::Result<std::vector<record::NamedText>> sweepPages(const sweep::Definition& sweep, const sweep::Table& table,
                                                          sweep::Store& store) {
    using Files = record::Result<std::vector<record::NamedText>>;
    std::string error;
    const std::vector<SweepFigure> figures = figuresOf(sweep, table, store, error);
    if (!error.empty())
        return Files::fail(error);
    Files files;
    for (const SweepFigure& f : figures) {
        report::CairoCanvas canvas(f.width, f.height, 1.5);
        f.draw(canvas);
        auto png = canvas.png();
        if (!png)
            return Files::fail(f.name + ".png: " + png.error);
        files.value.emplace_back(f.name + ".png", std::move(png.value));
    }
    files.value.emplace_back("report.html", pageOf(sweep, table, figures));
    return files;
}

} // namespace supercircle::cli
