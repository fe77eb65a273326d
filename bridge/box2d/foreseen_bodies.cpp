#include "bridge/box2d/foreseen_bodies.h"

#include <algorithm>
#include <cmath>

namespace supercircle::bridge {

void ForeseenBodies::note(b2World& world, const BodyRegistry& registry, float ahead) {
    noted_.clear();
    starts_.clear();
    for (b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext()) {
        if (b->GetType() != b2_staticBody)
            starts_.push_back({b, 0, b->GetWorldCenter(), b->GetAngle()});
        if (b->GetType() == b2_dynamicBody && b->IsEnabled()) {
            const Motion m = foreseenMotion(*b, ahead, world.GetGravity());
            noted_.push_back({nullptr, registry.id(b), b->GetWorldCenter() + m.way, b->GetAngle() + m.turn});
        }
    }
}

const ForeseenBodies::Pose* ForeseenBodies::startOf(const b2Body& body) const {
    const auto at = std::find_if(starts_.begin(), starts_.end(), [&](const Pose& p) { return p.body == &body; });
    return at != starts_.end() ? &*at : nullptr;
}

bool ForeseenBodies::stood(const b2Body& body) const {
    const Pose* start = startOf(body);
    return start != nullptr && start->centre == body.GetWorldCenter() && start->angle == body.GetAngle();
}

ForeseenBodies::Pose ForeseenBodies::straying(const BodyRegistry& registry, std::span<const step::BodyId> known,
                                              const Pose& noted, Motion& stray) {
    b2Body* b = std::binary_search(known.begin(), known.end(), noted.id) ? nullptr : registry.body(noted.id);
    if (b == nullptr || b->GetType() != b2_dynamicBody || !b->IsEnabled())
        return {};
    stray = {b->GetWorldCenter() - noted.centre, b->GetAngle() - noted.angle};
    // A body that comes to the other end of its reach has gone twice as far as a step can take it.
    const bool byStep = stray.way.Length() <= 2.0F * b2_maxTranslation && std::abs(stray.turn) <= 2.0F * b2_maxRotation;
    if (!byStep || (stray.way == b2Vec2_zero && stray.turn == 0.0F))
        return {};
    return {b, noted.id, noted.centre, noted.angle};
}

} // namespace supercircle::bridge
