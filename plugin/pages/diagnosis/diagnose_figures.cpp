#include "plugin/pages/diagnosis/diagnose_figures.h"

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/colour_map.h"
#include "plugin/graphics/plot.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/graphics/theme.h"
#include "plugin/recording/table/rounded.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::cli {

namespace {

using record::fixed;
using record::rounded;

using diagnosis::Diagnosis;
using diagnosis::RunCurves;
using graphics::Anchor;
using graphics::AxisRange;
using graphics::Canvas;
using graphics::Colour;
using graphics::Plot;
using graphics::PlotStyle;
using graphics::Point;
using graphics::SvgCanvas;
namespace theme = graphics::theme;

constexpr Colour kMarked = Colour::hex(0xf6d9a8);
constexpr Colour kStated = Colour::hex(0xd5dde6);
constexpr double kBar = 5.0; // height of the bars that mark visible intervals

/// Means over a few rows, because residuals of thousands of rows would fill the plot.
std::vector<double> smoothed(const std::vector<double>& u, const std::vector<bool>& counts) {
    const auto reach = static_cast<std::ptrdiff_t>(std::max<std::size_t>(1, u.size() / 160));
    const auto n = static_cast<std::ptrdiff_t>(u.size());
    std::vector<double> out(u.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::ptrdiff_t k = 0; k < n; ++k) {
        double sum = 0.0, rows = 0.0;
        for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, k - reach); j <= std::min(n - 1, k + reach); ++j)
            if (counts[static_cast<std::size_t>(j)]) {
                sum += u[static_cast<std::size_t>(j)];
                rows += 1.0;
            }
        if (counts[static_cast<std::size_t>(k)])
            out[static_cast<std::size_t>(k)] = sum / std::sqrt(rows); // of unit variance for pure noise
    }
    return out;
}

bool isPair(const Diagnosis& d) {
    return !d.effects.empty() && !d.effects.front().jointWith.empty();
}

void legend(Canvas& canvas, double x, double y, const Diagnosis& d, bool improved) {
    const auto entry = [&](const std::string& word, const Colour& colour, double width) {
        canvas.line({x, y - 4.0}, {x + 24.0, y - 4.0}, {colour, width});
        canvas.text({x + 30.0, y}, word, {theme::labelSize, theme::muted});
        x += 44.0 + graphics::textWidth(word, theme::labelSize);
    };
    entry("recorded", theme::ink, 2.6);
    entry("fitted without extra physics", theme::loading, 1.4);
    if (improved)
        entry("with " + improvedBy(d), theme::unloading, 1.4);
    if (std::any_of(d.runs.begin(), d.runs.end(), [](const RunCurves& c) { return !c.statedLow.empty(); })) {
        canvas.rectangle({x, y - 11.0, 24.0, 12.0}, {.fill = kStated});
        canvas.text({x + 30.0, y}, "stated intervals", {theme::labelSize, theme::muted});
        x += 44.0 + graphics::textWidth("stated intervals", theme::labelSize);
    }
    canvas.rectangle({x, y - 11.0, 24.0, 12.0}, {.fill = kMarked});
    canvas.text({x + 30.0, y}, "significant misfit", {theme::labelSize, theme::muted});
    x += 44.0 + graphics::textWidth("significant misfit", theme::labelSize);
    if (!improved)
        return;
    canvas.rectangle({x, y - 7.0, 24.0, kBar}, {.fill = theme::unloading});
    canvas.text({x + 30.0, y}, isPair(d) ? "effects visible" : "effect visible", {theme::labelSize, theme::muted});
}

void markVisibleIntervals(Canvas& canvas, const Plot& plot,
                          const std::vector<diagnosis::TimeInterval>& visibleIntervals) {
    for (const diagnosis::TimeInterval& s : visibleIntervals) {
        const double left = plot.at(s.from, 0.0).x, right = plot.at(s.to, 0.0).x;
        canvas.rectangle({left, plot.area.y + plot.area.height - kBar, right - left, kBar}, {.fill = theme::unloading});
    }
}

