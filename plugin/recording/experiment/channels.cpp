// Units of recorded channels.

#include "plugin/recording/experiment/free_scene.h"

#include "supercircle/support/names.h"

#include <algorithm>
#include <utility>

namespace supercircle::experiment {

namespace {

using Quantity = scene::Observation::Quantity;

constexpr double kStandardGravity = 9.80665; // m/s^2

bool endsWith(const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

} // namespace

std::vector<Unit> unitsOf(Quantity quantity) {
    switch (quantity) {
    case Quantity::Angle:
        return {{"rad", 1.0}, {"deg", kDegrees}};
    case Quantity::Spin:
        return {{"rad_s", 1.0}, {"deg_s", kDegrees}};
    case Quantity::AngularAcceleration:
        return {{"rad_s2", 1.0}, {"deg_s2", kDegrees}};
    case Quantity::Vx:
    case Quantity::Vy:
        return {{"m_s", 1.0}, {"mm_s", 1e3}};
    case Quantity::Ax:
    case Quantity::Ay:
        return {{"m_s2", 1.0}, {"mm_s2", 1e3}, {"g", 1.0 / kStandardGravity}};
    case Quantity::Force:
        return {{"N", 1.0}, {"kN", 1e-3}, {"mN", 1e3}};
    default:
        return {{"m", 1.0}, {"mm", 1e3}, {"um", 1e6}};
    }
}

std::string setChannel(const std::string& observe, const scene::Observation& observation, Channel& c, Stated& zero) {
    c.name = observe;
    const std::vector<Unit> units = unitsOf(observation.quantity);
    std::string all;
    const Unit* found = nullptr;
    for (const Unit& u : units) {
        all += (all.empty() ? "" : ", ") + std::string(u.name);
        if (c.unit.empty() ? endsWith(c.column, std::string("_") + u.name) : c.unit == u.name)
            found = &u;
    }
    if (found == nullptr)
        return (c.unit.empty() ? "the column \"" + c.column + "\" names no unit"
                               : "\"" + c.unit + "\" is no unit of this channel") +
               "; " + c.name + " is recorded in " + all;
    c.unit = found->name;
    c.perUnit = found->perUnit;
    zero.value *= c.sign / c.perUnit;
    zero.halfWidth /= c.perUnit;
    return {};
}

DriveAxis driveAxis(const Experiment& e) {
    return drivesLoad(e)
               ? DriveAxis{e.scene->driveParameter, e.scene->driveUnit == "1" ? "" : e.scene->driveUnit, 1.0, true}
               : DriveAxis{};
}

Result<Experiment> withFirstChannel(Experiment e, const std::string& observe) {
    if (channel(e).name == observe)
        return e;
    std::vector<std::string> names = {channel(e).name};
    for (std::size_t k = 0; k < furtherChannels(e).size(); ++k) {
        FurtherChannel& other = e.scene->further[k];
        names.push_back(other.observe);
        if (other.observe != observe)
            continue;
        std::swap(e.scene->observe, other.observe);
        std::swap(e.scene->observation, other.observation);
        std::swap(e.scene->channel, other.channel);
        std::swap(e.scene->zero, other.zero);
        std::swap(e.sensors.forceNoise, other.noise);
        for (Run& run : e.runs)
            if (k < run.readings.further.size())
                std::swap(run.readings.force, run.readings.further[k]);
        return e;
    }
    std::string all;
    for (const std::string& name : names)
        all += (all.empty() ? "" : ", ") + name;
    return Result<Experiment>::failure("there is no channel \"" + observe + "\"; expected one of " + all +
                                       didYouMean(observe, names));
}

} // namespace supercircle::experiment
