#pragma once
// Fit of nominal parameters and effects inside their bounds, by Levenberg-Marquardt steps with active bounds.
//
// Derivatives come from coarse simulations, residuals from fine ones: the discretisation error cancels in a difference.
// The final derivatives of the baseline fit are fine. Between refreshes Broyden's rank-one update adapts the Jacobian.
//
// Sources: J. J. More, "The Levenberg-Marquardt algorithm", LNM 630 (1978); C. G. Broyden, Math. Comp. 19 (1965) 577.

#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/likelihood.h"

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// The variables of a fit, x = (internal value - origin) / step: nominal parameters first, then those of each term.
class Variables {
public:
    Variables(const Model& model, const ParameterPoint& like);
    [[nodiscard]] Eigen::Index size() const { return lower.size(); }
    [[nodiscard]] Eigen::VectorXd of(const ParameterPoint& point) const;
    [[nodiscard]] ParameterPoint at(const Eigen::VectorXd& x) const;
    [[nodiscard]] const Scalar& scalar(Eigen::Index i) const { return scalars_[static_cast<std::size_t>(i)]; }
    Eigen::VectorXd lower, upper; ///< of x
    /// Penalty of learned laws and of deviations of specimens: x' penalty x is added to chi-squared; zero elsewhere.
    Eigen::MatrixXd penalty;
    Eigen::Index nominal = 0; ///< number of nominal parameters
    /// Inverse variance of the interval of a parameter, `widest` at most; 0 where a normal prior in the penalty says
    /// all.
    [[nodiscard]] double intervalPrecision(Eigen::Index i, double widest) const {
        const double width = std::min(upper[i] - lower[i], widest);
        return i < nominal && scalar(i).precision > 0.0 ? 0.0 : 12.0 / (width * width);
    }
    /// Inverse variances of normal priors of the nominal parameters, 0 of the others.
    [[nodiscard]] Eigen::VectorXd normalPrecision() const {
        Eigen::VectorXd out = Eigen::VectorXd::Zero(size());
        for (Eigen::Index i = 0; i < nominal; ++i)
            out[i] = scalar(i).precision;
        return out;
    }

private:
    std::vector<Scalar> scalars_;
    ParameterPoint like_;
};

/// Penalty matrix of n coefficients of a learned law, in units of their steps.
Eigen::MatrixXd smoothingPenalty(Eigen::Index n, double smoothing);

struct FitResult {
    std::string failure; ///< empty unless the start cannot be simulated
    ParameterPoint point;
    Eigen::VectorXd x;
    Eigen::VectorXd residual; ///< whitened, of the fine simulation
    Eigen::MatrixXd jacobian; ///< d(whitened simulation)/dx
    std::vector<Response> responses;
    double chiSquared = 0.0;   ///< |residual|^2 plus the penalties of masked rows and of deviations of specimens
    double cost = 0.0;         ///< chiSquared plus the penalty of learned laws
    int iterations = 0;        ///< steps that were taken
    bool atBranchEdge = false; ///< held at the edge of its solution branch (baseline fits)
};

struct FitSettings {
    int iterations = 60;         ///< maximum number of accepted steps
    double smallestGain = 0.3;   ///< a smaller predicted decrease of chi-squared ends the fit
    double differenceStep = 0.2; ///< difference step in x
    /// Refreshes of the effect's derivatives (of all without an effect), and of the nominal ones beside an effect, that
    /// are made whatever they bring. Further ones follow as long as the last lowered chi-squared by its dispersion.
    int refreshes = 2;
    int nominalRefreshes = 1;
    /// Chi-squared of a competing fit. A search above three times this after five iterations with little progress is
    /// stopped.
    double competitor = 0.0;
    bool progressive = true; ///< progressive fit of free runs (progressive_fit.h)
};

/// Simulates at f.x and sets all but Jacobian and iterations. False if the simulation cannot be compared with the
/// recordings.
[[nodiscard]] bool evaluate(Evaluator& evaluator, const Likelihood& likelihood, const Variables& variables,
                            FitResult& f);

/// Broyden's update.
/// @param change whitened change of the simulation by the step
void broydenUpdate(Eigen::MatrixXd& jacobian, const Eigen::VectorXd& step, const Eigen::VectorXd& change);

/// d(whitened simulation)/dx by central differences, one-sided at bounds, at branch edges and where one neighbour
/// fails; zero where both fail.
/// @param only the columns to compute; the others are left as in `into`
/// @return whether a stated parameter has another solution branch close by
bool differentiate(Evaluator& evaluator, const Likelihood& likelihood, const Variables& variables,
                   const Eigen::VectorXd& x, double difference, const std::vector<Eigen::Index>& only,
                   Eigen::MatrixXd& into, Fidelity fidelity = Fidelity::Coarse);

/// The same, using in each reading the smaller one-sided difference. A snap that moves by one reading would otherwise
/// dominate the column.
Eigen::MatrixXd differentiateRobustly(Evaluator& evaluator, const Likelihood& likelihood, const Variables& variables,
                                      const Eigen::VectorXd& x, double difference);

/// The same along a path through x from `down` to `up`, per unit of coordinate `by`.
Eigen::VectorXd slopeAlong(Evaluator& evaluator, const Likelihood& likelihood, const Variables& variables,
                           const Eigen::VectorXd& x, const Eigen::VectorXd& up, const Eigen::VectorXd& down,
                           Eigen::Index by);

/// @param known derivatives with respect to the first parameters (nominal ones, the first effect's); empty: compute
/// them
FitResult fit(Evaluator& evaluator, const Likelihood& likelihood, const ParameterPoint& start,
              const FitSettings& settings = {}, const Eigen::MatrixXd& known = {});

/// Linearised posterior covariance of x with uniform priors by their variance. The dispersion is the mean squared
/// residual, if above 1.
Eigen::MatrixXd posteriorCovariance(const Variables& variables, const Eigen::MatrixXd& jacobian, double dispersion);

/// Mean square of a fit's standardised residual.
double chiSquaredPerReading(const Likelihood& likelihood, const FitResult& fitted);

/// Columns of a fit's Jacobian whose parameters are not at a bound.
Eigen::MatrixXd freeColumns(const Model& model, const FitResult& fitted);

/// Indices in `fitted.x` of amplitudes at the far end of their plausible range which a score test of 3 sigma would move
/// beyond it. Such a law imitates another one (decision 0081). Learned laws are exempt, because their bounds are
/// numerical.
std::vector<Eigen::Index> amplitudesAtBound(const Model& model, const FitResult& fitted, double dispersion);

} // namespace supercircle::diagnosis