/// What simulations with the stated intervals fill, piece by piece between missing rows.
void drawBand(Canvas& canvas, const Plot& plot, const std::vector<double>& across, const RunCurves& c) {
    std::vector<Point> low, high;
    const auto fill = [&] {
        if (low.size() > 1) {
            low.insert(low.end(), high.rbegin(), high.rend());
            canvas.path(low, true, {.fill = kStated});
        }
        low.clear();
        high.clear();
    };
    for (std::size_t k = 0; k < c.statedLow.size(); ++k) {
        if (!std::isfinite(c.statedLow[k]) || !std::isfinite(c.statedHigh[k])) {
            fill();
            continue;
        }
        low.push_back(plot.at(across[k], c.statedLow[k]));
        high.push_back(plot.at(across[k], c.statedHigh[k]));
    }
    fill();
}

void markWindows(Canvas& canvas, const Plot& plot, const Diagnosis& d, const std::string& run,
                 const std::string& channel) {
    for (const diagnosis::ResidualWindow& w : d.misfit.significant)
        if (w.run == run && w.channel == channel && w.kind != diagnosis::StatisticKind::Signature) { // drawn as bars
            const double left = plot.at(w.timeFrom, 0.0).x, right = plot.at(w.timeTo, 0.0).x;
            canvas.rectangle({left, plot.area.y, right - left, plot.area.height}, {.fill = kMarked});
        }
}

constexpr double kRunWidth = 1180.0, kRunHeight = 560.0, kBarsWidth = 720.0;

/// Explanations and their probabilities, effects first.
std::vector<std::pair<std::string, double>> barsOf(const Diagnosis& d) {
    std::vector<std::pair<std::string, double>> bars;
    for (const diagnosis::FittedEffect& e : d.effects)
        bars.emplace_back(diagnosis::plainWords(e.label), e.probability);
    bars.emplace_back("no missing effect", d.adequate);
    bars.emplace_back("too small to be detected", d.undetectable());
    bars.emplace_back("outside the catalogue", d.outsideCatalogue);
    return bars;
}

double barsHeight(const Diagnosis& d) {
    return 26.0 * static_cast<double>(barsOf(d).size()) + 20.0;
}

/// Range of the recorded force, and of the simulated one up to a quarter beyond.
AxisRange forceRange(const RunCurves& c) {
    const AxisRange recorded = graphics::rangeOf({&c.recorded}), simulated = graphics::rangeOf({&c.baseline});
    const double reach = 0.25 * recorded.span();
    return {std::min(recorded.lo, std::max(simulated.lo, recorded.lo - reach)),
            std::max(recorded.hi, std::min(simulated.hi, recorded.hi + reach))};
}

