#include "plugin/bench/bench_solver.h"

#include "plugin/graphics/axis.h"
#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/plot.h"
#include "plugin/graphics/theme.h"
#include "plugin/recording/table/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace supercircle::cli {

namespace {

using graphics::Colour;

struct SolverLine {
    const char* solver;
    const char* label;
    Colour colour;
};
/// In drawing order.
constexpr SolverLine kLines[] = {{"plain_50000", "plain Gauss-Seidel, at most 50000", Colour::hex(0x9cc3e6)},
                                 {"plain", "at most 1000", Colour::hex(0x2a6fb8)},
                                 {"accelerated", "accelerated", Colour::hex(0x3a8f5c)},
                                 {"newton", "Newton", Colour::hex(0x8055a0)},
                                 {"path", "path alone", Colour::hex(0xe0a030)},
                                 {"strategy", "strategy (default)", Colour::hex(0xc8452d)}};

double figure(const Measurement& m, const std::string& key) {
    for (const auto& [name, value] : m.more)
        if (name == key)
            return value;
    return 0.0;
}

std::vector<std::string> distinct(const std::vector<SolverRow>& rows, std::string SolverRow::*field) {
    std::vector<std::string> all;
    for (const SolverRow& row : rows)
        if (std::find(all.begin(), all.end(), row.*field) == all.end())
            all.push_back(row.*field);
    return all;
}

std::string cell(const SolverRow& row) {
    char text[48];
    std::snprintf(text, sizeof text, row.median < 9.995 ? "%.2f" : "%.0f", row.median);
    std::string out = text;
    if (row.reached < 1.0) {
        std::snprintf(text, sizeof text, " (%.0f %%)", 100.0 * row.reached);
        out += text;
    }
    return out;
}

std::string power(double exponent) {
    char text[16];
    if (exponent >= 0.0 && exponent <= 5.0)
        std::snprintf(text, sizeof text, "%.0f", std::pow(10.0, exponent));
    else
        std::snprintf(text, sizeof text, "%g", std::pow(10.0, exponent));
    return text;
}

/// Decades of both axes as grid lines with their numbers.
void drawDecades(graphics::Canvas& canvas, const graphics::Plot& plot) {
    namespace theme = graphics::theme;
    for (double e = std::ceil(plot.x.lo); e <= plot.x.hi; e += 1.0) {
        const graphics::Point p = plot.at(e, plot.y.lo);
        canvas.line(p, {p.x, plot.area.y}, {theme::grid, 1.0});
        canvas.text({p.x, p.y + 18.0}, power(e), {theme::tickSize, theme::muted, graphics::Anchor::Middle});
    }
    for (double e = std::ceil(plot.y.lo); e <= plot.y.hi; e += 1.0) {
        const graphics::Point p = plot.at(plot.x.lo, e);
        canvas.line(p, {plot.area.right(), p.y}, {theme::grid, 1.0});
        canvas.text({p.x - 8.0, p.y + 4.0}, power(e), {theme::tickSize, theme::muted, graphics::Anchor::End});
    }
    canvas.rectangle(plot.area, {.stroke = graphics::Stroke{theme::axis, 1.0}});
}

void drawLine(graphics::Canvas& canvas, const graphics::Plot& plot, const std::vector<SolverRow>& rows,
              const SolverLine& line) {
    std::vector<graphics::Point> points;
    for (const SolverRow& row : rows)
        points.push_back(plot.at(std::log10(std::max(1.0, row.contacts)), std::log10(std::max(1e-6, row.median))));
    canvas.path(points, false, {.stroke = graphics::Stroke{line.colour.alpha(0.75), 1.8}});
    for (std::size_t i = 0; i < rows.size(); ++i)
        canvas.circle(points[i], 4.0,
                      {.fill = rows[i].reached >= 1.0 ? line.colour : graphics::theme::paper,
                       .stroke = graphics::Stroke{line.colour, 1.5}});
}

void drawLegend(graphics::Canvas& canvas, double x, double y) {
    namespace theme = graphics::theme;
    for (const SolverLine& line : kLines) {
        canvas.line({x, y - 4.0}, {x + 22.0, y - 4.0}, {line.colour, 2.0});
        canvas.circle({x + 11.0, y - 4.0}, 4.0, {.fill = line.colour});
        canvas.text({x + 30.0, y}, line.label, {theme::tickSize, theme::ink});
        x += 48.0 + graphics::textWidth(line.label, theme::tickSize);
    }
}

graphics::AxisRange decades(const std::vector<SolverRow>& rows, double SolverRow::*field) {
    graphics::AxisRange range{1e300, -1e300};
    for (const SolverRow& row : rows) {
        const double value = std::log10(std::max(1e-6, row.*field));
        range.lo = std::min(range.lo, value);
        range.hi = std::max(range.hi, value);
    }
    return graphics::padded(range, 0.05);
}

} // namespace

