#include "plugin/pages/run/key_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "plugin/graphics/axis.h"

namespace supercircle::pages {

using graphics::significant;

namespace {

struct Suffix {
    std::string_view ending, unit;
};

/// Longest first: "_m_s" before "_s".
constexpr std::array<Suffix, 17> suffixes{{{"_R2_over_B", "B/R²"},
                                           {"_R_over_B", "B/R"},
                                           {"_N_m2", "N m²"},
                                           {"_m_s2", "m/s²"},
                                           {"_kg_m", "kg/m"},
                                           {"_over_R", "R"},
                                           {"_over_L", "L"},
                                           {"_over_h", "h"},
                                           {"_rad_s", "rad/s"},
                                           {"_m_s", "m/s"},
                                           {"_rad", "rad"},
                                           {"_Pa", "Pa"},
                                           {"_N", "N"},
                                           {"_J", "J"},
                                           {"_s", "s"},
                                           {"_m", "m"},
                                           {"_Hz", "Hz"}}};

const Suffix* suffixOf(std::string_view key) {
    for (const Suffix& suffix : suffixes)
        if (key.size() > suffix.ending.size() && key.substr(key.size() - suffix.ending.size()) == suffix.ending)
            return &suffix;
    return nullptr;
}

struct Label {
    std::string_view key, text;
};

constexpr std::array<Label, 21> labels{{{"H0_over_R", "height of the pile, H₀"},
                                        {"delta_max_over_R", "working distance, Δmax"},
                                        {"dissipation_ratio", "dissipation ratio, η"},
                                        {"snap_fits", "snap-fits"},
                                        {"max_force_drop_R2_over_B", "largest force drop"},
                                        {"max_energy_release_R_over_B", "largest energy release of one shell"},
                                        {"peak_force_unfiltered_N", "peak force, unfiltered"},
                                        {"pull_off_force_R2_over_B", "pull-off force"},
                                        {"simulated_s", "simulated time"},
                                        {"wall_s", "computing time"},
                                        {"cpu_s", "CPU time"},
                                        {"penetration_max_over_h", "largest penetration"},
                                        {"length_error_max", "largest error of length"},
                                        {"contact_residual_max", "largest contact residual"},
                                        {"energy_residual_relative", "energy residual, relative"},
                                        {"elastic_J", "bending"},
                                        {"gravity_J", "gravity"},
                                        {"position_correction_J", "position correction"},
                                        {"dissipated_J", "dissipated"},
                                        {"phi_bar", "opening angle / 2π"},
                                        {"mu", "friction coefficient μ"}}};

std::string count(double n, const std::string& one, const std::string& many) {
    return std::to_string(std::lround(n)) + " " + (std::lround(n) == 1 ? one : many);
}

std::string wholeCount(std::size_t n, const std::string& one) {
    return std::to_string(n) + " " + one + (n == 1 ? "" : "s");
}

} // namespace

std::string keyLabel(const std::string& key) {
    for (const Label& label : labels)
        if (label.key == key)
            return std::string(label.text);
    std::string text = key;
    if (const Suffix* suffix = suffixOf(key))
        text.resize(text.size() - suffix->ending.size());
    std::replace(text.begin(), text.end(), '_', ' ');
    return text;
}

std::string keyUnit(const std::string& key) {
    const Suffix* suffix = suffixOf(key);
    return suffix == nullptr ? std::string{} : std::string(suffix->unit);
}

std::string parameterUnit(const std::string& name) {
    static constexpr std::array<Label, 12> known{{{"plate_speed", "m/s"},
                                                  {"speed", "m/s"},
                                                  {"max_force", "N"},
                                                  {"thickness", "m"},
                                                  {"width", "m"},
                                                  {"length", "m"},
                                                  {"radius", "m"},
                                                  {"angle", "rad"},
                                                  {"density", "kg/m³"},
                                                  {"youngs_modulus", "Pa"},
                                                  {"gravity", "m/s²"},
                                                  {"duration", "s"}}};
    for (const Label& entry : known)
        if (entry.key == name)
            return std::string(entry.text);
    return keyUnit(name);
}

std::string valueText(const record::Value& value) {
    if (const auto* number = std::get_if<double>(&value))
        return significant(*number);
    if (const auto* whole = std::get_if<std::int64_t>(&value))
        return std::to_string(*whole);
    if (const auto* flag = std::get_if<bool>(&value))
        return *flag ? "yes" : "no";
    return std::get<std::string>(value);
}

double summaryNumber(const record::Recording& recording, const std::string& key) {
    for (const auto& [name, value] : recording.summary)
        if (name == key) {
            if (const auto* number = std::get_if<double>(&value))
                return *number;
            if (const auto* whole = std::get_if<std::int64_t>(&value))
                return static_cast<double>(*whole);
        }
    for (const auto& [name, seconds] : recording.timing)
        if (name == key)
            return seconds;
    return std::numeric_limits<double>::quiet_NaN();
}

std::string summarySentence(const record::Recording& recording) {
    const auto value = [&](const char* key) { return summaryNumber(recording, key); };
    std::string text =
        recording.shells.empty() ? std::string("Rigid bodies") : wholeCount(recording.shells.size(), "shell");
    const double peak = value("peak_force_N"), travel = value("delta_max_over_R"), snaps = value("snap_fits");
    if (std::isfinite(peak)) {
        text += std::isfinite(travel) ? " squeezed up to " : " loaded up to ";
        text += significant(peak, 3) + " N";
        if (std::isfinite(travel))
            text += ", with a working distance of " + significant(travel, 3) + " R";
        if (std::isfinite(snaps))
            text += snaps == 0.0 ? ", without a snap-fit" : " and " + count(snaps, "snap-fit", "snap-fits");
        text += '.';
        if (const double ratio = value("dissipation_ratio"); std::isfinite(ratio))
            text += " The first cycle dissipates " + significant(100.0 * ratio, 2) +
                    " % of largest force × working distance.";
        return text;
    }
    double duration = value("simulated_s");
    if (!std::isfinite(duration) && recording.frames.size() > 1)
        duration = recording.frames.back().time - recording.frames.front().time;
    if (std::isfinite(duration))
        text += " simulated for " + significant(duration, 3) + " s";
    return text + '.';
}

} // namespace supercircle::pages
