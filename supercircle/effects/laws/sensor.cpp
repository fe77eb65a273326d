#include "supercircle/effects/sensor.h"
#include "supercircle/support/elementary.h"

#include <cmath>

namespace supercircle::effects {

double SensorChain::delayed(double time, double force) {
    if (model_.delay <= 0.0)
        return force;
    past_.emplace_back(time, force);
    const double at = time - model_.delay;
    while (past_.size() > 2 && past_[1].first <= at)
        past_.pop_front();
    if (past_.size() == 1 || at <= past_.front().first)
        return past_.front().second;
    const auto& [t0, f0] = past_[0];
    const auto& [t1, f1] = past_[1];
    return t1 > t0 ? f0 + (f1 - f0) * std::fmin(1.0, (at - t0) / (t1 - t0)) : f1;
}

double SensorChain::read(double time, double force) {
    if (!started_) {
        started_ = true;
        start_ = last_ = time;
        input_ = output_ = force; // steady before the first reading
    }
    const double input = delayed(time, force), dt = time - last_;
    if (model_.lag <= 0.0) {
        output_ = input;
    } else if (dt > 0.0) { // exact for a linear input
        const double x = dt / model_.lag, decay = math::exp(-x), slope = (input - input_) / x;
        output_ = input - slope + (output_ - input_ + slope) * decay;
    }
    input_ = input;
    last_ = time;
    const double age = time - start_;
    return (1.0 + model_.gain) * output_ - model_.drift * math::expm1(-age / model_.driftTime) + model_.driftRate * age;
}

} // namespace supercircle::effects
