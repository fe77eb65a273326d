#pragma once
// Stable ids for the bodies of a world without destruction callbacks (scheme and limits: Box2dPort).

#include "supercircle/step/port.h"

#include <box2d/box2d.h>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace supercircle::bridge {

class BodyRegistry {
public:
    /// Compares the world's body list with the last one: removes destroyed bodies, gives ids to new ones, oldest first.
    void sync(b2World& world);
    /// As sync(), but skipped if body count and youngest body are unchanged.
    void syncIfChanged(b2World& world);
    /// Null if there is no such body. Call after a sync.
    [[nodiscard]] b2Body* body(step::BodyId id) const;
    /// 0 if there is no such body. Call after a sync.
    [[nodiscard]] step::BodyId id(const b2Body* body) const;
    /// Ends the id of the body. As long as the body exists, it has a new id.
    void notifyDestroyed(const b2Body* body);

private:
    /// Properties that distinguish a body from a later one at the same address.
    struct Traits {
        std::uintptr_t userData = 0;
        const b2Fixture* fixtures = nullptr;
        b2BodyType type = b2_staticBody;
        float mass = 0.0F;
        float inertia = 0.0F;
        bool operator==(const Traits&) const = default;
    };
    struct KnownBody {
        b2Body* body = nullptr;
        step::BodyId id = 0;
        Traits traits;
    };
    static Traits traitsOf(const b2Body& body);
    static bool sameTraits(const Traits& before, const b2Body& body);

    [[nodiscard]] std::size_t indexOf(const b2Body* body) const; ///< in known_, or its size
    [[nodiscard]] std::size_t indexOf(step::BodyId id) const;
    void sortIndices();

    std::vector<KnownBody> known_; ///< oldest first
    // Sorted, for look-up only. A frame without changes allocates nothing.
    std::vector<std::pair<const b2Body*, std::size_t>> byBody_; ///< index into known_
    std::vector<std::pair<step::BodyId, std::size_t>> byId_;
    step::BodyId next_ = 1;
    std::vector<b2Body*> current_;       ///< storage of sync()
    std::vector<std::size_t> survivors_; ///< likewise
    std::vector<KnownBody> updated_;     ///< likewise
};

} // namespace supercircle::bridge
