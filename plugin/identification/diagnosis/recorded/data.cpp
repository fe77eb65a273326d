#include "plugin/identification/diagnosis/data.h"

#include "plugin/identification/replay/free_scales.h"
#include "plugin/identification/replay/parameters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supercircle::diagnosis {

namespace {

Eigen::VectorXd vectorOf(const std::vector<double>& v) {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

/// Splits a free run at its turning points into half oscillations.
std::vector<DriveSegment> halfOscillationsOf(const experiment::Run& run) {
    const std::vector<double>&t = run.readings.time, &v = run.readings.force;
    const auto [least, most] = std::minmax_element(v.begin(), v.end()); // NaN: compares false, is passed over
    const double back = v.empty() ? 0.0 : 0.02 * (*most - *least);
    std::vector<DriveSegment> segments;
    double from = run.driveTime.front();
    std::size_t turn = 0;
    int way = 0; // direction of the present half oscillation; 0: unknown
    for (std::size_t i = 1; i < v.size(); ++i) {
        if (!std::isfinite(v[i]))
            continue;
        const double moved = v[i] - v[turn];
        if (way == 0 || moved * way > 0.0) {
            turn = way == 0 && std::abs(moved) < back ? turn : i;
            way = way == 0 && std::abs(moved) >= back ? (moved > 0.0 ? 1 : -1) : way;
        } else if (std::abs(moved) > back) {
            segments.push_back({Phase::Free, from, t[turn], 0.0});
            from = t[turn];
            turn = i;
            way = -way;
        }
    }
    segments.push_back({Phase::Free, from, run.driveTime.back(), 0.0});
    return segments;
}

std::vector<DriveSegment> segmentsOf(const experiment::Run& run) {
    std::vector<DriveSegment> segments;
    for (std::size_t i = 1; i < run.driveTime.size(); ++i) {
        const double way = run.driveDisplacement[i] - run.driveDisplacement[i - 1];
        const double time = run.driveTime[i] - run.driveTime[i - 1];
        segments.push_back({way > 0.0   ? Phase::Loading
                            : way < 0.0 ? Phase::Unloading
                                        : Phase::Hold,
                            run.driveTime[i - 1], run.driveTime[i], way / time});
    }
    return segments;
}

int segmentAt(const std::vector<DriveSegment>& segments, double t) {
    std::size_t i = 0;
    while (i + 1 < segments.size() && t > segments[i].to)
        ++i;
    return static_cast<int>(i);
}

std::vector<int> segmentsAt(const std::vector<DriveSegment>& segments, const Eigen::VectorXd& times) {
    std::vector<int> all;
    for (const double t : times)
        all.push_back(segmentAt(segments, t));
    return all;
}

} // namespace

RecordedRun recordedRun(const experiment::Run& from, std::size_t markers, bool free, double perUnit,
                        const experiment::NaturalUnits& units, const std::vector<double>& further) {
    RecordedRun run;
    run.units = units;
    run.time = vectorOf(from.readings.time);
    run.force = perUnit * vectorOf(from.readings.force);
    run.displacement.resize(run.time.size());
    for (Eigen::Index k = 0; k < run.time.size(); ++k)
        run.displacement[k] = experiment::commanded(from, run.time[k]);
    run.markerTime = vectorOf(from.markers.time);
    run.markerCount = from.markers.time.empty() ? 0 : std::min(markers, from.markers.x.size());
    const Eigen::Index frames = run.markerTime.size();
    run.markers.resize(2 * static_cast<Eigen::Index>(run.markerCount) * frames);
    for (std::size_t m = 0; m < run.markerCount; ++m) {
        run.markers.segment(2 * static_cast<Eigen::Index>(m) * frames, frames) = vectorOf(from.markers.x[m]);
        run.markers.segment((2 * static_cast<Eigen::Index>(m) + 1) * frames, frames) = vectorOf(from.markers.y[m]);
    }
    run.furtherCount = from.readings.further.size();
    run.further.resize(static_cast<Eigen::Index>(run.furtherCount) * run.force.size());
    for (std::size_t c = 0; c < run.furtherCount; ++c)
        run.further.segment(static_cast<Eigen::Index>(c) * run.force.size(), run.force.size()) =
            further[c] * vectorOf(from.readings.further[c]);
    run.specimenReversed = from.specimenReversed;
    run.setDrive(free ? halfOscillationsOf(from) : segmentsOf(from));
    return run;
}

RecordedRun RecordedRun::withChannel(std::size_t channel) const {
    RecordedRun out = *this;
    out.force = further.segment(static_cast<Eigen::Index>(channel) * force.size(), force.size());
    out.further.resize(0);
    out.furtherCount = out.markerCount = 0;
    out.markers.resize(0);
    out.markerTime.resize(0);
    out.segmentOfMarkerRow.clear();
    return out;
}

RecordedData RecordedData::withChannel(std::size_t index) const {
    RecordedData out = *this;
    const FurtherColumn& own = further[index];
    out.runs.clear();
    for (const RecordedRun& run : runs)
        out.runs.push_back(run.withChannel(index));
    out.channel = own.name;
    out.unit = own.unit;
    out.weight = own.weight;
    out.statedForceNoise = own.statedNoise;
    out.zeroHalfWidth = out.zeroWindow = 0.0;
    out.further.clear();
    out.arcFraction.clear();
    out.markerNames.clear();
    return out;
}

const DriveSegment& RecordedRun::segmentAt(double t) const {
    return segments[static_cast<std::size_t>(diagnosis::segmentAt(segments, t))];
}

void RecordedRun::setDrive(std::vector<DriveSegment> drive) {
    constexpr double kRows = 3.0;
    const double shortest = time.size() > 1 ? kRows * spacing() : 0.0; // s, shortest dwell that separates strokes
    segments = std::move(drive);
    strokes.clear();
    for (std::size_t l = 0; l < segments.size(); ++l) {
        const DriveSegment& part = segments[l];
        const auto joins = [&](const Stroke& s) { return s.phase == part.phase && part.phase != Phase::Free; };
        const std::size_t n = strokes.size();
        if (n > 1 && joins(strokes[n - 2]) && strokes[n - 1].phase == Phase::Hold &&
            strokes[n - 1].to - strokes[n - 1].from < shortest) {
            strokes.pop_back();
            for (std::size_t k = l; k-- > 0 && segments[k].stroke == n - 1;)
                segments[k].stroke = n - 2;
        }
        if (strokes.empty() || !joins(strokes.back()))
            strokes.push_back({part.phase, part.from, part.to});
        strokes.back().to = part.to;
        segments[l].stroke = strokes.size() - 1;
    }
    segmentOfRow = segmentsAt(segments, time);
    segmentOfMarkerRow = segmentsAt(segments, markerTime);
}

const char* name(Phase phase) {
    return phase == Phase::Loading     ? "loading"
           : phase == Phase::Unloading ? "unloading"
           : phase == Phase::Hold      ? "hold"
                                       : "free";
}

std::size_t RecordedData::firstOf(std::size_t run) const {
    std::size_t first = free ? run : 0; // free runs have no drive to compare
    while (first < run &&
           (!sameDrive(runs[first], runs[run]) || runs[first].specimenReversed != runs[run].specimenReversed ||
            runs[first].specimen != runs[run].specimen))
        ++first;
    return first;
}

std::size_t RecordedData::repeatsOf(std::size_t run) const {
    std::size_t alike = 0;
    for (std::size_t r = 0; r < runs.size(); ++r)
        alike += r == run || (!free && sameDrive(runs[r], runs[run])) ? 1 : 0;
    return alike;
}

std::string RecordedData::markerChannel(Eigen::Index coordinate) const {
    return markerNames[static_cast<std::size_t>(coordinate / 2)] + (coordinate % 2 == 0 ? "_x" : "_y");
}

double RecordedData::peakForce() const {
    double most = 0.0;
    for (const RecordedRun& run : runs)
        for (const double f : run.force)
            most = std::isfinite(f) ? std::max(most, std::abs(f)) : most;
    return most;
}

double RecordedData::usualCorrelationTime() const {
    constexpr double kUsual = 0.25, kRows = 2.0, kShare = 0.05; // natural s, rows, of the shortest run
    double dt = 0.0, shortest = std::numeric_limits<double>::infinity();
    for (const RecordedRun& run : runs) {
        dt = std::max(dt, run.spacing());
        if (run.time.size() > 1)
            shortest = std::min(shortest, run.time[run.time.size() - 1] - run.time[0]);
    }
    return std::min(std::max(kUsual * units.time, kRows * dt), std::max(kShare * shortest, kRows * dt));
}

std::string tooFewReadings(const experiment::Experiment& e) {
    // Readings of a run that show their own noise; of a run at all; in all beyond the free numbers.
    constexpr std::size_t kShown = 20, kFewest = 6, kSpare = 5;
    if (e.runs.empty())
        return "there are no runs";
    std::size_t rows = 0;
    const experiment::Run* shortest = &e.runs.front();
    for (const experiment::Run& run : e.runs) {
        rows += run.readings.time.size();
        if (run.readings.time.size() < shortest->readings.time.size())
            shortest = &run;
    }
    const std::size_t least = shortest->readings.time.size();
    const bool table = experiment::isTable(e);
    if (!table && least >= kShown)
        return {};
    const bool stated = e.sensors.forceNoise > 0.0;
    const std::string has = shortest->file + " has " + std::to_string(least) + " rows; a diagnosis needs at least ";
    if (!table && (!stated || least < kFewest))
        return has + std::to_string(stated ? kFewest : kShown) + " readings of each run" +
               (stated ? "" : ", or the noise of the readings, which fewer do not show");
    if (!stated)
        return "a table does not show its noise; state \"noise_std\" in /channels/0";
    const std::size_t free = replay::freeNumbers(e);
    if (rows >= free + kSpare)
        return {};
    return std::to_string(rows) + (table ? " rows of tables" : " rows") + " are too few for " + std::to_string(free) +
           " numbers with an interval; a diagnosis needs " + std::to_string(free + kSpare) +
           ": record more, or state fewer intervals";
}

RecordedData recordedDataOf(const experiment::Experiment& e) {
    RecordedData data;
    data.units = replay::naturalUnits(e);
    const experiment::Channel& channel = experiment::channel(e);
    data.channel = channel.name;
    data.unit = channel.unit;
    data.free = experiment::isFree(e);
    data.freeShells = data.free && !experiment::isMechanism(e);
    data.table = experiment::isTable(e);
    data.drivesLoad = experiment::drivesLoad(e);
    if (!data.free)
        data.drive = experiment::driveAxis(e);
    data.statedForceNoise = channel.perUnit * e.sensors.forceNoise;
    data.statedMarkerNoise = e.sensors.markerNoise;
    data.displacementNoise = e.sensors.displacementNoise;
    data.zeroHalfWidth = e.sensors.forceZeroHalfWidth;
    data.zeroWindow = e.sensors.forceZeroWindow;
    data.weight = channel.weight;
    std::vector<double> further;
    for (const experiment::FurtherChannel& c : experiment::furtherChannels(e)) {
        data.further.push_back({c.channel.name, c.channel.unit, c.channel.perUnit * c.noise, c.channel.weight});
        further.push_back(c.channel.perUnit);
    }
    for (const experiment::Marker& m : e.markers) {
        data.arcFraction.push_back(m.arcFraction);
        data.markerNames.push_back(m.name);
    }
    const std::vector<std::string> names = experiment::runNames(e, true);
    for (const experiment::Run& run : e.runs) {
        data.runs.push_back(recordedRun(run, e.markers.size(), data.free, channel.perUnit, data.units, further));
        data.runs.back().name = names[data.runs.size() - 1];
        if (run.specimen >= 0)
            data.runs.back().specimen = e.scene->specimens[static_cast<std::size_t>(run.specimen)].id;
    }
    return data;
}

} // namespace supercircle::diagnosis
