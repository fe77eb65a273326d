// Inverse design: pairs of parameters that give a target working distance, dissipation or force, with the scatter of
// single stacks.

#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/subcommands.h"
#include "plugin/cli/sweep/sweep_input.h"
#include "plugin/pages/sweep/design_chart.h"
#include "plugin/pages/sweep/sweep_figures.h"
#include "plugin/pages/sweep/sweep_layout.h"

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/page_builder.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/lab/sweep/design.h"
#include "plugin/lab/sweep/result_store.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/text.h"
#include "plugin/scene/loader/document.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace supercircle::cli {

namespace {

using pages::parameterLabel;
using pages::quantityLabel;
using pages::shortNumber;
using pages::SweepFigure;
using sweep::DesignPoint;
using sweep::ResponseSurface;

/// A target value and the pairs that give it.
struct DesignTarget {
    std::string quantity;
    double value = 0.0;
    ResponseSurface surface;
    std::vector<DesignPoint> points;
};

struct Design {
    sweep::SweepDefinition sweep;
    sweep::RunTable table;
    std::vector<DesignTarget> targets;
    std::vector<std::pair<std::string, ResponseSurface>> others; ///< further quantities, shown beside each pair
    double measuredAt = 1.0, shells = 1.0;
};

/// Rows of the table: the values of the sweep and two between each, spaced as the interpolation.
std::vector<double> rowsOf(const ResponseSurface& s) {
    std::vector<double> rows;
    for (std::size_t i = 0; i + 1 < s.y.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const double t = k / 3.0;
            rows.push_back(s.y.front() > 0.0 ? s.y[i] * std::pow(s.y[i + 1] / s.y[i], t)
                                             : s.y[i] + t * (s.y[i + 1] - s.y[i]));
        }
    rows.push_back(s.y.back());
    return rows;
}

/// Shells of a stack: a fixed parameter of the sweep, else the scene's value; 0 if the scene has no stack.
double shellsOf(const sweep::SweepDefinition& sweep) {
    for (const sweep::ParameterValue& s : sweep.fixed)
        if (s.first == "shells")
            return s.second;
    std::vector<scene::Problem> problems;
    if (const auto scene = scene::load(sweep.scene, {}, problems))
        for (const scene::Parameter& p : scene->parameters)
            if (p.name == "shells")
                return p.value;
    return 0.0;
}

int load(const DesignArguments& a, Design& design) {
    auto loaded = loadSweep(a.file);
    if (!loaded)
        return kBadInput;
    design.sweep = std::move(*loaded);
    const std::string path = a.results + "/" + sweep::kStoreFile;
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        return complain(kBadInput, path + ": there is no such file; `supercircle sweep` creates it");
    sweep::ResultStore store;
    const auto failed = [&](const std::string& why) {
        return complain(store.cannotWrite() ? kCannotWrite : kBadInput, why);
    };
    if (const std::string why = store.open(path); !why.empty())
        return failed(why);
    if (const std::string why = store.checkFormat(); !why.empty())
        return failed(why);
    auto table = sweep::collect(design.sweep, store);
    if (!table)
        return failed(table.error());
    design.table = *std::move(table);
    const double shells = shellsOf(design.sweep);
    if (shells == 0.0 && a.shells > 0.0)
        return complain(kBadInput, "--shells: the scene " + design.sweep.scene + " has no parameter \"shells\"");
    design.measuredAt = std::max(1.0, shells);
    design.shells = a.shells > 0.0 ? a.shells : design.measuredAt;
    return kDone;
}

int solve(const DesignArguments& a, Design& design) {
    if (a.targets.empty())
        return complain(kBadInput, "--target is required: NAME=VALUE, for example delta_max_over_R=4");
    std::vector<scene::Override> targets;
    if (!readOverrides(a.targets, targets, "--target"))
        return kBadInput;
    for (const scene::Override& w : targets) {
        auto surface = sweep::responseSurface(design.sweep, design.table, w.name);
        if (!surface)
            return complain(kBadInput, a.results + ": " + surface.error());
        DesignTarget target{w.name, w.value, *std::move(surface), {}};
        for (const double y : rowsOf(target.surface))
            for (const DesignPoint& s : sweep::solveFor(target.surface, w.value, y))
                target.points.push_back(s);
        design.targets.push_back(std::move(target));
    }
    for (const std::string& name : pages::mainQuantities(design.table))
        if (auto surface = sweep::responseSurface(design.sweep, design.table, name))
            design.others.emplace_back(name, *std::move(surface));
    return kDone;
}

std::string csvOf(const Design& d, const DesignTarget& w) {
    const auto number = [](double v) {
        std::string text;
        record::appendNumber(text, v);
        return text;
    };
    std::string out = w.surface.yName.empty() ? "" : w.surface.yName + ",";
    out += w.surface.xName + "," + w.surface.xName + "_error";
    for (const auto& [name, surface] : d.others)
        out += "," + name + "," + name + "_error," + name + "_spread";
    out += '\n';
    for (const DesignPoint& s : w.points) {
        out += (w.surface.yName.empty() ? "" : number(s.y) + ",") + number(s.x) + "," + number(s.xError);
        for (const auto& [name, surface] : d.others) {
            const ResponseSurface::Value v = surface.at(s.x, s.y);
            out += "," + number(v.mean) + "," + number(v.error) + "," +
                   number(sweep::scaledSpread(v.spread, d.measuredAt, d.shells));
        }
        out += '\n';
    }
    return out;
}

std::string tableOf(const Design& d, const DesignTarget& w) {
    std::string html = "<div class=\"scroll\"><table><tr>";
    if (!w.surface.yName.empty())
        html += "<th>" + graphics::escaped(parameterLabel(w.surface.yName)) + "</th>";
    html += "<th>" + graphics::escaped(parameterLabel(w.surface.xName)) + "</th>";
    for (const auto& [name, surface] : d.others)
        html += "<th>" + graphics::escaped(quantityLabel(name)) + "</th>";
    html += "</tr>";
    for (const DesignPoint& s : w.points) {
        html += "<tr>" + (w.surface.yName.empty() ? "" : "<td>" + shortNumber(s.y, "%.3g") + "</td>") + "<td>" +
                shortNumber(s.x, "%.3f") + " ± " + shortNumber(s.xError, "%.1g") + "</td>";
        for (const auto& [name, surface] : d.others) {
            const ResponseSurface::Value v = surface.at(s.x, s.y);
            html += "<td>" + shortNumber(v.mean, "%.3g") + "<br><small>single stacks ± " +
                    shortNumber(sweep::scaledSpread(v.spread, d.measuredAt, d.shells), "%.2g") + "</small></td>";
        }
        html += "</tr>";
    }
    return html + "</table></div>";
}

std::string pageOf(const Design& d, const std::vector<SweepFigure>& charts) {
    graphics::PageBuilder page("Design");
    page.plainTables().introduction(
        "<p>From " + std::to_string(d.table.rows.size()) + " runs of " + graphics::escaped(d.sweep.name) +
        ". Scatter of single stacks of " + shortNumber(d.shells) + " shells" +
        (d.shells == d.measuredAt ? "" : ", from that of stacks of " + shortNumber(d.measuredAt) + " scaled by 1/√N") +
        ".</p>");
    for (std::size_t i = 0; i < charts.size(); ++i) {
        graphics::SvgCanvas canvas(charts[i].width, charts[i].height, charts[i].name, charts[i].title);
        charts[i].draw(canvas);
        page.section(charts[i].title,
                     "<div class=\"scroll\">" + canvas.finish() + "</div><p>" + graphics::escaped(charts[i].caption) +
                         "</p>" +
                         (d.targets[i].points.empty() ? "<p>No pair of the sweep's range gives this value.</p>"
                                                      : tableOf(d, d.targets[i])));
    }
    return page.html();
}

int write(const DesignArguments& a, const Design& d) {
    std::vector<SweepFigure> charts;
    std::vector<record::NamedText> files;
    for (const DesignTarget& w : d.targets) {
        charts.push_back(pages::designChart(w.surface, w.quantity, w.value));
        graphics::CairoCanvas canvas(charts.back().width, charts.back().height, 1.5);
        charts.back().draw(canvas);
        auto png = canvas.png();
        if (!png)
            return complain(kCannotWrite, png.error());
        files.emplace_back(charts.back().name + ".png", *std::move(png));
        files.emplace_back(charts.back().name + ".csv", csvOf(d, w));
    }
    files.emplace_back("design.html", pageOf(d, charts));
    const std::string folder = a.out.empty() ? a.results + "/design" : a.out;
    if (const std::string error = record::writeAtomically(folder, files).error(); !error.empty())
        return complain(kCannotWrite, error);
    if (!a.quiet)
        std::printf("chart and table: %s/design.html\n", folder.c_str());
    return kDone;
}

void print(const Design& d) {
    for (const DesignTarget& w : d.targets) {
        std::printf("%s = %s:\n", quantityLabel(w.quantity).c_str(), shortNumber(w.value).c_str());
        for (const DesignPoint& s : w.points) {
            std::printf("  ");
            if (!w.surface.yName.empty())
                std::printf("%s = %-6.3g ", w.surface.yName.c_str(), s.y);
            std::printf("%s = %.3f +- %.3f", w.surface.xName.c_str(), s.x, s.xError);
            for (const auto& [name, surface] : d.others) {
                const ResponseSurface::Value v = surface.at(s.x, s.y);
                if (name == w.quantity || name == "delta_max_over_R" || name == "dissipation_ratio")
                    std::printf("; %s %.3g, single stacks +- %.2g", name.c_str(), v.mean,
                                sweep::scaledSpread(v.spread, d.measuredAt, d.shells));
            }
            std::printf("\n");
        }
        if (w.points.empty()) {
            double least = w.surface.mean[0][0], most = least;
            for (const auto& row : w.surface.mean)
                for (const double v : row) {
                    least = std::min(least, v);
                    most = std::max(most, v);
                }
            std::printf("  no pair gives this: the sweep has %.4g to %.4g\n", least, most);
        }
    }
}

} // namespace

int design(const DesignArguments& a) {
    Design d;
    if (const int code = load(a, d); code != kDone)
        return code;
    if (const int code = solve(a, d); code != kDone)
        return code;
    if (!a.quiet)
        print(d);
    if (const int code = write(a, d); code != kDone)
        return code;
    const bool none =
        std::all_of(d.targets.begin(), d.targets.end(), [](const DesignTarget& w) { return w.points.empty(); });
    return !printed() ? kCannotWrite : none ? kBadInput : kDone;
}

} // namespace supercircle::cli
