#pragma once
// A recorded experiment as plain data: motion of the testing machine, specimens and set-up with uncertainties, and
// readings. SI units throughout, also where files use millimetres.

#include "plugin/api/include/supercircle/definitions.hpp"
#include "plugin/scene/loader/scene.h"
#include "supercircle/support/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::experiment {

/// What is known of a stated value: anywhere within an interval alike, normal about the value, or its logarithm normal
/// about that of the value.
enum class Prior : std::uint8_t { Interval, Normal, LogNormal };

/// A stated value. The true one lies within `halfWidth` of it, uniformly distributed; of the other priors that is three
/// standard deviations.
struct Stated {
    static constexpr double kDeviations = 3.0; ///< standard deviations in a half-width

    double value = 0.0;
    double halfWidth = 0.0; ///< same unit as `value`, 0: exact; of a log-normal prior to first order
    Prior prior = Prior::Interval;
    [[nodiscard]] double lower() const { return value - halfWidth; }
    [[nodiscard]] double upper() const { return value + halfWidth; }
};

enum class Protocol : std::uint8_t {
    ShellOnRigidCylinder,
    TwoShells,
    StripOnRigidFloor,
    ArchBetweenPlates,
    RingBetweenPlates, ///< a closed ring
    TetheredStrip,     ///< a bow: strings from both ends to the crosshead
    FreeScene,         ///< freely moving rigid bodies of a scene file, without a testing machine
    Scene              ///< a scene file, with a testing machine if it has a protocol
};

/// Part that carries a clamp or an obstacle.
enum class Carrier : std::uint8_t { Ground, Crosshead };

enum class ClampPlace : std::uint8_t { None, Middle, FirstEnd };

