#include "plugin/identification/diagnosis/likelihood.h"
#include "plugin/identification/diagnosis/model/decompositions.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace supercircle::diagnosis {

namespace {

/// Change of the force if the clock is one row ahead, N; 0 where unknown.
Eigen::VectorXd clockShift(const RecordedRun& run, const Response& fine, const Eigen::VectorXd& errors) {
    Eigen::VectorXd d = Eigen::VectorXd::Zero(run.force.size());
    if (!fine.failure.empty() || fine.force.size() != run.force.size())
        return d;
    for (Eigen::Index k = 1; k + 1 < d.size(); ++k)
        if (const double slope = 0.5 * (fine.force[k + 1] - fine.force[k - 1]);
            std::isfinite(slope) && std::isfinite(errors[k]))
            d[k] = slope;
    return d;
}

/// The simulated force in rows that count, 0 elsewhere.
Eigen::VectorXd ownScale(const RecordedRun& run, const Response& fine, const Eigen::VectorXd& errors) {
    Eigen::VectorXd d = Eigen::VectorXd::Zero(run.force.size());
    for (Eigen::Index k = 0; k < d.size() && fine.failure.empty() && fine.force.size() == d.size(); ++k)
        d[k] = std::isfinite(fine.force[k]) && std::isfinite(errors[k]) ? fine.force[k] : 0.0;
    return d;
}

/// The matrix S of (1 + N N')^(-1/2) = 1 - N S N'.
Eigen::MatrixXd shrinkageOf(const Eigen::MatrixXd& N) {
    const dense::SymmetricEigen eigen = dense::symmetricEigen(N.transpose() * N);
    Eigen::VectorXd s = eigen.values.cwiseMax(0.0);
    for (double& v : s) // (1 - 1/sqrt(1 + v)) / v, 1/2 where v vanishes
        v = v > 1e-9 ? (1.0 - 1.0 / std::sqrt(1.0 + v)) / v : 0.5;
    return eigen.vectors * s.asDiagonal() * eigen.vectors.transpose();
}

/// Prior standard deviation of the zero of a load cell, N. Poses have none.
double zeroOf(const RecordedData& data, const Noise& noise, const RecordedRun& run) {
    // Of the noise, where nothing is stated. Half: an untared cell is missing physics; double: offsets hide weak
    // effects.
    constexpr double kUntared = 5.0;
    const double mean = data.zeroWindow > 0.0 ? noise.stdOfMean(data.zeroWindow, run.spacing()) : 0.0;
    if (data.zeroHalfWidth > 0.0)
        return math::hypot(mean, data.zeroHalfWidth / std::sqrt(3.0));
    return data.free ? noise.total() : data.zeroWindow > 0.0 ? mean : kUntared * noise.total();
}

} // namespace

Likelihood::ChannelModel::ChannelModel(const RecordedData& data, const RecordedRun& run, const Noise& noise,
                                       const Response& fine, const Response& finer, double peak,
                                       const LikelihoodSettings& settings)
    : errors(modelErrorOf(run, noise, fine, finer, peak, settings)), zero(zeroOf(data, noise, run)) {
    double size = 1.0; // of all errors
    if (data.weight > 0.0)
        size = 1.0 / std::sqrt(data.weight);
    else
        errors.force.setConstant(std::numeric_limits<double>::infinity());
    force = Whitening(run.time, size * noise.white, size * noise.correlated, noise.correlationTime, size * errors.force,
                      errors.correlationTime);
    nuisance.resize(run.force.size(), 3);
    nuisance.col(0) = force.apply(Eigen::VectorXd::Constant(run.force.size(), zero));
    nuisance.col(1) = force.apply(clockShift(run, fine, errors.force) * settings.clockError);
    nuisance.col(2) =
        force.apply(ownScale(run, fine, errors.force) * (data.free ? 0.0 : settings.repeatFactor * settings.scale));
    shrinkage = shrinkageOf(nuisance);
}

Eigen::VectorXd Likelihood::ChannelModel::whiten(Eigen::VectorXd raw) const {
    for (Eigen::Index k = 0; k < raw.size(); ++k)
        if (!std::isfinite(errors.force[k]))
            raw[k] = 0.0; // does not count
    Eigen::VectorXd u = force.apply(raw);
    u -= nuisance * (shrinkage * (nuisance.transpose() * u));
    return u;
}

