#pragma once
// The named accuracies (decision 0198): how much coarser than `exact` the segments of a protocol are stepped. Dropping,
// settling and the approach are the same in all of them, so that a pile does not depend on the accuracy.

#include "plugin/scene/loader/scene.h"

namespace supercircle::lab {

struct AccuracyLevel {
    double longestStep; ///< over that of exact, which is one sample
    double motion;      ///< step::Settings::motionLimit, over that of exact
    double error;       ///< step::Settings::localError, over that of exact
    double relinearise; ///< step::Settings::relinearise, in thicknesses of the thinnest shell
    bool cull;          ///< leave out contacts that cannot meet in a step, and give hard problems up early
};

constexpr AccuracyLevel levelOf(scene::Accuracy accuracy) {
    switch (accuracy) {
    case scene::Accuracy::Standard:
        return {4.0, 2.0, 2.0, 0.003, true};
    case scene::Accuracy::Fast:
        return {8.0, 3.0, 2.0, 0.005, true};
    case scene::Accuracy::Exact:
        break;
    }
    return {1.0, 1.0, 1.0, 0.001, false};
}

} // namespace supercircle::lab
