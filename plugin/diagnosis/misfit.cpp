#include "plugin/diagnosis/misfit.h"

#include "plugin/replay/compare.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

namespace {

constexpr double kMissing = std::numeric_limits<double>::infinity();

std::vector<double> listOf(const Eigen::VectorXd& v) {
    return {v.data(), v.data() + v.size()};
}

double spacing(const RecordedRun& run) {
    return run.time.size() > 1
               ? (run.time[run.time.size() - 1] - run.time[0]) / static_cast<double>(run.time.size() - 1)
               : 1.0;
}

/// Steepest change of the simulated force from one row to the next within two rows, N.
double steepest(const Eigen::VectorXd& force, Eigen::Index k) {
    double most = 0.0;
    for (Eigen::Index j = std::max<Eigen::Index>(1, k - 1); j <= std::min(force.size() - 1, k + 2); ++j)
        most = std::max(most, std::abs(force[j] - force[j - 1]));
    return most;
}

void leaveOutSnaps(const RecordedRun& run, const Eigen::VectorXd& force, const MisfitSettings& s, RowErrors& out) {
    const experiment::Readings readings{listOf(run.time), listOf(run.displacement), listOf(force)};
    const double dt = spacing(run);
    for (const replay::Landmark& jump : replay::findLandmarks(readings, s.snapShare)) {
        // A jump at a turning point of the drive is friction or viscosity turning round, known to a row.
        const bool turns = std::any_of(run.legs.begin(), run.legs.end(), [&](const Leg& leg) {
            return jump.time > leg.from - 2.0 * dt && jump.time < leg.from + 0.1 + 2.0 * dt;
        });
        if (!turns)
            out.snaps.push_back(jump.time);
        const double before = turns ? 1.5 * dt : s.snapBefore, after = turns ? 1.5 * dt : s.snapAfter;
        for (Eigen::Index k = 0; k < run.time.size(); ++k)
            if (run.time[k] > jump.time - before && run.time[k] < jump.time + after)
                out.force[k] = kMissing;
        for (Eigen::Index k = 0; k < run.markerTime.size() && !turns; ++k)
            if (run.markerTime[k] > jump.time - before && run.markerTime[k] < jump.time + after)
                for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount); ++c)
                    out.markers[c * run.markerTime.size() + k] = kMissing;
    }
}

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

/// S of (1 + N N')^(-1/2) = 1 - N S N'.
Eigen::MatrixXd shrinking(const Eigen::MatrixXd& N) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(N.transpose() * N);
    Eigen::VectorXd s = eigen.eigenvalues().cwiseMax(0.0);
    for (double& v : s) // (1 - 1/sqrt(1 + v)) / v, 1/2 where v vanishes
        v = v > 1e-9 ? (1.0 - 1.0 / std::sqrt(1.0 + v)) / v : 0.5;
    return eigen.eigenvectors() * s.asDiagonal() * eigen.eigenvectors().transpose();
}

} // namespace

RowErrors rowErrors(const RecordedRun& run, const Noise& noise, const Response& fine, const Response& coarse,
                    double peakForce, const MisfitSettings& s) {
    RowErrors out;
    const Eigen::Index n = run.force.size();
    out.force = Eigen::VectorXd::Constant(n, std::hypot(s.shareOfPeak * peakForce, noise.runToRun));
    out.markers = Eigen::VectorXd::Constant(run.markers.size(), std::hypot(noise.marker, s.markerPlace));
    double shortest = kMissing;
    for (const Leg& leg : run.legs)
        if (leg.phase != Phase::Hold)
            shortest = std::min(shortest, leg.to - leg.from);
    out.memory = std::isfinite(shortest) ? std::clamp(0.1 * shortest, 0.02, 3.0) : 1.0;
    const bool known = fine.failure.empty() && fine.force.size() == n;
    const bool both = known && coarse.failure.empty() && coarse.force.size() == n;
    const double dt = spacing(run);
    const auto reach = std::max<Eigen::Index>(2, static_cast<Eigen::Index>(out.memory / dt));
    for (Eigen::Index k = 0; k < n && known; ++k) {
        const Leg& leg = run.legs[static_cast<std::size_t>(run.leg[static_cast<std::size_t>(k)])];
        const double way = std::abs(leg.speed) * dt; // of the head from row to row
        const double place = way > 0.0 ? steepest(fine.force, k) * std::min(1.0, s.contactPlace / way) : 0.0;
        double grid = 0.0;
        if (both) {
            const Eigen::Index a = std::max<Eigen::Index>(0, k - reach), b = std::min(n, k + reach + 1);
            grid = (fine.force - coarse.force).segment(a, b - a).norm() / std::sqrt(static_cast<double>(b - a)) / 3.0;
        }
        out.force[k] = std::sqrt(out.force[k] * out.force[k] + place * place + grid * grid);
    }
    for (Eigen::Index k = 0; k < run.markers.size(); ++k) {
        if (both && fine.markers.size() == run.markers.size() && coarse.markers.size() == run.markers.size())
            out.markers[k] = std::hypot(out.markers[k], (fine.markers[k] - coarse.markers[k]) / 3.0);
        if (!std::isfinite(run.markers[k]) || !std::isfinite(out.markers[k]))
            out.markers[k] = kMissing;
    }
    leaveOutSnaps(run, run.force, s, out);
    if (known)
        leaveOutSnaps(run, fine.force, s, out);
    for (Eigen::Index k = 0; k < n; ++k)
        if (!std::isfinite(run.force[k]) || !std::isfinite(out.force[k]))
            out.force[k] = kMissing;
    return out;
}

