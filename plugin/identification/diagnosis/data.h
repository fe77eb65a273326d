#pragma once
// Recordings as columns of numbers, with what the testing machine does in each row.

#include "plugin/recording/experiment/experiment.h"
#include "plugin/recording/experiment/natural_units.h"

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

enum class Phase : std::uint8_t { Loading, Unloading, Hold, Free };
const char* name(Phase phase);

/// A part of the commanded motion with constant speed.
struct DriveSegment {
    Phase phase = Phase::Hold;
    double from = 0.0, to = 0.0; ///< s
    double speed = 0.0;          ///< m/s, downwards
    std::size_t stroke = 0;      ///< index of its stroke (RecordedRun::setDrive)
};

/// The motion between two turning points, in one or more segments.
struct Stroke {
    Phase phase = Phase::Hold;
    double from = 0.0, to = 0.0; ///< s
};

struct RecordedRun {
    std::string name;
    Eigen::VectorXd time;         ///< s
    Eigen::VectorXd displacement; ///< as commanded, m
    Eigen::VectorXd force;        ///< N; NaN: missing
    std::vector<DriveSegment> segments;
    std::vector<Stroke> strokes;
    std::vector<int> segmentOfRow;       ///< index of the segment of each row
    Eigen::VectorXd markerTime;          ///< s
    Eigen::VectorXd markers;             ///< m, ordered as Response::markers; NaN: not seen
    std::vector<int> segmentOfMarkerRow; ///< index of the segment of each marker row
    std::size_t markerCount = 0;         ///< markers.size() = 2 markerCount markerTime.size()
    Eigen::VectorXd further;             ///< of RecordedData::further, in the rows of `force`, one after another
    std::size_t furtherCount = 0;        ///< further.size() = furtherCount force.size()
    bool specimenReversed = false;       ///< its specimens are mounted end for end
    std::string specimen;                ///< scenes: id of its specimen; empty: all runs have the same
    experiment::NaturalUnits units;      ///< of the set-up

    [[nodiscard]] Eigen::Index rows() const { return force.size() + markers.size() + further.size(); }
    /// The run with a further channel in place of the force, without markers.
    [[nodiscard]] RecordedRun withChannel(std::size_t channel) const;
    /// Sampling interval of the force, s.
    [[nodiscard]] double spacing() const {
        return time.size() > 1 ? (time[time.size() - 1] - time[0]) / static_cast<double>(time.size() - 1) : 1.0;
    }
    /// The segment of the drive at a time, s. There must be one.
    [[nodiscard]] const DriveSegment& segmentAt(double t) const;
    [[nodiscard]] const Stroke& strokeAt(double t) const { return strokes[segmentAt(t).stroke]; }
    /// Index of the stroke to which a row of the force or of the markers belongs.
    [[nodiscard]] std::size_t stroke(Eigen::Index row) const { return strokeOf(segmentOfRow, row); }
    [[nodiscard]] std::size_t markerStroke(Eigen::Index row) const { return strokeOf(segmentOfMarkerRow, row); }
    [[nodiscard]] Phase phase(Eigen::Index row) const {
        return segments[static_cast<std::size_t>(segmentOfRow[static_cast<std::size_t>(row)])].phase;
    }
    /// Sets segments and strokes, and the segment of each row. Times of readings and markers must be set before.
    /// Neighbouring segments of one direction form one stroke, including dwells shorter than three rows. Each half
    /// oscillation of a free run is a stroke.
    void setDrive(std::vector<DriveSegment> drive);

private:
    [[nodiscard]] std::size_t strokeOf(const std::vector<int>& rows, Eigen::Index row) const {
        return segments[static_cast<std::size_t>(rows[static_cast<std::size_t>(row)])].stroke;
    }
};

/// @param markers number of its tracks to use
/// @param free nothing is driven
/// @param perUnit unit of the reading per SI unit
/// @param further the same of channels beside the first one
RecordedRun recordedRun(const experiment::Run& run, std::size_t markers, bool free, double perUnit,
                        const experiment::NaturalUnits& units, const std::vector<double>& further = {});

/// Whether both repeat one motion: order, direction and speed of their legs agree to 2 % over the travel that they
/// share, at least half of the shorter run's. They may end and turn apart, and have other row times.
bool sameDrive(const RecordedRun& a, const RecordedRun& b);
/// Whether the commands are equal to rounding.
bool identicalDrive(const RecordedRun& a, const RecordedRun& b);

/// A channel beside the first one.
struct FurtherColumn {
    std::string name, unit;
    double statedNoise = 0.0; ///< in its unit; 0: not stated
    double weight = 1.0;      ///< of its log-likelihood; 0: not compared
};

struct RecordedData {
    std::vector<RecordedRun> runs;
    std::string channel = "force";                ///< what RecordedRun::force holds
    std::string unit = "N";                       ///< unit of that channel; degrees or mm for poses of free scenes
    bool free = false;                            ///< nothing is driven
    bool freeShells = false;                      ///< shells move freely, not bodies alone: see freeBodies()
    bool table = false;                           ///< rows are states of rest, without a clock
    bool drivesLoad = false;                      ///< RecordedRun::displacement is a load
    std::optional<experiment::DriveAxis> drive{}; ///< how it is shown; empty: free runs
    double statedForceNoise = 0.0;                ///< N, within about 30 %; 0: not stated
    double statedMarkerNoise = 0.0;               ///< m
    double displacementNoise = 0.0;               ///< m
    double zeroHalfWidth = 0.0;                   ///< N, stated, of the zero of a run; 0: not stated
    double zeroWindow = 0.0;                      ///< s, interval whose mean force is subtracted from the run
    experiment::NaturalUnits units;               ///< of the set-up
    double weight = 1.0;                          ///< of the log-likelihood of the channel
    std::vector<FurtherColumn> further;           ///< channels beside it
    std::vector<double> arcFraction;              ///< of each marker
    std::vector<std::string> markerNames;
    /// The recordings with a further channel in place of the first one, without markers.
    [[nodiscard]] RecordedData withChannel(std::size_t channel) const;
    /// Name of a marker coordinate: x and y of the first marker, of the second, ...
    [[nodiscard]] std::string markerChannel(Eigen::Index coordinate) const;
    /// The first run with the same drive, mounting and specimen; the run itself if there is none before it.
    [[nodiscard]] std::size_t firstOf(std::size_t run) const;
    /// Number of runs with the same drive, this one included, however specimens are mounted. Their simulations share
    /// one error. 1 in free scenes.
    [[nodiscard]] std::size_t repeatsOf(std::size_t run) const;
    [[nodiscard]] double peakForce() const;
    /// Whether bodies alone move freely. Their simulation takes a hundredth of the time of shells, and has no error of
    /// discretisation.
    [[nodiscard]] bool freeBodies() const { return free && !freeShells; }
    /// Usual correlation time of the sensor, s: a quarter of a natural second, at least two rows and at most a
    /// twentieth of a run.
    [[nodiscard]] double usualCorrelationTime() const;
};

/// Why the runs of an experiment have too few readings for a diagnosis; empty: they have enough. A run needs 20. A
/// table, and a run whose noise is stated, needs 6, and all together five more than there are numbers with an interval.
std::string tooFewReadings(const experiment::Experiment& experiment);

/// The recordings of an experiment. All rows of a run without readings are missing.
RecordedData recordedDataOf(const experiment::Experiment& experiment);

} // namespace supercircle::diagnosis
