#pragma once
// A recorded experiment as plain data: what the machine did, what is known about specimens and surroundings and how
// well, and what was measured. SI units throughout, also where the files use millimetres.

#include "plugin/include/supercircle/definitions.hpp"

#include <cstddef>
#include <cstdint>
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

enum class Protocol : std::uint8_t { ShellOnRigidCylinder, TwoShells, StripOnRigidFloor, ArchBetweenPlates };

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

/// A tracked point of the centre line.
struct Marker {
    std::string name;         ///< column prefix
    std::size_t specimen = 0; ///< index into Experiment::specimens
    double arcFraction = 0.0; ///< 0: first end, 1: last end
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
    std::vector<double> force;        ///< positive while the specimen resists the way down, N; NaN: missing
};

/// One run of the machine.
struct Run {
    std::string file;                      ///< as named in the description
    std::vector<double> driveTime;         ///< break points of the commanded motion, s, increasing
    std::vector<double> driveDisplacement; ///< m, positive downwards; linear between the break points
    double samplingRate = 0.0;             ///< Hz
    std::string specimenState;
    std::string markersFile;          ///< empty: not tracked
    double markersSamplingRate = 0.0; ///< Hz
    Readings readings;                ///< empty if the description was loaded without its runs
    MarkerTracks markers;             ///< empty: not tracked
};

struct Sensors {
    double forceNoise = 0.0;        ///< standard deviation, N, rough
    double forceZeroWindow = 0.0;   ///< the mean of this first stretch of time is subtracted, s; 0: nothing is
    double displacementNoise = 0.0; ///< m
    double markerNoise = 0.0;       ///< m
    std::string displacementChannel;
};

struct Experiment {
    std::string file; ///< where it was read
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
};

/// Name of a protocol in the files.
const char* name(Protocol protocol);

/// Median time between rows, s; 0 with fewer than two rows.
double medianStep(const std::vector<double>& time);

} // namespace supercircle::experiment
