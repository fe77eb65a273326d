#pragma once
// Cross-validated predictive log density.
//
// Each fold is left out in turn, the hypothesis is fitted to the other rows (linearised, simulated, one correction),
// and the fold is predicted. The covariance of its whitened error is 1 + J C J', C = (J_t' J_t + P)^-1 from the
// training rows and the priors P. Folds are runs with their repeats, else cycles, else fifths of the time. If
// derivatives and Laplace's method about the fit to all rows differ by more than six in chi-squared, the latter counts
// (decision 0079).
// A parameter that one fold alone identifies cannot be predicted for it; PredictiveScore::identifiedOnlyBy says so.
//
// Sources: A. Vehtari, A. Gelman, J. Gabry, Stat. Comput. 27 (2017) 1413; A. Vehtari, J. Lampinen, Neural Comput. 14
// (2002) 2439.

#include "plugin/identification/diagnosis/fit.h"

#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// Folds and blocks, per row of the stacked readings.
struct Grouping {
    std::vector<int> fold;  ///< left out together; -1: does not count
    std::vector<int> block; ///< a stroke of a run: unit of the bootstrap
    int folds = 0, blocks = 0;
    std::vector<std::string> names; ///< of folds: runs, "run_4.csv and 2 repeats", "cycle 2", "fifth 3"
    bool forward = false;           ///< folds follow each other in time (forward_validation.h)
};
/// Free runs are left out forward in time.
Grouping groupingOf(const Likelihood& likelihood);

struct PredictiveScore {
    std::string failure;
    Eigen::VectorXd energy;            ///< per block: |standardised error|^2
    Eigen::VectorXd volume;            ///< per block: share of the log determinant
    Eigen::VectorXd rows;              ///< per block
    Eigen::VectorXd error;             ///< whitened, per stacked row
    double forceRmse = 0.0;            ///< N
    std::vector<int> identifiedOnlyBy; ///< per parameter: the fold without which it is unknown, -1: none
    int folds = 0;                     ///< number of forecasts
    int substituted = 0;               ///< of these, where the fit to all rows stands in for the forecast
    int nonlinear = 0; ///< of those forward in time, where forecast and fit to all rows differ by more than linear
                       ///< forecasts do
    /// Log density per block, tempered by the dispersion.
    [[nodiscard]] Eigen::VectorXd score(double dispersion) const { return -0.5 * (energy / dispersion + volume); }
};

/// Precision of the prior of x: uniform distributions by their variance, and the penalty of learned laws.
Eigen::MatrixXd priorPrecision(const Variables& variables);
/// Replaces e by (1 + A A')^(-1/2) e and returns log det(1 + A A').
double standardise(const Eigen::MatrixXd& A, Eigen::VectorXd& e);
/// Adds the held-out rows of a fold to a score. @param held 1 for these rows, else 0 @param e their standardised error
/// @param volume log determinant of its covariance, a row
void addHeldOut(const Grouping& grouping, const Eigen::VectorXd& held, const Eigen::VectorXd& e,
                const Eigen::VectorXd& maskPenalty, double volume, PredictiveScore& score);

PredictiveScore crossValidate(Evaluator& evaluator, const Likelihood& likelihood, const Grouping& grouping,
                              const FitResult& fitted);
/// The same for rows that the fit has used: not suited for ranking.
PredictiveScore inSampleScore(const Likelihood& likelihood, const Grouping& grouping, const FitResult& fitted);

/// Root mean square of recorded minus simulated force over rows that count, N, with the best zero of each run removed.
double forceRmse(const Likelihood& likelihood, const std::vector<Response>& simulated,
                 const Grouping* grouping = nullptr, int fold = -1, double* chiSquared = nullptr,
                 double* count = nullptr);

} // namespace supercircle::diagnosis
