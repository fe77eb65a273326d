#pragma once
// What the load cell and its chain make of a force: delay, low pass, gain, drift.

#include "supercircle/effects/model.h"

#include <deque>
#include <utility>

namespace supercircle::effects {

/// Reads forces one after the other. Plain data: a copy goes on as the original does.
class SensorChain {
public:
    SensorChain() = default;
    explicit SensorChain(const SensorModel& model) : model_(model) {}

    /// The reading at `time` (s, not falling) of a force (N) that runs straight from its last value to this one.
    double read(double time, double force);

private:
    double delayed(double time, double force);

    SensorModel model_;
    bool started_ = false;
    double start_ = 0.0;                         ///< s
    double last_ = 0.0;                          ///< s
    double input_ = 0.0;                         ///< of the low pass at last_, N
    double output_ = 0.0;                        ///< N
    std::deque<std::pair<double, double>> past_; ///< times and forces that the delay still needs
};

} // namespace supercircle::effects
