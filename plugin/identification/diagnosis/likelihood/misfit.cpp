#include "plugin/identification/diagnosis/misfit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace supercircle::diagnosis {

namespace {

/// Change of the force when the clock runs a row ahead, N; 0 where it means nothing.
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

/// The simulated force where it is looked at, 0 elsewhere.
Eigen::VectorXd ownScale(const RecordedRun& run, const Response& fine, const Eigen::VectorXd& errors) {
    Eigen::VectorXd d = Eigen::VectorXd::Zero(run.force.size());
    for (Eigen::Index k = 0; k < d.size() && fine.failure.empty() && fine.force.size() == d.size(); ++k)
        d[k] = std::isfinite(fine.force[k]) && std::isfinite(errors[k]) ? fine.force[k] : 0.0;
    return d;
}

/// S of (1 + N N')^(-1/2) = 1 - N S N'.
Eigen::MatrixXd shrinking(const Eigen::MatrixXd& N) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(N.transpose() * N);
    Eigen::VectorXd s = eigen.eigenvalues().cwiseMax(0.0);
    for (double& v : s) // (1 - 1/sqrt(1 + v)) / v, 1/2 where v vanishes
        v = v > 1e-9 ? (1.0 - 1.0 / std::sqrt(1.0 + v)) / v : 0.5;
    return eigen.eigenvectors() * s.asDiagonal() * eigen.eigenvectors().transpose();
}

} // namespace

Misfit::Misfit(const Data& data, const Noise& noise, const std::vector<Response>& fine,
               const std::vector<Response>& finer, const MisfitSettings& settings)
    : data_(data), noise_(noise), settings_(settings), start_{0} {
    const double peak = data.free ? 0.0 : data.peakForce(); // the equations of free bodies are solved exactly
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const RecordedRun& run = data.runs[r];
        const MisfitSettings here = settings.inEachOf(data.repeatsOf(r));
        Part part;
        part.errors = rowErrors(run, noise, fine[r], finer[r], peak, here);
        part.force =
            Whitening(run.time, noise.white, noise.coloured, noise.memory, part.errors.force, part.errors.memory);
        addJumps(run, fine[r], finer[r], here, part);
        // A load cell that nobody tared reads something of its own, a few per cent of what it is read for; poses have
        // no such zero.
        const double untared = data.free ? noise.total() : std::max(5.0 * noise.total(), 0.05 * peak);
        part.zero = data.zeroWindow > 0.0 ? noise.ofMean(data.zeroWindow, run.spacing()) : untared;
        part.own.resize(run.force.size(), 3);
        part.own.col(0) = part.force.apply(Eigen::VectorXd::Constant(run.force.size(), part.zero));
        part.own.col(1) = part.force.apply(clockShift(run, fine[r], part.errors.force) * settings.clock);
        part.own.col(2) = part.force.apply(ownScale(run, fine[r], part.errors.force) *
                                           (data.free ? 0.0 : here.repeated * here.scale));
        part.shrink = shrinking(part.own);
        addPlaces(run, here.repeated * here.markerShift, part);
        addLandings(run, here.repeated * here.landing, part);
        start_.push_back(start_.back() + run.rows() + static_cast<Eigen::Index>(part.jumps.size()));
        parts_.push_back(std::move(part));
    }
}

/// Marker rows behind each recorded snap, up to the next one.
void Misfit::addLandings(const RecordedRun& run, double deviation, Part& part) {
    std::vector<double> snaps = part.errors.snaps;
    std::sort(snaps.begin(), snaps.end());
    constexpr double kSame = 1.0; // s: the recorded and the simulated snap are one event
    const Eigen::Index seen = run.markerTime.size();
    const auto rowAfter = [&](double t) {
        return static_cast<Eigen::Index>(std::lower_bound(run.markerTime.begin(), run.markerTime.end(), t) -
                                         run.markerTime.begin());
    };
    for (std::size_t i = 0; i < snaps.size(); ++i) {
        if (i + 1 < snaps.size() && snaps[i + 1] < snaps[i] + kSame)
            continue; // begins with the later of the two
        const Eigen::Index from = rowAfter(snaps[i]), to = i + 1 < snaps.size() ? rowAfter(snaps[i + 1]) : seen;
        for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount) && to > from; ++c)
            part.shifts.push_back({c * seen + from, c * seen + to, deviation});
    }
}

