#include "plugin/diagnosis/sight.h"

#include "plugin/diagnosis/row_errors.h"
#include "plugin/diagnosis/whitening.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

constexpr double kUsualCamera = 3e-5; ///< m, noise of a marker's coordinate where none was tracked yet

/// How far the machine goes from row to row around each, m; 0 without a machine.
Eigen::VectorXd ways(const Design& design, const Eigen::VectorXd& time) {
    const auto at = [&](double t) { // of the head
        std::size_t i = 1;
        while (i + 1 < design.time.size() && design.time[i] < t)
            ++i;
        const double share = (t - design.time[i - 1]) / (design.time[i] - design.time[i - 1]);
        return design.displacement[i - 1] +
               std::clamp(share, 0.0, 1.0) * (design.displacement[i] - design.displacement[i - 1]);
    };
    Eigen::VectorXd out = Eigen::VectorXd::Zero(time.size());
    for (Index k = 1; k < time.size() && design.time.size() > 1; ++k)
        out[k] = std::abs(at(time[k]) - at(time[k - 1]));
    return out;
}

/// Times at which the force jumps: between readings, as misfit.h asks of recorded ones.
std::vector<std::pair<double, double>> jumpsOf(const DesignResponse& like, const MisfitSettings& s) {
    const double least = s.snapShare * (like.force.maxCoeff() - like.force.minCoeff());
    std::vector<std::pair<double, double>> out;
    for (Index k = 1; k < like.force.size(); ++k)
        if (std::abs(like.force[k] - like.force[k - 1]) >= least && least > 0.0)
            out.emplace_back(like.time[k - 1], like.time[k]);
    return out;
}

/// Frames [from, to) in which markers share a shift.
struct Piece {
    Index from = 0, to = 0;
    bool landed = false; ///< behind a jump
};

/// Between the places where the machine turns round or the force jumps.
std::vector<Piece> piecesOf(const Design& design, const DesignResponse& like, const MisfitSettings& s) {
    const Eigen::VectorXd& frames = like.markerTime;
    const auto frameAt = [&](double t) { return std::lower_bound(frames.begin(), frames.end(), t) - frames.begin(); };
    const auto direction = [&](std::size_t i) {
        const double way = design.displacement[i] - design.displacement[i - 1];
        return (way > 0.0) - (way < 0.0);
    };
    std::vector<Index> cuts = {0, frames.size()};
    for (std::size_t i = 2; i < design.time.size(); ++i)
        if (direction(i) != direction(i - 1))
            cuts.push_back(frameAt(design.time[i - 1]));
    const auto jumps = jumpsOf(like, s);
    for (const auto& jump : jumps)
        cuts.push_back(frameAt(jump.second));
    std::sort(cuts.begin(), cuts.end());
    std::vector<Piece> out;
    for (std::size_t i = 1; i < cuts.size(); ++i)
        if (cuts[i] > cuts[i - 1])
            out.push_back({cuts[i - 1], cuts[i], !jumps.empty() && cuts[i - 1] >= frameAt(jumps.front().second)});
    return out;
}

