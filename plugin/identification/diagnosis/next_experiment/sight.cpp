#include "plugin/identification/diagnosis/next_experiment/sight.h"

#include <utility>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

constexpr double kUsualCamera = 3e-5; ///< m, noise of a marker's coordinate where none was tracked yet

std::vector<double> listOf(const Eigen::Ref<const Eigen::VectorXd>& v) {
    return {v.data(), v.data() + v.size()};
}

/// As if it had been made.
experiment::Run runOf(const Design& design, const DesignResponse& truth) {
    experiment::Run run;
    run.file = design.what;
    run.driveTime = design.time;
    run.driveDisplacement = design.displacement;
    if (run.driveTime.empty()) { // nothing is driven
        run.driveTime = {truth.time[0], truth.time[truth.time.size() - 1]};
        run.driveDisplacement = {0.0, 0.0};
    }
    run.turned = design.turned;
    run.readings = {listOf(truth.time), {}, listOf(truth.force)};
    run.markers.time = listOf(truth.markerTime);
    const Index frames = truth.markerTime.size();
    for (Index at = 0; frames > 0 && at < truth.markers.size(); at += 2 * frames) {
        run.markers.x.push_back(listOf(truth.markers.segment(at, frames)));
        run.markers.y.push_back(listOf(truth.markers.segment(at + frames, frames)));
    }
    return run;
}

Data recorded(const Design& design, const DesignResponse& truth, double zeroWindow) {
    Data data;
    data.free = design.time.empty();
    data.zeroWindow = zeroWindow;
    const experiment::Run run = runOf(design, truth);
    data.runs.push_back(recordedRun(run, run.markers.x.size(), data.free, 1.0));
    return data;
}

Response asResponse(const DesignResponse& r) {
    return {r.failure, r.force, r.markers, r.jumps};
}

Noise withCamera(Noise noise) {
    noise.marker = noise.marker > 0.0 ? noise.marker : kUsualCamera;
    return noise;
}

} // namespace

Sight::Sight(const Design& design, const DesignResponse& truth, const Noise& noise, double zeroWindow,
             std::size_t repeats)
    : data_(recorded(design, truth, zeroWindow)),
      misfit_(data_, withCamera(noise), {asResponse(truth)}, {Response{"not simulated", {}, {}}},
              MisfitSettings{}.inEachOf(repeats)) {}

std::optional<Eigen::VectorXd> Sight::apart(const DesignResponse& a, const DesignResponse& b) const {
    const Departure d = misfit_.change(0, asResponse(a), asResponse(b));
    if (d.rows.size() != misfit_.rowsOf(0))
        return std::nullopt;
    Eigen::VectorXd out = misfit_.whiten(0, d.rows);
    return out.allFinite() ? std::optional<Eigen::VectorXd>(std::move(out)) : std::nullopt;
}

} // namespace supercircle::diagnosis
