#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "plugin/graphics/colour_map.h"
#include "plugin/graphics/theme.h"
#include "plugin/pages/run/figures.h"
#include "plugin/pages/run/geometry.h"

namespace supercircle::pages {

using namespace graphics;

namespace {

using record::Frame;
using record::OutlineInfo;
using record::Recording;

struct Bounds {
    double lo_x = std::numeric_limits<double>::infinity(), hi_x = -lo_x, lo_y = lo_x, hi_y = -lo_x;
    void add(const Point& p, double r) {
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(r))
            return;
        lo_x = std::min(lo_x, p.x - r);
        hi_x = std::max(hi_x, p.x + r);
        lo_y = std::min(lo_y, p.y - r);
        hi_y = std::max(hi_y, p.y + r);
    }
    [[nodiscard]] bool empty() const { return !(lo_x <= hi_x); }
    [[nodiscard]] double size() const { return std::max(hi_x - lo_x, hi_y - lo_y); }
};

Bounds outlineBounds(const OutlineInfo& outline, const Frame& frame) {
    Bounds bounds;
    for (const Point& p : worldOutline(outline, frame))
        bounds.add(p, outline.radius);
    return bounds;
}

Bounds shellBounds(const Recording& recording, const std::vector<std::size_t>& frames) {
    Bounds bounds;
    for (const std::size_t index : frames) {
        const Frame& frame = recording.frames[index];
        for (std::size_t i = 0; i < std::min(frame.shells.size(), recording.shells.size()); ++i)
            for (const Point& p : centreLine(recording.shells[i], frame.shells[i], 1e-3 * recording.shells[i].length))
                bounds.add(p, 0.5 * recording.shells[i].thickness);
    }
    return bounds;
}

/// World to sheet: uniform scale, centred.
struct SheetMap {
    double scale = 1.0;
    Point origin; ///< sheet position of the world's origin
    [[nodiscard]] Point operator()(const Point& p) const { return {origin.x + scale * p.x, origin.y - scale * p.y}; }
};

SheetMap fit(const View& view, const Rect& area) {
    SheetMap map;
    map.scale = std::min(area.width / view.x.span(), area.height / view.y.span());
    map.origin = {area.x + 0.5 * area.width - map.scale * 0.5 * (view.x.lo + view.x.hi),
                  area.y + 0.5 * area.height + map.scale * 0.5 * (view.y.lo + view.y.hi)};
    return map;
}

void drawBodies(Canvas& canvas, const Recording& recording, const Frame& frame, const SheetMap& map) {
    const std::vector<bool> driven = drivenBodies(recording);
    for (const OutlineInfo& outline : recording.outlines) {
        const bool dark =
            outline.driven || (outline.body >= 0 && static_cast<std::size_t>(outline.body) < driven.size() &&
                               driven[static_cast<std::size_t>(outline.body)]);
        const Stroke edge{dark ? theme::drivenEdge : theme::bodyEdge, 1.0};
        const Colour fill = dark ? theme::driven : theme::body;
        std::vector<Point> points;
        for (const Point& p : worldOutline(outline, frame)) {
            const Point q = map(p);
            points.push_back({std::clamp(q.x, -2e4, 2e4), std::clamp(q.y, -2e4, 2e4)});
        }
        if (outline.kind == OutlineInfo::Kind::Circle && !points.empty())
            canvas.circle(points.front(), outline.radius * map.scale, {.fill = fill, .stroke = edge});
        else if (outline.kind == OutlineInfo::Kind::Polygon)
            canvas.path(points, true, {.fill = fill, .stroke = edge});
        else
            canvas.path(points, false,
                        {.stroke = Stroke{edge.colour, std::max(1.6, 2.0 * outline.radius * map.scale)}});
    }
}

/// Round length for a scale bar, at most `limit` m.
double roundLength(double limit) {
    const double power = std::pow(10.0, std::floor(std::log10(limit)));
    return limit >= 5.0 * power ? 5.0 * power : limit >= 2.0 * power ? 2.0 * power : power;
}

void drawScaleBar(Canvas& canvas, const SheetMap& map, const Rect& area) {
    const double length = roundLength(0.3 * area.width / map.scale);
    if (!std::isfinite(length) || length <= 0.0)
        return;
    const DisplayUnit unit = length < 1.0 ? DisplayUnit{1e3, "mm"} : DisplayUnit{1.0, "m"};
    const double x = area.x + 2.0, y = area.bottom() + 12.0, width = length * map.scale;
    const Stroke stroke{theme::muted, 1.4};
    canvas.line({x, y}, {x + width, y}, stroke);
    canvas.line({x, y - 3.0}, {x, y + 3.0}, stroke);
    canvas.line({x + width, y - 3.0}, {x + width, y + 3.0}, stroke);
    canvas.text({x + width + 8.0, y + 4.0}, significant(length * unit.factor, 1) + " " + unit.text,
                {12.0, theme::muted});
}

/// Displacement and force of a frame; values below a thousandth of the run's largest are shown as 0.
std::string caption(const Recording& recording, const Frame& frame) {
    if (!hasForceCurve(recording) || !std::isfinite(frame.displacement) || !std::isfinite(frame.force))
        return std::isfinite(frame.time) ? "t = " + significant(frame.time, 3) + " s" : std::string{};
    double force = 0.0, travel = 0.0;
    for (const Frame& other : recording.frames) {
        force = std::max(force, std::isfinite(other.force) ? std::abs(other.force) : 0.0);
        travel = std::max(travel, std::isfinite(other.displacement) ? std::abs(other.displacement) : 0.0);
    }
    const auto rounded = [](double value, double largest) { return std::abs(value) < 1e-3 * largest ? 0.0 : value; };
    return significant(1e3 * rounded(frame.displacement, travel), 3) + " mm, " +
           significant(rounded(frame.force, force), 3) + " N";
}

/// The frame with the largest bending energy of all shells.
std::size_t mostBent(const Recording& recording) {
    std::size_t best = 0;
    double most = -1.0;
    for (std::size_t i = 0; i < recording.frames.size(); ++i) {
        double sum = 0.0;
        for (const auto& shell : recording.frames[i].shells)
            sum += std::isfinite(shell.bending_energy) ? shell.bending_energy : 0.0;
        if (sum > most) {
            most = sum;
            best = i;
        }
    }
    return best;
}

} // namespace

