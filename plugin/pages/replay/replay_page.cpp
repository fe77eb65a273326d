#include "plugin/pages/replay/replay_page.h"

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/page_builder.h"
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

using graphics::Anchor;
using graphics::AxisRange;
using graphics::Canvas;
using graphics::Plot;
using graphics::PlotStyle;
using graphics::Rect;
namespace theme = graphics::theme;

constexpr double kWidth = 1180.0, kHeight = 560.0; // px
constexpr graphics::Colour kRecorded = theme::ink, kSimulated = theme::loading, kResidual = theme::unloading;

struct Columns {
    const experiment::Readings& recorded;
    const experiment::Readings& simulated;
    const replay::Comparison& comparison;
};

void drawWindows(Canvas& canvas, const Plot& plot, const Columns& c) {
    const std::vector<double>& time = c.recorded.time;
    for (std::size_t i = 0; i < time.size(); ++i) {
        if (!c.comparison.excluded[i])
            continue;
        std::size_t j = i;
        while (j + 1 < time.size() && c.comparison.excluded[j + 1])
            ++j;
        const double left = plot.at(time[i], 0.0).x, right = plot.at(time[j], 0.0).x;
        canvas.rectangle({left, plot.area.y, right - left, plot.area.height}, {.fill = theme::grid});
        i = j;
    }
}

void drawForces(Canvas& canvas, const Plot& plot, const std::vector<double>& x, const std::vector<double>& xSimulated,
                const Columns& c) {
    canvas.pushClip(plot.area);
    plot.drawLine(canvas, x, c.recorded.force, {kRecorded, 2.6});
    plot.drawLine(canvas, xSimulated, c.simulated.force, {kSimulated, 1.2});
    canvas.popClip();
}

/// @param excluded whether samples are excluded in this picture
void drawLegend(Canvas& canvas, double x, double y, bool excluded) {
    const auto entry = [&](const char* word, const graphics::Colour& colour, double width) {
        canvas.line({x, y - 4.0}, {x + 24.0, y - 4.0}, {colour, width});
        canvas.text({x + 30.0, y}, word, {theme::labelSize, theme::muted});
        x += 46.0 + graphics::textWidth(word, theme::labelSize);
    };
    entry("recorded", kRecorded, 2.6);
    entry("simulated", kSimulated, 1.2);
    entry("simulated - recorded", kResidual, 1.2);
    if (!excluded)
        return;
    canvas.rectangle({x, y - 11.0, 24.0, 12.0}, {.fill = theme::grid});
    canvas.text({x + 30.0, y}, "excluded around jumps", {theme::labelSize, theme::muted});
}

/// The clock of a run; a table has points instead.
graphics::AxisStyle clockOf(const experiment::Experiment& e, const experiment::Run& run) {
    return experiment::isTable(e)
               ? graphics::AxisStyle{"point, from 0", 1.0 / experiment::medianStep(run.readings.time)}
               : graphics::AxisStyle{"time (s)", 1.0};
}

/// Force over displacement on the left, over time on the right with the residual below.
void drawRun(Canvas& canvas, const experiment::Experiment& e, const experiment::Channel& channel,
             const experiment::Run& run, const ReplayedRun& done) {
    const bool free = experiment::isFree(e);
    const graphics::AxisStyle clock = clockOf(e, run);
    const experiment::DriveAxis drive = experiment::driveAxis(e);
    const Columns c{run.readings, done.simulated.readings, done.comparison};
    const auto unitFor = [&](double size) {
        return free || channel.unit != "N" ? graphics::DisplayUnit{channel.perUnit, channel.unit}
                                           : graphics::readableUnit(size, "N");
    };
    const graphics::DisplayUnit unit = unitFor(c.comparison.peakRecorded);
    const double worst = *std::max_element(c.comparison.residual.begin(), c.comparison.residual.end(),
                                           [](double a, double b) { return std::abs(a) < std::abs(b); });
    const graphics::DisplayUnit fine =
        unitFor(std::max(c.comparison.maxError, std::isfinite(worst) ? 0.1 * std::abs(worst) : 0.0));
    const AxisRange force = graphics::rangeOf({&c.recorded.force, &c.simulated.force});
    const AxisRange time = graphics::padded({run.driveTime.front(), run.driveTime.back()}, 0.01);
    drawLegend(canvas, 80.0, 24.0, c.comparison.excludedFraction > 0.0);

    const std::string label = std::string(channel.name) + " (" + unit.text + ")";
    PlotStyle style;
    style.y = {label, unit.factor};
    const double from = free ? 80.0 : 640.0; // free scenes have no displacement
    const Plot left({80.0, 40.0, 470.0, 460.0},
                    graphics::rangeOf({&c.recorded.displacement, &c.simulated.displacement}), force);
    style.x = {drive.label(), drive.perUnit};
    if (!free) {
        left.drawFrame(canvas, style);
        drawForces(canvas, left, c.recorded.displacement, c.simulated.displacement, c);
    }

    const Plot upper({from, 40.0, 1160.0 - from, 270.0}, time, force);
    style.x = {"", clock.factor};
    drawWindows(canvas, upper, c);
    upper.drawFrame(canvas, style);
    drawForces(canvas, upper, c.recorded.time, c.simulated.time, c);

    std::vector<double> shown = c.comparison.residual;
    for (std::size_t i = 0; i < shown.size(); ++i)
        if (c.comparison.excluded[i])
            shown[i] = std::numeric_limits<double>::quiet_NaN();
    const Plot lower({from, 345.0, 1160.0 - from, 155.0}, time, graphics::rangeOf({&shown}));
    style.x = clock;
    style.y = {"residual (" + fine.text + ")", fine.factor};
    style.yTicks = 5;
    drawWindows(canvas, lower, c);
    lower.drawFrame(canvas, style);
    canvas.pushClip(lower.area);
    lower.drawLine(canvas, c.recorded.time, shown, {kResidual, 1.2});
    canvas.popClip();
}