Misfit::Misfit(const Data& data, const Noise& noise, const std::vector<Response>& fine,
               const std::vector<Response>& coarse, const MisfitSettings& settings)
    : data_(data), noise_(noise), start_{0} {
    const double peak = data.free ? 0.0 : data.peakForce(); // the equations of free bodies are solved exactly
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const RecordedRun& run = data.runs[r];
        Part part;
        part.errors = rowErrors(run, noise, fine[r], coarse[r], peak, settings);
        part.force =
            Whitening(run.time, noise.white, noise.coloured, noise.memory, part.errors.force, part.errors.memory);
        const double prior = data.zeroWindow > 0.0 ? noise.ofMean(data.zeroWindow, spacing(run)) : noise.total();
        part.own.resize(run.force.size(), 2);
        part.own.col(0) = part.force.apply(Eigen::VectorXd::Constant(run.force.size(), prior));
        part.own.col(1) = part.force.apply(clockShift(run, fine[r], part.errors.force) * settings.clock);
        part.shrink = shrinking(part.own);
        addPlaces(run, settings.markerShift, part);
        addLandings(run, settings.landing, part);
        parts_.push_back(std::move(part));
        start_.push_back(start_.back() + run.rows());
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

/// Marker rows of each leg.
void Misfit::addPlaces(const RecordedRun& run, double deviation, Part& part) {
    const Eigen::Index seen = run.markerTime.size();
    for (Eigen::Index from = 0, to = 0; from < seen; from = to) {
        while (to < seen &&
               run.markerLeg[static_cast<std::size_t>(to)] == run.markerLeg[static_cast<std::size_t>(from)])
            ++to;
        for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount); ++c)
            part.shifts.push_back({c * seen + from, c * seen + to, deviation});
    }
}

Eigen::VectorXd Misfit::whiten(std::size_t r, const Eigen::VectorXd& force, const Eigen::VectorXd& markers) const {
    const Part& part = parts_[r];
    const RecordedRun& run = data_.runs[r];
    Eigen::VectorXd out = Eigen::VectorXd::Zero(run.rows());
    Eigen::VectorXd present = force;
    for (Eigen::Index k = 0; k < present.size(); ++k)
        if (!std::isfinite(part.errors.force[k]))
            present[k] = 0.0; // is not looked at
    Eigen::VectorXd u = part.force.apply(present);
    u -= part.own * (part.shrink * (part.own.transpose() * u));
    out.head(run.force.size()) = u;
    for (Eigen::Index k = 0; k < run.markers.size() && k < markers.size(); ++k)
        if (std::isfinite(part.errors.markers[k]))
            out[run.force.size() + k] = markers[k] / part.errors.markers[k];
    for (const auto& [from, to, deviation] : part.shifts) {
        double n2 = 0.0, along = 0.0;
        for (Eigen::Index k = from; k < to; ++k)
            if (std::isfinite(part.errors.markers[k])) {
                const double n = deviation / part.errors.markers[k];
                n2 += n * n;
                along += n * out[run.force.size() + k];
            }
        const double shrink = n2 > 0.0 ? along * (1.0 - 1.0 / std::sqrt(1.0 + n2)) / n2 : 0.0;
        for (Eigen::Index k = from; k < to; ++k)
            if (std::isfinite(part.errors.markers[k]))
                out[run.force.size() + k] -= shrink * deviation / part.errors.markers[k];
    }
    return out;
}

std::optional<Eigen::VectorXd> Misfit::residual(const std::vector<Response>& simulated) const {
    Eigen::VectorXd out(rows());
    for (std::size_t r = 0; r < runs(); ++r) {
        const RecordedRun& run = data_.runs[r];
        const Response& s = simulated[r];
        if (!s.failure.empty() || s.force.size() != run.force.size() || s.markers.size() != run.markers.size())
            return std::nullopt;
        out.segment(start(r), rowsOf(r)) = whiten(r, run.force - s.force, run.markers - s.markers);
    }
    return out.allFinite() ? std::optional<Eigen::VectorXd>(std::move(out)) : std::nullopt;
}

std::optional<Eigen::VectorXd> Misfit::difference(const std::vector<Response>& a,
                                                  const std::vector<Response>& b) const {
    Eigen::VectorXd out(rows());
    for (std::size_t r = 0; r < runs(); ++r) {
        if (!a[r].failure.empty() || !b[r].failure.empty() || a[r].force.size() != b[r].force.size() ||
            a[r].markers.size() != b[r].markers.size())
            return std::nullopt;
        out.segment(start(r), rowsOf(r)) = whiten(r, a[r].force - b[r].force, a[r].markers - b[r].markers);
    }
    return out.allFinite() ? std::optional<Eigen::VectorXd>(std::move(out)) : std::nullopt;
}

Eigen::Index Misfit::presentIn(std::size_t r) const {
    Eigen::Index n = parts_[r].force.present();
    for (const double e : parts_[r].errors.markers)
        n += std::isfinite(e) ? 1 : 0;
    return n;
}

Eigen::Index Misfit::present() const {
    Eigen::Index n = 0;
    for (std::size_t r = 0; r < runs(); ++r)
        n += presentIn(r);
    return n;
}

} // namespace supercircle::diagnosis