void drawRun(Canvas& canvas, const Diagnosis& d, std::size_t r) {
    const RunCurves& c = d.runs[r];
    const bool improved = !c.improved.empty();
    legend(canvas, 80.0, 24.0, d, improved);
    const AxisRange force = forceRange(c);
    const double peak = std::max(std::abs(force.lo), std::abs(force.hi));
    const graphics::AxisStyle clock = d.table && c.time.size() > 1
                                          ? graphics::AxisStyle{"point, from 0", 1.0 / (c.time[1] - c.time[0])}
                                          : graphics::AxisStyle{"time (s)", 1.0};
    const bool driven = d.drive.has_value();
    const graphics::DisplayUnit unit =
        d.unit == "N" ? graphics::readableUnit(peak, "N") : graphics::DisplayUnit{1.0, d.unit};
    PlotStyle style;
    style.x = driven ? graphics::AxisStyle{d.drive->label(), d.drive->perUnit} : clock;
    style.y = {d.channel + " (" + unit.text + ")", unit.factor};
    const std::vector<double>& across = driven ? c.displacement : c.time;
    const Plot left({80.0, 40.0, 470.0, 460.0}, graphics::rangeOf({&across}), force);
    left.drawFrame(canvas, style);
    canvas.pushClip(left.area);
    drawBand(canvas, left, across, c);
    left.drawLine(canvas, across, c.recorded, {theme::ink, 2.6});
    left.drawLine(canvas, across, c.baseline, {theme::loading, 1.4});
    if (improved)
        left.drawLine(canvas, across, c.improved, {theme::unloading, 1.4});
    canvas.popClip();
    const auto residual = [&](double y, const std::vector<double>& u, const Colour& colour, const std::string& words) {
        const std::vector<double> shown = smoothed(u, c.counts);
        AxisRange range = graphics::rangeOf({&shown});
        range = {std::min(range.lo, -5.0), std::max(range.hi, 5.0)};
        const Plot plot({640.0, y, 520.0, 180.0}, graphics::padded({c.time.front(), c.time.back()}, 0.01), range);
        if (&u == &c.residual)
            markWindows(canvas, plot, d, c.name, d.channel);
        const double top = plot.at(0.0, 2.0).y, bottom = plot.at(0.0, -2.0).y;
        canvas.rectangle({plot.area.x, top, plot.area.width, bottom - top}, {.fill = theme::grid});
        PlotStyle s;
        s.x = clock;
        s.y = {words, 1.0};
        s.yTicks = 5;
        plot.drawFrame(canvas, s);
        canvas.pushClip(plot.area);
        plot.drawLine(canvas, c.time, shown, {colour, 1.3});
        canvas.popClip();
        if (&u == &c.residual)
            markVisibleIntervals(canvas, plot, c.visibleIntervals);
    };
    residual(40.0, c.residual, theme::loading, "residual (sigma)");
    if (improved)
        residual(320.0, c.residualImproved, theme::unloading, isPair(d) ? "with the effects" : "with the effect");
}

constexpr double kPanelWidth = 240.0, kPanelHeight = 110.0; // of a marker coordinate, without its axes
constexpr double kPanelGap = 40.0, kPanelsTop = 56.0;
constexpr std::size_t kPanels = 4; // side by side: x and y of two markers

double markersHeight(const RunCurves& c) {
    return kPanelsTop + (kPanelHeight + kPanelGap) * static_cast<double>((c.markers.size() + kPanels - 1) / kPanels);
}

/// Limits common to all panels of a run, so that coordinates can be compared.
AxisRange markerRange(const std::vector<std::vector<double>>& shown) {
    std::vector<const std::vector<double>*> columns;
    for (const std::vector<double>& u : shown)
        columns.push_back(&u);
    const AxisRange range = graphics::rangeOf(columns);
    return {std::min(range.lo, -5.0), std::max(range.hi, 5.0)};
}

void markerLegend(Canvas& canvas, const Diagnosis& d, const RunCurves& c, bool improved) {
    double x = 50.0;
    const auto entry = [&](const std::string& word, const Colour& colour) {
        canvas.line({x, 20.0}, {x + 24.0, 20.0}, {colour, 1.4});
        canvas.text({x + 30.0, 24.0}, word, {theme::labelSize, theme::muted});
        x += 50.0 + graphics::textWidth(word, theme::labelSize);
    };
    const bool markers = std::any_of(c.markers.begin(), c.markers.end(), [](const auto& m) { return m.ofMarker; });
    const bool further = std::any_of(c.markers.begin(), c.markers.end(), [](const auto& m) { return !m.ofMarker; });
    entry(std::string(markers ? "markers" : "") + (markers && further ? " and " : "") +
              (further ? "further channels" : "") + " over time (s): residual without extra physics (sigma)",
          theme::loading);
    if (improved)
        entry("with " + improvedBy(d), theme::unloading);
}