std::vector<KeyView> keyViews(const Recording& recording) {
    static const std::array<std::pair<const char*, const char*>, 3> names{
        {{"before", "Before"}, {"peak", "At the peak"}, {"after", "After"}}};
    std::vector<KeyView> views;
    for (std::size_t i = 0; i < names.size() && hasForceCurve(recording); ++i)
        if (const std::int32_t frame = recording.keyFrames[i];
            frame >= 0 && static_cast<std::size_t>(frame) < recording.frames.size())
            views.push_back({names[i].first, names[i].second, static_cast<std::size_t>(frame)});
    if (!views.empty() || recording.frames.empty())
        return views;
    const std::size_t last = recording.frames.size() - 1, bent = mostBent(recording);
    views.push_back({"start", last == 0 ? "Configuration" : "At the start", 0});
    if (bent != 0 && bent != last)
        views.push_back({"peak", "Bent most", bent});
    if (last > 0)
        views.push_back({"end", "At the end", last});
    return views;
}

View viewOf(const Recording& recording, const std::vector<std::size_t>& frames) {
    Bounds bounds = shellBounds(recording, frames);
    const bool shells = !bounds.empty();
    const Bounds near = bounds;
    for (const std::size_t index : frames)
        for (const OutlineInfo& outline : recording.outlines) {
            Bounds o = outlineBounds(outline, recording.frames[index]);
            if (o.empty())
                continue;
            if (shells) { // large bodies are cut off, so that the shells stay visible; small bodies nearby are shown
                          // whole
                const double away =
                    std::max({o.lo_x - near.hi_x, near.lo_x - o.hi_x, o.lo_y - near.hi_y, near.lo_y - o.hi_y});
                if (away > 0.25 * near.size()) // for example a plate that waits high above
                    continue;
                const bool whole = outline.driven || o.size() < 0.6 * near.size();
                const double reach = (whole ? 1.0 : 0.05) * near.size();
                o.lo_x = std::max(o.lo_x, near.lo_x - reach);
                o.hi_x = std::min(o.hi_x, near.hi_x + reach);
                o.lo_y = std::max(o.lo_y, near.lo_y - reach);
                o.hi_y = std::min(o.hi_y, near.hi_y + reach);
                if (!(o.lo_x <= o.hi_x && o.lo_y <= o.hi_y))
                    continue;
            }
            bounds.add({o.lo_x, o.lo_y}, 0.0);
            bounds.add({o.hi_x, o.hi_y}, 0.0);
        }
    if (bounds.empty())
        return {{-1.0, 1.0}, {-1.0, 1.0}};
    const double margin = bounds.size() > 0.0 ? 0.02 * bounds.size() : 1.0;
    return {{bounds.lo_x - margin, bounds.hi_x + margin}, {bounds.lo_y - margin, bounds.hi_y + margin}};
}

double largestBendingEnergy(const Recording& recording) {
    double largest = 0.0;
    for (const Frame& frame : recording.frames)
        for (const auto& shell : frame.shells)
            if (std::isfinite(shell.bending_energy))
                largest = std::max(largest, shell.bending_energy);
    return largest;
}

