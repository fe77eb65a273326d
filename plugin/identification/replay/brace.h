#pragma once
// A bow as it is strung: a strip held at its middle, bent by a straight string between its ends (private to replay/).

#include "supercircle/rod/model.h"

#include <Eigen/Core>
#include <string>

namespace supercircle::replay {

struct Braced {
    std::string failure; ///< empty: found
    Eigen::VectorXd q;   ///< shape of the strip
    double half = 0.0;   ///< from an end to the middle of the string, m
};

/// The string passes through `nock` and pulls the ends along itself only: of all strings between ends held level with
/// the nock, the one whose pull has no part across it.
/// @param s, point, angle where and how the strip is held
Braced brace(const rod::RodModel& model, const rod::Vec2& gravity, double s, const rod::Vec2& point, double angle,
             const rod::Vec2& nock);

} // namespace supercircle::replay
