#pragma once
// How fast a gap that a step finds may be closed: the one answer for joints, holds, rings and drift (private
// to step/).
//
// A gap over the step's size is a velocity without a bound: a length that is closed within 1 us is a blow, and the
// motion it leaves is energy that nobody put in. A gap therefore closes at no more than `speed`, whatever the size of
// the step, and what is left is kept for the next steps. Gaps of a step's own making are far smaller than that.

#include "supercircle/rod/arc.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

struct Settings;

struct GapClosing {
    double speed = 0.0; ///< m/s
    double share = 1.0; ///< of what that speed closes

    /// Part of a gap (m, of either sign) that stays after `dt` s; exactly 0 where the speed is enough for all of it.
    [[nodiscard]] double left(double gap, double dt) const {
        const double rest = std::copysign(std::max(0.0, std::abs(gap) - speed * dt), gap);
        return share < 1.0 ? gap - share * (gap - rest) : rest;
    }
    [[nodiscard]] rod::Vec2 left(const rod::Vec2& gap, double dt) const {
        const double size = gap.norm(), closed = speed * dt;
        const rod::Vec2 rest = size > closed ? rod::Vec2((1.0 - closed / size) * gap) : rod::Vec2(rod::Vec2::Zero());
        return share < 1.0 ? rod::Vec2(gap - share * (gap - rest)) : rest;
    }
};

/// Overlaps that steps make themselves close in one step, but no faster than in one of this size, of Settings::dtMax.
/// With half of it, shells that were put into each other may bring in four times the energy; twice as much closes what
/// short steps make half as fast. With this value no quasi-static run of the golden list changes.
constexpr double kShortStep = 1.0 / 64.0;

/// That size, s; 0: steps have a given size. A way that is given without a velocity (a held point's target, a body
/// put somewhere else) takes as long at least: a shorter frame goes its share of it. Over 1 ps, 2 mm are six times the
/// speed of light, and a step that long keeps no law.
[[nodiscard]] double shortStep(const Settings& settings);

/// How fast overlaps close that steps make themselves, and others.
struct OverlapClosing {
    double overlap = 0.0;   ///< deeper ones were put there, m
    double shortStep = 0.0; ///< s
    double recovery = 0.0;  ///< of what was put there, and of the others beyond their share, m/s
    /// In a step of `dt` s, of what steps make themselves, m/s.
    [[nodiscard]] double fastest(double dt) const { return overlap / std::max(dt, shortStep) + recovery; }
};

} // namespace supercircle::step
