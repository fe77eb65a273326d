#pragma once
// Laws learned where no catalogue effect fits: penalised cubic B-splines of a state (P. H. C. Eilers, B. D. Marx, Stat.
// Sci. 11 (1996) 89; S. N. Wood, M. Fasiolo, Biometrics 73 (2017) 1071). Only the sensor may depend on time alone.
//
// | learned response | state | slot |
// | bending stiffness dM/d kappa | curvature change | material |
// | friction coefficient | sliding speed (logarithm) | contact |
// | friction coefficient | sliding distance | contact |
// | attraction of surfaces | gap | contact |
// | force of the testing machine, both directions equal | displacement | readings |
// | force of the testing machine against its motion | displacement | readings |
// | zero of the load cell | time | readings |

#include "plugin/identification/diagnosis/model/candidate_effects.h"

namespace supercircle::diagnosis {

/// Appends the learned laws that can act in an experiment after the catalogue's candidates.
void addLearnedLaws(CandidateEffects& candidateEffects, const experiment::Experiment& experiment,
                    const ExperimentScales& scales);

} // namespace supercircle::diagnosis
