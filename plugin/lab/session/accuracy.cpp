#include "plugin/lab/session/accuracy.h"

#include "plugin/lab/session/session.h"

#include <cmath>

namespace supercircle::lab {

/// After setStepLimits(). With a fixed step no limit changes; a longest step that the scene gives stays.
void Session::setAccuracy(double speed) {
    const AccuracyLevel level = levelOf(accuracy_);
    step::Settings& s = shells_.stepper().settings();
    if (s.fixedDt > 0.0)
        return;
    s.motionLimit = level.motion * motionLimit_;
    s.localError = level.error * localError_;
    s.relinearise = level.relinearise;
    s.cull = s.giveUpEarly = level.cull;
    sampleTravel_ = 0.0;
    if (level.longestStep == 1.0 || speed == 0.0 || scene_.numerics.dt_max > 0.0)
        return;
    sampleTravel_ = std::abs(speed) * s.dtMax; // addRowsBetween() keeps the rows of exact within a longer step
    s.dtMax *= level.longestStep;
    frame_ = s.dtMax;
}

} // namespace supercircle::lab
