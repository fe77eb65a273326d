#pragma once
// Comparison of recorded and simulated ensembles of random stacks by their statistics: heights, largest compression,
// dissipation ratio, force drops. Single curves of such stacks are not comparable.
//
// Shift of each quantity against the baseline ensemble: Welch's t, with p-values by permutation of the pooled stacks
// and the largest statistic over the quantities (P. H. Westfall, S. S. Young (1993)). Model weights: each recorded
// stack is one block of model_weights.h. Its score is the log density of a normal population with mean and covariance
// of the simulated ensemble. The covariance is pooled over all ensembles and widened by (1 + 1/n).

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
    std::string failure; ///< why there is no result; empty: there is one
    std::string verdict, statement;
    std::vector<EnsembleShift> shifts;
    std::vector<FittedEffect> effects; ///< most probable first
    double adequate = 0.0, outsideCatalogue = 0.0, p = 1.0;
};

/// @param effects one ensemble each, labels of effects
EnsembleDiagnosis diagnoseEnsembles(const std::vector<std::string>& quantities, const Ensemble& recorded,
                                    const Ensemble& nominal, const std::vector<Ensemble>& effects, std::uint64_t seed);

} // namespace supercircle::diagnosis
