// Contradictions within a description.

#include "plugin/recording/experiment/recording_quality.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace supercircle::experiment {

namespace {

/// E w h^3 / 12 and E w h are redundant where E, w and h are stated.
void judgeModuli(const Specimen& s, const std::string& pointer, std::vector<Contradiction>& out) {
    if (s.youngModulus <= 0.0 || s.width <= 0.0)
        return;
    const double h = s.thickness.value, b = s.youngModulus * s.width * h * h * h / 12.0,
                 k = s.youngModulus * s.width * h;
    const double slack = std::max(0.02 * s.bendingModulus.value, s.bendingModulus.halfWidth) +
                         3.0 * s.bendingModulus.value * s.thickness.halfWidth / h;
    if (const double ratio = s.bendingModulus.value / b; ratio > 100.0 || ratio < 0.01)
        out.push_back({pointer + "/bending_modulus_N_m2",
                       "this is " + shown(ratio) + " times E w h^3 / 12 = " + shown(b) + " N m^2 of the same specimen",
                       "SI units in all four", true});
    else if (std::abs(s.bendingModulus.value - b) > slack)
        out.push_back({pointer + "/bending_modulus_N_m2",
                       "E w h^3 / 12 of the same specimen is " + shown(b) + " N m^2; the stated value is taken",
                       {},
                       false});
    if (s.stretchModulus > 0.0 && std::abs(s.stretchModulus / k - 1.0) > 0.1)
        out.push_back({pointer + "/stretch_modulus_N",
                       "E w h of the same specimen is " + shown(k) + " N; the stated value is taken",
                       {},
                       false});
}

/// Implausible sizes: millimetres written as metres.
void judgeSizes(const Specimen& s, const std::string& pointer, std::vector<Contradiction>& out) {
    if (s.length > 50.0)
        out.push_back({pointer + "/arc_length_m", "a specimen of " + shown(s.length) + " m", "metres", true});
    if (s.thickness.value > 0.25 * s.length)
        out.push_back({pointer + "/thickness_m",
                       "a thickness of " + shown(s.thickness.value) + " m for a length of " + shown(s.length) + " m",
                       "a thin strip, both in metres", true});
    if (std::abs(s.naturalCurvature.value) * s.thickness.value > 0.5)
        out.push_back({pointer + "/natural_curvature_1_m",
                       "a radius of " + shown(1.0 / std::abs(s.naturalCurvature.value)) + " m for a thickness of " +
                           shown(s.thickness.value) + " m",
                       "a radius well above the thickness; curvature in 1/m", true});
    else if (std::abs(s.naturalCurvature.value) * s.length > 2.0 * M_PI * (1.0 + 1e-6))
        out.push_back({pointer + "/natural_curvature_1_m",
                       "the unloaded specimen closes on itself: curvature times length is " +
                           shown(std::abs(s.naturalCurvature.value) * s.length) + ", more than 2 pi",
                       {},
                       false});
}

/// Intervals that include zero, and implausible densities.
void judgeIntervals(const Specimen& s, const std::string& pointer, std::vector<Contradiction>& out) {
    const auto reachesZero = [&](const Stated& v, const char* key) {
        if (v.halfWidth >= std::abs(v.value) && v.value != 0.0)
            out.push_back(
                {pointer + key,
                 "the interval reaches from " + shown(v.value - v.halfWidth) + " to " + shown(v.value + v.halfWidth),
                 "an uncertainty below the value itself", true});
    };
    reachesZero(s.bendingModulus, "/bending_modulus_rel_unc");
    reachesZero(s.thickness, "/thickness_unc_m");
    reachesZero(s.linearMass, "/linear_mass_rel_unc");
    if (s.width <= 0.0)
        return;
    const double density = s.linearMass.value / (s.width * s.thickness.value);
    if (density > 3e4 || density < 5.0)
        out.push_back({pointer + "/linear_mass_kg_m",
                       "with width and thickness this is a density of " + shown(density) + " kg/m^3; kg/m is expected",
                       {},
                       false});
}

/// Point of the unloaded clamped specimen at arc length s.
Point unloaded(const Specimen& specimen, double s) {
    const Clamp& c = specimen.clamp;
    const double k = specimen.naturalCurvature.value, d = s - c.arcPosition, half = 0.5 * k * d;
    const double chord = std::abs(half) < 1e-8 ? d : d * math::sin(half) / half;
    return {c.initialPoint.x + chord * math::cos(c.initialTangentAngle + half),
            c.initialPoint.y + chord * math::sin(c.initialTangentAngle + half)};
}

double distance(const Obstacle& o, const Point& p) {
    if (o.kind == ObstacleKind::Cylinder)
        return math::hypot(p.x - o.point.x, p.y - o.point.y) - o.radius;
    return (p.x - o.point.x) * o.normal.x + (p.y - o.point.y) * o.normal.y;
}

/// Largest commanded displacement of all runs.
double furthest(const Experiment& e) {
    double most = 0.0;
    for (const Run& run : e.runs)
        for (const double d : run.driveDisplacement)
            most = std::max(most, std::abs(d));
    return most;
}

/// A clamped specimen that starts inside an obstacle, allowing for sag and stated uncertainties.
void judgePlaces(const Experiment& e, std::vector<Contradiction>& out) {
    for (std::size_t i = 0; i < e.specimens.size(); ++i) {
        const Specimen& s = e.specimens[i];
        if (s.clamp.where == ClampPlace::None)
            continue;
        const double slack = 0.01 * s.length + e.initialGapHalfWidth + s.thickness.halfWidth;
        for (std::size_t k = 0; k < e.obstacles.size(); ++k) {
            double least = distance(e.obstacles[k], s.clamp.initialPoint);
            for (int j = 0; j <= 64; ++j)
                least = std::min(least, distance(e.obstacles[k], unloaded(s, s.length * j / 64.0)));
            least -= 0.5 * s.thickness.value;
            if (least < -slack)
                out.push_back({"/specimens/" + std::to_string(i) + "/clamp/initial_point_m",
                               "at displacement 0 the unloaded specimen is " + shown(-1e3 * least) +
                                   " mm deep in obstacle " + std::to_string(k),
                               "a start without overlap", true});
            else if (e.specimens.size() == 1 && e.obstacles.size() == 1 && least > furthest(e) + slack)
                out.push_back({"/specimens/" + std::to_string(i) + "/clamp/initial_point_m",
                               "at displacement 0 the unloaded specimen is " + shown(1e3 * least) +
                                   " mm from the obstacle, and the crosshead moves by " + shown(1e3 * furthest(e)) +
                                   " mm: they never come into contact",
                               {},
                               false});
        }
    }
}

void judgeRuns(const Experiment& e, std::vector<Contradiction>& out) {
    std::set<std::string> files;
    for (std::size_t i = 0; i < e.runs.size(); ++i) {
        const Run& run = e.runs[i];
        const std::string pointer = "/runs/" + std::to_string(i);
        if (!files.insert(run.file).second)
            out.push_back({pointer + "/file", "another run has the same file \"" + run.file + "\"", {}, true});
        if (run.driveDisplacement.empty()) // a scene without a machine
            continue;
        const auto [lo, hi] = std::minmax_element(run.driveDisplacement.begin(), run.driveDisplacement.end());
        if (*hi == *lo && !e.scene)
            out.push_back({pointer + "/drive_displacement_mm", "the crosshead does not move", {}, false});
        double length = 0.0;
        for (const Specimen& s : e.specimens)
            length = std::max(length, s.length);
        if (*hi - *lo > 20.0 * length && !e.scene)
            out.push_back({pointer + "/drive_displacement_mm",
                           "the crosshead moves by " + shown(1e3 * (*hi - *lo)) + " mm, " +
                               shown((*hi - *lo) / length) + " times the length of the specimen",
                           "millimetres", true});
        if (!run.markersFile.empty() && e.markers.empty())
            out.push_back({pointer + "/markers_file", "there is a file of markers but no entry in /markers",
                           "the markers' names and places", true});
    }
}

} // namespace

