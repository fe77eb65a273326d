#pragma once
// What a comparison of the laboratory with a solved reference consists of: figures, checks, and what it took.

#include "supercircle/step/port.h"
#include "supercircle/step/rigid_definition.h"

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::validation {

/// Builds the rigid world of a scene (the caller brings the adapter: this folder knows no host engine).
using HostFactory = std::function<std::shared_ptr<step::HostWorld>(const step::RigidWorldDefinition&, std::string&)>;

struct Settings {
    HostFactory host;
    std::string scenes; ///< folder of the scene files
    std::string data;   ///< folder of the reference curves
    bool quick = false; ///< a subset, for the tests
    std::string filter; ///< only experiments whose id or title contains it
    int jobs = 1;       ///< experiments at a time; the digits do not depend on it
    const std::atomic<bool>* interrupt = nullptr;
    std::function<void(const std::string&)> progress; ///< called with one line after each experiment
};

/// One curve of a diagram.
struct Line {
    enum class Style { Reference, Points, Dashed, Connected };
    std::string name; ///< in the legend; empty: not there
    std::vector<double> x, y;
    Style style = Style::Points;
    int colour = 0; ///< index into the palette: one colour per case, reference and points alike
};

/// One diagram.
struct Panel {
    std::string title, xLabel, yLabel;
    bool logX = false, logY = false;
    std::optional<double> target; ///< level drawn across as the error aimed at
    std::vector<Line> lines;
};

/// One figure of error with what is asked of it.
struct Check {
    std::string what;
    double measured = 0.0;
    double wanted = 0.0;
    double error = 0.0;           ///< relative to the scale `of`; the comparison is |error| <= target
    std::string of;               ///< what the error is relative to: "peak", "value", ...
    std::optional<double> target; ///< none: shown, not judged
    std::string why;              ///< where the target comes from, or why it is missed
    /// Missed for a reason that is understood and lies outside the comparison; shown as missed, and a test may fail.
    bool open = false;
    [[nodiscard]] bool pass() const { return !target || (error == error && (error < 0 ? -error : error) <= *target); }
};

struct Experiment {
    std::string id, title;
    std::string about;                 ///< what is compared with what, for a mechanician
    std::vector<std::string> commands; ///< that produce the curves one by one
    std::vector<Panel> panels;
    std::vector<Check> checks;
    std::vector<std::string> remarks; ///< causes found of what is off
    std::string failure;              ///< not empty: it could not be done
    double seconds = 0.0;
    int runs = 0; ///< simulations played
};

/// An experiment that can be run.
struct Definition {
    std::string id, title;
    double cost = 1.0; ///< s, about; the dear ones start first
    std::function<void(const Settings&, Experiment&)> run;
};

/// All of them, in the order of the page.
const std::vector<Definition>& experiments();

} // namespace supercircle::validation