std::vector<bool> drivenBodies(const Recording& recording) {
    std::vector<bool> driven;
    bool marked = false;
    const auto mark = [&driven](std::size_t body) {
        driven.resize(std::max(driven.size(), body + 1));
        driven[body] = true;
    };
    for (const OutlineInfo& outline : recording.outlines)
        if (outline.driven && outline.body >= 0) {
            mark(static_cast<std::size_t>(outline.body));
            marked = true;
        }
    const auto [before, peak, after] = recording.keyFrames;
    const auto count = static_cast<std::int32_t>(recording.frames.size());
    if (marked || before < 0 || peak < 0 || before >= count || peak >= count)
        return driven;
    const Frame& a = recording.frames[static_cast<std::size_t>(before)];
    const Frame& b = recording.frames[static_cast<std::size_t>(peak)];
    const double travel = std::abs(b.displacement - a.displacement);
    for (std::size_t i = 0; i < std::min(a.bodies.size(), b.bodies.size()); ++i)
        if (travel > 0.0 &&
            std::abs(std::hypot(b.bodies[i].x - a.bodies[i].x, b.bodies[i].y - a.bodies[i].y) - travel) < 0.02 * travel)
            mark(i);
    return driven;
}

void drawConfiguration(Canvas& canvas, const Recording& recording, std::size_t index, const View& view,
                       double energyScale, const Rect& sheet, const std::string& title) {
    const Frame& frame = recording.frames[index];
    const double head = title.empty() ? 4.0 : 46.0;
    const Rect area{sheet.x + 12.0, sheet.y + head, sheet.width - 24.0, sheet.height - head - 26.0};
    const SheetMap map = fit(view, area);
    const Point low = map({view.x.lo, view.y.lo}), high = map({view.x.hi, view.y.hi});
    const Rect picture{low.x, high.y, high.x - low.x, low.y - high.y};
    canvas.pushClip(picture);
    drawBodies(canvas, recording, frame, map);
    for (std::size_t i = 0; i < std::min(frame.shells.size(), recording.shells.size()); ++i) {
        const auto& shell = recording.shells[i];
        std::vector<Point> line = centreLine(shell, frame.shells[i], 0.06 / map.scale);
        for (Point& p : line) {
            p = map(p);
            p = {std::clamp(p.x, -2e4, 2e4), std::clamp(p.y, -2e4, 2e4)};
        }
        const double energy = frame.shells[i].bending_energy;
        const Colour colour = energyColour(energyScale > 0.0 ? energy / energyScale : 0.0);
        // A minimum width keeps the shells visible in pictures of a thousand.
        canvas.path(line, shell.closed, {.stroke = Stroke{colour, std::max(shell.thickness * map.scale, 0.9)}});
    }
    canvas.popClip();
    drawScaleBar(canvas, map, {picture.x, area.y, picture.width, area.height});
    if (!title.empty()) {
        canvas.text({sheet.x + 14.0, sheet.y + 22.0}, title, {15.0, theme::ink, Anchor::Start, true});
        canvas.text({sheet.x + 14.0, sheet.y + 39.0}, caption(recording, frame), {12.0, theme::muted});
    }
}

void drawColourBar(Canvas& canvas, double energyScale, const Rect& sheet) {
    const Rect bar{sheet.x + 14.0, sheet.y + 22.0, sheet.width - 28.0, 12.0};
    constexpr int pieces = 96;
    for (int i = 0; i < pieces; ++i) {
        const double x = bar.x + bar.width * i / pieces;
        // Half a pixel of overlap hides the seams of antialiasing.
        const double width = bar.width / pieces + (i + 1 < pieces ? 0.6 : 0.0);
        canvas.rectangle({x, bar.y, width, bar.height}, {.fill = energyColour((i + 0.5) / pieces)});
    }
    const DisplayUnit unit = readableUnit(energyScale, "J");
    canvas.text({bar.x, sheet.y + 14.0}, "bending energy stored in a shell (" + unit.text + ")", {12.0, theme::ink});
    const Ticks ticks = niceTicks({0.0, energyScale * unit.factor}, sheet.width > 500.0 ? 9 : 6);
    for (const double value : ticks.values) {
        const double x = bar.x + bar.width * value / (energyScale * unit.factor);
        canvas.line({x, bar.bottom() + 1.0}, {x, bar.bottom() + 5.0}, {theme::axis, 1.0});
        canvas.text({x, bar.bottom() + 18.0}, ticks.label(value), {theme::tickSize, theme::muted, Anchor::Middle});
    }
    if (ticks.values.empty())
        canvas.text({bar.x, bar.bottom() + 18.0}, "0", {theme::tickSize, theme::muted});
}

} // namespace supercircle::pages