Eigen::VectorXd Likelihood::ChannelModel::transposed(Eigen::VectorXd u) const {
    u -= nuisance * (shrinkage.transpose() * (nuisance.transpose() * u));
    return force.transposed(u);
}

Likelihood::Likelihood(const RecordedData& data, const Noise& noise, const std::vector<Response>& fine,
                       const std::vector<Response>& finer, const LikelihoodSettings& settings)
    : data_(data), noise_(noise), settings_(settings.of(data)), start_{0} {
    const double peak = data.free ? 0.0 : data.peakForce(); // nothing free is pressed
    for (std::size_t c = 0; c < data.further.size(); ++c)
        further_.push_back(data.withChannel(c));
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const RecordedRun& run = data.runs[r];
        const LikelihoodSettings here = settings_.forRepeats(data.repeatsOf(r));
        RunModel model;
        static_cast<ChannelModel&>(model) = ChannelModel(data, run, noise, fine[r], finer[r], peak, here);
        for (std::size_t c = 0; c < run.furtherCount; ++c)
            model.further.emplace_back(further_[c], further_[c].runs[r], noise.further[c], fine[r].withChannel(c),
                                       finer[r].withChannel(c), data.free ? 0.0 : further_[c].peakForce(), here);
        addJumps(r, fine[r], finer[r], here, model);
        addStrokeShifts(run, here.repeatFactor * here.markerShift, model);
        addSnapShifts(run, here.repeatFactor * here.snapPositionError, model);
        start_.push_back(start_.back() + run.rows() + static_cast<Eigen::Index>(model.jumps.size()));
        runModels_.push_back(std::move(model));
    }
}

/// Adds a common shift of the marker rows between one recorded snap and the next.
void Likelihood::addSnapShifts(const RecordedRun& run, double sigma, RunModel& model) {
    std::vector<double> snaps = model.errors.snaps;
    std::sort(snaps.begin(), snaps.end());
    const double same = 1.0 * run.units.time; // s, recorded and simulated snap are one event
    const Eigen::Index frames = run.markerTime.size();
    const auto rowAfter = [&](double t) {
        return static_cast<Eigen::Index>(std::lower_bound(run.markerTime.begin(), run.markerTime.end(), t) -
                                         run.markerTime.begin());
    };
    for (std::size_t i = 0; i < snaps.size(); ++i) {
        if (i + 1 < snaps.size() && snaps[i + 1] < snaps[i] + same)
            continue; // the later of the two begins the interval
        const Eigen::Index from = rowAfter(snaps[i]), to = i + 1 < snaps.size() ? rowAfter(snaps[i + 1]) : frames;
        for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount) && to > from; ++c)
            model.shifts.push_back({c * frames + from, c * frames + to, sigma});
    }
}

/// Adds a common shift of the marker rows of each stroke.
void Likelihood::addStrokeShifts(const RecordedRun& run, double sigma, RunModel& model) {
    const Eigen::Index frames = run.markerTime.size();
    for (Eigen::Index from = 0, to = 0; from < frames; from = to) {
        while (to < frames && run.markerStroke(to) == run.markerStroke(from))
            ++to;
        for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount); ++c)
            model.shifts.push_back({c * frames + from, c * frames + to, sigma});
    }
}

