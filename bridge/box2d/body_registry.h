#pragma once
// Ids for the bodies of a world that says no goodbye (see Box2dPort for the scheme and its limits).

#include "supercircle/step/port.h"

#include <box2d/box2d.h>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace supercircle::bridge {

class BodyRegistry {
public:
    /// Compares the world's body list with the one last seen: drops the dead, gives ids to the new, oldest first.
    void sync(b2World& world);
    /// As sync(), skipped when body count and youngest body are those last seen.
    void syncIfChanged(b2World& world);
    /// Null when there is no such body. Call after a sync.
    [[nodiscard]] b2Body* body(step::BodyId id) const;
    /// 0 when there is no such body. Call after a sync.
    [[nodiscard]] step::BodyId id(const b2Body* body) const;
    /// The body's id dies; as long as the body itself lives it goes by a new one.
    void forget(const b2Body* body);

private:
    /// What a body keeps unless its user changes it: tells a successor at the same address from the original.
    struct Traits {
        std::uintptr_t userData = 0;
        const b2Fixture* fixtures = nullptr;
        b2BodyType type = b2_staticBody;
        float mass = 0.0F;
        float inertia = 0.0F;
        bool operator==(const Traits&) const = default;
    };
    struct Known {
        b2Body* body = nullptr;
        step::BodyId id = 0;
        Traits traits;
    };
    static Traits traitsOf(const b2Body& body);
    static bool looksTheSame(const Traits& before, const b2Body& body);

    [[nodiscard]] std::size_t place(const b2Body* body) const; ///< in known_, or its size
    [[nodiscard]] std::size_t place(step::BodyId id) const;
    void sortNames();

    std::vector<Known> known_; ///< oldest first
    // Sorted, looked up and never walked. A frame of a world in which nothing changed allocates nothing.
    std::vector<std::pair<const b2Body*, std::size_t>> byBody_; ///< index into known_
    std::vector<std::pair<step::BodyId, std::size_t>> byId_;
    step::BodyId next_ = 1;
    std::vector<b2Body*> current_;       ///< storage of sync()
    std::vector<std::size_t> survivors_; ///< likewise
    std::vector<Known> now_;             ///< likewise
};

} // namespace supercircle::bridge
