#include "plugin/identification/diagnosis/recorded/periodic_disturbance.h"

#include "plugin/identification/diagnosis/likelihood/whitening.h"
#include "plugin/identification/diagnosis/model/decompositions.h"
#include "supercircle/support/elementary.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// The trends of a dwell interval and, after a motion, relaxations.
/// @param unit s, natural unit of time
Eigen::MatrixXd relaxations(const DwellInterval& r, double unit) {
    constexpr std::array kTimes = {0.3, 1.0, 3.0}; // natural s
    const Index given = r.trends.cols();
    if (given == 1)
        return r.trends;
    Eigen::MatrixXd out(r.trends.rows(), given + static_cast<Index>(kTimes.size()));
    out.leftCols(given) = r.trends;
    for (std::size_t i = 0; i < kTimes.size(); ++i)
        out.col(given + static_cast<Index>(i)) =
            (-(r.time.array() - r.time[0]) / (kTimes[i] * unit)).unaryExpr([](double each) { return math::exp(each); });
    return out;
}

/// A dwell interval, whitened and without its trends.
struct WhitenedDwell {
    const DwellInterval* dwell = nullptr;
    Whitening whitening;
    Eigen::MatrixXd basis;
    Eigen::VectorXd force;

    WhitenedDwell(const DwellInterval& r, const CorrelatedNoise& noise, double unit)
        : dwell(&r), whitening(r.time, noise.white, noise.correlated, noise.correlationTime) {
        const Eigen::MatrixXd x = whitening.columns(relaxations(r, unit));
        basis = dense::orthonormalColumns(x);
        force = withoutTrends(r.force);
    }
    [[nodiscard]] Eigen::VectorXd withoutTrends(const Eigen::VectorXd& raw) const {
        Eigen::VectorXd u = whitening.apply(raw);
        u -= basis * (basis.transpose() * u);
        return u;
    }
};

/// The most probable noise of any size and correlation time.
struct NoiseFit {
    CorrelatedNoise noise;
    double logLikelihood = -std::numeric_limits<double>::infinity();
};

/// Noise fitted on a grid around the scale of second differences.
NoiseFit fitNoise(const std::vector<DwellInterval>& left, double unit) {
    double squares = 0.0, count = 0.0;
    for (const DwellInterval& r : left)
        for (Index k = 0; k + 2 < r.force.size(); ++k, count += 1.0)
            squares += math::pow(r.force[k + 2] - 2.0 * r.force[k + 1] + r.force[k], 2);
    const double size = std::sqrt(squares / std::max(1.0, count) / 6.0);
    NoiseFit best;
    for (int i = -8; i <= 2 && size > 0.0; ++i)
        for (int j = -3; j <= 12; ++j)
            for (const double times : {0.2, 0.5, 1.0, 2.0, 5.0, 10.0}) {
                const double correlationTime = times * unit;
                const double white = size * math::exp(0.2 * i);
                const CorrelatedNoise noise{white, white * math::exp(0.4 * j), correlationTime};
                double l = 0.0;
                for (const DwellInterval& r : left)
                    l += restrictedLogLikelihood(r, noise.white, noise.correlated, noise.correlationTime);
                if (l > best.logLikelihood)
                    best = {noise, l};
            }
    return best;
}

/// Residuals of whole runs, each about its own mean.
std::vector<DwellInterval> residualsOfRuns(const RecordedData& data, const std::vector<Eigen::VectorXd>& left) {
    constexpr std::size_t kFewest = 12; // rows
    std::vector<DwellInterval> out;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        std::vector<double> t, f;
        for (Index k = 0; k < left[r].size(); ++k)
            if (std::isfinite(left[r][k])) {
                t.push_back(data.runs[r].time[k]);
                f.push_back(left[r][k]);
            }
        if (t.size() < kFewest)
            continue;
        DwellInterval whole;
        whole.run = r;
        whole.time = Eigen::Map<Eigen::VectorXd>(t.data(), static_cast<Index>(t.size()));
        whole.force = Eigen::Map<Eigen::VectorXd>(f.data(), static_cast<Index>(f.size()));
        whole.trends = Eigen::MatrixXd::Ones(whole.time.size(), 1);
        out.push_back(std::move(whole));
    }
    return out;
}

void subtract(const PeriodicDisturbance& disturbance, std::vector<DwellInterval>& left) {
    for (DwellInterval& r : left)
        for (Index k = 0; k < r.time.size(); ++k)
            r.force[k] -= disturbance.at(r.run, r.time[k]);
}

double sumOfSquares(const std::vector<DwellInterval>& left) {
    double sum = 0.0;
    for (const DwellInterval& r : left)
        sum += (r.force.array() - r.force.mean()).square().sum();
    return sum;
}

/// Whether runs longer than two periods have similar amplitudes.
bool similarInAllRuns(const PeriodicDisturbance& disturbance, const std::vector<DwellInterval>& left) {
    constexpr double kPeriods = 2.0, kApart = 2.0;
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (const DwellInterval& r : left)
        if (r.time[r.time.size() - 1] - r.time[0] >= kPeriods * disturbance.period) {
            const double size = math::hypot(disturbance.cosine[r.run], disturbance.sine[r.run]);
            least = std::min(least, size);
            most = std::max(most, size);
        }
    return most > 0.0 && most <= kApart * least;
}

} // namespace

