#pragma once
// The reading of a load cell and its signal chain: delay, low pass, gain, drift.

#include "supercircle/effects/model.h"

#include <deque>
#include <utility>

namespace supercircle::effects {

/// Reads forces one after the other. Plain data: a copy continues like the original.
class SensorChain {
public:
    SensorChain() = default;
    explicit SensorChain(const SensorModel& model) : model_(model) {}

    /// The reading (N) at `time` (s, not decreasing) of a force (N) that is linear between the last value and this one.
    double read(double time, double force);

    /// Calls `archive` with all that changes, for saving and loading.
    template <class Self, class Archive>
    static void state(Self& self, Archive& archive) {
        archive(self.started_, self.start_, self.last_, self.input_, self.output_, self.past_);
    }

private:
    double delayed(double time, double force);

    SensorModel model_;
    bool started_ = false;
    double start_ = 0.0;                         ///< first time, s
    double last_ = 0.0;                          ///< last time, s
    double input_ = 0.0;                         ///< of the low pass at last_, N
    double output_ = 0.0;                        ///< N
    std::deque<std::pair<double, double>> past_; ///< times and forces that the delay still needs
};

} // namespace supercircle::effects
