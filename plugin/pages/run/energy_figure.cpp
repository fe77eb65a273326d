#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "plugin/graphics/decimate.h"
#include "plugin/graphics/plot.h"
#include "plugin/graphics/theme.h"
#include "plugin/pages/run/figures.h"
#include "plugin/pages/run/key_labels.h"

// Lines, not stacked layers: gravity returns energy while the pile falls, position correction and residual change sign,
// and stacked signed layers cannot be read.

namespace supercircle::pages {

using namespace graphics;

namespace {

using record::Recording;

struct EnergyTerm {
    std::string label;
    Colour colour;
    const std::vector<double>* values = nullptr;
    double largest = 0.0;
    bool residual = false;
};

Colour termColour(const std::string& name, std::size_t index) {
    struct Named {
        std::string_view start;
        unsigned rgb;
    };
    static constexpr std::array<Named, 10> known{{{"work", 0x1b1f24},
                                                  {"elastic", 0xc8452d},
                                                  {"bending", 0xc8452d},
                                                  {"gravity", 0x2a6fb8},
                                                  {"kinetic", 0x1f9e89},
                                                  {"friction", 0xd98a00},
                                                  {"impact", 0x8250a8},
                                                  {"effects", 0xc2457f},
                                                  {"numerical", 0x6e7781},
                                                  {"position", 0x8a5a2b}}};
    for (const Named& entry : known)
        if (name.rfind(entry.start, 0) == 0)
            return Colour::hex(entry.rgb);
    static constexpr std::array<unsigned, 4> others{0x4c956c, 0x5e60ce, 0xb56576, 0x457b9d};
    return Colour::hex(others[index % others.size()]);
}

std::vector<EnergyTerm> energyTerms(const Recording& recording) {
    std::vector<EnergyTerm> terms;
    const auto& series = recording.series;
    for (std::size_t i = 0; i < std::min(series.names.size(), series.columns.size()); ++i) {
        const std::string& name = series.names[i];
        if (name.size() < 3 || name.substr(name.size() - 2) != "_J")
            continue;
        EnergyTerm term{keyLabel(name), termColour(name, i), &series.columns[i]};
        term.residual = name.find("residual") != std::string::npos;
        for (const double value : series.columns[i])
            if (std::isfinite(value))
                term.largest = std::max(term.largest, std::abs(value));
        terms.push_back(term);
    }
    return terms;
}

AxisRange rangeOf(const std::vector<EnergyTerm>& terms, bool residual) {
    AxisRange range{0.0, 0.0};
    for (const EnergyTerm& term : terms)
        if (term.residual == residual)
            for (const double value : *term.values)
                if (std::isfinite(value))
                    range = {std::min(range.lo, value), std::max(range.hi, value)};
    return padded(range, 0.06);
}

constexpr double kLabelSize = 12.0, kLeader = 24.0;

/// What the names beside the lines need, with leader and margin.
double widestLabel(const std::vector<EnergyTerm>& terms) {
    double widest = 0.0;
    for (const EnergyTerm& term : terms)
        widest = std::max(widest, textWidth(term.label, kLabelSize, true));
    return kLeader + widest + 12.0;
}

/// Names of the lines at their right ends, moved apart where they overlap, with leader lines.
void labelEnds(Canvas& canvas, const Plot& plot, const std::vector<double>& time,
               const std::vector<EnergyTerm>& terms) {
    struct End {
        double wanted, y;
        const EnergyTerm* term;
    };
    std::vector<End> ends;
    for (const EnergyTerm& term : terms) {
        if (term.residual)
            continue;
        for (std::size_t i = std::min(time.size(), term.values->size()); i-- > 0;)
            if (std::isfinite((*term.values)[i]) && std::isfinite(time[i])) {
                const double y = plot.at(time[i], (*term.values)[i]).y;
                ends.push_back({y, y, &term});
                break;
            }
    }
    std::stable_sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.wanted < b.wanted; });
    constexpr double gap = 16.0;
    for (std::size_t i = 0; i < ends.size(); ++i)
        ends[i].y = std::max(ends[i].wanted, i == 0 ? plot.area.y + 6.0 : ends[i - 1].y + gap);
    double limit = plot.area.bottom() - 4.0;
    for (std::size_t i = ends.size(); i-- > 0; limit = ends[i].y - gap)
        if (ends[i].y > limit)
            ends[i].y = limit;
    const double x = plot.area.right();
    for (const End& end : ends) {
        canvas.path({{x, end.wanted}, {x + 6.0, end.wanted}, {x + 16.0, end.y}, {x + 20.0, end.y}}, false,
                    {.stroke = Stroke{end.term->colour.alpha(0.7), 1.0}});
        canvas.text({x + kLeader, end.y + 4.0}, end.term->label, {kLabelSize, end.term->colour, Anchor::Start, true});
    }
}