/// Imposed position and tangent of one section.
struct Clamp {
    ClampPlace where = ClampPlace::None;
    double arcPosition = 0.0;   ///< from the first end, m
    double clampedLength = 0.0; ///< m, 0: one section
    Carrier carriedBy = Carrier::Ground;
    Point initialPoint{};             ///< centre line at displacement 0, m
    double initialTangentAngle = 0.0; ///< rad, from +x counter-clockwise, direction of growing arc length
    std::string initialPlacement;     ///< placement in words, without a clamp
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

/// A rigid surface at its position at displacement 0.
struct Obstacle {
    ObstacleKind kind = ObstacleKind::Plane;
    Point point{};          ///< m, cylinder: axis; plane: any point of it
    double radius = 0.0;    ///< cylinder, m
    Point normal{0.0, 1.0}; ///< plane: unit vector towards the specimen
    Carrier carriedBy = Carrier::Ground;
};

/// A tracked point of the centre line, or of a body of the free scene.
struct Marker {
    std::string name;         ///< column prefix
    std::size_t specimen = 0; ///< index into Experiment::specimens
    double arcFraction = 0.0; ///< 0: first end, 1: last end
    std::string body;         ///< scenes: name of the body or shell
    Point local{};            ///< in its frame, m
};

/// An inextensible string from the specimen to a point, at displacement 0. Its length is that of the straight string of
/// the strung bow.
struct Bowstring {
    double arcFraction = 0.0; ///< where it is attached to the specimen
    Point point{};            ///< its other end, m
    Carrier carriedBy = Carrier::Crosshead;
};

/// A parameter of a scene with its uncertainty.
struct SceneParameter {
    std::string name;
    Stated stated;
    std::string unit{}, about{}; ///< as the scene has them
};

/// A specimen of an experiment with a scene: values of its own replace those of `scene_parameters`.
struct SceneSpecimen {
    std::string id;
    std::vector<SceneParameter> parameters;
};

/// A scene parameter that differs between specimens: theta_s = theta + tau z_s with standard normal z_s and a
/// half-normal tau (docs/theory/diagnosis.md).
struct BatchParameter {
    std::string name;
    double scale = 0.0; ///< of tau, in the unit of the parameter; 0: the specimens share one value
};

/// The channel by which runs are compared, as named in files and messages.
struct Channel {
    std::string name;     ///< "force", or what is observed
    std::string unit;     ///< in files: "N", "deg", "mm"
    std::string column;   ///< of the CSV files
    double perUnit = 1.0; ///< file unit per SI unit (N, rad, m)
    double sign = 1.0;    ///< of the file's numbers against the scene's, +-1
    double weight = 1.0;  ///< of its log-likelihood; 0: it is drawn, not compared
};

/// A channel beside the first one.
struct FurtherChannel {
    std::string observe; ///< name of the observation in the scene
    scene::Observation observation;
    Channel channel;
    Stated zero;        ///< reading where the scene says 0, SI unit of the observation
    double noise = 0.0; ///< the same unit, standard deviation, approximate
};

/// A scene file, and what is recorded of it.
struct FreeScene {
    std::string file;                       ///< scene file or shipped scene, as named in the description
    std::string text;                       ///< its content; empty if only the description was loaded
    std::vector<SceneParameter> parameters; ///< common to all runs
    std::vector<SceneSpecimen> specimens;   ///< empty: all runs have the same
    std::vector<BatchParameter> batch;      ///< parameters of `parameters`
    std::string observe;                    ///< name of the observation in the scene; empty: `observation` is described
    scene::Observation observation;
    Channel channel;
    Stated zero;                         ///< reading where the scene says 0, SI unit of the observation
    std::vector<FurtherChannel> further; ///< recorded and compared beside it
    std::string driveColumn;             ///< of the runs' files: the drive; empty: break points in the description
    double driveScale = 1.0;             ///< of that column: m, or the parameter's unit
    std::string driveParameter; ///< what is driven, a parameter of the loads; empty: the machine's displacement
    std::string driveUnit;      ///< of that parameter, as the scene states it
    bool driven = false;        ///< a machine moves a body or holds of the scene
    /// The files are tables of states of rest, without times: their clock is made up (decision 0220).
    bool table = false;
    bool turns = true;   ///< it has revolute joints
    bool clamps = false; ///< a shell is clamped
    bool rubs = false;   ///< its joints have dry friction of their own, or shells can touch something
};

/// Whether the scene is one that comes with the program: a name without ending and folder.
inline bool namesShipped(const FreeScene& scene) {
    return scene.file.find_first_of("./\\") == std::string::npos;
}

/// Marker positions over time. x[m][k], y[m][k]: marker m of Experiment::markers in row k, m; NaN: not seen.
struct MarkerTracks {
    std::vector<double> time; ///< s
    std::vector<std::vector<double>> x, y;
};

/// Measured readings; columns of equal length.
struct Readings {
    std::vector<double> time;         ///< s, increasing
    std::vector<double> displacement; ///< m, of the crosshead, positive downwards
    /// Positive while the specimen resists loading, N; NaN: missing. In free scenes the recorded pose
    /// (FreeScene::observation), SI unit; runs are compared by this column.
    std::vector<double> force;
    std::vector<std::vector<double>> further{}; ///< of FreeScene::further, SI units; NaN: missing
};

/// One run.
struct Run {
    std::string file;              ///< as named in the description
    std::vector<double> driveTime; ///< s, break points of the drive, increasing
    /// m, positive downwards (in the direction of a scene's machine), or the driven parameter of a scene; linear
    /// between the break points.
    std::vector<double> driveDisplacement;
    double samplingRate = 0.0; ///< Hz
    double start = 0.0;        ///< s, scenes: time of the file at which the simulation begins
    /// From, to: rows in between are not compared, s.
    std::vector<std::pair<double, double>> ignored;
    std::string specimenState;
    /// The specimens with their markers were mounted end for end; they bend to the same side.
    bool specimenReversed = false;
    std::string markersFile;                ///< empty: not tracked
    double markersSamplingRate = 0.0;       ///< Hz
    std::vector<SceneParameter> parameters; ///< parameters of this run of a free scene: its release state
    int specimen = -1;                      ///< index into FreeScene::specimens; -1: none is named
    Readings readings;                      ///< empty if only the description was loaded
    MarkerTracks markers;                   ///< empty: not tracked
};

/// Commanded displacement of the crosshead, m, by a drive of at least two break points.
double commanded(const Run& run, double t);

struct Sensors {
    double forceNoise = 0.0;         ///< N (free scenes: rad or m), standard deviation, approximate
    double forceZeroWindow = 0.0;    ///< s, the mean of this first interval is subtracted; 0: none
    double forceZeroHalfWidth = 0.0; ///< N, the zero of a run lies within this; 0: not stated
    double displacementNoise = 0.0;  ///< m
    double markerNoise = 0.0;        ///< m
    bool forceUnitConfirmed = false; ///< a force beside the scale of bending forces is no error
    std::string displacementChannel;
};

struct Experiment {
    std::string file; ///< path of the file
    std::string text; ///< content of the file; empty: not from a file
    Protocol protocol = Protocol::ShellOnRigidCylinder;
    std::string description;
    Point gravity{0.0, -9.81};       ///< as declared, m/s^2
    bool gravityOfScene = false;     ///< it is that of the scene
    std::vector<Specimen> specimens; ///< of a scene: its shells with the nominal parameters of the first run
    std::vector<Obstacle> obstacles;
    Stated friction;                ///< coefficient of all contacts, 1
    double initialGapHalfWidth = 0; ///< m, of the height of the crosshead at displacement 0
    std::vector<Run> runs;
    Sensors sensors;
    std::vector<Marker> markers;
    std::vector<Bowstring> strings;
    std::optional<FreeScene> scene; ///< of Protocol::FreeScene and Protocol::Scene
};

/// Whether nothing is driven by a testing machine.
inline bool isFree(const Experiment& experiment) {
    return experiment.scene && !experiment.scene->driven;
}

/// Whether a load is prescribed instead of a displacement.
inline bool drivesLoad(const Experiment& experiment) {
    return experiment.scene && !experiment.scene->driveParameter.empty();
}

/// Whether the runs are tables without a clock.
inline bool isTable(const Experiment& experiment) {
    return experiment.scene && experiment.scene->table;
}

/// What drives the runs, as figures and files show it: the machine's displacement, or a parameter of the loads.
struct DriveAxis {
    std::string name = "displacement", unit = "mm";
    double perUnit = 1e3; ///< per m, or 1
    bool isLoad = false;
    [[nodiscard]] std::string label() const { return unit.empty() ? name : name + " (" + unit + ")"; }
    [[nodiscard]] std::string column() const { return unit.empty() ? name : name + "_" + unit; }
};
DriveAxis driveAxis(const Experiment& experiment);

/// Whether rigid bodies on joints are simulated: a scene without shells. The shells of other scenes are the specimens.
inline bool isMechanism(const Experiment& experiment) {
    return experiment.scene && experiment.specimens.empty();
}

/// Name of a protocol in the files.
const char* name(Protocol protocol);

/// Unique names of the runs from their files (with `extension`, or without, as for results). Folders are added to equal
/// names, numbers to repeated files.
std::vector<std::string> runNames(const Experiment& experiment, bool extension);

/// The channel by which runs of this experiment are compared.
const Channel& channel(const Experiment& experiment);

/// Channels beside the first one; none outside of scenes.
const std::vector<FurtherChannel>& furtherChannels(const Experiment& experiment);

/// The experiment with another channel first, by the name of its observation; the first one takes its place.
[[nodiscard]] Result<Experiment> withFirstChannel(Experiment experiment, const std::string& observe);

/// Median time between rows, s; 0 with fewer than two rows.
double medianStep(const std::vector<double>& time);

} // namespace supercircle::experiment
