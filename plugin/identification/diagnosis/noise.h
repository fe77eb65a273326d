#pragma once
// Sensor noise, estimated from dwell intervals and from differences of neighbouring rows, never from the residual
// (decision 0070).
//
// Model: white noise plus AR(1). The white and correlated standard deviations maximise the restricted likelihood of the
// dwell intervals (mean, slope and logarithm of time removed) and of second differences, with two priors: the stated
// total is right within 20 %, and the ratio of the parts is near 0.55. Quantisation bounds the noise from below. A
// stated noise that the data contradict is dropped; the source says so.
// Scatter between repeats and periodic disturbances are estimated apart (decision 0071).
//
// Source: restricted likelihood: D. A. Harville, J. Am. Stat. Assoc. 72 (1977) 320; robust scale: P. J. Huber, E. M.
// Ronchetti, "Robust Statistics", 2nd ed. (2009), 5.1.

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/recorded/periodic_disturbance.h"
#include "plugin/identification/diagnosis/stop.h"

#include <cstdint>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

struct Noise {
    double white = 0.0;            ///< N, standard deviation of the white part
    double correlated = 0.0;       ///< N, standard deviation of the AR(1) part
    double correlationTime = 0.25; ///< s, decay of the AR(1) part to 1/e
    double marker = 0.0;           ///< m, per coordinate
    std::string source;            ///< how it was estimated, in words
    double dwellSeconds = 0.0;     ///< s, total length of the dwell intervals
    double runToRun = 0.0;         ///< N, scatter of repeats beyond the sensor noise; 0: none significant
    double excessKurtosis = 0.0;   ///< of the white part; 0: not significant
    std::size_t repeats = 0;       ///< runs that repeat another one
    /// Periodic disturbance found in dwell intervals or whole runs, not part of the noise: amplitude, N, and period, s;
    /// 0: none.
    double disturbance = 0.0, disturbancePeriod = 0.0;
    bool disturbanceInResidual = false; ///< found in the baseline residual of whole runs; else in dwell intervals
    /// Posterior draws of the first three. Empty: known exactly.
    struct PosteriorDraw {
        double white = 0.0, correlated = 0.0, correlationTime = 0.0;
    };
    std::vector<PosteriorDraw> posterior{};
    std::vector<Noise> further{}; ///< of channels beside the first one, in their units
    [[nodiscard]] double total() const;
    /// White noise of the same size (ablation of the whitening).
    [[nodiscard]] Noise asWhite() const;
    /// Standard deviation of the mean over `span` seconds with sampling interval `dt`, N.
    [[nodiscard]] double stdOfMean(double span, double dt) const;
};

/// @param known a disturbance found in whole runs (disturbanceInResidual()), which is removed first
/// @param stop  its interrupt throws Stopped; the time limit does not count, since nothing works without the noise
Noise estimateNoise(const RecordedData& data, const PeriodicDisturbance& known = {},
                    const StopToken& stop = StopToken());

/// 97.5 % posterior quantile of the mean squared whitened noise, relative to the most probable noise; 1 where the noise
/// is known exactly.
double noiseChiSquaredBound(const RecordedData& data, const Noise& noise, std::uint64_t seed);

} // namespace supercircle::diagnosis
