#pragma once
// Positions and vectors in metres to Box2D units and back (private to bridge/).

#include <supercircle/definitions.hpp>

#include <Eigen/Core>
#include <box2d/b2_math.h>

namespace supercircle::bridge {

/// `scale`: Box2D units per metre.
inline b2Vec2 toHost(const Eigen::Vector2d& v, double scale) {
    return {static_cast<float>(v.x() * scale), static_cast<float>(v.y() * scale)};
}
inline b2Vec2 toHost(const Point& p, double scale) {
    return {static_cast<float>(p.x * scale), static_cast<float>(p.y * scale)};
}
inline Eigen::Vector2d toSi(const b2Vec2& v, double scale) {
    return {static_cast<double>(v.x) / scale, static_cast<double>(v.y) / scale};
}

} // namespace supercircle::bridge