void Likelihood::addJumps(std::size_t r, const Response& fine, const Response& finer, const LikelihoodSettings& s,
                          RunModel& model) const {
    constexpr double kSame = 2.0; // rows between the times at which two channels show one event
    const RecordedRun& run = data_.runs[r];
    for (std::size_t c = 0; c <= run.furtherCount; ++c) {
        if (c > 0 && data_.further[c - 1].weight == 0.0)
            continue;
        const double noise = (c == 0 ? noise_ : noise_.further[c - 1]).total();
        ChannelJumps own{c, {}};
        for (const replay::Landmark& jump : recordedJumps(runOf(r, c), s.snapShare, s.jumpNoise * noise))
            if (std::none_of(model.jumps.begin(), model.jumps.end(), [&](const replay::Landmark& known) {
                    return c > 0 && std::abs(known.time - jump.time) <= kSame * run.spacing();
                }))
                own.jumps.push_back(jump);
        model.jumps.insert(model.jumps.end(), own.jumps.begin(), own.jumps.end());
        if (!own.jumps.empty())
            model.jumping.push_back(std::move(own));
    }
    const auto n = static_cast<Eigen::Index>(model.jumps.size());
    if (n == 0)
        return;
    Eigen::VectorXd nuisance = Eigen::VectorXd::Constant(n, run.spacing() / std::sqrt(12.0)), shared(n); // s
    const double travel = run.displacement.maxCoeff() - run.displacement.minCoeff();
    for (Eigen::Index i = 0; i < n; ++i)
        shared[i] = s.repeatFactor * s.jumpPositionError * travel /
                    std::abs(run.segmentAt(model.jumps[static_cast<std::size_t>(i)].time).speed);
    Eigen::Index first = 0; // of the channel
    std::vector<std::size_t> channel;
    for (const ChannelJumps& own : model.jumping) {
        channel.insert(channel.end(), own.jumps.size(), own.channel);
        if (fine.force.size() == run.force.size() && finer.force.size() == run.force.size()) {
            const RecordedRun& its = runOf(r, own.channel);
            const auto a = jumpsOf(its, inChannel(fine, own.channel), s),
                       b = jumpsOf(its, inChannel(finer, own.channel), s);
            const auto inFine = matchJumps(its, own.jumps, a, s.jumpReach),
                       inFiner = matchJumps(its, a, b, s.jumpReach);
            for (std::size_t i = 0; i < own.jumps.size(); ++i)
                if (const int f = inFine[i]; f >= 0 && inFiner[static_cast<std::size_t>(f)] >= 0) {
                    const double other = b[static_cast<std::size_t>(inFiner[static_cast<std::size_t>(f)])].time;
                    double& error = nuisance[first + static_cast<Eigen::Index>(i)];
                    error = math::hypot(error,
                                        s.repeatFactor * s.refinement * (a[static_cast<std::size_t>(f)].time - other));
                }
        }
        first += static_cast<Eigen::Index>(own.jumps.size());
    }
    Eigen::MatrixXd covariance = nuisance.cwiseAbs2().asDiagonal();
    // One event in two cycles: the same number of jumps of its direction precede it in a stroke of its phase.
    std::vector<std::tuple<std::size_t, Phase, bool, int>> event;
    for (std::size_t i = 0; i < model.jumps.size(); ++i) {
        const replay::Landmark& jump = model.jumps[i];
        const std::size_t stroke = run.segmentAt(jump.time).stroke;
        const bool rises = jump.after > jump.before;
        int before = 0;
        for (std::size_t k = 0; k < i; ++k)
            before += channel[k] == channel[i] && run.segmentAt(model.jumps[k].time).stroke == stroke &&
                      (model.jumps[k].after > model.jumps[k].before) == rises;
        event.emplace_back(channel[i], run.strokes[stroke].phase, rises, before);
    }
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index k = 0; k < n; ++k)
            if (event[static_cast<std::size_t>(i)] == event[static_cast<std::size_t>(k)])
                covariance(i, k) += shared[i] * shared[k];
    model.jumpFactor = dense::choleskyFactor(covariance);
}

bool Likelihood::complete(std::size_t r, const Response& s) const {
    return s.failure.empty() && s.force.size() == data_.runs[r].force.size() &&
           s.markers.size() == data_.runs[r].markers.size() && s.further.size() == data_.runs[r].further.size();
}