/// Marker rows of each stroke.
void Misfit::addPlaces(const RecordedRun& run, double deviation, Part& part) {
    const Eigen::Index seen = run.markerTime.size();
    for (Eigen::Index from = 0, to = 0; from < seen; from = to) {
        while (to < seen && run.markerStroke(to) == run.markerStroke(from))
            ++to;
        for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount); ++c)
            part.shifts.push_back({c * seen + from, c * seen + to, deviation});
    }
}

void Misfit::addJumps(const RecordedRun& run, const Response& fine, const Response& finer, const MisfitSettings& s,
                      Part& part) const {
    part.jumps = recordedJumps(run, s.snapShare, s.jumpNoise * noise_.total());
    const auto n = static_cast<Eigen::Index>(part.jumps.size());
    if (n == 0)
        return;
    Eigen::VectorXd own = Eigen::VectorXd::Constant(n, run.spacing() / std::sqrt(12.0)), shared(n); // s
    const double travel = run.displacement.maxCoeff() - run.displacement.minCoeff();
    for (Eigen::Index i = 0; i < n; ++i)
        shared[i] =
            s.repeated * s.jumpPlace * travel / std::abs(run.legAt(part.jumps[static_cast<std::size_t>(i)].time).speed);
    if (fine.force.size() == run.force.size() && finer.force.size() == run.force.size()) {
        const auto a = jumpsOf(run, fine, s), b = jumpsOf(run, finer, s);
        const auto inFine = sameJumps(run, part.jumps, a, s.jumpFarthest),
                   inFiner = sameJumps(run, a, b, s.jumpFarthest);
        for (std::size_t i = 0; i < part.jumps.size(); ++i)
            if (const int f = inFine[i]; f >= 0 && inFiner[static_cast<std::size_t>(f)] >= 0) {
                const double other = b[static_cast<std::size_t>(inFiner[static_cast<std::size_t>(f)])].time;
                double& error = own[static_cast<Eigen::Index>(i)];
                error = std::hypot(error, s.repeated * s.refinement * (a[static_cast<std::size_t>(f)].time - other));
            }
    }
    Eigen::MatrixXd covariance = own.cwiseAbs2().asDiagonal();
    // The same event in another cycle: as many jumps of its direction lie before it in a stroke of its phase.
    std::vector<std::tuple<Phase, bool, int>> event;
    for (std::size_t i = 0; i < part.jumps.size(); ++i) {
        const replay::Landmark& jump = part.jumps[i];
        const std::size_t stroke = run.legAt(jump.time).stroke;
        const bool rises = jump.after > jump.before;
        int before = 0;
        for (std::size_t k = 0; k < i; ++k)
            before +=
                run.legAt(part.jumps[k].time).stroke == stroke && (part.jumps[k].after > part.jumps[k].before) == rises;
        event.emplace_back(run.strokes[stroke].phase, rises, before);
    }
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index k = 0; k < n; ++k)
            if (event[static_cast<std::size_t>(i)] == event[static_cast<std::size_t>(k)])
                covariance(i, k) += shared[i] * shared[k];
    part.jumpFactor = covariance.llt().matrixL();
}

bool Misfit::complete(std::size_t r, const Response& s) const {
    return s.failure.empty() && s.force.size() == data_.runs[r].force.size() &&
           s.markers.size() == data_.runs[r].markers.size();
}

Misfit::Places Misfit::placesOf(std::size_t r, const Response& s) const {
    const RecordedRun& run = data_.runs[r];
    const std::vector<replay::Landmark>& recorded = parts_[r].jumps;
    Places out;
    if (recorded.empty())
        return out;
    const auto simulated = jumpsOf(run, s, settings_);
    const std::vector<int> partner = sameJumps(run, recorded, simulated, settings_.jumpFarthest);
    for (std::size_t i = 0; i < recorded.size(); ++i) {
        const double t = recorded[i].time;
        out.there.push_back(partner[i] >= 0);
        if (partner[i] < 0) { // as far as may be, to the side of one that it might have been
            double nearest = std::numeric_limits<double>::infinity();
            for (const replay::Landmark& other : simulated)
                if ((other.after > other.before) == (recorded[i].after > recorded[i].before) &&
                    std::abs(other.time - t) < std::abs(nearest - t))
                    nearest = other.time;
            out.time.push_back(t + std::copysign(reachOf(run, t, settings_.jumpFarthest), nearest - t));
            continue;
        }
        out.time.push_back(simulated[static_cast<std::size_t>(partner[i])].time);
        out.between.push_back(around(t, out.time.back(), settings_));
    }
    return out;
}

