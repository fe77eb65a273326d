#include "plugin/identification/sensitivity/model.h"

#include "plugin/identification/replay/free_scales.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace supercircle::sensitivity {

namespace {

using experiment::Experiment;

/// Relevant change of a parameter without a stated interval: the usual uncertainty of a laboratory.
double usualScale(const Experiment& e, const std::string& name, double value) {
    const experiment::NaturalUnits units = replay::naturalUnits(e);
    if (name == "gravity_x" || name == "gravity_y") {
        const double gravity = math::hypot(e.gravity.x, e.gravity.y);
        return (gravity > 0.0 ? gravity : 9.81) * (M_PI / 180.0); // m/s^2: a base tilted by one degree
    }
    if (name == "contact_arm")
        return 1.0; // its whole range
    if (name == "gap_shift")
        return 5e-5 * units.length;
    if (name == "friction")
        return std::max(0.02, 0.1 * value);
    if (name == "series_compliance" || name == "touch_compliance") {
        // m/N: a fiftieth of a percent of the crosshead travel at the largest force
        double force = 0.0, way = 0.0;
        for (const experiment::Run& run : e.runs) {
            for (const double f : run.readings.force)
                force = std::isfinite(f) ? std::max(force, std::abs(f)) : force;
            for (const double d : run.driveDisplacement)
                way = std::max(way, std::abs(d));
        }
        return force > 0.0 ? 2e-3 * way / force : 1e-5 * units.of("m/N");
    }
    return value != 0.0 ? 0.02 * std::abs(value) : 1.0;
}

Column columnOf(const Experiment& e, const replay::ParameterInfo& info, double value) {
    Column c;
    c.name = info.name;
    c.unit = info.unit;
    c.about = info.about;
    c.value = value;
    c.scale = info.stated.halfWidth > 0.0 ? info.stated.halfWidth : usualScale(e, info.name, value);
    const std::string base = info.name.substr(0, info.name.find('.'));
    if (base == "bending_modulus" || base == "thickness" || base == "linear_mass")
        c.lower = 1e-3 * value;
    if (base == "friction" || base == "contact_arm" || base == "series_compliance" || base == "touch_compliance")
        c.lower = 0.0;
    if (base == "contact_arm")
        c.upper = 1.0;
    return c;
}

/// Column of a parameter of an effect; empty: no such effect or parameter.
std::optional<Column> effectColumn(const Experiment& e, const replay::Parameters& parameters, const std::string& name) {
    const std::size_t colon = name.find(':');
    const effects::Effect* effect = colon == std::string::npos ? nullptr : effects::find(name.substr(0, colon));
    if (effect == nullptr)
        return std::nullopt;
    for (const effects::Parameter& p : effect->parameters) {
        if (p.name != name.substr(colon + 1) || !p.choices.empty())
            continue;
        Column c;
        c.name = name;
        c.unit = p.unit;
        c.about = p.about;
        c.value = replay::get(parameters, e, name).value_or(p.off);
        c.lower = p.min;
        c.upper = p.max;
        // Typical values are those of the reference specimen.
        const double unit = replay::naturalUnits(e).of(p.unit), typical = p.typical * unit;
        c.scale = std::abs(typical - (p.isSwitch ? p.off : 0.0));
        if (std::isinf(c.value)) {
            c.name = effect->name + ":1/" + p.name;
            c.unit = p.unit == "1/m" ? "m" : p.unit == "N/m" ? "m/N" : "1/(" + p.unit + ")";
            c.about = "inverse of: " + p.about;
            c.value = 0.0;
            c.lower = 0.0;
            c.upper = 1.0 / std::max(p.min, 1e-12);
            c.scale = 1.0 / typical;
            c.inverse = true;
        }
        return c;
    }
    return std::nullopt;
}

std::string setColumn(replay::Parameters& p, const Experiment& e, const Column& c, double value) {
    if (!c.inverse)
        return replay::set(p, e, c.name, value);
    std::string name = c.name;
    name.erase(name.find(":1/") + 1, 2);
    return value > 0.0 ? replay::set(p, e, name, 1.0 / value) : "an amplitude is negative";
}

/// Whether an amplitude belongs to the first law of its effect.
bool actsByItself(const effects::Effect& effect, const effects::Parameter& p) {
    effects::Setting setting = effects::off(effect);
    return effects::set(setting, p.name, p.typical).empty() && effects::validate({setting}).empty();
}

} // namespace

std::vector<std::string> effectNames(const Experiment& e) {
    std::vector<std::string> names;
    for (const effects::Effect& effect : effects::catalog())
        for (const effects::Parameter& p : effect.parameters)
            if (p.isSwitch && replay::acts(e, effect.key) && actsByItself(effect, p))
                names.push_back(effect.name + ":" + p.name);
    return names;
}

Model replayModel(const Experiment& e, const replay::Parameters& parameters, const replay::Resolution& resolution,
                  const std::vector<std::string>& names, std::string& error) {
    Model model;
    model.runs = e.runs.size();
    const std::vector<replay::ParameterInfo> all = replay::parameterList(e);
    const auto add = [&](const replay::ParameterInfo& info) {
        model.columns.push_back(columnOf(e, info, replay::get(parameters, e, info.name).value_or(0.0)));
    };
    for (const replay::ParameterInfo& info : all)
        if (names.empty() && (e.scene ? !info.ofBatch : info.name.find('.') == std::string::npos))
            add(info);
    for (const std::string& name : names) {
        const auto found =
            std::find_if(all.begin(), all.end(), [&](const replay::ParameterInfo& info) { return info.name == name; });
        if (found != all.end()) {
            add(*found);
            continue;
        }
        if (const auto column = effectColumn(e, parameters, name)) {
            model.columns.push_back(*column);
            continue;
        }
        replay::Parameters copy = parameters;
        error = replay::set(copy, e, name, 0.0); // reports the known names
        return {};
    }
    // Only differences from the centre are set, so a shared name keeps differences between specimens.
    model.simulate = [&e, parameters, resolution, columns = model.columns](
                         std::size_t run, const std::vector<double>& values, const replay::Options& options) {
        replay::Parameters p = parameters;
        for (std::size_t i = 0; i < columns.size() && i < values.size(); ++i)
            if (values[i] != columns[i].value)
                if (const std::string why = setColumn(p, e, columns[i], values[i]); !why.empty()) {
                    replay::Simulated failed;
                    failed.failure = why;
                    return failed;
                }
        return replay::simulate(e, run, p, resolution, options);
    };
    return model;
}

} // namespace supercircle::sensitivity
