#pragma once
// Dynamic bodies that Box2D's step carries elsewhere than their velocities say: step::Port::foresee, strayed.

#include "bridge/box2d/body_registry.h"
#include "bridge/box2d/outline_query.h"

#include <span>
#include <vector>

namespace supercircle::bridge {

class ForeseenBodies {
public:
    struct Pose {
        b2Body* body = nullptr; ///< null: nobody
        step::BodyId id = 0;
        b2Vec2 centre{0.0F, 0.0F}; ///< of mass, host units
        float angle = 0.0F;
    };

    /// Before a step of `ahead` s.
    void note(b2World& world, const BodyRegistry& registry, float ahead);
    /// Where a body that may move was before it; null: it was not there.
    [[nodiscard]] const Pose* startOf(const b2Body& body) const;
    /// After it: whether a body stands where it stood before.
    [[nodiscard]] bool stood(const b2Body& body) const;
    /// After it: where the bodies were foreseen that strayed from there, but those of `known` (sorted), and the ways.
    template <class Take>
    void forStrays(const BodyRegistry& registry, std::span<const step::BodyId> known, Take take) const {
        for (const Pose& p : noted_) {
            Motion stray;
            if (const Pose now = straying(registry, known, p, stray); now.body != nullptr)
                take(now, stray);
        }
    }

private:
    static Pose straying(const BodyRegistry& registry, std::span<const step::BodyId> known, const Pose& noted,
                         Motion& stray);

    std::vector<Pose> noted_;  ///< without pointers: bodies may be destroyed within the step
    std::vector<Pose> starts_; ///< of bodies that may move, before the step; pointers are compared, never followed
};

} // namespace supercircle::bridge
