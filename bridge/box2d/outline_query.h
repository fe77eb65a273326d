#pragma once
// Which pieces of which bodies lie in a box, now or within the coming step.

#include <box2d/box2d.h>
#include <cstdint>
#include <span>
#include <vector>

namespace supercircle::bridge {

/// Child `child` of a fixture that is solid to shells.
struct Piece {
    b2Body* body = nullptr;
    const b2Fixture* fixture = nullptr;
    int32 child = 0;

    /// Counts children from the body's oldest fixture, so that fixtures added later change no key.
    [[nodiscard]] std::uint32_t key() const;
};

/// Of a body, in host units.
struct Motion {
    b2Vec2 way = b2Vec2_zero; ///< of its centre of mass
    float turn = 0.0F;
};

/// Motion of a body within `ahead` s by its own velocity, at most what Box2D lets a body do in one step. What its
/// constraints and its user do to it within the step is not foreseen.
Motion foreseenMotion(const b2Body& body, float ahead, const b2Vec2& gravity);

/// Box of a piece on a motion from where it is.
b2AABB sweptBox(const Piece& piece, const Motion& motion);

/// Keeps its storage between queries. Only enabled bodies are found.
class OutlineQuery {
public:
    /// Pieces that meet `box` (host units) now.
    const std::vector<Piece>& now(b2World& world, const b2AABB& box);
    /// Pieces that meet one of the boxes (at least one), with all pieces of each body that may move and gets into one
    /// within `ahead` s by its own velocity.
    const std::vector<Piece>& ahead(b2World& world, std::span<const b2AABB> boxes, double ahead);
    /// All pieces of a body, if one of them met one of the boxes on the motion that led to where it is; else none.
    const std::vector<Piece>& onWay(b2Body& body, const Motion& motion, std::span<const b2AABB> boxes);
    const std::vector<Piece>& all(b2World& world);

    bool QueryCallback(int32 proxyId); // called by Box2D

private:
    const b2BroadPhase* broadPhase_ = nullptr;
    b2AABB box_{};
    std::vector<Piece> found_;
};

} // namespace supercircle::bridge
