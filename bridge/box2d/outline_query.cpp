#include "bridge/box2d/outline_query.h"

#include "bridge/box2d/outlines.h"

#include <algorithm>
#include <cmath>

namespace supercircle::bridge {

namespace {

void appendSolids(b2Body& body, std::vector<Piece>& pieces) {
    for (const b2Fixture* f = body.GetFixtureList(); f != nullptr; f = f->GetNext())
        for (int32 child = 0; isSolid(*f) && child < f->GetShape()->GetChildCount(); ++child)
            pieces.push_back({&body, f, child});
}

b2AABB boxOf(const Piece& p) {
    b2AABB box;
    p.fixture->GetShape()->ComputeAABB(&box, p.body->GetTransform(), p.child);
    return box;
}

/// Box2D's tree loses pieces below a box that is not finite.
bool treeIsSound(const b2World& world) {
    for (const b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext())
        if (!b->GetPosition().IsValid() || !std::isfinite(b->GetAngle()))
            return false;
    return true;
}

/// Way and turn of a body within `ahead` s, at most what Box2D lets a body do in one step. What its constraints and its
/// user do to it within the step is not foreseen.
struct Sweep {
    b2Vec2 way = b2Vec2_zero;
    float turn = 0.0F;

    Sweep(const b2Body& body, float ahead, const b2Vec2& gravity) {
        if (!body.IsAwake())
            return;
        const b2Vec2 fall = body.GetType() == b2_dynamicBody ? body.GetGravityScale() * gravity : b2Vec2_zero;
        way = ahead * (body.GetLinearVelocity() + ahead * fall);
        if (const float length = way.Length(); length > b2_maxTranslation)
            way *= b2_maxTranslation / length;
        turn = std::min(std::abs(ahead * body.GetAngularVelocity()), b2_maxRotation);
    }

    [[nodiscard]] b2AABB of(const Piece& p) const {
        b2AABB box = boxOf(p);
        const float swing = turn * (b2Abs(box.GetCenter() - p.body->GetWorldCenter()) + box.GetExtents()).Length();
        box.lowerBound += b2Min(way, b2Vec2_zero) - b2Vec2(swing, swing);
        box.upperBound += b2Max(way, b2Vec2_zero) + b2Vec2(swing, swing);
        return box;
    }
};

} // namespace

std::uint32_t Piece::key() const {
    std::uint32_t older = 0;
    for (const b2Fixture* f = fixture->GetNext(); f != nullptr; f = f->GetNext()) // newest first
        older += static_cast<std::uint32_t>(f->GetShape()->GetChildCount());
    return older + static_cast<std::uint32_t>(child);
}

bool OutlineQuery::QueryCallback(int32 proxyId) {
    auto* proxy = static_cast<b2FixtureProxy*>(broadPhase_->GetUserData(proxyId));
    const Piece piece{proxy->fixture->GetBody(), proxy->fixture, proxy->childIndex};
    if (isSolid(*piece.fixture) && b2TestOverlap(boxOf(piece), box_)) // the tree's own boxes are fattened
        found_.push_back(piece);
    return true;
}

const std::vector<Piece>& OutlineQuery::now(b2World& world, const b2AABB& box) {
    found_.clear();
    broadPhase_ = &world.GetContactManager().m_broadPhase;
    box_ = box;
    if (treeIsSound(world)) {
        broadPhase_->Query(this, box);
        return found_;
    }
    all(world);
    std::erase_if(found_, [&](const Piece& p) { return !b2TestOverlap(boxOf(p), box); });
    return found_;
}

const std::vector<Piece>& OutlineQuery::ahead(b2World& world, std::span<const b2AABB> boxes, double ahead) {
    b2AABB all = boxes.front();
    for (const b2AABB& box : boxes)
        all.Combine(box);
    now(world, all);
    const auto meets = [&](const b2AABB& piece) {
        return std::any_of(boxes.begin(), boxes.end(), [&](const b2AABB& box) { return b2TestOverlap(piece, box); });
    };
    std::erase_if(found_, [&](const Piece& p) { // those that may move follow, whole
        return p.body->GetType() != b2_staticBody || (boxes.size() > 1 && !meets(boxOf(p)));
    });
    for (b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext()) {
        if (b->GetType() == b2_staticBody || !b->IsEnabled())
            continue;
        const std::size_t first = found_.size();
        appendSolids(*b, found_);
        const Sweep sweep(*b, static_cast<float>(ahead), world.GetGravity());
        if (std::none_of(found_.begin() + static_cast<std::ptrdiff_t>(first), found_.end(),
                         [&](const Piece& p) { return meets(sweep.of(p)); }))
            found_.resize(first);
    }
    return found_;
}

const std::vector<Piece>& OutlineQuery::all(b2World& world) {
    found_.clear();
    for (b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext())
        if (b->IsEnabled())
            appendSolids(*b, found_);
    return found_;
}

} // namespace supercircle::bridge
