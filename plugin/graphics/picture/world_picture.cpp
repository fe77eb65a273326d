#include "plugin/graphics/picture/world_picture.h"

#include "plugin/graphics/picture/look.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace supercircle::picture {

namespace {

/// Made by the rule of decision 0172: equal steps in OKLab along a path from hue 250 to 464 degrees.
constexpr std::array<unsigned, 24> kEnergy = {0x4584c2, 0x5a82cd, 0x6e7fd4, 0x817bd8, 0x9478d9, 0xa576d6,
                                              0xb574d1, 0xc572ca, 0xd370c0, 0xdf70b5, 0xe874a9, 0xf0789c,
                                              0xf67e90, 0xfa8584, 0xfc8d78, 0xfd976f, 0xffa16b, 0xffac68,
                                              0xffb868, 0xfcc46c, 0xfad077, 0xf8db89, 0xf6e69b, 0xf6f0ae};
constexpr Colour kUnknown = Colour::hex(0x8a9099);
constexpr Point kLight{-0.5, -0.866}; ///< towards the light, px

Colour mix(const Colour& a, const Colour& b, double t) {
    return {a.r + t * (b.r - a.r), a.g + t * (b.g - a.g), a.b + t * (b.b - a.b), a.a};
}
Colour darker(const Colour& c, double by) {
    return {c.r * by, c.g * by, c.b * by, c.a};
}

/// 0 to 1: the share of the full amplitude, in the steps of the colour map; NaN stays.
double level(double energy, double full) {
    constexpr double kLast = kEnergy.size() - 1;
    const double share = std::sqrt(std::max(energy, 0.0) / std::max(full, 1e-300));
    return std::isnan(energy) ? energy : std::round(kLast * std::min(share, 1.0)) / kLast;
}

Colour colourOf(const Shell& shell, std::size_t i) {
    if (i < shell.colours.size())
        return shell.colours[i];
    if (shell.quarantined || i >= shell.energy.size() || std::isnan(shell.energy[i]))
        return kUnknown;
    if (shell.tint)
        return mix(*shell.tint, Colour::hex(kEnergy.back()), 0.8 * level(shell.energy[i], shell.fullEnergy));
    return energyOnDark(shell.energy[i], shell.fullEnergy);
}

struct Sizes {
    double half = 0.0; ///< of the band, px
    double ratio = 1.0;
    [[nodiscard]] bool thick() const { return half >= 2.0 * ratio; } ///< wide enough for a rim and a highlight
};

Sizes sizesOf(const View& view, const Shell& shell) {
    return {std::max(0.5 * shell.thickness * view.pixelsPerMetre, look::thinnest * view.pixelRatio), view.pixelRatio};
}

std::vector<Point> pixels(const View& view, const std::vector<Point>& metres, Point shift = {}) {
    std::vector<Point> out;
    out.reserve(metres.size());
    for (const Point& p : metres) {
        const Point at = view.pixel(p);
        out.push_back({at.x + shift.x, at.y + shift.y});
    }
    return out;
}

/// Whether something within `margin` px of the points can be seen.
bool visible(const View& view, const std::vector<Point>& points, double margin) {
    Point lower{1e300, 1e300}, upper{-1e300, -1e300};
    for (const Point& p : points) {
        lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
        upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
    }
    return upper.x >= -margin && upper.y >= -margin && lower.x <= view.width + margin &&
           lower.y <= view.height + margin;
}

/// The line that the light meets: nearer to the edge where the band faces it.
std::vector<BandVertex> highlight(const std::vector<BandVertex>& body, bool closed, const Sizes& sizes) {
    std::vector<BandVertex> out;
    const std::size_t n = body.size();
    for (std::size_t i = 0; i < n; ++i) {
        const Point before = body[i > 0 ? i - 1 : closed ? n - 1 : 0].at;
        const Point after = body[i + 1 < n ? i + 1 : closed ? 0 : n - 1].at;
        const double dx = after.x - before.x, dy = after.y - before.y;
        const double length = std::max(std::sqrt(dx * dx + dy * dy), 1e-9);
        const Point normal{dy / length, -dx / length};
        const double facing = normal.x * kLight.x + normal.y * kLight.y;
        const double shift = 0.42 * sizes.half * facing;
        out.push_back({{body[i].at.x + shift * normal.x, body[i].at.y + shift * normal.y},
                       0.2 * sizes.half,
                       mix(body[i].colour, look::light, 0.2 + 0.1 * std::round(4.0 * std::abs(facing)))});
    }
    return out;
}

void addShadow(DrawList& list, const View& view, const Shell& shell) {
    const Sizes sizes = sizesOf(view, shell);
    const double away = look::shadowShift * view.pixelRatio + 0.6 * sizes.half;
    const auto line = pixels(view, shell.line, {0.6 * away, away});
    if (visible(view, line, sizes.half))
        list.line(line, shell.closed, sizes.half + view.pixelRatio, look::shadow);
}

struct Style {
    Colour fill, edge;
};

Style styleOf(const Body& body) {
    Style s = body.role == Role::Loose    ? Style{look::loose, look::looseEdge}
              : body.role == Role::Driven ? Style{look::driven, look::drivenEdge}
                                          : Style{look::still, look::stillEdge};
    return {body.fill.value_or(s.fill), body.edge.value_or(s.edge)};
}

void addBodyShadow(DrawList& list, const View& view, const Body& body) {
    const double away = look::shadowShift * view.pixelRatio;
    const auto corners = pixels(view, body.points, {0.6 * away, away});
    const double radius = body.radius * view.pixelsPerMetre;
    if (!body.solid || body.role == Role::Still || !visible(view, corners, radius))
        return;
    if (corners.size() == 1)
        list.disc(corners.front(), radius + view.pixelRatio, look::shadow);
    else
        list.polygon(corners, look::shadow);
}

/// Pieces of one body: all edges first, so that none is seen between two pieces.
void addBody(DrawList& list, const View& view, std::span<const Body> pieces) {
    const double edge = look::edge * view.pixelRatio;
    std::vector<std::vector<Point>> all;
    for (const Body& piece : pieces)
        all.push_back(pixels(view, piece.points));
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Style style = styleOf(pieces[i]);
        const double radius = pieces[i].radius * view.pixelsPerMetre;
        if (all[i].empty() || !visible(view, all[i], radius + edge))
            continue;
        if (all[i].size() == 1)
            list.disc(all[i].front(), radius, style.edge);
        else
            list.line(all[i], pieces[i].solid, pieces[i].solid ? edge : 1.6 * edge, style.edge);
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Style style = styleOf(pieces[i]);
        const double radius = pieces[i].radius * view.pixelsPerMetre;
        if (all[i].empty() || !pieces[i].solid || !visible(view, all[i], radius))
            continue;
        if (all[i].size() == 1)
            list.disc(all[i].front(), std::max(radius - 1.5 * edge, 0.0), style.fill);
        else
            list.polygon(all[i], style.fill);
        if (all[i].size() == 1 && pieces[i].angle) {
            const math::SinCos turn = math::sinCos(*pieces[i].angle);
            const Point c = all[i].front(), end{c.x + 0.65 * radius * turn.cosine, c.y - 0.65 * radius * turn.sine};
            list.line(std::array{c, end}, false, 0.7 * edge, style.edge);
        }
    }
}

