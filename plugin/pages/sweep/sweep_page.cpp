#include "plugin/pages/sweep/sweep_page.h"

#include "plugin/pages/sweep/sweep_figures.h"
#include "plugin/pages/sweep/sweep_layout.h"

#include "plugin/graphics/axis.h"
#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/page_builder.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/lab/sweep/statistics.h"

#include <algorithm>
#include <cmath>

namespace supercircle::pages {

namespace {

using graphics::escaped;

/// Number of runs whose curves are shown per set.
constexpr std::size_t kCurves = 20;

/// The figure of the paper that a picture corresponds to (sweeps of stacks over opening angle and friction).
std::string paperFigure(const std::string& name) {
    if (name == "H0_over_R")
        return " Paper: figure 3(c).";
    if (name == "force_curves")
        return " Paper: figure 4 (opening angles 0.75 and 0.97).";
    if (name == "delta_max_over_R")
        return " Paper: figures 5(a) and 5(c).";
    if (name == "dissipation_ratio")
        return " Paper: figures 5(b) and 5(d).";
    if (name.rfind("histograms_", 0) == 0)
        return " Paper: figure 2 of the supplement.";
    return "";
}

bool asInThePaper(const sweep::SweepDefinition& sweep, const sweep::RunTable& table) {
    return sweep.x == "phi_bar" && table.column("H0_over_R") < table.columns.size();
}

std::vector<SweepFigure> figuresOf(const sweep::SweepDefinition& sweep, const sweep::RunTable& table,
                                   sweep::ResultStore& store, std::string& error) {
    std::vector<SweepFigure> figures;
    const std::vector<std::string> numbers = mainQuantities(table);
    if (sweep.sets.size() > 1)
        for (const std::string& quantity : numbers)
            figures.push_back(trendFigure(sweep, table, quantity));
    if (sweep.sets.size() <= 60) {
        for (const std::string& quantity : numbers)
            if (quantity == "delta_max_over_R" || quantity == "dissipation_ratio")
                figures.push_back(histogramFigure(sweep, table, quantity));
        std::vector<std::vector<sweep::RunRecord>> curves;
        for (std::size_t set = 0; set < sweep.sets.size() && error.empty(); ++set) {
            auto some = sweep::curvesOf(sweep, set, store, kCurves);
            error = some.error();
            if (some)
                curves.push_back(*std::move(some));
        }
        if (error.empty())
            figures.push_back(forceFigure(sweep, curves));
        figures.push_back(cyclesFigure(sweep, table));
    }
    figures.erase(std::remove_if(figures.begin(), figures.end(), [](const SweepFigure& f) { return !f.draw; }),
                  figures.end());
    return figures;
}

std::string svgOf(const SweepFigure& f) {
    graphics::SvgCanvas canvas(f.width, f.height, "figure-" + f.name, f.title);
    f.draw(canvas);
    return canvas.finish();
}

/// Mean ± standard error, median and spread of the main quantities, set by set.
std::string statisticsTable(const sweep::SweepDefinition& sweep, const sweep::RunTable& table) {
    const std::vector<std::string> numbers = mainQuantities(table);
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
                                                   shortNumber(s.madSigma, "%.2g") + "</small>"
                                             : "") +
                                    "</td>";
        }
        html += "<td>" + std::to_string(runs) + "</td>" + cells + "</tr>";
    }
    return html + "</table></div><p>Mean ± standard error of the mean; spread: 1.4826 MAD, the standard deviation of "
                  "single runs if they are Gaussian. All numbers: statistics.csv, results.csv.</p>";
}