Likelihood::SimulatedJumps Likelihood::simulatedJumpsOf(std::size_t r, const Response& s) const {
    SimulatedJumps out;
    for (const ChannelJumps& own : runModels_[r].jumping) {
        const RecordedRun& run = runOf(r, own.channel);
        const auto simulated = jumpsOf(run, inChannel(s, own.channel), settings_);
        const std::vector<int> partner = matchJumps(run, own.jumps, simulated, settings_.jumpReach);
        for (std::size_t i = 0; i < own.jumps.size(); ++i) {
            const replay::Landmark& recorded = own.jumps[i];
            const double t = recorded.time;
            out.found.push_back(partner[i] >= 0);
            if (partner[i] < 0) { // largest distance, towards the nearest jump of its direction
                double nearest = std::numeric_limits<double>::infinity();
                for (const replay::Landmark& other : simulated)
                    if ((other.after > other.before) == (recorded.after > recorded.before) &&
                        std::abs(other.time - t) < std::abs(nearest - t))
                        nearest = other.time;
                out.time.push_back(t + std::copysign(jumpReachOf(run, t, settings_.jumpReach), nearest - t));
                continue;
            }
            out.time.push_back(simulated[static_cast<std::size_t>(partner[i])].time);
            out.maskedRanges.push_back(maskedRange(t, out.time.back(), settings_));
        }
    }
    return out;
}

void Likelihood::interpolateAllMasked(std::size_t r, const TimeRanges& maskedRanges, RawDifference& d) const {
    const RecordedRun& run = data_.runs[r];
    const ModelError& errors = runModels_[r].errors;
    d.masked.assign(static_cast<std::size_t>(d.rows.size()), false);
    if (maskedRanges.empty())
        return;
    const auto one = [&](Eigen::Index from, const Eigen::VectorXd& time, const Eigen::VectorXd& error) {
        const std::vector<bool> masked = rowsInside(maskedRanges, time);
        interpolateMasked(d.rows.segment(from, time.size()), time, error, masked);
        for (Eigen::Index k = 0; k < time.size(); ++k)
            d.masked[static_cast<std::size_t>(from + k)] =
                masked[static_cast<std::size_t>(k)] && std::isfinite(error[k]);
    };
    one(0, run.time, errors.force);
    const Eigen::Index frames = run.markerTime.size();
    for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount) && frames > 0; ++c)
        one(run.force.size() + c * frames, run.markerTime, errors.markers.segment(c * frames, frames));
    for (std::size_t c = 0; c < run.furtherCount; ++c)
        one(run.force.size() + run.markers.size() + static_cast<Eigen::Index>(c) * run.force.size(), run.time,
            runModels_[r].further[c].errors.force);
}

std::vector<Response> Likelihood::finerThan(std::vector<Response> fine) const {
    for (std::size_t r = 0; r < fine.size(); ++r) {
        const Eigen::Index rows = data_.runs[r].force.size();
        if (fine[r].force.size() == rows)
            fine[r].force += runModels_[r].errors.correction / settings_.refinement;
        for (std::size_t c = 0; c < runModels_[r].further.size(); ++c)
            if (const auto from = static_cast<Eigen::Index>(c) * rows; fine[r].further.size() >= from + rows)
                fine[r].further.segment(from, rows) +=
                    runModels_[r].further[c].errors.correction / settings_.refinement;
    }
    return fine;
}

RawDifference Likelihood::rawResidual(std::size_t r, const Response& s) const {
    const RecordedRun& run = data_.runs[r];
    if (!complete(r, s))
        return {};
    RawDifference out;
    out.rows.resize(rowsOf(r));
    const SimulatedJumps jumps = simulatedJumpsOf(r, s);
    out.rows.head(run.rows()) << run.force - s.force - runModels_[r].errors.correction, run.markers - s.markers,
        run.further - s.further;
    for (std::size_t c = 0; c < run.furtherCount; ++c)
        partOf(r, c, out.rows) -= runModels_[r].further[c].errors.correction;
    for (std::size_t i = 0; i < jumps.time.size(); ++i)
        out.rows[run.rows() + static_cast<Eigen::Index>(i)] = runModels_[r].jumps[i].time - jumps.time[i];
    interpolateAllMasked(r, jumps.maskedRanges, out);
    return out;
}

RawDifference Likelihood::rawDifference(std::size_t r, const Response& a, const Response& b) const {
    const RecordedRun& run = data_.runs[r];
    if (!complete(r, a) || !complete(r, b))
        return {};
    RawDifference out;
    out.rows.resize(rowsOf(r));
    SimulatedJumps p = simulatedJumpsOf(r, a);
    const SimulatedJumps q = simulatedJumpsOf(r, b);
    out.rows.head(run.rows()) << a.force - b.force, a.markers - b.markers, a.further - b.further;
    for (std::size_t i = 0; i < p.time.size(); ++i) // a jump present in only one of them has no derivative
        out.rows[run.rows() + static_cast<Eigen::Index>(i)] = p.found[i] && q.found[i] ? p.time[i] - q.time[i] : 0.0;
    p.maskedRanges.insert(p.maskedRanges.end(), q.maskedRanges.begin(), q.maskedRanges.end());
    interpolateAllMasked(r, p.maskedRanges, out);
    return out;
}

