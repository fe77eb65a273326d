#pragma once
// A validation experiment: simulations compared with a solved reference, as diagrams and checks.

#include "supercircle/step/port.h"
#include "supercircle/step/rigid_definition.h"

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::validation {

/// Builds the rigid world of a scene; the caller provides the adapter to the host engine.
using HostFactory = std::function<std::shared_ptr<step::HostWorld>(const step::RigidWorldDefinition&, std::string&)>;

struct ValidationSettings {
    HostFactory host;
    std::string scenes; ///< folder of the scene files
    std::string data;   ///< folder of the reference curves
    bool quick = false; ///< a subset, for the tests
    std::string filter; ///< an id, or part of ids or titles; empty: all
    int jobs = 1;       ///< experiments at a time; the results do not depend on it
    const std::atomic<bool>* interrupt = nullptr;
    std::function<void(const std::string&)> progress; ///< called with one line after each experiment
};

/// One curve of a diagram.
struct PlotLine {
    enum class Style { Reference, Points, Dashed, Connected };
    std::string name; ///< in the legend; empty: no entry
    std::vector<double> x, y;
    Style style = Style::Points;
    int colour = 0; ///< index into the palette: one colour per case, for reference and points
};

/// Axes and curves of one picture.
struct Diagram {
    std::string title, xLabel, yLabel;
    bool logX = false, logY = false;
    std::optional<double> target; ///< horizontal line: largest error allowed
    std::vector<PlotLine> lines;
};

/// One error with its target.
struct Check {
    std::string description;
    double measured = 0.0;
    double reference = 0.0;
    double error = 0.0;           ///< relative to the scale `relativeTo`; passes if |error| <= target
    std::string relativeTo;       ///< "peak", "value", ...
    std::optional<double> target; ///< none: shown without a verdict
    std::string reason;           ///< where the target comes from, or why it is missed
    /// Missed for a known reason outside the comparison; shown as missed, and a test may fail.
    bool knownDeviation = false;
    [[nodiscard]] bool pass() const { return !target || (error == error && (error < 0 ? -error : error) <= *target); }
};

struct ValidationExperiment {
    std::string id, title;
    std::string about;                 ///< what is compared, for a mechanician
    std::vector<std::string> commands; ///< that produce the curves one by one
    std::vector<Diagram> diagrams;
    std::vector<Check> checks;
    std::vector<std::string> remarks; ///< known causes of deviations
    std::string failure;              ///< not empty: it could not be finished
    double seconds = 0.0;
    int runs = 0; ///< number of simulations
};

/// An experiment that can be run.
struct ExperimentDefinition {
    std::string id, title;
    double cost = 1.0; ///< s, roughly; expensive ones start first
    std::function<void(const ValidationSettings&, ValidationExperiment&)> run;
};

/// All of them, in the order of the page.
const std::vector<ExperimentDefinition>& experiments();

} // namespace supercircle::validation