/// A further channel in place of the first one.
std::pair<experiment::Run, ReplayedRun> withChannel(const experiment::Run& run, const ReplayedRun& done,
                                                    std::size_t index) {
    std::pair<experiment::Run, ReplayedRun> out(run, done);
    const replay::ChannelComparison& errors = done.comparison.further[index];
    out.first.readings.force = run.readings.further[index];
    out.second.simulated.readings.force = index < done.simulated.readings.further.size()
                                              ? done.simulated.readings.further[index]
                                              : std::vector<double>(run.readings.time.size(), std::nan(""));
    out.second.comparison.residual = errors.residual;
    out.second.comparison.peakRecorded = errors.peakRecorded;
    out.second.comparison.maxError = errors.maxError;
    return out;
}

std::string percent(double part, double whole) {
    return whole > 0.0 ? fixed(100.0 * part / whole, 2) + " %" : "";
}

/// Rows of the table of one run.
std::string figures(const ReplayedRun& run, const experiment::Experiment& e, const experiment::Run& recorded) {
    const graphics::AxisStyle clock = clockOf(e, recorded);
    const experiment::Channel& channel = experiment::channel(e);
    const double k = channel.perUnit;
    const std::string unit = std::string(" ") + channel.unit;
    const replay::Comparison& c = run.comparison;
    std::string html = "<table>";
    const auto row = [&](const std::string& what, const std::string& value) {
        html += "<tr><td>" + what + "</td><td>" + value + "</td></tr>";
    };
    row("peak, recorded", rounded(k * c.peakRecorded, 4) + unit + "");
    row("peak, simulated", rounded(k * c.peakSimulated, 4) + unit + "");
    row("rms error", rounded(k * c.rmse, 4) + unit + " (" + percent(c.rmse, c.peakRecorded) + " of the peak)");
    row("rms error about its mean",
        rounded(k * c.rmseAboutMean, 4) + unit + " (mean " + rounded(k * c.residualMean, 4) + unit + ")");
    row("largest error", rounded(k * c.maxError, 4) + unit + " (" + percent(c.maxError, c.peakRecorded) + ") at " +
                             (experiment::isTable(e) ? "point " : "") + rounded(clock.factor * c.maxErrorAt, 4) +
                             (experiment::isTable(e) ? ", from 0" : " s"));
    row("excluded around jumps", fixed(100.0 * c.excludedFraction, 1) + " % of the samples");
    for (std::size_t i = 0; i < c.further.size(); ++i) {
        const experiment::Channel& own = experiment::furtherChannels(e)[i].channel;
        row(own.name + ", rms and largest error", rounded(own.perUnit * c.further[i].rmse, 4) + " " + own.unit + " (" +
                                                      percent(c.further[i].rmse, c.further[i].peakRecorded) +
                                                      " of the peak), " +
                                                      rounded(own.perUnit * c.further[i].maxError, 4) + " " + own.unit);
    }
    if (!run.simulated.markers.time.empty())
        row("markers, rms and largest distance",
            fixed(1e3 * c.markerRmse, 3) + " mm, " + fixed(1e3 * c.markerMax, 3) + " mm");
    for (const auto& [i, j] : c.matches)
        row("jump at " + fixed(1e3 * c.recorded[i].displacement, 3) + " mm",
            "simulated at " + fixed(1e3 * c.simulated[j].displacement, 3) + " mm");
    row("steps, CPU time", std::to_string(run.simulated.steps) + ", " + fixed(run.simulated.cpuSeconds, 2) + " s");
    return html + "</table>";
}

