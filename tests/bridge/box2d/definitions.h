#pragma once
// Small worlds as definitions.

#include "bridge/box2d/lab_world.h"

#include <catch2/catch.hpp>
#include <memory>
#include <string>

namespace supercircle::bridge_test {

using namespace supercircle::step;

inline FixtureDefinition box(double halfWidth, double halfHeight, const Vec2& at = Vec2::Zero(),
                             double density = 1000.0) {
    FixtureDefinition f;
    f.vertices = {at + Vec2(-halfWidth, -halfHeight), at + Vec2(halfWidth, -halfHeight),
                  at + Vec2(halfWidth, halfHeight), at + Vec2(-halfWidth, halfHeight)};
    f.density = density;
    return f;
}

inline BodyDefinition body(BodyType type, const FixtureDefinition& f, const std::string& name = {}) {
    BodyDefinition b;
    b.name = name;
    b.type = type;
    b.fixtures = {f};
    return b;
}

inline RigidWorldDefinition worldWith(const BodyDefinition& b, double scale = 52.1) {
    RigidWorldDefinition d;
    d.lengthScale = scale;
    d.bodies = {b};
    return d;
}

inline std::unique_ptr<HostWorld> build(const RigidWorldDefinition& d) {
    std::string error;
    auto world = bridge::makeWorld(d, error);
    INFO(error);
    REQUIRE(world);
    CHECK(error.empty());
    return world;
}

inline std::string errorOf(const RigidWorldDefinition& d) {
    std::string error;
    CHECK(bridge::makeWorld(d, error) == nullptr);
    return error;
}

} // namespace supercircle::bridge_test
