#include "plugin/diagnosis/data.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace supercircle::diagnosis {

namespace {

Eigen::VectorXd vectorOf(const std::vector<double>& v) {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

std::vector<Leg> legsOf(const experiment::Run& run) {
    std::vector<Leg> legs;
    for (std::size_t i = 1; i < run.driveTime.size(); ++i) {
        const double way = run.driveDisplacement[i] - run.driveDisplacement[i - 1];
        const double time = run.driveTime[i] - run.driveTime[i - 1];
        legs.push_back({way > 0.0   ? Phase::Loading
                        : way < 0.0 ? Phase::Unloading
                                    : Phase::Hold,
                        run.driveTime[i - 1], run.driveTime[i], way / time});
    }
    return legs;
}

int legAt(const std::vector<Leg>& legs, double t) {
    std::size_t i = 0;
    while (i + 1 < legs.size() && t > legs[i].to)
        ++i;
    return static_cast<int>(i);
}

double commanded(const experiment::Run& run, double t) {
    std::size_t i = 1;
    while (i + 1 < run.driveTime.size() && t > run.driveTime[i])
        ++i;
    const double share = std::clamp((t - run.driveTime[i - 1]) / (run.driveTime[i] - run.driveTime[i - 1]), 0.0, 1.0);
    return (1.0 - share) * run.driveDisplacement[i - 1] + share * run.driveDisplacement[i];
}

RecordedRun runOf(const experiment::Run& from, std::size_t markers) {
    RecordedRun run;
    run.name = std::filesystem::path(from.file).filename().string();
    run.legs = legsOf(from);
    run.time = vectorOf(from.readings.time);
    run.force = vectorOf(from.readings.force);
    run.displacement.resize(run.time.size());
    for (Eigen::Index k = 0; k < run.time.size(); ++k) {
        run.displacement[k] = commanded(from, run.time[k]);
        run.leg.push_back(legAt(run.legs, run.time[k]));
    }
    run.markerTime = vectorOf(from.markers.time);
    run.markerCount = from.markers.time.empty() ? 0 : std::min(markers, from.markers.x.size());
    const Eigen::Index seen = run.markerTime.size();
    run.markers.resize(2 * static_cast<Eigen::Index>(run.markerCount) * seen);
    for (std::size_t m = 0; m < run.markerCount; ++m) {
        run.markers.segment(2 * static_cast<Eigen::Index>(m) * seen, seen) = vectorOf(from.markers.x[m]);
        run.markers.segment((2 * static_cast<Eigen::Index>(m) + 1) * seen, seen) = vectorOf(from.markers.y[m]);
    }
    for (Eigen::Index k = 0; k < seen; ++k)
        run.markerLeg.push_back(legAt(run.legs, run.markerTime[k]));
    return run;
}

} // namespace

const char* name(Phase phase) {
    return phase == Phase::Loading ? "loading" : phase == Phase::Unloading ? "unloading" : "hold";
}

double Data::peakForce() const {
    double most = 0.0;
    for (const RecordedRun& run : runs)
        for (const double f : run.force)
            most = std::isfinite(f) ? std::max(most, std::abs(f)) : most;
    return most;
}

Data dataOf(const experiment::Experiment& e) {
    Data data;
    data.statedForceNoise = e.sensors.forceNoise;
    data.statedMarkerNoise = e.sensors.markerNoise;
    data.displacementNoise = e.sensors.displacementNoise;
    data.zeroWindow = e.sensors.forceZeroWindow;
    for (const experiment::Marker& m : e.markers) {
        data.arcFraction.push_back(m.arcFraction);
        data.markerNames.push_back(m.name);
    }
    for (const experiment::Run& run : e.runs)
        data.runs.push_back(runOf(run, e.markers.size()));
    return data;
}

} // namespace supercircle::diagnosis
