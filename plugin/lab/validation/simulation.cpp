#include "plugin/lab/validation/simulation.h"

#include "plugin/lab/validation/reference_table.h"
#include "supercircle/support/order_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <stdexcept>

namespace supercircle::validation {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

} // namespace

std::string text(const char* format, ...) {
    char buffer[1024];
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(buffer, sizeof buffer, format, arguments);
    va_end(arguments);
    return buffer;
}

std::string SimulationCase::command() const {
    std::string out = "supercircle run scenes/" + scene + ".json";
    for (const scene::Override& p : parameters)
        out += " --param " + p.name + text("=%g", p.value);
    if (fixedDt > 0.0)
        out += text(" --fixed-dt %g", fixedDt);
    return out;
}

double ForceCurve::at(double x) const {
    return interpolate(d, f, x);
}

double ForceCurve::top() const {
    return f.empty() ? kNone : *std::max_element(f.begin(), f.end());
}

double ForceCurve::bottom() const {
    return f.empty() ? kNone : *std::min_element(f.begin(), f.end());
}

double interpolate(const std::vector<double>& xs, const std::vector<double>& ys, double x) {
    for (std::size_t i = 1; i < xs.size(); ++i)
        if ((xs[i - 1] - x) * (xs[i] - x) <= 0.0 && xs[i] != xs[i - 1])
            return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
    return kNone;
}

Parameters thin(double thickness) {
    const double ratio = thickness / 5e-4; // mass goes as density * thickness, stiffness as thickness^3
    return {{"thickness", thickness}, {"density", 1270.0 * ratio * ratio}};
}

scene::Scene load(const ValidationSettings& settings, const SimulationCase& what) {
    std::vector<scene::Problem> problems;
    auto scene = scene::load(settings.scenes + "/" + what.scene + ".json", what.parameters, problems);
    if (!scene)
        for (const scene::Problem& p : problems)
            if (p.severity == scene::Problem::Severity::Error)
                throw std::runtime_error(p.toString());
    if (scene->protocol && what.loadingOnly && scene->protocol->segments.size() > 1)
        scene->protocol->segments.resize(1);
    if (scene->protocol && what.untilForce > 0.0 && !scene->shells.empty()) {
        const double R = scene->report.R;
        scene->protocol->segments.front().stop_when.force =
            what.untilForce * bending_modulus(scene->shells.front()) / (R * R);
    }
    if (what.frames > 0.0)
        scene->report.sample_dt = what.frames;
    if (what.positionTolerance > 0.0)
        scene->numerics.position_tolerance = what.positionTolerance;
    return *scene;
}

namespace {

lab::RunResult simulate(const ValidationSettings& settings, ValidationExperiment& experiment, const scene::Scene& scene,
                        double fixedDt, bool frames, const std::string& name) {
    std::string error;
    std::shared_ptr<step::HostWorld> host = settings.host(scene.rigid, error);
    if (!host)
        throw std::runtime_error(name + ": " + error);
    lab::RunOptions options;
    options.fixedDt = fixedDt;
    options.keepFrames = frames;
    options.interrupt = settings.interrupt;
    ++experiment.runs;
    lab::RunResult out = lab::runScene(scene, host, options);
    if (out.status != lab::RunStatus::Done)
        throw std::runtime_error(name + ": " + out.message);
    return out;
}

} // namespace

lab::RunResult simulate(const ValidationSettings& settings, ValidationExperiment& experiment,
                        const SimulationCase& what) {
    return simulate(settings, experiment, load(settings, what), what.fixedDt, what.frames > 0.0, what.command());
}

lab::RunResult simulate(const ValidationSettings& settings, ValidationExperiment& experiment, const scene::Scene& scene,
                        double fixedDt) {
    return simulate(settings, experiment, scene, fixedDt, true, scene.name);
}

MeasuredCurves measureCurves(const ValidationSettings& settings, ValidationExperiment& experiment,
                             const SimulationCase& what) {
    MeasuredCurves out;
    out.recording = simulate(settings, experiment, what).recording;
    const record::Recording& r = out.recording;
    const std::vector<double>& d = *r.series.find("displacement_m");
    const std::vector<double>& f = *r.series.find("force_N");
    const double unit = r.B / (r.R * r.R);
    const auto turn = static_cast<std::size_t>(std::max_element(d.begin(), d.end()) - d.begin());
    for (std::size_t i = 0; i < d.size(); ++i) {
        ForceCurve& c = i <= turn ? out.loading : out.unloading;
        c.d.push_back(d[i] / r.R);
        c.f.push_back(f[i] / unit);
    }
    return out;
}