std::vector<Contradiction> contradictions(const Experiment& e) {
    std::vector<Contradiction> out;
    for (std::size_t i = 0; i < e.specimens.size(); ++i) {
        const std::string pointer = "/specimens/" + std::to_string(i);
        judgeSizes(e.specimens[i], pointer, out);
        judgeModuli(e.specimens[i], pointer, out);
        judgeIntervals(e.specimens[i], pointer, out);
    }
    for (std::size_t i = 0; i < e.markers.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if (e.markers[i].name == e.markers[k].name)
                out.push_back({"/markers/" + std::to_string(i) + "/name",
                               "there are two markers \"" + e.markers[i].name + "\"",
                               {},
                               true});
    if (e.friction.value > 10.0)
        out.push_back({"/friction/coefficient", "a friction coefficient of " + shown(e.friction.value), {}, false});
    if (math::hypot(e.gravity.x, e.gravity.y) > 50.0)
        out.push_back({"/gravity_m_s2", "gravity of " + shown(math::hypot(e.gravity.x, e.gravity.y)) + " m/s^2",
                       "m/s^2, 9.81 downwards", true});
    if (out.empty() || std::none_of(out.begin(), out.end(), [](const Contradiction& r) { return r.error; }))
        judgePlaces(e, out);
    judgeRuns(e, out);
    return out;
}

} // namespace supercircle::experiment
