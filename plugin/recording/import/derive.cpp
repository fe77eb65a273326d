#include "plugin/recording/import/derive.h"
#include "plugin/recording/table/json_text.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace supercircle::importing {

namespace {

using Json = nlohmann::ordered_json;

bool isNumber(const Json& json, const char* key) {
    return json.contains(key) && json[key].is_number();
}

double number(const Json& json, const char* key) {
    return isNumber(json, key) ? json[key].get<double>() : std::nan("");
}

struct Curve {
    std::vector<double> x, y;
    double half = 0.0; ///< half of the thickness
};

/// The unloaded specimen clamped at (0, 0); empty if something is unknown.
Curve unloaded(const Json& s) {
    Curve c;
    const double length = number(s, "arc_length_m"), k = number(s, "natural_curvature_1_m"),
                 h = number(s, "thickness_m");
    if (!std::isfinite(length * k * h) || !s.contains("clamp") || !s["clamp"].is_object())
        return c;
    const Json& clamp = s["clamp"];
    const double angle = number(clamp, "initial_tangent_angle_rad");
    const double from = clamp.value("where", "") == "middle" ? -0.5 * length : 0.0;
    c.half = 0.5 * h;
    for (int i = 0; std::isfinite(angle) && i <= 2000; ++i) {
        const double d = from + length * i / 2000.0, bend = 0.5 * k * d;
        const double chord = std::abs(bend) < 1e-8 ? d : d * math::sin(bend) / bend;
        c.x.push_back(chord * math::cos(angle + bend));
        c.y.push_back(chord * math::sin(angle + bend));
    }
    return c;
}

/// Smallest distance between the surfaces with the clamped point at height y.
double gap(const Curve& c, double y, const Json& json, const Curve& other, double otherY) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < c.x.size(); ++i) {
        for (const Json& o : json["obstacles"])
            if (o.value("type", "") == "cylinder")
                least = std::min(least, math::hypot(c.x[i], y + c.y[i]) - number(o, "radius_m") - c.half);
            else
                least = std::min(least, y + c.y[i] - c.half);
        for (std::size_t k = 0; k < other.x.size(); k += 10)
            least = std::min(least,
                             math::hypot(c.x[i] - other.x[k], y + c.y[i] - otherY - other.y[k]) - c.half - other.half);
    }
    return least;
}

/// Height of first contact from above: bisection between a large height and the first overlap, found in steps of half a
/// thickness.
double contactHeight(const Curve& c, const Json& json, const Curve& other, double otherY) {
    double size = 0.0;
    for (std::size_t i = 0; i < c.x.size(); ++i)
        size = std::max({size, std::abs(c.x[i]), std::abs(c.y[i])});
    double high = otherY + 4.0 * size, low = high;
    for (const Json& o : json["obstacles"])
        if (isNumber(o, "radius_m"))
            high += 2.0 * number(o, "radius_m");
    low = high;
    const double lowest = otherY - 4.0 * size - (high - otherY);
    for (double g = gap(c, low, json, other, otherY); g > 0.0; g = gap(c, low, json, other, otherY)) {
        low -= std::max(c.half, 0.25 * g);
        if (low < lowest || !(c.half > 0.0))
            return std::nan(""); // there is no contact
    }
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (gap(c, middle, json, other, otherY) > 0.0 ? high : low) = middle;
    }
    return high;
}

/// Sets B = E w h^3 / 12 if E, w and h are stated and B is not; removes empty optional entries.
void deriveModuli(Json& specimen, std::vector<std::string>& remarks) {
    if (!specimen.is_object())
        return;
    const double e = number(specimen, "young_modulus_Pa"), w = number(specimen, "width_m"),
                 h = number(specimen, "thickness_m");
    if (!isNumber(specimen, "bending_modulus_N_m2") && std::isfinite(e * w * h)) {
        specimen["bending_modulus_N_m2"] = e * w * h * h * h / 12.0;
        remarks.push_back("bending modulus of specimen " + specimen.value("id", "") +
                          " is E w h^3 / 12 = " + shown(e * w * h * h * h / 12.0) + " N m^2");
    }
    for (const char* key : {"young_modulus_Pa", "width_m"})
        if (specimen.contains(key) && specimen[key].is_null() && isNumber(specimen, "bending_modulus_N_m2"))
            specimen.erase(key);
}

/// Sets the height of the crosshead at displacement 0, from first contact and the unloaded shapes.
void deriveInitialHeight(Json& json, const Imported& all, std::vector<std::string>& remarks) {
    const auto withContact = std::find_if(all.runs.begin(), all.runs.end(), [](const ImportedRun& r) {
        return std::isfinite(r.firstContact) && r.firstContact > 0.0;
    });
    if (withContact == all.runs.end() || !json["obstacles"].is_array() || json["specimens"].empty())
        return;
    const auto done = [&](Json& point, double y) {
        if (!std::isfinite(y))
            return;
        point[1] = y;
        remarks.push_back("height of the crosshead at displacement 0: " + shown(1e3 * y) +
                          " mm, from first contact at " + shown(1e3 * withContact->firstContact) + " mm of " +
                          withContact->file +
                          " and the unloaded shape; its uncertainty, initial_gap_unc_m, must be stated by you");
    };
    Json& last = json["specimens"].back();
    if (json["protocol"] == "arch_between_plates" && !json["obstacles"].empty()) {
        const double length = number(last, "arc_length_m"), k = number(last, "natural_curvature_1_m"),
                     h = number(last, "thickness_m");
        Json& plate = json["obstacles"].back();
        if (std::isfinite(length * k * h) && k > 0.0 && plate["point_m"][1].is_null())
            done(plate["point_m"],
                 (1.0 - math::cos(std::min(0.5 * k * length, M_PI))) / k + h + withContact->firstContact);
        return;
    }
    if (!last["clamp"].is_object() || !last["clamp"].contains("initial_point_m") ||
        !last["clamp"]["initial_point_m"].is_array() || !last["clamp"]["initial_point_m"][1].is_null())
        return;
    for (const Json& o : json["obstacles"])
        if (o.value("type", "") == "cylinder" && !isNumber(o, "radius_m"))
            return;
    const Curve moved = unloaded(last);
    const bool two = json["specimens"].size() == 2;
    const Curve fixed = two ? unloaded(json["specimens"][0]) : Curve{};
    if (moved.x.empty() || (two && fixed.x.empty()))
        return;
    done(last["clamp"]["initial_point_m"], contactHeight(moved, json, fixed, 0.0) + withContact->firstContact);
}

} // namespace

std::string withDerivedValues(const std::string& description, const Imported& all, std::vector<std::string>& remarks) {
    Json json = record::parseJson(description);
    if (json["specimens"].is_array()) {
        for (Json& s : json["specimens"])
            deriveModuli(s, remarks);
        deriveInitialHeight(json, all, remarks);
    }
    return record::jsonText(json);
}

} // namespace supercircle::importing