/// Removes the part that a common shift of markers explains; a symmetric map.
void Likelihood::removeShift(const RunModel& model, const RunModel::CommonShift& shift,
                             Eigen::Ref<Eigen::VectorXd> markers) {
    const Eigen::VectorXd& errors = model.errors.markers;
    double n2 = 0.0, along = 0.0;
    for (Eigen::Index k = shift.from; k < shift.to; ++k)
        if (std::isfinite(errors[k])) {
            const double n = shift.sigma / errors[k];
            n2 += n * n;
            along += n * markers[k];
        }
    const double shrinkage = n2 > 0.0 ? along * (1.0 - 1.0 / std::sqrt(1.0 + n2)) / n2 : 0.0;
    for (Eigen::Index k = shift.from; k < shift.to; ++k)
        if (std::isfinite(errors[k]))
            markers[k] -= shrinkage * shift.sigma / errors[k];
}

Eigen::VectorXd Likelihood::whiten(std::size_t r, const Eigen::VectorXd& rawResidual) const {
    const RunModel& model = runModels_[r];
    const RecordedRun& run = data_.runs[r];
    const auto markers = rawResidual.segment(run.force.size(), run.markers.size());
    Eigen::VectorXd out = Eigen::VectorXd::Zero(rowsOf(r));
    if (const auto jumps = static_cast<Eigen::Index>(model.jumps.size()); jumps > 0)
        out.tail(jumps) = model.jumpFactor.triangularView<Eigen::Lower>().solve(rawResidual.tail(jumps));
    out.head(run.force.size()) = model.whiten(rawResidual.head(run.force.size()));
    for (std::size_t c = 0; c < run.furtherCount; ++c)
        partOf(r, c, out) = model.further[c].whiten(partOf(r, c, rawResidual));
    for (Eigen::Index k = 0; k < run.markers.size(); ++k)
        if (std::isfinite(model.errors.markers[k]))
            out[run.force.size() + k] = markers[k] / model.errors.markers[k];
    for (const RunModel::CommonShift& shift : model.shifts)
        removeShift(model, shift, out.segment(run.force.size(), run.markers.size()));
    return out;
}

Eigen::VectorXd Likelihood::whitenTransposed(std::size_t r, const Eigen::VectorXd& whitened) const {
    const RunModel& model = runModels_[r];
    const RecordedRun& run = data_.runs[r];
    Eigen::VectorXd out = Eigen::VectorXd::Zero(rowsOf(r));
    if (const auto jumps = static_cast<Eigen::Index>(model.jumps.size()); jumps > 0)
        out.tail(jumps) = model.jumpFactor.triangularView<Eigen::Lower>().transpose().solve(whitened.tail(jumps));
    out.head(run.force.size()) = model.transposed(whitened.head(run.force.size()));
    for (std::size_t c = 0; c < run.furtherCount; ++c)
        partOf(r, c, out) = model.further[c].transposed(partOf(r, c, whitened));
    auto markers = out.segment(run.force.size(), run.markers.size());
    markers = whitened.segment(run.force.size(), run.markers.size());
    for (auto shift = model.shifts.rbegin(); shift != model.shifts.rend(); ++shift)
        removeShift(model, *shift, markers);
    for (Eigen::Index k = 0; k < markers.size(); ++k)
        markers[k] = std::isfinite(model.errors.markers[k]) ? markers[k] / model.errors.markers[k] : 0.0;
    return out;
}

std::optional<Eigen::VectorXd> Likelihood::residual(const std::vector<Response>& simulated) const {
    Eigen::VectorXd out(rows());
    for (std::size_t r = 0; r < runs(); ++r) {
        const RawDifference d = rawResidual(r, simulated[r]);
        if (d.rows.size() != rowsOf(r))
            return std::nullopt;
        out.segment(start(r), rowsOf(r)) = whiten(r, d.rows);
    }
    return out.allFinite() ? std::optional<Eigen::VectorXd>(std::move(out)) : std::nullopt;
}

