#pragma once
// What of a hidden effect is left for anybody to find: its signature in the readings after the nominal parameters have
// done what they can inside their intervals.

#include "tests/blind_benchmark/conceal/cases.h"

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::oracle {

/// Clean readings of all runs.
struct Clean {
    std::string failure;
    std::vector<std::vector<double>> force;              ///< N, zero taken out as the sensor does
    std::vector<std::vector<std::vector<Vec2>>> markers; ///< per run, marker, time
    double largestChange = 0.0;                          ///< of curvature, 1/m
};
Clean simulate(const Description& d, const Setup& truth, const Resolution& resolution);
/// Two rods meet anywhere: their systems are expensive, and a design needs no more than a tenth.
Resolution coarse(std::size_t rods);

/// Which readings of a run's force a fit should not follow, s: those within one and a half of where the drive turns
/// round, starts or stops, which no machine does in no time, and beside a jump of the force from 0.1 s before to 0.3 s
/// behind, where clocks and dying swings decide. Three readings at turning points were all there was of a sensor that
/// is 3.4 ms late.
/// @param force of its readings, in deviations of their noise
std::vector<std::pair<double, double>> besideJumps(const RunPlan& run, const Eigen::Ref<const Eigen::VectorXd>& force);

struct Window {
    std::string run;
    double from = 0.0, to = 0.0;   ///< s
    std::string channel = "force"; ///< or a marker's coordinate, such as m0_x
};

/// What is left of an effect, all runs behind each other (force, then markers).
struct Left {
    /// What a fit without the effect cannot follow, its parameters anywhere inside their intervals, in deviations of
    /// one reading. Readings beside a jump, which no fit should follow, pull it like a few others at most.
    Eigen::VectorXd readings;
    /// Norm of the signature behind the true noise, the parameters' intervals as normal priors: what the best possible
    /// test for this very effect has for a signal, in deviations of its statistic under noise. A slow effect in a
    /// thousand readings is far less than their number suggests where the noise remembers. Readings beside a jump of
    /// the force are left out (Absorber::apartFromJumps).
    double detectable = 0.0;
};

/// Derivatives by the nominal parameters around a truth without effect, and what each run has of its own (zero, clock).
class Absorber {
public:
    Absorber(const Description& d, const Offsets& offsets, const Nuisance& noise);
    [[nodiscard]] const std::string& failure() const { return failure_; }
    [[nodiscard]] std::optional<Left> left(const Effects& effects) const;
    /// How well readings of two resolutions could be told apart: Left::detectable of their difference.
    [[nodiscard]] double apart(const Clean& a, const Clean& b) const { return detectable(stack(a), stack(b)); }
    /// Where the readings of a signature stand out of the noise, the force of a run first, then its markers.
    [[nodiscard]] std::vector<Window> windows(const Eigen::VectorXd& left) const;

private:
    [[nodiscard]] Eigen::VectorXd stack(const Clean& c) const;
    [[nodiscard]] Eigen::VectorXd whitened(Eigen::VectorXd stack) const;
    [[nodiscard]] double detectable(const Eigen::VectorXd& with, const Eigen::VectorXd& without) const;
    /// 1 for readings that count, 0 for those besideJumps().
    [[nodiscard]] Eigen::VectorXd apartFromJumps(const Eigen::VectorXd& stack) const;
    [[nodiscard]] Eigen::VectorXd beyondNominal(const Eigen::VectorXd& signature) const;
    void addOwn();

    const Description& d_;
    Offsets offsets_;
    Nuisance noise_;
    std::string failure_;
    Eigen::VectorXd base_;
    Eigen::MatrixXd columns_;         ///< of what a fit may move, in prior deviations
    Eigen::MatrixXd whitenedColumns_; ///< the same behind the noise
};

} // namespace supercircle::oracle
