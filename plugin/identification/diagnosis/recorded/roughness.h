#pragma once
// How much neighbouring readings do against each other, whatever a curve does: its bends leave little in second
// differences and next to nothing in fourth ones.

#include "plugin/identification/diagnosis/data.h"

#include <vector>

namespace supercircle::diagnosis {

/// Of a normal distribution: standard deviation over median absolute deviation.
inline constexpr double kMadToSigma = 1.482602218505602;

/// 0 of none.
double median(std::vector<double> v);

/// Standard deviation of second differences away from snaps, and their number.
struct Roughness {
    double scale = 0.0;
    double count = 0.0;
    double fourth = 0.0; ///< sum of fourth powers in units of the scale
    double dt = 0.0;     ///< s
};

/// Of each run that has rows enough for it.
std::vector<Roughness> roughnessOf(const Data& data);
/// Where no run by itself has rows enough, or most of its readings lie on a line: of the rows of all runs.
Roughness pooledRoughness(const Data& data);
/// Excess kurtosis of white noise from that of its second differences, which is half of it (1 + 16 + 1 over 6^2); 0
/// within three standard errors (correlated by -2/3 and 1/6, which makes their number count 1.4 times less). At most
/// that of Student's t with 5 degrees: kinks and small snaps look like more.
double tailsOf(const std::vector<Roughness>& rough);
/// Of a noise with a white and a coloured part, N, and a memory, s.
double roughnessLogLikelihood(const Roughness& r, double white, double coloured, double memory);

/// Absolute ones of rows [from, from + n).
std::vector<double> secondDifferences(const Eigen::VectorXd& v, Eigen::Index from, Eigen::Index n);
/// Absolute ones, in which a motion of ten rows and more a radian leaves a ten-thousandth of its amplitude.
void addFourthDifferences(const Eigen::Ref<const Eigen::VectorXd>& v, std::vector<double>& to);
/// Standard deviation of white noise by the median of its absolute fourth differences.
double whiteOf(std::vector<double> fourthDifferences);

/// Between neighbours among the distinct readings, beyond round-off; infinite: all are the same.
double smallestGap(const Eigen::Ref<const Eigen::VectorXd>& v);
/// The step in which readings come, infinite: none. Readings in steps are equal in many rows and multiples of the step
/// apart; few readings of a steep curve, or a curve that rests and then moves, are not.
double stepOf(const Eigen::Ref<const Eigen::VectorXd>& v);
/// Readings in steps are evenly distributed around the truth: no sensor is better. 0: nothing is told from them.
double leastNoise(double step);
/// @param size of a step: stepOf, or smallestGap where there is nothing else to go by
double leastForceNoise(const Data& data, double (*size)(const Eigen::Ref<const Eigen::VectorXd>&));

} // namespace supercircle::diagnosis
