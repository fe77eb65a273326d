#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "plugin/graphics/decimate.h"
#include "plugin/graphics/plot.h"
#include "plugin/graphics/theme.h"
#include "plugin/pages/run/figures.h"

namespace supercircle::pages {

using namespace graphics;

namespace {

using record::Event;
using record::Recording;

struct CurveData {
    const std::vector<double>& displacement;
    const std::vector<double>& force;
    AxisRange x, y;       ///< of the drawing
    std::size_t peak = 0; ///< row of the largest force
};

/// Curve and its drawing range. Travel before first contact is cut off, where the force is still zero.
std::optional<CurveData> curveOf(const Recording& recording) {
    if (!hasForceCurve(recording))
        return std::nullopt;
    const auto* displacement = recording.series.find("displacement_m");
    const auto* force = recording.series.find("force_N");
    const double huge = std::numeric_limits<double>::infinity();
    CurveData curve{*displacement, *force, {huge, -huge}, {0.0, 0.0}, 0};
    AxisRange all{huge, -huge};
    double most = 0.0, best = -huge;
    for (const RowRange& range : finiteRanges(*displacement, *force))
        for (std::size_t i = range.first; i <= range.last; ++i) {
            const double f = (*force)[i], d = (*displacement)[i];
            curve.y = {std::min(curve.y.lo, f), std::max(curve.y.hi, f)};
            all = {std::min(all.lo, d), std::max(all.hi, d)};
            most = std::max(most, std::abs(f));
            if (f > best) {
                best = f;
                curve.peak = i;
            }
        }
    if (!(all.lo <= all.hi))
        return std::nullopt;
    for (const RowRange& range : finiteRanges(*displacement, *force))
        for (std::size_t i = range.first; i <= range.last; ++i)
            if (std::abs((*force)[i]) > 2e-3 * most || most == 0.0) {
                curve.x.lo = std::min(curve.x.lo, (*displacement)[i]);
                curve.x.hi = std::max(curve.x.hi, (*displacement)[i]);
            }
    if (all.lo <= 0.0 && all.hi >= 0.0)
        curve.x = {std::min(curve.x.lo, 0.0), std::max(curve.x.hi, 0.0)};
    curve.x = padded(curve.x, 0.04);
    curve.y = padded(curve.y, 0.07);
    return curve;
}

void drawBranches(Canvas& canvas, const Plot& plot, const CurveData& curve, const std::vector<CurveBranch>& branches) {
    const int cycles = branches.empty() ? 1 : branches.back().cycle;
    // Late cycles first and paler: the first cycle stays on top.
    for (auto branch = branches.rbegin(); branch != branches.rend(); ++branch) {
        const auto first = static_cast<std::ptrdiff_t>(branch->rows.first);
        const auto last = static_cast<std::ptrdiff_t>(branch->rows.last) + 1;
        const double fade = cycles < 2 ? 1.0 : 1.0 - 0.6 * (branch->cycle - 1) / (cycles - 1);
        const Colour colour = branch->loading ? theme::loading : theme::unloading;
        plot.drawLine(canvas, {curve.displacement.begin() + first, curve.displacement.begin() + last},
                      {curve.force.begin() + first, curve.force.begin() + last},
                      {colour.alpha(fade), branch->cycle == 1 ? 1.9 : 1.3});
    }
}

void triangle(Canvas& canvas, Point p, double r) {
    canvas.path({{p.x, p.y + r}, {p.x - r, p.y - 0.8 * r}, {p.x + r, p.y - 0.8 * r}}, true,
                {.fill = theme::ink, .stroke = Stroke{theme::paper, 1.0}});
}

void diamond(Canvas& canvas, Point p, double r) {
    canvas.path({{p.x, p.y - r}, {p.x + r, p.y}, {p.x, p.y + r}, {p.x - r, p.y}}, true,
                {.fill = theme::paper, .stroke = Stroke{theme::ink, 1.6}});
}

struct EventMark {
    Point at;
    std::string text;
    enum class Shape { Triangle, Diamond, Ring, Square } shape = Shape::Ring;
};

/// Adds a mark; labels at the same point share it (the peak is often at the reversal).
void addMark(std::vector<EventMark>& marks, EventMark mark) {
    if (mark.shape != EventMark::Shape::Triangle)
        for (EventMark& other : marks)
            if (other.shape != EventMark::Shape::Triangle &&
                std::hypot(other.at.x - mark.at.x, other.at.y - mark.at.y) < 4.0) {
                if (other.text.find(mark.text) == std::string::npos)
                    other.text += ", " + mark.text;
                return;
            }
    marks.push_back(std::move(mark));
}

/// Marks of the events that lie on the curve; snap-fits are numbered as in the list of events.
std::vector<EventMark> marksOf(const Recording& recording, const Plot& plot, const CurveData& curve) {
    std::vector<EventMark> marks;
    bool peak = false;
    int snaps = 0;
    const auto* time = recording.series.find("time_s");
    const double end = time != nullptr && !time->empty() ? time->back() : std::numeric_limits<double>::infinity();
    for (const Event& event : recording.events) {
        if (event.kind == "reversal" && event.time >= end) // the end of the test is no reversal
            continue;
        const bool snap = event.kind == "snap_fit";
        snaps += snap ? 1 : 0;
        if (!std::isfinite(event.displacement) || !std::isfinite(event.force) || event.displacement < plot.x.lo ||
            event.displacement > plot.x.hi)
            continue;
        const Point p = plot.at(event.displacement, std::clamp(event.force, plot.y.lo, plot.y.hi));
        if (snap)
            addMark(marks, {{p.x, p.y - 9.0}, std::to_string(snaps), EventMark::Shape::Triangle});
        else if (event.kind == "first_contact")
            addMark(marks, {p, "first contact", EventMark::Shape::Ring});
        else if (event.kind == "reversal")
            addMark(marks, {p, "reversal", EventMark::Shape::Square});
        else if (event.kind == "peak") {
            addMark(marks, {p, "peak " + significant(event.force, 3) + " N", EventMark::Shape::Diamond});
            peak = true;
        }
    }
    if (!peak && curve.force[curve.peak] > 0.0)
        addMark(marks, {plot.at(curve.displacement[curve.peak], curve.force[curve.peak]),
                        "peak " + significant(curve.force[curve.peak], 3) + " N", EventMark::Shape::Diamond});
    return marks;
}

/// Keeps labels off the curve: small boxes along it, also along jumps.
void reserveCurve(LabelPlacer& placer, const Plot& plot, const CurveData& curve) {
    for (const RowRange& range : finiteRanges(curve.displacement, curve.force)) {
        Point last{};
        bool first = true;
        for (const std::size_t row : decimate(curve.force, range, 200)) {
            const Point p = plot.at(curve.displacement[row], curve.force[row]);
            const double length = first ? 0.0 : std::hypot(p.x - last.x, p.y - last.y);
            const int pieces = std::clamp(static_cast<int>(length / 4.0), 1, 200);
            for (int k = first ? pieces : 1; k <= pieces && length > 0.5; ++k) {
                const double w = static_cast<double>(k) / pieces;
                placer.reserve({last.x + w * (p.x - last.x) - 1.5, last.y + w * (p.y - last.y) - 1.5, 3.0, 3.0});
            }
            if (first || length > 0.5)
                last = p;
            first = false;
        }
    }
}

void drawMarks(Canvas& canvas, const Plot& plot, const CurveData& curve, const std::vector<EventMark>& marks) {
    LabelPlacer placer({plot.area.x + 2.0, plot.area.y + 2.0, plot.area.width - 4.0, plot.area.height - 4.0});
    reserveCurve(placer, plot, curve);
    for (const EventMark& mark : marks)
        placer.reserve({mark.at.x - 5.0, mark.at.y - 5.0, 10.0, 10.0});
    for (const EventMark& mark : marks) {
        if (mark.shape == EventMark::Shape::Triangle)
            triangle(canvas, mark.at, 4.6);
        else if (mark.shape == EventMark::Shape::Diamond)
            diamond(canvas, mark.at, 5.5);
        else if (mark.shape == EventMark::Shape::Square)
            canvas.rectangle({mark.at.x - 3.5, mark.at.y - 3.5, 7.0, 7.0},
                             {.fill = theme::paper, .stroke = Stroke{theme::ink, 1.4}});
        else
            canvas.circle(mark.at, 4.0, {.fill = theme::paper, .stroke = Stroke{theme::ink, 1.4}});
    }
    // Texts first, then as many snap-fit numbers as fit.
    for (const bool texts : {true, false})
        for (const EventMark& mark : marks)
            if ((mark.shape != EventMark::Shape::Triangle) == texts)
                placer.place(canvas, mark.at, 7.0, mark.text, {texts ? 12.0 : 10.5, theme::ink, Anchor::Middle});
}

void drawLegend(Canvas& canvas, Point at, int cycles, bool unloading, bool snaps) {
    const auto entry = [&](const std::string& text) {
        canvas.text({at.x, at.y}, text, {12.0, theme::ink});
        at.x += textWidth(text, 12.0) + 18.0;
    };
    const auto sample = [&](const Colour& colour) {
        canvas.line({at.x, at.y - 4.0}, {at.x + 20.0, at.y - 4.0}, {colour, 2.4});
        at.x += 26.0;
    };
    sample(theme::loading);
    entry("loading");
    if (unloading) {
        sample(theme::unloading);
        entry("unloading");
    }
    if (snaps) {
        triangle(canvas, {at.x + 4.0, at.y - 4.5}, 4.6);
        at.x += 14.0;
        entry("snap-fit");
    }
    if (cycles > 1)
        entry("cycles 1 (strong) to " + std::to_string(cycles) + " (pale)");
}

} // namespace

bool hasForceCurve(const Recording& recording) {
    const auto* displacement = recording.series.find("displacement_m");
    const auto* force = recording.series.find("force_N");
    if (displacement == nullptr || force == nullptr)
        return false;
    const auto varies = [](const std::vector<double>& values) {
        return std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) != values.end();
    };
    return varies(*displacement) || varies(*force);
}