std::string parameterTable(const Replay& replay) {
    std::string html = "<table><tr><th>parameter</th><th>stated</th><th>used</th></tr>";
    for (const replay::ParameterInfo& info : replay::parameterList(replay.experiment)) {
        const double used = replay::get(replay.parameters, replay.experiment, info.name).value_or(0.0);
        html += "<tr><td>" + graphics::escaped(info.name) + " (" + graphics::escaped(info.about) + ")</td><td>" +
                rounded(info.stated.value, 6) +
                (info.stated.halfWidth > 0.0 ? " ± " + rounded(info.stated.halfWidth, 2) : "") + " " + info.unit +
                "</td><td>" + rounded(used, 6) + "</td></tr>";
    }
    return html + "</table>";
}

/// Where parameters and effects come from, and how a carried law does.
std::string takenParagraph(const TakenFit& t, const experiment::Channel& channel) {
    const std::string of = "the fit \"" + graphics::escaped(t.label) + "\" of " + graphics::escaped(t.file);
    if (!t.carried)
        return "<p>Parameters and effects are those of " + of + ".</p>";
    std::string html = "<p>The law is that of " + of + ". In the pictures all other numbers are as stated.";
    const std::string unit = std::string(" ") + channel.unit;
    if (t.score)
        html += " Where they are fitted inside their intervals, readings that are left out are met to " +
                rounded(t.score->heldOutWith, 3) + unit + " with the law, and to " +
                rounded(t.score->heldOutWithout, 3) + unit + " without it.";
    html += "</p>";
    for (const std::string& note : t.notes)
        html += "<p>" + graphics::escaped(note) + ".</p>";
    return html;
}

} // namespace

Result<std::vector<record::NamedText>> replayPages(const Replay& replay) {
    using Files = std::vector<record::NamedText>;
    Files files;
    graphics::PageBuilder page("Replay of " + replay.experiment.file);
    page.plainTables().introduction(
        "<p>" + graphics::escaped(replay.experiment.description) + "</p>" +
        (replay.taken ? takenParagraph(*replay.taken, experiment::channel(replay.experiment)) : std::string()));
    for (std::size_t k = 0; k < replay.runs.size(); ++k) {
        const ReplayedRun& run = replay.runs[k];
        if (run.comparison.residual.empty())
            continue;
        std::string pictures;
        const auto draw = [&](const std::string& suffix, const experiment::Channel& channel,
                              const experiment::Run& recorded, const ReplayedRun& done) -> Status {
            graphics::CairoCanvas png(kWidth, kHeight, 1.5);
            drawRun(png, replay.experiment, channel, recorded, done);
            auto picture = png.png();
            if (!picture)
                return Status::failure(run.name + "_replay" + suffix + ".png: " + picture.error());
            files.emplace_back(run.name + "_replay" + suffix + ".png", *std::move(picture));
            graphics::SvgCanvas svg(kWidth, kHeight, "run" + std::to_string(k + 1) + suffix,
                                    "recorded and simulated " + (suffix.empty() ? "force" : channel.name) + " of " +
                                        run.name);
            drawRun(svg, replay.experiment, channel, recorded, done);
            pictures += "<div class=\"scroll wide\">" + svg.finish() + "</div>";
            return {};
        };
        if (Status drawn = draw("", experiment::channel(replay.experiment), replay.experiment.runs[k], run); !drawn)
            return Result<Files>::failure(drawn.error());
        for (std::size_t i = 0; i < run.comparison.further.size(); ++i) {
            const experiment::Channel& channel = experiment::furtherChannels(replay.experiment)[i].channel;
            const auto [recorded, done] = withChannel(replay.experiment.runs[k], run, i);
            if (Status drawn = draw("_" + channel.name, channel, recorded, done); !drawn)
                return Result<Files>::failure(drawn.error());
        }
        page.section(run.name,
                     (run.simulated.failure.empty() ? "" : "<p>" + graphics::escaped(run.simulated.failure) + "</p>") +
                         pictures + figures(run, replay.experiment, replay.experiment.runs[k]));
    }
    page.section("Parameters", parameterTable(replay) + "<p>" + std::to_string(replay.resolution.elements) +
                                   " elements a specimen</p>");
    files.emplace_back("replay.html", page.html());
    return files;
}

} // namespace supercircle::cli
