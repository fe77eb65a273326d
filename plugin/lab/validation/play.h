#pragma once
// Plays scenes for a comparison and turns what they leave into curves without units.

#include "plugin/lab/session/runner.h"
#include "plugin/lab/validation/experiment.h"
#include "plugin/scene/loader/loader.h"

#include <utility>

namespace supercircle::validation {

/// Named parameters of a scene.
using Parameters = std::vector<scene::Override>;

/// A simulation to be played: what `supercircle run` would be told.
struct Case {
    std::string scene; ///< path under the folder of scenes, without .json
    Parameters parameters;
    double fixedDt = 0.0;           ///< s, 0: adaptive
    bool loadingOnly = false;       ///< the machine's first move alone
    double untilForce = 0.0;        ///< B/R^2; > 0: the first move ends there
    double frames = 0.0;            ///< s between kept frames; 0: no frames
    double positionTolerance = 0.0; ///< m; > 0 replaces the scene's
    [[nodiscard]] std::string command() const;
};

/// A force-displacement leg in units of R and B / R^2.
struct Curve {
    std::vector<double> d, f;
    /// Force at d = x by linear interpolation (d rises or falls along the leg); NaN outside.
    [[nodiscard]] double at(double x) const;
    [[nodiscard]] double top() const;
    [[nodiscard]] double bottom() const;
};

struct Legs {
    Curve load, pull; ///< split where the displacement is largest
    record::Recording recording;
};

/// Thickness and density of a shell as thin as `thickness` (m) with the vibrations of the paper's: mass and stiffness
/// fall alike, and what counts as slow stays what it was. For Case::parameters.
Parameters thin(double thickness);

/// Loads and plays; throws std::runtime_error when the scene is wrong or the simulation cannot go on.
lab::Outcome play(const Settings& settings, Experiment& experiment, const Case& what);
/// Plays a scene made in code, keeping frames.
lab::Outcome play(const Settings& settings, Experiment& experiment, const scene::Scene& scene, double fixedDt);
/// The scene of a case, for those who step it themselves.
scene::Scene load(const Settings& settings, const Case& what);
/// The same as a curve, split where the displacement is largest.
Legs legs(const Settings& settings, Experiment& experiment, const Case& what);

/// Columns of a reference as a curve. Coarse tables (fewer than 60 rows) of one smooth branch are filled in by cubic
/// interpolation when `smooth`: straight lines between their rows would cost up to a per cent.
Curve reference(const Settings& settings, const std::string& file, const std::string& d = "indent_over_R",
                const std::string& f = "fR2_over_B", bool smooth = false);

/// Largest difference of measured and wanted force over `count` places spread evenly between `from` and `to`.
double worstDifference(const Curve& measured, const Curve& wanted, double from, double to, int count = 60);
/// Every so-manieth point of a dense curve, evenly along d, for markers.
Line markers(const Curve& curve, double from, double to, int count, std::string name, int colour);
/// A whole curve as a solid line.
Line solid(const Curve& curve, std::string name, int colour);
/// Linear interpolation of a table, y at x; NaN outside.
double interpolate(const std::vector<double>& xs, const std::vector<double>& ys, double x);

/// Displacement and force at the top before a shell collapses: the largest force before it first falls by 2 %, of
/// medians of five samples so that a jerk of a single step does not count; NaN where it does not. Not the largest drop:
/// once the tips have gone the force swings and the shell hits what is below, with spikes of twice the unfolding force,
/// which are dynamics.
std::pair<double, double> topBeforeCollapse(const Curve& load);

/// Force at vanishing thickness by linear extrapolation from thickness h and 2 h, at `count` places.
Curve atZeroThickness(const Curve& thin, const Curve& twice, double from, double to, int count = 400);

/// Largest and smallest force of a leg between two displacements: the machine's sudden start and turn, which jerk an
/// inextensible shell for a step or two, lie outside.
double topBetween(const Curve& curve, double from, double to);
double bottomBetween(const Curve& curve, double from, double to);

/// Diagram of errors on logarithmic scales: `error(i, x)`, relative, of case i at each abscissa x.
Panel study(const std::string& title, const std::string& xLabel, const std::vector<double>& xs,
            const std::vector<std::string>& names, double target,
            const std::function<double(std::size_t, double)>& error);

/// printf into a string.
std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// A check of a value against another, relative to the wanted value.
Check against(std::string what, double measured, double wanted, std::optional<double> target, std::string why);

} // namespace supercircle::validation