namespace {

/// Eight points an interval from the cubic through its four nearest rows.
ForceCurve refined(const ForceCurve& c) {
    ForceCurve out;
    const int n = static_cast<int>(c.d.size());
    for (int i = 0; i + 1 < n; ++i) {
        const int first = std::clamp(i - 1, 0, n - 4);
        const double* x = c.d.data() + first;
        const double* y = c.f.data() + first;
        const double from = c.d[static_cast<std::size_t>(i)], to = c.d[static_cast<std::size_t>(i) + 1];
        for (int k = 0; k < (i + 2 < n ? 8 : 9); ++k) {
            const double at = from + (to - from) * k / 8.0;
            double sum = 0.0;
            for (int a = 0; a < 4; ++a) {
                double weight = y[a];
                for (int b = 0; b < 4; ++b)
                    if (b != a)
                        weight *= (at - x[b]) / (x[a] - x[b]);
                sum += weight;
            }
            out.d.push_back(at);
            out.f.push_back(sum);
        }
    }
    return out;
}

} // namespace

ForceCurve reference(const ValidationSettings& settings, const std::string& file, const std::string& d,
                     const std::string& f, bool smooth) {
    const ReferenceTable table(settings.data, file);
    const ForceCurve curve{table.column(d), table.column(f)};
    return smooth && table.rows() >= 4 && table.rows() < 60 ? refined(curve) : curve;
}

double worstDifference(const ForceCurve& measured, const ForceCurve& expected, double from, double to, int count) {
    double worst = 0.0;
    for (int i = 0; i < count; ++i) {
        const double x = from + (to - from) * i / (count - 1);
        const double difference = std::abs(measured.at(x) - expected.at(x));
        if (!(difference <= worst)) // NaN (a missing point) persists
            worst = std::isnan(worst) ? worst : difference;
    }
    return worst;
}

std::pair<double, double> collapseLoad(const ForceCurve& load) {
    double d = 0.0, top = 0.0;
    for (std::size_t i = 0; i + 4 < load.f.size(); ++i) {
        std::array<double, 5> f{};
        std::copy_n(load.f.begin() + static_cast<std::ptrdiff_t>(i), 5, f.begin());
        const double middle = upperMedian(f);
        if (middle > top) {
            top = middle;
            d = load.d[i + 2];
        } else if (top > 1.0 && middle < 0.98 * top)
            return {d, top};
    }
    return {kNone, kNone};
}

ForceCurve atZeroThickness(const ForceCurve& thin, const ForceCurve& twice, double from, double to, int count) {
    ForceCurve out;
    for (int i = 0; i < count; ++i) {
        const double x = from + (to - from) * i / (count - 1);
        out.d.push_back(x);
        out.f.push_back(2.0 * thin.at(x) - twice.at(x));
    }
    return out;
}

double topBetween(const ForceCurve& curve, double from, double to) {
    double top = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < curve.d.size(); ++i)
        if (curve.d[i] >= from && curve.d[i] <= to)
            top = std::max(top, curve.f[i]);
    return top;
}

double bottomBetween(const ForceCurve& curve, double from, double to) {
    double bottom = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < curve.d.size(); ++i)
        if (curve.d[i] >= from && curve.d[i] <= to)
            bottom = std::min(bottom, curve.f[i]);
    return bottom;
}

Diagram convergenceStudy(const std::string& title, const std::string& xLabel, const std::vector<double>& xs,
                         const std::vector<std::string>& names, double target,
                         const std::function<double(std::size_t, double)>& error) {
    Diagram diagram{title, xLabel, "| error |, %", true, true, 100.0 * target, {}};
    for (std::size_t i = 0; i < names.size(); ++i) {
        PlotLine line{names[i], {}, {}, PlotLine::Style::Connected, static_cast<int>(i)};
        for (const double x : xs) {
            const double e = error(i, x);
            if (!std::isfinite(e))
                continue;
            line.x.push_back(x);
            line.y.push_back(100.0 * std::abs(e));
        }
        diagram.lines.push_back(line);
    }
    return diagram;
}

PlotLine markers(const ForceCurve& curve, double from, double to, int count, std::string name, int colour) {
    PlotLine line{std::move(name), {}, {}, PlotLine::Style::Points, colour};
    for (int i = 0; i < count; ++i) {
        const double x = from + (to - from) * i / std::max(1, count - 1), y = curve.at(x);
        if (std::isfinite(y)) {
            line.x.push_back(x);
            line.y.push_back(y);
        }
    }
    return line;
}

PlotLine solid(const ForceCurve& curve, std::string name, int colour) {
    return {std::move(name), curve.d, curve.f, PlotLine::Style::Reference, colour};
}

Check checkAgainst(std::string description, double measured, double reference, std::optional<double> target,
                   std::string reason) {
    return {std::move(description), measured, reference, measured / reference - 1.0, "value", target,
            std::move(reason),      false};
}

} // namespace supercircle::validation
