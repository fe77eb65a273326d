#pragma once
// Stacks of shells at random cannot be compared curve by curve, only by the statistics of many: heights, largest
// compression, dissipated share, force drops. An ensemble of recordings is compared with simulated ensembles, one
// without and one each with an effect, and what shifts them is named.
//
// Shift of each quantity against the nominal ensemble: Welch's t, p-values by permutation of the pooled stacks with the
// largest statistic over the quantities (P. H. Westfall, S. S. Young (1993)). Weights: each recorded stack is a block
// of weigh.h; its score is the predictive density of a normal population whose mean and covariance are those of the
// simulated ensemble, the covariance pooled over all ensembles and widened by (1 + 1/n) for the mean's own scatter.

#include "plugin/identification/diagnosis/result.h"

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// Stacks in rows, quantities in columns.
struct Ensemble {
    std::string label;
    Eigen::MatrixXd values;
};

struct EnsembleShift {
    std::string quantity;
    double recorded = 0.0, simulated = 0.0; ///< means
    double z = 0.0;                         ///< Welch's t
    double p = 1.0;                         ///< family-wise
};

struct EnsembleDiagnosis {
    std::string failure; ///< why nothing can be said
    std::string verdict, statement;
    std::vector<EnsembleShift> shifts;
    std::vector<FoundEffect> effects; ///< most probable first
    double nothing = 0.0, unknown = 0.0, p = 1.0;
};

/// @param effects one ensemble each, labels of effects
EnsembleDiagnosis diagnoseEnsembles(const std::vector<std::string>& quantities, const Ensemble& recorded,
                                    const Ensemble& nominal, const std::vector<Ensemble>& effects, std::uint64_t seed);

} // namespace supercircle::diagnosis