Eigen::VectorXd Likelihood::maskPenalty(const std::vector<Response>& simulated) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(rows());
    for (std::size_t r = 0; r < runs(); ++r) {
        const std::vector<bool> masked = rawResidual(r, simulated[r]).masked;
        for (std::size_t k = 0; k < masked.size(); ++k)
            out[start(r) + static_cast<Eigen::Index>(k)] = masked[k] ? 1.0 : 0.0;
    }
    return out;
}

std::optional<Eigen::VectorXd> Likelihood::whitenedDifference(const std::vector<Response>& a,
                                                              const std::vector<Response>& b) const {
    Eigen::VectorXd out(rows());
    for (std::size_t r = 0; r < runs(); ++r) {
        const RawDifference d = rawDifference(r, a[r], b[r]);
        if (d.rows.size() != rowsOf(r))
            return std::nullopt;
        out.segment(start(r), rowsOf(r)) = whiten(r, d.rows);
    }
    return out.allFinite() ? std::optional<Eigen::VectorXd>(std::move(out)) : std::nullopt;
}

std::size_t Likelihood::channelOf(std::size_t r, Eigen::Index row) const {
    const RecordedRun& run = data_.runs[r];
    const Eigen::Index after = row - run.force.size() - run.markers.size();
    return row < run.force.size() || row >= run.rows() ? 0
           : after < 0                                 ? 1
                                                       : 2 + static_cast<std::size_t>(after / run.force.size());
}

double Likelihood::timeOfReading(std::size_t r, Eigen::Index row) const {
    const RecordedRun& run = data_.runs[r];
    return isMarker(r, row)  ? run.markerTime[(row - run.force.size()) % run.markerTime.size()]
           : isForce(r, row) ? run.time[row]
                             : run.time[(row - run.force.size() - run.markers.size()) % run.force.size()];
}

bool Likelihood::counts(std::size_t r, Eigen::Index row) const {
    const RecordedRun& run = data_.runs[r];
    const ModelError& e = runModels_[r].errors;
    const std::size_t channel = channelOf(r, row);
    return isForce(r, row) ? std::isfinite(e.force[row])
           : channel == 1  ? std::isfinite(e.markers[row - e.force.size()])
           : channel > 1
               ? std::isfinite(runModels_[r]
                                   .further[channel - 2]
                                   .errors.force[(row - run.force.size() - run.markers.size()) % run.force.size()])
               : true;
}

std::size_t Likelihood::stroke(std::size_t r, Eigen::Index row) const {
    const RecordedRun& run = data_.runs[r];
    const std::size_t channel = channelOf(r, row);
    return isForce(r, row) ? run.stroke(row)
           : channel == 1  ? run.markerStroke((row - run.force.size()) % run.markerTime.size())
           : channel > 1   ? run.stroke((row - run.force.size() - run.markers.size()) % run.force.size())
                           : run.segmentAt(runModels_[r].jumps[static_cast<std::size_t>(row - run.rows())].time).stroke;
}

Eigen::Index Likelihood::countedRowsIn(std::size_t r) const {
    Eigen::Index n = 0;
    for (Eigen::Index k = 0; k < rowsOf(r); ++k)
        n += counts(r, k) ? 1 : 0;
    return n;
}

double Likelihood::signalNorm() const {
    double sum = 0.0;
    for (const RecordedRun& run : data_.runs) {
        double first = 0.0, second = 0.0, count = 0.0;
        for (const double v : run.force)
            if (std::isfinite(v)) {
                first += v;
                second += v * v;
                count += 1.0;
            }
        sum += count > 0.0 ? std::max(0.0, second - first * first / count) : 0.0;
    }
    return std::sqrt(sum) / std::max(noise_.total(), 1e-300);
}

Eigen::Index Likelihood::countedRows() const {
    Eigen::Index n = 0;
    for (std::size_t r = 0; r < runs(); ++r)
        n += countedRowsIn(r);
    return n;
}

} // namespace supercircle::diagnosis