void Misfit::bridgeAll(std::size_t r, const Stretches& between, Departure& d) const {
    const RecordedRun& run = data_.runs[r];
    const RowErrors& errors = parts_[r].errors;
    d.hidden.assign(static_cast<std::size_t>(d.rows.size()), false);
    if (between.empty())
        return;
    const auto one = [&](Eigen::Index from, const Eigen::VectorXd& time, const Eigen::VectorXd& error) {
        const std::vector<bool> hidden = rowsIn(between, time);
        bridge(d.rows.segment(from, time.size()), time, error, hidden);
        for (Eigen::Index k = 0; k < time.size(); ++k)
            d.hidden[static_cast<std::size_t>(from + k)] =
                hidden[static_cast<std::size_t>(k)] && std::isfinite(error[k]);
    };
    one(0, run.time, errors.force);
    const Eigen::Index seen = run.markerTime.size();
    for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount) && seen > 0; ++c)
        one(run.force.size() + c * seen, run.markerTime, errors.markers.segment(c * seen, seen));
}

Departure Misfit::departure(std::size_t r, const Response& s) const {
    const RecordedRun& run = data_.runs[r];
    if (!complete(r, s))
        return {};
    Departure out;
    out.rows.resize(rowsOf(r));
    const Places places = placesOf(r, s);
    out.rows.head(run.rows()) << run.force - s.force - parts_[r].errors.correction, run.markers - s.markers;
    for (std::size_t i = 0; i < places.time.size(); ++i)
        out.rows[run.rows() + static_cast<Eigen::Index>(i)] = parts_[r].jumps[i].time - places.time[i];
    bridgeAll(r, places.between, out);
    return out;
}

Departure Misfit::change(std::size_t r, const Response& a, const Response& b) const {
    const RecordedRun& run = data_.runs[r];
    if (!complete(r, a) || !complete(r, b))
        return {};
    Departure out;
    out.rows.resize(rowsOf(r));
    Places p = placesOf(r, a);
    const Places q = placesOf(r, b);
    out.rows.head(run.rows()) << a.force - b.force, a.markers - b.markers;
    for (std::size_t i = 0; i < p.time.size(); ++i) // what comes or goes between them is no derivative
        out.rows[run.rows() + static_cast<Eigen::Index>(i)] = p.there[i] && q.there[i] ? p.time[i] - q.time[i] : 0.0;
    p.between.insert(p.between.end(), q.between.begin(), q.between.end());
    bridgeAll(r, p.between, out);
    return out;
}

/// Leaves out what a shift could have done to a stretch of a marker; a symmetric map.
void Misfit::takeShiftOut(const Part& part, const Part::Shared& shift, Eigen::Ref<Eigen::VectorXd> markers) {
    const Eigen::VectorXd& errors = part.errors.markers;
    double n2 = 0.0, along = 0.0;
    for (Eigen::Index k = shift.from; k < shift.to; ++k)
        if (std::isfinite(errors[k])) {
            const double n = shift.deviation / errors[k];
            n2 += n * n;
            along += n * markers[k];
        }
    const double shrink = n2 > 0.0 ? along * (1.0 - 1.0 / std::sqrt(1.0 + n2)) / n2 : 0.0;
    for (Eigen::Index k = shift.from; k < shift.to; ++k)
        if (std::isfinite(errors[k]))
            markers[k] -= shrink * shift.deviation / errors[k];
}

Eigen::VectorXd Misfit::whiten(std::size_t r, const Eigen::VectorXd& departure) const {
    const Part& part = parts_[r];
    const RecordedRun& run = data_.runs[r];
    const auto markers = departure.segment(run.force.size(), run.markers.size());
    Eigen::VectorXd out = Eigen::VectorXd::Zero(rowsOf(r));
    if (const auto jumps = static_cast<Eigen::Index>(part.jumps.size()); jumps > 0)
        out.tail(jumps) = part.jumpFactor.triangularView<Eigen::Lower>().solve(departure.tail(jumps));
    Eigen::VectorXd present = departure.head(run.force.size());
    for (Eigen::Index k = 0; k < present.size(); ++k)
        if (!std::isfinite(part.errors.force[k]))
            present[k] = 0.0; // is not looked at
    Eigen::VectorXd u = part.force.apply(present);
    u -= part.own * (part.shrink * (part.own.transpose() * u));
    out.head(run.force.size()) = u;
    for (Eigen::Index k = 0; k < run.markers.size(); ++k)
        if (std::isfinite(part.errors.markers[k]))
            out[run.force.size() + k] = markers[k] / part.errors.markers[k];
    for (const Part::Shared& shift : part.shifts)
        takeShiftOut(part, shift, out.segment(run.force.size(), run.markers.size()));
    return out;
}