void addContacts(DrawList& list, const View& view, const Content& content) {
    for (const Contact& c : content.contacts) {
        const Point at = view.pixel(c.at);
        const double k = content.pixelsPerNewton * view.pixelRatio;
        const Point tip{at.x + k * c.force.x, at.y - k * c.force.y};
        if (c.force.x != 0.0 || c.force.y != 0.0)
            list.line(std::array{at, tip}, false, 0.8 * view.pixelRatio, look::contact);
        list.disc(at, look::mark * view.pixelRatio, look::contact);
    }
    for (const Point& p : content.holds) {
        list.disc(view.pixel(p), (look::mark + 2.6) * view.pixelRatio, look::outline);
        list.disc(view.pixel(p), (look::mark + 1.2) * view.pixelRatio, look::hold);
        list.disc(view.pixel(p), 0.5 * look::mark * view.pixelRatio, look::outline);
    }
}

} // namespace

Colour energyOnDark(double energy, double full) {
    const double x = level(energy, full);
    return std::isnan(x) ? kUnknown
                         : Colour::hex(kEnergy[static_cast<std::size_t>(std::lround(x * (kEnergy.size() - 1)))]);
}

std::string energyText(double joules) {
    static constexpr std::array<const char*, 8> kUnits = {"pJ", "nJ", "\u00b5J", "mJ", "J", "kJ", "MJ", "GJ"};
    double value = joules * 1e12;
    std::size_t unit = 0;
    while (std::abs(value) >= 999.5 && unit + 1 < kUnits.size()) {
        value *= 1e-3;
        ++unit;
    }
    char buffer[48];
    std::snprintf(buffer, sizeof buffer, std::abs(value) < 9.95 ? "%.1f %s" : "%.0f %s", value, kUnits[unit]);
    return buffer;
}

