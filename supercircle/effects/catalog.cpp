#include "supercircle/effects/entries.h"

namespace supercircle::effects {

const std::vector<Effect>& catalog() {
    static const std::vector<Effect> kAll = {viscoelasticBending(),
                                             nonlinearElasticity(),
                                             plasticity(),
                                             localDamage(),
                                             naturalCurvatureDefect(),
                                             stiffnessGradient(),
                                             softeningOverTime(),
                                             planarDrag(),
                                             gravity(),
                                             staticFrictionExcess(),
                                             rateDependentFriction(),
                                             wear(),
                                             adhesion(),
                                             contactCompliance(),
                                             machineCompliance(),
                                             backlash(),
                                             misalignment(),
                                             sensorDrift(),
                                             sensorGain(),
                                             sensorDelay()};
    return kAll;
}

} // namespace supercircle::effects
