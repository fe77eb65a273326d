#pragma once
// Scenes at the scale of games (shells of radius 1 m, frames of 1/60 s) for the benchmarks of game quality and of
// welded boxes: a shell on a cylinder, and piles in a box.

#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/bench/bench.h"
#include "plugin/scene/loader/scene.h"
#include "supercircle/contact/geometry.h"
#include "supercircle/step/port.h"
#include "supercircle/step/rigid_definition.h"

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

namespace supercircle::cli {

using rod::Vec2;

constexpr double kGameFrame = 1.0 / 60.0; ///< s
constexpr double kGameRadius = 1.0;       ///< m
constexpr double kGameMass = 2.0;         ///< kg

/// Pairs (shell and shell, shell and itself, shell and solid) whose centre lines cross in this configuration.
int crossedPairs(const std::vector<contact::RodCurve>& curves, const std::vector<contact::Outline>& outlines);

/// Results of one run, of shells or welded boxes.
struct GameRun {
    std::string name;
    double stretch = 0.0;       ///< largest relative stretch
    int crossings = 0;          ///< pairs crossed at the end
    double peak = 0.0;          ///< of the crosshead force, over theory (cylinders)
    double cpu = 0.0;           ///< s of CPU time per simulated second
    std::vector<double> frames; ///< ms of wall time
    std::vector<double> force;  ///< N, on the crosshead, mean of each frame
    int budgetExhausted = 0;    ///< frames that ran out of budget
    double height = 0.0;        ///< m, of the pile at the end
    double stored = 0.0;        ///< J, bending and gravity at the end
    std::string failure;        ///< empty unless the run could not continue
    std::vector<contact::RodCurve> curves;
};

/// A shell pushed over a cylinder, with its theoretical peak force.
struct CylinderCase {
    const char* name;
    double phi_bar; ///< 1
    double mu;      ///< 1
    double theory;  ///< B/R^2
};
/// Type I at 300 degrees: a simulation with 121 arcs and thickness R/500, which agrees with the solved references at
/// other angles to 0.3 % (docs/results/validation.md). Type II: unfolding force of the solved reference.
constexpr CylinderCase kCylinders[] = {{"smooth", 300.0 / 360.0, 0.35, 0.2059}, {"snap", 0.9, 0.3, 5.281}};

/// A shell over the cylinder, `gap` (m) above first contact; travelOf(): 98 % of the travel to the seated position, m.
ShellDef onCylinder(const CylinderCase& which, int elements, double gap);
double travelOf(const ShellDef& onCylinder);
/// The disc, static or of a mass (kg), without gravity.
step::RigidWorldDefinition cylinderWorld(double mu, double mass);

/// Shells dropped into a box.
struct PileCase {
    int shells = 30;
    int batchSize = 30;  ///< shells that enter at a time ...
    double every = 0.7;  ///< ... every so many seconds
    double width = 10.4; ///< m; the default is the paper's 200 mm at R = 19.2 mm
    double seconds = 5.0;
    double mu = 0.35;
    int elements = 15;
    int threads = 1;
    std::uint64_t seed = 1;
};
step::RigidWorldDefinition boxWorld(const PileCase& pile);
scene::Drop dropOf(const PileCase& pile);

/// Largest sustained force: maximum of the running medians of five frames' mean forces. Spikes of single frames are
/// left out: a shell that hits the cylinder after a snap, or a vibrating joint.
class SustainedPeak {
public:
    explicit SustainedPeak(double unit) : unit_(unit) {}
    void add(double force);
    [[nodiscard]] double highest() const { return highest_; }

private:
    double unit_;
    std::array<double, 5> last_{};
    std::size_t count_ = 0;
    double highest_ = 0.0;
};

/// Outlines of the first `bodies` bodies of a host.
std::vector<contact::Outline> solids(const step::HostWorld& host, std::size_t bodies);

double cpuSeconds();
double wallSeconds();

/// Runs frames for `seconds`; `frame` computes one and returns its length, s, or 0 when it failed.
void runFrames(GameRun& run, double seconds, const std::function<double(double)>& frame);

constexpr double kMachineSpeed = 0.1; ///< m/s
const char* nameOf(Quality quality);
GameRun ourCylinder(const CylinderCase& which, Quality quality, int elements);
GameRun ourPile(const PileCase& pile, Quality quality);

} // namespace supercircle::cli
