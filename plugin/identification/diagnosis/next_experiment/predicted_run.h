#pragma once
// Prediction of a candidate run by competing hypotheses: readings, and their derivatives by all uncertain parameters.
//
// A series of runs needs of each run only the products of these derivatives with each other and with the differences
// between hypotheses (PredictedRun::products()), which add up. So any two kinds of runs with repeats are compared
// without further simulations.

#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/next_experiment/run_likelihood.h"
#include "plugin/identification/diagnosis/noise.h"

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

/// A competing hypothesis, as fitted.
struct CompetingHypothesis {
    std::string label;
    ParameterPoint point;
    Eigen::VectorXd x;
    Eigen::MatrixXd covariance; ///< posteriorOf()
    double weight = 1.0;        ///< probability weight; unused for the baseline
    bool mirrorImage = false;   ///< the mirror image of another hypothesis
};

/// Uncertain parameters of all hypotheses in one list: the nominal ones (common, varied in the first), then those of
/// each hypothesis.
class UncertainParameters {
public:
    UncertainParameters(const Model& model, const std::vector<CompetingHypothesis>& competing);

    struct Item {
        std::size_t hypothesis = 0;
        Eigen::Index index = 0; ///< index in the hypothesis' x
        int run = -1;           ///< recorded run that states it for itself (Scalar::run)
        double deviation = 0.0; ///< of such a parameter in a further run, before it is made; of x
    };
    [[nodiscard]] const std::vector<Item>& items() const { return items_; }
    [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(items_.size()); }
    /// Square root of a hypothesis' covariance: one column per unit deviation of x. Zero for what runs state for
    /// themselves: each further run is released anew (PredictedRun::withoutOwn()).
    [[nodiscard]] const Eigen::MatrixXd& factor(std::size_t competitor) const { return factor_[competitor]; }
    /// The same in the order of entries().
    [[nodiscard]] const Eigen::MatrixXd& factorByItem(std::size_t competitor) const {
        return factorByItem_[competitor];
    }

private:
    std::vector<Item> items_;
    std::vector<Eigen::MatrixXd> factor_, factorByItem_;
};

class PredictedRun {
public:
    /// All arguments must outlive it.
    PredictedRun(Evaluator& evaluator, std::size_t index, const CandidateRun& candidateRun, const Noise& noise,
                 double zeroWindow, const std::vector<CompetingHypothesis>& competing,
                 const UncertainParameters& uncertain)
        : evaluator_(evaluator), index_(index), candidateRun_(candidateRun), noise_(noise), zeroWindow_(zeroWindow),
          competing_(competing), uncertain_(uncertain) {}

    /// False if it cannot be simulated.
    [[nodiscard]] bool simulate();
    /// Computes derivatives with respect to all uncertain parameters, once. Before, parameters count as known.
    void differentiate();
    /// Simulates at other points.
    [[nodiscard]] std::vector<CandidateRunResponse> at(const std::vector<ParameterPoint>& points) const {
        return evaluator_.predict(index_, points);
    }

    /// Likelihood of the run if one hypothesis is true, for one of so many repeats.
    [[nodiscard]] std::unique_ptr<RunLikelihood> likelihoodOf(std::size_t truth, std::size_t repeats) const;
    /// Standardised difference between the true hypothesis and a response, all repeats together. Empty: not comparable.
    [[nodiscard]] Eigen::VectorXd difference(const RunLikelihood& likelihood, std::size_t repeats, std::size_t truth,
                                             const CandidateRunResponse& alternative) const;
    [[nodiscard]] Eigen::VectorXd difference(const RunLikelihood& likelihood, std::size_t repeats, std::size_t truth,
                                             std::size_t alternative) const {
        return difference(likelihood, repeats, truth, responses_[alternative]);
    }
    /// Derivatives, one column per uncertain parameter; zero where the simulation fails. No rows: no parameter is
    /// uncertain.
    [[nodiscard]] Eigen::MatrixXd derivatives(const RunLikelihood& likelihood, std::size_t repeats) const;
    /// With one hypothesis true: [derivatives, differences to each hypothesis]' [the same]. Hypotheses that are not
    /// comparable have zero difference.
    const Eigen::MatrixXd& gram(std::size_t truth, std::size_t repeats);

    [[nodiscard]] const CandidateRun& candidateRun() const { return candidateRun_; }

private:
    /// The run with one uncertain parameter varied.
    struct Varied {
        double step = 0.0; ///< of x
        CandidateRunResponse response;
    };
    [[nodiscard]] bool usable(const CandidateRunResponse& r) const;
    /// Whitened change of the readings by a varied parameter. Empty: not comparable.
    [[nodiscard]] std::optional<Eigen::VectorXd> changeBy(const RunLikelihood& likelihood, std::size_t item) const;
    /// Whitened readings in the columns, without what this run's own parameters may change: each repeat has its own.
    [[nodiscard]] Eigen::MatrixXd withoutOwn(const RunLikelihood& likelihood, const Eigen::MatrixXd& readings) const;

    Evaluator& evaluator_;
    std::size_t index_;
    const CandidateRun& candidateRun_;
    const Noise& noise_;
    double zeroWindow_;
    const std::vector<CompetingHypothesis>& competing_;
    const UncertainParameters& uncertain_;
    std::vector<CandidateRunResponse> responses_; ///< of each hypothesis
    std::vector<Varied> varied_;                  ///< in the order of uncertain_.entries()
    std::map<std::pair<std::size_t, std::size_t>, Eigen::MatrixXd> gram_;
};

} // namespace supercircle::diagnosis