void addGround(DrawList& list, const View& view) {
    const Rect all{0.0, 0.0, view.width, view.height};
    list.polygon(std::array<Point, 4>{{{0.0, 0.0}, {all.width, 0.0}, {all.width, all.height}, {0.0, all.height}}},
                 look::ground);
}

void addShell(DrawList& list, const View& view, const Shell& shell, double alpha) {
    const Sizes sizes = sizesOf(view, shell);
    const std::vector<Point> line = pixels(view, shell.line);
    if (line.size() < 2 || !visible(view, line, sizes.half + 2.0 * sizes.ratio))
        return;
    std::vector<BandVertex> body;
    body.reserve(line.size());
    for (std::size_t i = 0; i < line.size(); ++i)
        body.push_back({line[i], sizes.half, colourOf(shell, i)});
    if (alpha < 1.0)
        return list.band(body, shell.closed, alpha);
    list.line(line, shell.closed, sizes.half + look::gap * sizes.ratio, look::outline);
    if (!sizes.thick())
        return list.band(body, shell.closed);
    std::vector<BandVertex> rim = body;
    for (BandVertex& v : rim)
        v.colour = darker(v.colour, 0.62);
    list.band(rim, shell.closed);
    for (BandVertex& v : body)
        v.halfWidth = std::max(sizes.half - look::rim * sizes.ratio, 0.7 * sizes.half);
    list.band(body, shell.closed);
    list.band(highlight(body, shell.closed, sizes), shell.closed);
}

void addWorld(DrawList& list, const View& view, const Content& content) {
    const Rect whole{0.0, 0.0, view.width, view.height};
    list.clip(whole);
    addBodies(list, view, content.bodies);
    addShells(list, view, content.shells);
    addContacts(list, view, content);
    addSnaps(list, view, content.snaps);
    list.clip(whole);
}

void addBodies(DrawList& list, const View& view, const std::vector<Body>& bodies) {
    for (const Body& body : bodies)
        addBodyShadow(list, view, body);
    for (std::size_t i = 0; i < bodies.size();) {
        std::size_t end = i + 1;
        while (end < bodies.size() && bodies[i].id != 0 && bodies[end].id == bodies[i].id)
            ++end;
        addBody(list, view, std::span(bodies).subspan(i, end - i));
        i = end;
    }
}

void addShells(DrawList& list, const View& view, const std::vector<Shell>& shells) {
    for (const Shell& shell : shells)
        addShadow(list, view, shell);
    for (const Shell& shell : shells)
        addShell(list, view, shell);
}

void addSnaps(DrawList& list, const View& view, const std::vector<SnapMark>& snaps) {
    const double ratio = view.pixelRatio;
    for (const SnapMark& s : snaps) {
        const double left = 1.0 - s.age;
        if (s.flash && !view.reducedMotion)
            list.glow(view.pixel(s.at), look::flashRadius * ratio * (0.7 + 0.3 * s.age), look::flash,
                      look::flashStrength * left * left);
    }
    // A text that would cover that of a larger snap is left out.
    std::vector<const SnapMark*> largest;
    for (const SnapMark& s : snaps)
        largest.push_back(&s);
    std::stable_sort(largest.begin(), largest.end(),
                     [](const SnapMark* a, const SnapMark* b) { return a->released > b->released; });
    std::vector<Rect> taken;
    for (const SnapMark* mark : largest) {
        const SnapMark& s = *mark;
        const double rise = view.reducedMotion ? 0.0 : 22.0 * s.age,
                     seen = view.reducedMotion ? 1.0 : 1.0 - s.age * s.age;
        const Point at = view.pixel(s.at);
        const Point base{at.x, at.y - (16.0 + rise) * ratio};
        const std::string joules = energyText(s.released);
        const double wide = 0.6 * look::snapSize * ratio * static_cast<double>(joules.size());
        const Rect box{base.x - 0.5 * wide, base.y - look::snapSize * ratio, wide, 1.2 * look::snapSize * ratio};
        if (std::any_of(taken.begin(), taken.end(), [&](const Rect& r) { return r.overlaps(box); }))
            continue;
        taken.push_back(box);
        TextLook text{look::snapSize * ratio, look::outline.alpha(0.8 * seen), Anchor::Middle, true};
        list.text({base.x + ratio, base.y + 1.4 * ratio}, joules, text);
        text.colour = look::snapText.alpha(seen);
        list.text(base, joules, text);
    }
}

} // namespace supercircle::picture
