#pragma once
// Noise that remembers, turned into noise that does not, in a time proportional to the number of rows.
//
// Model of a force reading's error: white + AR(1) of the sensor + error of the simulation, which is AR(1) with an
// amplitude of its own in every row (large where the curve is steep or the discretisation shows). A Kalman filter over
// the two remembering parts gives the innovations; divided by their standard deviations they are what L^-1 of the
// Cholesky factor of the covariance gives. The map is linear, so it is applied to residuals and signatures alike.
//
// Source: J. Durbin, S. J. Koopman, "Time Series Analysis by State Space Methods", 2nd ed. (2012), 4.3 (prediction
// error decomposition) and 4.10 (missing observations).

#include <Eigen/Core>
#include <vector>

namespace supercircle::diagnosis {

class Whitening {
public:
    Whitening() = default;
    /// @param time rows, s, increasing
    /// @param white, coloured standard deviations, N
    /// @param memory time in which the coloured noise falls to 1/e, s
    /// @param modelError standard deviation of the simulation's error in each row, N; empty: none. Rows with infinite
    ///        ones are missing.
    /// @param modelMemory its memory, s
    Whitening(const Eigen::VectorXd& time, double white, double coloured, double memory,
              const Eigen::VectorXd& modelError = {}, double modelMemory = 1.0);

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
        double deviation = 0.0; ///< of the innovation; 0: missing
    };
    std::vector<Row> rows_;
    double logDeterminant_ = 0.0;
    Eigen::Index present_ = 0;
};

} // namespace supercircle::diagnosis
