#include "plugin/shells/quality.h"

namespace supercircle {

step::Settings settingsFor(Quality quality, int threads) {
    step::Settings s;
    s.threads = threads;
    if (quality == Quality::Laboratory)
        return s;
    s.dtMax = 1.0 / 30.0;
    s.localError = 1.0;
    s.motionLimit = 10.0;
    s.relinearise = 0.01;
    s.maxIterations = 3;
    s.contact.tolerance = 1e-6;
    s.witness = true;
    s.frameSolves = 40;
    return s;
}

} // namespace supercircle
