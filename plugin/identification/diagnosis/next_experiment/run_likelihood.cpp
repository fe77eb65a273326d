#include "plugin/identification/diagnosis/next_experiment/run_likelihood.h"

#include <utility>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

constexpr double kUsualCamera = 3e-5; ///< natural m, noise of a marker coordinate without an earlier camera

std::vector<double> listOf(const Eigen::Ref<const Eigen::VectorXd>& v) {
    return {v.data(), v.data() + v.size()};
}

/// A recorded run with the predicted readings.
experiment::Run runOf(const CandidateRun& candidateRun, const CandidateRunResponse& truth) {
    experiment::Run run;
    run.file = candidateRun.description;
    run.driveTime = candidateRun.time;
    run.driveDisplacement = candidateRun.displacement;
    if (run.driveTime.empty()) { // nothing is driven
        run.driveTime = {truth.time[0], truth.time[truth.time.size() - 1]};
        run.driveDisplacement = {0.0, 0.0};
    }
    run.specimenReversed = candidateRun.specimenReversed;
    run.readings = {listOf(truth.time), {}, listOf(truth.force)};
    const Index rows = truth.force.size();
    for (Index at = 0; rows > 0 && at + rows <= truth.further.size(); at += rows)
        run.readings.further.push_back(listOf(truth.further.segment(at, rows)));
    run.markers.time = listOf(truth.markerTime);
    const Index frames = truth.markerTime.size();
    for (Index at = 0; frames > 0 && at < truth.markers.size(); at += 2 * frames) {
        run.markers.x.push_back(listOf(truth.markers.segment(at, frames)));
        run.markers.y.push_back(listOf(truth.markers.segment(at + frames, frames)));
    }
    return run;
}

RecordedData recorded(const CandidateRun& candidateRun, const CandidateRunResponse& truth, double zeroWindow) {
    RecordedData data;
    data.free = candidateRun.time.empty();
    data.zeroWindow = zeroWindow;
    const experiment::Run run = runOf(candidateRun, truth);
    data.units = candidateRun.units;
    data.weight = candidateRun.weight;
    data.table = candidateRun.table;
    data.drivesLoad = candidateRun.drivesLoad;
    for (std::size_t k = 0; k < run.readings.further.size(); ++k)
        data.further.push_back({{}, {}, 0.0, k < candidateRun.further.size() ? candidateRun.further[k] : 1.0});
    const std::vector<double> inItsUnit(run.readings.further.size(), 1.0);
    data.runs.push_back(recordedRun(run, run.markers.x.size(), data.free, 1.0, data.units, inItsUnit));
    return data;
}

Response asResponse(const CandidateRunResponse& r) {
    return {r.failure, r.force, r.markers, r.jumps, r.further};
}

Noise withCamera(Noise noise, const experiment::NaturalUnits& units) {
    noise.marker = noise.marker > 0.0 ? noise.marker : kUsualCamera * units.length;
    return noise;
}

} // namespace

RunLikelihood::RunLikelihood(const CandidateRun& candidateRun, const CandidateRunResponse& truth, const Noise& noise,
                             double zeroWindow, std::size_t repeats)
    : data_(recorded(candidateRun, truth, zeroWindow)),
      likelihood_(data_, withCamera(noise, candidateRun.units), {asResponse(truth)},
                  {Response{"not simulated", {}, {}}},
                  LikelihoodSettings{}.in(candidateRun.units).forRepeats(repeats)) {}

std::optional<Eigen::VectorXd> RunLikelihood::difference(const CandidateRunResponse& a,
                                                         const CandidateRunResponse& b) const {
    const RawDifference d = likelihood_.rawDifference(0, asResponse(a), asResponse(b));
    if (d.rows.size() != likelihood_.rowsOf(0))
        return std::nullopt;
    Eigen::VectorXd out = likelihood_.whiten(0, d.rows);
    return out.allFinite() ? std::optional<Eigen::VectorXd>(std::move(out)) : std::nullopt;
}

} // namespace supercircle::diagnosis
