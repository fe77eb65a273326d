// What a run keeps of its steps: rows of the series, and sums over all of them.

#include "plugin/lab/session/session.h"

#include "supercircle/rod/inertia.h"
#include "supercircle/step/damping.h"

#include <algorithm>
#include <cmath>

namespace supercircle::lab {

/// What is kept of every step.
void Session::record() {
    if (apparatus_.bedding > 0.0)
        largestForce_ = std::max(largestForce_, force());
    sample();
    keepFrame(false);
    watchVibration();
}

namespace {

/// Kinetic energy but for that of a rigid motion, J; all of it where the rod is held.
double vibratingEnergy(const step::Rod& r) {
    const double all = rod::kineticEnergy(r.gauss, r.u), mass = r.model.mass();
    if (!r.holds.empty())
        return all;
    const rod::Vec2 centre = rod::massCentre(r.kin, r.gauss);
    rod::Vec2 drift = rod::Vec2::Zero();
    for (std::size_t g = 0; g < r.u.size(); ++g)
        drift += (r.gauss.mass[g] / mass) * r.u[g];
    double momentum = 0.0, inertia = 0.0; // angular, about the centre of mass
    for (std::size_t g = 0; g < r.u.size(); ++g) {
        const rod::Vec2 arm = r.kin.middle() + r.gauss.arm[g] - centre;
        momentum += r.gauss.mass[g] * rod::cross(arm, r.u[g] - drift);
        inertia += r.gauss.mass[g] * arm.squaredNorm();
    }
    const double rigid = 0.5 * mass * drift.squaredNorm() + 0.5 * momentum * momentum / std::max(inertia, 1e-300);
    return std::max(0.0, all - rigid);
}

} // namespace

/// What a damping of the first mode would take at a ratio of 1: twice its frequency times the energy of vibration,
/// which is twice the kinetic one on average.
void Session::watchVibration() {
    const step::World& w = shells_.world();
    if (!shells_.stepper().settings().secondOrder)
        return;
    if (firstFrequencies_.size() != w.rods.size()) {
        firstFrequencies_.clear();
        for (const step::Rod& r : w.rods)
            firstFrequencies_.push_back(step::firstFrequency(r));
    }
    for (std::size_t i = 0; i < w.rods.size(); ++i)
        unitDamping_ += 4.0 * firstFrequencies_[i] * vibratingEnergy(w.rods[i]) * w.dt;
}

void Session::sample() {
    const step::World& w = shells_.world();
    if (!inProtocol_ && w.time < nextSampleTime_)
        return;
    nextSampleTime_ = w.time + 0.01;
    if (scene_.protocol && !inProtocol_)
        return;
    const double rawForce = force();
    addRowsBetween(rawForce);
    addRow(w.time, travel(), sensorOn_ ? sensor_.read(w.time, rawForce) : rawForce);
    rawForce_ = rawForce;
    if (!loading_)
        return;
    energies_.clear();
    for (const step::Rod& r : w.rods)
        energies_.push_back(rod::bendingEnergy(r.model, r.q));
    energyRelease_.sample(out_.series.columns[1].back(), energies_);
}

/// A row of the present state.
void Session::addRow(double time, double travel, double force) {
    const step::World& w = shells_.world();
    const step::EnergyBalance& l = w.energyBalance;
    const double row[] = {time,
                          travel,
                          force,
                          l.work - energyAtStart_.work,
                          l.bending,
                          l.gravity,
                          l.kinetic,
                          l.friction - energyAtStart_.friction,
                          l.impact - energyAtStart_.impact,
                          l.numerical - energyAtStart_.numerical,
                          l.positionCorrection - energyAtStart_.positionCorrection,
                          l.effects - energyAtStart_.effects,
                          l.residual() - energyAtStart_.residual(),
                          w.dt,
                          w.counters.contactResidualMax};
    for (std::size_t i = 0; i < std::size(row); ++i)
        out_.series.columns[i].push_back(row[i]);
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