/// Weights of a run's readings.
class Sight {
public:
    Sight(const Design& design, const DesignResponse& like, const Noise& noise, const MisfitSettings& s)
        : forces_(like.force.size()) {
        const double peak = like.force.cwiseAbs().maxCoeff();
        const double everywhere = std::hypot(s.repeated * design.doubt * s.shareOfPeak * peak, noise.runToRun);
        const Eigen::VectorXd way = ways(design, like.time);
        Eigen::VectorXd errors(forces_);
        for (Index k = 0; k < forces_; ++k)
            errors[k] = std::hypot(everywhere, placeError(like.force, k, way[k], s));
        // For a tenth of a leg at a time: many readings do not average it away.
        white_ = Whitening(like.time, noise.white, noise.coloured, noise.memory, errors,
                           std::clamp(0.05 * (like.time[forces_ - 1] - like.time[0]), 0.02, 3.0));
        const Eigen::VectorXd one = white_.apply(Eigen::VectorXd::Ones(forces_));
        shift_ = one / one.norm();
        const double camera = noise.marker > 0.0 ? noise.marker : kUsualCamera;
        const double place = s.repeated * design.doubt * s.markerPlace;
        markers_ = Eigen::VectorXd::Constant(like.markers.size(), 1.0 / std::hypot(camera, place));
        leaveSwingsOut(like, s.free * peak, s.swing);
        for (const auto& jump : jumpsOf(like, s)) {
            const auto [from, to] = around(jump.first, jump.second, s);
            leaveOut(like.markerTime, from, to);
        }
    }
    /// Whitened, a constant shift of the force taken out.
    [[nodiscard]] Eigen::MatrixXd operator()(const Eigen::MatrixXd& readings) const {
        Eigen::MatrixXd u(readings.rows(), readings.cols());
        u.topRows(forces_) = white_.columns(readings.topRows(forces_));
        u.topRows(forces_) -= shift_ * (shift_.transpose() * u.topRows(forces_));
        u.bottomRows(markers_.size()) = markers_.asDiagonal() * readings.bottomRows(markers_.size());
        return u;
    }

private:
    /// Markers of a specimen that was let go say nothing (row_errors.h).
    void leaveSwingsOut(const DesignResponse& r, double held, double swing) {
        for (Index k = 1; k < forces_; ++k)
            if (std::abs(r.force[k - 1]) > held && std::abs(r.force[k]) <= held)
                leaveOut(r.markerTime, r.time[k - 1], r.time[k] + swing);
    }
    void leaveOut(const Eigen::VectorXd& frames, double from, double to) {
        for (Index i = 0; i < markers_.size(); ++i)
            if (const double t = frames[i % frames.size()]; t >= from && t <= to)
                markers_[i] = 0.0;
    }

    Index forces_;
    Whitening white_;
    Eigen::VectorXd shift_;   ///< of length 1
    Eigen::VectorXd markers_; ///< 1 over the deviation of each of their rows, 1/m
};

/// Changes of the readings by one deviation of each thing that a run has of its own.
Eigen::MatrixXd ownOf(const Design& design, const DesignResponse& like, const MisfitSettings& s) {
    const Index n = like.force.size(), frames = like.markerTime.size();
    const Index tracks = frames > 0 ? like.markers.size() / frames : 0;
    const std::vector<Piece> pieces = piecesOf(design, like, s);
    const auto count = static_cast<Index>(pieces.size());
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(n + like.markers.size(), 2 + tracks * count);
    own.col(0).segment(1, n - 2) = s.clock * 0.5 * (like.force.tail(n - 2) - like.force.head(n - 2));
    own.col(1).head(n) = (design.time.empty() ? 0.0 : s.repeated * s.scale) * like.force;
    for (Index c = 0; c < tracks; ++c)
        for (Index i = 0; i < count; ++i) {
            const Piece& piece = pieces[static_cast<std::size_t>(i)];
            own.col(2 + c * count + i)
                .segment(n + c * frames + piece.from, piece.to - piece.from)
                .setConstant(s.repeated * (piece.landed ? s.landing : s.markerShift));
        }
    return own;
}

} // namespace

Eigen::MatrixXd seenProducts(const Design& design, const DesignResponse& like, const Noise& noise,
                             const Eigen::MatrixXd& columns, std::size_t repeats) {
    const MisfitSettings s = MisfitSettings{}.inEachOf(repeats);
    const Sight sight(design, like, noise, s);
    const Eigen::MatrixXd own = sight(ownOf(design, like, s)), seen = sight(columns), taken = own.transpose() * seen;
    const Eigen::MatrixXd alone = Eigen::MatrixXd::Identity(own.cols(), own.cols()) + own.transpose() * own;
    return static_cast<double>(repeats) * (seen.transpose() * seen - taken.transpose() * alone.ldlt().solve(taken));
}

} // namespace supercircle::diagnosis
