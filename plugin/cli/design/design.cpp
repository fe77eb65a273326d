// Pairs of parameters that give a wanted working distance, dissipation or force (the paper's design principle, turned
// round), with what single stacks will scatter.

#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/verbs.h"
#include "plugin/pages/sweep/design_chart.h"
#include "plugin/pages/sweep/sweep_figures.h"
#include "plugin/pages/sweep/sweep_layout.h"

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/page_parts.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/lab/sweep/design.h"
#include "plugin/lab/sweep/store.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/text.h"
#include "plugin/scene/loader/document.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace supercircle::cli {

namespace {

using sweep::Solution;
using sweep::Surface;

int complain(int code, const std::string& message) {
    std::fprintf(stderr, "%s\n", message.c_str());
    return code;
}

/// A wanted number and what answers it.
struct Wish {
    std::string quantity;
    double value = 0.0;
    Surface surface;
    std::vector<Solution> solutions;
};

struct Design {
    sweep::Definition sweep;
    sweep::Table table;
    std::vector<Wish> wishes;
    std::vector<std::pair<std::string, Surface>> others; ///< further numbers, shown beside each solution
    double measuredAt = 1.0, shells = 1.0;
};

/// Rows of the table: the sweep's own values and two between each, as the interpolation is spaced.
std::vector<double> rowsOf(const Surface& s) {
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

/// Shells of a stack as played: a setting of the sweep, else the scene's own value; 0 if the scene has no stack.
double shellsOf(const sweep::Definition& sweep) {
    for (const sweep::Setting& s : sweep.fixed)
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
    const std::string path = a.results + "/results.sqlite";
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        return complain(kBadInput, path + ": there is no such file; `supercircle sweep` makes it");
    sweep::Store store;
    if (const std::string why = store.open(path); !why.empty())
        return complain(kBadInput, why);
    auto table = sweep::collect(design.sweep, store);
    if (!table)
        return complain(kBadInput, table.error);
    design.table = std::move(table.value);
    const double shells = shellsOf(design.sweep);
    if (shells == 0.0 && a.shells > 0.0)
        return complain(kBadInput, "--shells: the scene " + design.sweep.scene + " has no parameter \"shells\"");
    design.measuredAt = std::max(1.0, shells);
    design.shells = a.shells > 0.0 ? a.shells : design.measuredAt;
    return kDone;
}

int answer(const DesignArguments& a, Design& design) {
    std::vector<scene::Override> wanted;
    if (!readOverrides(a.want, wanted))
        return kBadInput;
    for (const scene::Override& w : wanted) {
        auto surface = sweep::surfaceOf(design.sweep, design.table, w.name);
        if (!surface)
            return complain(kBadInput, a.results + ": " + surface.error);
        Wish wish{w.name, w.value, std::move(surface.value), {}};
        for (const double y : rowsOf(wish.surface))
            for (const Solution& s : sweep::solve(wish.surface, w.value, y))
                wish.solutions.push_back(s);
        design.wishes.push_back(std::move(wish));
    }
    for (const std::string& name : headlines(design.table))
        if (auto surface = sweep::surfaceOf(design.sweep, design.table, name))
            design.others.emplace_back(name, std::move(surface.value));
    return kDone;
}

std::string csvOf(const Design& d, const Wish& w) {
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
    for (const Solution& s : w.solutions) {
        out += (w.surface.yName.empty() ? "" : number(s.y) + ",") + number(s.x) + "," + number(s.xError);
        for (const auto& [name, surface] : d.others) {
            const Surface::Value v = surface.at(s.x, s.y);
            out += "," + number(v.mean) + "," + number(v.error) + "," +
                   number(sweep::spreadAt(v.spread, d.measuredAt, d.shells));
        }
        out += '\n';
    }
    return out;
}

std::string tableOf(const Design& d, const Wish& w) {
    std::string html = "<div class=\"scroll\"><table><tr>";
    if (!w.surface.yName.empty())
        html += "<th>" + report::escaped(parameterLabel(w.surface.yName)) + "</th>";
    html += "<th>" + report::escaped(parameterLabel(w.surface.xName)) + "</th>";
    for (const auto& [name, surface] : d.others)
        html += "<th>" + report::escaped(quantityLabel(name)) + "</th>";
    html += "</tr>";
    for (const Solution& s : w.solutions) {
        html += "<tr>" + (w.surface.yName.empty() ? "" : "<td>" + shortNumber(s.y, "%.3g") + "</td>") + "<td>" +
                shortNumber(s.x, "%.3f") + " ± " + shortNumber(s.xError, "%.1g") + "</td>";
        for (const auto& [name, surface] : d.others) {
            const Surface::Value v = surface.at(s.x, s.y);
            html += "<td>" + shortNumber(v.mean, "%.3g") + "<br><small>single stacks ± " +
                    shortNumber(sweep::spreadAt(v.spread, d.measuredAt, d.shells), "%.2g") + "</small></td>";
        }
        html += "</tr>";
    }
    return html + "</table></div>";
}

std::string pageOf(const Design& d, const std::vector<SweepFigure>& charts) {
    std::string html =
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Design</title><style>" +
        std::string(report::pageStyle()) +
        "table{border-collapse:collapse;font-size:14px}td,th{padding:3px 14px 3px 0;text-align:left;"
        "vertical-align:top}small{color:var(--muted)}</style></head><body><main><header><h1>Design</h1>"
        "<p>From " +
        std::to_string(d.table.rows.size()) + " runs of " + report::escaped(d.sweep.name) +
        ". Scatter of single stacks of " + shortNumber(d.shells) + " shells" +
        (d.shells == d.measuredAt ? "" : ", from that of stacks of " + shortNumber(d.measuredAt) + " by the law 1/√N") +
        ".</p></header>";
    for (std::size_t i = 0; i < charts.size(); ++i) {
        report::SvgCanvas canvas(charts[i].width, charts[i].height, charts[i].name, charts[i].title);
        charts[i].draw(canvas);
        html += "<div class=\"grid\"><section><h2>" + report::escaped(charts[i].title) + "</h2><div class=\"scroll\">" +
                canvas.finish() + "</div><p>" + report::escaped(charts[i].caption) + "</p>" +
                (d.wishes[i].solutions.empty() ? "<p>No pair of the sweep's range gives this value.</p>"
                                               : tableOf(d, d.wishes[i])) +
                "</section></div>";
    }
    return html + "</main></body></html>\n";
}

int write(const DesignArguments& a, const Design& d) {
    std::vector<SweepFigure> charts;
    std::vector<record::NamedText> files;
    for (const Wish& w : d.wishes) {
        charts.push_back(designChart(w.surface, w.quantity, w.value));
        report::CairoCanvas canvas(charts.back().width, charts.back().height, 1.5);
        charts.back().draw(canvas);
        auto png = canvas.png();
        if (!png)
            return complain(kCannotWrite, png.error);
        files.emplace_back(charts.back().name + ".png", std::move(png.value));
        files.emplace_back(charts.back().name + ".csv", csvOf(d, w));
    }
    files.emplace_back("design.html", pageOf(d, charts));
    const std::string folder = a.out.empty() ? a.results + "/design" : a.out;
    if (const std::string error = record::writeAtomically(folder, files); !error.empty())
        return complain(kCannotWrite, error);
    if (!a.quiet)
        std::printf("chart and table: %s/design.html\n", folder.c_str());
    return kDone;
}

void print(const Design& d) {
    for (const Wish& w : d.wishes) {
        std::printf("%s = %s:\n", quantityLabel(w.quantity).c_str(), shortNumber(w.value).c_str());
        for (const Solution& s : w.solutions) {
            std::printf("  ");
            if (!w.surface.yName.empty())
                std::printf("%s = %-6.3g ", w.surface.yName.c_str(), s.y);
            std::printf("%s = %.3f +- %.3f", w.surface.xName.c_str(), s.x, s.xError);
            for (const auto& [name, surface] : d.others) {
                const Surface::Value v = surface.at(s.x, s.y);
                if (name == w.quantity || name == "delta_max_over_R" || name == "eta")
                    std::printf("; %s %.3g, single stacks +- %.2g", name.c_str(), v.mean,
                                sweep::spreadAt(v.spread, d.measuredAt, d.shells));
            }
            std::printf("\n");
        }
        if (w.solutions.empty()) {
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
    if (const int code = answer(a, d); code != kDone)
        return code;
    if (!a.quiet)
        print(d);
    if (const int code = write(a, d); code != kDone)
        return code;
    const bool none = std::all_of(d.wishes.begin(), d.wishes.end(), [](const Wish& w) { return w.solutions.empty(); });
    return !printed() ? kCannotWrite : none ? kBadInput : kDone;
}

} // namespace supercircle::cli