/// Strip above the diagram with the names of the phases.
void drawPhases(Canvas& canvas, const Plot& plot, const Recording& recording) {
    struct Phase {
        double start, end;
        std::string name;
    };
    std::vector<Phase> phases;
    for (const auto& frame : recording.frames) {
        if (!std::isfinite(frame.time))
            continue;
        if (!phases.empty() && phases.back().name == frame.phase) {
            phases.back().end = frame.time;
            continue;
        }
        if (!phases.empty())
            phases.back().end = frame.time;
        phases.push_back({frame.time, frame.time, frame.phase});
    }
    if (phases.size() < 2 || phases.size() > 200)
        return;
    const double y = plot.area.y - 20.0;
    for (std::size_t i = 0; i < phases.size(); ++i) {
        const double a = std::clamp(plot.at(phases[i].start, 0.0).x, plot.area.x, plot.area.right());
        const double b = std::clamp(plot.at(phases[i].end, 0.0).x, plot.area.x, plot.area.right());
        if (b - a < 1.0)
            continue;
        const bool load = phases[i].name.rfind("load", 0) == 0, unload = phases[i].name.rfind("unload", 0) == 0;
        const Colour tone = load ? theme::loading.alpha(0.16) : unload ? theme::unloading.alpha(0.16) : theme::grid;
        canvas.rectangle({a + 0.5, y, std::max(b - a - 1.0, 0.5), 17.0}, {.fill = tone});
        if (textWidth(phases[i].name, 11.0) + 6.0 < b - a)
            canvas.text({0.5 * (a + b), y + 12.5}, phases[i].name, {11.0, theme::muted, Anchor::Middle});
    }
}

} // namespace

std::optional<PlotFrame> drawEnergy(Canvas& canvas, const Recording& recording, const Rect& sheet,
                                    const std::string& title) {
    const auto* time = recording.series.find("time_s");
    const std::vector<EnergyTerm> terms = energyTerms(recording);
    if (time == nullptr || time->empty() || terms.empty())
        return std::nullopt;
    const double huge = std::numeric_limits<double>::infinity();
    AxisRange span{huge, -huge};
    for (const double t : *time)
        if (std::isfinite(t))
            span = {std::min(span.lo, t), std::max(span.hi, t)};
    span = padded(span, 0.0);

    const bool residual = std::any_of(terms.begin(), terms.end(), [](const EnergyTerm& b) { return b.residual; });
    const double head = title.empty() ? 0.0 : 30.0;
    const double top = sheet.y + head + 34.0;
    const double bottom = sheet.bottom() - 52.0;
    const double lower = residual ? std::max(70.0, 0.2 * (bottom - top)) : 0.0;
    const Rect area{sheet.x + 70.0, top, sheet.width - 70.0 - widestLabel(terms),
                    bottom - top - (residual ? lower + 26.0 : 0.0)};
    const Plot plot(area, span, rangeOf(terms, false));
    const DisplayUnit unit = readableUnit(std::max(std::abs(plot.y.lo), std::abs(plot.y.hi)), "J");
    PlotStyle style;
    style.x = {residual ? "" : "time (s)", 1.0};
    style.y = {"energy (" + unit.text + ")", unit.factor};
    plot.drawFrame(canvas, style);
    drawPhases(canvas, plot, recording);
    canvas.pushClip(area);
    for (const EnergyTerm& term : terms)
        if (!term.residual)
            plot.drawLine(canvas, *time, *term.values, {term.colour, 1.7});
    canvas.popClip();
    labelEnds(canvas, plot, *time, terms);

    Rect whole = area;
    if (residual) {
        const Rect strip{area.x, area.bottom() + 26.0, area.width, lower};
        const Plot rest(strip, span, rangeOf(terms, true));
        const DisplayUnit small = readableUnit(std::max(std::abs(rest.y.lo), std::abs(rest.y.hi)), "J");
        PlotStyle lowerStyle;
        lowerStyle.x = {"time (s)", 1.0};
        lowerStyle.y = {"(" + small.text + ")", small.factor};
        lowerStyle.yTicks = 3;
        rest.drawFrame(canvas, lowerStyle);
        canvas.pushClip(strip);
        for (const EnergyTerm& term : terms)
            if (term.residual)
                rest.drawLine(canvas, *time, *term.values, {Colour::hex(0x57606a), 1.0});
        canvas.popClip();
        canvas.text({strip.right() + 12.0, strip.y + 0.5 * lower + 4.0}, "residual",
                    {12.0, theme::muted, Anchor::Start, true});
        whole.height = strip.bottom() - area.y;
    }
    if (!title.empty())
        canvas.text({sheet.x + 20.0, sheet.y + 28.0}, title, {theme::titleSize, theme::ink, Anchor::Start, true});
    return PlotFrame{whole, plot.x, plot.y};
}

} // namespace supercircle::pages
