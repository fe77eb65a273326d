#include "plugin/diagnosis/rests.h"

#include "plugin/diagnosis/whitening.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

Eigen::MatrixXd whitened(const Whitening& w, const Eigen::MatrixXd& columns) {
    Eigen::MatrixXd out(columns.rows(), columns.cols());
    for (Index c = 0; c < out.cols(); ++c)
        out.col(c) = w.apply(columns.col(c));
    return out;
}

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

    Plain(const Rest& r, double white, double coloured, double memory)
        : rest(&r), whitening(r.time, white, coloured, memory) {
        const Eigen::MatrixXd x = whitened(whitening, relaxations(r));
        basis = Eigen::HouseholderQR<Eigen::MatrixXd>(x).householderQ() * Eigen::MatrixXd::Identity(x.rows(), x.cols());
        force = free(r.force);
    }
    [[nodiscard]] Eigen::VectorXd free(const Eigen::VectorXd& raw) const {
        Eigen::VectorXd u = whitening.apply(raw);
        u -= basis * (basis.transpose() * u);
        return u;
    }
};

} // namespace

std::vector<Rest> restsOf(const Data& data) {
    std::vector<Rest> found;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        const RecordedRun& run = data.runs[r];
        for (std::size_t l = 0; l < run.legs.size(); ++l) {
            if (run.legs[l].phase != Phase::Hold)
                continue;
            std::vector<double> t, f;
            const bool first = l == 0;
            // A rest that follows a motion begins with whatever rings on.
            const double from = run.legs[l].from + (first ? 0.0 : 0.1);
            for (Index k = 0; k < run.time.size(); ++k)
                if (run.time[k] >= from && run.time[k] <= run.legs[l].to - 1e-9 && std::isfinite(run.force[k])) {
                    t.push_back(run.time[k]);
                    f.push_back(run.force[k]);
                }
            if (t.size() < 12)
                continue;
            Rest rest;
            rest.run = r;
            const auto n = static_cast<Index>(t.size());
            rest.time = Eigen::Map<Eigen::VectorXd>(t.data(), n);
            rest.force = Eigen::Map<Eigen::VectorXd>(f.data(), n);
            rest.trends.resize(n, first ? 1 : 3);
            rest.trends.col(0).setOnes();
            if (!first) {
                rest.trends.col(1) = (rest.time.array() - t.front()) / (t.back() - t.front());
                rest.trends.col(2) = (1.0 + (rest.time.array() - run.legs[l].from) / 0.3).log();
            }
            found.push_back(std::move(rest));
        }
    }
    return found;
}

double restrictedLogLikelihood(const Rest& rest, double white, double coloured, double memory) {
    const Whitening w(rest.time, white, coloured, memory);
    const Eigen::VectorXd u = w.apply(rest.force);
    const Eigen::MatrixXd x = whitened(w, rest.trends);
    const Eigen::LLT<Eigen::MatrixXd> gram(x.transpose() * x);
    const Eigen::VectorXd xu = x.transpose() * u;
    const double left = u.squaredNorm() - xu.dot(gram.solve(xu));
    const double logGram = 2.0 * gram.matrixLLT().diagonal().array().log().sum();
    return -0.5 * (left + w.logDeterminant() + logGram);
}

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

Swing largestSwing(const Data& data, const std::vector<Rest>& rests, double white, double coloured, double memory) {
    std::vector<Plain> plain;
    double span = 0.0, longest = 0.0, dt = 0.0; // s
    std::vector<double> resting(data.runs.size(), 0.0);
    for (const Rest& r : rests) {
        plain.emplace_back(r, white, coloured, memory);
        resting[r.run] += r.time[r.time.size() - 1] - r.time[0];
        longest = std::max(longest, resting[r.run]);
        const RecordedRun& run = data.runs[r.run];
        span = std::max(span, run.time[run.time.size() - 1] - run.time[0]);
        dt = std::max(dt, run.spacing());
    }
    Swing best;
    if (longest <= 0.0)
        return best;
    constexpr double kPeriods = 2.0, kRows = 5.0, kOversampling = 4.0;
    constexpr int kMost = 1500; // frequencies
    double f = kPeriods / longest;
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

} // namespace supercircle::diagnosis
