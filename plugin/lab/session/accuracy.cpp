#include "plugin/lab/session/accuracy.h"

#include "plugin/lab/session/session.h"

#include <algorithm>
#include <cmath>

namespace supercircle::lab {

/// After setStepLimits(). A fixed step and a longest step that the scene gives stay.
void Session::setAccuracy(double speed) {
    const AccuracyLevel level = levelOf(accuracy_);
    step::Settings& s = shells_.stepper().settings();
    if (s.fixedDt > 0.0)
        return;
    s.motionLimit = level.motion * motionLimit_;
    s.localError = level.error * localError_;
    s.relinearise = level.relinearise;
    s.cull = s.giveUpEarly = level.prune;
    sampleTravel_ = 0.0;
    if (level.longestStep == 1.0 || speed == 0.0 || scene_.numerics.dt_max > 0.0)
        return;
    sampleTravel_ = std::abs(speed) * s.dtMax;
    s.dtMax *= level.longestStep;
    frame_ = s.dtMax;
}

/// Rows within the last step where it is longer than a sample. Within a step of backward Euler everything is linear in
/// time, to its order.
void Session::addRowsBetween(double rawForce) {
    record::Series& s = out_.series;
    if (sampleTravel_ <= 0.0 || s.rows() == 0)
        return;
    const step::World& w = shells_.world();
    const double from = s.columns[0].back(), start = s.columns[1].back(), end = travel();
    const auto parts = static_cast<int>(std::ceil(std::abs(end - start) / sampleTravel_ - 1e-6));
    if (parts < 2)
        return;
    std::vector<double> before;
    for (const std::vector<double>& column : s.columns)
        before.push_back(column.back());
    const std::size_t first = s.rows();
    for (int i = 1; i < parts; ++i) {
        const double share = static_cast<double>(i) / parts;
        const double time = from + share * (w.time - from), force = rawForce_ + share * (rawForce - rawForce_);
        addRow(time, start + share * (end - start), sensorOn_ ? sensor_.read(time, force) : force);
    }
    for (std::size_t c = 3; c + 2 < s.columns.size(); ++c) // energies; not the step and the residual
        for (int i = 1; i < parts; ++i) {
            double& value = s.columns[c][first + static_cast<std::size_t>(i) - 1];
            value = before[c] + static_cast<double>(i) / parts * (value - before[c]);
        }
}

} // namespace supercircle::lab
