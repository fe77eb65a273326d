#include "plugin/identification/diagnosis/recorded/swings.h"

#include "plugin/identification/diagnosis/likelihood/whitening.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// The trends of a rest and, behind a motion, what relaxes within 0.3, 1 and 3 s.
Eigen::MatrixXd relaxations(const Rest& r) {
    constexpr std::array kTimes = {0.3, 1.0, 3.0};
    const Index given = r.trends.cols();
    if (given == 1)
        return r.trends;
    Eigen::MatrixXd out(r.trends.rows(), given + static_cast<Index>(kTimes.size()));
    out.leftCols(given) = r.trends;
    for (std::size_t i = 0; i < kTimes.size(); ++i)
        out.col(given + static_cast<Index>(i)) = (-(r.time.array() - r.time[0]) / kTimes[i]).exp();
    return out;
}

/// A rest, whitened and freed from its trends.
struct Plain {
    const Rest* rest = nullptr;
    Whitening whitening;
    Eigen::MatrixXd basis;
    Eigen::VectorXd force;

    Plain(const Rest& r, const Coloured& noise)
        : rest(&r), whitening(r.time, noise.white, noise.coloured, noise.memory) {
        const Eigen::MatrixXd x = whitening.columns(relaxations(r));
        basis = Eigen::HouseholderQR<Eigen::MatrixXd>(x).householderQ() * Eigen::MatrixXd::Identity(x.rows(), x.cols());
        force = free(r.force);
    }
    [[nodiscard]] Eigen::VectorXd free(const Eigen::VectorXd& raw) const {
        Eigen::VectorXd u = whitening.apply(raw);
        u -= basis * (basis.transpose() * u);
        return u;
    }
};

/// The most probable noise, whatever its size and memory.
struct Explained {
    Coloured noise;
    double logLikelihood = -std::numeric_limits<double>::infinity();
};

/// Among sizes around that of the rows' second differences.
Explained asNoise(const std::vector<Rest>& left) {
    double squares = 0.0, count = 0.0;
    for (const Rest& r : left)
        for (Index k = 0; k + 2 < r.force.size(); ++k, count += 1.0)
            squares += std::pow(r.force[k + 2] - 2.0 * r.force[k + 1] + r.force[k], 2);
    const double size = std::sqrt(squares / std::max(1.0, count) / 6.0);
    Explained best;
    for (int i = -8; i <= 2 && size > 0.0; ++i)
        for (int j = -3; j <= 12; ++j)
            for (const double memory : {0.2, 0.5, 1.0, 2.0, 5.0, 10.0}) {
                const double white = size * std::exp(0.2 * i);
                const Coloured noise{white, white * std::exp(0.4 * j), memory};
                double l = 0.0;
                for (const Rest& r : left)
                    l += restrictedLogLikelihood(r, noise.white, noise.coloured, noise.memory);
                if (l > best.logLikelihood)
                    best = {noise, l};
            }
    return best;
}

/// What is left of whole runs, each around a mean of its own.
std::vector<Rest> wholeRuns(const Data& data, const std::vector<Eigen::VectorXd>& left) {
    constexpr std::size_t kFewest = 12; // rows
    std::vector<Rest> out;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        std::vector<double> t, f;
        for (Index k = 0; k < left[r].size(); ++k)
            if (std::isfinite(left[r][k])) {
                t.push_back(data.runs[r].time[k]);
                f.push_back(left[r][k]);
            }
        if (t.size() < kFewest)
            continue;
        Rest whole;
        whole.run = r;
        whole.time = Eigen::Map<Eigen::VectorXd>(t.data(), static_cast<Index>(t.size()));
        whole.force = Eigen::Map<Eigen::VectorXd>(f.data(), static_cast<Index>(f.size()));
        whole.trends = Eigen::MatrixXd::Ones(whole.time.size(), 1);
        out.push_back(std::move(whole));
    }
    return out;
}

void takeOut(const Swing& swing, std::vector<Rest>& left) {
    for (Rest& r : left)
        for (Index k = 0; k < r.time.size(); ++k)
            r.force[k] -= swing.at(r.run, r.time[k]);
}

double squaresOf(const std::vector<Rest>& left) {
    double sum = 0.0;
    for (const Rest& r : left)
        sum += (r.force.array() - r.force.mean()).square().sum();
    return sum;
}

/// Whether the runs that hold two periods swing alike.
bool alikeInAll(const Swing& swing, const std::vector<Rest>& left) {
    constexpr double kPeriods = 2.0, kApart = 2.0;
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (const Rest& r : left)
        if (r.time[r.time.size() - 1] - r.time[0] >= kPeriods * swing.period) {
            const double size = std::hypot(swing.cosine[r.run], swing.sine[r.run]);
            least = std::min(least, size);
            most = std::max(most, size);
        }
    return most > 0.0 && most <= kApart * least;
}

} // namespace