void drawMarkers(Canvas& canvas, const Diagnosis& d, std::size_t r) {
    const RunCurves& c = d.runs[r];
    const bool improved = !c.improved.empty();
    markerLegend(canvas, d, c, improved);
    std::vector<std::vector<double>> before, after, all;
    for (const diagnosis::MarkerCurve& m : c.markers) {
        before.push_back(smoothed(m.residual, m.counts));
        after.push_back(improved ? smoothed(m.residualImproved, m.counts) : std::vector<double>{});
        all.push_back(before.back());
        all.push_back(after.back());
    }
    const AxisRange range = markerRange(all);
    for (std::size_t i = 0; i < c.markers.size(); ++i) {
        const double x = 50.0 + (kPanelWidth + kPanelGap) * static_cast<double>(i % kPanels);
        const double y = kPanelsTop + (kPanelHeight + kPanelGap) * static_cast<double>(i / kPanels);
        const std::vector<double>& time = c.markers[i].ofMarker ? c.markerTime : c.time;
        const Plot plot({x, y, kPanelWidth, kPanelHeight}, graphics::padded({time.front(), time.back()}, 0.01), range);
        markWindows(canvas, plot, d, c.name, c.markers[i].channel);
        const double top = plot.at(0.0, 2.0).y, bottom = plot.at(0.0, -2.0).y;
        canvas.rectangle({plot.area.x, top, plot.area.width, bottom - top}, {.fill = theme::grid});
        PlotStyle style;
        style.xTicks = 5;
        style.yTicks = 3;
        plot.drawFrame(canvas, style);
        const double place = c.markers[i].arcFraction;
        canvas.text({x, y - 5.0}, c.markers[i].channel + (place < 0.0 ? "" : ", arc fraction " + fixed(place, 2)),
                    {theme::tickSize, theme::ink});
        canvas.pushClip(plot.area);
        plot.drawLine(canvas, time, before[i], {theme::loading, 1.3});
        if (improved)
            plot.drawLine(canvas, time, after[i], {theme::unloading, 1.3});
        canvas.popClip();
    }
}

void drawProbabilities(Canvas& canvas, const Diagnosis& d) {
    const std::vector<std::pair<std::string, double>> bars = barsOf(d);
    for (std::size_t i = 0; i < bars.size(); ++i) {
        const double y = 10.0 + 26.0 * static_cast<double>(i);
        canvas.text({220.0, y + 15.0}, bars[i].first, {theme::labelSize, theme::ink, Anchor::End});
        canvas.rectangle({230.0, y + 2.0, 400.0, 18.0}, {.fill = theme::grid});
        canvas.rectangle({230.0, y + 2.0, 400.0 * bars[i].second, 18.0},
                         {.fill = i < d.effects.size() ? theme::unloading : theme::driven});
        canvas.text({640.0, y + 15.0}, fixed(100.0 * bars[i].second, 1) + " %", {theme::labelSize, theme::muted});
    }
}

} // namespace

std::string improvedBy(const Diagnosis& d) {
    return isPair(d) ? "the most probable pair" : "the most probable effect";
}

std::string runFigure(const Diagnosis& d, std::size_t r) {
    SvgCanvas canvas(kRunWidth, kRunHeight, "run" + std::to_string(r + 1), "forces and residuals of " + d.runs[r].name);
    drawRun(canvas, d, r);
    return canvas.finish();
}

std::string markerFigure(const Diagnosis& d, std::size_t r) {
    const RunCurves& c = d.runs[r];
    if (c.markers.empty())
        return {};
    SvgCanvas canvas(kRunWidth, markersHeight(c), "markers" + std::to_string(r + 1),
                     "residuals of the markers of " + c.name);
    drawMarkers(canvas, d, r);
    return canvas.finish();
}

std::string probabilityFigure(const Diagnosis& d) {
    SvgCanvas canvas(kBarsWidth, barsHeight(d), "probability", "probability of each explanation");
    drawProbabilities(canvas, d);
    return canvas.finish();
}

