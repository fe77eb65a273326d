#pragma once
// Nominal parameters and effects fitted inside their bounds, by Levenberg-Marquardt steps that never leave the box.
//
// Derivatives come from the coarse simulation, residuals from the fine one: what discretisation does to the curve
// cancels in a difference. (Those at the nominal fit's end come from the fine one: on them rests what stands out, and
// they are a few hundredths of a case's simulations.) Between refreshes the Jacobian learns from accepted steps
// (Broyden's rank-one update), so a fit costs little more than its fine simulations.
//
// Sources: J. J. More, "The Levenberg-Marquardt algorithm", LNM 630 (1978); C. G. Broyden, Math. Comp. 19 (1965) 577.

#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/misfit.h"

#include <Eigen/Core>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// The numbers a fit varies, as x = (inner value - origin) / step: nominal parameters first, then those of each term.
class Variables {
public:
    Variables(const Model& model, const Point& like);
    [[nodiscard]] Eigen::Index size() const { return lower.size(); }
    [[nodiscard]] Eigen::VectorXd of(const Point& point) const;
    [[nodiscard]] Point at(const Eigen::VectorXd& x) const;
    [[nodiscard]] const Scalar& scalar(Eigen::Index i) const { return scalars_[static_cast<std::size_t>(i)]; }
    Eigen::VectorXd lower, upper; ///< of x
    /// Roughness and size of learned laws: x' penalty x is added to the misfit; zero elsewhere.
    Eigen::MatrixXd penalty;
    Eigen::Index nominal = 0; ///< how many of them are nominal

private:
    std::vector<Scalar> scalars_;
    Point like_;
};

/// Penalty matrix of n coefficients of a learned law, in units of their steps.
Eigen::MatrixXd roughness(Eigen::Index n, double smoothing);

struct Fitted {
    std::string failure; ///< empty unless the start cannot be simulated
    Point point;
    Eigen::VectorXd x;
    Eigen::VectorXd residual; ///< whitened, of the fine simulation
    Eigen::MatrixXd jacobian; ///< d(whitened simulation)/dx
    std::vector<Response> responses;
    double misfit = 0.0; ///< |residual|^2
    double cost = 0.0;   ///< the same with the penalty
    int iterations = 0;  ///< steps that were taken
    bool atEdge = false; ///< of its branch, and held there (nominal fits): the derivatives promise more beyond it
};

struct FitSettings {
    int iterations = 20;     ///< steps that are taken, at most
    double enough = 0.3;     ///< a smaller gain of misfit ends it
    double difference = 0.2; ///< of x, for derivatives
    int refreshes = 2;       ///< of the derivatives by the effect's numbers (by the nominal ones where they are alone)
    int rests = 1;           ///< of those by the nominal numbers beside an effect
    /// Misfit of a rival: a search that is above three times this after five iterations and creeps is given up.
    double rival = 0.0;
    bool grow = true; ///< free runs from their beginnings on (grow.h)
};

/// Simulates at f.x and fills in all but Jacobian and history; false if that cannot be compared with the recordings.
bool evaluate(Evaluator& evaluator, const Misfit& misfit, const Variables& variables, Fitted& f);

/// Broyden's update. @param change of the simulation, whitened, by the step
void learnFrom(Eigen::MatrixXd& jacobian, const Eigen::VectorXd& step, const Eigen::VectorXd& change);

/// d(whitened simulation)/dx by central differences (one-sided at bounds), wider ones by a nominal number that hardly
/// shows; to one side where the other cannot be simulated, zero where neither can. `only`: which columns; the others
/// are left as in `into`. Where a stated number a little to one side has the specimen on another branch, its column is
/// that of the other side alone; whether there is such a number is what comes back.
bool differentiate(Evaluator& evaluator, const Misfit& misfit, const Variables& variables, const Eigen::VectorXd& x,
                   double difference, const std::vector<Eigen::Index>& only, Eigen::MatrixXd& into,
                   Fineness fineness = Fineness::Coarse);

/// The same where readings jump: of the two one-sided differences the one nearer to zero, reading by reading. A snap
/// that comes one reading later on one side of x says nothing of its neighbourhood, but in a central difference it
/// outweighs all other rows together (it made intervals of a fit three times too narrow).
Eigen::MatrixXd differentiateCarefully(Evaluator& evaluator, const Misfit& misfit, const Variables& variables,
                                       const Eigen::VectorXd& x, double difference);

/// The same along a path through x, from `down` to `up`, by its coordinate `by`.
Eigen::VectorXd slopeAlong(Evaluator& evaluator, const Misfit& misfit, const Variables& variables,
                           const Eigen::VectorXd& x, const Eigen::VectorXd& up, const Eigen::VectorXd& down,
                           Eigen::Index by);

/// @param known derivatives by the first parameters (nominal ones, the first effect's), taken before; empty:
/// take them
Fitted fit(Evaluator& evaluator, const Misfit& misfit, const Point& start, const FitSettings& settings = {},
           const Eigen::MatrixXd& known = {});

/// Covariance of x behind a fit: linearised, uniform priors by their variance, the misfit's dispersion (its mean square
/// per row, if that is above 1) counted. A normal distribution cut off at the bounds and drawn from was tried instead:
/// where the simulation's own error pushes a fit into a corner of its box, the corner becomes certain (a gain of 0.42
/// to 0.43 for 0.5, beside 0.37 to 0.48).
Eigen::MatrixXd posteriorOf(const Variables& variables, const Eigen::MatrixXd& jacobian, double dispersion);

/// Mean square of a fit's whitened residual.
double misfitPerRow(const Misfit& misfit, const Fitted& fitted);

/// Columns of a fit's Jacobian whose numbers no bound holds.
Eigen::MatrixXd freeColumns(const Model& model, const Fitted& fitted);

/// Amplitudes of effects that lie at the far end of what is plausible while the runs want them beyond it, by a score
/// test: what the misfit would gain, free numbers following, exceeds three deviations. A law that has to be stretched
/// that far imitates something else. Places in `fitted.x`; none of a learned law, whose bounds are numerical.
std::vector<Eigen::Index> pressedAmplitudes(const Model& model, const Fitted& fitted, double dispersion);

} // namespace supercircle::diagnosis
