#include "plugin/shells/quality.h"

namespace supercircle {

step::Settings settingsFor(Quality quality, int threads) {
    step::Settings s;
    s.threads = threads;
    if (quality == Quality::Laboratory)
        return s;
    s.dtMax = 1.0 / 30.0;
    s.localError = 3.0;
    s.motionLimit = 20.0;
    s.relinearise = 0.01;
    s.maxIterations = 2;
    s.contact.tolerance = 1e-6;
    s.sweepAbove = 500;
    s.cappedSweeps = 40;
    s.acceptUnconverged = true;
    s.prune = true;
    s.witness = true;
    s.frameSolves = 40;
    return s;
}

Quality qualityOf(const step::Settings& settings) {
    return settings.frameSolves > 0 ? Quality::Game : Quality::Laboratory;
}

} // namespace supercircle