std::optional<PlotFrame> drawForce(Canvas& canvas, const Recording& recording, const Rect& sheet,
                                   const std::string& title) {
    const std::optional<CurveData> curve = curveOf(recording);
    if (!curve)
        return std::nullopt;
    const bool scaled = recording.R > 0.0 && recording.B > 0.0;
    const double head = title.empty() ? 0.0 : 30.0;
    const double top = sheet.y + head + 26.0 + (recording.R > 0.0 ? 46.0 : 8.0);
    const Rect area{sheet.x + 70.0, top, sheet.width - 70.0 - (scaled ? 72.0 : 22.0), sheet.bottom() - 52.0 - top};
    const Plot plot(area, curve->x, curve->y);

    const DisplayUnit mm = {1e3, "mm"};
    const DisplayUnit force = readableUnit(std::max(std::abs(curve->y.lo), std::abs(curve->y.hi)), "N");
    PlotStyle style;
    style.x = {"displacement (" + mm.text + ")", mm.factor};
    style.y = {"force (" + force.text + ")", force.factor};
    if (recording.R > 0.0)
        style.top = AxisStyle{"displacement / R", 1.0 / recording.R};
    if (scaled)
        style.right = AxisStyle{"force / (B/R²)", recording.R * recording.R / recording.B};
    style.xTicks = sheet.width > 800.0 ? 10 : 8;
    plot.drawFrame(canvas, style);

    const std::vector<CurveBranch> branches = curveBranches(curve->displacement);
    canvas.pushClip(area);
    drawBranches(canvas, plot, *curve, branches);
    canvas.popClip();
    const std::vector<EventMark> marks = marksOf(recording, plot, *curve);
    drawMarks(canvas, plot, *curve, marks);
    if (!title.empty())
        canvas.text({sheet.x + 20.0, sheet.y + 28.0}, title, {theme::titleSize, theme::ink, Anchor::Start, true});
    const bool unloading =
        std::any_of(branches.begin(), branches.end(), [](const CurveBranch& branch) { return !branch.loading; });
    const bool snaps = std::any_of(marks.begin(), marks.end(),
                                   [](const EventMark& mark) { return mark.shape == EventMark::Shape::Triangle; });
    drawLegend(canvas, {area.x, sheet.y + head + 18.0}, branches.empty() ? 1 : branches.back().cycle, unloading, snaps);
    return PlotFrame{area, plot.x, plot.y};
}

} // namespace supercircle::pages