double PeriodicDisturbance::amplitude() const {
    double sum = 0.0, n = 0.0;
    for (std::size_t r = 0; r < cosine.size(); ++r)
        if (const double square = cosine[r] * cosine[r] + sine[r] * sine[r]; square > 0.0) {
            sum += square;
            n += 1.0;
        }
    return n > 0.0 ? std::sqrt(sum / n) : 0.0;
}

double PeriodicDisturbance::at(std::size_t run, double time) const {
    if (period <= 0.0)
        return 0.0;
    const double phase = 2.0 * M_PI * time / period;
    return cosine[run] * math::cos(phase) + sine[run] * math::sin(phase);
}

PeriodicDisturbance strongestDisturbance(const RecordedData& data, const std::vector<DwellInterval>& dwells,
                                         const CorrelatedNoise& noise, double periods) {
    std::vector<WhitenedDwell> plain;
    double span = 0.0, longest = 0.0, dt = 0.0; // s
    std::vector<double> dwelling(data.runs.size(), 0.0);
    for (const DwellInterval& r : dwells) {
        plain.emplace_back(r, noise, data.units.time);
        dwelling[r.run] += r.time[r.time.size() - 1] - r.time[0];
        longest = std::max(longest, dwelling[r.run]);
        const RecordedRun& run = data.runs[r.run];
        span = std::max(span, run.time[run.time.size() - 1] - run.time[0]);
        dt = std::max(dt, run.spacing());
    }
    PeriodicDisturbance best;
    if (longest <= 0.0)
        return best;
    constexpr double kRows = 5.0, kOversampling = 4.0;
    constexpr int kMost = 1500; // frequencies
    double f = periods / longest;
    for (int i = 0; i < kMost && f < 1.0 / (kRows * dt); ++i, f += 1.0 / (kOversampling * span)) {
        std::vector<Eigen::Matrix2d> gram(data.runs.size(), Eigen::Matrix2d::Zero());
        std::vector<Eigen::Vector2d> product(data.runs.size(), Eigen::Vector2d::Zero());
        for (const WhitenedDwell& p : plain) {
            const Eigen::ArrayXd phase = 2.0 * M_PI * f * p.dwell->time.array();
            Eigen::MatrixXd x(phase.size(), 2);
            x.col(0) = p.withoutTrends(phase.unaryExpr(&math::cos));
            x.col(1) = p.withoutTrends(phase.unaryExpr(&math::sin));
            gram[p.dwell->run] += x.transpose() * x;
            product[p.dwell->run] += x.transpose() * p.force;
        }
        const std::vector<double> none(data.runs.size(), 0.0);
        PeriodicDisturbance disturbance{1.0 / f, none, none};
        for (std::size_t r = 0; r < data.runs.size(); ++r) {
            const Eigen::VectorXd eigen = dense::symmetricEigenvalues(gram[r]);
            // The phase is unknown where the trends of a run explain the sine.
            if (eigen[0] < 0.05 * eigen[1] || eigen[1] <= 0.0)
                continue;
            const Eigen::Vector2d c = gram[r].ldlt().solve(product[r]);
            disturbance.explained += c.dot(product[r]);
            disturbance.cosine[r] = c[0];
            disturbance.sine[r] = c[1];
        }
        if (disturbance.explained > best.explained)
            best = std::move(disturbance);
    }
    return best;
}

double disturbancePenalty(const RecordedData& data) {
    return 15.0 + 3.0 * (2.0 * static_cast<double>(data.runs.size()) + 1.0);
}

RecordedData PeriodicDisturbance::removedFrom(const RecordedData& data) const {
    RecordedData still = data;
    for (std::size_t r = 0; r < still.runs.size(); ++r)
        for (Index k = 0; k < still.runs[r].force.size(); ++k)
            still.runs[r].force[k] -= at(r, still.runs[r].time[k]);
    return still;
}

PeriodicDisturbance findDisturbanceInResidual(const RecordedData& data, const std::vector<Eigen::VectorXd>& left) {
    constexpr double kPeriods = 4.0, kShare = 0.5;
    const std::vector<DwellInterval> whole = residualsOfRuns(data, left);
    if (whole.empty())
        return {};
    const NoiseFit without = fitNoise(whole, data.units.time);
    NoiseFit with = without;
    PeriodicDisturbance disturbance;
    std::vector<DwellInterval> still;
    for (int round = 0; round < 2; ++round) { // the second with the noise left by the first
        disturbance = strongestDisturbance(data, whole, with.noise, kPeriods);
        if (disturbance.period <= 0.0 || !similarInAllRuns(disturbance, whole))
            return {};
        still = whole;
        subtract(disturbance, still);
        with = fitNoise(still, data.units.time);
    }
    const bool most = sumOfSquares(still) <= (1.0 - kShare) * sumOfSquares(whole);
    return most && with.logLikelihood >= without.logLikelihood + disturbancePenalty(data) ? disturbance
                                                                                          : PeriodicDisturbance{};
}

} // namespace supercircle::diagnosis