Result<std::vector<record::NamedText>> diagnosisPictures(const Diagnosis& d) {
    using Files = std::vector<record::NamedText>;
    constexpr double kScale = 1.5;
    Files files;
    const auto keep = [&](const std::string& name, graphics::CairoCanvas& canvas) {
        auto picture = canvas.png();
        if (picture)
            files.emplace_back(name, *std::move(picture));
        return picture ? std::string{} : name + ": " + picture.error();
    };
    for (std::size_t r = 0; r < d.runs.size(); ++r) {
        graphics::CairoCanvas canvas(kRunWidth, kRunHeight, kScale);
        drawRun(canvas, d, r);
        if (std::string why = keep("run_" + std::to_string(r + 1) + "_diagnosis.png", canvas); !why.empty())
            return Result<Files>::failure(std::move(why));
        if (d.runs[r].markers.empty())
            continue;
        graphics::CairoCanvas markers(kRunWidth, markersHeight(d.runs[r]), kScale);
        drawMarkers(markers, d, r);
        if (std::string why = keep("run_" + std::to_string(r + 1) + "_markers.png", markers); !why.empty())
            return Result<Files>::failure(std::move(why));
    }
    graphics::CairoCanvas canvas(kBarsWidth, barsHeight(d), kScale);
    drawProbabilities(canvas, d);
    if (std::string why = keep("probabilities.png", canvas); !why.empty())
        return Result<Files>::failure(std::move(why));
    return files;
}

namespace {

std::string detectableText(double detectable) {
    constexpr double kUnrealistic = 10.0;
    if (!std::isfinite(detectable))
        return "not detectable in these runs";
    if (detectable > kUnrealistic)
        return "above ten times a relevant amplitude";
    return rounded(100.0 * detectable, 3) + " % of a relevant amplitude" + (detectable > 1.0 ? ": not detectable" : "");
}

} // namespace

std::string screenFigure(const Diagnosis& d) {
    std::vector<diagnosis::ScreenedEffect> effects = d.screening;
    std::stable_sort(effects.begin(), effects.end(), [](const auto& a, const auto& b) { return a.gain > b.gain; });
    double most = 10.0;
    for (const diagnosis::ScreenedEffect& s : effects)
        most = std::max(most, s.gain);
    SvgCanvas canvas(980.0, 22.0 * static_cast<double>(effects.size()) + 36.0, "screen",
                     "screening gain of each effect");
    canvas.text({230.0, 14.0}, "explained chi-squared (square root scale)", {theme::tickSize, theme::muted});
    canvas.text({610.0, 14.0}, "detectable amplitude", {theme::tickSize, theme::muted});
    for (std::size_t i = 0; i < effects.size(); ++i) {
        const double y = 22.0 + 22.0 * static_cast<double>(i);
        canvas.text({220.0, y + 13.0}, diagnosis::plainWords(effects[i].label),
                    {theme::labelSize, theme::ink, Anchor::End});
        canvas.rectangle({230.0, y + 2.0, 360.0 * std::sqrt(effects[i].gain / most), 14.0}, {.fill = theme::unloading});
        canvas.text({610.0, y + 13.0}, detectableText(effects[i].detectable), {theme::labelSize, theme::muted});
    }
    return canvas.finish();
}

