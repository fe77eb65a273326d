#include "bridge/box2d/body_registry.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace supercircle::bridge {

BodyRegistry::Traits BodyRegistry::traitsOf(const b2Body& body) {
    Traits t;
    t.userData = const_cast<b2Body&>(body).GetUserData().pointer; // 2.4.1 has no const getter
    t.fixtures = body.GetFixtureList();
    t.type = body.GetType();
    t.mass = body.GetMass();
    t.inertia = body.GetInertia();
    return t;
}

bool BodyRegistry::sameTraits(const Traits& before, const b2Body& body) {
    Traits now = traitsOf(body);
    if (!std::isfinite(before.mass + before.inertia) || !std::isfinite(now.mass + now.inertia)) {
        now.mass = before.mass; // NaN equals nothing, and tells nothing about who the body is
        now.inertia = before.inertia;
    }
    if (before.fixtures == now.fixtures)
        return before.userData == now.userData && before.type == now.type &&
               (!std::isfinite(before.mass + before.inertia) ||
                (before.mass == now.mass && before.inertia == now.inertia));
    if (before.userData != now.userData || before.type != now.type)
        return false;
    // If fixtures were added to the same body, the old head is still in the list.
    bool found = before.fixtures == nullptr;
    for (const b2Fixture* f = now.fixtures; f != nullptr && !found; f = f->GetNext())
        found = f == before.fixtures;
    return found;
}

std::size_t BodyRegistry::indexOf(const b2Body* body) const {
    const auto found = std::lower_bound(byBody_.begin(), byBody_.end(), body, [](const auto& entry, const b2Body* b) {
        return std::less<>()(entry.first, b);
    });
    return found == byBody_.end() || found->first != body ? known_.size() : found->second;
}

std::size_t BodyRegistry::indexOf(step::BodyId id) const {
    const auto found = std::lower_bound(byId_.begin(), byId_.end(), id,
                                        [](const auto& entry, step::BodyId sought) { return entry.first < sought; });
    return found == byId_.end() || found->first != id ? known_.size() : found->second;
}

void BodyRegistry::sortIndices() {
    byBody_.clear();
    byId_.clear();
    for (std::size_t i = 0; i < known_.size(); ++i) {
        byBody_.emplace_back(known_[i].body, i);
        byId_.emplace_back(known_[i].id, i);
    }
    std::sort(byBody_.begin(), byBody_.end(),
              [](const auto& a, const auto& b) { return std::less<>()(a.first, b.first); });
    std::sort(byId_.begin(), byId_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
}

void BodyRegistry::sync(b2World& world) {
    current_.clear();
    for (b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext())
        current_.push_back(b);
    std::reverse(current_.begin(), current_.end()); // Box2D's list starts with the youngest

    // Surviving bodies keep their order and come before all new ones: they form a prefix in the old order. At its end a
    // new body may have the address of a destroyed one, in the same position. All bodies before a true survivor are
    // survivors.
    survivors_.clear(); // indices into known_
    for (const b2Body* b : current_) {
        const std::size_t found = indexOf(b);
        if (found == known_.size() || (!survivors_.empty() && found <= survivors_.back()))
            break;
        survivors_.push_back(found);
    }
    while (!survivors_.empty() && !sameTraits(known_[survivors_.back()].traits, *current_[survivors_.size() - 1]))
        survivors_.pop_back();

    const bool all = survivors_.size() == current_.size() && current_.size() == known_.size();
    updated_.clear();
    for (std::size_t i = 0; i < current_.size(); ++i)
        updated_.push_back(
            {current_[i], i < survivors_.size() ? known_[survivors_[i]].id : next_++, traitsOf(*current_[i])});
    std::swap(known_, updated_);
    if (!all)
        sortIndices();
}

void BodyRegistry::syncIfChanged(b2World& world) {
    const bool same = world.GetBodyCount() == static_cast<int32>(known_.size()) &&
                      (known_.empty() || world.GetBodyList() == known_.back().body);
    if (!same)
        sync(world);
}

b2Body* BodyRegistry::body(step::BodyId id) const {
    const std::size_t found = indexOf(id);
    return found == known_.size() ? nullptr : known_[found].body;
}

step::BodyId BodyRegistry::id(const b2Body* body) const {
    const std::size_t found = indexOf(body);
    return found == known_.size() ? 0 : known_[found].id;
}

void BodyRegistry::notifyDestroyed(const b2Body* body) {
    const std::size_t found = indexOf(body);
    if (found == known_.size())
        return;
    // Its position in the order stays, because the body still exists for a moment; its id changes.
    known_[found].id = next_++;
    sortIndices();
}

} // namespace supercircle::bridge
