#pragma once
// Laws that are learned from data: uniform cubic B-splines of one state variable.
//
// The basis functions are positive and sum to one, so coefficients above -1 keep 1 + S positive. Bounds on the
// coefficients thus ensure a moment that increases with curvature and a positive friction coefficient.
//
// Source: C. de Boor, "A Practical Guide to Splines" (1978); P. H. C. Eilers, B. D. Marx, Stat. Sci. 11 (1996) 89.

#include <array>
#include <cstddef>

namespace supercircle::effects {

inline constexpr std::size_t kSplineCoefficients = 7;
using SplineCoefficients = std::array<double, kSplineCoefficients>;
/// Of a law that is given as a formula: 24 segments. Half as many err by 16 times as much, twice as many cost twice.
inline constexpr std::size_t kTableCoefficients = 27;
using TableCoefficients = std::array<double, kTableCoefficients>;

inline constexpr double kTableDecades = 6.0; ///< that the table of a law of a speed covers

struct SplinePoint {
    double value = 0.0;
    double slope = 0.0;  ///< dS/dx
    double area = 0.0;   ///< integral of S from 0 to x
    double moment = 0.0; ///< integral of the area from 0 to x
};

/// S(x) on [0, 1], constant beyond; the caller provides any odd continuation.
SplinePoint evaluateSpline(const SplineCoefficients& c, double x);

/// The same basis with three more coefficients of zero: S and its first two derivatives vanish at x = 1 and beyond.
SplinePoint evaluateFading(const SplineCoefficients& c, double x);

/// S(x) of a table on [0, 1], constant beyond.
SplinePoint evaluateTable(const TableCoefficients& c, double x);

} // namespace supercircle::effects
