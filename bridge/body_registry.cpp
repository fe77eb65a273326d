#include "bridge/body_registry.h"

#include <algorithm>
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

bool BodyRegistry::looksTheSame(const Traits& before, const b2Body& body) {
    const Traits now = traitsOf(body);
    if (before.fixtures == now.fixtures)
        return before == now;
    if (before.userData != now.userData || before.type != now.type)
        return false;
    // Fixtures may have been added to the same body: then the old head is still in the list.
    bool found = before.fixtures == nullptr;
    for (const b2Fixture* f = now.fixtures; f != nullptr && !found; f = f->GetNext())
        found = f == before.fixtures;
    return found;
}

void BodyRegistry::sync(b2World& world) {
    std::vector<b2Body*> current;
    for (b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext())
        current.push_back(b);
    std::reverse(current.begin(), current.end()); // Box2D's list starts with the youngest

    // Survivors keep their order and stand before all newcomers: they are a stretch at the front that is in the old
    // order. Where that stretch ends, a newcomer at a dead body's address may stand in the dead one's place; whoever
    // stands before a true survivor is one.
    std::vector<std::size_t> survivors; // indices into known_
    for (const b2Body* b : current) {
        const auto found = byBody_.find(b);
        if (found == byBody_.end() || (!survivors.empty() && found->second <= survivors.back()))
            break;
        survivors.push_back(found->second);
    }
    while (!survivors.empty() && !looksTheSame(known_[survivors.back()].traits, *current[survivors.size() - 1]))
        survivors.pop_back();

    std::vector<Known> now;
    now.reserve(current.size());
    for (std::size_t i = 0; i < current.size(); ++i)
        now.push_back({current[i], i < survivors.size() ? known_[survivors[i]].id : next_++, traitsOf(*current[i])});
    known_ = std::move(now);
    byBody_.clear();
    byId_.clear();
    for (std::size_t i = 0; i < known_.size(); ++i) {
        byBody_[known_[i].body] = i;
        byId_[known_[i].id] = i;
    }
}

void BodyRegistry::syncIfChanged(b2World& world) {
    const bool same = world.GetBodyCount() == static_cast<int32>(known_.size()) &&
                      (known_.empty() || world.GetBodyList() == known_.back().body);
    if (!same)
        sync(world);
}

b2Body* BodyRegistry::body(step::BodyId id) const {
    const auto found = byId_.find(id);
    return found == byId_.end() ? nullptr : known_[found->second].body;
}

step::BodyId BodyRegistry::id(const b2Body* body) const {
    const auto found = byBody_.find(body);
    return found == byBody_.end() ? 0 : known_[found->second].id;
}

void BodyRegistry::forget(const b2Body* body) {
    const auto found = byBody_.find(body);
    if (found == byBody_.end())
        return;
    // The place in the order stays (the body still lives for a moment); its name changes.
    byId_.erase(known_[found->second].id);
    known_[found->second].id = next_++;
    byId_[known_[found->second].id] = found->second;
}

} // namespace supercircle::bridge
