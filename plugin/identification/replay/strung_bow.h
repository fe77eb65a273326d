#pragma once
// Strung bow: a strip clamped at its middle and bent by a straight string between its ends (private to replay/).

#include "supercircle/rod/model.h"

#include <Eigen/Core>
#include <string>

namespace supercircle::replay {

struct StrungBow {
    std::string failure; ///< why there is none; empty: found
    Eigen::VectorXd q;   ///< generalised coordinates of the strip
    double half = 0.0;   ///< m, from an end to the middle of the string
};

/// Finds the strung shape. The string passes through `nock` and pulls the ends along itself only.
/// @param s, point, angle position of the clamp on the strip, its place and direction
StrungBow stringBow(const rod::RodModel& model, const rod::Vec2& gravity, double s, const rod::Vec2& point,
                    double angle, const rod::Vec2& nock);

} // namespace supercircle::replay
