#pragma once
// Detectability of a hidden effect: its signature in the readings that nominal parameters inside their intervals do not
// explain.

#include "tests/blind_benchmark/synthetic_cases/cases.h"

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::blind_benchmark {

/// Readings of all runs without noise.
struct CleanReadings {
    std::string failure;
    std::vector<std::vector<double>> force;              ///< N, minus the mean of the first half second
    std::vector<std::vector<std::vector<Vec2>>> markers; ///< per run, marker, time
    double maxCurvatureChange = 0.0;                     ///< of curvature, 1/m
};
CleanReadings simulate(const Description& d, const Setup& truth, const Resolution& resolution);
/// Resolution for the sizing of effects. Systems of two rods are expensive, and a size is needed to a tenth only.
Resolution coarseResolution(std::size_t rods);
/// Resolution of the recordings, refined by an even factor or by a half.
Resolution finer(double factor);

/// Intervals whose readings a fit should not follow, s: within one and a half readings of where the drive turns, starts
/// or stops, and from 0.1 s before to 0.3 s behind a jump of the force. There clocks and decaying vibrations decide.
/// @param force of its readings, in noise standard deviations
std::vector<std::pair<double, double>> excludedIntervals(const RunPlan& run,
                                                         const Eigen::Ref<const Eigen::VectorXd>& force);

struct VisibleInterval {
    std::string run;
    double from = 0.0, to = 0.0;   ///< s
    std::string channel = "force"; ///< or a marker's coordinate, such as m0_x
};

/// Part of an effect's signature that nominal parameters do not explain. All runs behind each other: force, then
/// markers.
struct Unexplained {
    /// Difference from the best fit without the effect, parameters inside their intervals, in noise standard deviations
    /// of a reading. Readings beside a jump pull this fit with limited weight.
    Eigen::VectorXd readings;
    /// Norm of the whitened signature, with the parameters' intervals as normal priors: the signal of the best possible
    /// test for this very effect, in standard deviations of its statistic. Readings beside a jump are left out
    /// (decision 0090).
    double detectable = 0.0;
};

/// Linear model of the readings without effect: derivatives by the nominal parameters and by each run's zero and clock.
class BaselineModel {
public:
    BaselineModel(const Description& d, const Offsets& offsets, const SensorNoise& noise);
    [[nodiscard]] const std::string& failure() const { return failure_; }
    [[nodiscard]] std::optional<Unexplained> unexplained(const Effects& effects) const;
    /// Unexplained::detectable of the difference of two sets of readings.
    [[nodiscard]] double detectableDifference(const CleanReadings& a, const CleanReadings& b) const {
        return detectable(stack(a), stack(b));
    }
    /// Intervals in which a signature exceeds the noise: force of a run first, then its markers.
    [[nodiscard]] std::vector<VisibleInterval> visibleIntervals(const Eigen::VectorXd& signature) const;

private:
    [[nodiscard]] Eigen::VectorXd stack(const CleanReadings& c) const;
    [[nodiscard]] Eigen::VectorXd whitened(Eigen::VectorXd stack) const;
    [[nodiscard]] double detectable(const Eigen::VectorXd& with, const Eigen::VectorXd& without) const;
    /// 1 for readings that count, 0 for those in excludedIntervals().
    [[nodiscard]] Eigen::VectorXd includedReadings(const Eigen::VectorXd& stack) const;
    [[nodiscard]] Eigen::VectorXd beyondNominal(const Eigen::VectorXd& signature) const;
    void addRunNuisances();

    const Description& d_;
    Offsets offsets_;
    SensorNoise noise_;
    std::string failure_;
    Eigen::VectorXd base_;
    Eigen::MatrixXd columns_;         ///< per parameter, in standard deviations of its prior
    Eigen::MatrixXd whitenedColumns_; ///< the same, whitened
};

} // namespace supercircle::blind_benchmark
