#pragma once
// Simulates scenes for a comparison and turns the results into dimensionless curves.

#include "plugin/lab/session/run_scene.h"
#include "plugin/lab/validation/experiment.h"
#include "plugin/scene/loader/loader.h"

#include <utility>

namespace supercircle::validation {

/// Named parameters of a scene.
using Parameters = std::vector<scene::Override>;

/// One simulation: the arguments of `supercircle run`.
struct SimulationCase {
    std::string scene; ///< path under the folder of scenes, without .json
    Parameters parameters;
    double fixedDt = 0.0;           ///< s, 0: adaptive
    bool loadingOnly = false;       ///< the first segment of the protocol alone
    double untilForce = 0.0;        ///< B/R^2; > 0: the first segment ends at this force
    double frames = 0.0;            ///< s between kept frames; 0: no frames
    double positionTolerance = 0.0; ///< m; > 0 replaces the scene's
    [[nodiscard]] std::string command() const;
};

/// One branch of a force-displacement curve in units of R and B / R^2.
struct ForceCurve {
    std::vector<double> d, f;
    /// Force at d = x by linear interpolation (d rises or falls along the branch); NaN outside.
    [[nodiscard]] double at(double x) const;
    [[nodiscard]] double top() const;
    [[nodiscard]] double bottom() const;
};

struct MeasuredCurves {
    ForceCurve loading, unloading; ///< split where the displacement is largest
    record::Recording recording;
};

/// Thickness and density of a thin shell (`thickness` in m) with the natural frequencies of the paper's: mass and
/// stiffness decrease alike, so the same speeds stay quasi-static. For SimulationCase::parameters.
Parameters thin(double thickness);

/// Loads and simulates; throws std::runtime_error when the scene is wrong or the simulation cannot continue.
lab::RunResult simulate(const ValidationSettings& settings, ValidationExperiment& experiment,
                        const SimulationCase& what);
/// Simulates a scene made in code, with frames.
lab::RunResult simulate(const ValidationSettings& settings, ValidationExperiment& experiment, const scene::Scene& scene,
                        double fixedDt);
/// The scene of a case, to be changed before it is simulated.
scene::Scene load(const ValidationSettings& settings, const SimulationCase& what);
/// Simulates a case and splits its force curve where the displacement is largest.
MeasuredCurves measureCurves(const ValidationSettings& settings, ValidationExperiment& experiment,
                             const SimulationCase& what);

/// Columns of a reference as a curve. With `smooth`, tables of fewer than 60 rows are refined by cubic interpolation,
/// because linear interpolation between their rows has errors of up to 1 %.
ForceCurve reference(const ValidationSettings& settings, const std::string& file,
                     const std::string& d = "indent_over_R", const std::string& f = "fR2_over_B", bool smooth = false);

/// Largest difference of measured and reference force at `count` points spaced evenly between `from` and `to`.
double worstDifference(const ForceCurve& measured, const ForceCurve& expected, double from, double to, int count = 60);
/// `count` points of a dense curve, spaced evenly along d, for markers.
PlotLine markers(const ForceCurve& curve, double from, double to, int count, std::string name, int colour);
/// A whole curve as a solid line.
PlotLine solid(const ForceCurve& curve, std::string name, int colour);
/// Linear interpolation of a table, y at x; NaN outside.
double interpolate(const std::vector<double>& xs, const std::vector<double>& ys, double x);

/// Displacement and force at collapse: the largest force before it first falls by 2 %, of running medians of five
/// samples; NaN without a collapse. The spikes after the collapse are dynamics (decision 0175).
std::pair<double, double> collapseLoad(const ForceCurve& load);

/// Force at zero thickness by linear extrapolation from thickness h and 2 h, at `count` points.
ForceCurve atZeroThickness(const ForceCurve& thin, const ForceCurve& twice, double from, double to, int count = 400);

/// Largest and smallest force of a branch between two displacements. The sudden start and turn of the crosshead, which
/// give force spikes for a step or two, lie outside.
double topBetween(const ForceCurve& curve, double from, double to);
double bottomBetween(const ForceCurve& curve, double from, double to);

/// Convergence study on logarithmic scales: `error(i, x)`, relative, of case i at each abscissa x.
Diagram convergenceStudy(const std::string& title, const std::string& xLabel, const std::vector<double>& xs,
                         const std::vector<std::string>& names, double target,
                         const std::function<double(std::size_t, double)>& error);

/// printf into a string.
std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// A check of a value, relative to its reference.
Check checkAgainst(std::string description, double measured, double reference, std::optional<double> target,
                   std::string reason);

} // namespace supercircle::validation