std::optional<SolverRow> solverRow(const Measurement& m) {
    const std::vector<std::string> parts = record::splitAt(m.name, '/');
    if (parts.size() != 5 || parts[0] != "solver" || m.samples == 0)
        return std::nullopt;
    SolverRow row;
    row.kind = parts[1];
    row.shells = std::atoi(parts[2].c_str());
    row.solver = parts[3];
    row.tolerance = parts[4];
    row.contacts = figure(m, "contacts_mean");
    row.active = figure(m, "active_mean");
    row.median = m.median;
    row.reached = figure(m, "reached");
    return row;
}

std::string solverTable(const std::vector<SolverRow>& rows) {
    const std::vector<std::string> solvers = distinct(rows, &SolverRow::solver);
    std::string out = "| set | shells | contacts | active | tolerance |";
    std::string rule = "\n|---|---:|---:|---:|---|";
    for (const std::string& solver : solvers) {
        out += " " + solver + " |";
        rule += "---:|";
    }
    out += rule;
    const SolverRow* last = nullptr;
    for (const SolverRow& row : rows) {
        if (last == nullptr || last->kind != row.kind || last->shells != row.shells ||
            last->tolerance != row.tolerance) {
            char head[128];
            std::snprintf(head, sizeof head, "\n| %s | %d | %.0f | %.0f | %s |", row.kind.c_str(), row.shells,
                          row.contacts, row.active, row.tolerance.c_str());
            out += head;
            for (const std::string& solver : solvers) {
                const auto found = std::find_if(rows.begin(), rows.end(), [&](const SolverRow& r) {
                    return r.kind == row.kind && r.shells == row.shells && r.tolerance == row.tolerance &&
                           r.solver == solver;
                });
                out += found == rows.end() ? " - |" : " " + cell(*found) + " |";
            }
        }
        last = &row;
    }
    return out + "\n";
}

std::string solverPicture(const std::vector<SolverRow>& rows, std::string& error) {
    namespace theme = graphics::theme;
    const std::vector<std::string> kinds = distinct(rows, &SolverRow::kind);
    const std::vector<std::string> tolerances = distinct(rows, &SolverRow::tolerance);
    constexpr double width = 420.0, height = 300.0, left = 70.0, top = 110.0, gapX = 50.0, gapY = 80.0;
    graphics::CairoCanvas canvas(left + static_cast<double>(kinds.size()) * (width + gapX),
                                 top + static_cast<double>(tolerances.size()) * (height + gapY), 2.0);
    canvas.text({left, 30.0}, "Contact solvers: CPU time of one warm solve",
                {theme::titleSize, theme::ink, graphics::Anchor::Start, true});
    canvas.text({left, 50.0}, "hollow: some problems of the set did not reach the tolerance",
                {theme::tickSize, theme::muted});
    drawLegend(canvas, left, 74.0);
    const graphics::AxisRange x = decades(rows, &SolverRow::contacts), y = decades(rows, &SolverRow::median);
    for (std::size_t i = 0; i < kinds.size(); ++i)
        for (std::size_t j = 0; j < tolerances.size(); ++j) {
            const graphics::Plot plot({left + static_cast<double>(i) * (width + gapX),
                                       top + static_cast<double>(j) * (height + gapY), width, height},
                                      x, y);
            drawDecades(canvas, plot);
            const std::string title = kinds[i] + ", contact residual <= " + tolerances[j];
            canvas.text({plot.area.x + 10.0, plot.area.y + 20.0}, title, {theme::labelSize, theme::ink});
            canvas.text({plot.area.x + 0.5 * width, plot.area.bottom() + 38.0}, "contacts",
                        {theme::labelSize, theme::ink, graphics::Anchor::Middle});
            if (i == 0)
                canvas.text({plot.area.x - 48.0, plot.area.y + 0.5 * height}, "CPU time / ms",
                            {theme::labelSize, theme::ink, graphics::Anchor::Middle, false, -90.0});
            for (const SolverLine& line : kLines) {
                std::vector<SolverRow> own;
                for (const SolverRow& row : rows)
                    if (row.kind == kinds[i] && row.tolerance == tolerances[j] && row.solver == line.solver)
                        own.push_back(row);
                if (!own.empty())
                    drawLine(canvas, plot, own, line);
            }
        }
    auto png = canvas.png();
    error = png.error();
    return png ? *png : std::string();
}

} // namespace supercircle::cli
