#pragma once
// Whitening of correlated noise, in time proportional to the number of rows.
//
// Model of a reading's error: white noise + AR(1) of the sensor + AR(1) of the model, the latter with an amplitude in
// every row. A Kalman filter over the two AR(1) states gives the innovations. Divided by their standard deviations they
// equal L^-1 applied to the errors, L the Cholesky factor of the covariance. The map is linear and is applied to
// residuals and signatures alike.
//
// Source: J. Durbin, S. J. Koopman, "Time Series Analysis by State Space Methods", 2nd ed. (2012), 4.3 (prediction
// error decomposition) and 4.10 (missing observations).

#include <Eigen/Core>
#include <vector>

namespace supercircle::diagnosis {

class Whitening {
public:
    Whitening() = default;
    /// @param time of the rows, s, increasing
    /// @param white, correlated standard deviations, N
    /// @param correlationTime of the AR(1) noise, s (decay to 1/e)
    /// @param modelError standard deviation of the model error in each row, N; empty: none; infinite: the row is
    /// missing
    /// @param modelCorrelationTime of the model error, s
    Whitening(const Eigen::VectorXd& time, double white, double correlated, double correlationTime,
              const Eigen::VectorXd& modelError = {}, double modelCorrelationTime = 1.0);

    /// Standardised innovations of `raw`; 0 in missing rows.
    [[nodiscard]] Eigen::VectorXd apply(const Eigen::VectorXd& raw) const;
    /// The same of each column.
    [[nodiscard]] Eigen::MatrixXd columns(const Eigen::MatrixXd& raw) const;
    /// The transposed map: <apply(a), b> = <a, transposed(b)> for all a that are 0 in missing rows.
    [[nodiscard]] Eigen::VectorXd transposed(const Eigen::VectorXd& whitened) const;
    [[nodiscard]] double logDeterminant() const { return logDeterminant_; } ///< of the covariance of the rows present
    [[nodiscard]] Eigen::Index present() const { return present_; }

private:
    struct Row {
        double decayA = 0.0, decayB = 0.0; ///< from the row before
        double gainA = 0.0, gainB = 0.0;
        double amplitude = 0.0; ///< of the model error
        double sigma = 0.0;     ///< of the innovation; 0: missing
    };
    std::vector<Row> rows_;
    double logDeterminant_ = 0.0;
    Eigen::Index present_ = 0;
};

} // namespace supercircle::diagnosis
