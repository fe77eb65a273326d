#pragma once
// Recordings as the statistics see them: columns of numbers and what the machine was doing in each row.

#include "plugin/recording/experiment/experiment.h"

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

enum class Phase : std::uint8_t { Loading, Unloading, Hold, Free };
const char* name(Phase phase);

/// A straight piece of the commanded motion.
struct Leg {
    Phase phase = Phase::Hold;
    double from = 0.0, to = 0.0; ///< s
    double speed = 0.0;          ///< m/s, downwards
    std::size_t stroke = 0;      ///< which it belongs to (RecordedRun::drivenBy)
};

/// What the drive does from one turning point to the next, in however many legs it is given.
struct Stroke {
    Phase phase = Phase::Hold;
    double from = 0.0, to = 0.0; ///< s
};

struct RecordedRun {
    std::string name;
    Eigen::VectorXd time;         ///< s
    Eigen::VectorXd displacement; ///< as commanded, m
    Eigen::VectorXd force;        ///< N; NaN: missing
    std::vector<Leg> legs;
    std::vector<Stroke> strokes;
    std::vector<int> leg;        ///< of each row
    Eigen::VectorXd markerTime;  ///< s
    Eigen::VectorXd markers;     ///< as Response::markers, NaN: not seen
    std::vector<int> markerLeg;  ///< of each marker row
    std::size_t markerCount = 0; ///< markers.size() = 2 markerCount markerTime.size()
    bool turned = false;         ///< its specimens were mounted turned end for end

    [[nodiscard]] Eigen::Index rows() const { return force.size() + markers.size(); }
    /// Of the force's rows, s.
    [[nodiscard]] double spacing() const {
        return time.size() > 1 ? (time[time.size() - 1] - time[0]) / static_cast<double>(time.size() - 1) : 1.0;
    }
    /// The leg of the drive at a time; there must be one.
    [[nodiscard]] const Leg& legAt(double t) const;
    [[nodiscard]] const Stroke& strokeAt(double t) const { return strokes[legAt(t).stroke]; }
    /// Which stroke a row of the force or of the markers belongs to.
    [[nodiscard]] std::size_t stroke(Eigen::Index row) const { return strokeOf(leg, row); }
    [[nodiscard]] std::size_t markerStroke(Eigen::Index row) const { return strokeOf(markerLeg, row); }
    [[nodiscard]] Phase phase(Eigen::Index row) const {
        return legs[static_cast<std::size_t>(leg[static_cast<std::size_t>(row)])].phase;
    }
    /// Sets legs and strokes, and which leg each row belongs to; times of readings and markers must be there.
    /// Neighbouring legs of one direction are one stroke, rests among them too that are shorter than three rows. Legs
    /// of free runs are half swings, each a stroke.
    void drivenBy(std::vector<Leg> pieces);

private:
    [[nodiscard]] std::size_t strokeOf(const std::vector<int>& rows, Eigen::Index row) const {
        return legs[static_cast<std::size_t>(rows[static_cast<std::size_t>(row)])].stroke;
    }
};

/// @param markers how many of its tracks count @param free nothing is driven @param perUnit of what is read
RecordedRun recordedRun(const experiment::Run& run, std::size_t markers, bool free, double perUnit);

/// Whether the machine does the same in both.
bool sameDrive(const RecordedRun& a, const RecordedRun& b);

struct Data {
    std::vector<RecordedRun> runs;
    std::string channel = "force";   ///< what RecordedRun::force holds ...
    std::string unit = "N";          ///< ... and its unit: degrees and mm for poses of free scenes
    bool free = false;               ///< nothing is driven, and the simulation is exact
    double statedForceNoise = 0.0;   ///< N, within about 30 %; 0: not stated
    double statedMarkerNoise = 0.0;  ///< m
    double displacementNoise = 0.0;  ///< m
    double zeroWindow = 0.0;         ///< s, stretch whose mean force was subtracted
    std::vector<double> arcFraction; ///< of each marker
    std::vector<std::string> markerNames;
    /// Name of a marker coordinate: x and y of the first marker, of the second, ...
    [[nodiscard]] std::string markerChannel(Eigen::Index coordinate) const;
    /// The first run that does the same as this one, with specimens mounted alike (itself, if none does before it).
    [[nodiscard]] std::size_t firstOf(std::size_t run) const;
    /// How many runs have this one's drive, itself included, however specimens are mounted: what simulations are off by
    /// is the same in them. Of free scenes 1.
    [[nodiscard]] std::size_t repeatsOf(std::size_t run) const;
    [[nodiscard]] double peakForce() const;
};

/// The recordings of an experiment. Runs without readings are left out of every sum (all rows missing).
Data dataOf(const experiment::Experiment& experiment);

} // namespace supercircle::diagnosis