std::string similarityFigure(const Diagnosis& d) {
    const std::size_t n = d.similarity.size();
    if (n < 2)
        return {};
    constexpr double kCell = 54.0, kLeft = 200.0, kTop = 14.0;
    const double side = kCell * static_cast<double>(n);
    SvgCanvas canvas(kLeft + side + 20.0, kTop + side + 10.0, "similarity", "similarity of the effects' signatures");
    for (std::size_t i = 0; i < n; ++i) {
        const double y = kTop + kCell * static_cast<double>(i);
        canvas.text({kLeft - 8.0, y + 32.0}, diagnosis::plainWords(d.similarityLabels[i]),
                    {theme::labelSize, theme::ink, Anchor::End});
        for (std::size_t j = 0; j < n; ++j) {
            const double x = kLeft + kCell * static_cast<double>(j), v = d.similarity[i][j];
            canvas.rectangle({x, y, kCell - 2.0, kCell - 2.0}, {.fill = graphics::signedColour(0.8 * v)});
            canvas.text({x + 0.5 * kCell, y + 32.0}, fixed(v, 2), {theme::tickSize, theme::ink, Anchor::Middle});
        }
    }
    return canvas.finish();
}

namespace {

/// Points of the unloaded centre line from its first end, m.
std::vector<Point> naturalLine(const experiment::Specimen& s) {
    std::vector<Point> points;
    constexpr int kPieces = 120;
    const double k = s.naturalCurvature.value, h = s.length / kPieces;
    double angle = -0.5 * k * s.length + (k > 0.0 ? 3.14159265358979 : 0.0), x = 0.0, y = 0.0;
    for (int i = 0; i <= kPieces; ++i) {
        points.push_back({x, y});
        x += h * std::cos(angle + 0.5 * k * h);
        y += h * std::sin(angle + 0.5 * k * h);
        angle += k * h;
    }
    return points;
}

/// Arc fraction of the first effect's position, -1: it has none.
double placeOf(const Diagnosis& d) {
    if (!d.effects.empty())
        for (const diagnosis::FittedParameter& p : d.effects.front().parameters)
            if (p.name == "arc_fraction")
                return p.value;
    return -1.0;
}

} // namespace

std::string specimenFigure(const Diagnosis& d, const experiment::Experiment& e) {
    const double place = placeOf(d);
    if (e.specimens.empty() || (place < 0.0 && e.markers.empty()))
        return {};
    const double width = 300.0;
    SvgCanvas canvas(width * static_cast<double>(e.specimens.size()), 260.0, "specimen", "where along the specimen");
    for (std::size_t s = 0; s < e.specimens.size(); ++s) {
        std::vector<Point> line = naturalLine(e.specimens[s]);
        AxisRange x{0.0, 0.0}, y{0.0, 0.0};
        for (const Point& p : line) {
            x = {std::min(x.lo, p.x), std::max(x.hi, p.x)};
            y = {std::min(y.lo, p.y), std::max(y.hi, p.y)};
        }
        const double scale = 190.0 / std::max({x.span(), y.span(), 1e-9});
        for (Point& p : line)
            p = {width * (static_cast<double>(s) + 0.5) + scale * (p.x - 0.5 * (x.lo + x.hi)),
                 125.0 - scale * (p.y - 0.5 * (y.lo + y.hi))};
        canvas.path(line, false, {.stroke = {{theme::ink, 4.0}}});
        const auto at = [&](double f) {
            return line[static_cast<std::size_t>(std::clamp(f, 0.0, 1.0) * static_cast<double>(line.size() - 1))];
        };
        for (const experiment::Marker& m : e.markers)
            if (m.specimen == s)
                canvas.circle(at(m.arcFraction), 4.0, {.fill = theme::driven});
        const bool here =
            place >= 0.0 && (e.specimens.size() == 1 ||
                             d.effects.front().variant.find("specimen " + e.specimens[s].id) != std::string::npos);
        if (here) {
            canvas.circle(at(place), 11.0, {.stroke = {{theme::loading, 3.0}}});
            canvas.text({at(place).x, at(place).y - 18.0}, "arc fraction " + fixed(place, 2),
                        {theme::labelSize, theme::loading, Anchor::Middle});
        }
        canvas.text({width * (static_cast<double>(s) + 0.5), 250.0}, "specimen " + e.specimens[s].id,
                    {theme::labelSize, theme::muted, Anchor::Middle});
    }
    return canvas.finish();
}

} // namespace supercircle::cli
