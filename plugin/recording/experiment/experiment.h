#pragma once
// A recorded experiment as plain data: what the machine did, what is known about specimens and surroundings and how
// well, and what was measured. SI units throughout, also where the files use millimetres.

#include "plugin/api/include/supercircle/definitions.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::experiment {

/// A stated value; the true one lies anywhere (uniformly) within `halfWidth` of it.
struct Stated {
    double value = 0.0;
    double halfWidth = 0.0; ///< same unit as `value`, 0: exact
    [[nodiscard]] double lower() const { return value - halfWidth; }
    [[nodiscard]] double upper() const { return value + halfWidth; }
};

enum class Protocol : std::uint8_t {
    ShellOnRigidCylinder,
    TwoShells,
    StripOnRigidFloor,
    ArchBetweenPlates,
    RingBetweenPlates, ///< a closed ring
    TetheredStrip,     ///< a bow: strings from both ends to the head
    FreeScene          ///< rigid bodies of a scene file, left to themselves: there is no machine
};

/// What carries a clamp or an obstacle.
enum class Carrier : std::uint8_t { Ground, MachineHead };

enum class ClampPlace : std::uint8_t { None, Middle, FirstEnd };

/// Position and tangent of one section imposed.
struct Clamp {
    ClampPlace where = ClampPlace::None;
    double arcPosition = 0.0;   ///< from the first end, m
    double clampedLength = 0.0; ///< m, 0: one section
    Carrier carriedBy = Carrier::Ground;
    Point initialPoint{};             ///< centre line at displacement 0, m
    double initialTangentAngle = 0.0; ///< rad, from +x counter-clockwise, direction of growing arc length
    std::string initialPlacement;     ///< in words, where nothing is clamped
};

/// A flexible strip, straight or curved.
struct Specimen {
    std::string id;
    double length = 0.0;       ///< arc length, m
    Stated naturalCurvature;   ///< 1/m
    Stated thickness;          ///< m
    double width = 0.0;        ///< m
    double youngModulus = 0;   ///< Pa, 0: not stated
    Stated bendingModulus;     ///< N m^2
    double stretchModulus = 0; ///< N, 0: not stated
    Stated linearMass;         ///< kg/m
    Clamp clamp;
};

enum class ObstacleKind : std::uint8_t { Cylinder, Plane };

/// A rigid surface at its place at displacement 0.
struct Obstacle {
    ObstacleKind kind = ObstacleKind::Plane;
    Point point{};          ///< cylinder: axis; plane: any point of it, m
    double radius = 0.0;    ///< cylinder, m
    Point normal{0.0, 1.0}; ///< plane: unit vector towards the specimen
    Carrier carriedBy = Carrier::Ground;
};

/// A tracked point of the centre line, or of a body of the free scene.
struct Marker {
    std::string name;         ///< column prefix
    std::size_t specimen = 0; ///< index into Experiment::specimens
    double arcFraction = 0.0; ///< 0: first end, 1: last end
    std::string body;         ///< free scenes: its name
    Point local{};            ///< in its frame, m
};

/// An inextensible string from the specimen to a point, at displacement 0. Its length is such that it is straight
/// there and then, together with the other one: the bow is braced.
struct String {
    double arcFraction = 0.0; ///< where it is tied to the specimen
    Point point{};            ///< its other end, m
    Carrier carriedBy = Carrier::MachineHead;
};

/// A parameter of a scene and what is known about it.
struct SceneParameter {
    std::string name;
    Stated stated;
    std::string unit{}, about{}; ///< as the scene has them
};

enum class Quantity : std::uint8_t { Angle, X, Y };

/// A mechanism that moves by itself, and which pose of which body is recorded.
struct FreeScene {
    std::string file;                       ///< of the scene, as named in the description
    std::string text;                       ///< its content; empty if the description was loaded alone
    std::vector<SceneParameter> parameters; ///< the same in all runs
    std::string body;
    Quantity quantity = Quantity::Angle;
    double zeroHalfWidth = 0.0; ///< of the reading where the scene says 0, rad or m
};

/// The channel that runs are compared by, as files and messages name it.
struct Channel {
    const char* name;   ///< "force", "angle", "x", "y"
    const char* unit;   ///< in files: "N", "deg", "mm"
    const char* column; ///< NAME_UNIT
    double perUnit;     ///< what one of ours (N, rad, m) is in it
};

/// Where markers were, over time. x[m][k], y[m][k]: marker m of Experiment::markers in row k, m; NaN: not seen.
struct MarkerTracks {
    std::vector<double> time; ///< s
    std::vector<std::vector<double>> x, y;
};

/// What the machine measured; rows of equal length.
struct Readings {
    std::vector<double> time;         ///< s, increasing
    std::vector<double> displacement; ///< of the head, positive downwards, m
    /// Positive while the specimen resists the way down, N; NaN: missing. In free scenes the pose that was recorded
    /// instead (FreeScene::quantity), rad or m: everything that compares runs compares this column.
    std::vector<double> force;
};

/// One run of the machine.
struct Run {
    std::string file;                      ///< as named in the description
    std::vector<double> driveTime;         ///< break points of the commanded motion, s, increasing
    std::vector<double> driveDisplacement; ///< m, positive downwards; linear between the break points
    double samplingRate = 0.0;             ///< Hz
    std::string specimenState;
    /// The specimens were mounted turned end for end, their markers with them; they bend to the same side as before.
    bool turned = false;
    std::string markersFile;                ///< empty: not tracked
    double markersSamplingRate = 0.0;       ///< Hz
    std::vector<SceneParameter> parameters; ///< of the free scene, of this run alone: how it was let go
    Readings readings;                      ///< empty if the description was loaded without its runs
    MarkerTracks markers;                   ///< empty: not tracked
};

/// Where the head is told to be, m, by a drive of two break points or more.
double commanded(const Run& run, double t);

struct Sensors {
    double forceNoise = 0.0;        ///< standard deviation, N (free scenes: rad or m), rough
    double forceZeroWindow = 0.0;   ///< the mean of this first stretch of time is subtracted, s; 0: nothing is
    double displacementNoise = 0.0; ///< m
    double markerNoise = 0.0;       ///< m
    std::string displacementChannel;
};

struct Experiment {
    std::string file; ///< where it was read
    std::string text; ///< what stood there; empty: not from a file
    Protocol protocol = Protocol::ShellOnRigidCylinder;
    std::string description;
    Point gravity{0.0, -9.81}; ///< as declared, m/s^2
    std::vector<Specimen> specimens;
    std::vector<Obstacle> obstacles;
    Stated friction;                ///< coefficient of all contacts, 1
    double initialGapHalfWidth = 0; ///< of the head's height at displacement 0, m
    std::vector<Run> runs;
    Sensors sensors;
    std::vector<Marker> markers;
    std::vector<String> strings;
    std::optional<FreeScene> scene; ///< of Protocol::FreeScene
};

/// Name of a protocol in the files.
const char* name(Protocol protocol);

/// A name for each run, no two alike: its file's (with `extension`, or without, as results are called); with folders
/// where two files are called the same, numbered where a file is named twice.
std::vector<std::string> runNames(const Experiment& experiment, bool extension);

/// The channel that runs of this experiment are compared by.
const Channel& channel(const Experiment& experiment);

/// Median time between rows, s; 0 with fewer than two rows.
double medianStep(const std::vector<double>& time);

} // namespace supercircle::experiment
