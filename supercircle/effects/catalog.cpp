#include "supercircle/effects/entries/entries.h"

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
                                             sensorDelay(),
                                             bearingFriction(),
                                             airDrag(),
                                             guideFriction(),
                                             nonlinearSpring(),
                                             rateAndStateFriction(),
                                             supportSettlement(),
                                             clampCompliance()};
    return kAll;
}

} // namespace supercircle::effects
