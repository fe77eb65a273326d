#pragma once
// Vectors of the plane (private to replay/).

#include "supercircle/rod/arc.h"
#include "supercircle/support/trig.h"

namespace supercircle::replay {

inline double cross(const rod::Vec2& a, const rod::Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}
inline rod::Vec2 rotated(const rod::Vec2& v, double angle) {
    const double c = math::cos(angle), s = math::sin(angle);
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}
/// Velocity of the point r of a body that turns about the origin.
inline rod::Vec2 crossSpin(double spin, const rod::Vec2& r) {
    return {-spin * r.y(), spin * r.x()};
}

} // namespace supercircle::replay