Eigen::VectorXd Misfit::whitenTransposed(std::size_t r, const Eigen::VectorXd& whitened) const {
    const Part& part = parts_[r];
    const RecordedRun& run = data_.runs[r];
    Eigen::VectorXd out = Eigen::VectorXd::Zero(rowsOf(r));
    if (const auto jumps = static_cast<Eigen::Index>(part.jumps.size()); jumps > 0)
        out.tail(jumps) = part.jumpFactor.triangularView<Eigen::Lower>().transpose().solve(whitened.tail(jumps));
    Eigen::VectorXd u = whitened.head(run.force.size());
    u -= part.own * (part.shrink.transpose() * (part.own.transpose() * u));
    out.head(run.force.size()) = part.force.transposed(u);
    auto markers = out.segment(run.force.size(), run.markers.size());
    markers = whitened.segment(run.force.size(), run.markers.size());
    for (auto shift = part.shifts.rbegin(); shift != part.shifts.rend(); ++shift)
        takeShiftOut(part, *shift, markers);
    for (Eigen::Index k = 0; k < markers.size(); ++k)
        markers[k] = std::isfinite(part.errors.markers[k]) ? markers[k] / part.errors.markers[k] : 0.0;
    return out;
}

std::optional<Eigen::VectorXd> Misfit::residual(const std::vector<Response>& simulated) const {
    Eigen::VectorXd out(rows());
    for (std::size_t r = 0; r < runs(); ++r) {
        const Departure d = departure(r, simulated[r]);
        if (d.rows.size() != rowsOf(r))
            return std::nullopt;
        out.segment(start(r), rowsOf(r)) = whiten(r, d.rows);
    }
    return out.allFinite() ? std::optional<Eigen::VectorXd>(std::move(out)) : std::nullopt;
}

Eigen::VectorXd Misfit::charge(const std::vector<Response>& simulated) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(rows());
    for (std::size_t r = 0; r < runs(); ++r) {
        const std::vector<bool> hidden = departure(r, simulated[r]).hidden;
        for (std::size_t k = 0; k < hidden.size(); ++k)
            out[start(r) + static_cast<Eigen::Index>(k)] = hidden[k] ? 1.0 : 0.0;
    }
    return out;
}

std::optional<Eigen::VectorXd> Misfit::difference(const std::vector<Response>& a,
                                                  const std::vector<Response>& b) const {
    Eigen::VectorXd out(rows());
    for (std::size_t r = 0; r < runs(); ++r) {
        const Departure d = change(r, a[r], b[r]);
        if (d.rows.size() != rowsOf(r))
            return std::nullopt;
        out.segment(start(r), rowsOf(r)) = whiten(r, d.rows);
    }
    return out.allFinite() ? std::optional<Eigen::VectorXd>(std::move(out)) : std::nullopt;
}

bool Misfit::counts(std::size_t r, Eigen::Index row) const {
    const RowErrors& e = parts_[r].errors;
    return isForce(r, row)    ? std::isfinite(e.force[row])
           : isMarker(r, row) ? std::isfinite(e.markers[row - e.force.size()])
                              : true;
}

std::size_t Misfit::stroke(std::size_t r, Eigen::Index row) const {
    const RecordedRun& run = data_.runs[r];
    return isForce(r, row)    ? run.stroke(row)
           : isMarker(r, row) ? run.markerStroke((row - run.force.size()) % run.markerTime.size())
                              : run.legAt(parts_[r].jumps[static_cast<std::size_t>(row - run.rows())].time).stroke;
}

Eigen::Index Misfit::presentIn(std::size_t r) const {
    Eigen::Index n = 0;
    for (Eigen::Index k = 0; k < rowsOf(r); ++k)
        n += counts(r, k) ? 1 : 0;
    return n;
}

Eigen::Index Misfit::present() const {
    Eigen::Index n = 0;
    for (std::size_t r = 0; r < runs(); ++r)
        n += presentIn(r);
    return n;
}

} // namespace supercircle::diagnosis
