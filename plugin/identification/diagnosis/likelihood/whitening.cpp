#include "plugin/identification/diagnosis/likelihood/whitening.h"

#include "supercircle/support/elementary.h"

#include <cmath>

namespace supercircle::diagnosis {

Whitening::Whitening(const Eigen::VectorXd& time, double white, double correlated, double correlationTime,
                     const Eigen::VectorXd& modelError, double modelCorrelationTime) {
    // Covariance of the two states (sensor a in N, model b with unit variance), predicted and then corrected.
    double aa = correlated * correlated, ab = 0.0, bb = modelError.size() > 0 ? 1.0 : 0.0;
    for (Eigen::Index k = 0; k < time.size(); ++k) {
        Row row;
        const double dt = k > 0 ? time[k] - time[k - 1] : 0.0;
        if (k > 0) {
            row.decayA = math::exp(-dt / correlationTime);
            row.decayB = math::exp(-dt / modelCorrelationTime);
            aa = row.decayA * row.decayA * aa + correlated * correlated * (1.0 - row.decayA * row.decayA);
            ab *= row.decayA * row.decayB;
            bb = modelError.size() > 0 ? 1.0 + row.decayB * row.decayB * (bb - 1.0) : 0.0;
        }
        const double e = modelError.size() > 0 ? modelError[k] : 0.0;
        if (std::isfinite(e)) {
            row.amplitude = e;
            const double va = aa + e * ab, vb = ab + e * bb; // covariance of the states with the reading
            const double variance = va + e * vb + white * white;
            row.gainA = va / variance;
            row.gainB = vb / variance;
            row.sigma = std::sqrt(variance);
            aa -= row.gainA * va;
            ab -= row.gainA * vb;
            bb -= row.gainB * vb;
            logDeterminant_ += math::log(variance);
            ++present_;
        }
        rows_.push_back(row);
    }
}

Eigen::VectorXd Whitening::apply(const Eigen::VectorXd& raw) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(raw.size());
    double a = 0.0, b = 0.0;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
        const Row& row = rows_[k];
        a *= row.decayA;
        b *= row.decayB;
        if (row.sigma == 0.0)
            continue;
        const double innovation = raw[static_cast<Eigen::Index>(k)] - a - row.amplitude * b;
        a += row.gainA * innovation;
        b += row.gainB * innovation;
        out[static_cast<Eigen::Index>(k)] = innovation / row.sigma;
    }
    return out;
}

Eigen::MatrixXd Whitening::columns(const Eigen::MatrixXd& raw) const {
    Eigen::MatrixXd out(raw.rows(), raw.cols());
    for (Eigen::Index c = 0; c < out.cols(); ++c)
        out.col(c) = apply(raw.col(c));
    return out;
}

Eigen::VectorXd Whitening::transposed(const Eigen::VectorXd& whitened) const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(whitened.size());
    double a = 0.0, b = 0.0; // derivative of the sum with respect to the states after a row
    for (std::size_t k = rows_.size(); k-- > 0;) {
        const Row& row = rows_[k];
        if (row.sigma != 0.0) {
            const double innovation =
                whitened[static_cast<Eigen::Index>(k)] / row.sigma + row.gainA * a + row.gainB * b;
            out[static_cast<Eigen::Index>(k)] = innovation;
            a -= innovation;
            b -= row.amplitude * innovation;
        }
        a *= row.decayA;
        b *= row.decayB;
    }
    return out;
}

} // namespace supercircle::diagnosis