std::string failedTable(const sweep::SweepDefinition& sweep, const sweep::RunTable& table) {
    std::string html;
    for (const sweep::Row& row : table.rows)
        if (row.status != "done")
            html += "<tr><td>" + escaped(sweep::keyOf(sweep.parameterValues(row.set))) + "</td><td>" +
                    std::to_string(row.seed) + "</td><td>" + row.status + ": " + escaped(row.message) +
                    "</td><td><code>" + escaped(sweep::commandOf(sweep, row.set, row.seed)) + "</code></td></tr>";
    return html.empty()
               ? html
               : "<table><tr><th>parameters</th><th>seed</th><th>message</th><th>command</th></tr>" + html + "</table>";
}

/// Quality measures of the simulations, over all runs.
std::string qualityText(const sweep::RunTable& table) {
    double crossings = 0.0, penetration = 0.0, residual = 0.0, cpu = 0.0;
    std::size_t done = 0;
    for (const sweep::Row& row : table.rows) {
        done += row.status == "done" ? 1 : 0;
        cpu += row.cpu;
        if (const double v = row.number(table.column("crossings")); std::isfinite(v))
            crossings += v;
        if (const double v = row.number(table.column("penetration_max_over_h")); std::isfinite(v))
            penetration = std::max(penetration, v);
        if (const double v = std::abs(row.number(table.column("energy_residual_relative"))); std::isfinite(v))
            residual = std::max(residual, v);
    }
    const double runs = std::max<double>(1.0, static_cast<double>(table.rows.size()));
    return "<p>" + std::to_string(table.rows.size()) + " runs, " + std::to_string(table.rows.size() - done) +
           " of them failed; " + shortNumber(crossings) + " crossings of shells, largest penetration " +
           shortNumber(penetration, "%.2g") + " of a thickness, largest energy residual " +
           shortNumber(residual, "%.1e") + ". CPU time: " + graphics::readableDuration(cpu) + " in all, " +
           shortNumber(cpu / runs, "%.3g") + " s a run (timings.csv).</p>";
}

std::string pageOf(const sweep::SweepDefinition& sweep, const sweep::RunTable& table,
                   const std::vector<SweepFigure>& figures) {
    graphics::PageBuilder page(sweep.name);
    page.plainTables();
    page.introduction("<p>" + escaped(sweep.about) + "</p>\n" + qualityText(table) + "\n");
    page.section("Runs that failed", failedTable(sweep, table));
    const bool paper = asInThePaper(sweep, table);
    std::string pair; // narrow figures share a line
    const auto flush = [&] {
        if (!pair.empty())
            page.add("<div class=\"grid halves\">" + pair + "</div>\n");
        pair.clear();
    };
    for (const SweepFigure& f : figures) {
        const bool narrow = f.width < 700.0;
        const std::string one = "<section><h2>" + escaped(f.title) + "</h2><div class=\"scroll" +
                                (narrow ? "" : " wide") + "\">" + svgOf(f) + "</div><p>" + escaped(f.caption) +
                                (paper ? paperFigure(f.name) : "") + "</p></section>";
        if (narrow) {
            pair += one;
        } else {
            flush();
            page.add("<div class=\"grid\">" + one + "</div>\n");
        }
    }
    flush();
    page.section("Statistics", statisticsTable(sweep, table));
    return page.html();
}

} // namespace

Result<std::vector<record::NamedText>> sweepPages(const sweep::SweepDefinition& sweep, const sweep::RunTable& table,
                                                  sweep::ResultStore& store) {
    using Files = Result<std::vector<record::NamedText>>;
    std::string error;
    const std::vector<SweepFigure> figures = figuresOf(sweep, table, store, error);
    if (!error.empty())
        return Files::failure(error);
    std::vector<record::NamedText> files;
    for (const SweepFigure& f : figures) {
        graphics::CairoCanvas canvas(f.width, f.height, 1.5);
        f.draw(canvas);
        auto png = canvas.png();
        if (!png)
            return Files::failure(f.name + ".png: " + png.error());
        files.emplace_back(f.name + ".png", *std::move(png));
    }
    files.emplace_back("report.html", pageOf(sweep, table, figures));
    return files;
}

} // namespace supercircle::pages