double Swing::amplitude() const {
    double sum = 0.0, n = 0.0;
    for (std::size_t r = 0; r < cosine.size(); ++r)
        if (const double square = cosine[r] * cosine[r] + sine[r] * sine[r]; square > 0.0) {
            sum += square;
            n += 1.0;
        }
    return n > 0.0 ? std::sqrt(sum / n) : 0.0;
}

double Swing::at(std::size_t run, double time) const {
    if (period <= 0.0)
        return 0.0;
    const double phase = 2.0 * M_PI * time / period;
    return cosine[run] * std::cos(phase) + sine[run] * std::sin(phase);
}

Swing largestSwing(const Data& data, const std::vector<Rest>& rests, const Coloured& noise, double periods) {
    std::vector<Plain> plain;
    double span = 0.0, longest = 0.0, dt = 0.0; // s
    std::vector<double> resting(data.runs.size(), 0.0);
    for (const Rest& r : rests) {
        plain.emplace_back(r, noise);
        resting[r.run] += r.time[r.time.size() - 1] - r.time[0];
        longest = std::max(longest, resting[r.run]);
        const RecordedRun& run = data.runs[r.run];
        span = std::max(span, run.time[run.time.size() - 1] - run.time[0]);
        dt = std::max(dt, run.spacing());
    }
    Swing best;
    if (longest <= 0.0)
        return best;
    constexpr double kRows = 5.0, kOversampling = 4.0;
    constexpr int kMost = 1500; // frequencies
    double f = periods / longest;
    for (int i = 0; i < kMost && f < 1.0 / (kRows * dt); ++i, f += 1.0 / (kOversampling * span)) {
        std::vector<Eigen::Matrix2d> gram(data.runs.size(), Eigen::Matrix2d::Zero());
        std::vector<Eigen::Vector2d> product(data.runs.size(), Eigen::Vector2d::Zero());
        for (const Plain& p : plain) {
            const Eigen::ArrayXd phase = 2.0 * M_PI * f * p.rest->time.array();
            Eigen::MatrixXd x(phase.size(), 2);
            x.col(0) = p.free(phase.cos());
            x.col(1) = p.free(phase.sin());
            gram[p.rest->run] += x.transpose() * x;
            product[p.rest->run] += x.transpose() * p.force;
        }
        const std::vector<double> none(data.runs.size(), 0.0);
        Swing swing{1.0 / f, none, none};
        for (std::size_t r = 0; r < data.runs.size(); ++r) {
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(gram[r]);
            // What a run's trends imitate says nothing of its phase.
            if (eigen.eigenvalues()[0] < 0.05 * eigen.eigenvalues()[1] || eigen.eigenvalues()[1] <= 0.0)
                continue;
            const Eigen::Vector2d c = gram[r].ldlt().solve(product[r]);
            swing.explained += c.dot(product[r]);
            swing.cosine[r] = c[0];
            swing.sine[r] = c[1];
        }
        if (swing.explained > best.explained)
            best = std::move(swing);
    }
    return best;
}

double priceOfSwing(const Data& data) {
    return 15.0 + 3.0 * (2.0 * static_cast<double>(data.runs.size()) + 1.0);
}

Data Swing::takenOut(const Data& data) const {
    Data still = data;
    for (std::size_t r = 0; r < still.runs.size(); ++r)
        for (Index k = 0; k < still.runs[r].force.size(); ++k)
            still.runs[r].force[k] -= at(r, still.runs[r].time[k]);
    return still;
}

Swing swingOfMisfit(const Data& data, const std::vector<Eigen::VectorXd>& left) {
    constexpr double kPeriods = 4.0, kShare = 0.5;
    const std::vector<Rest> whole = wholeRuns(data, left);
    if (whole.empty())
        return {};
    const Explained without = asNoise(whole);
    Explained with = without;
    Swing swing;
    std::vector<Rest> still;
    for (int round = 0; round < 2; ++round) { // the second with the noise that the first leaves
        swing = largestSwing(data, whole, with.noise, kPeriods);
        if (swing.period <= 0.0 || !alikeInAll(swing, whole))
            return {};
        still = whole;
        takeOut(swing, still);
        with = asNoise(still);
    }
    const bool most = squaresOf(still) <= (1.0 - kShare) * squaresOf(whole);
    return most && with.logLikelihood >= without.logLikelihood + priceOfSwing(data) ? swing : Swing{};
}

} // namespace supercircle::diagnosis
