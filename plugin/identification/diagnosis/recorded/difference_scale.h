#pragma once
// Noise scale from differences of neighbouring readings. Curvature of the signal contributes little to second
// differences and almost nothing to fourth ones.

#include "plugin/identification/diagnosis/data.h"

#include <cstdint>
#include <vector>

namespace supercircle::diagnosis {

/// Of a normal distribution: standard deviation over median absolute deviation.
inline constexpr double kMadToSigma = 1.482602218505602;

enum class DifferenceOrder : std::uint8_t { Second, Fourth };

/// Standard deviation of differences away from snaps, with their number.
struct DifferenceScale {
    double scale = 0.0;
    double count = 0.0;
    double fourth = 0.0; ///< sum of fourth powers in units of the scale
    double dt = 0.0;     ///< s
};

/// Difference scale of each run with enough rows.
std::vector<DifferenceScale> differenceScaleOf(const RecordedData& data,
                                               DifferenceOrder order = DifferenceOrder::Second);
/// Difference scale of all runs together, where no single run has enough rows.
DifferenceScale pooledDifferenceScale(const RecordedData& data);
/// Excess kurtosis of white noise from that of its differences, which is half as large, of fourth ones 0.37 times. 0
/// within three standard errors; at most that of Student's t with 5 degrees, because kinks and small snaps look
/// heavy-tailed.
double excessKurtosisOf(const std::vector<DifferenceScale>& scales, DifferenceOrder order = DifferenceOrder::Second);
/// Log likelihood of the scale for white plus AR(1) noise, N, N, s.
double differenceScaleLogLikelihood(const DifferenceScale& r, double white, double correlated, double correlationTime);

/// Absolute second differences of rows [from, from + n).
std::vector<double> secondDifferences(const Eigen::VectorXd& v, Eigen::Index from, Eigen::Index n);
/// Appends absolute fourth differences. A motion sampled ten times a radian leaves 1e-4 of its amplitude.
void addFourthDifferences(const Eigen::Ref<const Eigen::VectorXd>& v, std::vector<double>& to);
/// Standard deviation of white noise by the median of its absolute fourth differences.
double whiteStdOf(std::vector<double> fourthDifferences);
/// The same by their mean square away from snaps, which counts heavy tails in full; 0: no run has enough rows.
double whiteStdOf(const std::vector<DifferenceScale>& fourthDifferences);

/// Smallest gap between distinct readings, beyond round-off; infinite: all are equal.
double smallestGap(const Eigen::Ref<const Eigen::VectorXd>& v);
/// Quantisation step, infinite: none. Quantised readings repeat and differ by multiples of the step.
double quantisationStep(const Eigen::Ref<const Eigen::VectorXd>& v);
/// Standard deviation of quantisation, a lower bound of the noise. 0: no step.
double quantisationNoise(double step);
/// @param size how the step is found: quantisationStep, or smallestGap as a last resort
double quantisationForceNoise(const RecordedData& data, double (*size)(const Eigen::Ref<const Eigen::VectorXd>&));

} // namespace supercircle::diagnosis
