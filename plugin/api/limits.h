#pragma once
// Ranges of the numbers in calls (private to plugin/api).
//
// Finite numbers are not enough: squares of them overflow, and masses of denormal densities divide to infinity. The NaN
// that follows spreads to all shells. These bounds are far beyond any real world and keep squares and products finite.

#include "plugin/api/include/supercircle/definitions.hpp"
#include "supercircle/rod/model.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/result.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace supercircle::limits {

constexpr double kFarthest = 1e12;   ///< m, coordinates and lengths; rad
constexpr double kFastest = 1e9;     ///< m/s; rad/s and Hz
constexpr double kMostEnergy = 1e30; ///< J
constexpr double kMostTurn = 8.0 * M_PI;
constexpr int kFewestElements = 3;  ///< one or two arcs cannot bend where they are pressed: no contact problem under a
                                    ///< load has a solution
constexpr int kMostElements = 1024; ///< ids of contacts have room for so many (contact/detection/feature_id.h)
constexpr std::size_t kMostPointMasses = 256; ///< on a shell
constexpr double kMostFriction = 1e9;
constexpr double kScale =
    1e30; ///< masses (kg) and B / length (N m): not larger than this, nor smaller than its inverse

inline const char* const kTooFar = "positions must be finite and within 1e12 m";
inline const char* const kTooStrong = "forces and impulses must be finite, and so must the velocity they cause";
inline const char* const kBadFriction = "the friction coefficient must lie between 0 and 1e9";
inline const char* const kBadDamping = "damping_ratio must be at most 100; a negative one is that of the quality";

inline bool damping(double ratio) {
    return ratio <= 100.0;
}
inline bool position(const Point& p) {
    return math::hypot(p.x, p.y) < kFarthest;
}
inline bool angle(double a) {
    return std::abs(a) < kFarthest;
}
inline bool velocity(const Point& v, double spin = 0.0) {
    return math::hypot(v.x, v.y) < kFastest && std::abs(spin) < kFastest;
}
inline bool friction(double mu) {
    return mu >= 0.0 && mu <= kMostFriction;
}
/// Whether an impulse (or a force that acts for one second) gives the shell a finite energy.
inline bool impulse(const rod::RodModel& model, const Point& p, double angular) {
    const double linear = math::hypot(p.x, p.y) + std::abs(angular) / model.definition().length;
    return linear * linear < kMostEnergy * model.mass();
}
/// The same for the motion of a rigid shell.
inline bool motion(const rod::RodDefinition& d, const Point& v, double spin) {
    const double speed = math::hypot(v.x, v.y) + std::abs(spin) * d.length;
    return rod::massOf(d) * speed * speed < kMostEnergy;
}
/// Checks the sizes of a shell that passes rod::validate.
inline Status shell(const rod::RodDefinition& d) {
    const auto within = [](double x, double low, double high) { return x > low && x < high; };
    const double mass = rod::massOf(d);
    if (!within(d.length, 1.0 / kFarthest, kFarthest) || !within(d.thickness, 1.0 / kFarthest, kFarthest) ||
        !within(mass, 1.0 / kScale, kScale) || !within(d.bendingModulus / d.length, 1.0 / kScale, kScale))
        return Status::failure(
            "the shell is too large or too small, too heavy or too light, too stiff or too soft: its motion would "
            "not be finite");
    double bend = 0.0;
    for (const double k : d.naturalCurvature)
        bend = std::max(bend, std::abs(k));
    if (!(d.bendingModulus * d.length * bend * bend < kMostEnergy))
        return Status::failure("the shell is too strongly curved: its energy would not be finite");
    return {};
}
/// An element that turns more than once overlaps itself, and drawing a million turns would take unbounded memory.
inline Status turns(const rod::RodModel& model, const std::vector<double>& curvature) {
    for (int i = 0; i < model.elements(); ++i)
        if (const double turn = curvature[static_cast<std::size_t>(i)] * model.elementLength(i);
            !(std::abs(turn) <= kMostTurn))
            return Status::failure(
                "natural_curvature, curvature and radius may turn an element by 8 pi at most: element " +
                std::to_string(i) + " would turn by " + std::to_string(turn) + " rad");
    return {};
}
/// A closed curve that does not cross itself turns once (Whitney). The closure keeps the whole turns that are nearest.
inline Status ring(const rod::RodModel& model, const std::vector<double>& curvature) {
    double turn = 0.0;
    for (int i = 0; i < model.elements(); ++i)
        turn += curvature[static_cast<std::size_t>(i)] * model.elementLength(i);
    if (std::abs(turn) > M_PI && std::abs(turn) < 3.0 * M_PI)
        return {};
    return Status::failure("a ring turns once: curvature must add up to 2 pi over its length, here it is " +
                           std::to_string(turn) + " rad (empty: a round ring)");
}

} // namespace supercircle::limits
